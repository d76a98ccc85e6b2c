!> Expectations that a run has decided, as text: a restart takes them over.
module mpm_verdict_record
  use mpm_error, only: error_t, exit_deck, make_error
  use mpm_expectations, only: judge, subject_of, verdict_t
  use mpm_kinds, only: dp
  use mpm_text, only: parse_real, real_text
  implicit none
  private
  public :: restore_verdicts, verdicts_text

  integer, parameter :: number_length = 24        !! characters of a number
  real(dp), parameter :: time_tolerance = 1.0e-9_dp !! relative

contains

  !> A line for each decided expectation: the value found, the time, and what was compared.
  pure function verdicts_text(verdicts) result(text)
    type(verdict_t), intent(in) :: verdicts(:) !! of the run
    character(:), allocatable :: text
    integer :: i

    text = ""
    do i = 1, size(verdicts)
      if (.not. verdicts(i)%reached) cycle
      text = text//exact(verdicts(i)%found)//key_of(verdicts(i))//new_line("a")
    end do
  end function verdicts_text

  !> Decides the expectations of a deck that an earlier run has met on its way. One whose time is
  !! over, but which that run was not asked for, cannot be decided any more.
  pure subroutine restore_verdicts(verdicts, text, time, error)
    type(verdict_t), intent(inout) :: verdicts(:)    !! of the deck, none decided
    character(*), intent(in) :: text                 !! as verdicts_text gives it
    real(dp), intent(in) :: time                     !! total time of the restart
    type(error_t), allocatable, intent(out) :: error !! exit_deck
    real(dp) :: found
    integer :: first, i
    logical :: ok

    do i = 1, size(verdicts)
      associate (expected => verdicts(i)%expected)
        first = index(new_line("a")//text, key_of(verdicts(i))//new_line("a")) - number_length - 1
        if (first > 0) then
          call parse_real(trim(adjustl(text(first:first + number_length - 1))), found, ok)
          if (ok) call judge(verdicts(i), found)
        else if (expected%time < time*(1.0_dp - time_tolerance)) then
          call make_error(error, exit_deck, expected%origin//": error: an *EXPECT at time "// &
                          real_text(expected%time)//" that the run before the restart at time "// &
                          real_text(time)//" was not asked for: expected a later time")
          return
        end if
      end associate
    end do
  end subroutine restore_verdicts

  !> What makes an expectation the same as another one, whatever value it expects.
  pure function key_of(verdict) result(key)
    type(verdict_t), intent(in) :: verdict
    character(:), allocatable :: key

    key = " "//exact(verdict%expected%time)//" "//subject_of(verdict%expected)
  end function key_of

  !> A number that reading gives back.
  pure function exact(value) result(text)
    real(dp), intent(in) :: value
    character(number_length) :: text

    write (text, "(es24.16e3)") value
  end function exact

end module mpm_verdict_record
