!> The clock of the system, for spans of wall time.
module mpm_clock
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: wall_time

contains

  !> Seconds of the system's clock.
  function wall_time() result(seconds)
    real(dp) :: seconds !! [s]
    integer(ip) :: ticks, rate

    call system_clock(ticks, rate)
    seconds = real(ticks, dp)/real(rate, dp)
  end function wall_time

end module mpm_clock
