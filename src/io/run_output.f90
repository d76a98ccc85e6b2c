!> All output of a run, driven by three events: an attempt, an accepted increment, the end.
module mpm_run_output
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mpm_clock, only: wall_time
  use mpm_error, only: error_t, exit_expectation, exit_ok
  use mpm_expectations, only: collect_expectations, evaluate_expectations, is_expected, verdict_t
  use mpm_file_exchange, only: remove_file
  use mpm_hdf5_file, only: write_text_attribute
  use mpm_history, only: open_history, units_of, write_history_row
  use mpm_history_columns, only: history_column_t, history_columns, history_values
  use mpm_iteration_watch, only: iteration_watch_t
  use mpm_kinds, only: dp
  use mpm_ledger, only: point_ledger
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_model, only: model_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_text
  use mpm_progress, only: end_progress, show_progress
  use mpm_publication, only: is_publication_due, note_publication, publication_t
  use mpm_result_paths, only: result_paths_t
  use mpm_results_file, only: close_results, is_field_output_due, open_results, publish_results, &
                              results_file_t, write_increment_fields
  use mpm_run_log, only: attempt_text, close_log, locking_text, log_attempt, log_message, &
                         log_summary, open_log, run_log_t
  use mpm_run_state, only: estimated_time_left, run_info_t, run_state_t
  use mpm_run_tables, only: append_history, append_iterations, append_ledger, n_waiting, &
                            open_tables, run_tables_t, write_tables
  use mpm_status_file, only: open_status, status_file_t, write_status
  use mpm_text_file, only: close_text_file, ignore_size_signal, text_file_t
  implicit none
  private
  public :: run_output_t, close_output, open_output, write_attempt, write_increment
  public :: open_fields, prepare_output, publish_output, write_last_state

  integer, parameter :: most_waiting = 4096 !! rows of a table in memory

  !> Everything that is open during a run. Between iterations, results that wait are published.
  type, extends(iteration_watch_t) :: run_output_t
    type(run_log_t)      :: log                      !! JOB.log
    type(status_file_t)  :: status                   !! JOB.sta
    type(text_file_t)    :: history                  !! JOB_history.csv
    type(results_file_t) :: results                  !! JOB.vtkhdf and JOB_mesh.vtkhdf
    type(run_tables_t)   :: tables                   !! group /tessera of JOB.vtkhdf
    type(publication_t)  :: publication              !! of the results and the tables
    type(history_column_t), allocatable :: column(:) !! of *HISTORY
    type(verdict_t), allocatable :: verdict(:)       !! of *EXPECT
    logical :: quiet = .false.                       !! no progress on stderr
    logical :: verbose = .false.                     !! every Newton iteration on stderr
    logical :: is_resumed = .false.                  !! the files of an interrupted run go on
    logical :: metered = .false.                     !! log or deck ask for the locking meter
    type(result_paths_t) :: paths                    !! of all files
    integer :: n_shown = -1                          !! accepted increments at the last field output
    real(dp) :: told(3) = 0.0_dp                     !! seconds in earlier rows of the ledger
    character(:), allocatable :: run_id              !! no other run has it
    type(error_t), allocatable :: failure            !! between iterations, not told yet
  contains
    procedure :: note_iteration => publish_between_iterations
  end type run_output_t

