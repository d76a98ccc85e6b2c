!> Newton's method for one increment.
module mpm_equilibrium
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_assembly, only: apply_tangent, assemble_tangent
  use mpm_dof_map, only: add_solution, gather_free
  use mpm_eigenvalues, only: find_eigenvalues
  use mpm_ghost_penalty, only: add_ghost_force, add_ghost_tangent
  use mpm_interruption, only: received_signal
  use mpm_iteration_watch, only: iteration_watch_t
  use mpm_kinds, only: dp
  use mpm_kinematics, only: find_largest_stretch
  use mpm_linear_method, only: chosen_method, method_automatic
  use mpm_linear_solver, only: solver_memory, solver_not_finite, solver_ok
  use mpm_newton_report, only: close_report, newton_report_t, open_report, outcome_converged, &
    outcome_interrupted, outcome_inverted, outcome_iterations, outcome_material, outcome_memory, &
    outcome_not_finite, outcome_singular, outcome_stagnated, outcome_stretched
  use mpm_residual_norm, only: force_scale, node_of_largest, relative
  use mpm_system, only: body_t, evaluate, evaluate_force, evaluation_inverted, evaluation_ok, &
    system_t
  use mpm_tangent_solution, only: choose_accuracy, factorize_again, forcing_t, solve_tangent
  implicit none
  private
  public :: find_equilibrium, method_for, newton_settings_t

  real(dp), parameter :: near = 0.1_dp !! largest residual of a prediction worth a start [-]

  !> Controls of Newton's method (*CONTROLS).
  type :: newton_settings_t
    real(dp) :: tolerance = 1.0e-9_dp !! residual over external force and reactions [-]
    integer  :: max_iterations = 20   !! corrections in one increment
    integer  :: max_backtracks = 8    !! halvings of one correction
    logical  :: eigenvalues = .false. !! look for extreme eigenvalues of the tangent in the end
    logical  :: prediction = .true.   !! start from the last increment where that is near
    real(dp) :: max_stretch = 2.0_dp  !! largest |ln(principal stretch)| in one increment [-]
    integer  :: linear_solver = method_automatic !! method_*
    integer  :: least_recycled = huge(1) !! unknowns from which automatic means recycling
    logical  :: repeats = .false.     !! an attempt that fails with kept factors is made once more
                                      !! with exact corrections
  end type newton_settings_t

  !> The state of Newton's method between two corrections.
  type :: newton_state_t
    real(dp), allocatable :: residual(:) !! (n)  f_ext - f_int of the unknowns [force]
    real(dp), allocatable :: x(:)        !! (n)  correction [length]
    logical  :: exactly = .false.        !! all corrections have all digits
    logical  :: moved = .false.          !! the start already has the prescribed displacements
    real(dp) :: norm = 0.0_dp            !! of the residual [force]
    real(dp) :: stiffness = 0.0_dp       !! largest entry of the tangent [force/length]
    type(forcing_t) :: forcing           !! accuracy of the corrections
  end type newton_state_t

