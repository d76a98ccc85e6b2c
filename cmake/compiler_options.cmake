# Compiler options, by what they are for:
#   tessera_build     what every Fortran target needs: optimisation, run-time checks, OpenMP
#   tessera_warnings  the language standard and the warnings, for our own sources only

if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  message(FATAL_ERROR "Tessera is built with gfortran; found ${CMAKE_Fortran_COMPILER_ID}")
endif()
if(CMAKE_Fortran_COMPILER_VERSION VERSION_LESS 12)
  message(FATAL_ERROR "gfortran 12 or newer is needed; found ${CMAKE_Fortran_COMPILER_VERSION}")
endif()

set(TESSERA_STANDARD_FLAGS -std=f2008)
# gfortran 12 raises -Wuninitialized falsely for the descriptor of an allocatable that is assigned
# for the first time; a real that is really unset is a signalling NaN in the debug build.
set(TESSERA_WARNING_FLAGS -Wall -Wextra -pedantic -Wno-uninitialized)
set(TESSERA_DEBUG_FLAGS
  -Og -fcheck=all -finit-real=snan -ffpe-trap=invalid,zero,overflow -fbacktrace)
# A finding ends the process: what reads hostile input in it must notice.
set(TESSERA_SANITIZE_FLAGS
  -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)

find_package(OpenMP REQUIRED COMPONENTS Fortran)

add_library(tessera_build INTERFACE)
target_link_libraries(tessera_build INTERFACE OpenMP::OpenMP_Fortran)
target_compile_options(tessera_build INTERFACE
  $<$<CONFIG:Debug>:${TESSERA_DEBUG_FLAGS}>
  $<$<BOOL:${TESSERA_NATIVE}>:-march=native>
  $<$<BOOL:${TESSERA_SANITIZE}>:${TESSERA_SANITIZE_FLAGS}>)
target_link_options(tessera_build INTERFACE $<$<BOOL:${TESSERA_SANITIZE}>:${TESSERA_SANITIZE_FLAGS}>)

add_library(tessera_warnings INTERFACE)
target_compile_options(tessera_warnings INTERFACE
  ${TESSERA_STANDARD_FLAGS} ${TESSERA_WARNING_FLAGS}
  $<$<BOOL:${TESSERA_WERROR}>:-Werror>)

# The flags as one line, for the log of a run.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
set(TESSERA_COMPILER_FLAGS
  ${CMAKE_Fortran_FLAGS} ${CMAKE_Fortran_FLAGS_${build_type}} ${OpenMP_Fortran_FLAGS}
  ${TESSERA_STANDARD_FLAGS} ${TESSERA_WARNING_FLAGS})
if(build_type STREQUAL "DEBUG")
  list(APPEND TESSERA_COMPILER_FLAGS ${TESSERA_DEBUG_FLAGS})
endif()
if(TESSERA_NATIVE)
  list(APPEND TESSERA_COMPILER_FLAGS -march=native)
endif()
if(TESSERA_SANITIZE)
  list(APPEND TESSERA_COMPILER_FLAGS ${TESSERA_SANITIZE_FLAGS})
endif()
list(JOIN TESSERA_COMPILER_FLAGS " " TESSERA_COMPILER_FLAGS)
unset(build_type)
