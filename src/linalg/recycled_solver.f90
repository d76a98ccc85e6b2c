!> Factors that are kept over a sequence of similar matrices, as the preconditioner of GMRES, and
!! the rule when to make new ones. Source: theory.md (15h), (15i).
!!
!! They may be of single precision, which takes half the time and memory. Where that does not serve,
!! UMFPACK makes them from then on.
!!
!! Every decision rests on counts, none on time: a run that is repeated, or goes on after a restart,
!! makes new factors at the same places.
module mpm_recycled_solver
  use mpm_checksum, only: checksum_of_longs, checksum_text
  use mpm_csc_matrix, only: csc_matrix_t, zero_values
  use mpm_gmres, only: gmres_converged, gmres_t, open_gmres, solve_by_gmres
  use mpm_kinds, only: dp, ip
  use mpm_linear_solver, only: analyse, choose_library, factorize, has_factors, is_analysed, &
    is_exact, library_umfpack, linear_solver_t, solve, solver_memory, solver_ok, work_of_factors, &
    work_of_solution
  implicit none
  private
  public :: accuracy_t, factor_memory_t, recycler_t
  public :: accept_factors, accepted_factors, forget_factors, prepare_factors, renew_factors
  public :: restore_factors, solve_recycled

  integer, parameter  :: n_largest = 40            !! directions of GMRES between two restarts
  real(dp), parameter :: growth = 1.5_dp           !! of the work per digit until an increment ends
  real(dp), parameter :: fewest_digits = 1.0e-3_dp !! that count as asked for
  real(dp), parameter :: least_ratio = 5.0e-5_dp   !! of pivots of single precision: below it they
                                                   !! do not tell whether the matrix is singular

  !> What is wanted of a solution.
  type :: accuracy_t
    real(dp) :: goal = 0.0_dp  !! norm of its residual [as the right-hand side]
    real(dp) :: ahead = 0.0_dp !! decimal digits still to gain in this and the solutions that
                               !! follow soon, 0 if unknown
    logical  :: decides = .true. !! new factors may be made because they are cheaper
    logical  :: afresh = .false. !! new factors are made, whatever those in use would cost
  end type accuracy_t

  !> Which factors are in use and what they have cost; enough to make them again.
  type :: factor_memory_t
    logical  :: is_there = .false.   !! there are factors, or values to make them from
    logical  :: needs_double = .false. !! single precision did not serve
    integer  :: n = 0                !! equations
    integer  :: nnz = 0              !! entries
    character(8) :: pattern = ""     !! checksum of the pattern
    real(dp) :: work = 0.0_dp        !! of the factorisation and the solutions [entries read]
    real(dp) :: digits = 0.0_dp      !! gained by all solutions
    real(dp) :: rate = 0.0_dp        !! work per digit of the last solution, 0 after a direct one
    real(dp), allocatable :: val(:)  !! (nnz)  the matrix that was factorised
  end type factor_memory_t

  !> Factors in use, those that a restart begins with, and what the last solution took.
  type :: recycler_t
    type(factor_memory_t) :: now      !! in use
    type(factor_memory_t) :: accepted !! after the last accepted increment; its values are in now
                                      !! as long as those are the same
    logical  :: changed = .false.     !! now has other values than accepted
    type(gmres_t) :: gmres            !! work space
    integer  :: n_iterations = 0      !! of GMRES in the last solution, with old and new factors
    logical  :: is_new = .false.      !! the factors are of the matrix solved last
    logical  :: gave_up = .false.     !! older factors were tried in vain in the last solution
    real(dp) :: seconds(2) = 0.0_dp   !! CPU of the last solution: factorisation, the rest [s]
  end type recycler_t

