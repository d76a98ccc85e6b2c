!> Signals that ask the program to end: noted when they come, obeyed where the work can be left.
!!
!! A handler has no arguments of ours, so that what it notes must be a variable of the module.
module mpm_interruption
  use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t
  implicit none
  private
  public :: catch_signals, forget_signal, note_termination, received_signal
  public :: signal_hang_up, signal_interrupt, signal_terminate

  integer, parameter :: signal_hang_up = 1    !! SIGHUP: the terminal went away
  integer, parameter :: signal_interrupt = 2  !! SIGINT
  integer, parameter :: signal_pipe = 13      !! SIGPIPE: nobody reads what is written
  integer, parameter :: signal_terminate = 15 !! SIGTERM
  integer, parameter :: exit_of_signal = 128  !! added to the signal: exit code, as shells do

  integer(c_int), volatile, save :: received = 0_c_int !! the last one, 0 if none

  interface
    !> Sets what happens at a signal.
    function c_signal(number, action) bind(c, name="signal") result(previous)
      import :: c_funptr, c_int
      implicit none
      integer(c_int), value :: number
      type(c_funptr), value :: action
      type(c_funptr) :: previous
    end function c_signal

    !> Ends the process at once; may be called by a handler.
    subroutine c_exit_now(code) bind(c, name="_exit")
      import :: c_int
      implicit none
      integer(c_int), value :: code
    end subroutine c_exit_now
  end interface

contains

  !> From now on SIGINT, SIGTERM and SIGHUP are noted. One that the program was started to ignore, as
  !! shells do for work in the background, stays ignored. A pipe that nobody reads any more is no
  !! reason to end.
  subroutine catch_signals()
    integer(c_intptr_t), parameter :: ignore = 1_c_intptr_t ! SIG_IGN
    integer, parameter :: noted(3) = [signal_interrupt, signal_terminate, signal_hang_up]
    type(c_funptr) :: previous
    integer :: i

    received = 0_c_int
    do i = 1, size(noted)
      previous = c_signal(int(noted(i), c_int), c_funloc(note_signal))
      if (transfer(previous, ignore) == ignore) previous = c_signal(int(noted(i), c_int), previous)
    end do
    previous = c_signal(int(signal_pipe, c_int), transfer(ignore, previous))
  end subroutine catch_signals

  !> Notes a signal; the second one ends the program at once. Called by the system.
  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number !! signal

    integer(c_int) :: code

    code = int(exit_of_signal + signal_terminate, c_int)
    if (number == int(signal_interrupt, c_int)) code = int(exit_of_signal, c_int) + number
    if (received /= 0_c_int) call c_exit_now(code)
    received = number
  end subroutine note_signal

  !> Notes a SIGTERM that a library has caught.
  subroutine note_termination()
    call note_signal(int(signal_terminate, c_int))
  end subroutine note_termination

  !> The signal that came, 0 if none did.
  integer function received_signal() result(number)
    number = int(received)
  end function received_signal

  !> Forgets a signal that was obeyed.
  subroutine forget_signal()
    received = 0_c_int
  end subroutine forget_signal

end module mpm_interruption
