#!/bin/sh
# Installs what is missing, builds with every check, runs every test. Arguments go to pytest.
#   sh tools/test.sh [-k NAME ...]
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
cd "$root"

sh tools/setup.sh post test

# The program as a whole is tested with checks; what takes long or is timed, in the release build.
cmake --preset debug -DTESSERA_WERROR=ON
cmake --build --preset debug
cmake --build --preset debug --target fuzz_driver
cmake --preset release
cmake --build --preset release

failed=0
ctest --preset debug || failed=1

if [ "$failed" -ne 0 ]; then
  echo "test: ctest failed, see above; the tests of the program follow"
fi
TESSERA_EXE="$root/build/debug/bin/tessera" \
TESSERA_RELEASE_EXE="$root/build/release/bin/tessera" \
  .venv/bin/python -m pytest tests "$@" || failed=1

exit "$failed"
