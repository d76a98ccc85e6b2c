!> Reads many inputs in one process, for the fuzzer: each goes the way that the program sends it.
!!
!! Every line of standard input is a request, its words separated by tabs:
!!     model  DECK          deck, model, its text for the log, pattern of the first increment
!!     run    ARGUMENT...   a whole command line
!! Each is answered by a line that begins with "= ": exit code, characters of the message, 1 if it holds control
!! characters, CPU time in microseconds, largest memory of the process so far in KiB.
program fuzz_driver
  use, intrinsic :: iso_c_binding, only: c_int, c_long
  use, intrinsic :: iso_fortran_env, only: input_unit, output_unit
  use mpm_command_line, only: command_line_t, read_command_line
  use mpm_deck_card, only: deck_t
  use mpm_diagnostics, only: diagnostics_t, to_error
  use mpm_error, only: error_t, exit_deck, exit_ok
  use mpm_increments, only: begin_step, schedule_t, start_increment
  use mpm_input_deck, only: read_deck
  use mpm_kinds, only: dp
  use mpm_log_model, only: model_text
  use mpm_model, only: model_t
  use mpm_model_builder, only: build_model
  use mpm_run_job, only: run_job
  use mpm_solve_job, only: make_body, prepare_increment
  use mpm_source_excerpt, only: printable
  use mpm_system, only: body_t, free_system, open_system, system_t
  implicit none

  interface
    !> What the process has used; KiB of memory in the fifth number.
    function c_usage(who, usage) bind(c, name="getrusage") result(status)
      import :: c_int, c_long
      integer(c_int), value :: who
      integer(c_long), intent(out) :: usage(18)
      integer(c_int) :: status
    end function c_usage
  end interface

  character(*), parameter :: tab = achar(9)
  character(4096) :: line
  character(:), allocatable :: message
  real(dp) :: before, after
  integer :: code, status

  do
    read (input_unit, "(a)", iostat=status) line
    if (status /= 0) exit
    call cpu_time(before)
    if (index(line, "model"//tab) == 1) then
      call try_model(code, message, trim(line(7:)))
    else
      call try_run(code, message, trim(line(5:)))
    end if
    call cpu_time(after)
    write (output_unit, "('= ',*(i0,1x))") code, len(message), merge(0, 1, is_clean(message)), &
      nint(1.0e6_dp*(after - before)), memory()
    flush (output_unit)
  end do

contains

  !> Everything up to the first factorisation.
  subroutine try_model(code, message, path)
    integer, intent(out) :: code                          !! exit code
    character(:), allocatable, intent(out) :: message     !! empty if all is well
    character(*), intent(in) :: path                      !! deck
    type(deck_t)  :: deck
    type(model_t) :: model
    type(diagnostics_t) :: diag
    type(error_t), allocatable :: error
    character(:), allocatable :: text

    call read_deck(deck, path, diag)
    call to_error(diag, exit_deck, error)
    if (.not. allocated(error)) call build_model(model, deck, .true., diag, error)
    if (.not. allocated(error)) then
      text = model_text(model)
      call try_increment(model, error)
    end if
    call take_error(code, message, error)
  end subroutine try_model

  !> Unknowns, loads and pattern of the first increment.
  subroutine try_increment(model, error)
    type(model_t), intent(inout) :: model            !! its loads are prepared
    type(error_t), allocatable, intent(out) :: error !! what is wrong with it
    type(body_t)     :: body
    type(system_t)   :: system
    type(schedule_t) :: schedule

    call make_body(body, model)
    call open_system(system, body)
    call begin_step(schedule, 1, model%step(1)%schedule, [real(dp) ::])
    call start_increment(schedule)
    call prepare_increment(system, body, model, schedule, 0.0_dp, error)
    call free_system(system)
  end subroutine try_increment

  !> A command line.
  subroutine try_run(code, message, words)
    integer, intent(out) :: code                      !! exit code
    character(:), allocatable, intent(out) :: message !! empty if all is well
    character(*), intent(in) :: words                 !! separated by tabs
    character(len(words)), allocatable :: argument(:)
    type(command_line_t) :: options
    type(error_t), allocatable :: error
    integer :: exit_code, first, last

    allocate (argument(0))
    first = 1
    do while (first <= len(words))
      last = first + index(words(first:)//tab, tab) - 2
      argument = [character(len(words)) :: argument, words(first:last)]
      first = last + 2
    end do
    exit_code = exit_ok
    call read_command_line(options, argument, error)
    options%threads = 1
    if (.not. allocated(error)) call run_job(exit_code, options, error)
    call take_error(code, message, error)
    if (code == exit_ok) code = exit_code
  end subroutine try_run

  !> Exit code and message of an error.
  subroutine take_error(code, message, error)
    integer, intent(out) :: code                       !! exit_ok without an error
    character(:), allocatable, intent(out) :: message  !! empty without an error
    type(error_t), allocatable, intent(in) :: error    !! or unallocated

    code = exit_ok
    message = ""
    if (.not. allocated(error)) return
    code = error%code
    message = error%message
  end subroutine take_error

  !> Whether a terminal can show a message.
  pure logical function is_clean(text)
    character(*), intent(in) :: text !! lines
    character(len(text)) :: shown
    integer :: i

    shown = printable(text)
    is_clean = .true.
    do i = 1, len(text)
      if (shown(i:i) /= text(i:i) .and. text(i:i) /= new_line("a")) is_clean = .false.
    end do
  end function is_clean

  !> Largest resident memory of the process so far.
  integer function memory()
    integer(c_long) :: usage(18) !! seconds and microseconds twice, then KiB
    integer(c_int) :: failed

    failed = c_usage(0_c_int, usage)
    memory = merge(int(usage(5)), 0, failed == 0_c_int)
  end function memory

end program fuzz_driver
