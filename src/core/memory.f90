!> Whether memory is to be had before it is needed where its lack could not be told, and what becomes
!! of memory that is given back.
module mpm_memory
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_ptr, c_size_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: give_back_memory, has_room, keep_freed_memory, megabytes

  ! Numbers of malloc.h.
  integer(c_int), parameter :: trim_threshold = -1_c_int !! M_TRIM_THRESHOLD
  integer(c_int), parameter :: mmap_threshold = -3_c_int !! M_MMAP_THRESHOLD
  integer(c_int), parameter :: kept = 268435456_c_int    !! free memory that the process keeps [bytes]
  integer(c_int), parameter :: apart = 33554432_c_int    !! what is larger is got from the system and
                                                         !! given back to it one by one [bytes]

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

    !> Gives free pages back to the system; 1 if there were some.
    function c_malloc_trim(pad) bind(c, name="malloc_trim") result(released)
      import :: c_int, c_size_t
      implicit none
      integer(c_size_t), value :: pad
      integer(c_int) :: released
    end function c_malloc_trim

    !> Changes how the C library manages memory; 0 if it does not know how.
    function c_mallopt(parameter, value) bind(c, name="mallopt") result(done)
      import :: c_int
      implicit none
      integer(c_int), value :: parameter, value
      integer(c_int) :: done
    end function c_mallopt
  end interface

contains

  !> Lets the process keep memory that it frees, up to a limit: factors are made and thrown away in
  !! every iteration, and pages that come anew from the system cost a quarter of a factorisation.
  !! .false.: the C library does not do it, and nothing is lost but time.
  function keep_freed_memory() result(keeps)
    logical :: keeps

    keeps = c_mallopt(mmap_threshold, apart) /= 0_c_int
    if (keeps) keeps = c_mallopt(trim_threshold, kept) /= 0_c_int
  end function keep_freed_memory

  !> Tries to get memory and gives it back at once. The system may promise more than it has.
  function has_room(n_bytes) result(room)
    integer(ip), intent(in) :: n_bytes !! wanted [bytes]
    logical :: room
    type(c_ptr) :: block

    block = c_malloc(int(max(1_ip, n_bytes), c_size_t))
    room = c_associated(block)
    if (room) call c_free(block)
  end function has_room

  !> Gives free memory that was kept back to the system, before much is needed at once.
  !! .false.: there was none.
  function give_back_memory() result(released)
    logical :: released

    released = c_malloc_trim(0_c_size_t) /= 0_c_int
  end function give_back_memory

  !> Bytes in whole megabytes, at least one.
  pure real(dp) function megabytes(n_bytes) result(amount)
    real(dp), intent(in) :: n_bytes !! [bytes]

    amount = max(1.0_dp, anint(n_bytes/1.0e6_dp))
  end function megabytes

end module mpm_memory
