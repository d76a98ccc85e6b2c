!> Runs the tests of a suite and counts them: the part of the stand-in for pFUnit that holds state.
!!
!! An assertion has no argument through which it could report to the runner, so the running test,
!! its messages and the counters are variables of this module.
module pf_run
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: int64, output_unit
  implicit none
  private
  public :: anyExceptions, finish, run_test, SourceLocation, start, throw

  !> Where an assertion stands.
  type :: SourceLocation
    character(:), allocatable :: file !! name of the .pf file
    integer :: line = 0               !! line in that file
  end type SourceLocation

  interface
    !> Ends the program with any status: a Fortran 2008 stop code must be a constant.
    subroutine c_exit(status) bind(c, name="exit")
      import :: c_int
      implicit none
      integer(c_int), value :: status !! exit code
    end subroutine c_exit

    !> A test, or what runs before or after it.
    subroutine procedure_without_arguments()
      implicit none
    end subroutine procedure_without_arguments
  end interface

  integer, parameter :: max_column = 80

  character(:), allocatable :: filter  !! only tests whose name contains this
  character(:), allocatable :: running !! messages of the running test, empty while it holds
  character(:), allocatable :: report  !! failures so far
  logical :: verbose = .false.         !! name every test before it runs
  integer :: n_run = 0
  integer :: n_failed = 0
  integer :: column = 0
  integer(int64) :: ticks_at_start = 0

contains

  !> Reads the command line: `-f text`, `--filter text`, `-v`, `--verbose`, `-d`, `--debug`.
  subroutine start()
    integer :: i, n_argument

    filter = ""
    running = ""
    report = ""
    n_argument = command_argument_count()
    i = 1
    do while (i <= n_argument)
      select case (argument(i))
      case ("-f", "--filter")
        if (i == n_argument) call refuse("missing text after " // argument(i))
        filter = argument(i + 1)
        i = i + 1
      case ("-v", "--verbose", "-d", "--debug")
        verbose = .true.
      case default
        call refuse("unknown option " // argument(i))
      end select
      i = i + 1
    end do
    call system_clock(ticks_at_start)
  end subroutine start

  !> Runs one test between its preparation and its clean-up; records whether it failed.
  subroutine run_test(name, test, before, after)
    character(*), intent(in) :: name                          !! full name, suite.test
    procedure(procedure_without_arguments) :: test            !! the test
    procedure(procedure_without_arguments), optional :: before !! runs first
    procedure(procedure_without_arguments), optional :: after  !! runs last, also after a failure

    if (index(name, filter) == 0) return
    running = ""
    n_run = n_run + 1
    if (verbose) write (output_unit, "(a)") " " // name
    call put(".")

    if (present(before)) call before()
    if (.not. anyExceptions()) call test()
    if (present(after)) call after()

    if (anyExceptions()) then
      n_failed = n_failed + 1
      report = report // "Failure in: " // name // new_line("a") // running // new_line("a")
      call put("F")
    end if
  end subroutine run_test

  !> Adds a failed assertion to the running test.
  subroutine throw(text, location)
    character(*), intent(in) :: text             !! what failed, may hold several lines
    type(SourceLocation), intent(in) :: location !! where it stands

    character(12) :: line

    write (line, "(i0)") location%line
    running = running // "  Location: [" // location%file // ":" // trim(line) // "]" &
      // new_line("a") // text // new_line("a")
  end subroutine throw

  !> Has an assertion of the running test failed?
  logical function anyExceptions() result(failed)
    failed = len(running) > 0
  end function anyExceptions

  !> Prints the summary and ends the program: status 0 only if tests ran and none failed.
  subroutine finish()
    integer(int64) :: ticks, ticks_per_second

    call system_clock(ticks, ticks_per_second)
    write (output_unit, "(/, a, f12.3, a, /)") "Time: ", &
      real(ticks - ticks_at_start) / real(ticks_per_second), " seconds"
    write (output_unit, "(a)", advance="no") report
    if (n_run == 0) then
      write (output_unit, "(a)") " FAILURES!!!", "No test ran."
    else if (n_failed == 0) then
      write (output_unit, "(a, /, a, i0, a)") " OK", " (", n_run, &
        trim(merge(" test) ", " tests)", n_run == 1))
    else
      write (output_unit, "(a, /, 3(a, i0))") " FAILURES!!!", "Tests run: ", n_run, &
        ", Failures: ", n_failed, ", Errors: ", 0
    end if
    flush (output_unit)
    call c_exit(merge(0_c_int, 2_c_int, n_run > 0 .and. n_failed == 0))
  end subroutine finish

  ! Flushes, so that the output of a test that crashes shows which one it was.
  subroutine put(mark)
    character(1), intent(in) :: mark

    write (output_unit, "(a)", advance="no") mark
    column = column + 1
    if (verbose .or. column == max_column) then
      write (output_unit, "(a)") ""
      column = 0
    end if
    flush (output_unit)
  end subroutine put

  function argument(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text

    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(length) :: text)
    call get_command_argument(i, value=text)
  end function argument

  subroutine refuse(text)
    character(*), intent(in) :: text

    write (output_unit, "(a)") text, "options: -f TEXT  -v"
    call c_exit(1_c_int)
  end subroutine refuse

end module pf_run
