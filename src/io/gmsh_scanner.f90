!> A mesh file in memory, read line by line and number by number; remembers the first failure.
module mpm_gmsh_scanner
  use mpm_input_file, only: load_input
  use mpm_kinds, only: dp, ip
  use mpm_source_excerpt, only: printable
  use mpm_text, only: integer_text, largest_input, parse_real, real_text
  implicit none
  private
  public :: gmsh_scanner_t, load_text, failed, fail_at_token, fail_at_line, fail_at_end
  public :: next_line, next_integer, next_real, next_word, end_line, rest_of_line, line_text
  public :: next_count, number_failure, read_count

  character(*), parameter :: blanks = " "//achar(9)//achar(13)

  !> The text, the current line and word, and the first failure. After a failure every
  !! procedure returns at once, so that callers need not test after each number.
  type :: gmsh_scanner_t
    character(:), allocatable :: path    !! name of the file, for messages
    character(:), allocatable :: text    !! whole file
    character(:), allocatable :: section !! section that is being read, such as $Nodes
    integer     :: line = 0              !! number of the current line
    integer(ip) :: line_first = 1        !! first character of the current line
    integer(ip) :: line_last = 0         !! last character of the current line, without line end
    integer(ip) :: at = 1                !! next character to look at
    integer(ip) :: word_first = 1        !! first character of the last word
    character(:), allocatable :: message !! first failure; unallocated: none
    integer     :: error_line = 0        !! line of the failure, 0 = the file as a whole
    integer     :: error_column = 0      !! column of the failure
  end type gmsh_scanner_t

