!> A message with the line that it is about: the line is cut, cleaned and pointed at.
module mpm_source_excerpt
  use mpm_text, only: bytes_of_character, integer_text
  implicit none
  private
  public :: source_place_t, message_text, printable

  integer, parameter :: max_excerpt = 96     !! characters of a line that are shown
  integer, parameter :: rank_other = 1000000 !! files that do not belong to the deck come last

  !> Where a message points to.
  type :: source_place_t
    integer :: rank = rank_other       !! order of the file: its index in the deck
    character(:), allocatable :: path  !! file
    integer :: line = 0                !! line in the file, 0 = the file as a whole
    integer :: first = 1               !! columns of the token
    integer :: last = 1
    character(:), allocatable :: text  !! the line
  end type source_place_t

contains

  !> Complete text of a message: where, what, the line and a caret below the token.
  pure function message_text(place, is_error, message, hint) result(text)
    type(source_place_t), intent(in)   :: place    !! what to point at
    logical, intent(in)                :: is_error !! .false.: a warning
    character(*), intent(in)           :: message  !! what is wrong and what was expected
    character(*), intent(in), optional :: hint     !! text behind the caret
    character(:), allocatable :: number, pointer_line, text
    integer :: cut, width

    text = place%path//":"
    if (place%line > 0) &
      text = text//integer_text(place%line)//":"//integer_text(screen_column(place))//":"
    text = text//trim(merge(" error:  ", " warning:", is_error))//" "//message
    if (place%line == 0 .or. len_trim(place%text) == 0) return
    number = integer_text(place%line)
    number = repeat(" ", max(0, 5 - len(number)))//number//" | "
    cut = 0
    if (place%last > max_excerpt) cut = max(0, place%first - max_excerpt/2)
    do while (cut > 0 .and. is_later_byte(place%text(cut + 1:cut + 1)))
      cut = cut - 1
    end do
    pointer_line = blanks_below(place%text(cut + 1:min(len(place%text), place%first - 1)))
    width = len(blanks_below(place%text(place%first:min(len(place%text), place%last, &
                                                        cut + max_excerpt))))
    pointer_line = pointer_line//"^"//repeat("~", max(width, 1) - 1)
    if (cut > 0) pointer_line = "   "//pointer_line
    if (present(hint)) pointer_line = trim(pointer_line//" "//hint)
    text = text//new_line("a")//number//excerpt(place%text, cut)//new_line("a") &
           //repeat(" ", len(number) - 2)//"| "//pointer_line
  end function message_text

  !> Column of the token on the screen: a character of several bytes counts once.
  pure integer function screen_column(place)
    type(source_place_t), intent(in) :: place !! what is pointed at
    integer :: i

    screen_column = place%first
    if (.not. allocated(place%text)) return
    do i = 1, min(place%first - 1, len(place%text))
      if (is_later_byte(place%text(i:i))) screen_column = screen_column - 1
    end do
  end function screen_column

  !> The part of a line that is shown, without control characters.
  pure function excerpt(line, cut) result(part)
    character(*), intent(in)  :: line !! a line of a file
    integer, intent(in)       :: cut  !! characters left out at the start
    character(:), allocatable :: part
    integer :: last

    last = len_trim(line)
    if (last > cut + max_excerpt) last = cut + max_excerpt
    part = printable(line(cut + 1:last))
    if (cut > 0) part = "..."//part
    if (last < len_trim(line)) part = part//"..."
  end function excerpt

  !> Blanks as wide as a text on the screen: tabs stay, the later bytes of a character vanish.
  pure function blanks_below(text) result(blanks)
    character(*), intent(in)  :: text !! a part of a line
    character(:), allocatable :: blanks
    integer :: i

    blanks = ""
    do i = 1, len(text)
      if (text(i:i) == achar(9)) then
        blanks = blanks//achar(9)
      else if (.not. is_later_byte(text(i:i))) then
        blanks = blanks//" "
      end if
    end do
  end function blanks_below

  !> Whether a byte is the second or a later one of a UTF-8 character.
  pure logical function is_later_byte(byte)
    character(1), intent(in) :: byte !! any byte

    is_later_byte = iand(ichar(byte), 192) == 128
  end function is_later_byte

  !> A text with control characters, except tabs, and bytes that are not UTF-8 replaced by
  !! question marks.
  pure function printable(text) result(clean)
    character(*), intent(in) :: text !! any bytes
    character(len(text))     :: clean
    integer :: byte, i, n

    clean = text
    i = 1
    do while (i <= len(text))
      byte = ichar(text(i:i))
      n = bytes_of_character(text, i)
      if ((byte < 32 .and. byte /= 9) .or. byte == 127 .or. n == 0) clean(i:i) = "?"
      i = i + max(n, 1)
    end do
  end function printable

end module mpm_source_excerpt
