!> Whether load control has met a limit load: the last load that the body can carry.
module mpm_limit_load
  use mpm_dof_map, only: gather_free
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_memory, outcome_stretched
  use mpm_system, only: system_t
  implicit none
  private
  public :: limit_watch_t, begin_watch, meets_limit_load, watch_increment

  real(dp), parameter :: small = 0.02_dp    !! increment over period from which on it is looked for [-]
  real(dp), parameter :: soft = 10.0_dp     !! softness of a tangent that fails twice [-]
  real(dp), parameter :: softer = 30.0_dp   !! softness of an increment before one that fails [-]
  real(dp), parameter :: softest = 300.0_dp !! softness of an increment that still converges [-]

  !> What is known about the loads of a step. A restart needs it.
  type :: limit_watch_t
    real(dp) :: flexibility = 0.0_dp !! way of the load over its growth in the first increment that
                                     !! it drives, 0 before it [length/force]
    real(dp) :: softness = 0.0_dp    !! that of the last increment over the first, 0 if not by load [-]
    real(dp) :: load = 0.0_dp        !! norm of the load in the last accepted increment [force]
    logical  :: told = .false.       !! the limit load was met in this step
  end type limit_watch_t

contains

  !> A step begins: its loads may be others.
  pure subroutine begin_watch(watch)
    type(limit_watch_t), intent(inout) :: watch

    watch%flexibility = 0.0_dp
    watch%softness = 0.0_dp
    watch%told = .false.
  end subroutine begin_watch

  !> Notes how far the load of an increment in equilibrium has gone. Source: theory.md (15d).
  pure subroutine watch_increment(watch, system, report)
    type(limit_watch_t), intent(inout) :: watch
    type(system_t), intent(in)        :: system   !! in equilibrium
    type(newton_report_t), intent(in) :: report   !! of the attempt
    real(dp) :: load(system%dofs%n), way(system%dofs%n), norm, flexibility, growth
    logical :: driven

    call gather_free(system%dofs, system%f_ext, load)
    call gather_free(system%dofs, system%u, way)
    norm = norm2(load)
    driven = is_driven_by_load(watch, system, report)
    growth = norm - watch%load
    watch%load = norm
    watch%softness = 0.0_dp
    if (.not. driven .or. growth <= epsilon(1.0_dp)*norm) return
    flexibility = abs(dot_product(load/norm, way))/growth
    if (watch%flexibility <= 0.0_dp) then
      watch%flexibility = flexibility
    else
      watch%softness = flexibility/watch%flexibility
    end if
  end subroutine watch_increment

  !> Whether an attempt is at a limit load: a small increment, driven by a load that grows, is so much
  !! softer than the first one of the step that the load cannot grow on. One that converged has
  !! been watched before. Source: theory.md (15d).
  pure logical function meets_limit_load(watch, system, report, schedule) result(met)
    type(limit_watch_t), intent(in)   :: watch
    type(system_t), intent(in)        :: system   !! after the attempt
    type(newton_report_t), intent(in) :: report   !! of the attempt
    type(schedule_t), intent(in)      :: schedule !! the attempt is open

    met = .false.
    if (watch%flexibility <= 0.0_dp .or. schedule%size > small*schedule%settings%period) return
    if (report%outcome == outcome_converged) then
      met = watch%softness > softest
    else if (all(report%outcome /= [outcome_memory, outcome_stretched])) then
      if (.not. is_driven_by_load(watch, system, report)) return
      met = watch%softness > softer &
            .or. (schedule%attempt > 1 .and. report%reach > soft*watch%flexibility &
                                                            *(load_norm(system) - watch%load))
    end if
  end function meets_limit_load

  !> Norm of the applied forces on unknowns.
  pure real(dp) function load_norm(system) result(norm)
    type(system_t), intent(in) :: system !! forces of an increment
    real(dp) :: load(system%dofs%n)

    call gather_free(system%dofs, system%f_ext, load)
    norm = norm2(load)
  end function load_norm

  !> Whether nothing moves but by growing loads, and what is out of balance at the start is their
  !! growth: not a body that hangs on its new mesh in another way than on the old one.
  pure logical function is_driven_by_load(watch, system, report) result(driven)
    type(limit_watch_t), intent(in)   :: watch  !! at the last accepted increment
    type(system_t), intent(in)        :: system !! after an attempt
    type(newton_report_t), intent(in) :: report !! of the attempt
    real(dp) :: norm

    norm = load_norm(system)
    driven = norm > watch%load .and. all(abs(system%dofs%prescribed) <= 0.0_dp)
    if (driven) driven = report%at_rest <= 2.0_dp*(1.0_dp - watch%load/norm)
  end function is_driven_by_load

end module mpm_limit_load
