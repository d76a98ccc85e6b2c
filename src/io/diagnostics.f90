!> Messages about the input with file, line and column, collected until a pass is over.
module mpm_diagnostics
  use mpm_deck_card, only: deck_card_t, deck_field_t, deck_line_t, deck_t, parameter_index, &
                           physical_line
  use mpm_error, only: error_t, make_error
  use mpm_text, only: integer_text
  implicit none
  private
  public :: diagnostics_t, source_place_t, quoted
  public :: error_at_keyword, error_at_parameter, error_at_field, error_at_place, error_in_file
  public :: warning_at_keyword, warning_at_parameter, warning_at_field
  public :: place_in_line, to_error, warnings_text

  integer, parameter :: max_kept = 200     !! messages kept; further ones are only counted
  integer, parameter :: max_excerpt = 96   !! characters of a line that are shown
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

  !> One message.
  type :: diagnostic_t
    integer :: rank = 0, line = 0, column = 0
    logical :: is_error = .true.       !! .false.: a warning
    character(:), allocatable :: path
    character(:), allocatable :: text  !! complete, with the excerpt
  end type diagnostic_t

  !> The messages so far, kept in the order of file, line and column.
  type :: diagnostics_t
    integer :: n_errors = 0
    integer :: n_warnings = 0
    integer :: n = 0                              !! messages kept
    type(diagnostic_t), allocatable :: message(:) !! (max_kept)
  end type diagnostics_t

