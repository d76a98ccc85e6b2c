# Foreign libraries, each behind one target: UMFPACK::UMFPACK, METIS::METIS, ZLIB::ZLIB, tessera_hdf5,
# and MUMPS::MUMPS and ISAL::ISAL where they are there.

find_package(UMFPACK 5.7 REQUIRED)
find_package(METIS 5.1 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(ISAL) # fields are packed six times as fast with it
find_package(MUMPS 5.5) # factors that are kept, and LINEAR SOLVER=MUMPS of a deck

# Without the component HL, which nothing here uses: on a Debian without the development files of curl
# and OpenSSL CMake takes it for found, but names a library that does not exist.
set(HDF5_PREFER_PARALLEL FALSE)
find_package(HDF5 1.10.3 REQUIRED COMPONENTS Fortran)

add_library(tessera_hdf5 INTERFACE)
target_include_directories(tessera_hdf5 SYSTEM INTERFACE ${HDF5_Fortran_INCLUDE_DIRS})
target_link_libraries(tessera_hdf5 INTERFACE ${HDF5_Fortran_LIBRARIES})
