!> The one table of keywords: parser, messages, `--schema` and the manual come from it.
module mpm_deck_schema
  use mpm_deck_schema_mesh, only: add_mesh_keywords
  use mpm_deck_schema_model, only: add_model_keywords
  use mpm_deck_schema_rule, only: schema_t
  use mpm_deck_schema_step, only: add_step_keywords
  use mpm_text, only: nearest_word
  implicit none
  private
  public :: build_schema, find_keyword, keyword_hint

contains

  !> Builds the table.
  pure subroutine build_schema(schema)
    type(schema_t), intent(out) :: schema !! all keywords

    call add_mesh_keywords(schema)
    call add_model_keywords(schema)
    call add_step_keywords(schema)
  end subroutine build_schema

  !> Position of a keyword in the table, 0 if it is unknown.
  pure integer function find_keyword(schema, keyword)
    type(schema_t), intent(in) :: schema  !! all keywords
    character(*), intent(in)   :: keyword !! canonical name

    do find_keyword = schema%n, 1, -1
      if (schema%keyword(find_keyword)%keyword == keyword) return
    end do
  end function find_keyword

  !> `did you mean '*NODE'?`, empty if no keyword is close.
  pure function keyword_hint(schema, keyword) result(hint)
    type(schema_t), intent(in) :: schema  !! all keywords
    character(*), intent(in)   :: keyword !! canonical name as written
    character(:), allocatable  :: hint
    character(20), allocatable :: names(:)

    names = schema%keyword(:schema%n)%keyword
    hint = nearest_word(keyword, names)
    if (len(hint) > 0) hint = "did you mean '*"//hint//"'?"
  end function keyword_hint

end module mpm_deck_schema
