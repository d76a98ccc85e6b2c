!> Data lines of a card against the schema.
module mpm_deck_schema_lines
  use mpm_deck_card, only: deck_card_t, deck_line_t, deck_t, field_text, parameter_index, &
    parameter_text
  use mpm_deck_schema_rule, only: expectation_text, keyword_rule_t, layout_t, value_rule_t
  use mpm_deck_schema_value, only: is_choice, value_hint, value_is_valid
  use mpm_diagnostics, only: diagnostics_t, error_at_field, error_at_keyword, quoted
  use mpm_text, only: integer_text, normalize_keyword
  implicit none
  private
  public :: check_lines, layout_text

contains

  !> Checks number and fields of all data lines of a card. Of a list, a comma at its end is dropped.
  pure subroutine check_lines(rule, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(inout)        :: deck   !! fields behind the last comma of lists go
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    integer :: i, i_layout

    if (rule%is_text) return
    call check_number_of_lines(rule, deck, i_card, diag)
    if (rule%n_layouts == 0) return
    do i = 1, size(deck%card(i_card)%data)
      i_layout = layout_of(rule, deck%card(i_card), deck%card(i_card)%data(i))
      if (rule%layout(i_layout)%n_fields == 0) return
      if (rule%layout(i_layout)%repeats) call drop_last_comma(deck%card(i_card)%data(i))
      call check_line(rule, rule%layout(i_layout), deck, [i_card, i], diag)
    end do
  end subroutine check_lines

  !> Checks how many data lines a card has.
  pure subroutine check_number_of_lines(rule, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    integer :: max_lines, min_lines, n
    type(deck_line_t) :: no_line
    type(layout_t) :: layout

    n = size(deck%card(i_card)%data)
    min_lines = rule%min_lines
    max_lines = rule%max_lines
    if (rule%n_layouts > 0) then
      allocate (no_line%field(0))
      layout = rule%layout(layout_of(rule, deck%card(i_card), no_line))
      if (layout%n_fields == 0) then
        min_lines = 0
        max_lines = 0
      end if
    end if
    if (n < min_lines) then
      call error_at_keyword(diag, deck, i_card, "missing data line of *"//trim(rule%keyword)// &
                            ": expected "//layout_text(layout))
    else if (n > max_lines .and. max_lines == 0) then
      call error_at_field(diag, deck, i_card, 1, 0, &
                          "data line: expected none, *"//trim(rule%keyword)//" takes none here")
    else if (n > max_lines) then
      call error_at_field(diag, deck, i_card, max_lines + 1, 0, "too many data lines of *"// &
                          trim(rule%keyword)//": expected "//integer_text(max_lines))
    end if
  end subroutine check_number_of_lines

  !> The layout that holds for a data line.
  pure integer function layout_of(rule, card, line)
    type(keyword_rule_t), intent(in) :: rule !! rule with at least one layout
    type(deck_card_t), intent(in)    :: card !! the card
    type(deck_line_t), intent(in)    :: line !! data line, may be without fields
    integer :: n

    do layout_of = 1, rule%n_layouts - 1
      associate (layout => rule%layout(layout_of))
        n = layout%field_number
        if (n == 0) then
          if (condition_holds(card, trim(layout%parameter))) return
        else if (n <= size(line%field)) then
          if (is_choice(field_text(line, n), layout%field_value)) return
        end if
      end associate
    end do
    if (rule%layout(layout_of)%field_number == 0) return
    layout_of = 1
    n = rule%layout(rule%n_layouts)%field_number
    if (n > size(line%field)) return
    if (is_choice(field_text(line, n), rule%layout(rule%n_layouts)%field_value)) &
      layout_of = rule%n_layouts
  end function layout_of

  !> Whether a card has a parameter (`GENERATE`), or one of some values of it (`TYPE=CPE3|CPS3`).
  pure logical function condition_holds(card, condition)
    type(deck_card_t), intent(in) :: card      !! the card
    character(*), intent(in)      :: condition !! name, or name and values; empty = always
    integer :: equals

    equals = index(condition//"=", "=")
    condition_holds = parameter_index(card, condition(:equals - 1)) > 0 .or. len(condition) == 0
    if (equals > len(condition) .or. .not. condition_holds) return
    condition_holds = is_choice(parameter_text(card, condition(:equals - 1), ""), &
                                condition(equals + 1:))
  end function condition_holds

  !> Takes the empty field behind the last comma from a line.
  pure subroutine drop_last_comma(line)
    type(deck_line_t), intent(inout) :: line !! a line of a list
    integer :: n

    n = size(line%field)
    if (n < 2) return
    if (line%field(n)%last >= line%field(n)%first .or. line%field(n)%quoted) return
    line%field = line%field(:n - 1)
  end subroutine drop_last_comma

  !> Checks the fields of a data line; only its first error is reported.
  pure subroutine check_line(rule, layout, deck, at, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(layout_t), intent(in)         :: layout !! of the line
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: at(2)  !! card and data line
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    character(:), allocatable :: what
    integer :: i, i_rule, n_same
    logical :: ok

    i_rule = 1
    n_same = 0
    what = " values in a line of *"//trim(rule%keyword)//": expected "//layout_text(layout)
    do i = 1, size(deck%card(at(1))%data(at(2))%field)
      if (i_rule > layout%n_fields) then
        call error_at_field(diag, deck, at(1), at(2), i, "too many"//what)
        return
      end if
      call check_field(rule, layout%field(i_rule), deck, [at, i], diag, ok)
      if (.not. ok) return
      n_same = n_same + 1
      if (n_same /= layout%field(i_rule)%count) cycle
      n_same = 0
      i_rule = i_rule + 1
      if (layout%repeats .and. i_rule > layout%n_fields) i_rule = 1
    end do
    ok = i_rule > layout%n_fields .or. (layout%repeats .and. i_rule == 1)
    if (i_rule <= layout%n_fields .and. n_same == 0) &
      ok = ok .or. .not. layout%field(i_rule)%required
    if (.not. ok) call error_at_field(diag, deck, at(1), at(2), i, "too few"//what)
  end subroutine check_line

  !> Checks one field.
  pure subroutine check_field(rule, field, deck, at, diag, ok)
    type(keyword_rule_t), intent(in)   :: rule  !! rule of the card
    type(value_rule_t), intent(in)     :: field !! rule of the field
    type(deck_t), intent(in)           :: deck  !! complete deck
    integer, intent(in)                :: at(3) !! card, data line and field
    type(diagnostics_t), intent(inout) :: diag  !! gets the error
    logical, intent(out)               :: ok    !! .false.: there was one
    character(:), allocatable :: hint

    associate (line => deck%card(at(1))%data(at(2)))
      associate (token => line%field(at(3)))
        ok = value_is_valid(field, line%text(token%first:token%last), token%quoted)
        if (ok) return
        if (token%last < token%first) then
          call error_at_field(diag, deck, at(1), at(2), at(3), "empty field in a line of *"// &
                              trim(rule%keyword)//": expected "//trim(field%name)//", "// &
                              expectation_text(field))
          return
        end if
        hint = value_hint(field, line%text(token%first:token%last))
        call error_at_field(diag, deck, at(1), at(2), at(3), trim(field%name)//" of *"// &
                            trim(rule%keyword)//" is "// &
                            quoted(line%text(token%first:token%last))//": expected "// &
                            expectation_text(field), hint)
      end associate
    end associate
  end subroutine check_field

  !> Fields of a data line in words: `set, first[, last[, value]]`.
  pure function layout_text(layout) result(text)
    type(layout_t), intent(in) :: layout !! fields of a data line
    character(:), allocatable :: text
    integer :: i, n_open

    text = ""
    n_open = 0
    do i = 1, layout%n_fields
      associate (field => layout%field(i))
        if (.not. field%required) then
          text = text//"["
          n_open = n_open + 1
        end if
        if (i > 1) text = text//", "
        text = text//trim(field%name)
        if (field%count > 1) text = text//" (x"//integer_text(field%count)//")"
      end associate
    end do
    text = text//repeat("]", n_open)
    if (layout%repeats) text = text//", ..."
  end function layout_text

end module mpm_deck_schema_lines
