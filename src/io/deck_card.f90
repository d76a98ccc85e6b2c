!> The deck as data: cards, each with its parameters and data lines, and where they stand.
module mpm_deck_card
  use mpm_kinds, only: dp
  use mpm_text, only: normalize_keyword, parse_integer, parse_real, parse_real_list
  implicit none
  private
  public :: deck_t, deck_card_t, deck_file_t, deck_line_t, deck_parameter_t, deck_field_t
  public :: has_parameter, parameter_index, parameter_text, parameter_integer, parameter_real
  public :: parameter_choice, parameter_reals, parameter_path
  public :: field_count, field_text, field_integer, field_real, field_is_integer, physical_line
  public :: folder_of, append_field, append_line, append_card, append_file, append_parameter

  !> A token of a line. Of a quoted string the columns are those between the quotes.
  type :: deck_field_t
    integer :: first = 1       !! first column in the text of the line
    integer :: last = 0        !! last column, first - 1 if empty
    logical :: quoted = .false.
  end type deck_field_t

  !> A logical line: one line of a file, or several that trailing commas join, with line feeds
  !! between.
  type :: deck_line_t
    integer :: file = 0                           !! index in deck%file
    integer :: number = 0                         !! number of the (first) line in its file
    character(:), allocatable :: text             !! as in the file, comments included
    type(deck_field_t), allocatable :: field(:)   !! tokens between commas
  end type deck_line_t

  !> A parameter of a keyword line, NAME=VALUE or a flag. Columns are those of the card's head.
  type :: deck_parameter_t
    character(:), allocatable :: name  !! canonical: upper case, single blanks
    character(:), allocatable :: value !! as written, without quotes; empty for a flag
    logical :: has_value = .false.     !! .false.: a flag
    integer :: name_first = 1          !! columns of the name
    integer :: name_last = 0
    integer :: value_first = 1         !! columns of the value, quotes included
    integer :: value_last = 0
  end type deck_parameter_t

  !> A keyword line with its data lines.
  type :: deck_card_t
    character(:), allocatable :: keyword                  !! canonical, `MATERIAL POINTS`
    type(deck_line_t) :: head                             !! keyword line; field(1) is the keyword
    type(deck_parameter_t), allocatable :: parameter(:)   !! in the order of the deck
    type(deck_line_t), allocatable :: data(:)             !! data lines, blank ones left out
  end type deck_card_t

  !> A file of the deck.
  type :: deck_file_t
    character(:), allocatable :: path !! as opened: that of the deck, or relative to it
  end type deck_file_t

  !> All cards of a deck, includes resolved.
  type :: deck_t
    character(:), allocatable :: name              !! name of the job: without folder and extension
    type(deck_file_t), allocatable :: file(:)      !! the deck first, then its includes
    type(deck_card_t), allocatable :: card(:)      !! in the order of the deck, without *INCLUDE
    character(:), allocatable :: source            !! the whole text, with the text of includes
  end type deck_t