contains

  !> An error that points at a keyword.
  pure subroutine error_at_keyword(diag, deck, i_card, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one error more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    character(*), intent(in)           :: message   !! what is wrong and what was expected
    character(*), intent(in), optional :: hint      !! text behind the caret: did you mean ...

    call add_message(diag, .true., place_of_keyword(deck, i_card), message, hint)
  end subroutine error_at_keyword

  !> A warning that points at a keyword.
  pure subroutine warning_at_keyword(diag, deck, i_card, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one warning more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    character(*), intent(in)           :: message   !! what is odd
    character(*), intent(in), optional :: hint      !! text behind the caret

    call add_message(diag, .false., place_of_keyword(deck, i_card), message, hint)
  end subroutine warning_at_keyword

  !> An error that points at the value of a parameter, or at its name if it has none.
  pure subroutine error_at_parameter(diag, deck, i_card, name, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one error more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    character(*), intent(in)           :: name      !! canonical; keyword if not there
    character(*), intent(in)           :: message   !! what is wrong and what was expected
    character(*), intent(in), optional :: hint      !! text behind the caret: did you mean ...

    call add_message(diag, .true., place_of_parameter(deck, i_card, name), message, hint)
  end subroutine error_at_parameter

  !> A warning that points at the value of a parameter, or at its name if it has none.
  pure subroutine warning_at_parameter(diag, deck, i_card, name, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one warning more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    character(*), intent(in)           :: name      !! canonical; keyword if not there
    character(*), intent(in)           :: message   !! what is odd
    character(*), intent(in), optional :: hint      !! text behind the caret

    call add_message(diag, .false., place_of_parameter(deck, i_card, name), message, hint)
  end subroutine warning_at_parameter

  !> An error that points at a field of a data line, or behind it if there is no such field.
  pure subroutine error_at_field(diag, deck, i_card, i_line, i_field, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one error more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    integer, intent(in)                :: i_line    !! data line of the card
    integer, intent(in)                :: i_field   !! field; 0 = the whole line
    character(*), intent(in)           :: message   !! what is wrong and what was expected
    character(*), intent(in), optional :: hint      !! text behind the caret: did you mean ...

    call add_message(diag, .true., place_of_field(deck, i_card, i_line, i_field), message, hint)
  end subroutine error_at_field

  !> A warning that points at a field of a data line, or behind it if there is no such field.
  pure subroutine warning_at_field(diag, deck, i_card, i_line, i_field, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one warning more
    type(deck_t), intent(in)           :: deck      !! any deck
    integer, intent(in)                :: i_card    !! card of the deck
    integer, intent(in)                :: i_line    !! data line of the card
    integer, intent(in)                :: i_field   !! field; 0 = the whole line
    character(*), intent(in)           :: message   !! what is odd
    character(*), intent(in), optional :: hint      !! text behind the caret

    call add_message(diag, .false., place_of_field(deck, i_card, i_line, i_field), message, hint)
  end subroutine warning_at_field

  !> An error at a place.
  pure subroutine error_at_place(diag, place, message, hint)
    type(diagnostics_t), intent(inout) :: diag      !! gets one error more
    type(source_place_t), intent(in)   :: place     !! what to point at
    character(*), intent(in)           :: message   !! what is wrong and what was expected
    character(*), intent(in), optional :: hint      !! text behind the caret: did you mean ...

    call add_message(diag, .true., place, message, hint)
  end subroutine error_at_place

  !> An error in a file that is not a deck: a mesh file, say.
  pure subroutine error_in_file(diag, path, line, column, source_text, message)
    type(diagnostics_t), intent(inout) :: diag        !! gets one error more
    character(*), intent(in)           :: path        !! file
    integer, intent(in)                :: line        !! line; 0 = the file as a whole
    integer, intent(in)                :: column      !! first column of the token
    character(*), intent(in)           :: source_text !! the line; empty = no excerpt
    character(*), intent(in)           :: message     !! what is wrong and what was expected
    type(source_place_t) :: place
    integer :: width

    place%path = path
    place%line = line
    place%first = max(column, 1)
    place%text = source_text
    place%last = place%first
    if (place%first <= len(source_text)) then
      width = scan(source_text(place%first:), " ,"//achar(9)) - 1
      if (width < 0) width = len(source_text) - place%first + 1
      place%last = place%first + max(width, 1) - 1
    end if
    call add_message(diag, .true., place, message)
  end subroutine error_in_file

  !> The place of a keyword.
  pure function place_of_keyword(deck, i_card) result(place)
    type(deck_t), intent(in) :: deck   !! any deck
    integer, intent(in)      :: i_card !! card of the deck
    type(source_place_t)     :: place

    associate (head => deck%card(i_card)%head)
      place = place_in_line(deck, head, head%field(1)%first, head%field(1)%last)
    end associate
  end function place_of_keyword

  !> The place of a parameter's value, or else of its name, or else of the keyword.
  pure function place_of_parameter(deck, i_card, name) result(place)
    type(deck_t), intent(in) :: deck   !! any deck
    integer, intent(in)      :: i_card !! card of the deck
    character(*), intent(in) :: name   !! canonical name
    type(source_place_t)     :: place
    integer :: i

    i = parameter_index(deck%card(i_card), name)
    if (i == 0) then
      place = place_of_keyword(deck, i_card)
      return
    end if
    associate (parameter => deck%card(i_card)%parameter(i), head => deck%card(i_card)%head)
      if (parameter%value_last >= parameter%value_first) then
        place = place_in_line(deck, head, parameter%value_first, parameter%value_last)
      else
        place = place_in_line(deck, head, parameter%name_first, parameter%name_last)
      end if
    end associate
  end function place_of_parameter

  !> The place of a field, of the end of the line if there is no such field.
  pure function place_of_field(deck, i_card, i_line, i_field) result(place)
    type(deck_t), intent(in) :: deck    !! any deck
    integer, intent(in)      :: i_card  !! card of the deck
    integer, intent(in)      :: i_line  !! data line of the card
    integer, intent(in)      :: i_field !! field; 0 = the whole line
    type(source_place_t)     :: place
    type(deck_field_t) :: span
    integer :: n

    associate (line => deck%card(i_card)%data(i_line))
      n = size(line%field)
      if (i_field == 0 .and. n > 0) then
        span = deck_field_t(line%field(1)%first, line%field(n)%last)
        if (line%field(1)%quoted) span%first = span%first - 1
        if (line%field(n)%quoted) span%last = span%last + 1
      else if (i_field > n .and. n > 0) then
        span%first = line%field(n)%last + merge(2, 1, line%field(n)%quoted)
        span%last = span%first
      else if (n > 0) then
        span = line%field(i_field)
        if (span%quoted) span = deck_field_t(span%first - 1, span%last + 1)
      end if
      place = place_in_line(deck, line, span%first, span%last)
    end associate
  end function place_of_field

  !> The place of some columns of a logical line.
  pure function place_in_line(deck, line, first, last) result(place)
    type(deck_t), intent(in)      :: deck        !! names the files
    type(deck_line_t), intent(in) :: line        !! a line of the deck
    integer, intent(in)           :: first, last !! columns in line%text
    type(source_place_t)          :: place
    integer :: before, length

    before = index(line%text(:min(first - 1, len(line%text))), new_line("a"), back=.true.)
    length = index(line%text(before + 1:), new_line("a")) - 1
    if (length < 0) length = len(line%text) - before
    place%rank = line%file
    place%path = deck%file(line%file)%path
    place%line = physical_line(line, first)
    place%text = line%text(before + 1:before + length)
    place%first = first - before
    place%last = min(last - before, length)
  end function place_in_line

  !> Adds a message in its order of file, line and column, unless it is there already.
  pure subroutine add_message(diag, is_error, place, message, hint)
    type(diagnostics_t), intent(inout) :: diag     !! gets one message more
    logical, intent(in)                :: is_error !! .false.: a warning
    type(source_place_t), intent(in)   :: place    !! what to point at
    character(*), intent(in)           :: message  !! what is wrong and what was expected
    character(*), intent(in), optional :: hint     !! text behind the caret
    type(diagnostic_t) :: new
    integer :: i, at

    new%rank = place%rank
    new%line = place%line
    new%column = place%first
    new%is_error = is_error
    new%path = place%path
    new%text = formatted(place, is_error, message, hint)
    if (.not. allocated(diag%message)) allocate (diag%message(max_kept))
    at = diag%n + 1
    do i = diag%n, 1, -1
      if (diag%message(i)%text == new%text) return
      if (comes_before(new, diag%message(i)) .and. at == i + 1) at = i
    end do
    if (is_error) diag%n_errors = diag%n_errors + 1
    if (.not. is_error) diag%n_warnings = diag%n_warnings + 1
    if (diag%n == max_kept) return
    do i = diag%n, at, -1
      diag%message(i + 1) = diag%message(i)
    end do
    diag%message(at) = new
    diag%n = diag%n + 1
  end subroutine add_message

  !> Whether a message stands before another: by file, line and column.
  pure logical function comes_before(a, b)
    type(diagnostic_t), intent(in) :: a, b !! messages

    comes_before = .false.
    if (a%rank /= b%rank) then
      comes_before = a%rank < b%rank
    else if (a%path /= b%path) then
      comes_before = llt(a%path, b%path)
    else if (a%line /= b%line) then
      comes_before = a%line < b%line
    else
      comes_before = a%column < b%column
    end if
  end function comes_before

  !> Complete text of a message: where, what, the line and a caret below the token.
  pure function formatted(place, is_error, message, hint) result(text)
    type(source_place_t), intent(in)   :: place    !! what to point at
    logical, intent(in)                :: is_error !! .false.: a warning
    character(*), intent(in)           :: message  !! what is wrong and what was expected
    character(*), intent(in), optional :: hint     !! text behind the caret
    character(:), allocatable :: text, pointer_line
    character(6) :: number
    integer :: cut, width

    text = place%path//":"
    if (place%line > 0) text = text//integer_text(place%line)//":"//integer_text(screen_column(place))//":"
    text = text//trim(merge(" error:  ", " warning:", is_error))//" "//message
    if (place%line == 0 .or. len_trim(place%text) == 0) then
      return
    end if
    write (number, "(i5,1x)") place%line
    cut = 0
    if (place%last > max_excerpt) cut = max(0, place%first - max_excerpt/2)
    width = min(max(1, place%last - place%first + 1), max_excerpt + cut - place%first + 1)
    pointer_line = blanks_below(place%text(cut + 1:min(len(place%text), place%first - 1)))
    pointer_line = pointer_line//"^"//repeat("~", max(width, 1) - 1)
    if (cut > 0) pointer_line = "   "//pointer_line
    if (present(hint)) pointer_line = trim(pointer_line//" "//hint)
    text = text//new_line("a")//number//"| "//excerpt(place%text, cut) &
           //new_line("a")//"      | "//pointer_line
  end function formatted

  !> Column of the token on the screen: a character of several bytes counts once.
  pure integer function screen_column(place)
    type(source_place_t), intent(in) :: place !! what is pointed at
    integer :: i

    screen_column = place%first
    if (.not. allocated(place%text)) return
    do i = 1, min(place%first - 1, len(place%text))
      if (iand(ichar(place%text(i:i)), 192) == 128) screen_column = screen_column - 1
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
      else if (iand(ichar(text(i:i)), 192) /= 128) then
        blanks = blanks//" "
      end if
    end do
  end function blanks_below

  !> A text with control characters, except tabs, replaced by question marks.
  pure function printable(text) result(clean)
    character(*), intent(in) :: text !! any bytes
    character(len(text))     :: clean
    integer :: i

    clean = text
    do i = 1, len(text)
      if ((ichar(text(i:i)) < 32 .and. text(i:i) /= achar(9)) .or. ichar(text(i:i)) == 127) &
        clean(i:i) = "?"
    end do
  end function printable

  !> A user's text in single quotes, for a message: printable and not longer than 40 characters.
  pure function quoted(text) result(shown)
    character(*), intent(in)  :: text !! any bytes
    character(:), allocatable :: shown

    if (len(text) > 40) then
      shown = "'"//printable(text(:37))//"...'"
    else
      shown = "'"//printable(text)//"'"
    end if
  end function quoted

  !> Turns the messages into an error, if one of them is an error. Warnings are among its text.
  pure subroutine to_error(diag, code, error)
    type(diagnostics_t), intent(in) :: diag              !! messages
    integer, intent(in)             :: code              !! exit code, one of exit_*
    type(error_t), allocatable, intent(out) :: error     !! unallocated without an error
    character(:), allocatable :: text
    integer :: i, n_more

    if (diag%n_errors == 0) return
    text = diag%message(1)%text
    do i = 2, diag%n
      text = text//new_line("a")//diag%message(i)%text
    end do
    n_more = diag%n_errors + diag%n_warnings - diag%n
    if (n_more > 0) text = text//new_line("a")//"... and "//integer_text(n_more)//" more"
    call make_error(error, code, text)
  end subroutine to_error

  !> Text of the warnings, empty if there is none.
  pure function warnings_text(diag) result(text)
    type(diagnostics_t), intent(in) :: diag !! messages
    character(:), allocatable :: text
    integer :: i

    text = ""
    do i = 1, diag%n
      if (diag%message(i)%is_error) cycle
      if (len(text) > 0) text = text//new_line("a")
      text = text//diag%message(i)%text
    end do
  end function warnings_text

end module mpm_diagnostics