contains

  !> Newton's method with backtracking. On success system%u, system%kinematics and system%f_int hold
  !! the solution; on failure nothing converged has changed. Source: theory.md (15).
  subroutine find_equilibrium(system, report, body, settings, watch)
    type(system_t), intent(inout)       :: system  !! dofs, pattern, f_ext of this increment are set
    type(newton_report_t), intent(out)  :: report
    type(body_t), intent(in)            :: body
    type(newton_settings_t), intent(in) :: settings
    class(iteration_watch_t), intent(inout), optional :: watch !! told of iterations
    type(newton_state_t) :: newton
    integer :: n_before
    logical :: needed_double, predicts

    needed_double = system%recycler%now%needs_double
    call open_report(report, settings%max_iterations)
    allocate (newton%residual(system%dofs%n), newton%x(system%dofs%n))
    predicts = settings%prediction .and. system%guess_ratio > 0.0_dp
    call start_at_rest(newton, system, report, body, .not. predicts)
    if (predicts) then
      call predict(newton, system, report, body)
      if (report%predicted) call iterate(newton, system, report, body, settings, watch)
    end if
    if (report%predicted .and. may_try_again(report)) then
      n_before = report%n_iterations
      call begin_again(newton, system, report, body, settings)
      report%n_given_up = n_before
    end if
    if (.not. report%predicted) call iterate(newton, system, report, body, settings, watch)
    if (settings%repeats .and. may_try_again(report) .and. any(report%gmres > 0)) then
      n_before = report%n_iterations
      newton%exactly = .true.
      call begin_again(newton, system, report, body, settings)
      report%n_inexact = n_before
      call iterate(newton, system, report, body, settings, watch)
    end if
    if (report%outcome == outcome_converged) call judge_stretch(report, system, settings)
    if (report%outcome == outcome_converged) call judge_tangent(report, system, body, settings)
    if (report%outcome == outcome_converged .and. settings%eigenvalues) then
      call find_eigenvalues(report%eigenvalues, system%solver, system%tangent)
    end if
    report%left_single = system%recycler%now%needs_double .and. .not. needed_double
    report%worst_node = node_of_largest(system)
    call close_report(report)
  end subroutine find_equilibrium

  !> Whether another way to the equilibrium of the increment may do better.
  pure logical function may_try_again(report) result(may)
    type(newton_report_t), intent(in) :: report

    may = all(report%outcome /= [outcome_converged, outcome_interrupted, outcome_memory])
  end function may_try_again

  !> At rest once more, with a report that keeps what was tried before.
  subroutine begin_again(newton, system, report, body, settings)
    type(newton_state_t), intent(inout)  :: newton
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    type(newton_settings_t), intent(in)  :: settings
    real(dp) :: seconds(5)
    integer  :: n_given_up

    n_given_up = report%n_given_up
    seconds = sum(report%seconds, dim=2)
    call open_report(report, settings%max_iterations)
    report%n_given_up = n_given_up
    report%seconds(:, 1) = seconds
    call start_at_rest(newton, system, report, body, .true.)
  end subroutine begin_again

  !> The method that solves the linear systems of a number of unknowns.
  pure integer function method_for(settings, n) result(method)
    type(newton_settings_t), intent(in) :: settings
    integer, intent(in) :: n !! unknowns

    method = chosen_method(settings%linear_solver, n, settings%least_recycled)
  end function method_for

  !> No displacement: the prescribed one comes with the first correction.
  subroutine start_at_rest(newton, system, report, body, with_moduli)
    type(newton_state_t), intent(inout)  :: newton
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    logical, intent(in)                  :: with_moduli !! a correction follows

    report%outcome = outcome_converged
    report%worst_element = 0
    report%worst_point = 0
    newton%moved = .false.
    newton%forcing = forcing_t(exactly=newton%exactly)
    system%u = 0.0_dp
    call measure(newton, system, report, body, 0, with_moduli)
    report%at_rest = report%residual(0)
  end subroutine start_at_rest

  !> Starts with the prescribed displacements and, elsewhere, those of the last increment times
  !! the ratio of the sizes; back to rest when that is far from equilibrium, or farther than rest.
  !! Source: theory.md (15a).
  subroutine predict(newton, system, report, body)
    type(newton_state_t), intent(inout)  :: newton !! at rest
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    real(dp) :: norm_at_rest

    if (report%outcome /= outcome_converged) return
    norm_at_rest = newton%norm
    call gather_free(system%dofs, system%u_last, newton%x)
    system%u = system%dofs%prescribed
    call add_solution(system%dofs, system%guess_ratio*newton%x, system%u)
    call measure(newton, system, report, body, 0, .true.)
    newton%moved = report%outcome == outcome_converged .and. report%residual(0) <= near
    if (newton%moved .and. all(abs(system%dofs%prescribed) <= 0.0_dp)) &
      newton%moved = newton%norm < norm_at_rest
    report%predicted = newton%moved
    if (.not. newton%moved) call start_at_rest(newton, system, report, body, .true.)
  end subroutine predict

  !> Corrections until the residual is small or cannot be made so.
  subroutine iterate(newton, system, report, body, settings, watch)
    type(newton_state_t), intent(inout)  :: newton !! at the start
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    type(newton_settings_t), intent(in)  :: settings
    class(iteration_watch_t), intent(inout), optional :: watch
    integer :: iteration

    do iteration = 1, settings%max_iterations
      if (report%outcome /= outcome_converged) exit
      call correct(newton, system, report, body, settings, iteration)
      if (report%outcome /= outcome_converged) exit
      call step(newton, system, report, body, settings, iteration)
      if (report%outcome /= outcome_converged) exit
      if (report%residual(iteration) <= settings%tolerance) exit
      if (present(watch)) call watch%note_iteration()
      if (iteration == settings%max_iterations) report%outcome = outcome_iterations
      if (received_signal() /= 0) report%outcome = outcome_interrupted
    end do
  end subroutine iterate

  !> Refuses an increment that stretches an element too far. Source: theory.md (15b).
  pure subroutine judge_stretch(report, system, settings)
    type(newton_report_t), intent(inout) :: report
    type(system_t), intent(in)           :: system !! in equilibrium
    type(newton_settings_t), intent(in)  :: settings
    integer :: element

    call find_largest_stretch(report%stretch, element, system%kinematics, system%element)
    if (report%stretch <= settings%max_stretch) return
    report%outcome = outcome_stretched
    report%worst_element = element
  end subroutine judge_stretch

  !> Factors of the last tangent where they matter in themselves: for its eigenvalues, and where
  !! the body went so far that something may not be held.
  subroutine judge_tangent(report, system, body, settings)
    type(newton_report_t), intent(inout) :: report !! converged; perhaps singular
    type(system_t), intent(inout)        :: system
    type(body_t), intent(in)             :: body
    type(newton_settings_t), intent(in)  :: settings
    integer :: outcome

    if (.not. settings%eigenvalues .and. maxval(abs(system%u)) &
        <= maxval(maxval(body%mesh%x, dim=2) - minval(body%mesh%x, dim=2))) return
    call factorize_again(system, outcome)
    if (outcome /= solver_ok) report%outcome = merge(outcome_memory, outcome_singular, &
                                                     outcome == solver_memory)
    if (system%dofs%n > 0) report%rcond = min(report%rcond, system%solver%rcond)
  end subroutine judge_tangent

  !> Tangent, factors and the correction x. The first one from rest carries the prescribed
  !! displacement.
  subroutine correct(newton, system, report, body, settings, iteration)
    type(newton_state_t), intent(inout)  :: newton
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    type(newton_settings_t), intent(in)  :: settings
    integer, intent(in)                  :: iteration
    real(dp), allocatable :: force(:, :), load(:), rhs(:)
    real(dp) :: clock(2)
    integer :: outcome

    report%n_iterations = iteration
    if (.not. system%sums%has_moduli) &
      call measure(newton, system, report, body, iteration - 1, .true.)
    call cpu_time(clock(1))
    call assemble_tangent(system%tangent, system%map, body%mesh, body%patches, system%kinematics, system%sums)
    call add_ghost_tangent(system%tangent, system%map, system%ghost)
    newton%stiffness = maxval(abs(system%tangent%val))
    rhs = newton%residual
    if (iteration == 1 .and. .not. newton%moved) then
      allocate (force, mold=system%u)
      call apply_tangent(force, system%dofs%prescribed, system%map, body%mesh, body%patches, &
                         system%kinematics, system%sums)
      ! The penalty is linear: its force at a displacement is its stiffness times it.
      call add_ghost_force(force, system%ghost, system%dofs%prescribed)
      call gather_free(system%dofs, force, newton%x)
      rhs = rhs - newton%x
    end if
    call cpu_time(clock(2))
    call choose_accuracy(newton%forcing, norm2(rhs), merge(newton%norm, 0.0_dp, &
                         iteration > 1 .or. newton%moved), report%residual(iteration - 1), &
                         report%n_plastic > 0, settings%tolerance)
    call solve_tangent(newton%x, system, rhs, newton%forcing%accuracy, &
                       method_for(settings, system%dofs%n), outcome)
    newton%forcing%gave_up = system%recycler%gave_up
    if (system%dofs%n > 0) report%rcond = min(report%rcond, system%solver%rcond)
    report%seconds(3:5, iteration) = report%seconds(3:5, iteration) &
                                     + [clock(2) - clock(1), system%recycler%seconds]
    report%gmres(iteration) = system%recycler%n_iterations
    report%is_new(iteration) = system%recycler%is_new
    select case (outcome)
    case (solver_ok)
      allocate (load, mold=newton%x)
      call gather_free(system%dofs, system%f_ext, load)
      report%reach = max(report%reach, abs(dot_product(load, newton%x)) &
                         /max(norm2(load), tiny(1.0_dp)/epsilon(1.0_dp)))
    case (solver_memory)
      report%outcome = outcome_memory
    case (solver_not_finite)
      report%outcome = outcome_not_finite
    case default
      report%outcome = outcome_singular
    end select
  end subroutine correct

  !> Applies the correction, halved until the residual falls, but for the one that carries the
  !! prescribed displacement.
  subroutine step(newton, system, report, body, settings, iteration)
    type(newton_state_t), intent(inout)  :: newton
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    type(newton_settings_t), intent(in)  :: settings
    integer, intent(in)                  :: iteration
    real(dp), allocatable :: u(:, :)
    real(dp) :: norm, length
    integer :: n_halved

    u = system%u
    norm = newton%norm
    length = 1.0_dp
    if (iteration == 1 .and. .not. newton%moved) u = u + system%dofs%prescribed
    do n_halved = 0, settings%max_backtracks
      system%u = u
      call add_solution(system%dofs, length*newton%x, system%u)
      report%outcome = outcome_converged
      ! Shorter steps are tried by their residual alone; the one taken gets its moduli later.
      call measure(newton, system, report, body, iteration, n_halved == 0)
      report%backtracks(iteration) = n_halved
      if (iteration == 1 .and. .not. newton%moved) return
      if (report%outcome == outcome_converged) then
        if (newton%norm < norm .or. report%residual(iteration) <= settings%tolerance) return
      end if
      length = 0.5_dp*length
    end do
    if (report%outcome == outcome_converged) report%outcome = outcome_stagnated
  end subroutine step

  !> Evaluates forces at system%u and the residual there, with what a tangent needs or without.
  subroutine measure(newton, system, report, body, iteration, with_moduli)
    type(newton_state_t), intent(inout)  :: newton
    type(system_t), intent(inout)        :: system
    type(newton_report_t), intent(inout) :: report
    type(body_t), intent(in)             :: body
    integer, intent(in)                  :: iteration
    logical, intent(in)                  :: with_moduli
    real(dp) :: before(2)
    integer :: outcome

    before = system%seconds
    if (with_moduli) then
      call evaluate(system, body, outcome)
    else
      call evaluate_force(system, body, outcome)
    end if
    ! The evaluation before the first correction belongs to the first iteration.
    associate (seconds => report%seconds(1:2, max(iteration, 1)))
      seconds = seconds + (system%seconds - before)
    end associate
    if (outcome /= evaluation_ok) then
      report%outcome = merge(outcome_inverted, outcome_material, outcome == evaluation_inverted)
      report%worst_element = system%worst_element
      if (system%worst_point > 0) report%worst_point = body%points%id(system%worst_point)
      return
    end if
    ! Forces of nodes without unknowns too: they are the reactions.
    if (.not. all(ieee_is_finite(system%f_int))) then
      report%outcome = outcome_not_finite
      return
    end if
    call gather_free(system%dofs, system%f_ext - system%f_int, newton%residual)
    newton%norm = norm2(newton%residual)
    report%residual(iteration) = relative(newton%norm, force_scale(newton%stiffness, system))
    report%n_plastic = system%sums%n_plastic
    report%flowing(iteration) = report%n_plastic
    if (.not. newton%norm <= huge(1.0_dp)) report%outcome = outcome_stagnated
  end subroutine measure

end module mpm_equilibrium
