!> The schedule of a step: size of increments, cut-back, growth, end of the step.
module mpm_increments
  use mpm_kinds, only: dp
  implicit none
  private
  public :: schedule_settings_t, schedule_t
  public :: accept_step, begin_step, cut_back, guess_ratio, keep_below_stretch, resume_step
  public :: start_increment

  real(dp), parameter :: most_raise = 100.0_dp !! largest factor on the ghost penalty [-]

  !> *STATIC and the INC of *STEP.
  type :: schedule_settings_t
    logical  :: direct = .false.            !! .true.: equal increments, cut only when Newton fails, grown back to the initial size
    real(dp) :: initial = 1.0_dp            !! first size, step time
    real(dp) :: period = 1.0_dp             !! length of the step
    real(dp) :: minimum = 1.0e-5_dp         !! smallest size
    real(dp) :: maximum = 1.0_dp            !! largest size
    integer  :: max_increments = 100        !! accepted increments in the step
  end type schedule_settings_t

  !> Where the analysis stands in time.
  type :: schedule_t
    type(schedule_settings_t) :: settings
    integer  :: step = 0             !! number of the step
    integer  :: increment = 0        !! number of the current increment in the step, from 1
    integer  :: increment_total = 0  !! accepted increments in the run
    integer  :: attempt = 0          !! attempt at this increment, from 1
    real(dp) :: step_time = 0.0_dp   !! at the start of the increment
    real(dp) :: total_time = 0.0_dp  !! at the start of the increment
    real(dp) :: total_start = 0.0_dp !! total time at the start of the step
    real(dp) :: size = 0.0_dp        !! size of the increment
    real(dp) :: planned = 0.0_dp     !! size before it was shortened to hit a stop
    real(dp), allocatable :: stop_time(:) !! step times that must be hit, ascending, the last one is the period
    integer  :: n_cuts = 0           !! cut-backs in the step so far
    real(dp) :: last_size = 0.0_dp   !! of the last accepted increment in the step, 0 before the first
    real(dp) :: ghost_raise = 1.0_dp !! factor on a ghost penalty whose strength is left to the run [-]
    logical  :: finished = .false.   !! the end of the step is reached
  end type schedule_t

