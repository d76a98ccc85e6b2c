!> The rules of a keyword as data: its parameters, its data lines, where it may stand.
module mpm_deck_schema_rule
  use mpm_kinds, only: dp
  use mpm_text, only: parse_real
  implicit none
  private
  public :: schema_t, keyword_rule_t, layout_t, value_rule_t
  public :: add_keyword, add_parameter, add_layout, add_field, add_text_lines
  public :: within_range, expectation_text, choice_list, kind_name
  public :: value_flag, value_integer, value_real, value_reals, value_choice, value_name
  public :: value_new_name, value_text, value_item
  public :: in_model, in_step, in_both, once_never, once_in_deck, once_in_scope

  integer, parameter :: value_flag = 1     !! no value
  integer, parameter :: value_integer = 2
  integer, parameter :: value_real = 3
  integer, parameter :: value_reals = 4    !! several reals separated by commas
  integer, parameter :: value_choice = 5   !! one of some words
  integer, parameter :: value_name = 6     !! name of a set, material, amplitude or surface
  integer, parameter :: value_new_name = 7 !! a name that the keyword defines, unique in the deck
  integer, parameter :: value_text = 8     !! any text
  integer, parameter :: value_item = 9     !! a number or the name of a set

  integer, parameter :: in_model = 1 !! before the first *STEP
  integer, parameter :: in_step = 2  !! between *STEP and *END STEP
  integer, parameter :: in_both = 3

  integer, parameter :: once_never = 0    !! may be repeated
  integer, parameter :: once_in_deck = 1
  integer, parameter :: once_in_scope = 2 !! once in its step, or once after its parent

  !> The rule of one value: a parameter or a field of a data line.
  type :: value_rule_t
    character(16)  :: name = ""         !! canonical
    integer        :: kind = value_text !! value_*
    logical        :: required = .true.
    integer        :: group = 0         !! > 0: one parameter of the group at most, or exactly
    integer        :: count = 1         !! fields in a row, 0 = one or more
    character(16)  :: range = ""        !! `> 0`, `>= 1, <= 3`, empty = any
    character(128) :: choices = ""      !! words between bars
    character(16)  :: default = ""      !! text of the default, empty = none
    character(20)  :: only_with = ""    !! `SOURCE=METIS`: needs this value of another parameter
    character(96)  :: meaning = ""
  end type value_rule_t

  !> The fields of a data line, for a value of a parameter or of a field.
  type :: layout_t
    character(32) :: parameter = ""   !! `GENERATE` or `TYPE=CPE3|CPS3`; empty = always
    integer       :: field_number = 0 !! > 0: this field selects the layout
    character(8)  :: field_value = "" !! ... when it has this value
    logical       :: repeats = .false. !! the fields may follow each other again in one line
    integer       :: n_fields = 0     !! 0 = no data lines
    type(value_rule_t) :: field(8)
  end type layout_t

  !> The rules of a keyword.
  type :: keyword_rule_t
    character(20)  :: keyword = ""     !! canonical
    character(10)  :: group = ""       !! heading of the manual
    integer        :: section = in_model
    integer        :: once = once_never
    character(12)  :: parent = ""      !! keyword that must precede it
    character(160) :: meaning = ""
    logical        :: is_text = .false. !! data lines are free text
    integer        :: min_lines = 0
    integer        :: max_lines = 0    !! huge = any number
    integer        :: n_parameters = 0
    integer        :: n_layouts = 0
    type(value_rule_t) :: parameter(8)
    type(layout_t)     :: layout(6)
  end type keyword_rule_t

  !> All keywords.
  type :: schema_t
    integer :: n = 0
    type(keyword_rule_t), allocatable :: keyword(:) !! (>= n)
  end type schema_t

