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
      import :: c_int32_t, c_long, c_ptr
      implicit none
      type(c_ptr), value            :: in          !! n_in bytes
      integer(c_long), value        :: n_in        !! bytes
      integer(c_int32_t), intent(inout) :: out(*)  !! room for n_out bytes
      integer(c_long), value        :: n_out       !! bytes
      integer(c_long)               :: n           !! bytes written
    end function isal_deflate
  end interface

  !> Exchanges parts of words.
  interface exchange
    module procedure exchange_in_words, exchange_in_halves
  end interface exchange

contains

  !> Packs the values of a chunk. The bytes of the same rank of all values come together first.
  subroutine pack_chunk(packed, n_bytes, values, n_values, bytes_of_value)
    integer(c_int32_t), allocatable, intent(out) :: packed(:) !! the chunk as it is stored
    integer(ip), intent(out) :: n_bytes     !! of it; 0: to be left to HDF5
    type(c_ptr), intent(in) :: values       !! in the order and the byte order of the file
    integer, intent(in) :: n_values         !! how many
    integer, intent(in) :: bytes_of_value   !! 4 or 8
    integer(ip), allocatable, target :: work(:)
    character(80) :: reason
    integer(ip) :: n_plain, room
    integer :: status

    n_bytes = 0_ip
    if (len(isal_version) == 0) return
    n_plain = int(n_values, ip)*int(bytes_of_value, ip)
    room = n_plain + n_plain/32_ip + 1024_ip
    allocate (work((n_plain + 7_ip)/8_ip), stat=status, errmsg=reason)
    if (status /= 0) return
    allocate (packed((room + 3_ip)/4_ip), stat=status, errmsg=reason)
    if (status /= 0) return
    call shuffle(c_loc(work), values, n_values, bytes_of_value)
    n_bytes = int(isal_deflate(c_loc(work), int(n_plain, c_long), packed, int(room, c_long)), ip)
  end subroutine pack_chunk

  !> Puts the bytes of the same rank side by side: a word of them at a time where values fill such
  !! words.
  subroutine shuffle(shuffled, values, n_values, bytes_of_value)
    type(c_ptr), intent(in) :: shuffled !! as many bytes as the values have
    type(c_ptr), intent(in) :: values
    integer, intent(in) :: n_values
    integer, intent(in) :: bytes_of_value !! 4 or 8
    integer(ip), pointer, contiguous        :: eights(:, :), words(:, :)
    integer(c_int32_t), pointer, contiguous :: fours(:, :), half_words(:, :)
    integer(c_int8_t), pointer, contiguous  :: bytes(:, :), plain(:, :)

    if (bytes_of_value == 8 .and. mod(n_values, 8) == 0) then
      call c_f_pointer(values, eights, [8, n_values/8])
      call c_f_pointer(shuffled, words, [n_values/8, 8])
      call shuffle_eights(words, eights, n_values/8)
    else if (bytes_of_value == 4 .and. mod(n_values, 4) == 0) then
      call c_f_pointer(values, fours, [4, n_values/4])
      call c_f_pointer(shuffled, half_words, [n_values/4, 4])
      call shuffle_fours(half_words, fours, n_values/4)
    else
      call c_f_pointer(values, plain, [bytes_of_value, n_values])
      call c_f_pointer(shuffled, bytes, [n_values, bytes_of_value])
      call shuffle_bytes(bytes, plain, bytes_of_value, n_values)
    end if
  end subroutine shuffle

  !> Puts the bytes of the same rank side by side, those of eight values at once: halves, then
  !! quarters, then bytes change places. It takes a third of the time of
  !! shuffle_bytes.
  pure subroutine shuffle_eights(shuffled, plain, n)
    integer, intent(in) :: n                       !! values / 8
    integer(ip), intent(out) :: shuffled(n, 0:7)   !! bytes of eight values each
    integer(ip), intent(in)  :: plain(0:7, n)      !! values
    integer(ip), parameter :: half = 4294967295_ip !! lower bits of each pair of halves, and so on
    integer(ip), parameter :: quarter = 65535_ip*4294967297_ip
    integer(ip), parameter :: eighth = 255_ip*281479271743489_ip
    integer(ip) :: a, b, c, d, e, f, g, h          ! in registers, which an array is not
    integer :: i

    do i = 1, n
      a = plain(0, i)
      b = plain(1, i)
      c = plain(2, i)
      d = plain(3, i)
      e = plain(4, i)
      f = plain(5, i)
      g = plain(6, i)
      h = plain(7, i)
      call exchange(a, e, 32, half)
      call exchange(b, f, 32, half)
      call exchange(c, g, 32, half)
      call exchange(d, h, 32, half)
      call exchange(a, c, 16, quarter)
      call exchange(b, d, 16, quarter)
      call exchange(e, g, 16, quarter)
      call exchange(f, h, 16, quarter)
      call exchange(a, b, 8, eighth)
      call exchange(c, d, 8, eighth)
      call exchange(e, f, 8, eighth)
      call exchange(g, h, 8, eighth)
      shuffled(i, 0) = a
      shuffled(i, 1) = b
      shuffled(i, 2) = c
      shuffled(i, 3) = d
      shuffled(i, 4) = e
      shuffled(i, 5) = f
      shuffled(i, 6) = g
      shuffled(i, 7) = h
    end do
  end subroutine shuffle_eights

  !> The same of four values of four bytes.
  pure subroutine shuffle_fours(shuffled, plain, n)
    integer, intent(in) :: n                             !! values / 4
    integer(c_int32_t), intent(out) :: shuffled(n, 0:3)  !! bytes of four values each
    integer(c_int32_t), intent(in)  :: plain(0:3, n)     !! values
    integer(c_int32_t), parameter :: half = 65535_c_int32_t !! lower bits of each pair
    integer(c_int32_t), parameter :: quarter = 255_c_int32_t*65537_c_int32_t
    integer(c_int32_t) :: a, b, c, d
    integer :: i

    do i = 1, n
      a = plain(0, i)
      b = plain(1, i)
      c = plain(2, i)
      d = plain(3, i)
      call exchange(a, c, 16, half)
      call exchange(b, d, 16, half)
      call exchange(a, b, 8, quarter)
      call exchange(c, d, 8, quarter)
      shuffled(i, 0) = a
      shuffled(i, 1) = b
      shuffled(i, 2) = c
      shuffled(i, 3) = d
    end do
  end subroutine shuffle_fours

  !> Exchanges the upper parts of a with the lower parts of b.
  elemental subroutine exchange_in_words(a, b, n_bits, lower)
    integer(ip), intent(inout) :: a, b
    integer, intent(in) :: n_bits    !! of a part
    integer(ip), intent(in) :: lower !! bits of the lower parts
    integer(ip) :: difference

    difference = iand(ieor(shiftr(a, n_bits), b), lower)
    b = ieor(b, difference)
    a = ieor(a, shiftl(difference, n_bits))
  end subroutine exchange_in_words

  !> The same in halves of words.
  elemental subroutine exchange_in_halves(a, b, n_bits, lower)
    integer(c_int32_t), intent(inout) :: a, b
    integer, intent(in) :: n_bits           !! of a part
    integer(c_int32_t), intent(in) :: lower !! bits of the lower parts
    integer(c_int32_t) :: difference

    difference = iand(ieor(shiftr(a, n_bits), b), lower)
    b = ieor(b, difference)
    a = ieor(a, shiftl(difference, n_bits))
  end subroutine exchange_in_halves

  !> Puts the bytes of the same rank side by side, one by one, some values at a time, which
  !! then stay in the first-level cache.
  pure subroutine shuffle_bytes(shuffled, plain, bytes_of_value, n_values)
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
  end subroutine shuffle_bytes

end module mpm_chunk_packing
