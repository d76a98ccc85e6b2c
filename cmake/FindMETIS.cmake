# Finds METIS, which has no package file of its own, built with 32-bit indices.
# Defines METIS_FOUND, METIS_VERSION and the target METIS::METIS.

find_path(METIS_INCLUDE_DIR metis.h)
find_library(METIS_LIBRARY metis)
mark_as_advanced(METIS_INCLUDE_DIR METIS_LIBRARY)

unset(METIS_VERSION)
if(METIS_INCLUDE_DIR)
  set(parts)
  foreach(part MAJOR MINOR SUBMINOR)
    file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" line
      REGEX "^#define[ \t]+METIS_VER_${part}[ \t]+[0-9]+" LIMIT_COUNT 1)
    string(REGEX REPLACE ".*[ \t]([0-9]+).*" "\\1" number "${line}")
    list(APPEND parts "${number}")
  endforeach()
  list(JOIN parts "." METIS_VERSION)

  # The Fortran binding passes 32-bit integers: another width would corrupt memory silently.
  file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" line REGEX "^[ \t]*#[ \t]*define[ \t]+IDXTYPEWIDTH")
  if(NOT line MATCHES "IDXTYPEWIDTH[ \t]+32")
    message(FATAL_ERROR "METIS must have IDXTYPEWIDTH 32; ${METIS_INCLUDE_DIR}/metis.h has: ${line}")
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(METIS
  REQUIRED_VARS METIS_LIBRARY METIS_INCLUDE_DIR
  VERSION_VAR METIS_VERSION)

if(METIS_FOUND AND NOT TARGET METIS::METIS)
  add_library(METIS::METIS UNKNOWN IMPORTED)
  set_target_properties(METIS::METIS PROPERTIES
    IMPORTED_LOCATION "${METIS_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${METIS_INCLUDE_DIR}")
endif()
