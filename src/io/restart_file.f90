!> JOB.restart.h5: a run on the disk, to go on from.
module mpm_restart_file
  use mpm_error, only: error_t
  use mpm_file_exchange, only: remove_file, rotate_file
  use mpm_kinds, only: dp
  use mpm_model, only: model_t, restart_by_clock
  use mpm_record_file, only: close_record, create_record, open_record, record_t, seal_record
  use mpm_record_values, only: exchange_integer, exchange_reals, exchange_text, refuse_value
  use mpm_restart_state, only: exchange_body, exchange_factors, exchange_run_state, &
                               exchange_schedule, exchange_starts, exchange_watch, restart_t
  use mpm_run_state, only: make_run_state
  implicit none
  private
  public :: is_restart_due, open_restart, read_restart, write_restart

  real(dp), parameter :: seconds_between = 600.0_dp !! restart files without *RESTART [s]
  character(*), parameter :: suffix = ".next" !! of the file that is being written

contains

  !> Whether a restart file is due after an increment.
  pure logical function is_restart_due(frequency, increment, ends_step, seconds) result(due)
    integer, intent(in)  :: frequency !! of *RESTART: every so many increments, 0 = the last one of
                                      !! a step; restart_by_clock without *RESTART
    integer, intent(in)  :: increment !! number in the step
    logical, intent(in)  :: ends_step !! it is the last one of the step
    real(dp), intent(in) :: seconds   !! since the last restart file, or since the start [s]

    if (frequency == restart_by_clock) then
      due = seconds >= seconds_between
    else
      due = ends_step
      if (frequency > 0) due = due .or. mod(increment, frequency) == 0
    end if
  end function is_restart_due

  !> Writes a new file, brings it to the disk and lets it take the place of the last one, which
  !! becomes the previous one. A failure leaves both as they were.
  subroutine write_restart(restart, model, present, previous, error)
    type(restart_t), intent(inout) :: restart        !! complete; not changed
    type(model_t), intent(inout)   :: model          !! not changed
    character(*), intent(in) :: present              !! JOB.restart.h5
    character(*), intent(in) :: previous             !! JOB.restart.1.h5
    type(error_t), allocatable, intent(out) :: error !! exit_file, for example a full disk
    type(record_t) :: record

    call create_record(record, present//suffix, error)
    call exchange_identity(record, restart, error)
    call exchange_run(record, restart, model, error)
    call close_record(record, error)
    if (.not. allocated(error)) call seal_record(present//suffix, error)
    if (.not. allocated(error)) call rotate_file(present//suffix, present, previous, error)
    if (allocated(error)) call remove_file(present//suffix)
  end subroutine write_restart

  !> Opens a file and reads what run it belongs to, which is to be compared with the deck before
  !! the rest is read.
  subroutine open_restart(record, restart, path, error)
    type(record_t), intent(out)  :: record           !! open
    type(restart_t), intent(out) :: restart          !! its identity and its schedule
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file: no such file, damaged ...

    call open_record(record, path, error)
    call exchange_identity(record, restart, error)
  end subroutine open_restart

  !> Reads the rest and closes the file.
  subroutine read_restart(restart, record, model, error)
    type(restart_t), intent(inout) :: restart        !! complete on return
    type(record_t), intent(inout)  :: record         !! open; closed on return
    type(model_t), intent(inout)   :: model          !! the model that was compared; constraints of
                                                     !! the step get their starts
    type(error_t), allocatable, intent(out) :: error !! exit_file: a value that does not fit

    restart%points = model%points
    restart%surface = model%surface
    restart%mesh_x = model%mesh%x
    allocate (restart%u_start(model%mesh%n_dim, merge(model%points%n, 0, &
                              in_geostatic_step(model, restart%schedule%step))), source=0.0_dp)
    call make_run_state(restart%state, model%mesh%n_dim, model%mesh%n_node, model%mesh%n_el, &
                        model%patches%n)
    call exchange_run(record, restart, model, error)
    call close_record(record, error)
    restart%is_loaded = .not. allocated(error)
  end subroutine read_restart

  !> Whether a step looks at the way of the points since its beginning.
  pure logical function in_geostatic_step(model, i_step)
    type(model_t), intent(in) :: model
    integer, intent(in)       :: i_step !! number of the step, 0: none has begun

    in_geostatic_step = .false.
    if (i_step >= 1 .and. i_step <= size(model%step)) &
      in_geostatic_step = model%step(i_step)%geostatic
  end function in_geostatic_step

  !> What run it is and where it stands.
  subroutine exchange_identity(record, restart, error)
    type(record_t), intent(in) :: record               !! open
    type(restart_t), intent(inout) :: restart          !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_text(record, "written_by", restart%written_by, error)
    call exchange_text(record, "formulation", restart%formulation, error)
    call exchange_text(record, "deck_signature", restart%deck_signature, error)
    call exchange_text(record, "model_signature", restart%model_signature, error)
    call exchange_schedule(record, restart%schedule, error)
    if (allocated(error)) return
    associate (schedule => restart%schedule)
      if (schedule%step < 0 .or. schedule%increment < 0 .or. schedule%attempt /= 0 .or. &
          schedule%step_time < 0.0_dp) then
        call refuse_value(record, "schedule", "the schedule of a run", error)
      end if
    end associate
  end subroutine exchange_identity

  !> The state of the run.
  subroutine exchange_run(record, restart, model, error)
    type(record_t), intent(in) :: record               !! open
    type(restart_t), intent(inout) :: restart          !! written, or read
    type(model_t), intent(inout) :: model              !! constraints get their starts
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_run_state(record, restart%state, error)
    call exchange_watch(record, restart%watch, error)
    call exchange_factors(record, restart%factors, error)
    call exchange_starts(record, model, restart%schedule%step, error)
    call exchange_body(record, restart, model%mesh%n_el, error)
    call exchange_text(record, "output_mark", restart%output_mark, error)
    call exchange_text(record, "verdicts", restart%verdicts, error)
    call exchange_reals(record, "seconds", shape(restart%seconds), restart%seconds, error)
    call exchange_integer(record, "n_attempts", restart%n_attempts, error)
    call exchange_integer(record, "n_iterations", restart%n_iterations, error)
  end subroutine exchange_run

end module mpm_restart_file
