!> What ends a run early, and where in time and space it happened.
module mpm_run_failure
  use mpm_error, only: error_t, exit_lost_point, exit_model, exit_no_convergence, exit_solver, &
    make_error
  use mpm_fail_file, only: failure_t, write_fail_file
  use mpm_failure_evidence, only: failure_evidence_t, gather_evidence
  use mpm_failure_text, only: causes_text, count_cause, free_modes_text, place_of_failure
  use mpm_increments, only: cut_back, schedule_t
  use mpm_kinds, only: dp
  use mpm_memory, only: megabytes
  use mpm_model, only: model_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_memory, &
    outcome_singular, outcome_stretched, outcome_text
  use mpm_place_text, only: place_text
  use mpm_point_location, only: location_report_t
  use mpm_system, only: body_t, system_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: check_count, check_held, memory_error, place_of, record_failure, report_lost_point
  public :: refuse_mechanism, shorten

  character(*), parameter :: line_end = new_line("a")
  real(dp), parameter :: doubtful_rcond = 1.0e-12_dp !! pivot ratio that may come from a free mode
  real(dp), parameter :: hopeless_rcond = 1.0e-13_dp !! pivot ratio of rounding errors

contains

  !> Cuts the increment after a failed attempt; at the smallest size the run ends.
  subroutine shorten(schedule, report, system, model, error)
    type(schedule_t), intent(inout)   :: schedule
    type(newton_report_t), intent(in) :: report
    type(system_t), intent(in)        :: system
    type(model_t), intent(in)         :: model
    type(error_t), allocatable, intent(out) :: error
    logical :: exhausted

    call cut_back(schedule, exhausted)
    if (report%outcome == outcome_memory) then
      call memory_error(error, system, "factorisation")
      error%message = error%message//place_of(schedule, model)
    else if (exhausted) then
      call make_error(error, exit_no_convergence, "error: no convergence at the smallest increment "// &
                      real_text(schedule%settings%minimum)//": "//outcome_text(report%outcome)// &
                      place_of(schedule, model))
    end if
  end subroutine shorten

  !> Calls a tangent singular that has a free mode and pivots of rounding errors, or doubtful ones and
  !! a displacement beyond the mesh to show for it: such a solution has no meaning, whatever its
  !! residual.
  pure subroutine refuse_mechanism(report, body, u, schedule, model)
    type(newton_report_t), intent(inout) :: report   !! its outcome may change
    type(body_t), intent(in)     :: body             !! converged
    real(dp), intent(in)         :: u(:, :)          !! (n_dim, n_node)  of the attempt [length]
    type(schedule_t), intent(in) :: schedule
    type(model_t), intent(in)    :: model

    if (all(report%outcome /= [outcome_converged, outcome_stretched])) return
    if (report%rcond > doubtful_rcond) return
    if (report%rcond > hopeless_rcond .and. maxval(abs(u)) <= &
        maxval(maxval(body%mesh%x, dim=2) - minval(body%mesh%x, dim=2))) return
    if (len(free_modes_text(body, model, schedule%step)) > 0) report%outcome = outcome_singular
  end subroutine refuse_mechanism

  !> A tangent that is singular because something is not held: no size of the increment helps.
  subroutine check_held(error, body, report, schedule, model)
    type(error_t), allocatable, intent(out) :: error !! exit_model
    type(body_t), intent(in)          :: body        !! converged
    type(newton_report_t), intent(in) :: report      !! of a failed attempt
    type(schedule_t), intent(in)      :: schedule
    type(model_t), intent(in)         :: model

    if (report%outcome /= outcome_singular) return
    if (len(free_modes_text(body, model, schedule%step)) == 0) return
    call make_error(error, exit_model, "error: "//outcome_text(report%outcome)// &
                    ", and smaller increments do not help"//place_of(schedule, model))
  end subroutine check_held

  !> The linear solver lacks memory: how much it wants, and what helps.
  pure subroutine memory_error(error, system, stage)
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    type(system_t), intent(in) :: system             !! with the pattern
    character(*), intent(in)   :: stage              !! what it was for
    character(:), allocatable  :: wanted

    wanted = ""
    if (system%solver%memory > 0.0_dp) wanted = ", about "//real_text( &
      megabytes(system%solver%memory))//" MB are needed"
    call make_error(error, exit_solver, "error: not enough memory for the "//stage//" of "// &
                    integer_text(system%dofs%n)//" equations with "// &
                    real_text(real(system%tangent%nnz, dp))//" entries"//wanted// &
                    ": expected more memory, a coarser mesh or smaller patches")
  end subroutine memory_error

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

  !> A point left the mesh and the deck wants that to be an error.
  subroutine report_lost_point(error, body, location, model, schedule)
    type(error_t), allocatable, intent(out) :: error
    type(body_t), intent(in)            :: body
    type(location_report_t), intent(in) :: location
    type(model_t), intent(in)           :: model
    type(schedule_t), intent(in)        :: schedule

    call make_error(error, exit_lost_point, "error: "//integer_text(location%n_lost)// &
                    " material points left the mesh, the first is point "// &
                    integer_text(location%first_lost)//" at ("// &
                    place_text(body%points%x(:, body%points%place(location%first_lost)))//"): expected a mesh "// &
                    "that reaches further, or *LOST POINTS, ACTION=FREEZE or REMOVE"// &
                    place_of(schedule, model))
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

  !> Adds the worst place, likely causes and the name of the file with the last attempt to an error of
  !! the analysis, and writes that file. Errors of files stay as they are.
  subroutine record_failure(error, path, body, system, report, schedule, model)
    type(error_t), intent(inout)      :: error    !! what ends the run
    character(*), intent(in)          :: path     !! JOB_fail.vtkhdf
    type(body_t), intent(in)          :: body     !! as the last attempt found it
    type(system_t), intent(in)        :: system   !! as the last attempt left it
    type(newton_report_t), intent(in) :: report   !! of the last attempt; or with a lost point
    type(schedule_t), intent(in)      :: schedule
    type(model_t), intent(in)         :: model
    type(failure_t) :: failure
    type(failure_evidence_t) :: nowhere
    type(error_t), allocatable :: late
    character(:), allocatable :: place

    select case (error%code)
    case (exit_model, exit_no_convergence, exit_solver, exit_lost_point)
      call gather_evidence(failure%evidence, body, system, report)
    case default
      return
    end select
    ! An increment that had converged has no worst place but a lost point: the message names its own.
    if (report%outcome == outcome_converged .and. report%worst_point == 0 .and. &
        any(error%code == [exit_model, exit_lost_point])) failure%evidence = nowhere
    place = place_of_failure(failure%evidence, body%mesh, body%points)
    if (len(place) > 0) error%message = error%message//line_end//"  worst place: "//place
    if (error%code == exit_no_convergence .and. report%outcome == outcome_converged) then
      error%message = error%message//count_cause(schedule)
    else
      error%message = error%message//causes_text(failure%evidence, &
        free_modes_text(body, model, schedule%step), report, body, model, schedule)
    end if
    error%message = error%message//line_end//"  last attempt: "//path
    failure%exit_code = error%code
    failure%outcome = outcome_text(report%outcome)
    failure%message = error%message
    failure%step = schedule%step
    failure%increment = schedule%increment
    failure%attempt = schedule%attempt
    failure%time = schedule%total_time
    if (schedule%attempt > 0) failure%time = schedule%total_time + schedule%size
    call write_fail_file(path, failure, body, system, late)
    if (allocated(late)) error%message = error%message//" was not written"//line_end//late%message
  end subroutine record_failure

end module mpm_run_failure
