!> Time functions of loads and prescribed displacements.
module mpm_amplitude
  use mpm_kinds, only: dp
  implicit none
  private
  public :: amplitude_t, time_increment_t, amplitude_value, step_fraction

  !> A piecewise linear function of step time, constant outside its table.
  type :: amplitude_t
    character(:), allocatable :: name
    real(dp), allocatable :: time(:)  !! (n) ascending
    real(dp), allocatable :: value(:) !! (n) [-]
  end type amplitude_t

  !> Where an increment lies in its step.
  type :: time_increment_t
    real(dp) :: start = 0.0_dp  !! step time at the start of the increment
    real(dp) :: size = 0.0_dp   !! size of the increment
    real(dp) :: period = 1.0_dp !! length of the step
  end type time_increment_t

contains

  !> Value of an amplitude at a time. Source: linear interpolation.
  pure function amplitude_value(amplitude, time) result(value)
    type(amplitude_t), intent(in) :: amplitude !! table with at least one entry
    real(dp), intent(in) :: time               !! step time
    real(dp) :: value                          !! factor [-]
    integer :: i

    value = amplitude%value(1)
    do i = 2, size(amplitude%time)
      if (time <= amplitude%time(i - 1)) return
      value = amplitude%value(i)
      if (time < amplitude%time(i)) then
        value = amplitude%value(i - 1) + (value - amplitude%value(i - 1)) &
                *(time - amplitude%time(i - 1))/(amplitude%time(i) - amplitude%time(i - 1))
        return
      end if
    end do
  end function amplitude_value

  !> Part of a condition that is in force at a step time: t/period without an amplitude, the
  !! amplitude's value with one.
  pure function step_fraction(index, time, period, amplitudes) result(fraction)
    integer, intent(in)  :: index                    !! index of the amplitude, 0 = linear ramp
    real(dp), intent(in) :: time                     !! step time
    real(dp), intent(in) :: period                   !! length of the step
    type(amplitude_t), intent(in) :: amplitudes(:)   !! all amplitudes of the model
    real(dp) :: fraction                             !! [-]

    if (index == 0) then
      fraction = time/period
    else
      fraction = amplitude_value(amplitudes(index), time)
    end if
  end function step_fraction

end module mpm_amplitude
