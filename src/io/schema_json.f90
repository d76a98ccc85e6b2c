!> The schema of decks as JSON, for editors and other programs.
module mpm_schema_json
  use mpm_deck_schema, only: build_schema
  use mpm_deck_schema_rule, only: in_model, in_step, keyword_rule_t, kind_name, layout_t, &
    once_in_deck, once_in_scope, schema_t, value_rule_t
  use mpm_deck_schema_value, only: split_choices
  use mpm_text, only: integer_text
  implicit none
  private
  public :: schema_json

  character(*), parameter :: lf = new_line("a")

contains

  !> All keywords as one JSON object.
  pure function schema_json() result(text)
    character(:), allocatable :: text
    type(schema_t) :: schema
    integer :: i

    call build_schema(schema)
    text = "{"//lf//"  ""keywords"": ["
    do i = 1, schema%n
      if (i > 1) text = text//","
      text = text//lf//keyword_json(schema%keyword(i))
    end do
    text = text//lf//"  ]"//lf//"}"
  end function schema_json

  !> One keyword.
  pure function keyword_json(rule) result(text)
    type(keyword_rule_t), intent(in) :: rule !! rule of the keyword
    character(:), allocatable :: text
    integer :: i

    text = "    {"//pair("keyword", "*"//trim(rule%keyword))//", "//pair("group", rule%group)// &
           ", "//pair("section", section_name(rule%section))//", "// &
           pair("once", once_name(rule))
    if (len_trim(rule%parent) > 0) text = text//", "//pair("parent", "*"//trim(rule%parent))
    text = text//","//lf//"     "//pair("meaning", rule%meaning)
    text = text//","//lf//"     ""parameters"": ["
    do i = 1, rule%n_parameters
      if (i > 1) text = text//","
      text = text//lf//"       "//value_json(rule%parameter(i))
    end do
    text = text//"],"//lf//"     ""data"": {""text"": "//logical_json(rule%is_text)// &
           ", ""min"": "//integer_text(rule%min_lines)//", ""max"": "
    if (rule%max_lines == huge(1)) then
      text = text//"null, ""lines"": ["
    else
      text = text//integer_text(rule%max_lines)//", ""lines"": ["
    end if
    do i = 1, rule%n_layouts
      if (i > 1) text = text//","
      text = text//lf//"       "//layout_json(rule%layout(i))
    end do
    text = text//"]}}"
  end function keyword_json

  !> One form of data lines.
  pure function layout_json(layout) result(text)
    type(layout_t), intent(in) :: layout !! form of data lines
    character(:), allocatable :: text
    integer :: i

    text = "{"
    if (len_trim(layout%parameter) > 0) text = text//pair("when", layout%parameter)//", "
    if (layout%field_number > 0) text = text//pair("when", "field "// &
      integer_text(layout%field_number)//"="//trim(layout%field_value))//", "
    text = text//"""repeats"": "//logical_json(layout%repeats)//", ""fields"": ["
    do i = 1, layout%n_fields
      if (i > 1) text = text//","
      text = text//lf//"         "//value_json(layout%field(i))
    end do
    text = text//"]}"
  end function layout_json

  !> One parameter or field.
  pure function value_json(rule) result(text)
    type(value_rule_t), intent(in) :: rule !! a parameter or field
    character(:), allocatable :: text
    character(16), allocatable :: words(:)
    integer :: i

    text = "{"//pair("name", rule%name)//", "//pair("type", kind_name(rule%kind))// &
           ", ""required"": "//logical_json(rule%required)
    if (rule%group > 0) text = text//", ""exclusive"": "//integer_text(rule%group)
    if (rule%count > 1) text = text//", ""count"": "//integer_text(rule%count)
    if (len_trim(rule%range) > 0) text = text//", "//pair("range", rule%range)
    if (len_trim(rule%choices) > 0) then
      call split_choices(rule%choices, words)
      text = text//", ""choices"": ["""//trim(words(1))//""""
      do i = 2, size(words)
        text = text//", """//trim(words(i))//""""
      end do
      text = text//"]"
    end if
    if (len_trim(rule%default) > 0) text = text//", "//pair("default", rule%default)
    if (len_trim(rule%only_with) > 0) text = text//", "//pair("only_with", rule%only_with)
    text = text//", "//pair("meaning", rule%meaning)//"}"
  end function value_json

  !> A name and a text. The table holds neither quotes nor backslashes.
  pure function pair(name, value) result(text)
    character(*), intent(in) :: name, value !! texts without quotes
    character(:), allocatable :: text

    text = """"//name//""": """//trim(value)//""""
  end function pair

  !> A logical.
  pure function logical_json(value) result(text)
    logical, intent(in) :: value !! any
    character(:), allocatable :: text

    text = trim(merge("true ", "false", value))
  end function logical_json

  !> Name of the part of a deck.
  pure function section_name(section) result(name)
    integer, intent(in) :: section !! in_*
    character(:), allocatable :: name

    select case (section)
    case (in_model)
      name = "model"
    case (in_step)
      name = "step"
    case default
      name = "both"
    end select
  end function section_name

  !> How often a keyword may stand.
  pure function once_name(rule) result(name)
    type(keyword_rule_t), intent(in) :: rule !! rule of the keyword
    character(:), allocatable :: name

    select case (rule%once)
    case (once_in_deck)
      name = "deck"
    case (once_in_scope)
      name = "step"
      if (len_trim(rule%parent) > 0) name = "parent"
    case default
      name = "no"
    end select
  end function once_name

end module mpm_schema_json
