!> When new results become visible to a reader: not more often than once in an interval.
!!
!! The clock decides about nothing else: what the results hold is the same for any interval.
module mpm_publication
  use mpm_kinds, only: dp
  implicit none
  private
  public :: publication_t, default_interval, is_publication_due, note_publication

  real(dp), parameter :: default_interval = 1.0_dp !! [s]

  !> The last publication, and whether there is anything to publish.
  type :: publication_t
    real(dp) :: interval = default_interval !! least time between two of them [s], 0: none
    logical  :: is_first = .true.           !! nothing has been published yet
    logical  :: is_waiting = .false.        !! something was written since
    real(dp) :: last = 0.0_dp               !! reading of the clock at the last one [s]
  end type publication_t

contains

  !> Whether results are to be published now: the first ones at once.
  pure logical function is_publication_due(publication, now) result(due)
    type(publication_t), intent(in) :: publication
    real(dp), intent(in) :: now !! reading of the clock [s]

    due = publication%is_waiting .and. &
          (publication%is_first .or. now - publication%last >= publication%interval)
  end function is_publication_due

  !> Everything that was written has been published.
  pure subroutine note_publication(publication, now)
    type(publication_t), intent(inout) :: publication !! nothing waits
    real(dp), intent(in) :: now                       !! reading of the clock [s]

    publication%is_first = .false.
    publication%is_waiting = .false.
    publication%last = now
  end subroutine note_publication

end module mpm_publication
