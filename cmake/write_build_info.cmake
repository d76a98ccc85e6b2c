# Run at every build: writes the build information with the revision of this moment. The file is
# touched only when its content changes, so an unchanged revision compiles nothing.
# Input: SOURCE_DIR, TEMPLATE, OUTPUT, VALUES (a file that sets the values known since configuring).

include("${VALUES}")

find_program(git_program git)
set(TESSERA_GIT_REVISION "unknown")
if(git_program)
  execute_process(
    COMMAND "${git_program}" -c "safe.directory=${SOURCE_DIR}" -C "${SOURCE_DIR}"
      describe --always --dirty --abbrev=12 --exclude=*
    RESULT_VARIABLE failed OUTPUT_VARIABLE revision
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(TESSERA_GIT_REVISION "${revision}")
  endif()
endif()

configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
