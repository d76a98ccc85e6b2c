!> One value of a deck against its rule.
module mpm_deck_schema_value
  use mpm_deck_schema_rule, only: value_choice, value_flag, value_integer, value_item, &
    value_name, value_new_name, value_real, value_reals, value_rule_t, within_range
  use mpm_kinds, only: dp
  use mpm_text, only: largest_input, nearest_word, normalize_keyword, parse_integer, parse_real, &
    parse_real_list, real_text
  implicit none
  private
  public :: value_is_valid, value_hint, is_choice, split_choices

  integer, parameter :: max_name = 80 !! characters of a name

contains

  !> Whether a text is a value that a rule allows.
  pure logical function value_is_valid(rule, text, is_quoted)
    type(value_rule_t), intent(in) :: rule      !! a parameter or field
    character(*), intent(in)       :: text      !! the value, without quotes
    logical, intent(in)            :: is_quoted !! .true.: it stood in quotes
    real(dp), allocatable :: list(:)
    real(dp) :: number
    integer :: i

    number = 0.0_dp
    select case (rule%kind)
    case (value_flag)
      value_is_valid = len(text) == 0
    case (value_integer)
      call parse_integer(text, i, value_is_valid)
      number = real(i, dp)
    case (value_real)
      call parse_real(text, number, value_is_valid)
      value_is_valid = value_is_valid .and. abs(number) <= largest_input
    case (value_reals)
      call parse_real_list(text, list, value_is_valid)
      if (value_is_valid) value_is_valid = all(abs(list) <= largest_input)
    case (value_choice)
      value_is_valid = is_choice(text, rule%choices)
    case (value_name, value_new_name)
      value_is_valid = is_name(text)
    case (value_item)
      call parse_integer(text, i, value_is_valid)
      if (value_is_valid) value_is_valid = i > 0
      if (.not. value_is_valid .or. is_quoted) value_is_valid = is_name(text)
    case default
      value_is_valid = len_trim(text) > 0 .and. index(text, """") == 0
    end select
    if (.not. value_is_valid) return
    if (rule%kind /= value_integer .and. rule%kind /= value_real) return
    value_is_valid = .not. is_quoted .and. within_range(number, rule%range)
  end function value_is_valid

  !> Whether a text can be the name of something: not a number, no quotes, not too long.
  pure logical function is_name(text)
    character(*), intent(in) :: text !! without blanks around it
    real(dp) :: number

    call parse_real(text, number, is_name)
    is_name = .not. is_name .and. len(text) <= max_name .and. len_trim(text) > 0 &
              .and. scan(text, """=*") == 0
  end function is_name

  !> Whether a text is one of some words, as keywords are compared.
  pure logical function is_choice(text, choices)
    character(*), intent(in) :: text    !! as written
    character(*), intent(in) :: choices !! `A|B|C`
    character(:), allocatable :: word

    word = normalize_keyword(text)
    is_choice = len(word) > 0 .and. index("|"//trim(choices)//"|", "|"//word//"|") > 0
  end function is_choice

  !> `did you mean 'A'?` behind a wrong choice, the limit behind a number that is beyond it; empty
  !! if there is nothing to say.
  pure function value_hint(rule, text) result(hint)
    type(value_rule_t), intent(in) :: rule !! a parameter or field
    character(*), intent(in)       :: text !! the wrong value
    character(:), allocatable :: hint
    character(16), allocatable :: words(:)
    real(dp), allocatable :: list(:)
    logical :: ok

    hint = ""
    if (rule%kind == value_real .or. rule%kind == value_reals) then
      call parse_real_list(text, list, ok)
      if (.not. ok) return
      if (any(abs(list) > largest_input)) hint = "at most "//real_text(largest_input)//" in magnitude"
    end if
    if (rule%kind /= value_choice) return
    call split_choices(rule%choices, words)
    hint = nearest_word(normalize_keyword(text), words)
    if (len(hint) > 0) hint = "did you mean '"//hint//"'?"
  end function value_hint

  !> Words between bars as a list.
  pure subroutine split_choices(choices, words)
    character(*), intent(in) :: choices                  !! `A|B|C`
    character(16), allocatable, intent(out) :: words(:)  !! (n)
    integer :: first, i, last, n

    n = count([(choices(i:i) == "|", i=1, len_trim(choices))]) + 1
    allocate (words(n))
    first = 1
    do i = 1, n
      last = index(trim(choices(first:))//"|", "|") + first - 2
      words(i) = choices(first:last)
      first = last + 2
    end do
  end subroutine split_choices

end module mpm_deck_schema_value
