!> Messages about the input with file, line and column, collected until a pass is over.
module mpm_diagnostics
  use mpm_deck_card, only: deck_card_t, deck_field_t, deck_line_t, deck_t, parameter_index, &
                           physical_line
  use mpm_error, only: error_t, make_error
  use mpm_source_excerpt, only: message_text, printable, source_place_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: diagnostics_t, quoted
  public :: error_at_keyword, error_at_parameter, error_at_field, error_at_place, error_in_file
  public :: warning_at_keyword, warning_at_parameter, warning_at_field
  public :: place_in_line, to_error, too_many_errors, warnings_text

  integer, parameter :: max_kept = 200     !! messages kept; further ones are only counted
  integer, parameter :: max_errors = 1000  !! errors after which the reading of a deck stops

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

    if (diag%n == max_kept) then
      call count_message(diag, is_error)
      return
    end if
    new%rank = place%rank
    new%line = place%line
    new%column = place%first
    new%is_error = is_error
    new%path = place%path
    new%text = message_text(place, is_error, message, hint)
    if (.not. allocated(diag%message)) allocate (diag%message(max_kept))
    at = diag%n + 1
    do i = diag%n, 1, -1
      if (diag%message(i)%text == new%text) return
      if (comes_before(new, diag%message(i)) .and. at == i + 1) at = i
    end do
    call count_message(diag, is_error)
    do i = diag%n, at, -1
      diag%message(i + 1) = diag%message(i)
    end do
    diag%message(at) = new
    diag%n = diag%n + 1
  end subroutine add_message

  !> Counts a message.
  pure subroutine count_message(diag, is_error)
    type(diagnostics_t), intent(inout) :: diag !! one message more
    logical, intent(in) :: is_error            !! .false.: a warning

    if (is_error) diag%n_errors = diag%n_errors + 1
    if (.not. is_error) diag%n_warnings = diag%n_warnings + 1
  end subroutine count_message

  !> Whether there are so many errors that reading on helps nobody.
  pure logical function too_many_errors(diag)
    type(diagnostics_t), intent(in) :: diag !! messages so far

    too_many_errors = diag%n_errors > max_errors
  end function too_many_errors

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
