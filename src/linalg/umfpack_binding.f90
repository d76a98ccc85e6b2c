!> C interfaces of UMFPACK 5 for real matrices with 64-bit indices; no logic.
! allow(assumed-size)
module mpm_umfpack_binding
  use, intrinsic :: iso_c_binding, only: c_double, c_long, c_ptr
  implicit none
  private
  public :: umfpack_dl_defaults, umfpack_dl_symbolic, umfpack_dl_numeric, umfpack_dl_solve
  public :: umfpack_dl_free_symbolic, umfpack_dl_free_numeric
  public :: umfpack_control, umfpack_info
  public :: control_initial, control_strategy, control_ordering, control_refinements
  public :: strategy_symmetric, ordering_cholmod, info_flops, info_entries
  public :: info_peak, info_peak_estimate, info_rcond, info_unit
  public :: info_entries_l, info_entries_u, info_flops_estimate, info_symmetric_entries
  public :: info_symmetric_flops, info_variable_peak
  public :: status_ok, status_ordering_failed, status_out_of_memory, status_singular, system_a

  ! Zero-based positions, as in umfpack.h.
  integer, parameter :: umfpack_control = 20     !! length of the array of controls
  integer, parameter :: umfpack_info = 90        !! length of the array of statistics
  integer, parameter :: control_strategy = 5     !! position of UMFPACK_STRATEGY
  integer, parameter :: control_initial = 6      !! position of UMFPACK_ALLOC_INIT
  integer, parameter :: control_refinements = 7  !! position of UMFPACK_IRSTEP
  integer, parameter :: control_ordering = 10    !! position of UMFPACK_ORDERING
  integer, parameter :: info_unit = 3            !! position of UMFPACK_SIZE_OF_UNIT
  integer, parameter :: info_flops = 42          !! position of UMFPACK_FLOPS
  integer, parameter :: info_entries = 64        !! position of UMFPACK_LU_ENTRIES
  integer, parameter :: info_peak_estimate = 21  !! position of UMFPACK_PEAK_MEMORY_ESTIMATE
  integer, parameter :: info_flops_estimate = 22 !! position of UMFPACK_FLOPS_ESTIMATE
  integer, parameter :: info_entries_l = 23      !! position of UMFPACK_LNZ_ESTIMATE
  integer, parameter :: info_entries_u = 24      !! position of UMFPACK_UNZ_ESTIMATE
  integer, parameter :: info_variable_peak = 26  !! position of UMFPACK_VARIABLE_PEAK_ESTIMATE
  integer, parameter :: info_symmetric_entries = 36 !! position of UMFPACK_SYMMETRIC_LUNZ
  integer, parameter :: info_symmetric_flops = 37 !! position of UMFPACK_SYMMETRIC_FLOPS
  integer, parameter :: info_peak = 41           !! position of UMFPACK_PEAK_MEMORY
  integer, parameter :: info_rcond = 67          !! position of UMFPACK_RCOND

  integer, parameter :: strategy_symmetric = 3   !! UMFPACK_STRATEGY_SYMMETRIC
  integer, parameter :: ordering_cholmod = 0     !! AMD, or METIS where AMD fills in much

  integer(c_long), parameter :: status_ok = 0             !! UMFPACK_OK
  integer(c_long), parameter :: status_singular = 1       !! UMFPACK_WARNING_singular_matrix
  integer(c_long), parameter :: status_out_of_memory = -1 !! UMFPACK_ERROR_out_of_memory
  integer(c_long), parameter :: status_ordering_failed = -18 !! UMFPACK_ERROR_ordering_failed
  integer(c_long), parameter :: system_a = 0              !! UMFPACK_A: A x = b

  interface

    !> Fills the controls with their defaults.
    subroutine umfpack_dl_defaults(control) bind(c, name="umfpack_dl_defaults")
      import :: c_double
      implicit none
      real(c_double), intent(out) :: control(0:19) !! controls
    end subroutine umfpack_dl_defaults

    !> Orders the columns and analyses the pattern.
    function umfpack_dl_symbolic(n_row, n_col, col_ptr, row, val, symbolic, control, info) &
      bind(c, name="umfpack_dl_symbolic") result(status)
      import :: c_double, c_long, c_ptr
      implicit none
      integer(c_long), value :: n_row              !! rows
      integer(c_long), value :: n_col              !! columns
      integer(c_long), intent(in) :: col_ptr(0:*)  !! (0:n)
      integer(c_long), intent(in) :: row(0:*)      !! (0:nnz-1)
      real(c_double), intent(in)  :: val(0:*)      !! (0:nnz-1)
      type(c_ptr), intent(out)    :: symbolic      !! handle of the analysis
      real(c_double), intent(in)  :: control(0:19) !! controls
      real(c_double), intent(out) :: info(0:89)    !! statistics
      integer(c_long) :: status                    !! status_*
    end function umfpack_dl_symbolic

    !> Factorises the values.
    function umfpack_dl_numeric(col_ptr, row, val, symbolic, numeric, control, info) &
      bind(c, name="umfpack_dl_numeric") result(status)
      import :: c_double, c_long, c_ptr
      implicit none
      integer(c_long), intent(in) :: col_ptr(0:*)  !! (0:n)
      integer(c_long), intent(in) :: row(0:*)      !! (0:nnz-1)
      real(c_double), intent(in)  :: val(0:*)      !! (0:nnz-1)
      type(c_ptr), value          :: symbolic      !! handle of the analysis
      type(c_ptr), intent(out)    :: numeric       !! handle of the factors
      real(c_double), intent(in)  :: control(0:19) !! controls
      real(c_double), intent(out) :: info(0:89)    !! statistics
      integer(c_long) :: status                    !! status_*
    end function umfpack_dl_numeric

    !> Solves with existing factors.
    function umfpack_dl_solve(system, col_ptr, row, val, x, rhs, numeric, control, info) &
      bind(c, name="umfpack_dl_solve") result(status)
      import :: c_double, c_long, c_ptr
      implicit none
      integer(c_long), value :: system             !! which system, system_a
      integer(c_long), intent(in) :: col_ptr(0:*)  !! (0:n)
      integer(c_long), intent(in) :: row(0:*)      !! (0:nnz-1)
      real(c_double), intent(in)  :: val(0:*)      !! (0:nnz-1)
      real(c_double), intent(out) :: x(*)          !! (n)  solution
      real(c_double), intent(in)  :: rhs(*)        !! (n)  right-hand side
      type(c_ptr), value          :: numeric       !! handle of the factors
      real(c_double), intent(in)  :: control(0:19) !! controls
      real(c_double), intent(out) :: info(0:89)    !! statistics
      integer(c_long) :: status                    !! status_*
    end function umfpack_dl_solve

    !> Releases an analysis and sets its handle to null.
    subroutine umfpack_dl_free_symbolic(symbolic) bind(c, name="umfpack_dl_free_symbolic")
      import :: c_ptr
      implicit none
      type(c_ptr), intent(inout) :: symbolic !! handle
    end subroutine umfpack_dl_free_symbolic

    !> Releases factors and sets their handle to null.
    subroutine umfpack_dl_free_numeric(numeric) bind(c, name="umfpack_dl_free_numeric")
      import :: c_ptr
      implicit none
      type(c_ptr), intent(inout) :: numeric !! handle
    end subroutine umfpack_dl_free_numeric

  end interface

end module mpm_umfpack_binding
