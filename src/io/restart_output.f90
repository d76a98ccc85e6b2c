!> What the output of a run adds to a restart, and takes back from it.
module mpm_restart_output
  use mpm_error, only: error_t
  use mpm_expectations, only: evaluate_expectations
  use mpm_model, only: model_t
  use mpm_output_mark, only: mark_text, output_mark_t
  use mpm_output_resume, only: take_mark
  use mpm_restart_state, only: restart_t
  use mpm_run_output, only: run_output_t
  use mpm_verdict_record, only: restore_verdicts, verdicts_text
  implicit none
  private
  public :: note_output, restore_output

contains

  !> Notes what was decided and counted so far.
  subroutine note_output(restart, output)
    type(restart_t), intent(inout) :: restart !! takes it
    type(run_output_t), intent(in) :: output  !! after an accepted increment
    type(output_mark_t) :: mark

    call take_mark(output, mark)
    restart%output_mark = mark_text(mark)
    restart%verdicts = verdicts_text(output%verdict)
    restart%seconds = output%log%seconds
    restart%n_attempts = output%log%n_attempts
    restart%n_iterations = output%log%n_iterations
  end subroutine note_output

  !> Goes on with what was decided and counted.
  subroutine restore_output(output, restart, model, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(restart_t), intent(in) :: restart           !! loaded
    type(model_t), intent(in) :: model               !! patches
    type(error_t), allocatable, intent(out) :: error !! exit_deck: an expectation too early

    output%log%seconds = restart%seconds
    output%log%n_attempts = restart%n_attempts
    output%log%n_iterations = restart%n_iterations
    call restore_verdicts(output%verdict, restart%verdicts, restart%state%time, error)
    if (allocated(error)) return
    call evaluate_expectations(output%verdict, restart%points, model%patches, restart%state)
  end subroutine restore_output

end module mpm_restart_output
