# add_pf_test(LAYER <layer> SOURCES <test_file>.pf... [<helper>.f90...] [LINKS <library>...])
#
# One executable test_<layer>, also the name of its ctest, from the tests of that layer.
# With pFUnit installed its own preprocessor and library are used, else those in tests/pf.
find_package(PFUNIT 4.13 QUIET)
find_package(Python3 REQUIRED COMPONENTS Interpreter)

function(add_pf_test)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "LAYER" "SOURCES;LINKS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_LAYER OR NOT arg_SOURCES)
    message(FATAL_ERROR "add_pf_test needs LAYER and SOURCES; unknown: '${arg_UNPARSED_ARGUMENTS}'")
  endif()

  set(name test_${arg_LAYER})
  set(libraries tessera_${arg_LAYER} tessera_build ${arg_LINKS})
  set(suites ${arg_SOURCES})
  list(FILTER suites INCLUDE REGEX "\\.pf$")
  set(helpers ${arg_SOURCES})
  list(FILTER helpers EXCLUDE REGEX "\\.pf$")

  if(PFUNIT_FOUND)
    add_pfunit_ctest(${name}
      TEST_SOURCES ${suites} OTHER_SOURCES ${helpers} LINK_LIBRARIES ${libraries})
    guard_pfunit_test(${name} "${suites}")
  else()
    add_stand_in_test(${name} "${suites}" "${helpers}" "${libraries}")
  endif()
  set_tests_properties(${name} PROPERTIES
    ENVIRONMENT "TESSERA_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
endfunction()

# pFUnit's driver is not built anew when the list of suites changes, and 4.14.0 may lose a suite: the
# test passes only if as many tests ran as there are.
function(guard_pfunit_test name suites)
  set_source_files_properties("${CMAKE_CURRENT_BINARY_DIR}/${name}_driver.F90" PROPERTIES
    OBJECT_DEPENDS "${CMAKE_CURRENT_BINARY_DIR}/${name}.inc")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${suites})
  set(n_tests 0)
  foreach(suite IN LISTS suites)
    file(STRINGS "${suite}" tests REGEX "^[ \t]*@test[ \t]*$")
    list(LENGTH tests n_in_suite)
    math(EXPR n_tests "${n_tests} + ${n_in_suite}")
  endforeach()
  set_tests_properties(${name} PROPERTIES
    PASS_REGULAR_EXPRESSION "OK[ \n\r]+\\(${n_tests} tests?\\)")
endfunction()

# The same with our own preprocessor: the suites become one Fortran file each, and a driver.
function(add_stand_in_test name suites helpers libraries)
  set(preprocessor "${PROJECT_SOURCE_DIR}/tests/pf/pf_to_fortran.py")
  set(inputs)
  set(generated)
  foreach(suite IN LISTS suites)
    get_filename_component(stem "${suite}" NAME_WE)
    set(input "${CMAKE_CURRENT_SOURCE_DIR}/${suite}")
    set(output "${CMAKE_CURRENT_BINARY_DIR}/${stem}.f90")
    add_custom_command(OUTPUT "${output}"
      COMMAND Python3::Interpreter "${preprocessor}" suite "${input}" "${output}"
      DEPENDS "${input}" "${preprocessor}"
      VERBATIM)
    list(APPEND inputs "${input}")
    list(APPEND generated "${output}")
  endforeach()

  set(driver "${CMAKE_CURRENT_BINARY_DIR}/${name}_driver.f90")
  add_custom_command(OUTPUT "${driver}"
    COMMAND Python3::Interpreter "${preprocessor}" driver ${inputs} "${driver}"
    DEPENDS ${inputs} "${preprocessor}"
    VERBATIM)

  add_executable(${name} ${helpers} ${generated} "${driver}")
  set(module_dir "${CMAKE_CURRENT_BINARY_DIR}/modules")
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${module_dir}")
  target_include_directories(${name} PRIVATE "${module_dir}")
  target_link_libraries(${name} PRIVATE ${libraries} tessera_funit tessera_warnings)
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
endfunction()
