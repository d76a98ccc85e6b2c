!> The note about a limit load: in the log, and on the terminal.
module mpm_limit_note
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mpm_error, only: error_t
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp
  use mpm_limit_load, only: limit_watch_t, meets_limit_load
  use mpm_newton_report, only: newton_report_t
  use mpm_run_log, only: log_message
  use mpm_run_output, only: run_output_t
  use mpm_system, only: system_t
  use mpm_text, only: real_text
  implicit none
  private
  public :: note_limit_load

contains

  !> Tells once in a step that an attempt has come to a limit load.
  subroutine note_limit_load(watch, output, system, report, schedule, error)
    type(limit_watch_t), intent(inout) :: watch        !! remembers that it was told
    type(run_output_t), intent(inout)  :: output       !! open
    type(system_t), intent(in)         :: system       !! after the attempt
    type(newton_report_t), intent(in)  :: report       !! of the attempt
    type(schedule_t), intent(in)       :: schedule     !! the attempt is open
    type(error_t), allocatable, intent(out) :: error   !! exit_file
    character(:), allocatable :: text

    if (watch%told) return
    if (.not. meets_limit_load(watch, system, report, schedule)) return
    watch%told = .true.
    text = "note: the loads of the step can hardly grow beyond "// &
           percent_text(schedule%step_time + schedule%size, schedule%settings%period)// &
           " of its time: a limit load under load control; prescribe displacements to go past it"
    if (.not. output%quiet) write (error_unit, "(a)") text
    call log_message(output%log, text, error)
  end subroutine note_limit_load

  !> A part of a whole in per cent, with one decimal.
  pure function percent_text(part, whole) result(text)
    real(dp), intent(in) :: part, whole
    character(:), allocatable :: text

    text = real_text(real(nint(1000.0_dp*part/whole), dp)/10.0_dp)//" %"
  end function percent_text

end module mpm_limit_note
