!> The libraries that this program was built with, for `--version`, the log and the results.
module mpm_library_text
  use mpm_build_info, only: hdf5_version, isal_version, metis_version, mumps_version, &
    umfpack_version
  implicit none
  private
  public :: library_text

contains

  !> Names and versions; of those that need not be there only the ones that are.
  pure function library_text() result(text)
    character(:), allocatable :: text

    text = "HDF5 "//hdf5_version//", UMFPACK "//umfpack_version//", METIS "//metis_version
    if (len(mumps_version) > 0) text = text//", MUMPS "//mumps_version
    if (len(isal_version) > 0) text = text//", ISA-L "//isal_version
  end function library_text

end module mpm_library_text
