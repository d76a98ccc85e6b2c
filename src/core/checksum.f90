!> Checksums by zlib: accidents that change a file or a model are noticed.
module mpm_checksum
  use, intrinsic :: iso_c_binding, only: c_loc, c_long, c_ptr, c_size_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: checksum_text, checksum_of_integers, checksum_of_longs, checksum_of_reals
  public :: checksum_of_text

  interface
    !> CRC-32 of bytes, going on from that of the bytes before.
    function c_crc32(crc, bytes, length) bind(c, name="crc32_z") result(next)
      import :: c_long, c_ptr, c_size_t
      implicit none
      integer(c_long), value :: crc
      type(c_ptr), value :: bytes
      integer(c_size_t), value :: length
      integer(c_long) :: next
    end function c_crc32
  end interface

contains

  !> Goes on with a text.
  function checksum_of_text(before, text) result(checksum)
    integer(ip), intent(in) :: before        !! checksum so far, 0 at first
    character(*), intent(in), target :: text !! bytes
    integer(ip) :: checksum                  !! 0 .. 2^32 - 1

    checksum = before
    if (len(text) > 0) checksum = int(c_crc32(int(before, c_long), c_loc(text), &
                                              len(text, c_size_t)), ip)
  end function checksum_of_text

  !> Goes on with reals.
  function checksum_of_reals(before, values) result(checksum)
    integer(ip), intent(in) :: before                    !! checksum so far, 0 at first
    real(dp), intent(in), target, contiguous :: values(:) !! (n)
    integer(ip) :: checksum                              !! 0 .. 2^32 - 1

    checksum = before
    if (size(values) > 0) checksum = int(c_crc32(int(before, c_long), c_loc(values), &
      int(storage_size(values)/8, c_size_t)*size(values, kind=c_size_t)), ip)
  end function checksum_of_reals

  !> Goes on with integers.
  function checksum_of_integers(before, values) result(checksum)
    integer(ip), intent(in) :: before                   !! checksum so far, 0 at first
    integer, intent(in), target, contiguous :: values(:) !! (n)
    integer(ip) :: checksum                             !! 0 .. 2^32 - 1

    checksum = before
    if (size(values) > 0) checksum = int(c_crc32(int(before, c_long), c_loc(values), &
      int(storage_size(values)/8, c_size_t)*size(values, kind=c_size_t)), ip)
  end function checksum_of_integers

  !> Goes on with integers of 64 bits.
  function checksum_of_longs(before, values) result(checksum)
    integer(ip), intent(in) :: before                        !! checksum so far, 0 at first
    integer(ip), intent(in), target, contiguous :: values(:) !! (n)
    integer(ip) :: checksum                                  !! 0 .. 2^32 - 1

    checksum = before
    if (size(values) > 0) checksum = int(c_crc32(int(before, c_long), c_loc(values), &
      int(storage_size(values)/8, c_size_t)*size(values, kind=c_size_t)), ip)
  end function checksum_of_longs

  !> A checksum as eight hexadecimal digits.
  pure function checksum_text(checksum) result(text)
    integer(ip), intent(in) :: checksum !! 0 .. 2^32 - 1
    character(8) :: text

    write (text, "(z8.8)") iand(checksum, int(z"FFFFFFFF", ip))
  end function checksum_text

end module mpm_checksum
