!> Numeric kinds of the whole program.
module mpm_kinds
  use, intrinsic :: iso_c_binding, only: c_double, c_long
  implicit none
  private
  public :: dp, ip

  integer, parameter :: dp = c_double !! double precision, the C double of UMFPACK
  integer, parameter :: ip = c_long   !! 64-bit integer, the C long of umfpack_dl_*
end module mpm_kinds
