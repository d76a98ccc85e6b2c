!> What the writers are told about an attempt and about an accepted increment.
module mpm_run_notes
  use mpm_clock, only: wall_time
  use mpm_ghost_penalty, only: ghost_share
  use mpm_increment_work, only: reference_work
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp
  use mpm_model, only: model_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_interrupted
  use mpm_nodal_frames, only: part_along
  use mpm_point_location, only: location_report_t
  use mpm_run_state, only: note_balance, note_constraints, run_state_t
  use mpm_system, only: body_t, system_t
  implicit none
  private
  public :: note_attempt, note_equilibrium, note_location

contains

  !> What an attempt was.
  subroutine note_attempt(state, schedule, report, system, body)
    type(run_state_t), intent(inout)  :: state
    type(schedule_t), intent(in)      :: schedule
    type(newton_report_t), intent(in) :: report
    type(system_t), intent(in)        :: system
    type(body_t), intent(in)          :: body

    state%step = schedule%step
    state%increment = schedule%increment
    state%attempt = schedule%attempt
    state%size = schedule%size
    state%time = schedule%total_time + schedule%size
    state%step_time = schedule%step_time + schedule%size
    state%n_iterations = report%n_iterations
    state%residual = report%residual(report%n_iterations)
    state%n_active_elements = size(system%element)
    state%eigenvalue = [report%eigenvalues%smallest, report%eigenvalues%largest]
    if (body%ghost_gamma > 0.0_dp) then
      state%n_ghost_pairs = system%ghost%pairs%n
      if (body%ghost_adapts) state%ghost_raise = schedule%ghost_raise
    end if
    if (all(report%outcome /= [outcome_converged, outcome_interrupted])) &
      state%n_cuts = state%n_cuts + 1
    state%wall_seconds = wall_time() - state%started
    state%point_loop_seconds = system%point_loop_seconds
  end subroutine note_attempt

  !> Forces and displacements of the converged increment.
  subroutine note_equilibrium(state, system, body, model)
    type(run_state_t), intent(inout) :: state
    type(system_t), intent(in)       :: system
    type(body_t), intent(in)         :: body
    type(model_t), intent(in)        :: model

    call note_constraints(state, body%patches, system)
    call note_share(state, system, body) ! before the forces of the start are overwritten
    state%applied = system%f_ext
    state%reaction = part_along(model%frames, system%f_int - system%f_ext, system%dofs%fixed)
    call note_balance(state, system)
    state%delta_u = system%u
    state%node_u = state%node_u + system%u
    state%delta_j = 1.0_dp
    state%delta_j(system%element) = 1.0_dp + system%kinematics%delta_j_m1(system%element)
    state%delta_j_patch = patch_means(state%delta_j, system%element, body%mesh%volume, &
                                      model%patches%of_element, model%patches%n)
  end subroutine note_equilibrium

  !> What the ghost penalty carries of the load; without pairs nothing is computed.
  subroutine note_share(state, system, body)
    type(run_state_t), intent(inout) :: state !! with the forces at the start of the increment
    type(system_t), intent(in)       :: system
    type(body_t), intent(in)         :: body
    real(dp) :: work

    state%ghost_share_now = 0.0_dp
    if (system%ghost%pairs%n == 0) return
    work = reference_work(sum(system%u*(state%applied + state%reaction)), &
                          sum(system%u*system%f_int), body%points, &
                          system%kinematics%disp_grad_bar)
    state%ghost_share_now = ghost_share(system%ghost, system%u, work, &
                                        maxval(abs(state%node_u) + abs(system%u)))
    state%ghost_share = max(state%ghost_share, state%ghost_share_now)
  end subroutine note_share

  !> Mean volume change of the patches of the deck, also with the standard method, which does not
  !! use it. Source: theory.md (4).
  pure function patch_means(delta_j, element, volume, of_element, n_patch) result(mean)
    real(dp), intent(in) :: delta_j(:)    !! (n_el)  det dF [-]
    integer, intent(in)  :: element(:)    !! active elements
    real(dp), intent(in) :: volume(:)     !! (n_el)  at the start of the increment
    integer, intent(in)  :: of_element(:) !! (n_el)  patch of each element
    integer, intent(in)  :: n_patch
    real(dp) :: mean(n_patch)             !! 1 for an empty patch [-]
    real(dp) :: total(n_patch)
    integer :: i, e

    mean = 0.0_dp
    total = 0.0_dp
    do i = 1, size(element)
      e = element(i)
      mean(of_element(e)) = mean(of_element(e)) + volume(e)*delta_j(e)
      total(of_element(e)) = total(of_element(e)) + volume(e)
    end do
    where (total > 0.0_dp)
      mean = mean/total
    elsewhere
      mean = 1.0_dp
    end where
  end function patch_means

  !> Times and counts after the acceptance.
  subroutine note_location(state, schedule, location)
    type(run_state_t), intent(inout)    :: state
    type(schedule_t), intent(in)        :: schedule
    type(location_report_t), intent(in) :: location

    state%increment_total = schedule%increment_total
    state%time = schedule%total_time
    state%step_time = schedule%step_time
    state%n_extrapolated = location%n_extrapolated
    state%n_lost = state%n_lost + location%n_lost
  end subroutine note_location

end module mpm_run_notes