contains

  !> Whether a card has a parameter or a flag.
  pure logical function has_parameter(card, name)
    type(deck_card_t), intent(in) :: card !! any card
    character(*), intent(in)      :: name !! canonical name, `PER ELEMENT`

    has_parameter = parameter_index(card, name) > 0
  end function has_parameter

  !> Position of a parameter on its card, 0 if it is not there.
  pure integer function parameter_index(card, name)
    type(deck_card_t), intent(in) :: card !! any card
    character(*), intent(in)      :: name !! canonical name

    do parameter_index = size(card%parameter), 1, -1
      if (card%parameter(parameter_index)%name == name) return
    end do
  end function parameter_index

  !> Value of a parameter as written.
  pure function parameter_text(card, name, default) result(text)
    type(deck_card_t), intent(in) :: card    !! checked against the schema
    character(*), intent(in)      :: name    !! canonical name
    character(*), intent(in)      :: default !! result if the card does not have it
    character(:), allocatable     :: text
    integer :: i

    text = default
    i = parameter_index(card, name)
    if (i > 0) text = card%parameter(i)%value
  end function parameter_text

  !> Value of a choice in canonical form: upper case, single blanks.
  pure function parameter_choice(card, name, default) result(choice)
    type(deck_card_t), intent(in) :: card    !! checked against the schema
    character(*), intent(in)      :: name    !! canonical name
    character(*), intent(in)      :: default !! result if the card does not have it
    character(:), allocatable     :: choice

    choice = normalize_keyword(parameter_text(card, name, default))
  end function parameter_choice

  !> Value of an integer parameter.
  pure integer function parameter_integer(card, name, default)
    type(deck_card_t), intent(in) :: card    !! checked against the schema
    character(*), intent(in)      :: name    !! canonical name
    integer, intent(in)           :: default !! result if the card does not have it
    logical :: ok
    integer :: i

    parameter_integer = default
    i = parameter_index(card, name)
    if (i > 0) call parse_integer(card%parameter(i)%value, parameter_integer, ok)
  end function parameter_integer

  !> Value of a real parameter.
  pure real(dp) function parameter_real(card, name, default)
    type(deck_card_t), intent(in) :: card    !! checked against the schema
    character(*), intent(in)      :: name    !! canonical name
    real(dp), intent(in)          :: default !! result if the card does not have it
    logical :: ok
    integer :: i

    parameter_real = default
    i = parameter_index(card, name)
    if (i > 0) call parse_real(card%parameter(i)%value, parameter_real, ok)
  end function parameter_real

  !> Values of a parameter that holds several reals, `DIRECTION=0,0,1`.
  pure function parameter_reals(card, name) result(values)
    type(deck_card_t), intent(in) :: card !! checked against the schema
    character(*), intent(in)      :: name !! canonical name
    real(dp), allocatable         :: values(:) !! (n), empty if the card does not have it
    logical :: ok

    call parse_real_list(parameter_text(card, name, ""), values, ok)
  end function parameter_reals

  !> Path of a file that a parameter names: relative to the folder of the file with the card.
  pure function parameter_path(deck, card, name) result(path)
    type(deck_t), intent(in)      :: deck !! the card's deck
    type(deck_card_t), intent(in) :: card !! checked against the schema
    character(*), intent(in)      :: name !! canonical name
    character(:), allocatable     :: path !! empty if the card does not have it

    path = parameter_text(card, name, "")
    if (index(path, "/") /= 1 .and. len(path) > 0) &
      path = folder_of(deck%file(card%head%file)%path)//path
  end function parameter_path

  !> Number of fields of a data line.
  pure integer function field_count(line)
    type(deck_line_t), intent(in) :: line !! a data line

    field_count = size(line%field)
  end function field_count

  !> Text of a field, without quotes and blanks around it.
  pure function field_text(line, i) result(text)
    type(deck_line_t), intent(in) :: line !! a data line
    integer, intent(in)           :: i    !! field, 1..field_count
    character(:), allocatable     :: text

    text = line%text(line%field(i)%first:line%field(i)%last)
  end function field_text

  !> Whether a field is an integer (a node number, say, and not the name of a set).
  pure logical function field_is_integer(line, i)
    type(deck_line_t), intent(in) :: line !! a data line
    integer, intent(in)           :: i    !! field, 1..field_count
    integer :: value

    call parse_integer(line%text(line%field(i)%first:line%field(i)%last), value, field_is_integer)
    field_is_integer = field_is_integer .and. .not. line%field(i)%quoted
  end function field_is_integer

  !> Integer in a field, 0 if it is none.
  pure integer function field_integer(line, i)
    type(deck_line_t), intent(in) :: line !! a data line, checked against the schema
    integer, intent(in)           :: i    !! field, 1..field_count
    logical :: ok

    call parse_integer(line%text(line%field(i)%first:line%field(i)%last), field_integer, ok)
  end function field_integer

  !> Real in a field, 0 if it is none.
  pure real(dp) function field_real(line, i)
    type(deck_line_t), intent(in) :: line !! a data line, checked against the schema
    integer, intent(in)           :: i    !! field, 1..field_count
    logical :: ok

    call parse_real(line%text(line%field(i)%first:line%field(i)%last), field_real, ok)
  end function field_real

  !> Number in its file of the line that a column of a logical line stands in.
  pure integer function physical_line(line, column)
    type(deck_line_t), intent(in) :: line   !! any line
    integer, intent(in)           :: column !! column in line%text
    integer :: i

    physical_line = line%number
    do i = 1, min(column, len(line%text) + 1) - 1
      if (line%text(i:i) == new_line("a")) physical_line = physical_line + 1
    end do
  end function physical_line

  !> Folder of a path with its slash, empty for the current one.
  pure function folder_of(path) result(folder)
    character(*), intent(in)  :: path !! path of a file
    character(:), allocatable :: folder

    folder = path(:index(path, "/", back=.true.))
  end function folder_of

  !> Appends to a list of fields that grows geometrically.
  pure subroutine append_field(list, n, item)
    type(deck_field_t), allocatable, intent(inout) :: list(:) !! (>= n) on return
    integer, intent(inout) :: n                               !! entries in use
    type(deck_field_t), intent(in) :: item                    !! new entry
    type(deck_field_t), allocatable :: longer(:)

    if (n == size(list)) then
      allocate (longer(2*n + 4))
      longer(:n) = list(:n)
      call move_alloc(longer, list)
    end if
    n = n + 1
    list(n) = item
  end subroutine append_field

  !> Appends to the list of files.
  pure subroutine append_file(list, path)
    type(deck_file_t), allocatable, intent(inout) :: list(:) !! one longer on return
    character(*), intent(in) :: path                         !! file
    type(deck_file_t), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(list) + 1))
    do i = 1, size(list)
      call move_alloc(list(i)%path, longer(i)%path)
    end do
    longer(size(longer))%path = path
    call move_alloc(longer, list)
  end subroutine append_file

  !> Appends to a list of parameters.
  pure subroutine append_parameter(list, item)
    type(deck_parameter_t), allocatable, intent(inout) :: list(:) !! one longer on return
    type(deck_parameter_t), intent(in) :: item                    !! new entry
    type(deck_parameter_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = item
    call move_alloc(longer, list)
  end subroutine append_parameter

  !> Moves a line to the end of a list that grows geometrically; the text is not copied.
  pure subroutine append_line(list, n, item)
    type(deck_line_t), allocatable, intent(inout) :: list(:) !! (>= n) on return
    integer, intent(inout) :: n                              !! entries in use
    type(deck_line_t), intent(inout) :: item                 !! new entry, empty on return
    type(deck_line_t), allocatable :: longer(:)
    integer :: i

    if (n == size(list)) then
      allocate (longer(2*n + 4))
      do i = 1, n
        call move_line(list(i), longer(i))
      end do
      call move_alloc(longer, list)
    end if
    n = n + 1
    call move_line(item, list(n))
  end subroutine append_line

  !> Moves a line without a copy of its text.
  pure subroutine move_line(from, to)
    type(deck_line_t), intent(inout) :: from !! empty on return
    type(deck_line_t), intent(inout) :: to   !! overwritten

    to%file = from%file
    to%number = from%number
    call move_alloc(from%text, to%text)
    call move_alloc(from%field, to%field)
  end subroutine move_line

  !> Moves a card to the end of a list that grows geometrically; data lines are not copied.
  pure subroutine append_card(list, n, item)
    type(deck_card_t), allocatable, intent(inout) :: list(:) !! (>= n) on return
    integer, intent(inout) :: n                              !! entries in use
    type(deck_card_t), intent(inout) :: item                 !! new entry, empty on return
    type(deck_card_t), allocatable :: longer(:)
    integer :: i

    if (n == size(list)) then
      allocate (longer(2*n + 4))
      do i = 1, n
        call move_card(list(i), longer(i))
      end do
      call move_alloc(longer, list)
    end if
    n = n + 1
    call move_card(item, list(n))
  end subroutine append_card

  !> Moves a card without a copy of its lines.
  pure subroutine move_card(from, to)
    type(deck_card_t), intent(inout) :: from !! empty on return
    type(deck_card_t), intent(inout) :: to   !! overwritten

    call move_alloc(from%keyword, to%keyword)
    call move_line(from%head, to%head)
    call move_alloc(from%parameter, to%parameter)
    call move_alloc(from%data, to%data)
  end subroutine move_card

end module mpm_deck_card