contains

  !> Opens all files of a run. Earlier results are overwritten: see mpm_result_paths before.
  subroutine open_output(output, paths, model, info, error)
    type(run_output_t), intent(out) :: output        !! open
    type(result_paths_t), intent(in) :: paths        !! files of the job
    type(model_t), intent(in) :: model               !! at time zero
    type(run_info_t), intent(in) :: info             !! deck and program
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call prepare_output(output, model, info)
    call remove_file(paths%failure) ! of an earlier run
    call open_log(output%log, paths%log, model, info, error)
    if (allocated(error)) return
    call open_status(output%status, paths%status, model, error)
    if (allocated(error)) return
    call open_history(output%history, paths%history, output%column, model, info, error)
    if (allocated(error)) return
    call open_fields(output, paths, model, info, error)
  end subroutine open_output

  !> What a run writes, before any file is open.
  subroutine prepare_output(output, model, info)
    type(run_output_t), intent(inout) :: output      !! ready to open its files
    type(model_t), intent(in) :: model               !! at time zero
    type(run_info_t), intent(in) :: info             !! how much to tell

    call ignore_size_signal()
    output%quiet = info%quiet
    output%verbose = info%verbose
    output%run_id = info%run_id
    output%publication%interval = info%publish_interval
    output%column = history_columns(model)
    call collect_expectations(output%verdict, model)
    output%metered = model%locking_meter .or. is_expected(output%verdict, "CHECKERBOARD")
  end subroutine prepare_output

  !> Opens JOB.vtkhdf and JOB_mesh.vtkhdf without rows. Earlier ones stay until the first output.
  subroutine open_fields(output, paths, model, info, error)
    type(run_output_t), intent(inout) :: output      !! both are open, or none after an error
    type(result_paths_t), intent(in) :: paths        !! files of the job
    type(model_t), intent(in) :: model               !! at time zero
    type(run_info_t), intent(in) :: info             !! deck and program
    type(error_t), allocatable, intent(out) :: error !! exit_file

    output%paths = paths
    call open_results(output%results, paths%points, paths%mesh, model, error)
    if (.not. allocated(error)) then
      call open_tables(output%tables, output%results%points%file, output%column, info, &
                       units_of(model), error)
    end if
    call write_text_attribute(output%results%mesh%file, "/VTKHDF", "run", info%run_id, error)
    if (allocated(error)) call close_results(output%results, error)
  end subroutine open_fields

  !> Writes what Newton's method did in an attempt, converged or not, and adds up the time it takes.
  subroutine write_attempt(output, state, report, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(run_state_t), intent(in) :: state           !! after the attempt
    type(newton_report_t), intent(in) :: report      !! of the attempt
    type(error_t), allocatable, intent(out) :: error !! exit_file
    real(dp) :: start

    call cpu_time(start)
    call write_rows_of_attempt(output, state, report, error)
    call count_since(output%log, start)
  end subroutine write_attempt

  !> Adds the CPU time since a reading to that of output.
  subroutine count_since(log, start)
    type(run_log_t), intent(inout) :: log !! its seconds of output grow
    real(dp), intent(in) :: start         !! reading of cpu_time [s]
    real(dp) :: now

    call cpu_time(now)
    log%output_seconds = log%output_seconds + now - start
  end subroutine count_since

  !> Writes log, status and iterations of an attempt, and shows it.
  subroutine write_rows_of_attempt(output, state, report, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(run_state_t), intent(in) :: state           !! after the attempt
    type(newton_report_t), intent(in) :: report      !! of the attempt
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call log_attempt(output%log, state, report, error)
    if (allocated(error)) return
    call write_status(output%status, state, outcome_text(report%outcome), error)
    if (allocated(error)) return
    call move_alloc(output%failure, error)
    if (allocated(error)) return
    call append_iterations(output%tables, state, report)
    call limit_waiting(output, error)
    if (report%outcome /= outcome_converged) call publish_if_due(output, error)
    if (allocated(error) .or. output%quiet) return
    if (output%verbose) then
      write (error_unit, "(a)") attempt_text(state, report)
      return
    end if
    call show_progress(state, estimated_time_left(state, output%status%end_time))
  end subroutine write_rows_of_attempt

  !> Writes an accepted increment; before the first one, the state at time zero. Adds up the time.
  subroutine write_increment(output, model, mesh, points, state, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(model_t), intent(in)     :: model           !! steps and patches
    type(mesh_t), intent(in)      :: mesh            !! where it is now
    type(points_t), intent(in)    :: points          !! converged state
    type(run_state_t), intent(in) :: state           !! after the increment
    type(error_t), allocatable, intent(out) :: error !! exit_file
    real(dp) :: start

    call cpu_time(start)
    call write_rows_and_fields(output, model, mesh, points, state, error)
    call count_since(output%log, start)
  end subroutine write_increment

  !> Writes the rows of an accepted increment, and its fields when they are due.
  subroutine write_rows_and_fields(output, model, mesh, points, state, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(model_t), intent(in)     :: model           !! steps and patches
    type(mesh_t), intent(in)      :: mesh            !! where it is now
    type(points_t), intent(in)    :: points          !! converged state
    type(run_state_t), intent(in) :: state           !! after the increment
    type(error_t), allocatable, intent(out) :: error !! exit_file
    real(dp), allocatable :: values(:)
    real(dp) :: seconds(3)
    logical :: due

    if (model%locking_meter .and. state%step > 0) then
      call log_message(output%log, locking_text(state), error)
    end if
    if (allocated(error)) return
    allocate (values(size(output%column)))
    values(:) = history_values(output%column, points, model%patches, state)
    call write_history_row(output%history, state, values, error)
    if (allocated(error)) return
    call append_history(output%tables, state, values)
    seconds = [state%location_seconds, output%log%output_seconds, state%point_loop_seconds]
    call append_ledger(output%tables, state, point_ledger(points), seconds - output%told)
    output%told = seconds
    call limit_waiting(output, error)
    call evaluate_expectations(output%verdict, points, model%patches, state)
    due = state%step == 0 .or. output%n_shown < 0 ! the first one, also after a restart
    if (.not. due) due = is_field_output_due(model%step(state%step), state)
    if (due .and. .not. allocated(error)) then
      output%n_shown = state%increment_total
      call write_increment_fields(output%results, model, mesh, points, state, error)
    end if
    call publish_if_due(output, error)
  end subroutine write_rows_and_fields

  !> Notes that results wait, and writes the tables when too many of their rows are in memory.
  subroutine limit_waiting(output, error)
    type(run_output_t), intent(inout) :: output        !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    output%publication%is_waiting = .true.
    if (n_waiting(output%tables) < most_waiting) return
    call write_tables(output%tables, output%results%points%file, error)
  end subroutine limit_waiting

  !> Publishes what waits when the last time is long enough ago.
  subroutine publish_if_due(output, error)
    type(run_output_t), intent(inout) :: output        !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    if (is_publication_due(output%publication, wall_time())) call publish_output(output, error)
  end subroutine publish_if_due

  !> Makes everything that was written visible to a reader of the results.
  subroutine publish_output(output, error)
    type(run_output_t), intent(inout) :: output      !! open, nothing waits
    type(error_t), allocatable, intent(out) :: error !! exit_file

    if (.not. output%publication%is_waiting) return
    call write_tables(output%tables, output%results%points%file, error)
    call publish_results(output%results, error)
    if (.not. allocated(error)) call note_publication(output%publication, wall_time())
  end subroutine publish_output

  !> An increment that takes long does not hide the one before it. A failure is told after the
  !! attempt.
  subroutine publish_between_iterations(watch)
    class(run_output_t), intent(inout) :: watch !! open; perhaps nothing waits any more
    type(error_t), allocatable :: failure
    real(dp) :: start

    if (allocated(watch%failure)) return
    if (.not. is_publication_due(watch%publication, wall_time())) return
    call cpu_time(start)
    call publish_output(watch, failure)
    call move_alloc(failure, watch%failure)
    call count_since(watch%log, start)
  end subroutine publish_between_iterations

  !> Writes the fields of the last accepted increment before a run ends early, unless they are
  !! there already.
  subroutine write_last_state(output, model, mesh, points, state, error)
    type(run_output_t), intent(inout) :: output      !! open
    type(model_t), intent(in)     :: model           !! steps and patches
    type(mesh_t), intent(in)      :: mesh            !! where it is now
    type(points_t), intent(in)    :: points          !! converged state
    type(run_state_t), intent(in) :: state           !! after the last accepted increment
    type(error_t), allocatable, intent(out) :: error !! exit_file

    if (output%n_shown == state%increment_total) return
    output%n_shown = state%increment_total
    call write_increment_fields(output%results, model, mesh, points, state, error)
  end subroutine write_last_state

  !> Publishes the results, writes the summary and closes everything. The results come first: who
  !! reads in the log how a run has ended finds all of them.
  subroutine close_output(output, model, state, exit_code, error)
    type(run_output_t), intent(inout) :: output      !! closed
    type(model_t), intent(in) :: model               !! node sets
    type(run_state_t), intent(in) :: state           !! at the end of the run
    integer, intent(in) :: exit_code                 !! of the program
    type(error_t), allocatable, intent(out) :: error !! exit_file: the first one that occurs
    type(error_t), allocatable :: failure
    integer :: code

    if (.not. output%quiet) call end_progress()
    code = exit_code
    call close_fields(output, error)
    if (allocated(error)) then
      if (any(code == [exit_ok, exit_expectation])) code = error%code
      call log_message(output%log, error%message, failure)
    end if
    call log_summary(output%log, model, state, output%verdict, code, failure)
    call keep_first(error, failure)
    call close_log(output%log, failure)
    call keep_first(error, failure)
    call close_text_file(output%status%file, failure)
    call keep_first(error, failure)
    call close_text_file(output%history, failure)
    call keep_first(error, failure)
  end subroutine close_output

  !> Publishes and closes the results. Those that have failed before are only closed.
  subroutine close_fields(output, error)
    type(run_output_t), intent(inout) :: output      !! its results are closed
    type(error_t), allocatable, intent(out) :: error !! exit_file
    real(dp) :: start

    call cpu_time(start)
    associate (file => output%results%points%file)
      if (.not. file%has_failed) call write_tables(output%tables, file, error)
    end associate
    call close_results(output%results, error)
    call count_since(output%log, start)
  end subroutine close_fields

  !> Keeps an error unless there is one already.
  pure subroutine keep_first(error, failure)
    type(error_t), allocatable, intent(inout) :: error   !! the first one
    type(error_t), allocatable, intent(inout) :: failure !! a later one

    if (.not. allocated(error)) call move_alloc(failure, error)
  end subroutine keep_first

end module mpm_run_output
