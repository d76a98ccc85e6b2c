!> Packs a chunk of a dataset as the filters shuffle and deflate of HDF5 do, by ISA-L, which takes a
!! sixth of the time of zlib. Without ISA-L nothing is packed, and HDF5 does it.
! allow(assumed-size)
module mpm_chunk_packing
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int32_t, c_int8_t, c_loc, c_long, c_ptr
  use mpm_build_info, only: isal_version
  use mpm_kinds, only: ip
  implicit none
  private
  public :: pack_chunk

  interface
    !> Packs bytes into a zlib stream, see isal_shim.c; 0 if that fails.
    function isal_deflate(in, n_in, out, n_out) bind(c, name="tessera_isal_deflate") result(n)
      import :: c_int32_t, c_int8_t, c_long
      implicit none
      integer(c_int8_t), intent(in) :: in(*)       !! (n_in)
      integer(c_long), value        :: n_in        !! bytes
      integer(c_int32_t), intent(inout) :: out(*)  !! room for n_out bytes
      integer(c_long), value        :: n_out       !! bytes
      integer(c_long)               :: n           !! bytes written
    end function isal_deflate
  end interface

contains

  !> Packs the values of a chunk. The bytes of the same rank of all values come together first.
  subroutine pack_chunk(packed, n_bytes, values, n_values, bytes_of_value)
    integer(c_int32_t), allocatable, intent(out) :: packed(:) !! the chunk as it is stored
    integer(ip), intent(out) :: n_bytes     !! of it; 0: to be left to HDF5
    type(c_ptr), intent(in) :: values       !! in the order and the byte order of the file
    integer, intent(in) :: n_values         !! how many
    integer, intent(in) :: bytes_of_value   !! 4 or 8
    integer(c_int8_t), pointer     :: plain(:, :)
    integer(c_int8_t), allocatable :: shuffled(:, :)
    character(80) :: reason
    integer(ip) :: room
    integer :: status

    n_bytes = 0_ip
    if (len(isal_version) == 0) return
    room = int(n_values, ip)*int(bytes_of_value, ip)
    room = room + room/32_ip + 1024_ip
    allocate (shuffled(n_values, bytes_of_value), stat=status, errmsg=reason)
    if (status /= 0) return
    allocate (packed((room + 3_ip)/4_ip), stat=status, errmsg=reason)
    if (status /= 0) return
    call c_f_pointer(values, plain, [bytes_of_value, n_values])
    call shuffle(shuffled, plain, bytes_of_value, n_values)
    n_bytes = int(isal_deflate(shuffled, int(size(shuffled, kind=ip), c_long), packed, &
                               int(room, c_long)), ip)
  end subroutine pack_chunk

  !> Puts the bytes of the same rank side by side, some values at a time, which then stay in the
  !! first-level cache.
  pure subroutine shuffle(shuffled, plain, bytes_of_value, n_values)
    integer, intent(in) :: bytes_of_value, n_values
    integer(c_int8_t), intent(out) :: shuffled(n_values, bytes_of_value)
    integer(c_int8_t), intent(in)  :: plain(bytes_of_value, n_values)
    integer, parameter :: at_once = 2048 !! values
    integer :: first, i, k

    do first = 1, n_values, at_once
      do k = 1, bytes_of_value
        do i = first, min(first + at_once - 1, n_values)
          shuffled(i, k) = plain(k, i)
        end do
      end do
    end do
  end subroutine shuffle

end module mpm_chunk_packing
