!> Decks as texts, for tests: a backslash stands for a line feed.
module deck_samples
  use mpm_deck_card, only: deck_t
  use mpm_diagnostics, only: diagnostics_t, to_error
  use mpm_error, only: error_t, exit_deck
  use mpm_input_deck, only: read_deck
  implicit none
  private
  public :: write_bytes, as_lines, read_text, messages_of, headlines_of, headlines_in_step
  public :: headlines

contains

  !> Writes a file with exactly these bytes.
  subroutine write_bytes(path, bytes)
    character(*), intent(in) :: path  !! file to write
    character(*), intent(in) :: bytes !! its content
    integer :: unit

    open (newunit=unit, file=path, access="stream", form="unformatted", status="replace", &
          action="write")
    if (len(bytes) > 0) write (unit) bytes
    close (unit)
  end subroutine write_bytes

  !> A text with line feeds in place of backslashes.
  pure function as_lines(text) result(lines)
    character(*), intent(in) :: text !! lines between backslashes
    character(len(text)) :: lines
    integer :: i

    lines = text
    do i = 1, len(text)
      if (text(i:i) == "\") lines(i:i) = new_line("a")
    end do
  end function as_lines

  !> Reads a deck from a text.
  subroutine read_text(deck, diag, text)
    type(deck_t), intent(out) :: deck         !! the deck
    type(diagnostics_t), intent(out) :: diag  !! its errors
    character(*), intent(in) :: text          !! lines between backslashes

    call write_bytes("t.inp", as_lines(text))
    call read_deck(deck, "t.inp", diag)
  end subroutine read_text

  !> All messages about a deck, empty if there is none.
  function messages_of(text) result(messages)
    character(*), intent(in)  :: text     !! lines between backslashes
    character(:), allocatable :: messages
    type(deck_t) :: deck
    type(diagnostics_t) :: diag
    type(error_t), allocatable :: error

    call read_text(deck, diag, text)
    call to_error(diag, exit_deck, error)
    messages = ""
    if (allocated(error)) messages = error%message
  end function messages_of

  !> The lines of messages that say where and what, with backslashes between, without the name of
  !! the file and the word error.
  pure function headlines(messages) result(lines)
    character(*), intent(in)  :: messages !! text for the user
    character(:), allocatable :: lines
    character(:), allocatable :: line
    integer :: first, last, mark

    lines = ""
    first = 1
    do while (first <= len(messages))
      last = first + index(messages(first:)//new_line("a"), new_line("a")) - 2
      line = messages(first:last)
      mark = index(line, " error: ")
      if (index(line, "t.inp:") == 1 .and. mark > 0) then
        if (len(lines) > 0) lines = lines//"\"
        lines = lines//line(7:mark - 1)//line(mark + 7:)
      end if
      first = last + 2
    end do
  end function headlines

  !> Where and what, of all messages about a deck.
  function headlines_of(text) result(lines)
    character(*), intent(in)  :: text !! lines between backslashes
    character(:), allocatable :: lines

    lines = headlines(messages_of(text))
  end function headlines_of

  !> Where and what, of all messages about cards that stand from line 4 on in a complete step.
  function headlines_in_step(text) result(lines)
    character(*), intent(in)  :: text !! lines between backslashes
    character(:), allocatable :: lines

    lines = headlines_of("*STEP\*STATIC\0.1, 1\"//text//"\*END STEP\")
  end function headlines_in_step

end module deck_samples
