!> Compresses rows that repeat into what the filters shuffle and deflate of HDF5 make of a chunk.
!!
!! The points of an element that does not flow have the same stress and strain to the last bit.
!! Only that is looked for: a row equal to the one before it. The stream is what RFC 1950 and 1951
!! say, one block with the fixed codes, so that any reader unpacks it; a general compressor takes
!! several times as long to find the same.
module mpm_row_packing
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use mpm_kinds, only: ip
  implicit none
  private
  public :: pack_rows

  integer, parameter :: bytes_of_word = 8
  integer, parameter :: shortest = 3, longest = 258         !! bytes of a match
  integer(int64), parameter :: checksum_base = 65521_int64  !! of Adler-32
  integer, parameter :: most_columns = 12                   !! the table of distances ends here
  integer, parameter :: literals_at_once = 7                !! 63 bits at most

  !> The codes of the block; the first bit of a code is the lowest.
  type :: codes_t
    integer(int64) :: literal(0:255) = 0_int64
    integer :: n_literal(0:255) = 0
    integer(int64) :: match(shortest:longest) = 0_int64 !! length, then the distance of a row
    integer :: n_match(shortest:longest) = 0
  end type codes_t

  !> Bits on their way into words.
  type :: writer_t
    integer(int32), allocatable :: word(:)
    integer :: n_words = 0
    integer(int64) :: pool = 0_int64 !! bits that do not fill a word yet
    integer :: n_bits = 0            !! of the pool, fewer than 32
  end type writer_t

  !> Adler-32: the plain sum and the one weighted by the distance from the end.
  type :: checksum_t
    integer(int64) :: plain = 1_int64, weighted = 0_int64
  end type checksum_t

