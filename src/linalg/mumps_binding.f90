!> Interfaces of mumps_shim.c, which calls MUMPS where the program is built with it; no logic.
! allow(assumed-size)
module mpm_mumps_binding
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_long, c_ptr
  implicit none
  private
  public :: mumps_analyse, mumps_close, mumps_factorize, mumps_is_there, mumps_solve
  public :: mumps_bytes, mumps_entries, mumps_flops, mumps_found, mumps_ok, mumps_singular

  integer(c_int), parameter :: mumps_ok = 0_c_int       !! done
  integer(c_int), parameter :: mumps_singular = 1_c_int !! zero pivot, or another error than memory

  ! Positions of what a call tells.
  integer, parameter :: mumps_bytes = 0   !! memory of a factorisation
  integer, parameter :: mumps_entries = 1 !! of the factors
  integer, parameter :: mumps_flops = 2   !! of a factorisation
  integer, parameter :: mumps_found = 3   !! how many these are

  interface

    !> 1 in a program that was built with MUMPS.
    pure function mumps_is_there() bind(c, name="tessera_mumps_is_there") result(answer)
      import :: c_int
      implicit none
      integer(c_int) :: answer
    end function mumps_is_there

    !> Analyses a pattern in an order of elimination; null if that fails.
    function mumps_analyse(single, n, nnz, col_ptr, row, place, status, found) &
      bind(c, name="tessera_mumps_analyse") result(handle)
      import :: c_double, c_int, c_long, c_ptr
      implicit none
      integer(c_int), value :: single             !! 1: factors of single precision, 0: of double
      integer(c_int), value :: n                  !! rows and columns
      integer(c_long), value :: nnz               !! entries
      integer(c_long), intent(in) :: col_ptr(0:*) !! (0:n)
      integer(c_long), intent(in) :: row(0:*)     !! (0:nnz-1)
      integer(c_int), intent(in) :: place(*)      !! (n)  of each column, from 1
      integer(c_int), intent(out) :: status       !! mumps_ok, mumps_singular or 2: no memory
      real(c_double), intent(out) :: found(0:*)   !! (0:mumps_found-1)  estimates
      type(c_ptr) :: handle
    end function mumps_analyse

    !> Factorises values in the order of the pattern.
    function mumps_factorize(handle, val, rcond, found) &
      bind(c, name="tessera_mumps_factorize") result(status)
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle             !! of an analysis
      real(c_double), intent(in) :: val(0:*)   !! (0:nnz-1)
      real(c_double), intent(out) :: rcond     !! smallest over largest pivot, 0 if singular [-]
      real(c_double), intent(out) :: found(0:*) !! (0:mumps_found-1)  counts
      integer(c_int) :: status                 !! as above
    end function mumps_factorize

    !> Solves with the factors.
    function mumps_solve(handle, x) bind(c, name="tessera_mumps_solve") result(status)
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle             !! with factors
      real(c_double), intent(inout) :: x(*)    !! (n)  right-hand side in, solution out
      integer(c_int) :: status                 !! as above
    end function mumps_solve

    !> Releases everything; harmless with null.
    subroutine mumps_close(handle) bind(c, name="tessera_mumps_close")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle             !! no handle afterwards
    end subroutine mumps_close

  end interface

end module mpm_mumps_binding
