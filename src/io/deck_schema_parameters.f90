!> Parameters of a card against the schema.
module mpm_deck_schema_parameters
  use mpm_deck_card, only: deck_card_t, deck_t, parameter_index, parameter_text
  use mpm_deck_schema_rule, only: choice_list, expectation_text, keyword_rule_t, value_flag, &
    value_rule_t
  use mpm_deck_schema_value, only: is_choice, value_hint, value_is_valid
  use mpm_diagnostics, only: diagnostics_t, error_at_keyword, error_at_parameter, &
    error_at_place, place_in_line, quoted
  use mpm_text, only: nearest_word
  implicit none
  private
  public :: check_card_parameters

contains

  !> Checks all parameters of a card: known, once, valid, complete.
  pure subroutine check_card_parameters(rule, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the errors
    integer :: i, i_rule

    do i = 1, size(deck%card(i_card)%parameter)
      i_rule = rule_of(rule, deck%card(i_card)%parameter(i)%name)
      if (i_rule == 0) then
        call refuse_parameter(rule, deck, i_card, i, diag)
      else if (parameter_index(deck%card(i_card), deck%card(i_card)%parameter(i)%name) > i) then
        cycle
      else
        call check_duplicate(rule, deck, i_card, i, diag)
        call check_value(rule, rule%parameter(i_rule), deck, [i_card, i], diag)
        call check_company(rule, rule%parameter(i_rule), deck, i_card, diag)
      end if
    end do
    do i = 1, rule%n_parameters
      if (parameter_index(deck%card(i_card), trim(rule%parameter(i)%name)) == 0) &
        call check_missing(rule, i, deck, i_card, diag)
    end do
  end subroutine check_card_parameters

  !> Position of a parameter in the rule of its keyword, 0 if it is unknown.
  pure integer function rule_of(rule, name)
    type(keyword_rule_t), intent(in) :: rule !! rule of a card
    character(*), intent(in)         :: name !! canonical name

    do rule_of = rule%n_parameters, 1, -1
      if (rule%parameter(rule_of)%name == name) return
    end do
  end function rule_of

  !> Reports a parameter that the keyword does not have.
  pure subroutine refuse_parameter(rule, deck, i_card, i, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    integer, intent(in)                :: i      !! its parameter
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    character(:), allocatable :: hint, message, name

    associate (head => deck%card(i_card)%head, parameter => deck%card(i_card)%parameter(i))
      if (parameter%name_last < parameter%name_first) then
        call error_at_place(diag, place_in_line(deck, head, parameter%name_first, &
                                                parameter%name_first), &
                            "empty parameter of *"//trim(rule%keyword)//": "//known_names(rule))
        return
      end if
      name = head%text(parameter%name_first:parameter%name_last)
      message = "unknown parameter "//quoted(name)//" of *"//trim(rule%keyword)
      hint = likely_name(rule, parameter%name)
      if (len(hint) > 0) then
        hint = "did you mean '"//hint//"'?"
      else
        message = message//": "//known_names(rule)
      end if
      call error_at_place(diag, place_in_line(deck, head, parameter%name_first, &
                                              parameter%name_last), message, hint)
    end associate
  end subroutine refuse_parameter

  !> The parameter that was probably meant by a wrong name, empty if none is close.
  pure function likely_name(rule, name) result(likely)
    type(keyword_rule_t), intent(in) :: rule !! rule of a card
    character(*), intent(in)         :: name !! canonical form of the wrong name
    character(:), allocatable :: likely
    character(16), allocatable :: names(:)

    names = rule%parameter(:rule%n_parameters)%name
    likely = nearest_word(name, names)
  end function likely_name

  !> Whether a card has an unknown parameter that is probably a misspelt one.
  pure logical function is_misspelt(rule, card, name)
    type(keyword_rule_t), intent(in) :: rule !! rule of the card
    type(deck_card_t), intent(in)    :: card !! the card
    character(*), intent(in)         :: name !! parameter that it does not have
    integer :: i

    is_misspelt = .false.
    do i = 1, size(card%parameter)
      if (rule_of(rule, card%parameter(i)%name) > 0) cycle
      is_misspelt = is_misspelt .or. likely_name(rule, card%parameter(i)%name) == name
    end do
  end function is_misspelt

  !> `expected A, B or C`, or that the keyword takes none.
  pure function known_names(rule) result(text)
    type(keyword_rule_t), intent(in) :: rule !! rule of a card
    character(:), allocatable :: text
    integer :: i

    text = "expected none"
    if (rule%n_parameters == 0) return
    text = trim(rule%parameter(1)%name)
    do i = 2, rule%n_parameters
      text = text//"|"//trim(rule%parameter(i)%name)
    end do
    text = "expected "//choice_list(text)
  end function known_names

  !> Reports a parameter that the card has already.
  pure subroutine check_duplicate(rule, deck, i_card, i, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    integer, intent(in)                :: i      !! last one of its name
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    integer :: j

    associate (card => deck%card(i_card))
      do j = 1, i - 1
        if (card%parameter(j)%name /= card%parameter(i)%name) cycle
        call error_at_place(diag, place_in_line(deck, card%head, card%parameter(i)%name_first, &
                                                card%parameter(i)%name_last), &
                            "duplicate parameter "//card%parameter(i)%name//" of *"// &
                            trim(rule%keyword)//": expected it once")
        return
      end do
    end associate
  end subroutine check_duplicate

  !> Checks the value of a parameter.
  pure subroutine check_value(rule, expected, deck, at, diag)
    type(keyword_rule_t), intent(in)   :: rule     !! rule of the card
    type(value_rule_t), intent(in)     :: expected !! rule of the parameter
    type(deck_t), intent(in)           :: deck     !! complete deck
    integer, intent(in)                :: at(2)    !! card and its parameter
    type(diagnostics_t), intent(inout) :: diag     !! gets the error
    character(:), allocatable :: hint, what
    logical :: in_quotes

    what = trim(expected%name)//" of *"//trim(rule%keyword)
    associate (parameter => deck%card(at(1))%parameter(at(2)))
      in_quotes = parameter%value_last - parameter%value_first + 1 > len(parameter%value) &
                  .and. index(deck%card(at(1))%head%text(parameter%value_first:), """") == 1
      if (expected%kind == value_flag) then
        if (parameter%has_value) &
          call error_at_parameter(diag, deck, at(1), parameter%name, &
                                  what//" is a flag: expected no value")
      else if (len(parameter%value) == 0) then
        call error_at_parameter(diag, deck, at(1), parameter%name, &
                                what//" has no value: expected "//expectation_text(expected))
      else if (.not. value_is_valid(expected, parameter%value, in_quotes)) then
        hint = value_hint(expected, parameter%value)
        call error_at_parameter(diag, deck, at(1), parameter%name, what//" is "// &
                                quoted(parameter%value)//": expected "// &
                                expectation_text(expected), hint)
      end if
    end associate
  end subroutine check_value

  !> Checks that the parameters which a parameter needs are there, and those that exclude it not.
  pure subroutine check_company(rule, expected, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule     !! rule of the card
    type(value_rule_t), intent(in)     :: expected !! rule of a parameter that the card has
    type(deck_t), intent(in)           :: deck     !! complete deck
    integer, intent(in)                :: i_card   !! card of the deck
    type(diagnostics_t), intent(inout) :: diag     !! gets the error
    integer :: i

    if (.not. is_wanted(rule, expected, deck%card(i_card))) &
      call error_at_parameter(diag, deck, i_card, trim(expected%name), trim(expected%name)// &
                              " of *"//trim(rule%keyword)//": expected only with "// &
                              trim(expected%only_with))
    if (expected%group == 0) return
    do i = 1, rule%n_parameters
      if (rule%parameter(i)%name == expected%name) exit
      if (rule%parameter(i)%group /= expected%group) cycle
      if (parameter_index(deck%card(i_card), trim(rule%parameter(i)%name)) == 0) cycle
      call error_at_parameter(diag, deck, i_card, trim(expected%name), &
                              trim(expected%name)//" of *"//trim(rule%keyword)// &
                              ": expected not together with "//trim(rule%parameter(i)%name))
    end do
  end subroutine check_company

  !> Whether the other parameter that a parameter depends on has its value, by default too.
  pure logical function is_wanted(rule, expected, card) result(wanted)
    type(keyword_rule_t), intent(in) :: rule     !! rule of the card
    type(value_rule_t), intent(in)   :: expected !! rule of a parameter
    type(deck_card_t), intent(in)    :: card     !! the card
    character(:), allocatable :: other
    integer :: equals

    equals = index(expected%only_with, "=")
    wanted = equals == 0
    if (wanted) return
    other = expected%only_with(:equals - 1)
    wanted = is_choice(parameter_text(card, other, &
                                      trim(rule%parameter(rule_of(rule, other))%default)), &
                       expected%only_with(equals + 1:))
  end function is_wanted

  !> Whether a card needs a parameter that it does not have; a misspelt one has its own message.
  pure logical function is_needed(rule, missing, card) result(needed)
    type(keyword_rule_t), intent(in) :: rule    !! rule of the card
    type(value_rule_t), intent(in)   :: missing !! rule of the parameter
    type(deck_card_t), intent(in)    :: card    !! the card

    needed = missing%required .and. is_wanted(rule, missing, card) &
             .and. .not. is_misspelt(rule, card, trim(missing%name))
  end function is_needed

  !> Reports a required parameter that the card does not have.
  pure subroutine check_missing(rule, i_rule, deck, i_card, diag)
    type(keyword_rule_t), intent(in)   :: rule   !! rule of the card
    integer, intent(in)                :: i_rule !! parameter that is not there
    type(deck_t), intent(in)           :: deck   !! complete deck
    integer, intent(in)                :: i_card !! card of the deck
    type(diagnostics_t), intent(inout) :: diag   !! gets the error
    character(:), allocatable :: names
    integer :: i

    associate (missing => rule%parameter(i_rule))
      if (.not. is_needed(rule, missing, deck%card(i_card))) return
      names = ""
      do i = 1, rule%n_parameters
        if (missing%group == 0 .or. rule%parameter(i)%group /= missing%group) cycle
        if (parameter_index(deck%card(i_card), trim(rule%parameter(i)%name)) > 0) return
        names = names//"|"//trim(rule%parameter(i)%name)
      end do
      if (len(names) > 0) then
        if (index(names, "|"//trim(missing%name)) > 1) return
        call error_at_keyword(diag, deck, i_card, "missing parameter of *"//trim(rule%keyword)// &
                              ": expected "//choice_list(names(2:)))
      else
        call error_at_keyword(diag, deck, i_card, "missing parameter "//trim(missing%name)// &
                              " of *"//trim(rule%keyword)//": expected "//value_form(missing))
      end if
    end associate
  end subroutine check_missing

  !> How a parameter is written: `STRENGTH with UNIAXIAL, SHEAR or RADIUS`.
  pure function value_form(rule) result(text)
    type(value_rule_t), intent(in) :: rule !! a parameter
    character(:), allocatable :: text

    text = trim(rule%name)
    if (rule%kind /= value_flag) text = text//" with "//expectation_text(rule)
  end function value_form

end module mpm_deck_schema_parameters
