!> The comparisons behind the assertions, on arrays made flat.
module pf_compare
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_fortran_env, only: int64, real64
  use pf_run, only: SourceLocation, throw
  implicit none
  private
  public :: assertion, assertion_t, compare, require
  public :: op_eq, op_ne, op_lt, op_le, op_gt, op_ge

  integer, parameter :: op_eq = 1, op_ne = 2, op_lt = 3, op_le = 4, op_gt = 5, op_ge = 6
  character(*), parameter :: name_of(6) = [character(24) :: "AssertEqual", "AssertNotEqual", &
    "AssertLessThan", "AssertLessThanOrEqual", "AssertGreaterThan", "AssertGreaterThanOrEqual"]
  character(*), parameter :: nl = new_line("a")

  !> What is asserted, apart from the values.
  type :: assertion_t
    integer :: op = op_eq                  !! one of op_*
    integer, allocatable :: expected(:)    !! (rank) shape of the expected value, () for a scalar
    integer, allocatable :: actual(:)      !! (rank) shape of the value found
    type(SourceLocation) :: location       !! where the assertion stands
    character(:), allocatable :: message   !! words of the test's author, empty if none
    real(real64) :: tolerance = 0          !! absolute tolerance of op_eq and op_ne
  end type assertion_t

  !> Fails the running test unless the relation holds for every element; one expected value stands
  !! for all elements, and shapes must agree otherwise.
  interface compare
    module procedure compare_character, compare_integer, compare_logical, compare_real
  end interface compare

