!> Builds the steps: schedule, controls, and everything in force in each of them.
module mpm_step_builder
  use mpm_boundary_builder, only: add_boundary, begin_boundary_step, boundary_state_t, &
    & close_boundary_step, fix_boundary, open_boundary, warn_released
  use mpm_build_context, only: at_card, at_field, at_parameter, build_context_t, fault
  use mpm_deck_card, only: deck_t, field_count, field_real, has_parameter, parameter_choice, &
    & parameter_integer, parameter_real, parameter_text
  use mpm_expectation_builder, only: build_expectation
  use mpm_external_force, only: load_t
  use mpm_increments, only: schedule_settings_t
  use mpm_kinds, only: dp
  use mpm_linear_method, only: least_recycled, method_mumps, method_name, method_of_name
  use mpm_linear_solver, only: has_mumps
  use mpm_load_builder, only: add_loads, begin_load_step, close_load_step, load_state_t
  use mpm_model, only: history_request_t, model_t, step_t
  use mpm_output_builder, only: build_field_output, build_history
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: build_steps

  real(dp), parameter :: smallest_part = 1.0e-5_dp !! default minimum over the period
  real(dp), parameter :: most_outputs = 1.0e5_dp  !! times of TIME INTERVAL in a step
  real(dp), parameter :: least_part = 1.0e-12_dp   !! least first increment over the period

  !> What is in force; it carries over from step to step.
  type :: conditions_t
    type(boundary_state_t) :: boundary !! prescribed displacements
    type(load_state_t) :: loads        !! loads
  end type conditions_t

