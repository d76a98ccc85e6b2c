!> The cards of a deck against the schema: known, at the right place, complete.
module mpm_deck_schema_check
  use mpm_deck_card, only: deck_t, parameter_index, parameter_text
  use mpm_deck_schema, only: find_keyword, keyword_hint
  use mpm_deck_schema_lines, only: check_lines
  use mpm_deck_schema_parameters, only: check_card_parameters
  use mpm_deck_schema_rule, only: in_both, in_model, in_step, keyword_rule_t, once_in_deck, &
    once_in_scope, once_never, schema_t, value_new_name
  use mpm_diagnostics, only: diagnostics_t, error_at_keyword, error_at_parameter, quoted, &
    too_many_errors
  use mpm_text, only: integer_text, same_name
  implicit none
  private
  public :: check_deck, check_parameters

  !> Where the walk through the cards stands.
  type :: walk_t
    logical :: inside = .false. !! between *STEP and *END STEP
    integer :: step = 0         !! card of the last *STEP, 0 before
    integer :: procedure = 0    !! card of the *STATIC or *GEOSTATIC of the step, 0 without
  end type walk_t

contains

  !> Checks all cards.
  pure subroutine check_deck(schema, deck, diag)
    type(schema_t), intent(in)         :: schema !! all keywords
    type(deck_t), intent(inout)        :: deck   !! complete deck; commas at the end of lists go
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    type(walk_t) :: walk
    integer :: i, i_rule

    do i = 1, size(deck%card)
      if (too_many_errors(diag)) return
      i_rule = find_keyword(schema, deck%card(i)%keyword)
      if (i_rule == 0) then
        call refuse_keyword(schema, deck, i, diag)
        cycle
      end if
      associate (rule => schema%keyword(i_rule))
        call check_steps(deck, i, walk, diag)
        call check_section(rule, deck, i, walk, diag)
        call check_parent(schema, rule, deck, i, diag)
        call check_once(rule, deck, i, walk, diag)
        call check_card_parameters(rule, deck, i, diag)
        call check_new_name(rule, deck, i, diag)
        call check_lines(rule, deck, i, diag)
      end associate
    end do
    if (.not. walk%inside) return
    call check_procedure(deck, walk, diag)
    call error_at_keyword(diag, deck, walk%step, "*STEP without its end: expected *END STEP")
  end subroutine check_deck

  !> Checks the parameters of one card.
  pure subroutine check_parameters(schema, deck, i_card, diag)
    type(schema_t), intent(in)         :: schema !! all keywords
    type(deck_t), intent(in)           :: deck   !! deck as read so far
    integer, intent(in)                :: i_card !! card of a known keyword
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors

    call check_card_parameters(schema%keyword(find_keyword(schema, deck%card(i_card)%keyword)), &
                               deck, i_card, diag)
  end subroutine check_parameters

  !> Reports a keyword that the table does not have.
  pure subroutine refuse_keyword(schema, deck, i_card, diag)
    type(schema_t), intent(in)         :: schema !! all keywords
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the keyword
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    character(:), allocatable :: hint, name

    associate (head => deck%card(i_card)%head)
      name = head%text(head%field(1)%first:head%field(1)%last)
    end associate
    hint = keyword_hint(schema, deck%card(i_card)%keyword)
    if (len(hint) > 0) then
      call error_at_keyword(diag, deck, i_card, "unknown keyword "//quoted(name), hint)
    else
      call error_at_keyword(diag, deck, i_card, "unknown keyword "//quoted(name)// &
                            ": expected a keyword of tessera --schema")
    end if
  end subroutine refuse_keyword

  !> Follows the steps: each ends before the next, none ends twice, each has one procedure.
  pure subroutine check_steps(deck, i_card, walk, diag)
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of a known keyword
    type(walk_t), intent(inout)        :: walk   !! moves on
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors

    select case (deck%card(i_card)%keyword)
    case ("STEP")
      if (walk%inside) then
        call error_at_keyword(diag, deck, i_card, &
                              "*STEP inside a step: expected *END STEP before it")
        call check_procedure(deck, walk, diag)
      end if
      walk = walk_t(inside=.true., step=i_card)
    case ("END STEP")
      if (walk%inside) then
        call check_procedure(deck, walk, diag)
      else
        call error_at_keyword(diag, deck, i_card, &
                              "*END STEP without a step: expected *STEP before it")
      end if
      walk%inside = .false.
    case ("STATIC", "GEOSTATIC")
      call check_only_procedure(deck, i_card, walk, diag)
      walk%procedure = i_card
    end select
  end subroutine check_steps

  !> Reports a second procedure of another kind in a step.
  pure subroutine check_only_procedure(deck, i_card, walk, diag)
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! *STATIC or *GEOSTATIC
    type(walk_t), intent(in)           :: walk   !! before the card
    type(diagnostics_t), intent(inout) :: diag   !! gets the error

    if (walk%procedure == 0) return
    associate (first => deck%card(walk%procedure), second => deck%card(i_card))
      if (first%keyword == second%keyword) return
      call error_at_keyword(diag, deck, i_card, "*"//second%keyword//" in a step that has *"// &
                            first%keyword//" in line "//integer_text(first%head%number)// &
                            ": expected one of them")
    end associate
  end subroutine check_only_procedure

  !> Reports a step without *STATIC and *GEOSTATIC.
  pure subroutine check_procedure(deck, walk, diag)
    type(deck_t), intent(in)           :: deck !! complete deck
    type(walk_t), intent(in)           :: walk !! at the end of a step
    type(diagnostics_t), intent(inout) :: diag !! gets the error

    if (walk%procedure > 0) return
    call error_at_keyword(diag, deck, walk%step, &
                          "step without procedure: expected *STATIC or *GEOSTATIC in it")
  end subroutine check_procedure

  !> Checks that a card stands in the right part of the deck.
  pure subroutine check_section(rule, deck, i_card, walk, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(walk_t), intent(in)           :: walk   !! where it stands
    type(diagnostics_t), intent(inout) :: diag   !! gets the error

    if (rule%keyword == "STEP" .or. rule%keyword == "END STEP") return
    if (rule%section == in_step .and. .not. walk%inside) then
      call error_at_keyword(diag, deck, i_card, "*"//trim(rule%keyword)// &
                            " outside a step: expected between *STEP and *END STEP")
    else if (rule%section == in_model .and. walk%step > 0) then
      call error_at_keyword(diag, deck, i_card, "*"//trim(rule%keyword)// &
                            " of the model: expected before the first *STEP")
    else if (rule%section == in_both .and. walk%step > 0 .and. .not. walk%inside) then
      call error_at_keyword(diag, deck, i_card, "*"//trim(rule%keyword)// &
                            " between steps: expected before the first *STEP or inside a step")
    end if
  end subroutine check_section

  !> Checks that a card follows its parent, with nothing but other children of it between.
  pure subroutine check_parent(schema, rule, deck, i_card, diag)
    type(schema_t), intent(in)         :: schema !! all keywords
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    integer :: i, i_rule

    if (len_trim(rule%parent) == 0) return
    do i = i_card - 1, 1, -1
      if (deck%card(i)%keyword == rule%parent) return
      i_rule = find_keyword(schema, deck%card(i)%keyword)
      if (i_rule == 0) cycle
      if (schema%keyword(i_rule)%parent /= rule%parent) exit
    end do
    call error_at_keyword(diag, deck, i_card, "*"//trim(rule%keyword)// &
                          " without *"//trim(rule%parent)//": expected *"//trim(rule%parent)// &
                          " before it")
  end subroutine check_parent

  !> Checks that a card is not given twice in the deck, in its step or for its parent.
  pure subroutine check_once(rule, deck, i_card, walk, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(walk_t), intent(in)           :: walk   !! where it stands
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    character(:), allocatable :: scope
    integer :: i, first

    if (rule%once == once_never) return
    first = 1
    scope = "a deck"
    if (rule%once == once_in_scope .and. len_trim(rule%parent) == 0) then
      if (.not. walk%inside) return
      first = max(walk%step, 1)
      scope = "a step"
    end if
    do i = i_card - 1, first, -1
      if (rule%once == once_in_scope .and. deck%card(i)%keyword == rule%parent) return
      if (deck%card(i)%keyword /= rule%keyword) cycle
      if (len_trim(rule%parent) > 0) scope = "a *"//trim(rule%parent)
      call error_at_keyword(diag, deck, i_card, "duplicate *"//trim(rule%keyword)// &
                            ", first in line "//integer_text(deck%card(i)%head%number)// &
                            ": expected one in "//scope)
      return
    end do
  end subroutine check_once

  !> Checks that the name that a card defines is new.
  pure subroutine check_new_name(rule, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    character(:), allocatable :: name, parameter
    integer :: i, j

    if (rule%n_parameters == 0) return
    if (rule%parameter(1)%kind /= value_new_name) return
    parameter = trim(rule%parameter(1)%name)
    name = parameter_text(deck%card(i_card), parameter, "")
    if (len(name) == 0) return
    do i = 1, i_card - 1
      if (deck%card(i)%keyword /= rule%keyword) cycle
      j = parameter_index(deck%card(i), parameter)
      if (j == 0) cycle
      if (len(deck%card(i)%parameter(j)%value) /= len(name)) cycle
      if (.not. same_name(deck%card(i)%parameter(j)%value, name)) cycle
      call error_at_parameter(diag, deck, i_card, parameter, "*"//trim(rule%keyword)//" "// &
                              quoted(name)//" is defined already in line "// &
                              integer_text(deck%card(i)%head%number)//": expected a new name")
      return
    end do
  end subroutine check_new_name

end module mpm_deck_schema_check
