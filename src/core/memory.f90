!> Whether memory is to be had before it is needed where its lack could not be told.
module mpm_memory
  use, intrinsic :: iso_c_binding, only: c_associated, c_ptr, c_size_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: has_room, megabytes

  interface
    !> Memory of C; null if there is none.
    function c_malloc(size) bind(c, name="malloc") result(block)
      import :: c_ptr, c_size_t
      implicit none
      integer(c_size_t), value :: size
      type(c_ptr) :: block
    end function c_malloc

    !> Gives memory back.
    subroutine c_free(block) bind(c, name="free")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: block
    end subroutine c_free
  end interface

contains

  !> Tries to get memory and gives it back at once. The system may promise more than it has.
  function has_room(n_bytes) result(room)
    integer(ip), intent(in) :: n_bytes !! wanted [bytes]
    logical :: room
    type(c_ptr) :: block

    block = c_malloc(int(max(1_ip, n_bytes), c_size_t))
    room = c_associated(block)
    if (room) call c_free(block)
  end function has_room

  !> Bytes in whole megabytes, at least one.
  pure real(dp) function megabytes(n_bytes) result(amount)
    real(dp), intent(in) :: n_bytes !! [bytes]

    amount = max(1.0_dp, anint(n_bytes/1.0e6_dp))
  end function megabytes

end module mpm_memory
