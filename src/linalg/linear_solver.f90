!> Direct solution of sparse linear systems: the one seam behind which solvers are exchanged.
module mpm_linear_solver
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_long, &
    c_null_ptr, c_ptr
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_kinds, only: dp, ip
  use mpm_memory, only: has_room
  use mpm_mumps_binding, only: mumps_analyse, mumps_close, mumps_factorize, mumps_is_there, &
    mumps_ok, mumps_singular, mumps_solve
  use mpm_openblas_binding, only: dtrsm, openblas_set_num_threads
  use mpm_umfpack_binding, only: control_initial, control_ordering, control_refinements, &
    control_strategy, info_entries, info_flops, info_peak, info_peak_estimate, info_rcond, &
    info_unit, ordering_cholmod, status_ok, status_ordering_failed, status_out_of_memory, &
    strategy_symmetric, system_a, umfpack_control, umfpack_dl_defaults, &
    umfpack_dl_free_numeric, umfpack_dl_free_symbolic, umfpack_dl_numeric, umfpack_dl_solve, &
    umfpack_dl_symbolic, umfpack_info
  implicit none
  private
  public :: linear_solver_t, analyse, factorize, solve, free_solver
  public :: choose_library, has_factors, has_mumps, is_analysed, work_of_factors, work_of_solution
  public :: solver_ok, solver_singular, solver_memory, solver_not_finite

  integer, parameter :: solver_ok = 0       !! done
  integer, parameter :: solver_singular = 1 !! matrix singular to machine precision, or not finite
  integer, parameter :: solver_memory = 2   !! out of memory
  integer, parameter :: solver_not_finite = 3 !! the solution holds infinity or no numbers

  integer(ip), parameter :: blas_buffer = 135000000_ip !! a little more than OpenBLAS takes [bytes]
  real(dp), parameter :: first_units = 1.0e6_dp !! memory that a factorisation begins with; it grows.
    !! What UMFPACK would take at once is a fifth more in the end, and saves a twentieth of the time
  real(dp), parameter :: smallest_rcond = 1.0e-16_dp !! pivot ratio below which no digit is left

  !> A solver with its foreign handles: release them with `free_solver`. Never copy one that
  !! holds handles.
  type :: linear_solver_t
    type(c_ptr) :: symbolic = c_null_ptr                   !! analysis of the pattern
    type(c_ptr) :: numeric = c_null_ptr                    !! factors
    type(c_ptr) :: mumps = c_null_ptr                      !! analysis and factors of MUMPS
    logical     :: by_mumps = .false.                      !! MUMPS in place of UMFPACK
    real(dp)    :: control(0:umfpack_control - 1) = 0.0_dp !! controls of UMFPACK
    real(dp)    :: info(0:umfpack_info - 1) = 0.0_dp       !! statistics of UMFPACK's last call
    real(dp)    :: memory = 0.0_dp      !! estimate for a factorisation by the last analysis, 0 if
                                        !! unknown [bytes]
    real(dp)    :: most_memory = 0.0_dp !! of all factorisations so far, as UMFPACK reports [bytes]
    real(dp)    :: rcond = 1.0_dp       !! smallest over largest pivot, last factorisation [-]
    integer     :: n_analyses = 0       !! analyses so far
    integer     :: n_factorizations = 0 !! factorisations so far
  end type linear_solver_t

  ! Work, in entries of the factors that are read from memory. Measured: theory.md (15h).
  real(dp), parameter :: flops_per_entry = 65.0_dp !! of a factorisation, in the time of one entry
  real(dp), parameter :: passes = 16.0_dp          !! over the factors while they are made
  real(dp), parameter :: per_column = 1500.0_dp    !! of a factorisation, whatever its size

  !> OpenBLAS has its working memory: it belongs to the process, not to a solver.
  logical, save :: has_buffer = .false.

