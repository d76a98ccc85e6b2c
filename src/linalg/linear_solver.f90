!> Direct solution of sparse linear systems: the one seam behind which solvers are exchanged.
module mpm_linear_solver
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_long, &
    c_null_ptr, c_ptr
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_kinds, only: dp, ip
  use mpm_memory, only: has_room
  use mpm_mumps_binding, only: mumps_analyse, mumps_bytes, mumps_close, mumps_entries, &
    mumps_factorize, mumps_flops, mumps_found, mumps_is_there, mumps_ok, mumps_singular, mumps_solve
  use mpm_node_ordering, only: order_by_nodes
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
  public :: choose_library, has_factors, has_mumps, is_analysed, is_exact, work_of_factors, &
            work_of_solution
  public :: library_mumps, library_single, library_umfpack
  public :: solver_ok, solver_singular, solver_memory, solver_not_finite

  integer, parameter :: solver_ok = 0       !! done
  integer, parameter :: solver_singular = 1 !! matrix singular to machine precision, or not finite
  integer, parameter :: solver_memory = 2   !! out of memory
  integer, parameter :: solver_not_finite = 3 !! the solution holds infinity or no numbers

  integer, parameter :: library_umfpack = 0 !! UMFPACK
  integer, parameter :: library_mumps = 1   !! MUMPS
  integer, parameter :: library_single = 2  !! MUMPS with factors of single precision: preconditioners

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
    logical     :: has_mumps_factors = .false.             !! there are factors of MUMPS
    integer     :: library = library_umfpack               !! library_*
    real(dp)    :: control(0:umfpack_control - 1) = 0.0_dp !! controls of UMFPACK
    real(dp)    :: info(0:umfpack_info - 1) = 0.0_dp       !! statistics of UMFPACK's last call
    real(dp)    :: memory = 0.0_dp      !! estimate for a factorisation by the last analysis, 0 if
                                        !! unknown [bytes]
    real(dp)    :: most_memory = 0.0_dp !! of all factorisations so far, as the library reports [bytes]
    real(dp)    :: entries = 0.0_dp     !! of the factors; before there are any, of MUMPS expected
    real(dp)    :: flops = 0.0_dp       !! of the factorisation, likewise
    real(dp)    :: rcond = 1.0_dp       !! smallest over largest pivot, last factorisation [-]
    integer     :: n_analyses = 0       !! analyses so far
    integer     :: n_factorizations = 0 !! factorisations so far
  end type linear_solver_t

  ! Work, in entries of the factors that are read from memory. Measured: theory.md (15h).
  real(dp), parameter :: flops_per_entry = 65.0_dp !! of a factorisation, in the time of one entry
  real(dp), parameter :: passes = 16.0_dp          !! over the factors while they are made
  real(dp), parameter :: per_column = 1500.0_dp    !! of a factorisation, whatever its size
  real(dp), parameter :: per_unknown = 150.0_dp    !! of a solution, likewise

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

    call free_solver(solver)
    outcome = solver_ok
    solver%memory = 0.0_dp
    solver%entries = 0.0_dp
    solver%flops = 0.0_dp
    if (matrix%n == 0) return
    ! More BLAS threads would make sums depend on their number and fight with OpenMP.
    call openblas_set_num_threads(1_c_int)
    call take_blas_buffer(outcome)
    if (outcome /= solver_ok) return
    solver%n_analyses = solver%n_analyses + 1
    if (solver%library /= library_umfpack) then
      call analyse_by_mumps(solver, matrix, outcome)
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

  !> The same by MUMPS.
  subroutine analyse_by_mumps(solver, matrix, outcome)
    type(linear_solver_t), intent(inout) :: solver !! receives the analysis
    type(csc_matrix_t), intent(in) :: matrix       !! pattern
    integer, intent(out) :: outcome                !! solver_*
    real(c_double) :: found(0:mumps_found - 1)
    integer(c_int) :: code
    integer(c_int), allocatable :: place(:)
    character(80) :: reason
    integer :: problem
    logical :: is_ordered

    outcome = solver_memory
    allocate (place(matrix%n), stat=problem, errmsg=reason)
    if (problem /= 0) return
    call order_by_nodes(place, matrix, is_ordered)
    if (.not. is_ordered) return
    solver%mumps = mumps_analyse(merge(1_c_int, 0_c_int, solver%library == library_single), &
                                 int(matrix%n, c_int), int(matrix%nnz, c_long), matrix%col_ptr, &
                                 matrix%row, place, code, found)
    solver%memory = found(mumps_bytes)
    solver%entries = found(mumps_entries)
    solver%flops = found(mumps_flops)
    outcome = outcome_of_mumps(code)
  end subroutine analyse_by_mumps

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
    if (solver%library /= library_umfpack) then
      call factorize_by_mumps(solver, matrix, outcome)
    else
      status = umfpack_dl_numeric(matrix%col_ptr, matrix%row, matrix%val, solver%symbolic, &
                                  solver%numeric, solver%control, solver%info)
      solver%rcond = solver%info(info_rcond)
      solver%entries = solver%info(info_entries)
      solver%flops = solver%info(info_flops)
      solver%most_memory = max(solver%most_memory, solver%info(info_peak)*solver%info(info_unit))
      outcome = outcome_of(status)
    end if
    if (outcome == solver_ok .and. .not. solver%rcond > smallest_rcond) outcome = solver_singular
  end subroutine factorize

  !> The same by MUMPS.
  subroutine factorize_by_mumps(solver, matrix, outcome)
    type(linear_solver_t), intent(inout) :: solver !! analysed; receives the factors
    type(csc_matrix_t), intent(in) :: matrix       !! as in `factorize`
    integer, intent(out) :: outcome                !! solver_*
    real(c_double) :: found(0:mumps_found - 1)

    outcome = outcome_of_mumps(mumps_factorize(solver%mumps, matrix%val, solver%rcond, found))
    solver%has_mumps_factors = outcome == solver_ok
    solver%entries = found(mumps_entries)
    solver%flops = found(mumps_flops)
    solver%most_memory = max(solver%most_memory, found(mumps_bytes))
  end subroutine factorize_by_mumps

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
    if (solver%library /= library_umfpack) then
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

    are_there = c_associated(solver%numeric) .or. solver%has_mumps_factors
  end function has_factors

  !> Whether a solution has all digits that the matrix allows.
  pure logical function is_exact(solver)
    type(linear_solver_t), intent(in) :: solver

    is_exact = solver%library /= library_single
  end function is_exact

  !> Work of the last factorisation, counted and not timed, so that it is the same in every run.
  !! Source: theory.md (15h).
  pure real(dp) function work_of_factors(solver, matrix) result(work)
    type(linear_solver_t), intent(in) :: solver !! factorised
    type(csc_matrix_t), intent(in) :: matrix

    work = solver%flops/flops_per_entry + passes*solver%entries + per_column*real(matrix%n, dp)
  end function work_of_factors

  !> Work of a solution with the factors and a product with the matrix. Source: theory.md (15h).
  pure real(dp) function work_of_solution(solver, matrix) result(work)
    type(linear_solver_t), intent(in) :: solver !! factorised
    type(csc_matrix_t), intent(in) :: matrix

    work = solver%entries + real(matrix%nnz, dp) + per_unknown*real(matrix%n, dp)
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
    solver%has_mumps_factors = .false.
  end subroutine free_solver

  !> Whether this program was built with MUMPS.
  pure logical function has_mumps() result(has)
    has = mumps_is_there() == 1_c_int
  end function has_mumps

  !> Takes a library from now on; what another one has made is released.
  subroutine choose_library(solver, library)
    type(linear_solver_t), intent(inout) :: solver !! without analysis if it is another one
    integer, intent(in) :: library                 !! library_*; MUMPS only where has_mumps()

    if (solver%library /= library) call free_solver(solver)
    solver%library = library
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