contains

  !> Bundles what the assertions share.
  pure function assertion(op, expected, actual, location, message, tolerance) result(a)
    integer, intent(in) :: op                          !! one of op_*
    integer, intent(in) :: expected(:)                 !! (rank) shape of the expected value
    integer, intent(in) :: actual(:)                   !! (rank) shape of the value found
    type(SourceLocation), intent(in) :: location       !! where the assertion stands
    character(*), intent(in), optional :: message      !! words of the test's author
    real(real64), intent(in), optional :: tolerance    !! absolute tolerance
    type(assertion_t) :: a

    a%op = op
    a%expected = expected
    a%actual = actual
    a%location = location
    a%message = ""
    if (present(message)) a%message = message // nl
    if (present(tolerance)) a%tolerance = tolerance
  end function assertion

  !> Fails the running test unless the condition holds.
  subroutine require(condition, what, location, message)
    logical, intent(in) :: condition              !! must be true
    character(*), intent(in) :: what              !! name of the assertion
    type(SourceLocation), intent(in) :: location  !! where it stands
    character(*), intent(in), optional :: message !! words of the test's author

    if (condition) return
    if (present(message)) then
      call throw(message // nl // what // " failure", location)
    else
      call throw(what // " failure", location)
    end if
  end subroutine require

  subroutine compare_real(expected, actual, a)
    real(real64), intent(in) :: expected(:), actual(:)
    type(assertion_t), intent(in) :: a

    character(80) :: difference
    integer :: i, j

    if (.not. conformable(a)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if (holds_real(a, expected(j), actual(i))) cycle
      difference = ""
      if (a%op == op_eq .and. is_finite(expected(j)) .and. is_finite(actual(i))) then
        write (difference, "(a, g0, a, g0, a)") "<", actual(i) - expected(j), &
          "> (greater than tolerance of ", a%tolerance, ")"
      end if
      call fail(a, i, text_of_real(expected(j)), text_of_real(actual(i)), trim(difference))
      return
    end do
  end subroutine compare_real

  subroutine compare_integer(expected, actual, a)
    integer(int64), intent(in) :: expected(:), actual(:)
    type(assertion_t), intent(in) :: a

    character(24) :: texts(3)
    integer :: i, j

    if (.not. conformable(a)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if (holds_order(a%op, expected(j) < actual(i), expected(j) > actual(i))) cycle
      write (texts, "(i0)") expected(j), actual(i), actual(i) - expected(j)
      if (a%op /= op_eq) texts(3) = ""
      call fail(a, i, trim(texts(1)), trim(texts(2)), trim(texts(3)))
      return
    end do
  end subroutine compare_integer

  subroutine compare_logical(expected, actual, a)
    logical, intent(in) :: expected(:), actual(:)
    type(assertion_t), intent(in) :: a

    character(*), parameter :: text(0:1) = [character(7) :: ".false.", ".true."]
    integer :: i, j

    if (.not. conformable(a)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if ((expected(j) .eqv. actual(i)) .eqv. a%op == op_eq) cycle
      call fail(a, i, trim(text(merge(1, 0, expected(j)))), trim(text(merge(1, 0, actual(i)))), "")
      return
    end do
  end subroutine compare_logical

  ! As Fortran compares: blanks at the end do not count. pFUnit ignores those in front as well.
  subroutine compare_character(expected, actual, a)
    character(*), intent(in) :: expected(:), actual(:)
    type(assertion_t), intent(in) :: a

    integer :: i, j

    if (.not. conformable(a)) return
    do i = 1, size(actual)
      j = min(i, size(expected))
      if (expected(j) == actual(i)) cycle
      call fail(a, i, trim(expected(j)), trim(actual(i)), "")
      return
    end do
  end subroutine compare_character

  ! A NaN fulfils nothing, not even "not equal"; an infinity equals only itself.
  pure logical function holds_real(a, expected, actual) result(holds)
    type(assertion_t), intent(in) :: a
    real(real64), intent(in) :: expected, actual

    if (is_nan(expected) .or. is_nan(actual)) then
      holds = .false.
    else if (a%op > op_ne .or. .not. (is_finite(expected) .and. is_finite(actual))) then
      holds = holds_order(a%op, expected < actual, expected > actual)
    else
      holds = (abs(actual - expected) <= a%tolerance) .eqv. a%op == op_eq
    end if
  end function holds_real

  pure logical function holds_order(op, less, greater) result(holds)
    integer, intent(in) :: op
    logical, intent(in) :: less, greater

    select case (op)
    case (op_eq)
      holds = .not. (less .or. greater)
    case (op_ne)
      holds = less .or. greater
    case (op_lt)
      holds = less
    case (op_le)
      holds = .not. greater
    case (op_gt)
      holds = greater
    case default
      holds = .not. less
    end select
  end function holds_order

  ! Reports shapes that differ.
  logical function conformable(a) result(same)
    type(assertion_t), intent(in) :: a

    same = size(a%expected) == 0
    if (.not. same) same = all(a%expected == a%actual)
    if (same) return
    call throw(a%message // "Arrays not conformable" &
      // nl // "    Expected shape: " // list(a%expected) &
      // nl // "      Actual shape: " // list(a%actual), a%location)
  end function conformable

  subroutine fail(a, i, expected, actual, difference)
    type(assertion_t), intent(in) :: a
    integer, intent(in) :: i ! position of the first offender in the flat array
    character(*), intent(in) :: expected, actual, difference

    character(:), allocatable :: text

    text = a%message
    if (size(a%actual) > 0) text = text // "Array"
    text = text // trim(name_of(a%op)) // " failure:" &
      // nl // "      Expected: <" // expected // ">" // nl // "        Actual: <" // actual // ">"
    if (difference /= "") text = text // nl // "    Difference: " // difference
    if (size(a%actual) > 0) text = text // nl // "      at index: " // list(subscripts(i, a%actual))
    call throw(text, a%location)
  end subroutine fail

  pure function subscripts(i, extents) result(index)
    integer, intent(in) :: i, extents(:)
    integer :: index(size(extents))

    integer :: k, rest

    rest = i - 1
    do k = 1, size(extents)
      index(k) = 1 + modulo(rest, extents(k))
      rest = rest / extents(k)
    end do
  end function subscripts

  pure function list(values) result(text)
    integer, intent(in) :: values(:)
    character(:), allocatable :: text

    character(12) :: number
    integer :: k

    text = "["
    do k = 1, size(values)
      write (number, "(i0)") values(k)
      text = text // trim(number)
      if (k < size(values)) text = text // ","
    end do
    text = text // "]"
  end function list

  pure function text_of_real(x) result(text)
    real(real64), intent(in) :: x
    character(:), allocatable :: text

    character(32) :: buffer

    buffer = "NaN"
    if (.not. is_nan(x)) write (buffer, "(g0)") x
    text = trim(buffer)
  end function text_of_real

  pure logical function is_finite(x) result(finite)
    real(real64), intent(in) :: x

    finite = .false.
    if (.not. is_nan(x)) finite = ieee_is_finite(x)
  end function is_finite

  ! By the bits: any comparison of a signalling NaN would trap in a checked build, and end the run
  ! where a message is wanted.
  pure logical function is_nan(x) result(nan)
    real(real64), intent(in) :: x

    integer(int64), parameter :: infinity = int(z"7FF0000000000000", int64)

    nan = ibclr(transfer(x, infinity), 63) > infinity
  end function is_nan

end module pf_compare
