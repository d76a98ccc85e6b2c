# add_layer(NAME <layer> SOURCES <file>... [IMPORTS <layer>...] [LINKS <library>...])
#
# One static library tessera_<layer> with a module directory of its own. Only the module directories
# of the imported layers are on its search path, so a `use` against the layer order does not compile.
function(add_layer)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME" "SOURCES;IMPORTS;LINKS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_NAME OR NOT arg_SOURCES)
    message(FATAL_ERROR "add_layer needs NAME and SOURCES; unknown: '${arg_UNPARSED_ARGUMENTS}'")
  endif()

  set(target tessera_${arg_NAME})
  set(module_dir "${PROJECT_BINARY_DIR}/modules/${arg_NAME}")
  list(TRANSFORM arg_IMPORTS PREPEND tessera_)
  foreach(import IN LISTS arg_IMPORTS)
    if(NOT TARGET ${import})
      message(FATAL_ERROR "layer ${arg_NAME}: ${import} does not exist (yet): wrong layer order?")
    endif()
  endforeach()

  add_library(${target} STATIC ${arg_SOURCES})
  set_target_properties(${target} PROPERTIES Fortran_MODULE_DIRECTORY "${module_dir}")
  target_include_directories(${target} PUBLIC "${module_dir}")
  target_link_libraries(${target}
    PUBLIC ${arg_IMPORTS}
    PRIVATE ${arg_LINKS} tessera_build tessera_warnings)
endfunction()
