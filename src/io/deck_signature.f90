!> What a deck fixes about a run, card by card: a restart goes on only with a deck that fixes the
!! same.
module mpm_deck_signature
  use mpm_checksum, only: checksum_of_text, checksum_text
  use mpm_deck_card, only: deck_card_t, deck_line_t, deck_t, field_count, field_text
  use mpm_diagnostics, only: diagnostics_t, error_at_keyword, to_error
  use mpm_error, only: error_t, exit_deck
  use mpm_kinds, only: dp, ip
  use mpm_source_excerpt, only: printable
  use mpm_text, only: integer_text, parse_real, to_upper
  implicit none
  private
  public :: check_signature, deck_signature

  !> They change what is written, or how it is found; what sets hold is compared with the model.
  character(8), parameter :: free_keyword(9) = [character(8) :: "HEADING", "CONTROLS", "OUTPUT", &
    "HISTORY", "EXPECT", "RESTART", "NSET", "ELSET", "SURFACE"]
  character(*), parameter :: may_change = "expected changes only in INC, in the smallest and "// &
    "largest increment, in *CONTROLS, *HEADING, *OUTPUT, *HISTORY, *EXPECT and *RESTART, and in "// &
    "steps that have not begun"

contains

  !> One line for each card that fixes something: its step (0 in the model part), its keyword with
  !! parameters, and a checksum of its data lines.
  function deck_signature(deck) result(text)
    type(deck_t), intent(in) :: deck  !! checked against the schema
    character(:), allocatable :: text !! lines
    integer :: i, step

    text = ""
    step = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "STEP") step = step + 1
      if (any(free_keyword == deck%card(i)%keyword)) cycle
      text = text//integer_text(step)//" "//card_signature(deck%card(i))//new_line("a")
    end do
  end function deck_signature

  !> Compares a deck with the signature of an earlier one, up to a step.
  subroutine check_signature(deck, signature, last_step, error)
    type(deck_t), intent(in) :: deck                 !! the deck now
    character(*), intent(in) :: signature            !! of the deck then
    integer, intent(in)      :: last_step            !! steps after it may differ
    type(error_t), allocatable, intent(out) :: error !! exit_deck at the first card that differs
    type(diagnostics_t) :: diag
    character(:), allocatable :: then, now
    integer :: first, i, step

    first = 1
    step = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "STEP") step = step + 1
      if (step > last_step) exit
      if (any(free_keyword == deck%card(i)%keyword)) cycle
      now = integer_text(step)//" "//card_signature(deck%card(i))
      call next_line(then, first, signature)
      if (now == then) cycle
      call error_at_keyword(diag, deck, i, "*"//deck%card(i)%keyword// &
                            " is not as it was when the restart file was written, where "// &
                            described(then)//" stood here: "//may_change)
      exit
    end do
    call to_error(diag, exit_deck, error)
    if (allocated(error) .or. step > last_step) return
    call next_line(then, first, signature)
    if (len(then) == 0) return
    if (step_of(then) > last_step) return
    call error_at_keyword(diag, deck, size(deck%card), described(then)// &
                          " of the deck that the restart file was written with is missing: "// &
                          may_change)
    call to_error(diag, exit_deck, error)
  end subroutine check_signature

  !> Keyword, parameters and data of a card, as far as they fix something.
  function card_signature(card) result(text)
    type(deck_card_t), intent(in) :: card !! checked against the schema
    character(:), allocatable :: text
    integer(ip) :: checksum
    integer :: i

    text = "*"//card%keyword
    do i = 1, size(card%parameter)
      associate (parameter => card%parameter(i))
        ! What stands in the file of a mesh is compared with the model, its path may change.
        if (card%keyword == "STEP" .and. parameter%name == "INC") cycle
        if (card%keyword == "MESH" .and. parameter%name == "FILE") cycle
        text = text//", "//parameter%name
        if (parameter%has_value) text = text//"="//canonical(parameter%value)
      end associate
    end do
    if (size(card%data) == 0) return
    checksum = 0_ip
    do i = 1, size(card%data)
      checksum = checksum_of_text(checksum, line_signature(card%keyword, card%data(i)))
    end do
    text = text//" #"//checksum_text(checksum)
  end function card_signature

  !> Fields of a data line. The sizes of the smallest and the largest increment are free.
  function line_signature(keyword, line) result(text)
    character(*), intent(in) :: keyword     !! of the card
    type(deck_line_t), intent(in) :: line   !! data line
    character(:), allocatable :: text
    integer :: i, n

    text = ""
    n = field_count(line)
    if (keyword == "STATIC" .or. keyword == "GEOSTATIC") n = min(2, n)
    do i = 1, n
      text = text//canonical(field_text(line, i))//","
    end do
    text = text//new_line("a")
  end function line_signature

  !> A value without the freedom of writing: numbers by value, words in upper case.
  function canonical(value) result(text)
    character(*), intent(in) :: value !! as in the deck
    character(:), allocatable :: text
    character(24) :: buffer
    real(dp) :: number
    logical :: ok

    call parse_real(value, number, ok)
    text = to_upper(value)
    if (.not. ok) return
    write (buffer, "(es24.16e3)") number
    text = trim(adjustl(buffer))
  end function canonical

  !> The next line of a text, empty behind the last one.
  subroutine next_line(line, first, text)
    character(:), allocatable, intent(out) :: line !! without its end
    integer, intent(inout) :: first                !! where it begins; on return the one after
    character(*), intent(in) :: text               !! lines
    integer :: length

    line = ""
    if (first > len(text)) return
    length = index(text(first:), new_line("a")) - 1
    if (length < 0) length = len(text) - first + 1
    line = text(first:first + length - 1)
    first = first + length + 1
  end subroutine next_line

  !> Number of the step of a line of a signature.
  integer function step_of(line)
    character(*), intent(in) :: line !! of a signature
    real(dp) :: number
    logical :: ok

    call parse_real(line(:index(line, " ") - 1), number, ok)
    step_of = huge(1)
    if (ok) step_of = int(number)
  end function step_of

  !> A line of a signature for a message.
  function described(line) result(text)
    character(*), intent(in) :: line !! of a signature, perhaps empty
    character(:), allocatable :: text
    integer :: first, last

    text = "nothing"
    first = index(line, "*")
    if (first == 0) return
    last = index(line, " #") - 1
    if (last < first) last = len(line)
    text = printable(line(first:last))
    if (last < len(line)) text = text//" with other data lines"
  end function described

end module mpm_deck_signature