contains

  !> Builds all steps.
  subroutine build_steps(model, deck, context)
    type(model_t), intent(inout) :: model           !! with mesh, points, amplitudes; steps are set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(conditions_t) :: conditions
    real(dp) :: time
    integer :: i, first, n

    n = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "STEP") n = n + 1
    end do
    allocate (model%step(n))
    call open_boundary(conditions%boundary, model)
    n = 0
    first = 0
    time = 0.0_dp
    do i = 1, size(deck%card)
      select case (deck%card(i)%keyword)
      case ("STEP")
        first = i
      case ("END STEP")
        n = n + 1
        call build_step(model, n, conditions, deck, context, [first, i], time)
        first = 0
      case ("BOUNDARY")
        if (first == 0) call fix_boundary(conditions%boundary, model, deck, context, i)
      case default
        cycle
      end select
    end do
  end subroutine build_steps

  !> Builds one step.
  subroutine build_step(model, n, conditions, deck, context, range, time)
    type(model_t), intent(inout) :: model             !! step n is set
    integer, intent(in) :: n                          !! number of the step
    type(conditions_t), intent(inout) :: conditions   !! in force
    type(deck_t), intent(in) :: deck                  !! the deck
    type(build_context_t), intent(inout) :: context   !! takes errors
    integer, intent(in) :: range(2)                   !! (2) cards *STEP and *END STEP
    real(dp), intent(inout) :: time                   !! total time at the start, then at the end
    type(step_t) :: step
    integer :: i

    call open_step(step, model, n, deck, range(1))
    associate (boundary => conditions%boundary, loads => conditions%loads)
      call begin_boundary_step(boundary, deck, context, range(1), range(2))
      call begin_load_step(loads, deck, context, range(1), range(2))
      do i = range(1), range(2)
        select case (deck%card(i)%keyword)
        case ("STATIC", "GEOSTATIC")
          call build_procedure(step, deck, context, i)
        case ("CONTROLS")
          call build_controls(step, deck, context, i)
        case ("BOUNDARY")
          call add_boundary(boundary, model, deck, context, i)
        case ("CLOAD", "DLOAD", "DSLOAD")
          call add_loads(loads, boundary, model, deck, context, i)
        case default
          cycle
        end select
      end do
      call warn_released(boundary, model%mesh, deck, context, range)
      call close_boundary_step(step%constraint, boundary, step%schedule%period, model%amplitude)
      call close_load_step(step%load, loads, step%schedule%period, model%amplitude)
      if (step%geostatic) call apply_at_once(step%load)
    end associate
    step%newton%least_recycled = least_recycled(model%mesh%n_dim, step%schedule%direct)
    step%newton%repeats = step%schedule%direct
    call build_requests(step, model, deck, context, range, time)
    call check_interval(step, deck, context)
    time = time + step%schedule%period
    model%step(n) = step
  end subroutine build_step

  !> TIME INTERVAL of *OUTPUT, perhaps of a step before, does not cut the step into dust.
  subroutine check_interval(step, deck, context)
    type(step_t), intent(in) :: step                !! with schedule and requests
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error

    associate (interval => step%field_output%time_interval, period => step%schedule%period)
      if (.not. step%has_field_output .or. interval <= 0.0_dp) return
      if (period <= most_outputs*interval) return
      call fault(context, deck, at_card(step%card), "TIME INTERVAL="//real_text(interval) &
                 //" of *OUTPUT is too short for this step: expected at least " &
                 //real_text(period/most_outputs))
    end associate
  end subroutine check_interval

  !> Name, number of increments, and the requests that carry over.
  subroutine open_step(step, model, n, deck, i_card)
    type(step_t), intent(out) :: step  !! without conditions
    type(model_t), intent(in) :: model !! with the steps before
    integer, intent(in) :: n           !! number of the step
    type(deck_t), intent(in) :: deck   !! the deck
    integer, intent(in) :: i_card      !! *STEP

    step%card = i_card
    step%name = parameter_text(deck%card(i_card), "NAME", "STEP-"//integer_text(n))
    step%schedule%max_increments = parameter_integer(deck%card(i_card), "INC", &
                                                     step%schedule%max_increments)
    allocate (step%history(0), step%expectation(0))
    if (n == 1) return
    step%has_field_output = model%step(n - 1)%has_field_output
    step%field_output = model%step(n - 1)%field_output
    step%history = model%step(n - 1)%history
    step%newton = model%step(n - 1)%newton
    step%restart_frequency = model%step(n - 1)%restart_frequency
  end subroutine open_step

  !> *STATIC or *GEOSTATIC; without its data line one increment of size 1.
  subroutine build_procedure(step, deck, context, i_card)
    type(step_t), intent(inout) :: step             !! procedure and schedule are set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *STATIC or *GEOSTATIC

    step%geostatic = deck%card(i_card)%keyword == "GEOSTATIC"
    step%largest_move = parameter_real(deck%card(i_card), "UTOL", 0.0_dp)
    if (size(deck%card(i_card)%data) > 0) call build_schedule(step, deck, context, i_card)
  end subroutine build_procedure

  !> Loads without amplitude are in force from the beginning of the step.
  pure subroutine apply_at_once(load)
    type(load_t), intent(inout) :: load(:) !! loads of a *GEOSTATIC step
    integer :: i

    do i = 1, size(load)
      load(i)%start = load(i)%value
    end do
  end subroutine apply_at_once

  !> The data line of *STATIC or *GEOSTATIC.
  subroutine build_schedule(step, deck, context, i_card)
    type(step_t), intent(inout) :: step             !! schedule is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *STATIC or *GEOSTATIC

    associate (line => deck%card(i_card)%data(1), schedule => step%schedule)
      schedule%direct = has_parameter(deck%card(i_card), "DIRECT")
      schedule%initial = field_real(line, 1)
      schedule%period = field_real(line, 2)
      schedule%minimum = min(schedule%initial, smallest_part*schedule%period)
      schedule%maximum = schedule%period
      if (schedule%direct) schedule%maximum = schedule%initial
      if (field_count(line) > 2) schedule%minimum = field_real(line, 3)
      if (field_count(line) > 3) schedule%maximum = field_real(line, 4)
      if (schedule%initial < least_part*schedule%period) then
        call fault(context, deck, at_field(i_card, 1, 1), "the first increment " &
                   //real_text(schedule%initial)//" is too short for the step: expected at least " &
                   //real_text(least_part*schedule%period))
        return
      end if
      call check_schedule(schedule, deck, context, i_card)
    end associate
  end subroutine build_schedule

  !> The numbers of the data line fit each other.
  subroutine check_schedule(schedule, deck, context, i_card)
    type(schedule_settings_t), intent(in) :: schedule !! read, the first increment not too short
    type(deck_t), intent(in) :: deck                  !! the deck
    type(build_context_t), intent(inout) :: context   !! takes errors
    integer, intent(in) :: i_card                     !! *STATIC or *GEOSTATIC
    real(dp) :: needed

    associate (line => deck%card(i_card)%data(1))
      if (schedule%initial > schedule%period) then
        call fault(context, deck, at_field(i_card, 1, 1), "the first increment " &
                   //real_text(schedule%initial)//" is longer than the step: expected at most " &
                   //real_text(schedule%period))
      else if (schedule%minimum > schedule%initial) then
        call fault(context, deck, at_field(i_card, 1, 3), "the smallest increment " &
                   //real_text(schedule%minimum)//" is larger than the first: expected at most " &
                   //real_text(schedule%initial))
      else if (schedule%direct .and. field_count(line) > 3) then
        call fault(context, deck, at_field(i_card, 1, 4), "a largest increment with DIRECT, " &
                   //"where all are equal: expected no fourth value")
      else if (schedule%maximum < schedule%initial) then
        call fault(context, deck, at_field(i_card, 1, 4), "the largest increment " &
                   //real_text(schedule%maximum)//" is smaller than the first: expected at least " &
                   //real_text(schedule%initial))
      end if
      needed = schedule%period/schedule%initial
      if (schedule%direct .and. needed > real(schedule%max_increments, dp) + 0.5_dp) then
        call fault(context, deck, at_field(i_card, 1, 1), "the step needs "//real_text(needed) &
                   //" increments, INC allows "//integer_text(schedule%max_increments) &
                   //": expected a larger INC on *STEP")
      end if
    end associate
  end subroutine check_schedule

  !> *CONTROLS: what it does not name stays as it was in the step before, or with RESET goes back
  !! to its default.
  subroutine build_controls(step, deck, context, i_card)
    type(step_t), intent(inout) :: step !! controls of the step before in, those of the step out
    type(deck_t), intent(in) :: deck    !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_card       !! *CONTROLS
    type(step_t) :: defaults
    logical :: is_there

    associate (card => deck%card(i_card), newton => step%newton)
      if (has_parameter(card, "RESET")) newton = defaults%newton
      newton%tolerance = parameter_real(card, "TOLERANCE", newton%tolerance)
      newton%max_iterations = parameter_integer(card, "MAX ITERATIONS", newton%max_iterations)
      newton%max_backtracks = parameter_integer(card, "MAX BACKTRACKS", newton%max_backtracks)
      newton%max_stretch = parameter_real(card, "MAX STRETCH", newton%max_stretch)
      newton%prediction = parameter_choice(card, "PREDICTION", trim(merge("ON ", "OFF", &
                                           newton%prediction))) == "ON"
      newton%linear_solver = method_of_name(parameter_choice(card, "LINEAR SOLVER", &
                                                             method_name(newton%linear_solver)))
      newton%eigenvalues = newton%eigenvalues .or. has_parameter(card, "EIGENVALUES")
      is_there = has_mumps()
      if (newton%linear_solver == method_mumps .and. .not. is_there &
          .and. has_parameter(card, "LINEAR SOLVER")) then
        call fault(context, deck, at_parameter(i_card, "LINEAR SOLVER"), &
                   "this program was built without MUMPS: expected DIRECT or RECYCLED")
      end if
    end associate
  end subroutine build_controls

  !> *OUTPUT, *HISTORY and *EXPECT of a step.
  subroutine build_requests(step, model, deck, context, range, time)
    type(step_t), intent(inout) :: step             !! requests are added
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: range(2)                 !! (2) cards *STEP and *END STEP
    real(dp), intent(in) :: time                    !! total time at the start of the step
    type(history_request_t) :: request
    integer :: i

    do i = range(1), range(2)
      select case (deck%card(i)%keyword)
      case ("OUTPUT")
        step%has_field_output = .true.
        call build_field_output(step%field_output, model, deck, context, i)
      case ("RESTART")
        step%restart_frequency = parameter_integer(deck%card(i), "FREQUENCY", 1)
      case ("HISTORY")
        call build_history(request, model, deck, context, i)
        step%history = [step%history, request]
      case ("EXPECT")
        call build_expectation(step%expectation, model, deck, context, i, &
                               [time, time + step%schedule%period])
      case default
        cycle
      end select
    end do
  end subroutine build_requests

end module mpm_step_builder
