# Finds the sequential MUMPS in double and single precision, which has no package file of its own.
# Defines MUMPS_FOUND, MUMPS_VERSION and the target MUMPS::MUMPS.

find_path(MUMPS_INCLUDE_DIR dmumps_c.h)
find_library(MUMPS_LIBRARY dmumps_seq)
find_library(MUMPS_SINGLE_LIBRARY smumps_seq)
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_LIBRARY MUMPS_SINGLE_LIBRARY)

unset(MUMPS_VERSION)
if(MUMPS_INCLUDE_DIR)
  file(STRINGS "${MUMPS_INCLUDE_DIR}/dmumps_c.h" line
    REGEX "^#define MUMPS_VERSION +\"[0-9.]+\"" LIMIT_COUNT 1)
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" MUMPS_VERSION "${line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS
  REQUIRED_VARS MUMPS_LIBRARY MUMPS_SINGLE_LIBRARY MUMPS_INCLUDE_DIR
  VERSION_VAR MUMPS_VERSION)

if(MUMPS_FOUND AND NOT TARGET MUMPS::MUMPS)
  add_library(MUMPS::MUMPS UNKNOWN IMPORTED)
  set_target_properties(MUMPS::MUMPS PROPERTIES
    IMPORTED_LOCATION "${MUMPS_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MUMPS_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${MUMPS_SINGLE_LIBRARY}")
endif()
