!> What ends a run early, and where in time and space it happened.
module mpm_run_failure
  use mpm_equilibrium, only: newton_report_t, outcome_memory, outcome_text
  use mpm_error, only: error_t, exit_lost_point, exit_no_convergence, exit_solver, make_error
  use mpm_increments, only: cut_back, schedule_t
  use mpm_model, only: model_t
  use mpm_point_location, only: location_report_t
  use mpm_system, only: body_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: check_count, place_of, report_lost_point, shorten

contains

  !> Cuts the increment after a failed attempt; at the smallest size the run ends.
  subroutine shorten(schedule, report, model, error)
    type(schedule_t), intent(inout)   :: schedule
    type(newton_report_t), intent(in) :: report
    type(model_t), intent(in)         :: model
    type(error_t), allocatable, intent(out) :: error
    logical :: exhausted

    call cut_back(schedule, exhausted)
    if (report%outcome == outcome_memory) then
      call make_error(error, exit_solver, "error: "//outcome_text(report%outcome)// &
                      place_of(schedule, model))
    else if (exhausted) then
      call make_error(error, exit_no_convergence, "error: no convergence at the smallest increment "// &
                      real_text(schedule%settings%minimum)//": "//outcome_text(report%outcome)// &
                      worst_of(report, model)//place_of(schedule, model))
    end if
  end subroutine shorten

  !> Where in time a run failed: in an attempt, or after an accepted increment.
  pure function place_of(schedule, model) result(text)
    type(schedule_t), intent(in) :: schedule
    type(model_t), intent(in)    :: model
    character(:), allocatable :: text

    text = " (step '"//model%step(schedule%step)%name//"', increment "// &
           integer_text(schedule%increment)
    if (schedule%attempt > 0) text = text//", attempt "//integer_text(schedule%attempt)
    text = text//", step time "//real_text(schedule%step_time)//")"
  end function place_of

  !> Where in the mesh an attempt failed, in the numbers of the input.
  pure function worst_of(report, model) result(text)
    type(newton_report_t), intent(in) :: report
    type(model_t), intent(in)         :: model
    character(:), allocatable :: text

    text = ""
    if (report%worst_element > 0) text = text//", element "// &
      integer_text(model%mesh%parent_label(model%mesh%parent(report%worst_element)))
    if (report%worst_point > 0) text = text//", material point "//integer_text(report%worst_point)
    if (report%worst_node > 0) text = text//", largest residual at node "// &
      integer_text(model%mesh%node_label(report%worst_node))
  end function worst_of

  !> A point left the mesh and the deck wants that to be an error.
  subroutine report_lost_point(error, body, location, model, schedule)
    type(error_t), allocatable, intent(out) :: error
    type(body_t), intent(in)            :: body
    type(location_report_t), intent(in) :: location
    type(model_t), intent(in)           :: model
    type(schedule_t), intent(in)        :: schedule
    character(:), allocatable :: place
    integer :: i

    place = ""
    do i = 1, model%mesh%n_dim
      if (i > 1) place = place//", "
      place = place//real_text(body%points%x(i, location%first_lost))
    end do
    call make_error(error, exit_lost_point, "error: "//integer_text(location%n_lost)// &
                    " material points left the mesh, the first is point "// &
                    integer_text(body%points%id(location%first_lost))//" at ("//place// &
                    "): expected a mesh that reaches further, or *LOST POINTS, ACTION=FREEZE or "// &
                    "REMOVE"//place_of(schedule, model))
  end subroutine report_lost_point

  !> More increments than the deck allows.
  subroutine check_count(schedule, model, error)
    type(schedule_t), intent(in) :: schedule
    type(model_t), intent(in)    :: model
    type(error_t), allocatable, intent(out) :: error

    if (schedule%finished .or. schedule%increment < schedule%settings%max_increments) return
    call make_error(error, exit_no_convergence, "error: "// &
                    integer_text(schedule%settings%max_increments)// &
                    " increments done and the step is not finished: expected fewer, or a larger INC of *STEP"// &
                    place_of(schedule, model))
  end subroutine check_count

end module mpm_run_failure