contains

  !> Prepares the schedule for a step.
  pure subroutine begin_step(schedule, step, settings, stop_time)
    type(schedule_t), intent(inout) :: schedule
    integer, intent(in)  :: step                        !! number of the step
    type(schedule_settings_t), intent(in) :: settings
    real(dp), intent(in) :: stop_time(:)                !! step times to be hit, in any order, with repeats

    schedule%settings = settings
    schedule%step = step
    schedule%increment = 0
    schedule%attempt = 0
    schedule%step_time = 0.0_dp
    schedule%total_start = schedule%total_time
    schedule%n_cuts = 0
    schedule%last_size = 0.0_dp
    schedule%finished = .false.
    schedule%planned = min(settings%initial, settings%period)
    call sort_stops(schedule, stop_time)
  end subroutine begin_step

  !> Goes on in a step with the settings that it has now.
  pure subroutine resume_step(schedule, settings, stop_time)
    type(schedule_t), intent(inout) :: schedule         !! after an accepted increment
    type(schedule_settings_t), intent(in) :: settings   !! of the same period
    real(dp), intent(in) :: stop_time(:)                !! step times to be hit, in any order, with repeats

    schedule%settings = settings
    schedule%planned = min(max(schedule%planned, settings%minimum), settings%maximum)
    call sort_stops(schedule, stop_time)
  end subroutine resume_step

  !> Keeps the stops inside the step, ascending, unique, closed by the period.
  pure subroutine sort_stops(schedule, stop_time)
    type(schedule_t), intent(inout) :: schedule
    real(dp), intent(in) :: stop_time(:) !! step times
    real(dp), allocatable :: sorted(:)
    real(dp) :: gap, last

    gap = 1.0e-9_dp*schedule%settings%period
    allocate (sorted(0))
    last = 0.0_dp
    do
      if (.not. any(stop_time > last + gap .and. stop_time < schedule%settings%period - gap)) exit
      last = minval(stop_time, mask=stop_time > last + gap)
      sorted = [sorted, last]
    end do
    schedule%stop_time = [sorted, schedule%settings%period]
  end subroutine sort_stops

  !> Opens the next attempt: the planned size, shortened to hit the next stop.
  pure subroutine start_increment(schedule)
    type(schedule_t), intent(inout) :: schedule
    real(dp) :: rest

    if (schedule%attempt == 0) schedule%increment = schedule%increment + 1
    schedule%attempt = schedule%attempt + 1
    rest = next_stop(schedule) - schedule%step_time
    schedule%size = schedule%planned
    if (schedule%size > rest - 1.0e-9_dp*schedule%settings%period) then
      schedule%size = rest
    else if (.not. schedule%settings%direct .and. 2.0_dp*schedule%size > rest) then
      schedule%size = 0.5_dp*rest
    end if
  end subroutine start_increment

  !> The first stop after the current time.
  pure function next_stop(schedule) result(time)
    type(schedule_t), intent(in) :: schedule
    real(dp) :: time !! step time

    time = minval(schedule%stop_time, &
                  mask=schedule%stop_time > schedule%step_time + 1.0e-9_dp*schedule%settings%period)
  end function next_stop

  !> Accepts the increment: time goes on, easy increments grow.
  pure subroutine accept_step(schedule, n_iterations)
    type(schedule_t), intent(inout) :: schedule
    integer, intent(in) :: n_iterations !! of the accepted increment
    integer, parameter :: very_easy = 3, easy = 6, hard = 12
    real(dp) :: stop_at

    stop_at = next_stop(schedule)
    schedule%total_time = schedule%total_time + schedule%size
    if (schedule%step_time + schedule%size > stop_at - 1.0e-9_dp*schedule%settings%period) then
      schedule%total_time = schedule%total_time - schedule%size + (stop_at - schedule%step_time)
      schedule%step_time = stop_at
    else
      schedule%step_time = schedule%step_time + schedule%size
    end if
    schedule%finished = schedule%step_time >= schedule%settings%period
    schedule%increment_total = schedule%increment_total + 1
    schedule%last_size = schedule%size
    if (schedule%settings%direct) then
      schedule%planned = min(2.0_dp*schedule%planned, schedule%settings%initial)
      if (schedule%attempt > 1) schedule%planned = min(schedule%planned, schedule%size)
    else if (n_iterations <= very_easy .and. schedule%attempt == 1) then
      schedule%planned = min(2.0_dp*schedule%planned, schedule%settings%maximum)
    else if (n_iterations <= easy .and. schedule%attempt == 1) then
      schedule%planned = min(1.5_dp*schedule%planned, schedule%settings%maximum)
    else if (n_iterations > hard) then
      schedule%planned = max(0.5_dp*schedule%planned, schedule%settings%minimum)
    end if
    if (schedule%attempt == 1) schedule%ghost_raise = max(1.0_dp, 0.5_dp*schedule%ghost_raise)
    schedule%attempt = 0
  end subroutine accept_step

  !> Quarters a failed increment. At the smallest size the schedule is exhausted. Where one cut does
  !! not help, what stops the run may be an element at the edge of the body: the penalty grows.
  !! Source: theory.md (15c), section 13.
  pure subroutine cut_back(schedule, exhausted)
    type(schedule_t), intent(inout) :: schedule
    logical, intent(out) :: exhausted !! .true.: the failed increment was already the smallest

    schedule%n_cuts = schedule%n_cuts + 1
    if (schedule%attempt > 1) schedule%ghost_raise = min(10.0_dp*schedule%ghost_raise, most_raise)
    exhausted = schedule%size <= schedule%settings%minimum*(1.0_dp + 1.0e-9_dp)
    schedule%planned = max(0.25_dp*schedule%size, schedule%settings%minimum)
  end subroutine cut_back

  !> Plans the next attempt so that it stays below the largest stretch, as far as the last one,
  !! accepted or not, tells. Source: theory.md (15b).
  pure subroutine keep_below_stretch(schedule, stretch, limit)
    type(schedule_t), intent(inout) :: schedule !! after acceptance or cut; its size is the last one
    real(dp), intent(in) :: stretch             !! of the last attempt, 0 if not known [-]
    real(dp), intent(in) :: limit               !! largest one [-]
    real(dp), parameter :: margin = 0.9_dp

    if (schedule%settings%direct .and. stretch <= limit) return
    if (stretch <= tiny(stretch)) return
    schedule%planned = max(schedule%settings%minimum, &
                           min(schedule%planned, margin*limit/stretch*schedule%size))
  end subroutine keep_below_stretch

  !> Factor from the displacements of the last increment to a guess of those of this one; 0 for
  !! none: the first increment of a step, and any after a cut. Source: theory.md (15a).
  pure function guess_ratio(schedule) result(ratio)
    type(schedule_t), intent(in) :: schedule !! an increment is open
    real(dp) :: ratio                        !! [-]

    ratio = 0.0_dp
    if (schedule%attempt == 1 .and. schedule%last_size > 0.0_dp) &
      ratio = schedule%size/schedule%last_size
  end function guess_ratio

end module mpm_increments
