!> A job from its deck to its results: what the command line asks for, formulation by formulation.
module mpm_run_job
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use mpm_command_line, only: command_line_t
  use mpm_deck_card, only: deck_t, folder_of
  use mpm_deck_signature, only: deck_signature
  use mpm_diagnostics, only: diagnostics_t, to_error, warnings_text
  use mpm_error, only: error_t, exit_deck, exit_expectation, exit_file, &
                       exit_interrupted, exit_ok, exit_terminated, make_error
  use mpm_estimate_job, only: estimate_job
  use mpm_expectations, only: n_failed_expectations, verdict_line
  use mpm_increments, only: begin_step, schedule_t, start_increment
  use mpm_input_deck, only: read_deck
  use mpm_interruption, only: catch_signals, received_signal, signal_interrupt
  use mpm_kinds, only: dp
  use mpm_log_model, only: model_text
  use mpm_model, only: formulation_fbar, formulation_standard, model_t
  use mpm_model_builder, only: build_model
  use mpm_output_mark, only: output_mark_t, read_mark
  use mpm_output_resume, only: resume_output
  use mpm_restart_load, only: load_restart
  use mpm_restart_point, only: place_text
  use mpm_restart_state, only: restart_t
  use mpm_result_paths, only: are_there_results, existing_results, make_folder, result_paths, &
                              result_paths_t
  use mpm_run_estimate, only: estimate_text, run_estimate_t
  use mpm_run_log, only: log_message
  use mpm_run_memory, only: check_memory
  use mpm_run_output, only: close_output, open_output, run_output_t
  use mpm_run_state, only: make_run_info, run_info_t, run_state_t
  use mpm_source_excerpt, only: printable
  use mpm_solve_job, only: make_body, prepare_increment, solve_job
  use mpm_system, only: body_t, free_system, open_system, system_t
  use mpm_tangent_check, only: check_tangent, tangent_report_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: run_job

  real(dp), parameter :: tangent_tolerance = 1.0e-7_dp !! of --check-tangent

