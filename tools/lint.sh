#!/bin/sh
# Checks style: fortitude for Fortran, ruff for Python, the budgets of the style guide.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
cd "$root"

sh tools/setup.sh lint

failed=0
.venv/bin/fortitude check --output-format concise src tests/pf || failed=1
.venv/bin/ruff check . || failed=1
.venv/bin/ruff format --check . || failed=1
.venv/bin/python tools/budgets.py || failed=1
exit "$failed"