contains

  !> Reads a whole file; a directory, a missing or an empty file is a failure.
  subroutine load_text(scanner, path)
    type(gmsh_scanner_t), intent(out) :: scanner !! at the start of the file
    character(*), intent(in) :: path             !! file
    character(:), allocatable :: reason

    scanner%path = path
    scanner%section = ""
    call load_input(scanner%text, path, reason)
    if (len(reason) > 0) then
      scanner%message = "cannot be read ("//reason//"): expected a gmsh mesh"
    else if (len(scanner%text, ip) == 0) then
      scanner%message = "the file is empty: expected a gmsh mesh"
    end if
  end subroutine load_text

  !> Whether something went wrong already.
  pure function failed(scanner) result(has_failed)
    type(gmsh_scanner_t), intent(in) :: scanner !! any
    logical :: has_failed                       !! .true. after the first failure

    has_failed = allocated(scanner%message)
  end function failed

  !> Failure at the last word.
  pure subroutine fail_at_token(scanner, message)
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    character(*), intent(in) :: message            !! what is wrong and what was expected

    call fail_at_line(scanner, scanner%line, message)
    scanner%error_column = int(scanner%word_first - scanner%line_first) + 1
  end subroutine fail_at_token

  !> Failure at the start of a line.
  pure subroutine fail_at_line(scanner, line, message)
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    integer, intent(in)      :: line               !! number of the line
    character(*), intent(in) :: message            !! what is wrong and what was expected

    if (failed(scanner)) return
    scanner%message = printable(message)
    scanner%error_line = line
    scanner%error_column = 1
  end subroutine fail_at_line

  !> Puts the words for one item in the place of those for any, if the failure has them. Hot loops
  !! say which item they expect only in this way, after a failure.
  pure subroutine number_failure(scanner, any_item, item)
    type(gmsh_scanner_t), intent(inout) :: scanner !! message is changed
    character(*), intent(in) :: any_item           !! such as "the number of a node"
    character(*), intent(in) :: item               !! such as "the number of node 3 of 7"
    integer :: first

    first = index(scanner%message, any_item, back=.true.)
    if (first > 0) scanner%message = scanner%message(:first - 1)//item &
                                     //scanner%message(first + len(any_item):)
  end subroutine number_failure

  !> Failure because the file ends: points behind the last line.
  pure subroutine fail_at_end(scanner, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    character(*), intent(in) :: expected           !! what was expected

    if (scanner%section == "") then
      call fail_at_line(scanner, max(1, scanner%line), "the file ends: expected "//expected)
    else
      call fail_at_line(scanner, max(1, scanner%line), "the file ends inside "//scanner%section &
                        //": expected "//expected)
    end if
  end subroutine fail_at_end

  !> Goes to the next line that is not blank.
  pure subroutine next_line(scanner, expected, found)
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the start of the line afterwards
    character(*), intent(in) :: expected           !! what the line should hold, for the message
    logical, intent(out), optional :: found        !! .false. at the end of the file: no failure

    if (present(found)) found = .false.
    if (failed(scanner)) return
    do
      if (scanner%at > len(scanner%text)) exit
      scanner%line = scanner%line + 1
      scanner%line_first = scanner%at
      scanner%word_first = scanner%at
      scanner%line_last = end_of_line(scanner) - 1
      if (verify(scanner%text(scanner%at:scanner%line_last), blanks) > 0) then
        if (present(found)) found = .true.
        return
      end if
      scanner%at = scanner%line_last + 2
    end do
    if (.not. present(found)) call fail_at_end(scanner, expected)
  end subroutine next_line

  !> Position of the next line end, one behind the text if there is none.
  pure function end_of_line(scanner) result(at)
    type(gmsh_scanner_t), intent(in) :: scanner !! at the start of a line
    integer(ip) :: at                           !! position in the text

    do at = scanner%at, len(scanner%text, ip)
      if (scanner%text(at:at) == achar(10)) return
    end do
  end function end_of_line

  !> Finds the next word of the line; its last character is at - 1.
  pure subroutine next_word(scanner, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! word_first .. at - 1 is the word
    character(*), intent(in) :: expected           !! what was expected, for the message
    integer(ip) :: i

    if (failed(scanner)) return
    i = scanner%at
    do while (i <= scanner%line_last)
      if (.not. is_blank(scanner%text(i:i))) exit
      i = i + 1
    end do
    scanner%word_first = i
    do while (i <= scanner%line_last)
      if (is_blank(scanner%text(i:i))) exit
      i = i + 1
    end do
    scanner%at = i
    if (scanner%word_first < i) return
    if (i > len(scanner%text)) call fail_at_token(scanner, "the file ends: expected "//expected)
    call fail_at_token(scanner, "the line ends: expected "//expected)
  end subroutine next_word

  !> Whether a character separates words.
  pure function is_blank(character_1) result(blank)
    character(1), intent(in) :: character_1 !! one character
    logical :: blank                        !! .true. for blank, tab, carriage return

    blank = character_1 == " " .or. character_1 == achar(9) .or. character_1 == achar(13)
  end function is_blank

  !> The next word as an integer.
  pure subroutine next_integer(scanner, value, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the word afterwards
    integer, intent(out)     :: value              !! 0 after a failure
    character(*), intent(in) :: expected           !! what was expected, for the message
    integer(ip) :: i, first, total, digit

    value = 0
    call next_word(scanner, expected)
    if (failed(scanner)) return
    first = scanner%word_first
    if (index("+-", scanner%text(first:first)) > 0 .and. scanner%at - first > 1) first = first + 1
    total = 0
    do i = first, scanner%at - 1
      digit = iachar(scanner%text(i:i)) - iachar("0")
      if (digit < 0 .or. digit > 9) then
        call fail_at_token(scanner, "'"//word(scanner)//"' is not an integer: expected "//expected)
        return
      end if
      total = 10*total + digit
      if (total > huge(value)) then
        call fail_at_token(scanner, "'"//word(scanner)//"' is too large: expected "//expected &
                           //", at most "//integer_text(huge(value)))
        return
      end if
    end do
    value = int(total)
    if (scanner%text(scanner%word_first:scanner%word_first) == "-") value = -value
  end subroutine next_integer

  !> A line that holds one count.
  subroutine read_count(scanner, n, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the line
    integer, intent(out)     :: n                  !! count, 0 after a failure
    character(*), intent(in) :: expected           !! what the count is

    call next_line(scanner, expected)
    call next_count(scanner, n, expected)
    call end_line(scanner, "only "//expected)
  end subroutine read_count

  !> A count: not negative, and not more than the rest of the file can hold.
  subroutine next_count(scanner, n, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the number
    integer, intent(out)     :: n                  !! count, 0 after a failure
    character(*), intent(in) :: expected           !! what the count is

    call next_integer(scanner, n, expected)
    if (n < 0) call fail_at_token(scanner, "a count below zero: expected "//expected)
    if (n > bytes_left(scanner)) call fail_at_token(scanner, "the file is too short for this " &
      & //"count: it was truncated, or the count is wrong: expected "//expected)
    if (failed(scanner)) n = 0
  end subroutine next_count

  !> The next word as a real number.
  pure subroutine next_real(scanner, value, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the word afterwards
    real(dp), intent(out)    :: value              !! 0 after a failure
    character(*), intent(in) :: expected           !! what was expected, for the message
    logical :: ok

    value = 0.0_dp
    call next_word(scanner, expected)
    if (failed(scanner)) return
    call parse_real(scanner%text(scanner%word_first:scanner%at - 1), value, ok)
    if (.not. ok) then
      value = 0.0_dp
      call fail_at_token(scanner, "'"//word(scanner)//"' is not a number: expected "//expected)
    else if (abs(value) > largest_input) then
      value = 0.0_dp
      call fail_at_token(scanner, "'"//word(scanner)//"' is too large: expected "//expected &
                         //", at most "//real_text(largest_input)//" in magnitude")
    end if
  end subroutine next_real

  !> The last word, cut to a length that fits a message.
  pure function word(scanner) result(shown)
    type(gmsh_scanner_t), intent(in) :: scanner !! behind a word
    character(:), allocatable :: shown          !! any bytes

    shown = scanner%text(scanner%word_first:min(scanner%at - 1, scanner%word_first + 39))
  end function word

  !> The line must end here.
  pure subroutine end_line(scanner, expected)
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the next line afterwards
    character(*), intent(in) :: expected           !! what the line should hold, for the message

    if (failed(scanner)) return
    if (verify(scanner%text(scanner%at:scanner%line_last), blanks) > 0) then
      call next_word(scanner, expected)
      call fail_at_token(scanner, "unexpected '"//word(scanner)//"': expected "//expected)
      return
    end if
    scanner%at = scanner%line_last + 2
  end subroutine end_line

  !> Takes what is left of the line, without blanks around it.
  pure subroutine rest_of_line(scanner, rest)
    type(gmsh_scanner_t), intent(inout) :: scanner     !! at the next line afterwards
    character(:), allocatable, intent(out) :: rest     !! text
    integer :: first, last

    rest = ""
    if (failed(scanner)) return
    rest = scanner%text(scanner%at:scanner%line_last)
    first = verify(rest, blanks)
    last = verify(rest, blanks, back=.true.)
    if (first > 0) then
      scanner%word_first = scanner%at + first - 1
      rest = rest(first:last)
    else
      rest = ""
    end if
    scanner%at = scanner%line_last + 2
  end subroutine rest_of_line

  !> Characters that are still to be read: no count in the file can be larger.
  pure function bytes_left(scanner) result(n_byte)
    type(gmsh_scanner_t), intent(in) :: scanner !! anywhere
    integer :: n_byte                           !! at most huge

    n_byte = int(min(int(huge(1), ip), len(scanner%text, ip) - scanner%at + 1))
  end function bytes_left

  !> A line of the file for a message, cut and made printable.
  pure function line_text(scanner, line) result(text)
    type(gmsh_scanner_t), intent(in) :: scanner !! with a file
    integer, intent(in) :: line                 !! number of the line
    character(:), allocatable :: text           !! empty when there is no such line
    integer(ip) :: first, length
    integer :: i

    text = ""
    first = 1
    do i = 1, line
      if (first > len(scanner%text)) return
      length = index(scanner%text(first:), achar(10), kind=ip) - 1
      if (length < 0) length = len(scanner%text, ip) - first + 1
      if (i == line) text = scanner%text(first:first + min(length, 200_ip) - 1)
      first = first + length + 1
    end do
    if (len(text) == 0) return
    if (text(len(text):) == achar(13)) text = text(:len(text) - 1)
    text = printable(text)
  end function line_text

end module mpm_gmsh_scanner