contains

  !> Reads the deck, builds the model and runs every formulation asked for.
  subroutine run_job(exit_code, options, error)
    integer, intent(out) :: exit_code            !! the largest one of all formulations
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    type(deck_t)   :: deck
    type(model_t)  :: model, variant
    type(run_info_t) :: info
    integer, allocatable :: formulation(:)
    character(:), allocatable :: warnings
    integer :: i, code

    exit_code = exit_ok
    call read_model(model, deck, warnings, options, error)
    if (.not. allocated(error)) call check_memory(model, options%max_memory, error)
    if (allocated(error)) return
    formulation = formulations(options, model)
    call make_run_info(info, deck%file(1)%path, deck%source, options%threads, options%quiet)
    info%verbose = options%verbose
    if (options%publish >= 0.0_dp) info%publish_interval = options%publish
    info%warnings = warnings
    call catch_signals()
    do i = 1, size(formulation)
      if (received_signal() /= 0) then
        exit_code = merge(exit_interrupted, exit_terminated, received_signal() == signal_interrupt)
        return
      end if
      info%formulation = formulation_name(formulation(i))
      if (i < size(formulation)) then
        variant = model
        call run_variant(code, variant, formulation(i), deck, info, options, error)
      else
        call run_variant(code, model, formulation(i), deck, info, options, error)
      end if
      if (allocated(error)) return
      exit_code = max(exit_code, code)
    end do
  end subroutine run_job

  !> What the options ask for, with one formulation.
  subroutine run_variant(exit_code, model, formulation, deck, info, options, error)
    integer, intent(out)          :: exit_code
    type(model_t), intent(inout)  :: model       !! used up
    integer, intent(in)           :: formulation !! formulation_*
    type(deck_t), intent(in)      :: deck
    type(run_info_t), intent(in)  :: info
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error

    call choose_formulation(model, formulation, size(options%compare) > 0)
    if (options%check_tangent) then
      call run_tangent_check(exit_code, model, error)
    else if (options%estimate) then
      call run_estimate(exit_code, model, options, error)
    else
      call run_formulation(exit_code, model, deck, info, options, error)
    end if
  end subroutine run_variant

  !> Deck and model; warnings go to stderr, as part of the error if there is one.
  subroutine read_model(model, deck, warnings, options, error)
    type(model_t), intent(out) :: model
    type(deck_t), intent(out)  :: deck
    character(:), allocatable, intent(out) :: warnings !! empty if there is none
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    type(diagnostics_t) :: diag

    warnings = ""
    call read_deck(deck, options%deck, diag)
    call to_error(diag, exit_deck, error)
    if (allocated(error)) return
    call build_model(model, deck, options%lax, diag, error)
    if (allocated(error)) return
    warnings = warnings_text(diag)
    if (len(warnings) > 0) write (error_unit, "(a)") warnings
  end subroutine read_model

  !> Formulations of --compare, else that of the deck.
  pure function formulations(options, model) result(list)
    type(command_line_t), intent(in) :: options
    type(model_t), intent(in)        :: model
    integer, allocatable :: list(:)

    list = [model%formulation]
    if (allocated(options%compare)) then
      if (size(options%compare) > 0) list = options%compare
    end if
  end function formulations

  !> Makes a model one of --compare. Expectations belong to the formulation of the deck.
  subroutine choose_formulation(model, formulation, named)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: formulation !! formulation_*
    logical, intent(in) :: named       !! .true.: the job gets the name of the formulation
    integer :: i

    if (formulation /= model%formulation) then
      do i = 1, size(model%step)
        if (allocated(model%step(i)%expectation)) deallocate (model%step(i)%expectation)
      end do
    end if
    model%formulation = formulation
    if (named) model%job = model%job//"_"//formulation_name(formulation)
  end subroutine choose_formulation

  !> Name of a formulation on the command line and in names of jobs.
  pure function formulation_name(formulation) result(name)
    integer, intent(in) :: formulation !! formulation_*
    character(:), allocatable :: name

    select case (formulation)
    case (formulation_standard)
      name = "standard"
    case (formulation_fbar)
      name = "fbar"
    case default
      name = "unknown"
    end select
  end function formulation_name

  !> One run with all its files.
  subroutine run_formulation(exit_code, model, deck, info, options, error)
    integer, intent(out)          :: exit_code
    type(model_t), intent(inout)  :: model
    type(deck_t), intent(in)      :: deck
    type(run_info_t), intent(in)  :: info
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    type(result_paths_t) :: paths
    type(run_output_t)   :: output
    type(run_state_t)    :: state
    type(restart_t)      :: restart
    type(run_estimate_t) :: estimate
    type(error_t), allocatable :: failure
    character(:), allocatable  :: folder, text

    exit_code = exit_ok
    if (len(options%restart) > 0) then
      call load_restart(restart, options%restart, deck, model, info%formulation, error)
      if (allocated(error)) return
      if (options%check) then
        write (output_unit, "(a)") model%job//": restart file "//options%restart// &
          " belongs to this deck, "//place_text(restart)
        return
      end if
    end if
    if (options%max_memory > 0.0_dp .and. .not. restart%is_loaded) then
      call estimate_job(estimate, model, options%max_memory, .false., error)
      if (allocated(error)) return
    end if
    folder = options%output
    if (len(folder) == 0) folder = folder_of(options%deck)
    call make_folder(folder, error)
    if (allocated(error)) return
    paths = result_paths(folder, model%job)
    if (restart%is_loaded) then
      call open_restarted(output, paths, model, info, restart, options, error)
    else
      if (.not. options%force) call existing_results(paths, error)
      if (allocated(error)) return
      call open_output(output, paths, model, info, error)
    end if
    if (allocated(error)) return
    restart%deck_signature = deck_signature(deck)
    restart%formulation = info%formulation
    restart%written_by = info%version//" "//info%git
    if (.not. options%quiet .and. (options%check .or. options%verbose)) text = model_text(model)
    call solve_job(output, state, model, restart, options%check, options%max_memory, &
                   failure)
    if (allocated(failure)) then
      exit_code = failure%code
      call log_message(output%log, failure%message, error)
    else if (.not. options%check .and. n_failed_expectations(output%verdict) > 0) then
      exit_code = exit_expectation
    end if
    call close_output(output, model, state, exit_code, error)
    if (allocated(text)) write (output_unit, "(a)") text
    if (.not. options%quiet) call print_summary(output, paths, model%job, options%check)
    if (options%quiet .and. exit_code == exit_expectation) call print_failures(output)
    if (allocated(failure)) call move_alloc(failure, error)
  end subroutine run_formulation

  !> Opens the files of a run that goes on: beside its results these are continued, elsewhere new
  !! ones begin with the state of the restart.
  subroutine open_restarted(output, paths, model, info, restart, options, error)
    type(run_output_t), intent(out)  :: output       !! open
    type(result_paths_t), intent(in) :: paths        !! files of the job
    type(model_t), intent(in)        :: model        !! at time zero
    type(run_info_t), intent(in)     :: info
    type(restart_t), intent(in)      :: restart      !! loaded
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error !! exit_file: results that do not fit
    type(output_mark_t) :: mark
    character(:), allocatable :: message
    logical :: is_mark

    message = "restarted "//info%started//" from "//options%restart//" at "//place_text(restart)// &
              ", written by Tessera "//printable(restart%written_by)
    if (are_there_results(paths)) then
      call read_mark(mark, restart%output_mark, is_mark)
      if (is_mark) then
        call resume_output(output, paths, model, info, mark, message, error)
      else
        call make_error(error, exit_file, "error: restart file '"//options%restart// &
                        "' does not fit: output_mark: expected where the results stand")
      end if
      output%is_resumed = .not. allocated(error)
      return
    end if
    call open_output(output, paths, model, info, error)
    if (.not. allocated(error)) call log_message(output%log, message, error)
  end subroutine open_restarted

  !> What was run, what came out and where it is.
  subroutine print_summary(output, paths, job, only_check)
    type(run_output_t), intent(in)   :: output
    type(result_paths_t), intent(in) :: paths
    character(*), intent(in)         :: job
    logical, intent(in)              :: only_check
    integer :: i

    if (.not. only_check) then
      do i = 1, size(output%verdict)
        write (output_unit, "(a)") verdict_line(output%verdict(i))
      end do
    end if
    write (output_unit, "(a)") job//": log "//paths%log//", history "//paths%history// &
      ", fields "//paths%points//" and "//paths%mesh
  end subroutine print_summary

  !> Expectations that failed: also a quiet run tells why it ends with an exit code.
  subroutine print_failures(output)
    type(run_output_t), intent(in) :: output
    integer :: i

    do i = 1, size(output%verdict)
      if (.not. output%verdict(i)%met) write (error_unit, "(a)") verdict_line(output%verdict(i))
    end do
  end subroutine print_failures

  !> --estimate: what the run will need.
  subroutine run_estimate(exit_code, model, options, error)
    integer, intent(out)         :: exit_code
    type(model_t), intent(inout) :: model
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error !! also more memory than is allowed
    type(run_estimate_t) :: estimate

    exit_code = exit_ok
    call estimate_job(estimate, model, options%max_memory, .true., error)
    if (.not. allocated(estimate%job)) return
    estimate%formulation = formulation_name(model%formulation)
    write (output_unit, "(a)") estimate_text(estimate)
  end subroutine run_estimate

  !> --check-tangent: the tangent of the first increment at a random state.
  subroutine run_tangent_check(exit_code, model, error)
    integer, intent(out)         :: exit_code !! exit_expectation when the tangent is wrong
    type(model_t), intent(inout) :: model
    type(error_t), allocatable, intent(out) :: error
    type(body_t)     :: body
    type(system_t)   :: system
    type(schedule_t) :: schedule
    type(tangent_report_t) :: report

    exit_code = exit_ok
    call make_body(body, model)
    call open_system(system, body)
    call begin_step(schedule, 1, model%step(1)%schedule, [real(dp) ::])
    call start_increment(schedule)
    call prepare_increment(system, body, model, schedule, 0.0_dp, error)
    if (.not. allocated(error)) call check_tangent(report, system, body)
    call free_system(system)
    if (allocated(error)) return
    if (.not. report%error <= tangent_tolerance .or. .not. report%evaluated) exit_code = exit_expectation
    write (output_unit, "(a)") model%job//" ("//formulation_name(model%formulation)// &
      "): tangent against central differences, relative difference "//real_text(report%error)// &
      ", allowed "//real_text(tangent_tolerance)//"; "//integer_text(report%n_columns)// &
      " columns compared, "//integer_text(report%n_skipped)//" left out at the yield surface; "// &
      integer_text(report%n_plastic)//" of "//integer_text(body%points%n)//" points plastic"
  end subroutine run_tangent_check

end module mpm_run_job