contains

  !> Adds a keyword without parameters and data lines.
  pure subroutine add_keyword(schema, keyword, group, section, once, meaning, parent)
    type(schema_t), intent(inout) :: schema  !! gets one keyword more
    character(*), intent(in) :: keyword      !! canonical name
    character(*), intent(in) :: group        !! heading of the manual
    integer, intent(in)      :: section      !! in_*
    integer, intent(in)      :: once         !! once_*
    character(*), intent(in) :: meaning      !! one sentence
    character(*), intent(in), optional :: parent !! keyword that must precede it
    type(keyword_rule_t), allocatable :: longer(:)

    if (.not. allocated(schema%keyword)) allocate (schema%keyword(40))
    if (schema%n == size(schema%keyword)) then
      allocate (longer(2*schema%n))
      longer(:schema%n) = schema%keyword
      call move_alloc(longer, schema%keyword)
    end if
    schema%n = schema%n + 1
    associate (rule => schema%keyword(schema%n))
      rule%keyword = keyword
      rule%group = group
      rule%section = section
      rule%once = once
      rule%meaning = meaning
      if (present(parent)) rule%parent = parent
    end associate
  end subroutine add_keyword

  !> Adds a parameter to the last keyword.
  pure subroutine add_parameter(schema, rule)
    type(schema_t), intent(inout)  :: schema !! its last keyword gets one parameter more
    type(value_rule_t), intent(in) :: rule   !! the parameter

    associate (keyword => schema%keyword(schema%n))
      keyword%n_parameters = keyword%n_parameters + 1
      keyword%parameter(keyword%n_parameters) = rule
    end associate
  end subroutine add_parameter

  !> Adds a form of data lines to the last keyword; its fields are added next.
  pure subroutine add_layout(schema, min_lines, max_lines, layout)
    type(schema_t), intent(inout) :: schema !! its last keyword gets one layout more
    integer, intent(in) :: min_lines        !! fewest data lines
    integer, intent(in) :: max_lines        !! most data lines
    type(layout_t), intent(in) :: layout    !! when it holds

    associate (keyword => schema%keyword(schema%n))
      keyword%min_lines = min_lines
      keyword%max_lines = max_lines
      keyword%n_layouts = keyword%n_layouts + 1
      keyword%layout(keyword%n_layouts) = layout
    end associate
  end subroutine add_layout

  !> Adds a field to the last layout of the last keyword.
  pure subroutine add_field(schema, rule)
    type(schema_t), intent(inout)  :: schema !! its last layout gets one field more
    type(value_rule_t), intent(in) :: rule   !! the field

    associate (keyword => schema%keyword(schema%n))
      associate (layout => keyword%layout(keyword%n_layouts))
        layout%n_fields = layout%n_fields + 1
        layout%field(layout%n_fields) = rule
      end associate
    end associate
  end subroutine add_field

  !> Lets the last keyword take lines of free text.
  pure subroutine add_text_lines(schema)
    type(schema_t), intent(inout) :: schema !! its last keyword is changed

    schema%keyword(schema%n)%is_text = .true.
    schema%keyword(schema%n)%max_lines = huge(1)
  end subroutine add_text_lines

  !> Whether a number keeps all conditions of a range.
  pure logical function within_range(value, range)
    real(dp), intent(in)     :: value !! number
    character(*), intent(in) :: range !! `> 0`, `>= 1, <= 3`; empty = any
    real(dp) :: bound
    integer :: first, last, space
    logical :: ok

    within_range = .true.
    first = 1
    do while (first <= len_trim(range))
      last = index(range(first:)//",", ",") + first - 2
      space = index(range(first:last), " ") + first - 1
      call parse_real(trim(range(space + 1:last)), bound, ok)
      select case (range(first:space - 1))
      case (">")
        ok = value > bound
      case (">=")
        ok = value >= bound
      case ("<")
        ok = value < bound
      case default
        ok = value <= bound
      end select
      within_range = within_range .and. ok
      first = last + 3
    end do
  end function within_range

  !> What a value must be, in words: `an integer > 0`, `UNIAXIAL, SHEAR or RADIUS`.
  pure function expectation_text(rule) result(text)
    type(value_rule_t), intent(in) :: rule !! a parameter or field
    character(:), allocatable :: text

    select case (rule%kind)
    case (value_integer)
      text = trim("an integer "//rule%range)
    case (value_real)
      text = trim("a real "//rule%range)
    case (value_reals)
      text = "reals separated by commas"
    case (value_choice)
      text = choice_list(rule%choices)
    case (value_name, value_new_name)
      text = "a name of at most 80 characters"
    case (value_item)
      text = "a number > 0 or the name of a set"
    case default
      text = "a text"
    end select
  end function expectation_text

  !> Words between bars as a list for reading: `A, B or C`.
  pure function choice_list(choices) result(text)
    character(*), intent(in)  :: choices !! `A|B|C`
    character(:), allocatable :: text
    integer :: i, last

    text = ""
    last = index(choices, "|", back=.true.)
    do i = 1, len_trim(choices)
      if (choices(i:i) /= "|") then
        text = text//choices(i:i)
      else if (i == last) then
        text = text//" or "
      else
        text = text//", "
      end if
    end do
  end function choice_list

  !> Name of a kind of value, as in the schema's JSON.
  pure function kind_name(kind) result(name)
    integer, intent(in) :: kind !! value_*
    character(:), allocatable :: name
    character(8), parameter :: names(9) = [character(8) :: "flag", "integer", "real", "reals", &
                                           "choice", "name", "name", "text", "item"]

    name = trim(names(kind))
  end function kind_name

end module mpm_deck_schema_rule
