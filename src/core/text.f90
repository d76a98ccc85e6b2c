!> Words and numbers in text: names compared without case, numbers read by our own grammar.
module mpm_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_kinds, only: dp
  implicit none
  private
  public :: to_upper, same_name, normalize_keyword, nearest_word
  public :: bytes_of_character
  public :: parse_integer, parse_real, parse_real_list, integer_text, real_text, full_text
  public :: largest_input

  !> Numbers of the user reach up to it: products of a few of them do not overflow.
  real(dp), parameter :: largest_input = 1.0e30_dp
  integer, parameter :: i64 = selected_int_kind(18)

  !> A decimal number taken apart: (-1)^negative * 0.digits * 10^exponent.
  type :: decimal_t
    logical :: negative = .false.
    logical :: valid = .false.          !! the text is a number
    character(:), allocatable :: digits !! significant digits without leading zeros
    integer :: exponent = 0             !! power of ten of the point before the first digit
  end type decimal_t

contains

  !> Text with the letters a to z in upper case.
  pure function to_upper(text) result(upper)
    character(*), intent(in) :: text !! any text
    character(len(text))     :: upper
    integer :: i

    do i = 1, len(text)
      if (text(i:i) >= "a" .and. text(i:i) <= "z") then
        upper(i:i) = achar(iachar(text(i:i)) - 32)
      else
        upper(i:i) = text(i:i)
      end if
    end do
  end function to_upper

  !> Whether two names are the same without regard to case and trailing blanks.
  pure logical function same_name(a, b)
    character(*), intent(in) :: a, b !! names as written

    same_name = len_trim(a) == len_trim(b)
    if (same_name) same_name = to_upper(a) == to_upper(b)
  end function same_name

  !> Canonical form of a keyword or parameter name: upper case, every run of blanks, `_` and `-`
  !! a single blank, none at the ends.
  pure function normalize_keyword(text) result(canonical)
    character(*), intent(in)  :: text      !! name as written, without the star
    character(:), allocatable :: canonical
    character(len(text)) :: upper, packed
    integer :: i, n

    upper = to_upper(text)
    packed = ""
    n = 0
    do i = 1, len(text)
      if (index(" _-"//achar(9), upper(i:i)) == 0) then
        n = n + 1
        packed(n:n) = upper(i:i)
      else if (n > 0) then
        if (packed(n:n) /= " ") n = n + 1
      end if
    end do
    canonical = trim(packed(:n))
  end function normalize_keyword

  !> The candidate that a word was probably meant to be, empty if none is close: an edit distance
  !! (insert, delete, replace, swap) of at most a third of the longer length, at least 1.
  pure function nearest_word(word, candidates) result(nearest)
    character(*), intent(in)  :: word          !! word as written
    character(*), intent(in)  :: candidates(:) !! (n) words to choose from, trailing blanks ignored
    character(:), allocatable :: nearest
    integer :: best, distance, i

    nearest = ""
    best = huge(best)
    if (len_trim(word) > 80) return
    do i = 1, size(candidates)
      distance = edit_distance(to_upper(trim(word)), to_upper(trim(candidates(i))))
      if (distance > max(1, max(len_trim(word), len_trim(candidates(i)))/3)) cycle
      if (distance >= best .or. distance >= len_trim(candidates(i))) cycle
      best = distance
      nearest = trim(candidates(i))
    end do
  end function nearest_word

  !> Number of edits from one word to another: insert, delete, replace, swap of neighbours.
  pure integer function edit_distance(a, b)
    character(*), intent(in) :: a, b !! words
    integer :: cost, i, j
    integer :: d(-1:len(a), -1:len(b))

    d = len(a) + len(b)
    d(0:, 0) = [(i, i=0, len(a))]
    d(0, 0:) = [(j, j=0, len(b))]
    do j = 1, len(b)
      do i = 1, len(a)
        cost = merge(0, 1, a(i:i) == b(j:j))
        d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
        if (i == 1 .or. j == 1) cycle
        if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) &
          d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
      end do
    end do
    edit_distance = d(len(a), len(b))
  end function edit_distance

  !> Reads an integer: an optional sign and digits, nothing else.
  pure subroutine parse_integer(text, value, ok)
    character(*), intent(in) :: text  !! without blanks at the ends
    integer, intent(out)     :: value !! 0 when not ok
    logical, intent(out)     :: ok    !! .false.: not an integer, or too large
    integer(i64) :: total
    integer :: first, i

    value = 0
    total = 0
    ok = .false.
    first = 1 + n_signs(text)
    if (first > len(text)) return
    do i = first, len(text)
      if (.not. is_digit(text(i:i))) return
      total = 10*total + iachar(text(i:i)) - iachar("0")
      if (total > huge(value)) return
    end do
    value = int(total)
    if (text(1:1) == "-") value = -value
    ok = .true.
  end subroutine parse_integer

  !> Reads a real: `1`, `.5`, `-2.`, `1e-3`, `1D3`. Not a number: NaN, Inf, `2*3.`, `/`, blanks.
  !! Too small becomes zero, too large is refused. Correctly rounded.
  pure subroutine parse_real(text, value, ok)
    character(*), intent(in) :: text  !! without blanks at the ends
    real(dp), intent(out)    :: value !! 0 when not ok
    logical, intent(out)     :: ok    !! .false.: not a number, or too large
    type(decimal_t) :: decimal

    value = 0.0_dp
    call parse_short_real(text, value, ok)
    if (ok) return
    decimal = taken_apart(text)
    ok = decimal%valid
    if (.not. ok) return
    if (len(decimal%digits) == 0 .or. decimal%exponent < -330) return
    ok = .not. overflows(decimal)
    if (.not. ok) return
    value = rounded(decimal)
    if (decimal%negative) value = -value
  end subroutine parse_real

  !> Reads a number with few digits without an internal file: at most 15 digits times or over a
  !! power of ten up to 22 is exact before the one rounding.
  pure subroutine parse_short_real(text, value, ok)
    character(*), intent(in) :: text  !! without blanks at the ends
    real(dp), intent(out)    :: value !! 0 when not ok
    logical, intent(out)     :: ok    !! .false.: not a number without exponent and with few digits
    integer(i64) :: mantissa
    integer :: first, i, n_digits, point

    value = 0.0_dp
    ok = .false.
    mantissa = 0
    n_digits = 0
    point = 0
    first = 1 + n_signs(text)
    do i = first, len(text)
      if (is_digit(text(i:i))) then
        n_digits = n_digits + 1
        if (n_digits > 15) return
        mantissa = 10*mantissa + iachar(text(i:i)) - iachar("0")
      else if (text(i:i) == "." .and. point == 0) then
        point = i
      else
        return
      end if
    end do
    if (n_digits == 0) return
    value = real(mantissa, dp)
    if (point > 0) value = value/10.0_dp**(len(text) - point)
    if (text(1:1) == "-") value = -value
    ok = .true.
  end subroutine parse_short_real

  !> Takes a number apart into sign, significant digits and exponent.
  pure function taken_apart(text) result(decimal)
    character(*), intent(in) :: text !! without blanks at the ends
    type(decimal_t) :: decimal
    character(len(text)) :: digits
    integer :: exponent, i, n, n_fraction, n_mantissa, point

    digits = ""
    n = 0
    n_mantissa = 0
    n_fraction = 0
    point = 0
    i = 1 + n_signs(text)
    do i = i, len(text)
      if (is_digit(text(i:i))) then
        n_mantissa = n_mantissa + 1
        if (point > 0) n_fraction = n_fraction + 1
        if (n == 0 .and. text(i:i) == "0") cycle
        n = n + 1
        digits(n:n) = text(i:i)
      else if (text(i:i) == "." .and. point == 0) then
        point = i
      else
        exit
      end if
    end do
    call parse_exponent(text(i:), exponent, decimal%valid)
    decimal%valid = decimal%valid .and. n_mantissa > 0
    decimal%negative = index(text, "-") == 1
    decimal%digits = digits(:n)
    decimal%exponent = exponent + n - n_fraction
  end function taken_apart

  !> Reads the exponent of a real: empty, or E or D, an optional sign and digits.
  pure subroutine parse_exponent(text, exponent, ok)
    character(*), intent(in) :: text     !! rest of a number
    integer, intent(out)     :: exponent !! limited to +-99999
    logical, intent(out)     :: ok       !! .false.: not an exponent
    integer, parameter :: limit = 99999
    integer :: first, i

    exponent = 0
    ok = len(text) == 0
    if (ok) return
    if (index("eEdD", text(1:1)) == 0) return
    first = 2 + n_signs(text(2:))
    if (first > len(text)) return
    do i = first, len(text)
      if (.not. is_digit(text(i:i))) return
      exponent = min(limit, 10*exponent + iachar(text(i:i)) - iachar("0"))
    end do
    if (text(2:2) == "-") exponent = -exponent
    ok = .true.
  end subroutine parse_exponent

  !> Whether a decimal number is beyond the largest real, 1.7976931348623157E308: decided on the
  !! digits, because the conversion itself would trap.
  pure logical function overflows(decimal)
    type(decimal_t), intent(in) :: decimal !! a number other than zero
    character(*), parameter :: largest = "17976931348623157"

    overflows = decimal%exponent > 309
    if (decimal%exponent == 309) &
      overflows = decimal%digits(:min(len(decimal%digits), len(largest))) > largest
  end function overflows

  !> Magnitude of a decimal number that neither overflows nor vanishes.
  pure real(dp) function rounded(decimal)
    type(decimal_t), intent(in) :: decimal !! a number other than zero
    integer, parameter :: n_kept = 40
    character(64) :: buffer
    integer :: n, status

    n = min(n_kept, len(decimal%digits))
    write (buffer, "(a,a,i0)") decimal%digits(:n), "E", decimal%exponent - n
    read (buffer, "(e64.0)", iostat=status) rounded
    if (status /= 0) rounded = 0.0_dp
  end function rounded

  !> Reads reals separated by commas, blanks around them allowed.
  pure subroutine parse_real_list(text, value, ok)
    character(*), intent(in) :: text                  !! `1, 2, 3`
    real(dp), allocatable, intent(out) :: value(:)    !! (n), empty when not ok
    logical, intent(out) :: ok                        !! .false.: an item is not a number
    integer :: comma, first
    real(dp) :: item

    allocate (value(0))
    first = 1
    do
      comma = index(text(first:), ",")
      if (comma == 0) comma = len(text) - first + 2
      call parse_real(trim(adjustl(text(first:first + comma - 2))), item, ok)
      if (.not. ok) then
        value = [real(dp) ::]
        return
      end if
      value = [value, item]
      first = first + comma
      if (first > len(text) + 1) exit
    end do
  end subroutine parse_real_list

  !> Number of bytes of the UTF-8 character that begins at a byte, 0 if none begins there: a stray
  !! or missing byte, an overlong form, a surrogate.
  pure integer function bytes_of_character(text, first) result(n)
    character(*), intent(in) :: text  !! any bytes
    integer, intent(in)      :: first !! 1..len(text)
    integer :: byte, i, second

    byte = ichar(text(first:first))
    n = 1
    if (byte < 128) return
    n = 0
    if (byte < 194 .or. byte > 244) return
    n = merge(2, merge(3, 4, byte < 240), byte < 224)
    if (first + n - 1 > len(text)) n = 0
    do i = first + 1, first + n - 1
      if (iand(ichar(text(i:i)), 192) /= 128) n = 0
    end do
    if (n == 0) return
    second = ichar(text(first + 1:first + 1))
    if ((byte == 224 .and. second < 160) .or. (byte == 237 .and. second > 159)) n = 0
    if ((byte == 240 .and. second < 144) .or. (byte == 244 .and. second > 143)) n = 0
  end function bytes_of_character

  !> Shortest text of an integer.
  pure function integer_text(value) result(text)
    integer, intent(in) :: value !! any integer
    character(:), allocatable :: text
    character(12) :: buffer

    write (buffer, "(i0)") value
    text = trim(buffer)
  end function integer_text

  !> Short text of a real: up to 6 significant digits, no trailing zeros, `0.25`, `1e-5`, `3`.
  pure function real_text(value) result(text)
    real(dp), intent(in) :: value !! any real
    character(:), allocatable :: text

    text = text_of_digits(value, 6)
  end function real_text

  !> Text of a real that gives back a decimal number of up to 15 digits as it was written.
  pure function full_text(value) result(text)
    real(dp), intent(in) :: value !! any real
    character(:), allocatable :: text

    text = text_of_digits(value, 15)
  end function full_text

  !> Text of a real, rounded, without trailing zeros.
  pure function text_of_digits(value, n_digits) result(text)
    real(dp), intent(in) :: value    !! any real
    integer, intent(in)  :: n_digits !! most significant digits, 6 to 17
    character(:), allocatable :: text
    character(40) :: buffer
    character(12) :: form
    integer :: exponent, point

    if (.not. ieee_is_finite(value)) then
      write (buffer, "(f0.0)") value
      text = trim(buffer)
      return
    end if
    write (form, "(a,i0,a)") "(es40.", n_digits - 1, "e3)"
    write (buffer, form) value
    buffer = adjustl(buffer)
    point = index(buffer, "E")
    read (buffer(point + 1:), "(i5)") exponent
    if (exponent >= -4 .and. exponent <= 5) then
      write (form, "(a,i0,a)") "(f40.", n_digits - 1 - exponent, ")"
      write (buffer, form) value
      text = without_trailing_zeros(trim(adjustl(buffer)))
    else
      text = without_trailing_zeros(buffer(:point - 1))//"e"//integer_text(exponent)
    end if
  end function text_of_digits

  !> A decimal fraction without zeros at its end, and without a point at its end.
  pure function without_trailing_zeros(text) result(short)
    character(*), intent(in)  :: text !! digits with a point
    character(:), allocatable :: short

    short = text(:verify(text, "0", back=.true.))
    if (index(short, ".") == len(short)) short = short(:len(short) - 1)
  end function without_trailing_zeros

  !> Number of signs at the start of a text, 0 or 1.
  pure integer function n_signs(text)
    character(*), intent(in) :: text !! any text

    n_signs = 0
    if (len(text) == 0) return
    if (text(1:1) == "+" .or. text(1:1) == "-") n_signs = 1
  end function n_signs

  !> Whether a character is a decimal digit.
  pure logical function is_digit(letter)
    character(1), intent(in) :: letter !! one character

    is_digit = letter >= "0" .and. letter <= "9"
  end function is_digit

end module mpm_text
