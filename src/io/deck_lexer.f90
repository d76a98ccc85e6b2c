!> From the bytes of a file to logical lines with tokens: comments, quotes, continuation.
module mpm_deck_lexer
  use mpm_deck_card, only: append_field, deck_field_t, deck_line_t
  use mpm_diagnostics, only: diagnostics_t, error_at_place, too_many_errors
  use mpm_input_file, only: load_input
  use mpm_kinds, only: ip
  use mpm_source_excerpt, only: source_place_t
  use mpm_text, only: bytes_of_character, integer_text
  implicit none
  private
  public :: source_file_t, load_file, next_line, line_end, line_keyword, line_data

  integer, parameter :: line_end = 0     !! no further line
  integer, parameter :: line_keyword = 1
  integer, parameter :: line_data = 2
  integer, parameter :: max_length = 2048 !! characters of a line

  !> A file on its way through the lexer.
  type :: source_file_t
    integer :: file = 0                !! index in deck%file
    character(:), allocatable :: path
    character(:), allocatable :: text  !! the whole file with line feeds only
    integer :: next = 1                !! where the next line begins
    integer :: number = 0              !! number of the current line
    integer :: first = 1               !! where the current line begins
    integer :: last = 0                !! where it ends, without line feed
    integer :: begin = 0               !! where the logical line begins
    integer :: n_echoed = 0            !! characters that the echo of the deck has already
    type(deck_field_t), allocatable :: field(:) !! (>= n_fields) of the logical line
    integer :: n_fields = 0
  end type source_file_t

