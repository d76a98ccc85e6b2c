# Defines TESSERA_BUILD_INFO, the generated source of module mpm_build_info, and the target
# tessera_build_info that keeps it up to date.

set(TESSERA_BUILD_INFO "${PROJECT_BINARY_DIR}/generated/build_info.f90")
set(values "${PROJECT_BINARY_DIR}/generated/build_info_values.cmake")
configure_file("${PROJECT_SOURCE_DIR}/cmake/build_info_values.cmake.in" "${values}" @ONLY)

add_custom_target(tessera_build_info
  COMMAND "${CMAKE_COMMAND}"
    "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}"
    "-DTEMPLATE=${PROJECT_SOURCE_DIR}/src/core/build_info.f90.in"
    "-DOUTPUT=${TESSERA_BUILD_INFO}"
    "-DVALUES=${values}"
    -P "${PROJECT_SOURCE_DIR}/cmake/write_build_info.cmake"
  BYPRODUCTS "${TESSERA_BUILD_INFO}"
  COMMENT "Updating the build information"
  VERBATIM)
unset(values)

# The line of the compiler flags is as long as the flags are.
set_source_files_properties("${TESSERA_BUILD_INFO}" PROPERTIES
  GENERATED TRUE COMPILE_OPTIONS -ffree-line-length-none)
