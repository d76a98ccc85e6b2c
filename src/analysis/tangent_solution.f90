!> The linear system of a correction: how accurately it is solved, and by which method.
module mpm_tangent_solution
  use mpm_kinds, only: dp
  use mpm_linear_method, only: method_recycled
  use mpm_linear_solver, only: factorize, solve, solver_ok
  use mpm_recycled_solver, only: accuracy_t, forget_factors, renew_factors, solve_recycled
  use mpm_system, only: system_t
  implicit none
  private
  public :: forcing_t, choose_accuracy, factorize_again, solve_tangent

  real(dp), parameter :: blind = 1.0e-6_dp   !! relative residual of a first solution from rest
  real(dp), parameter :: first = 0.01_dp     !! of a first solution from the last increment
  real(dp), parameter :: largest = 0.1_dp    !! of any solution
  real(dp), parameter :: digits = 10.0_dp    !! of solutions that are to be exact
  real(dp), parameter :: factor = 0.9_dp     !! on the square of the fall of the last correction
  ! Where no point flows, and where some do: digits are worth less then.
  real(dp), parameter :: square(2) = [0.1_dp, 1.0_dp] !! on the square of the residual
  real(dp), parameter :: of_forces(2) = [1.0e-3_dp, 1.0e-2_dp] !! largest residual over the forces
  real(dp), parameter :: below = 0.01_dp     !! least one over the tolerance of Newton's method
  real(dp), parameter :: settled = 0.2_dp    !! fall of the residual that lets new factors pay

  !> What decides how accurately the next system is solved.
  type :: forcing_t
    logical  :: exactly = .false.  !! all solutions with all digits
    logical  :: begun = .false.    !! there was a correction before
    logical  :: gave_up = .false.  !! older factors were tried in vain for it
    real(dp) :: norm = 0.0_dp      !! of Newton's residual before that one, 0 if unknown [force]
    type(accuracy_t) :: accuracy   !! asked of the next solution
  end type forcing_t

contains

  !> Accuracy of the next solution: digits that the correction is worth, by the fall of the
  !! residual before (Eisenstat and Walker) and by its own size. Source: theory.md (15g).
  pure subroutine choose_accuracy(forcing, norm_rhs, norm, residual, flows, tolerance)
    type(forcing_t), intent(inout) :: forcing
    real(dp), intent(in) :: norm_rhs  !! of the right-hand side [force]
    real(dp), intent(in) :: norm      !! of Newton's residual [force]; 0: it says nothing here
    real(dp), intent(in) :: residual  !! the same, relative [-]
    logical, intent(in)  :: flows     !! there are points in plastic flow
    real(dp), intent(in) :: tolerance !! that it must reach [-]
    real(dp) :: eta, scale
    integer  :: i

    associate (accuracy => forcing%accuracy)
      if (forcing%exactly) then
        accuracy = accuracy_t(goal=norm_rhs*10.0_dp**(-digits), afresh=.true.)
      else if (.not. (norm > 0.0_dp .and. residual > 0.0_dp)) then
        accuracy = accuracy_t(goal=blind*norm_rhs, ahead=0.0_dp, decides=.false.)
      else
        eta = first
        accuracy%decides = .true.
        accuracy%afresh = .false.
        if (forcing%begun) then
          eta = factor
          if (norm < forcing%norm) eta = factor*(norm/forcing%norm)**2
          accuracy%decides = norm < settled*forcing%norm
          accuracy%afresh = forcing%gave_up .and. .not. accuracy%decides
        end if
        scale = norm/residual
        i = merge(2, 1, flows)
        eta = min(eta, square(i)*residual)
        if (eta*residual > of_forces(i)) eta = of_forces(i)/residual
        accuracy%goal = min(largest*norm_rhs, max(eta*norm_rhs, below*tolerance*scale))
        accuracy%ahead = max(0.0_dp, log10(residual/max(below*tolerance, epsilon(norm))))
      end if
    end associate
    forcing%begun = .true.
    forcing%norm = norm
  end subroutine choose_accuracy

  !> Solves for a correction. What it took is in system%recycler, also with the direct methods.
  subroutine solve_tangent(x, system, rhs, accuracy, method, outcome)
    real(dp), intent(out) :: x(:)            !! (n)  correction [length]
    type(system_t), intent(inout) :: system  !! with tangent and analysis; gets new factors or not
    real(dp), intent(in) :: rhs(:)           !! (n) [force]
    type(accuracy_t), intent(in) :: accuracy !! of the recycling method
    integer, intent(in)  :: method           !! method_* of the deck
    integer, intent(out) :: outcome          !! solver_*
    real(dp) :: clock(3)

    associate (recycler => system%recycler)
      if (method == method_recycled .and. system%dofs%n > 0) then
        call solve_recycled(recycler, x, system%solver, system%tangent, rhs, accuracy, outcome)
        return
      end if
      call forget_factors(recycler)
      call cpu_time(clock(1))
      call factorize(system%solver, system%tangent, outcome)
      call cpu_time(clock(2))
      if (outcome == solver_ok) call solve(system%solver, system%tangent, rhs, x, outcome)
      call cpu_time(clock(3))
      recycler%is_new = .true.
      recycler%n_iterations = 0
      recycler%seconds = clock(2:3) - clock(1:2)
    end associate
  end subroutine solve_tangent

  !> Makes factors of the tangent that was solved last, unless they are there.
  subroutine factorize_again(system, outcome)
    type(system_t), intent(inout) :: system !! with the tangent
    integer, intent(out) :: outcome         !! solver_*

    outcome = solver_ok
    if (system%recycler%is_new .or. system%dofs%n == 0) return
    call renew_factors(system%recycler, system%solver, system%tangent, outcome)
  end subroutine factorize_again

end module mpm_tangent_solution
