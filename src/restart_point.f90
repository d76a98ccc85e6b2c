!> Restart files of a run: when one is written, and the end that a user asks for.
module mpm_restart_point
  use mpm_analysis_run, only: analysis_t
  use mpm_clock, only: wall_time
  use mpm_control_files, only: take_request
  use mpm_error, only: error_t, exit_interrupted, exit_terminated, make_error
  use mpm_interruption, only: received_signal, signal_interrupt
  use mpm_material_points, only: hand_over
  use mpm_model, only: model_t
  use mpm_recycled_solver, only: accept_factors, accepted_factors
  use mpm_restart_file, only: is_restart_due, write_restart
  use mpm_restart_output, only: note_output
  use mpm_restart_state, only: restart_t
  use mpm_run_log, only: log_message
  use mpm_run_output, only: publish_output, run_output_t
  use mpm_run_state, only: run_state_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: keep_point, obey_requests, place_text, save_point

contains

  !> Notes where the run is after an accepted increment.
  subroutine keep_point(analysis, output, state)
    type(analysis_t), intent(inout) :: analysis   !! kept is set
    type(run_output_t), intent(in) :: output      !! the increment is written
    type(run_state_t), intent(in) :: state        !! after the increment

    analysis%kept%schedule = analysis%schedule
    analysis%kept%state = state
    analysis%kept%u_start = analysis%u_start
    analysis%kept%watch = analysis%watch
    call accept_factors(analysis%system%recycler)
    call note_output(analysis%kept, output)
  end subroutine keep_point

  !> Writes a restart file of the last accepted increment. A run that goes on from it needs all
  !! results up to there, so they are published first.
  subroutine save_point(analysis, output, model, error)
    type(analysis_t), intent(inout) :: analysis      !! mesh and points are those of kept
    type(run_output_t), intent(inout) :: output      !! open
    type(model_t), intent(inout) :: model            !! not changed
    type(error_t), allocatable, intent(out) :: error !! exit_file
    type(restart_t) :: restart

    call publish_output(output, error)
    if (allocated(error)) return
    restart = analysis%kept
    restart%mesh_x = analysis%body%mesh%x
    call hand_over(analysis%body%points, restart%points)
    restart%surface = analysis%body%surface
    restart%factors = accepted_factors(analysis%system%recycler)
    call write_restart(restart, model, output%paths%restart, output%paths%previous_restart, error)
    call hand_over(restart%points, analysis%body%points)
    if (allocated(error)) return
    analysis%last_written = wall_time()
    call log_message(output%log, "  restart file "//output%paths%restart//" written at "// &
                     place_text(restart), error)
  end subroutine save_point

  !> After an accepted increment: restart files that are due or asked for, and a wanted end.
  subroutine obey_requests(analysis, output, model, error)
    type(analysis_t), intent(inout) :: analysis
    type(run_output_t), intent(inout) :: output
    type(model_t), intent(inout) :: model            !! not changed
    type(error_t), allocatable, intent(out) :: error !! the run is to end, or exit_file
    logical :: asked, due, stopped

    due = is_restart_due(model%step(analysis%schedule%step)%restart_frequency, &
                         analysis%schedule%increment, analysis%schedule%finished, &
                         wall_time() - analysis%last_written)
    call take_request(asked, output%paths%restart_request)
    call take_request(stopped, output%paths%stop_request)
    if (is_finished(analysis, model)) stopped = .false. ! there is nothing left to stop
    if (is_interrupted() .and. .not. is_finished(analysis, model)) then
      call end_by_signal(analysis, output, model, error)
      return
    end if
    if (due .or. asked .or. stopped) call save_point(analysis, output, model, error)
    if (allocated(error) .or. .not. stopped) return
    call make_error(error, exit_interrupted, "stopped by "//output%paths%stop_request//" at "// &
                    place_text(analysis%kept)//go_on_text(output))
  end subroutine obey_requests

  !> Whether the last step is done.
  pure logical function is_finished(analysis, model) result(finished)
    type(analysis_t), intent(in) :: analysis
    type(model_t), intent(in) :: model

    finished = analysis%schedule%finished .and. analysis%schedule%step == size(model%step)
  end function is_finished

  !> Whether a signal asks to end.
  logical function is_interrupted() result(interrupted)
    interrupted = received_signal() /= 0
  end function is_interrupted

  !> The end that a signal asks for: a restart file, and the exit code that belongs to the signal.
  subroutine end_by_signal(analysis, output, model, error)
    type(analysis_t), intent(inout) :: analysis
    type(run_output_t), intent(inout) :: output
    type(model_t), intent(inout) :: model            !! not changed
    type(error_t), allocatable, intent(out) :: error !! why the run ends, or exit_file

    call save_point(analysis, output, model, error)
    if (allocated(error)) return
    if (received_signal() == signal_interrupt) then
      call make_error(error, exit_interrupted, "interrupted at "//place_text(analysis%kept)// &
                      go_on_text(output))
    else
      call make_error(error, exit_terminated, "terminated at "//place_text(analysis%kept)// &
                      go_on_text(output))
    end if
  end subroutine end_by_signal

  !> How to go on after a wanted end.
  pure function go_on_text(output) result(text)
    type(run_output_t), intent(in) :: output
    character(:), allocatable :: text

    text = ": go on with tessera --restart "//output%paths%restart//" and the deck"
  end function go_on_text

  !> Where in time a restart file was written.
  pure function place_text(restart) result(text)
    type(restart_t), intent(in) :: restart
    character(:), allocatable :: text

    text = "step "//integer_text(restart%schedule%step)//", increment "// &
           integer_text(restart%schedule%increment)//", total time "// &
           real_text(restart%schedule%total_time)
  end function place_text

end module mpm_restart_point
