!> Going on with the result files of an interrupted run.
module mpm_output_resume
  use mpm_error, only: error_t
  use mpm_kinds, only: ip
  use mpm_model, only: model_t
  use mpm_output_mark, only: output_mark_t
  use mpm_result_paths, only: result_paths_t
  use mpm_results_file, only: close_results, publish_results
  use mpm_run_log, only: resume_log
  use mpm_run_output, only: open_fields, prepare_output, run_output_t
  use mpm_run_state, only: run_info_t
  use mpm_run_tables, only: add_waiting_tables
  use mpm_status_file, only: resume_status
  use mpm_text_file, only: check_text_file, resume_text_file
  use mpm_vtkhdf, only: mark_vtkhdf, resume_vtkhdf
  implicit none
  private
  public :: resume_output, take_mark

contains

  !> Where the files stand after an increment that was written.
  subroutine take_mark(output, mark)
    type(run_output_t), intent(in) :: output  !! open
    type(output_mark_t), intent(out) :: mark

    mark%run_id = output%run_id
    mark%status = output%status%file%mark
    mark%history = output%history%mark
    call mark_vtkhdf(output%results%points, mark%points)
    call add_waiting_tables(output%tables, mark%points%n_rows)
    call mark_vtkhdf(output%results%mesh, mark%mesh)
    mark%n_written = int(output%results%n_written, ip)
    mark%n_shown = int(output%n_shown, ip)
  end subroutine take_mark

  !> Goes on with the files of an interrupted run: what is behind the mark is lost. They are
  !! checked before the first of them is changed. Counts of the log and verdicts are those of a
  !! new run.
  subroutine resume_output(output, paths, model, info, mark, message, error)
    type(run_output_t), intent(out) :: output        !! open, stands at the mark
    type(result_paths_t), intent(in) :: paths        !! files of the job
    type(model_t), intent(in) :: model               !! at time zero
    type(run_info_t), intent(in) :: info             !! deck and program
    type(output_mark_t), intent(in) :: mark          !! of the interrupted run
    character(*), intent(in) :: message              !! for the log, without line end
    type(error_t), allocatable, intent(out) :: error !! exit_file: files that do not fit
    type(run_info_t) :: same_run

    call check_text_file(paths%status, mark%status, error)
    if (allocated(error)) return
    call check_text_file(paths%history, mark%history, error)
    if (allocated(error)) return
    same_run = info
    same_run%run_id = mark%run_id
    call prepare_output(output, model, same_run)
    call open_fields(output, paths, model, same_run, error)
    if (allocated(error)) return
    associate (results => output%results)
      call resume_vtkhdf(results%points, mark%points, "/tessera", mark%run_id, error)
      call resume_vtkhdf(results%mesh, mark%mesh, "/VTKHDF", mark%run_id, error)
      results%n_written = int(mark%n_written)
      output%n_shown = int(mark%n_shown)
      if (.not. allocated(error)) call resume_texts(output, paths, model, mark, message, error)
      call publish_results(results, error)
      if (allocated(error)) call close_results(results, error)
    end associate
  end subroutine resume_output

  !> Cuts the text files to the mark and goes on with them.
  subroutine resume_texts(output, paths, model, mark, message, error)
    type(run_output_t), intent(inout) :: output      !! its text files are open
    type(result_paths_t), intent(in) :: paths        !! files of the job
    type(model_t), intent(in) :: model               !! at time zero
    type(output_mark_t), intent(in) :: mark          !! of the interrupted run
    character(*), intent(in) :: message              !! for the log
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call resume_log(output%log, paths%log, message, error)
    if (allocated(error)) return
    call resume_status(output%status, paths%status, model, mark%status, error)
    if (allocated(error)) return
    call resume_text_file(output%history, paths%history, mark%history, error)
  end subroutine resume_texts

end module mpm_output_resume
