!> Reads a deck: files to lines, lines to cards, cards checked against the schema.
module mpm_input_deck
  use mpm_deck_card, only: append_card, append_file, append_line, append_parameter, deck_card_t, &
    deck_field_t, deck_line_t, deck_parameter_t, deck_t, folder_of
  use mpm_deck_lexer, only: line_data, line_end, line_keyword, load_file, next_line, source_file_t
  use mpm_deck_schema, only: build_schema, find_keyword
  use mpm_deck_schema_check, only: check_deck, check_parameters
  use mpm_deck_schema_rule, only: schema_t
  use mpm_diagnostics, only: diagnostics_t, error_at_keyword, error_at_parameter, error_at_place, &
    error_in_file, place_in_line, quoted
  use mpm_text, only: integer_text, normalize_keyword
  implicit none
  private
  public :: read_deck

  integer, parameter :: max_depth = 10 !! files that include each other
  integer, parameter :: max_files = 1000 !! files of a deck
  integer, parameter :: max_cards = 5000 !! keywords of a deck
  integer, parameter :: max_fields = 1000 !! parameters of a keyword line, and their values

  !> Where the reading stands.
  type :: reader_t
    type(schema_t)    :: schema
    type(deck_card_t) :: card              !! card that still gets data lines
    logical :: has_card = .false.          !! .false. before the first keyword
    logical :: is_text = .false.           !! data lines of the card are text
    integer :: n_data = 0                  !! data lines of the card
    integer :: n_cards = 0                 !! finished cards
    integer :: n_stray = 0                 !! data lines before the first keyword
    integer :: depth = 0                   !! open files
    integer :: open_file(max_depth) = 0    !! their indices in deck%file
    integer :: n_source = 0                !! characters of the echo
  end type reader_t

