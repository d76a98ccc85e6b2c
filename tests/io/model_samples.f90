!> A small plane deck that can be varied, and what becomes of it, for tests of the builders.
module model_samples
  use deck_samples, only: as_lines, headlines, write_bytes
  use mpm_deck_card, only: deck_t
  use mpm_diagnostics, only: diagnostics_t, to_error, warnings_text
  use mpm_error, only: error_t, exit_deck
  use mpm_input_deck, only: read_deck
  use mpm_model, only: model_t
  use mpm_model_builder, only: build_model
  use mpm_text, only: integer_text
  implicit none
  private
  public :: plane_deck, plane_mesh, varied, build_text, outcome_of, warnings_of, source_path

  !> Unit square of two triangles with its upper edge: lines 1 to 10.
  character(*), parameter :: plane_mesh = "*NODE\1, 0, 0\2, 1, 0\3, 1, 1\4, 0, 1\"// &
    "*ELEMENT, TYPE=CPE3, ELSET=SOIL\1, 1, 2, 3\2, 1, 3, 4\*ELEMENT, TYPE=T3D2, ELSET=TOP\3, 3, 4\"

  !> The square pressed down by its upper edge: 24 lines.
  character(*), parameter :: plane_deck = plane_mesh//"*NSET, NSET=BASE\1, 2\"// &
    "*FORMULATION, TYPE=STANDARD\*MATERIAL, NAME=CLAY\*ELASTIC\1000, 0.3\"// &
    "*MATERIAL POINTS, ELSET=SOIL, MATERIAL=CLAY, PER ELEMENT=3\*STEP, NAME=PUSH\*STATIC\"// &
    "0.5, 1.0\*BOUNDARY\BASE, 1, 2\TOP, 2, 2, -0.1\*END STEP\"

contains

  !> The plane deck with one text in place of another; an unknown text spoils the deck.
  pure function varied(old, new, deck) result(text)
    character(*), intent(in) :: old            !! text to be replaced, once
    character(*), intent(in) :: new            !! replacement
    character(*), intent(in), optional :: deck !! deck instead of the plane one
    character(:), allocatable :: text
    integer :: i

    text = plane_deck
    if (present(deck)) text = deck
    i = index(text, old)
    if (i == 0) then
      text = "text to replace not found: "//old
      return
    end if
    text = text(:i - 1)//new//text(i + len(old):)
  end function varied

  !> Builds a model from a text.
  subroutine build_text(model, text, error, lax, diag)
    type(model_t), intent(out) :: model              !! the model
    character(*), intent(in) :: text                 !! lines between backslashes
    type(error_t), allocatable, intent(out) :: error !! of the deck or of the model
    logical, intent(in) :: lax                       !! option --lax
    type(diagnostics_t), intent(out) :: diag         !! all messages
    type(deck_t) :: deck

    call write_bytes("t.inp", as_lines(text))
    call read_deck(deck, "t.inp", diag)
    call to_error(diag, exit_deck, error)
    if (allocated(error)) return
    call build_model(model, deck, lax, diag, error)
  end subroutine build_text

  !> Exit code and messages of a deck: "2 22:1:node set ...", "ok" when it is built.
  function outcome_of(text) result(outcome)
    character(*), intent(in)  :: text    !! lines between backslashes
    character(:), allocatable :: outcome
    type(model_t) :: model
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diag

    call build_text(model, text, error, .false., diag)
    outcome = "ok"
    if (allocated(error)) outcome = integer_text(error%code)//" "//headlines(error%message)
  end function outcome_of

  !> Warnings of a deck that is built with --lax.
  function warnings_of(text) result(warnings)
    character(*), intent(in)  :: text     !! lines between backslashes
    character(:), allocatable :: warnings
    type(model_t) :: model
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diag

    call build_text(model, text, error, .true., diag)
    warnings = warnings_text(diag)
    if (allocated(error)) warnings = error%message
  end function warnings_of

  !> Path of a file of the project.
  function source_path(path)
    character(*), intent(in)  :: path !! relative to the root of the project
    character(:), allocatable :: source_path
    character(1000) :: root

    call get_environment_variable("TESSERA_SOURCE_DIR", root)
    source_path = trim(root)//"/"//path
  end function source_path

end module model_samples
