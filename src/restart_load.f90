!> A restart file is read: whether it belongs to the deck, and the run put back where it was.
module mpm_restart_load
  use mpm_analysis_run, only: analysis_t
  use mpm_clock, only: wall_time
  use mpm_deck_card, only: deck_t
  use mpm_deck_signature, only: check_signature
  use mpm_error, only: error_t, exit_deck, exit_file, make_error
  use mpm_expectations, only: collect_expectations, verdict_t
  use mpm_increments, only: resume_step
  use mpm_kinds, only: dp
  use mpm_material_points, only: group_points, hand_over
  use mpm_mesh, only: build_geometry
  use mpm_model, only: model_t
  use mpm_model_signature, only: check_model
  use mpm_record_file, only: close_record, record_t
  use mpm_recycled_solver, only: factor_memory_t, restore_factors
  use mpm_restart_file, only: open_restart, read_restart
  use mpm_restart_state, only: restart_t
  use mpm_run_state, only: run_state_t
  use mpm_source_excerpt, only: printable
  use mpm_text, only: integer_text
  use mpm_verdict_record, only: restore_verdicts
  implicit none
  private
  public :: load_restart, restore_point

  integer, parameter :: most_increments = 1000000000 !! of a step

contains

  !> Reads a restart file that belongs to a deck.
  subroutine load_restart(restart, path, deck, model, formulation, error)
    type(restart_t), intent(out) :: restart          !! complete
    character(*), intent(in) :: path                 !! restart file
    type(deck_t), intent(in) :: deck                 !! the deck now
    type(model_t), intent(inout) :: model            !! of the deck; constraints get their starts
    character(*), intent(in) :: formulation          !! of this run, standard or fbar
    type(error_t), allocatable, intent(out) :: error !! exit_file, exit_deck or exit_model
    type(record_t) :: record
    type(verdict_t), allocatable :: verdicts(:)
    type(error_t), allocatable :: ignored

    call open_restart(record, restart, path, error)
    if (.not. allocated(error)) call compare(restart, path, deck, model, formulation, error)
    if (allocated(error)) then
      call close_record(record, ignored)
      return
    end if
    call read_restart(restart, record, model, error)
    if (allocated(error)) return
    if (restart%state%step /= restart%schedule%step) then
      call make_error(error, exit_file, "error: restart file '"//path//"' does not fit: "// &
                      "state_step: expected the step of its schedule")
      return
    end if
    ! Before any file is opened: whether all expectations can be decided.
    call collect_expectations(verdicts, model)
    call restore_verdicts(verdicts, restart%verdicts, restart%state%time, error)
  end subroutine load_restart

  !> Whether a restart file belongs to a deck.
  subroutine compare(restart, path, deck, model, formulation, error)
    type(restart_t), intent(in) :: restart           !! its identity
    character(*), intent(in) :: path                 !! restart file
    type(deck_t), intent(in) :: deck                 !! the deck now
    type(model_t), intent(in) :: model               !! of the deck
    character(*), intent(in) :: formulation          !! of this run
    type(error_t), allocatable, intent(out) :: error !! exit_deck or exit_model

    if (restart%formulation /= formulation) then
      call make_error(error, exit_deck, "error: restart file '"//path//"' is of a run with "// &
                      "formulation "//printable(restart%formulation)//": this run has "// &
                      formulation//", expected the same (--compare "// &
                      printable(restart%formulation)//")")
      return
    end if
    call check_signature(deck, restart%deck_signature, restart%schedule%step, error)
    if (allocated(error)) return
    if (restart%schedule%step > size(model%step)) then
      call make_error(error, exit_deck, "error: restart file '"//path//"' was written in step "// &
                      integer_text(restart%schedule%step)//": expected a deck with that many steps")
      return
    end if
    call check_model(model, restart%model_signature, restart%schedule%step, error)
    if (allocated(error) .or. restart%schedule%step == 0) return
    associate (schedule => restart%schedule, period => model%step(restart%schedule%step)%schedule%period)
      if (schedule%increment < most_increments .and. schedule%planned > 0.0_dp .and. schedule%step_time <= period .and. &
          (schedule%finished .eqv. schedule%step_time >= period)) return
    end associate
    call make_error(error, exit_file, "error: restart file '"//path//"' does not fit: schedule: "// &
                    "expected a time in its step")
  end subroutine compare

  !> Puts a run back where its restart file was written.
  subroutine restore_point(analysis, state, model, stop_time, error)
    type(analysis_t), intent(inout) :: analysis !! body at time zero, kept was loaded; restored
    type(run_state_t), intent(out) :: state     !! after the last accepted increment
    type(model_t), intent(in) :: model          !! of the deck now
    real(dp), intent(in) :: stop_time(:)        !! step times to be hit in the step it goes on in
    type(error_t), allocatable, intent(out) :: error !! exit_file: no mesh
    integer :: inverted

    state = analysis%kept%state
    state%started = wall_time() - state%wall_seconds
    analysis%schedule = analysis%kept%schedule
    if (analysis%schedule%step > 0) then
      call resume_step(analysis%schedule, model%step(analysis%schedule%step)%schedule, stop_time)
    end if
    associate (body => analysis%body)
      body%mesh%x = analysis%kept%mesh_x
      call build_geometry(body%mesh, inverted)
      call hand_over(analysis%kept%points, body%points)
      call group_points(body%points, body%mesh%n_el)
      body%surface = analysis%kept%surface
    end associate
    analysis%system%u_last = state%delta_u
    analysis%u_start = analysis%kept%u_start
    analysis%watch = analysis%kept%watch
    call restore_factors(analysis%system%recycler, analysis%kept%factors)
    analysis%kept%factors = factor_memory_t() ! the system has them
    deallocate (analysis%kept%mesh_x)
    if (inverted > 0) call make_error(error, exit_file, "error: the restart file does not fit: "// &
                                      "mesh_x: expected elements that are not inside out")
  end subroutine restore_point

end module mpm_restart_load