contains

  !> Reads and checks a deck with its includes. All errors of the pass are collected; without one,
  !! every value can be taken from its card without a further check.
  subroutine read_deck(deck, path, diag)
    type(deck_t), intent(out)          :: deck !! the deck, complete as far as it could be read
    character(*), intent(in)           :: path !! file to read
    type(diagnostics_t), intent(inout) :: diag !! gets the errors
    type(reader_t) :: reader
    type(source_file_t) :: source
    character(:), allocatable :: reason
    integer :: n_errors_before

    deck%name = name_of_job(path)
    allocate (deck%file(0), deck%card(0))
    deck%source = ""
    n_errors_before = diag%n_errors
    call build_schema(reader%schema)
    call load_file(source, path, reason)
    if (len(reason) > 0) then
      call error_in_file(diag, path, 0, 1, "", "cannot read the deck: "//reason)
      return
    end if
    call read_file(reader, deck, source, diag)
    call finish_card(reader, deck)
    call trim_deck(reader, deck)
    if (size(deck%card) == 0 .and. diag%n_errors == n_errors_before) then
      call error_in_file(diag, path, 1, 1, "", "the deck is empty: expected keywords such as *STEP")
    else
      call check_deck(reader%schema, deck, diag)
    end if
    if (diag%n_errors == n_errors_before .and. .not. has_step(deck)) &
      call error_in_file(diag, path, source%number, 1, "", "nothing to solve: expected *STEP")
  end subroutine read_deck

  !> Name of a job: that of the deck without folder and extension.
  pure function name_of_job(path) result(name)
    character(*), intent(in)  :: path !! file of the deck
    character(:), allocatable :: name
    integer :: point

    name = path(len(folder_of(path)) + 1:)
    point = index(name, ".", back=.true.)
    if (point > 1) name = name(:point - 1)
  end function name_of_job

  !> Whether a deck has a step.
  pure logical function has_step(deck)
    type(deck_t), intent(in) :: deck !! complete deck
    integer :: i

    has_step = .false.
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "STEP") has_step = .true.
    end do
  end function has_step

  !> Reads the lines of a file, and of those that it includes.
  recursive subroutine read_file(reader, deck, source, diag)
    type(reader_t), intent(inout)      :: reader !! moves on
    type(deck_t), intent(inout)        :: deck   !! gets file, cards and echo
    type(source_file_t), intent(inout) :: source !! file, at its start
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    type(deck_line_t) :: line
    integer :: kind

    call append_file(deck%file, source%path)
    source%file = size(deck%file)
    reader%depth = reader%depth + 1
    reader%open_file(reader%depth) = source%file
    do
      call next_line(source, line, kind, reader%is_text, diag)
      select case (kind)
      case (line_end)
        exit
      case (line_keyword)
        call read_keyword(reader, deck, source, line, diag)
      case (line_data)
        call read_data(reader, deck, line, diag)
      end select
    end do
    call echo(reader, deck, source%text(source%n_echoed + 1:))
    if (reader%depth > 1 .and. index(source%text, new_line("a"), back=.true.) < len(source%text)) &
      call echo(reader, deck, new_line("a"))
    reader%depth = reader%depth - 1
  end subroutine read_file

  !> Takes a data line into the current card.
  subroutine read_data(reader, deck, line, diag)
    type(reader_t), intent(inout)      :: reader !! its card gets the line
    type(deck_t), intent(in)           :: deck   !! names the files
    type(deck_line_t), intent(inout)   :: line   !! the line, empty on return
    type(diagnostics_t), intent(inout) :: diag   !! gets an error before the first keyword
    integer :: last

    if (reader%has_card) then
      call append_line(reader%card%data, reader%n_data, line)
      return
    end if
    last = line%field(size(line%field))%last
    if (reader%n_stray == 0) &
      call error_at_place(diag, place_in_line(deck, line, line%field(1)%first, last), &
                          "data before the first keyword: expected a line such as *HEADING")
    reader%n_stray = reader%n_stray + 1
  end subroutine read_data

  !> Begins a card, or includes a file.
  recursive subroutine read_keyword(reader, deck, source, line, diag)
    type(reader_t), intent(inout)      :: reader !! gets the card
    type(deck_t), intent(inout)        :: deck   !! gets the card before
    type(source_file_t), intent(inout) :: source !! the file of the line
    type(deck_line_t), intent(inout)   :: line   !! keyword line, empty on return
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    type(deck_card_t) :: card
    integer :: i_rule

    call cut_keyword_line(line, deck, diag)
    call make_card(card, line)
    if (card%keyword == "INCLUDE") then
      call include_file(reader, deck, source, card, diag)
      return
    end if
    call finish_card(reader, deck)
    if (reader%n_cards == max_cards) then
      call refuse_more_cards(reader, deck, source, card, diag)
      return
    end if
    i_rule = find_keyword(reader%schema, card%keyword)
    reader%is_text = .false.
    if (i_rule > 0) reader%is_text = reader%schema%keyword(i_rule)%is_text
    reader%card = card
    reader%has_card = .true.
    reader%n_data = 0
  end subroutine read_keyword

  !> Leaves only the keyword of a line that goes on and on.
  pure subroutine cut_keyword_line(line, deck, diag)
    type(deck_line_t), intent(inout)   :: line !! keyword line
    type(deck_t), intent(in)           :: deck !! names the files
    type(diagnostics_t), intent(inout) :: diag !! gets the error

    if (size(line%field) <= max_fields) return
    associate (field => line%field(max_fields + 1))
      call error_at_place(diag, place_in_line(deck, line, field%first, field%last), &
                          "more than "//integer_text(max_fields)// &
                          " fields in a keyword line: expected fewer")
    end associate
    line%field = line%field(:1)
  end subroutine cut_keyword_line

  !> Stops the reading of a file at a keyword that is one too many.
  subroutine refuse_more_cards(reader, deck, source, card, diag)
    type(reader_t), intent(inout)      :: reader !! without a card
    type(deck_t), intent(in)           :: deck   !! names the files
    type(source_file_t), intent(inout) :: source !! the file of the keyword, at its end on return
    type(deck_card_t), intent(in)      :: card   !! of the keyword
    type(diagnostics_t), intent(inout) :: diag   !! gets the error

    associate (field => card%head%field(1))
      call error_at_place(diag, place_in_line(deck, card%head, field%first, field%last), &
                          "more than "//integer_text(max_cards)//" keywords: expected fewer")
    end associate
    reader%is_text = .false.
    source%next = len(source%text) + 1
  end subroutine refuse_more_cards

  !> Makes a card of a keyword line.
  pure subroutine make_card(card, line)
    type(deck_card_t), intent(out)   :: card !! card without data lines
    type(deck_line_t), intent(inout) :: line !! keyword line
    type(deck_parameter_t) :: parameter
    integer :: i

    associate (head => line%text(line%field(1)%first:line%field(1)%last))
      card%keyword = normalize_keyword(head(2:))
    end associate
    allocate (card%parameter(0), card%data(0))
    do i = 2, size(line%field)
      associate (token => line%text(line%field(i)%first:line%field(i)%last), &
                 n => size(card%parameter))
        if (n > 0 .and. scan(token, "+-.0123456789") == 1) then
          if (card%parameter(n)%has_value) then
            call extend_value(card%parameter(n), token, line%field(i)%last)
            cycle
          end if
        end if
      end associate
      call make_parameter(parameter, line%text, line%field(i))
      call append_parameter(card%parameter, parameter)
    end do
    card%head = line
  end subroutine make_card

  !> Adds a number to the value of a parameter: `DIRECTION=0` and `1`.
  pure subroutine extend_value(parameter, token, last)
    type(deck_parameter_t), intent(inout) :: parameter !! gets the number
    character(*), intent(in) :: token                  !! number behind a comma
    integer, intent(in)      :: last                   !! its last column

    parameter%value = parameter%value//","//token
    parameter%value_last = last
  end subroutine extend_value

  !> Makes a parameter of a token: NAME=VALUE, NAME="VALUE" or a flag.
  pure subroutine make_parameter(parameter, text, token)
    type(deck_parameter_t), intent(out) :: parameter !! the parameter
    character(*), intent(in)            :: text      !! keyword line
    type(deck_field_t), intent(in)      :: token     !! columns of the token
    character(*), parameter :: blanks = " "//achar(9)
    integer :: equals, first, last

    equals = index(text(token%first:token%last), "=")
    parameter%has_value = equals > 0 .and. .not. token%quoted
    parameter%name_first = token%first
    parameter%name_last = token%last
    parameter%value = ""
    if (parameter%has_value) then
      last = token%first + equals - 2
      parameter%name_last = token%first - 1 + verify(text(token%first:last), blanks, back=.true.)
      first = token%first + equals
      first = first + max(verify(text(first:token%last), blanks), 1) - 1
      parameter%value_first = first
      parameter%value_last = token%last
      last = token%last
      if (last > first .and. index(text(first:last), """") == 1 .and. text(last:last) == """") then
        first = first + 1
        last = last - 1
      end if
      parameter%value = text(first:last)
    end if
    parameter%name = normalize_keyword(text(parameter%name_first:parameter%name_last))
  end subroutine make_parameter

  !> Reads the file of an *INCLUDE in place of its line.
  recursive subroutine include_file(reader, deck, source, card, diag)
    type(reader_t), intent(inout)      :: reader !! moves on
    type(deck_t), intent(inout)        :: deck   !! gets the cards of the file
    type(source_file_t), intent(inout) :: source !! the including file
    type(deck_card_t), intent(inout)   :: card   !! the *INCLUDE
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    type(source_file_t) :: included
    character(:), allocatable :: path, reason
    integer :: i, i_card, n_errors_before

    n_errors_before = diag%n_errors
    i_card = reader%n_cards + 1
    call append_card(deck%card, reader%n_cards, card)
    call check_parameters(reader%schema, deck, i_card, diag)
    reader%n_cards = i_card - 1
    if (diag%n_errors > n_errors_before) return
    path = deck%card(i_card)%parameter(1)%value
    if (index(path, "/") /= 1) path = folder_of(source%path)//path
    if (reader%depth == max_depth) then
      call error_at_keyword(diag, deck, i_card, "more than "//integer_text(max_depth)// &
                            " files include each other: expected fewer")
      return
    end if
    if (size(deck%file) == max_files) then
      call error_at_keyword(diag, deck, i_card, "more than "//integer_text(max_files)// &
                            " files in a deck: expected fewer")
      return
    end if
    do i = 1, reader%depth
      if (deck%file(reader%open_file(i))%path /= path) cycle
      call error_at_parameter(diag, deck, i_card, "INPUT", &
                              quoted(path)//" includes itself: expected another file")
      return
    end do
    call load_file(included, path, reason)
    if (len(reason) > 0) then
      call error_at_parameter(diag, deck, i_card, "INPUT", &
                              "cannot read "//quoted(path)//": "//reason)
      return
    end if
    call echo_include(reader, deck, source)
    call read_file(reader, deck, included, diag)
  end subroutine include_file

  !> Echoes the text up to an *INCLUDE, and its line as a comment.
  subroutine echo_include(reader, deck, source)
    type(reader_t), intent(inout)      :: reader !! moves on
    type(deck_t), intent(inout)        :: deck   !! gets the text
    type(source_file_t), intent(inout) :: source !! the including file, behind the line
    integer :: i

    call echo(reader, deck, source%text(source%n_echoed + 1:source%begin - 1)//"** ")
    do i = source%begin, source%last
      call echo(reader, deck, source%text(i:i))
      if (source%text(i:i) == new_line("a")) call echo(reader, deck, "** ")
    end do
    call echo(reader, deck, new_line("a"))
    source%n_echoed = min(source%last + 1, len(source%text))
  end subroutine echo_include

  !> Appends to the echo of the deck, which grows geometrically.
  subroutine echo(reader, deck, text)
    type(reader_t), intent(inout) :: reader !! counts the characters
    type(deck_t), intent(inout)   :: deck   !! gets the text
    character(*), intent(in)      :: text   !! next part
    character(:), allocatable :: longer

    if (reader%n_source + len(text) > len(deck%source)) then
      allocate (character(2*(reader%n_source + len(text))) :: longer)
      longer(:reader%n_source) = deck%source(:reader%n_source)
      call move_alloc(longer, deck%source)
    end if
    deck%source(reader%n_source + 1:reader%n_source + len(text)) = text
    reader%n_source = reader%n_source + len(text)
  end subroutine echo

  !> Moves the current card into the deck.
  subroutine finish_card(reader, deck)
    type(reader_t), intent(inout) :: reader !! without a card on return
    type(deck_t), intent(inout)   :: deck   !! gets the card
    type(deck_line_t), allocatable :: data(:)
    integer :: i, n

    if (.not. reader%has_card) return
    allocate (data(0))
    n = 0
    if (reader%n_data > 0) then
      deallocate (data)
      allocate (data(reader%n_data))
      do i = 1, reader%n_data
        call append_line(data, n, reader%card%data(i))
      end do
    end if
    call move_alloc(data, reader%card%data)
    call append_card(deck%card, reader%n_cards, reader%card)
    reader%has_card = .false.
  end subroutine finish_card

  !> Gives up the spare places of the lists.
  subroutine trim_deck(reader, deck)
    type(reader_t), intent(in)  :: reader !! counts
    type(deck_t), intent(inout) :: deck   !! lists of the right length
    type(deck_card_t), allocatable :: card(:)
    integer :: i, n

    allocate (card(reader%n_cards))
    n = 0
    do i = 1, reader%n_cards
      call append_card(card, n, deck%card(i))
    end do
    call move_alloc(card, deck%card)
    deck%source = deck%source(:reader%n_source)
  end subroutine trim_deck

end module mpm_input_deck
