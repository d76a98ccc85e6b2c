!> The schema of decks as the keyword tables of the manual.
module mpm_schema_markdown
  use mpm_deck_schema, only: build_schema
  use mpm_deck_schema_lines, only: layout_text
  use mpm_deck_schema_rule, only: choice_list, in_model, in_step, keyword_rule_t, kind_name, &
    layout_t, once_in_deck, once_in_scope, schema_t, value_choice, value_flag, value_rule_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: schema_markdown

  character(*), parameter :: lf = new_line("a")

contains

  !> All keywords: a heading per group and per keyword, and their tables. Without a line feed at
  !! the end.
  pure function schema_markdown() result(text)
    character(:), allocatable :: text
    type(schema_t) :: schema
    character(10) :: group
    integer :: i

    call build_schema(schema)
    text = ""
    group = ""
    do i = 1, schema%n
      if (i > 1) text = text//lf//lf
      if (schema%keyword(i)%group /= group) then
        group = schema%keyword(i)%group
        text = text//"### Keywords of the group "//trim(group)//lf//lf
      end if
      text = text//keyword_markdown(schema%keyword(i))
    end do
  end function schema_markdown

  !> One keyword.
  pure function keyword_markdown(rule) result(text)
    type(keyword_rule_t), intent(in) :: rule !! rule of the keyword
    character(:), allocatable :: text
    integer :: i

    text = "#### `*"//trim(rule%keyword)//"`"//lf//lf//trim(rule%meaning)//lf//place_text(rule)
    if (rule%n_parameters > 0) then
      text = text//lf//lf//"| parameter | value | default | meaning |"//lf//"|---|---|---|---|"
      do i = 1, rule%n_parameters
        text = text//lf//value_row("`"//trim(rule%parameter(i)%name)//"`", rule%parameter(i))
      end do
    end if
    do i = 1, rule%n_layouts
      text = text//lf//lf//layout_markdown(rule, rule%layout(i))
    end do
  end function keyword_markdown

  !> Where a keyword may stand, and how often.
  pure function place_text(rule) result(text)
    type(keyword_rule_t), intent(in) :: rule !! rule of the keyword
    character(:), allocatable :: text

    select case (rule%section)
    case (in_model)
      text = "Model part"
    case (in_step)
      text = "Inside a step"
    case default
      text = "Model part or inside a step"
    end select
    if (rule%keyword == "STEP") text = "Begins the history part"
    if (len_trim(rule%parent) > 0) text = text//", after `*"//trim(rule%parent)//"`"
    if (rule%once == once_in_deck) text = text//", once in a deck"
    if (rule%once == once_in_scope .and. len_trim(rule%parent) == 0) &
      text = text//", once in a step"
    if (rule%once == once_in_scope .and. len_trim(rule%parent) > 0) text = text//", once"
    text = text//"."
  end function place_text

  !> The form of data lines and their fields.
  pure function layout_markdown(rule, layout) result(text)
    type(keyword_rule_t), intent(in) :: rule   !! rule of the keyword
    type(layout_t), intent(in)       :: layout !! form of its data lines
    character(:), allocatable :: text
    character(:), allocatable :: condition
    integer :: i

    condition = ""
    if (len_trim(layout%parameter) > 0) condition = " with `"//spoken(layout%parameter)//"`"
    if (layout%field_number > 0) condition = " with `"//trim(layout%field_value)//"`"
    if (layout%n_fields == 0) then
      text = "Data lines"//condition//": none."
      return
    end if
    text = "Data lines"//condition//" ("//number_of_lines(rule)//"): `"//layout_text(layout)// &
           "`"//lf//lf//"| field | value | default | meaning |"//lf//"|---|---|---|---|"
    do i = 1, layout%n_fields
      text = text//lf//value_row(trim(layout%field(i)%name), layout%field(i))
    end do
  end function layout_markdown

  !> How many data lines a keyword takes.
  pure function number_of_lines(rule) result(text)
    type(keyword_rule_t), intent(in) :: rule !! rule of the keyword
    character(:), allocatable :: text

    if (rule%max_lines == huge(1)) then
      text = integer_text(rule%min_lines)//" or more"
    else
      text = integer_text(rule%max_lines)
      if (rule%min_lines < rule%max_lines) text = "at most "//text
    end if
  end function number_of_lines

  !> A row of a table.
  pure function value_row(name, rule) result(text)
    character(*), intent(in)       :: name !! first column
    type(value_rule_t), intent(in) :: rule !! a parameter or field
    character(:), allocatable :: text, default

    select case (rule%kind)
    case (value_choice)
      text = spoken(rule%choices)
    case (value_flag)
      text = "flag"
    case default
      text = trim(kind_name(rule%kind)//" "//rule%range)
    end select
    if (rule%count > 1) text = integer_text(rule%count)//" times "//text
    default = trim(rule%default)
    if (len(default) == 0) default = trim(merge("required", "none    ", rule%required))
    if (rule%group > 0 .and. rule%required) default = "one of them"
    text = "| "//name//" | "//text//" | "//default//" | "//trim(rule%meaning)
    if (len_trim(rule%only_with) > 0) text = text//"; only with `"//trim(rule%only_with)//"`"
    text = text//" |"
  end function value_row

  !> Words between bars without bars, which would end a cell of a table.
  pure function spoken(choices) result(text)
    character(*), intent(in)  :: choices !! `A|B|C`
    character(:), allocatable :: text

    text = choice_list(trim(choices))
  end function spoken

end module mpm_schema_markdown