contains

  !> Reads a whole file; byte-order mark and carriage returns at line ends are taken out.
  subroutine load_file(source, path, reason)
    type(source_file_t), intent(out) :: source       !! ready for next_line
    character(*), intent(in) :: path                 !! file to read
    character(:), allocatable, intent(out) :: reason !! why it could not be read, empty if it was
    integer :: n_bytes

    source%path = path
    allocate (source%field(16))
    call load_input(source%text, path, reason)
    if (len(reason) == 0 .and. len(source%text, ip) >= huge(n_bytes)) &
      reason = "more than "//integer_text(huge(n_bytes))//" bytes"
    if (len(reason) > 0) then
      reason = trim(adjustl(reason(index(reason, ": ", back=.true.) + 1:)))
      return
    end if
    call make_unix_lines(source%text, n_bytes)
    source%text = source%text(:n_bytes)
  end subroutine load_file

  !> Takes the byte-order mark and carriage returns before line feeds out of a text.
  pure subroutine make_unix_lines(text, n)
    character(*), intent(inout) :: text !! bytes of a file
    integer, intent(out)        :: n    !! characters that are left
    character(3), parameter :: mark = char(239)//char(187)//char(191)
    integer :: first, i

    n = 0
    first = 1
    if (text(:min(3, len(text))) == mark) first = 4
    do i = first, len(text)
      if (text(i:i) == achar(13)) then
        if (i == len(text)) cycle
        if (text(i + 1:i + 1) == achar(10)) cycle
      end if
      n = n + 1
      text(n:n) = text(i:i)
    end do
  end subroutine make_unix_lines

  !> The next logical line: blank lines and comments left out, continued lines joined. A comma
  !! behind which nothing follows leaves an empty field at the end.
  pure subroutine next_line(source, line, kind, as_text, diag)
    type(source_file_t), intent(inout) :: source !! moves on
    type(deck_line_t), intent(out)     :: line   !! the line
    integer, intent(out)               :: kind   !! line_*
    logical, intent(in)                :: as_text !! .true.: data lines are text, one field
    type(diagnostics_t), intent(inout) :: diag   !! gets errors of unreadable lines
    integer :: begin, content, ending, last
    logical :: continued, is_text, usable

    kind = line_end
    continued = .false.
    source%n_fields = 0
    begin = 0
    content = 0
    last = 0
    if (too_many_errors(diag)) source%next = len(source%text) + 1
    do while (source%next <= len(source%text))
      if (source%text(source%next:source%next) == new_line("a")) then
        source%next = source%next + 1
        source%number = source%number + 1
        cycle
      end if
      if (continued .and. begins_with_star(source%text(source%next:))) exit
      call advance(source)
      call check_characters(source, usable, diag)
      if (too_many_errors(diag)) source%next = len(source%text) + 1
      if (.not. usable) cycle
      is_text = as_text .and. .not. continued &
                .and. .not. begins_with_star(source%text(source%first:source%last))
      ending = content_end(source, is_text)
      if (ending < source%first) cycle
      content = ending
      if (.not. continued) then
        begin = source%first
        line%number = source%number
        kind = merge(line_keyword, line_data, begins_with_star(source%text(begin:source%last)))
      end if
      last = source%last
      if (is_text) then
        call add_text_field(source, begin, content)
        exit
      end if
      call add_fields(source, begin, content, continued, diag)
      if (.not. continued) exit
    end do
    if (kind == line_end) return
    if (continued) call append_field(source%field, source%n_fields, &
                                     deck_field_t(content - begin + 2, content - begin + 1))
    source%begin = begin
    line%file = source%file
    line%text = source%text(begin:last)
    line%field = source%field(:source%n_fields)
  end subroutine next_line

  !> Whether a text begins with a star that is not a comment.
  pure logical function begins_with_star(text)
    character(*), intent(in) :: text !! rest of a file, from the start of a line
    integer :: first

    first = verify(text, " "//achar(9))
    begins_with_star = .false.
    if (first == 0) return
    begins_with_star = text(first:first) == "*" .and. &
                       text(first:min(first + 1, len(text))) /= "**"
  end function begins_with_star

  !> Goes on to the next line of the file.
  pure subroutine advance(source)
    type(source_file_t), intent(inout) :: source !! moves on
    integer :: length

    length = index(source%text(source%next:), new_line("a")) - 1
    if (length < 0) length = len(source%text) - source%next + 1
    source%first = source%next
    source%last = source%first + length - 1
    source%next = source%last + 2
    source%number = source%number + 1
  end subroutine advance

  !> Refuses lines that are too long, and bytes that are no text.
  pure subroutine check_characters(source, usable, diag)
    type(source_file_t), intent(inout) :: source !! after a NUL byte nothing more is read
    logical, intent(out)               :: usable !! .false.: leave the line out
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    integer :: at, length

    length = source%last - source%first + 1
    usable = .false.
    if (length > max_length) then
      call error_at_place(diag, place_of(source, 1, 1), "line of "//integer_text(length)// &
                          " characters: expected at most "//integer_text(max_length))
      return
    end if
    at = first_bad_byte(source%text(source%first:source%last))
    usable = at == 0
    if (usable) return
    select case (ichar(source%text(source%first + at - 1:source%first + at - 1)))
    case (0)
      call error_at_place(diag, place_of(source, at, at), "NUL byte: expected a text file")
      source%next = len(source%text) + 1
    case (1:127)
      call error_at_place(diag, place_of(source, at, at), "control character: expected text")
    case default
      call error_at_place(diag, place_of(source, at, at), &
                          "byte that is not UTF-8: expected text in UTF-8")
    end select
  end subroutine check_characters

  !> Position of the first control character or byte that is not UTF-8, 0 if there is none.
  pure integer function first_bad_byte(text) result(at)
    character(*), intent(in) :: text !! a line
    integer :: byte, n

    at = 1
    do while (at <= len(text))
      byte = ichar(text(at:at))
      if ((byte < 32 .and. byte /= 9) .or. byte == 127) return
      n = bytes_of_character(text, at)
      if (n == 0) return
      at = at + n
    end do
    at = 0
  end function first_bad_byte

  !> Where the content of the current line ends: before a comment, without trailing blanks.
  pure integer function content_end(source, as_text)
    type(source_file_t), intent(in) :: source !! the line
    logical, intent(in)             :: as_text !! .true.: quotes have no meaning
    logical :: inside
    integer :: i

    content_end = source%first - 1
    inside = .false.
    associate (text => source%text)
      do i = source%first, source%last
        if (text(i:i) == " " .or. text(i:i) == achar(9)) cycle
        if (text(i:i) == """" .and. .not. as_text) inside = .not. inside
        if (.not. inside .and. text(i:min(i + 1, source%last)) == "**") then
          if (content_end < i - 1 .or. i == source%first) return
        end if
        content_end = i
      end do
    end associate
  end function content_end

  !> Takes a line of text as one field.
  pure subroutine add_text_field(source, begin, end_of_content)
    type(source_file_t), intent(inout) :: source !! gets the field
    integer, intent(in) :: begin                 !! where the line begins in the file
    integer, intent(in) :: end_of_content        !! where its content ends
    integer :: first

    first = verify(source%text(begin:end_of_content), " "//achar(9))
    call append_field(source%field, source%n_fields, &
                      deck_field_t(first, end_of_content - begin + 1))
  end subroutine add_text_field

  !> Adds the tokens of the current line to those of the logical line.
  pure subroutine add_fields(source, begin, end_of_content, continued, diag)
    type(source_file_t), intent(inout) :: source !! gets the fields
    integer, intent(in)  :: begin                !! where the logical line begins in the file
    integer, intent(in)  :: end_of_content       !! where the content of the current line ends
    logical, intent(out) :: continued            !! .true.: the content ends with a comma
    type(diagnostics_t), intent(inout) :: diag   !! gets an error for a missing quote
    integer :: first, i, opening
    logical :: inside

    inside = .false.
    opening = 0
    first = source%first
    do i = source%first, end_of_content
      if (source%text(i:i) == """") then
        inside = .not. inside
        opening = i - source%first + 1
      else if (source%text(i:i) == "," .and. .not. inside) then
        call add_token(source, begin, first, i - 1)
        first = i + 1
      end if
    end do
    continued = first > end_of_content
    if (.not. continued) call add_token(source, begin, first, end_of_content)
    if (inside) call error_at_place(diag, place_of(source, opening, opening), &
                                    "missing closing quote: expected '""'")
  end subroutine add_fields

  !> Adds one token without blanks and quotes around it.
  pure subroutine add_token(source, begin, first, last)
    type(source_file_t), intent(inout) :: source !! gets the field
    integer, intent(in) :: begin                 !! where the logical line begins in the file
    integer, intent(in) :: first, last           !! the token in the file, blanks included
    type(deck_field_t) :: token
    integer :: a, b

    a = verify(source%text(first:last), " "//achar(9))
    b = verify(source%text(first:last), " "//achar(9), back=.true.)
    if (a == 0) then
      token%first = first - begin + 1
      token%last = token%first - 1
    else
      a = first + a - 1
      b = first + b - 1
      token%quoted = b > a .and. source%text(a:a) == """" .and. source%text(b:b) == """"
      if (token%quoted) then
        a = a + 1
        b = b - 1
      end if
      token%first = a - begin + 1
      token%last = b - begin + 1
    end if
    call append_field(source%field, source%n_fields, token)
  end subroutine add_token

  !> A place in the current line.
  pure function place_of(source, first, last) result(place)
    type(source_file_t), intent(in) :: source      !! the line
    integer, intent(in)             :: first, last !! columns
    type(source_place_t)            :: place

    place%rank = source%file
    place%path = source%path
    place%line = source%number
    place%first = first
    place%last = last
    place%text = source%text(source%first:source%last)
  end function place_of

end module mpm_deck_lexer