contains

  !> Orders and analyses the pattern of a matrix. A pattern of structural symmetry is expected;
  !! values may be unsymmetric. Factors of an earlier pattern are released.
  subroutine analyse(solver, matrix, outcome)
    type(linear_solver_t), intent(inout) :: solver !! receives the analysis
    type(csc_matrix_t), intent(in) :: matrix       !! pattern; values only need to exist
    integer, intent(out) :: outcome                !! solver_*
    integer(ip) :: status
    integer(c_int) :: code

    call free_solver(solver)
    outcome = solver_ok
    solver%memory = 0.0_dp
    if (matrix%n == 0) return
    ! More BLAS threads would make sums depend on their number and fight with OpenMP.
    call openblas_set_num_threads(1_c_int)
    call take_blas_buffer(outcome)
    if (outcome /= solver_ok) return
    solver%n_analyses = solver%n_analyses + 1
    if (solver%by_mumps) then
      solver%mumps = mumps_analyse(int(matrix%n, c_int), int(matrix%nnz, c_long), &
                                   matrix%col_ptr, matrix%row, code, solver%memory)
      outcome = outcome_of_mumps(code)
      return
    end if
    call umfpack_dl_defaults(solver%control)
    solver%control(control_strategy) = real(strategy_symmetric, dp)
    solver%control(control_ordering) = real(ordering_cholmod, dp)
    solver%control(control_refinements) = 0.0_dp
    solver%control(control_initial) = -first_units
    status = umfpack_dl_symbolic(int(matrix%n, ip), int(matrix%n, ip), matrix%col_ptr, &
                                 matrix%row, matrix%val, solver%symbolic, solver%control, &
                                 solver%info)
    outcome = outcome_of(status)
    if (outcome == solver_ok) solver%memory = solver%info(info_peak_estimate) &
                                              *solver%info(info_unit)
  end subroutine analyse

  !> Lets OpenBLAS take its working memory as long as there is some: it waits for ever when it needs
  !! it and there is none. It keeps what it has got.
  subroutine take_blas_buffer(outcome)
    integer, intent(out) :: outcome !! solver_ok or solver_memory
    real(c_double) :: a(1, 1), b(1, 1)

    outcome = solver_ok
    if (has_buffer) return
    if (.not. has_room(blas_buffer)) then
      outcome = solver_memory
      return
    end if
    a = 1.0_c_double
    b = 1.0_c_double
    call dtrsm("L", "U", "N", "N", 1_c_int, 1_c_int, 1.0_c_double, a, 1_c_int, b, 1_c_int)
    has_buffer = .true.
  end subroutine take_blas_buffer

  !> Factorises a matrix whose pattern has been analysed.
  !! Singular: a zero pivot, or pivots whose ratio leaves no digit, or values that are not finite.
  subroutine factorize(solver, matrix, outcome)
    type(linear_solver_t), intent(inout) :: solver !! analysed; receives the factors
    type(csc_matrix_t), intent(in) :: matrix       !! same pattern as in `analyse`
    integer, intent(out) :: outcome                !! solver_*
    integer(ip) :: status

    outcome = solver_ok
    if (matrix%n == 0) return
    if (c_associated(solver%numeric)) call umfpack_dl_free_numeric(solver%numeric)
    solver%rcond = 0.0_dp
    outcome = solver_singular
    if (.not. all(ieee_is_finite(matrix%val))) return
    solver%n_factorizations = solver%n_factorizations + 1
    if (solver%by_mumps) then
      outcome = outcome_of_mumps(mumps_factorize(solver%mumps, matrix%val, solver%rcond))
    else
      status = umfpack_dl_numeric(matrix%col_ptr, matrix%row, matrix%val, solver%symbolic, &
                                  solver%numeric, solver%control, solver%info)
      solver%rcond = solver%info(info_rcond)
      solver%most_memory = max(solver%most_memory, solver%info(info_peak)*solver%info(info_unit))
      outcome = outcome_of(status)
    end if
    if (outcome == solver_ok .and. .not. solver%rcond > smallest_rcond) outcome = solver_singular
  end subroutine factorize

  !> Solves A x = rhs with the factors of the last factorisation.
  subroutine solve(solver, matrix, rhs, x, outcome)
    type(linear_solver_t), intent(inout) :: solver !! factorised
    type(csc_matrix_t), intent(in) :: matrix       !! A, as factorised
    real(dp), intent(in)  :: rhs(:)                !! (n)
    real(dp), intent(out) :: x(:)                  !! (n)
    integer, intent(out)  :: outcome               !! solver_*
    integer(ip) :: status

    outcome = solver_ok
    if (matrix%n == 0) return
    if (solver%by_mumps) then
      x = rhs
      outcome = outcome_of_mumps(mumps_solve(solver%mumps, x))
    else
      status = umfpack_dl_solve(system_a, matrix%col_ptr, matrix%row, matrix%val, x, rhs, &
                                solver%numeric, solver%control, solver%info)
      outcome = outcome_of(status)
    end if
    if (outcome == solver_ok .and. .not. all(ieee_is_finite(x))) outcome = solver_not_finite
  end subroutine solve

  !> Whether there is an analysis, so that a matrix can be factorised.
  pure function is_analysed(solver) result(is_there)
    type(linear_solver_t), intent(in) :: solver
    logical :: is_there

    is_there = c_associated(solver%symbolic) .or. c_associated(solver%mumps)
  end function is_analysed

  !> Whether there are factors to solve with.
  pure function has_factors(solver) result(are_there)
    type(linear_solver_t), intent(in) :: solver
    logical :: are_there

    are_there = c_associated(solver%numeric)
  end function has_factors

  !> Work of the last factorisation, counted and not timed, so that it is the same in every run.
  !! Source: theory.md (15h).
  pure real(dp) function work_of_factors(solver, matrix) result(work)
    type(linear_solver_t), intent(in) :: solver !! factorised
    type(csc_matrix_t), intent(in) :: matrix

    work = solver%info(info_flops)/flops_per_entry + passes*solver%info(info_entries) &
           + per_column*real(matrix%n, dp)
  end function work_of_factors

  !> Work of a solution with the factors and a product with the matrix. Source: theory.md (15h).
  pure real(dp) function work_of_solution(solver, matrix) result(work)
    type(linear_solver_t), intent(in) :: solver !! factorised
    type(csc_matrix_t), intent(in) :: matrix

    work = solver%info(info_entries) + real(matrix%nnz, dp)
  end function work_of_solution

  !> Releases the handles; harmless when there are none. Counts stay, statistics go.
  subroutine free_solver(solver)
    type(linear_solver_t), intent(inout) :: solver !! without handles afterwards

    if (c_associated(solver%numeric)) call umfpack_dl_free_numeric(solver%numeric)
    if (c_associated(solver%symbolic)) call umfpack_dl_free_symbolic(solver%symbolic)
    call mumps_close(solver%mumps)
    solver%numeric = c_null_ptr
    solver%symbolic = c_null_ptr
    solver%info = 0.0_dp
    solver%mumps = c_null_ptr
  end subroutine free_solver

  !> Whether this program was built with MUMPS.
  logical function has_mumps() result(has)
    has = mumps_is_there() == 1_c_int
  end function has_mumps

  !> Takes MUMPS or UMFPACK from now on; what the other one has made is released.
  subroutine choose_library(solver, by_mumps)
    type(linear_solver_t), intent(inout) :: solver !! without analysis if it is another one
    logical, intent(in) :: by_mumps                !! only where has_mumps()

    if (solver%by_mumps .neqv. by_mumps) call free_solver(solver)
    solver%by_mumps = by_mumps
  end subroutine choose_library

  !> Outcome that belongs to a status of MUMPS.
  pure function outcome_of_mumps(status) result(outcome)
    integer(c_int), intent(in) :: status !! of mpm_mumps_binding
    integer :: outcome                   !! solver_*

    select case (status)
    case (mumps_ok)
      outcome = solver_ok
    case (mumps_singular)
      outcome = solver_singular
    case default
      outcome = solver_memory
    end select
  end function outcome_of_mumps

  !> Outcome that belongs to a status of UMFPACK.
  pure function outcome_of(status) result(outcome)
    integer(ip), intent(in) :: status !! return value of an umfpack_dl_* function
    integer :: outcome                !! solver_*

    select case (status)
    case (status_ok)
      outcome = solver_ok
    case (status_out_of_memory, status_ordering_failed) ! METIS and CHOLMOD do not say why
      outcome = solver_memory
    case default
      outcome = solver_singular
    end select
  end function outcome_of

end module mpm_linear_solver
