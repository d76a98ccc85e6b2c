# Finds UMFPACK, which has no package file of its own, and OpenBLAS, on which its speed depends.
# Defines UMFPACK_FOUND, UMFPACK_VERSION and the target UMFPACK::UMFPACK.

find_path(UMFPACK_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
find_library(UMFPACK_LIBRARY umfpack)
find_library(OPENBLAS_LIBRARY openblas PATH_SUFFIXES openblas-pthread)
mark_as_advanced(UMFPACK_INCLUDE_DIR UMFPACK_LIBRARY OPENBLAS_LIBRARY)

unset(UMFPACK_VERSION)
if(UMFPACK_INCLUDE_DIR)
  set(parts)
  foreach(part MAIN SUB SUBSUB)
    file(STRINGS "${UMFPACK_INCLUDE_DIR}/umfpack.h" line
      REGEX "^#define UMFPACK_${part}_VERSION +[0-9]+" LIMIT_COUNT 1)
    string(REGEX REPLACE ".* ([0-9]+).*" "\\1" number "${line}")
    list(APPEND parts "${number}")
  endforeach()
  list(JOIN parts "." UMFPACK_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(UMFPACK
  REQUIRED_VARS UMFPACK_LIBRARY UMFPACK_INCLUDE_DIR OPENBLAS_LIBRARY
  VERSION_VAR UMFPACK_VERSION)

if(UMFPACK_FOUND AND NOT TARGET UMFPACK::UMFPACK)
  add_library(UMFPACK::UMFPACK UNKNOWN IMPORTED)
  set_target_properties(UMFPACK::UMFPACK PROPERTIES
    IMPORTED_LOCATION "${UMFPACK_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${UMFPACK_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${OPENBLAS_LIBRARY}")
endif()