contains

  !> Makes ready for matrices of a pattern. Analysis and factors stay when it is that of the
  !! matrices before; after a restart the factors are made again.
  subroutine prepare_factors(recycler, solver, matrix, outcome)
    type(recycler_t), intent(inout) :: recycler
    type(linear_solver_t), intent(inout) :: solver !! analysed afterwards
    type(csc_matrix_t), intent(inout) :: matrix    !! new pattern, values zero in and out
    integer, intent(out) :: outcome                !! solver_*
    character(8) :: pattern
    logical :: is_same

    outcome = solver_ok
    pattern = checksum_text(checksum_of_longs(checksum_of_longs(0_ip, matrix%col_ptr), matrix%row))
    is_same = recycler%now%n == matrix%n .and. recycler%now%nnz == matrix%nnz &
              .and. recycler%now%pattern == pattern
    if (is_same .and. is_analysed(solver)) return
    call analyse(solver, matrix, outcome)
    if (.not. is_same) call forget_factors(recycler)
    recycler%gmres = gmres_t()
    recycler%now%n = matrix%n
    recycler%now%nnz = int(min(matrix%nnz, int(huge(1), ip)))
    recycler%now%pattern = pattern
    if (outcome /= solver_ok .or. .not. recycler%now%is_there) return
    matrix%val = recycler%now%val
    call factorize(solver, matrix, outcome)
    call zero_values(matrix)
    if (outcome /= solver_ok) call forget_factors(recycler)
    outcome = solver_ok
  end subroutine prepare_factors

  !> Solves A x = rhs: with the factors in use and GMRES, or with new factors where those are
  !! cheaper or GMRES does not get there.
  subroutine solve_recycled(recycler, x, solver, matrix, rhs, accuracy, outcome)
    type(recycler_t), intent(inout) :: recycler
    real(dp), intent(out) :: x(:)                  !! (n)
    type(linear_solver_t), intent(inout) :: solver !! prepared
    type(csc_matrix_t), intent(in) :: matrix       !! A
    real(dp), intent(in) :: rhs(:)                 !! (n)
    type(accuracy_t), intent(in) :: accuracy
    integer, intent(out) :: outcome                !! solver_*
    real(dp) :: clock(2), digits, norm
    logical  :: solved !! by GMRES

    recycler%seconds = 0.0_dp
    recycler%n_iterations = 0
    recycler%is_new = .false.
    recycler%gave_up = .false.
    norm = norm2(rhs)
    digits = fewest_digits
    if (norm > 0.0_dp) digits = max(digits, log10(norm) - log10(max(accuracy%goal, tiny(norm))))
    outcome = solver_ok
    solved = .false.
    call cpu_time(clock(1))
    ! Nothing on the right-hand side would hide a singular matrix.
    if (norm > 0.0_dp .and. serve_on(recycler%now, solver, matrix, accuracy)) then
      call iterate(recycler, x, solver, matrix, rhs, accuracy%goal, solved)
      recycler%gave_up = .not. solved
    end if
    if (.not. solved) then
      call solve_afresh(recycler, x, solver, matrix, rhs, accuracy%goal, outcome)
      solved = outcome == solver_ok .and. .not. is_exact(solver)
    end if
    call cpu_time(clock(2))
    recycler%seconds(2) = clock(2) - clock(1) - recycler%seconds(1)
    recycler%now%digits = recycler%now%digits + digits
    if (solved) recycler%now%rate = recycler%gmres%n_iterations*work_of_solution(solver, matrix) &
                                    /digits
  end subroutine solve_recycled

  !> Solves with factors of the matrix itself; those of single precision need some iterations.
  subroutine solve_afresh(recycler, x, solver, matrix, rhs, goal, outcome)
    type(recycler_t), intent(inout) :: recycler
    real(dp), intent(out) :: x(:)                  !! (n)
    type(linear_solver_t), intent(inout) :: solver !! prepared
    type(csc_matrix_t), intent(in) :: matrix       !! A
    real(dp), intent(in) :: rhs(:)                 !! (n)
    real(dp), intent(in) :: goal                   !! norm of the residual
    integer, intent(out) :: outcome                !! solver_*
    logical :: solved

    call renew_factors(recycler, solver, matrix, outcome)
    if (outcome == solver_ok .and. .not. is_exact(solver)) then
      call iterate(recycler, x, solver, matrix, rhs, goal, solved)
      if (solved) return
      call leave_single(recycler, solver, matrix, outcome)
    end if
    if (outcome /= solver_ok) return
    call solve(solver, matrix, rhs, x, outcome)
    recycler%now%work = recycler%now%work + work_of_solution(solver, matrix)
  end subroutine solve_afresh

  !> Whether the factors in use serve one more solution. Source: theory.md (15i).
  pure function serve_on(factors, solver, matrix, accuracy) result(serves)
    type(factor_memory_t), intent(in) :: factors
    type(linear_solver_t), intent(in) :: solver !! with the factors
    type(csc_matrix_t), intent(in) :: matrix
    type(accuracy_t), intent(in) :: accuracy    !! of the solution
    logical  :: serves
    real(dp) :: afresh

    serves = factors%is_there .and. has_factors(solver) .and. .not. accuracy%afresh
    if (.not. (serves .and. accuracy%decides)) return
    afresh = work_of_factors(solver, matrix) + accuracy%ahead*work_of_solution(solver, matrix)
    serves = growth*factors%rate*accuracy%ahead <= afresh &
               .and. factors%rate*factors%digits <= factors%work
  end function serve_on

  !> GMRES, for at most the work of new factors.
  subroutine iterate(recycler, x, solver, matrix, rhs, goal, solved)
    type(recycler_t), intent(inout) :: recycler
    real(dp), intent(out) :: x(:)                  !! (n)
    type(linear_solver_t), intent(inout) :: solver !! with the factors
    type(csc_matrix_t), intent(in) :: matrix       !! A
    real(dp), intent(in) :: rhs(:)                 !! (n)
    real(dp), intent(in) :: goal                   !! norm of the residual
    logical, intent(out) :: solved
    integer  :: outcome
    real(dp) :: once

    once = work_of_solution(solver, matrix)
    if (recycler%gmres%n /= matrix%n) call open_gmres(recycler%gmres, matrix, n_largest)
    recycler%gmres%n_iterations = max(1, int(work_of_factors(solver, matrix)/once))
    call solve_by_gmres(recycler%gmres, x, solver, matrix, rhs, goal, outcome)
    recycler%n_iterations = recycler%n_iterations + recycler%gmres%n_iterations
    recycler%now%work = recycler%now%work + recycler%gmres%n_iterations*once
    solved = outcome == gmres_converged
  end subroutine iterate

  !> Factorises a matrix and remembers it. Source: theory.md 7.1.
  subroutine renew_factors(recycler, solver, matrix, outcome)
    type(recycler_t), intent(inout) :: recycler
    type(linear_solver_t), intent(inout) :: solver !! prepared
    type(csc_matrix_t), intent(in) :: matrix
    integer, intent(out) :: outcome                !! solver_*

    recycler%is_new = .true.
    call make_factors(recycler, solver, matrix, outcome)
    if (is_exact(solver) .or. outcome == solver_memory) return
    if (outcome /= solver_ok .or. solver%rcond < least_ratio) then
      call leave_single(recycler, solver, matrix, outcome)
    end if
  end subroutine renew_factors

  !> Single precision does not serve: factors by UMFPACK, now and, if it can make them, later.
  subroutine leave_single(recycler, solver, matrix, outcome)
    type(recycler_t), intent(inout) :: recycler
    type(linear_solver_t), intent(inout) :: solver !! of single precision; exact afterwards
    type(csc_matrix_t), intent(in) :: matrix
    integer, intent(out) :: outcome                !! solver_*

    call choose_library(solver, library_umfpack)
    call analyse(solver, matrix, outcome)
    if (outcome == solver_ok) call make_factors(recycler, solver, matrix, outcome)
    recycler%now%needs_double = outcome == solver_ok
  end subroutine leave_single

  !> Factors in place of those in use.
  subroutine make_factors(recycler, solver, matrix, outcome)
    type(recycler_t), intent(inout) :: recycler
    type(linear_solver_t), intent(inout) :: solver !! analysed
    type(csc_matrix_t), intent(in) :: matrix
    integer, intent(out) :: outcome                !! solver_*
    real(dp) :: clock(2)

    call forget_factors(recycler)
    recycler%gmres = gmres_t() ! the factors need the room
    call cpu_time(clock(1))
    call factorize(solver, matrix, outcome)
    call cpu_time(clock(2))
    recycler%seconds(1) = recycler%seconds(1) + clock(2) - clock(1)
    if (outcome /= solver_ok .or. matrix%nnz > int(huge(1), ip)) return
    recycler%now%val = matrix%val
    recycler%now%is_there = .true.
    recycler%now%work = work_of_factors(solver, matrix)
  end subroutine make_factors

  !> The factors in use serve no more, only those of the last accepted increment are remembered.
  pure subroutine forget_factors(recycler)
    type(recycler_t), intent(inout) :: recycler

    if (.not. recycler%changed .and. recycler%now%is_there) then
      call move_alloc(recycler%now%val, recycler%accepted%val)
    end if
    recycler%changed = .true.
    if (allocated(recycler%now%val)) deallocate (recycler%now%val)
    recycler%now%is_there = .false.
    recycler%now%work = 0.0_dp
    recycler%now%digits = 0.0_dp
    recycler%now%rate = 0.0_dp
  end subroutine forget_factors

  !> After an accepted increment: a restart begins with the factors in use.
  pure subroutine accept_factors(recycler)
    type(recycler_t), intent(inout) :: recycler

    if (allocated(recycler%accepted%val)) deallocate (recycler%accepted%val)
    recycler%changed = .false.
    recycler%accepted = without_values(recycler%now)
  end subroutine accept_factors

  !> All of a memory but the values.
  pure function without_values(factors) result(short)
    type(factor_memory_t), intent(in) :: factors
    type(factor_memory_t) :: short

    short = factor_memory_t(factors%is_there, factors%needs_double, factors%n, factors%nnz, &
                            factors%pattern, factors%work, factors%digits, factors%rate)
  end function without_values

  !> What a restart file keeps.
  pure function accepted_factors(recycler) result(factors)
    type(recycler_t), intent(in) :: recycler
    type(factor_memory_t) :: factors

    factors = recycler%accepted
    if (factors%is_there .and. .not. recycler%changed) factors%val = recycler%now%val
  end function accepted_factors

  !> Goes on from a restart file.
  pure subroutine restore_factors(recycler, factors)
    type(recycler_t), intent(inout) :: recycler
    type(factor_memory_t), intent(in) :: factors

    recycler%now = factors
    call accept_factors(recycler)
  end subroutine restore_factors

end module mpm_recycled_solver
