!> Places in space as text for messages.
module mpm_place_text
  use mpm_kinds, only: dp
  use mpm_text, only: real_text
  implicit none
  private
  public :: place_text

contains

  !> Coordinates with commas between them: "1, 0.5, -2".
  pure function place_text(x) result(text)
    real(dp), intent(in) :: x(:)      !! (n_dim)  position [length]
    character(:), allocatable :: text
    integer :: i

    text = ""
    do i = 1, size(x)
      if (i > 1) text = text//", "
      text = text//real_text(x(i))
    end do
  end function place_text

end module mpm_place_text