contains

  !> Packs the rows of a chunk.
  pure subroutine pack_rows(packed, n_bytes, row)
    integer(int32), allocatable, intent(out) :: packed(:) !! stream, byte after byte
    integer(ip), intent(out) :: n_bytes                   !! of the stream; 0: it does not pay
    integer(int64), intent(in) :: row(:, :)               !! (n_columns, n_rows)  bits of the values
    type(codes_t)    :: codes
    type(writer_t)   :: writer
    type(checksum_t) :: checksum
    integer, allocatable :: first(:)
    integer :: i, n_columns, plane

    n_columns = size(row, 1)
    n_bytes = 0_ip
    call find_runs(first, row)
    if (n_columns > most_columns .or. 5*size(first) > 4*size(row, 2)) return
    call make_codes(codes, n_columns)
    allocate (writer%word(16 + (size(first)*n_columns*bytes_of_word*5)/16 &
                          + (size(row)*bytes_of_word)/250 + size(first)*bytes_of_word))
    call put(writer, int(z"0178", int64), 16)
    call put(writer, 3_int64, 3)
    checksum%weighted = size(row, kind=int64)*bytes_of_word
    do plane = 0, bytes_of_word - 1
      do i = 1, size(first) - 1
        call put_run(writer, checksum, codes, row, [first(i), first(i + 1) - first(i), plane])
      end do
    end do
    call put(writer, 0_int64, 7) ! end of the block
    call put(writer, 0_int64, modulo(-writer%n_bits, 8))
    call put_checksum(writer, checksum)
    n_bytes = 4_ip*int(writer%n_words, ip) + int(writer%n_bits/8, ip)
    writer%word(writer%n_words + 1) = transfer(writer%pool, 0_int32)
    call move_alloc(writer%word, packed)
  end subroutine pack_rows

  !> Finds where rows differ from those before them.
  pure subroutine find_runs(first, row)
    integer, allocatable, intent(out) :: first(:) !! (n_runs+1)  first row of each run; the last one
                                                  !! is behind all rows
    integer(int64), intent(in) :: row(:, :)       !! (n_columns, n_rows)
    integer, allocatable :: found(:)
    integer :: n, r

    allocate (found(size(row, 2) + 1))
    n = 0
    do r = 1, size(row, 2)
      if (r > 1) then
        if (all(row(:, r) == row(:, r - 1))) cycle
      end if
      n = n + 1
      found(n) = r
    end do
    found(n + 1) = size(row, 2) + 1
    first = found(:n + 1)
  end subroutine find_runs

  !> One byte of the values of a run: those of its first row, the others by reference.
  pure subroutine put_run(writer, checksum, codes, row, run)
    type(writer_t), intent(inout)   :: writer
    type(checksum_t), intent(inout) :: checksum
    type(codes_t), intent(in)  :: codes
    integer(int64), intent(in) :: row(:, :) !! (n_columns, n_rows)
    integer, intent(in) :: run(3)           !! first row, number of rows, byte of the values
    integer(int64) :: bits, place, total, turned, weight
    integer :: byte, column, n, n_columns, rest, length

    n_columns = size(row, 1)
    bits = 0_int64
    n = 0
    total = 0_int64
    turned = 0_int64
    do column = 1, n_columns
      byte = int(ibits(row(column, run(1)), 8*run(3), 8))
      bits = ior(bits, shiftl(codes%literal(byte), n))
      n = n + codes%n_literal(byte)
      total = total + byte
      turned = turned + byte*(column - 1)
      if (mod(column, literals_at_once) == 0 .or. column == n_columns) then
        call put(writer, ibits(bits, 0, 32), min(n, 32))
        if (n > 32) call put(writer, shiftr(bits, 32), n - 32)
        bits = 0_int64
        n = 0
      end if
    end do
    rest = n_columns*(run(2) - 1)
    do while (rest >= shortest)
      length = min(rest, longest)
      if (rest - length > 0 .and. rest - length < shortest) length = length - shortest
      call put(writer, codes%match(length), codes%n_match(length))
      rest = rest - length
    end do
    do n = 1, rest ! too short for a reference; only scalars and pairs
      byte = int(ibits(row(modulo(n - 1, n_columns) + 1, run(1)), 8*run(3), 8))
      call put(writer, codes%literal(byte), codes%n_literal(byte))
    end do
    ! Sum over the rows of the run of (bytes from here to the end) times byte.
    place = int(run(3), int64)*size(row, kind=int64) + int(run(1) - 1, int64)*n_columns
    weight = run(2)*(size(row, kind=int64)*bytes_of_word - place) &
             - n_columns*(int(run(2), int64)*(run(2) - 1))/2
    checksum%plain = modulo(checksum%plain + run(2)*total, checksum_base)
    checksum%weighted = modulo(checksum%weighted + modulo(weight, checksum_base)*total &
                               - run(2)*turned, checksum_base)
  end subroutine put_run

  !> Appends bits, 32 at most.
  pure subroutine put(writer, bits, n)
    type(writer_t), intent(inout) :: writer
    integer(int64), intent(in) :: bits !! the lowest n; all others are zero
    integer, intent(in) :: n

    writer%pool = ior(writer%pool, shiftl(bits, writer%n_bits))
    writer%n_bits = writer%n_bits + n
    if (writer%n_bits < 32) return
    writer%n_words = writer%n_words + 1
    writer%word(writer%n_words) = transfer(writer%pool, 0_int32)
    writer%pool = shiftr(writer%pool, 32)
    writer%n_bits = writer%n_bits - 32
  end subroutine put

  !> Appends the checksum, its highest byte first.
  pure subroutine put_checksum(writer, checksum)
    type(writer_t), intent(inout) :: writer
    type(checksum_t), intent(in)  :: checksum
    integer(int64) :: half(2)
    integer :: i

    half = [checksum%weighted, checksum%plain]
    do i = 1, 2
      call put(writer, ibits(half(i), 8, 8), 8)
      call put(writer, ibits(half(i), 0, 8), 8)
    end do
  end subroutine put_checksum

  !> The fixed codes of RFC 1951, 3.2.6, and those of matches at the distance of a row.
  pure subroutine make_codes(codes, n_columns)
    type(codes_t), intent(out) :: codes
    integer, intent(in) :: n_columns
    integer, parameter :: first_distance(0:6) = [1, 2, 3, 4, 5, 7, 9]
    integer, parameter :: extra_of_distance(0:6) = [0, 0, 0, 0, 1, 1, 2]
    integer :: base, code, extra, i, k, n

    do i = 0, 143
      codes%literal(i) = turned_round(48 + i, 8)
      codes%n_literal(i) = 8
    end do
    do i = 144, 255
      codes%literal(i) = turned_round(400 + i - 144, 9)
      codes%n_literal(i) = 9
    end do
    k = count(first_distance <= n_columns) - 1
    do i = shortest, longest
      call find_length_code(code, extra, base, i)
      n = merge(7, 8, code < 280)
      codes%match(i) = turned_round(merge(code - 256, 192 + code - 280, code < 280), n)
      codes%match(i) = ior(codes%match(i), shiftl(int(i - base, int64), n))
      n = n + extra
      codes%match(i) = ior(codes%match(i), shiftl(turned_round(k, 5), n))
      n = n + 5
      codes%match(i) = ior(codes%match(i), shiftl(int(n_columns - first_distance(k), int64), n))
      codes%n_match(i) = n + extra_of_distance(k)
    end do
  end subroutine make_codes

  !> Code of a length, number of its extra bits, length of the code without them.
  pure subroutine find_length_code(code, extra, base, length)
    integer, intent(out) :: code, extra, base
    integer, intent(in)  :: length !! 3 to 258
    integer :: i

    if (length == longest) then
      code = 285
      extra = 0
      base = longest
      return
    end if
    code = 257
    base = shortest
    do i = 0, 27
      extra = max(0, i/4 - 1)
      if (length < base + shiftl(1, extra)) return
      base = base + shiftl(1, extra)
      code = code + 1
    end do
  end subroutine find_length_code

  !> A code with its first bit lowest.
  pure integer(int64) function turned_round(code, n) result(bits)
    integer, intent(in) :: code !! first bit highest
    integer, intent(in) :: n    !! bits
    integer :: i

    bits = 0_int64
    do i = 0, n - 1
      if (btest(code, i)) bits = ibset(bits, n - 1 - i)
    end do
  end function turned_round

end module mpm_row_packing
