!> The progress of a run on stderr.
module mpm_progress
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mpm_kinds, only: dp
  use mpm_run_state, only: run_state_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: end_progress, progress_line, show_progress

  character(*), parameter :: carriage_return = achar(13)
  integer(c_int), parameter :: stderr_descriptor = 2_c_int
  integer, parameter :: width = 79 !! a line that is rewritten must not wrap

  interface
    !> Whether a file descriptor is a terminal.
    function is_terminal(descriptor) bind(c, name="isatty") result(yes)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: yes
    end function is_terminal
  end interface

contains

  !> Shows where the run is: one line that is rewritten on a terminal, else a line per call.
  !! A terminal that went away is no reason to stop.
  subroutine show_progress(state, seconds_left)
    type(run_state_t), intent(in) :: state   !! after an attempt
    real(dp), intent(in) :: seconds_left     !! estimate [s]
    character(width) :: line
    character(width) :: reason
    integer :: status

    line = progress_line(state, seconds_left)
    if (is_terminal(stderr_descriptor) /= 0_c_int) then
      write (error_unit, "(a)", advance="no", iostat=status, iomsg=reason) &
        carriage_return//line
      if (status == 0) flush (error_unit, iostat=status, iomsg=reason)
    else
      write (error_unit, "(a)", iostat=status, iomsg=reason) trim(line)
    end if
    if (status /= 0) return
  end subroutine show_progress

  !> Leaves the line that is rewritten.
  subroutine end_progress()
    character(width) :: reason
    integer :: status

    if (is_terminal(stderr_descriptor) == 0_c_int) return
    write (error_unit, "(a)", iostat=status, iomsg=reason) ""
    if (status /= 0) return
  end subroutine end_progress

  !> What is shown.
  pure function progress_line(state, seconds_left) result(line)
    type(run_state_t), intent(in) :: state   !! after an attempt
    real(dp), intent(in) :: seconds_left     !! estimate [s]
    character(:), allocatable :: line

    line = "step "//integer_text(state%step)//" increment "//integer_text(state%increment)
    if (state%attempt > 1) line = line//" attempt "//integer_text(state%attempt)
    line = line//" time "//real_text(state%time)//" iterations " &
           //integer_text(state%n_iterations)//" residual "//real_text(state%residual) &
           //" left "//integer_text(nint(min(seconds_left, 1.0e9_dp)))//" s"
  end function progress_line

end module mpm_progress
