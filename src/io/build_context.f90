!> What the builders of the model share: messages, exit code, names and whether they are used.
module mpm_build_context
  use mpm_deck_card, only: deck_t
  use mpm_diagnostics, only: diagnostics_t, error_at_field, error_at_keyword, &
    & error_at_parameter, quoted, warning_at_keyword
  use mpm_error, only: error_t, exit_deck
  use mpm_mesh, only: index_set_t, mesh_t
  use mpm_text, only: nearest_word, same_name
  implicit none
  private
  public :: build_context_t, place_t, at_card, at_field, at_parameter
  public :: fault, fault_of, define_name, use_name, find_name, report_unused
  public :: require_node_set, require_element_set, require_surface, name_hint, set_names
  public :: is_node_set, is_element_set, is_surface, is_material, is_amplitude

  integer, parameter :: is_node_set = 1    !! *NSET
  integer, parameter :: is_element_set = 2 !! *ELSET
  integer, parameter :: is_surface = 3     !! *SURFACE
  integer, parameter :: is_material = 4    !! *MATERIAL
  integer, parameter :: is_amplitude = 5   !! *AMPLITUDE
  integer, parameter :: max_name = 80      !! characters of a name

  character(11), parameter :: kind_text(5) = ["node set   ", "element set", "surface    ", &
                                              "material   ", "amplitude  "]

  !> A place in the deck.
  type :: place_t
    integer :: card = 0                    !! index of the card
    integer :: line = 0                    !! data line, 0 = the keyword line
    integer :: field = 0                   !! field of the data line, 0 = the whole line
    character(:), allocatable :: parameter !! parameter; unallocated: the keyword
  end type place_t

  !> A name that the deck defines.
  type :: definition_t
    integer :: kind = 0               !! is_*
    integer :: card = 0               !! card that defines it
    character(:), allocatable :: name !! as written
    logical :: used = .false.         !! something refers to it
  end type definition_t

  !> State of a build.
  type :: build_context_t
    type(diagnostics_t) :: diag                           !! messages so far
    integer :: code = huge(1)                             !! smallest exit code so far
    logical :: lax = .false.                              !! unused names are only warnings
    type(definition_t), allocatable :: definition(:)      !! names of the deck
  end type build_context_t

contains

  !> The keyword of a card.
  pure function at_card(card) result(place)
    integer, intent(in) :: card !! index of the card
    type(place_t) :: place      !! keyword

    place%card = card
  end function at_card

  !> A field of a data line.
  pure function at_field(card, line, field) result(place)
    integer, intent(in) :: card  !! index of the card
    integer, intent(in) :: line  !! data line
    integer, intent(in) :: field !! field, 0 = the whole line
    type(place_t) :: place       !! field

    place%card = card
    place%line = line
    place%field = field
  end function at_field

  !> A parameter of a card.
  pure function at_parameter(card, parameter) result(place)
    integer, intent(in) :: card           !! index of the card
    character(*), intent(in) :: parameter !! canonical name
    type(place_t) :: place                !! value of the parameter

    place%card = card
    place%parameter = parameter
  end function at_parameter

  !> Reports an error.
  pure subroutine fault(context, deck, place, message, hint, code)
    type(build_context_t), intent(inout) :: context !! gets one error more
    type(deck_t), intent(in)  :: deck               !! the deck
    type(place_t), intent(in) :: place              !! what is wrong
    character(*), intent(in)  :: message            !! what is wrong and what was expected
    character(*), intent(in), optional :: hint      !! text below the line, empty = none
    integer, intent(in), optional :: code           !! exit code, exit_deck without it
    integer :: this_code

    this_code = exit_deck
    if (present(code)) this_code = code
    context%code = min(context%code, this_code)
    if (present(hint)) then
      if (len(hint) > 0) then
        call point_at(context%diag, deck, place, message, hint)
        return
      end if
    end if
    call point_at(context%diag, deck, place, message)
  end subroutine fault

  !> Adds a message at a place.
  pure subroutine point_at(diag, deck, place, message, hint)
    type(diagnostics_t), intent(inout) :: diag !! gets one error more
    type(deck_t), intent(in)  :: deck          !! the deck
    type(place_t), intent(in) :: place         !! what is wrong
    character(*), intent(in)  :: message       !! what is wrong and what was expected
    character(*), intent(in), optional :: hint !! text below the line

    if (place%line > 0) then
      call error_at_field(diag, deck, place%card, place%line, place%field, message, hint)
    else if (allocated(place%parameter)) then
      call error_at_parameter(diag, deck, place%card, place%parameter, message, hint)
    else
      call error_at_keyword(diag, deck, place%card, message, hint)
    end if
  end subroutine point_at

  !> Reports an error that came up from another layer, if there is one.
  pure subroutine fault_of(context, deck, place, error)
    type(build_context_t), intent(inout) :: context  !! gets one error more
    type(deck_t), intent(in)  :: deck                !! the deck
    type(place_t), intent(in) :: place               !! what caused it
    type(error_t), allocatable, intent(in) :: error  !! unallocated: nothing happens

    if (allocated(error)) call fault(context, deck, place, error%message, code=error%code)
  end subroutine fault_of

  !> Notes a name; the same name of the same kind twice is an error.
  pure subroutine define_name(context, deck, kind, place, name)
    type(build_context_t), intent(inout) :: context !! gets the name
    type(deck_t), intent(in)  :: deck               !! the deck
    integer, intent(in)       :: kind               !! is_*
    type(place_t), intent(in) :: place              !! where it is defined
    character(*), intent(in)  :: name               !! as written
    type(definition_t), allocatable :: longer(:)
    integer :: i, n

    if (.not. allocated(context%definition)) allocate (context%definition(0))
    if (find_name(context, kind, name) > 0) then
      call fault(context, deck, place, trim(kind_text(kind))//" "//quoted(name) &
                 //" is defined already: expected a new name")
      return
    end if
    n = size(context%definition)
    allocate (longer(n + 1))
    do i = 1, n
      longer(i)%kind = context%definition(i)%kind
      longer(i)%card = context%definition(i)%card
      longer(i)%used = context%definition(i)%used
      call move_alloc(context%definition(i)%name, longer(i)%name)
    end do
    longer(n + 1) = definition_t(kind, place%card, name)
    call move_alloc(longer, context%definition)
  end subroutine define_name

  !> Position of a name among the definitions, 0 if there is none of that kind.
  pure integer function find_name(context, kind, name) result(found)
    type(build_context_t), intent(in) :: context !! definitions
    integer, intent(in)      :: kind             !! is_*
    character(*), intent(in) :: name             !! any case

    if (allocated(context%definition)) then
      do found = 1, size(context%definition)
        if (context%definition(found)%kind == kind) then
          if (same_name(context%definition(found)%name, name)) return
        end if
      end do
    end if
    found = 0
  end function find_name

  !> Marks a name as used. A set of elements may stand for its nodes and its faces.
  pure subroutine use_name(context, kind, name)
    type(build_context_t), intent(inout) :: context !! definition is marked
    integer, intent(in)      :: kind                !! is_*
    character(*), intent(in) :: name                !! any case
    integer :: found

    found = find_name(context, kind, name)
    if (found == 0 .and. (kind == is_node_set .or. kind == is_surface)) then
      found = find_name(context, is_element_set, name)
    end if
    if (found > 0) context%definition(found)%used = .true.
  end subroutine use_name

  !> Names that nothing uses are errors, warnings when lax.
  pure subroutine report_unused(context, deck)
    type(build_context_t), intent(inout) :: context !! gets the messages
    type(deck_t), intent(in) :: deck                !! the deck
    integer :: i

    if (.not. allocated(context%definition)) return
    do i = 1, size(context%definition)
      associate (item => context%definition(i))
        if (item%used) cycle
        if (context%lax) then
          call warning_at_keyword(context%diag, deck, item%card, "nothing uses " &
            & //trim(kind_text(item%kind))//" "//quoted(item%name))
        else
          call fault(context, deck, at_card(item%card), "nothing uses " &
            & //trim(kind_text(item%kind))//" "//quoted(item%name) &
            & //": expected a use, or --lax on the command line")
        end if
      end associate
    end do
  end subroutine report_unused

  !> Index of a node set that must exist and hold nodes; 0 after an error.
  pure subroutine require_node_set(context, deck, mesh, place, name, found)
    type(build_context_t), intent(inout) :: context !! marks the use, gets the errors
    type(deck_t), intent(in)  :: deck               !! the deck
    type(mesh_t), intent(in)  :: mesh               !! with sets
    type(place_t), intent(in) :: place              !! where the name stands
    character(*), intent(in)  :: name               !! any case
    integer, intent(out)      :: found              !! index in mesh%node_set

    found = set_index(names_of(mesh, is_node_set), name)
    call use_name(context, is_node_set, name)
    if (found == 0) then
      call fault_of_missing_set(context, deck, mesh, is_node_set, place, name)
    else if (size(mesh%node_set(found)%item) == 0) then
      call fault(context, deck, place, "node set "//quoted(name)//" is empty: expected nodes")
      found = 0
    end if
  end subroutine require_node_set

  !> Index of an element set that must exist and hold elements; 0 after an error.
  pure subroutine require_element_set(context, deck, mesh, place, name, found)
    type(build_context_t), intent(inout) :: context !! marks the use, gets the errors
    type(deck_t), intent(in)  :: deck               !! the deck
    type(mesh_t), intent(in)  :: mesh               !! with sets
    type(place_t), intent(in) :: place              !! where the name stands
    character(*), intent(in)  :: name               !! any case
    integer, intent(out)      :: found              !! index in mesh%element_set

    found = set_index(names_of(mesh, is_element_set), name)
    call use_name(context, is_element_set, name)
    if (found == 0) then
      call fault_of_missing_set(context, deck, mesh, is_element_set, place, name)
    else if (size(mesh%element_set(found)%item) == 0) then
      call fault(context, deck, place, "element set "//quoted(name) &
                 //" is empty: expected elements")
      found = 0
    end if
  end subroutine require_element_set

  !> Index of a surface that must exist and hold faces; 0 after an error.
  pure subroutine require_surface(context, deck, mesh, place, name, found)
    type(build_context_t), intent(inout) :: context !! marks the use, gets the errors
    type(deck_t), intent(in)  :: deck               !! the deck
    type(mesh_t), intent(in)  :: mesh               !! with sets
    type(place_t), intent(in) :: place              !! where the name stands
    character(*), intent(in)  :: name               !! any case
    integer, intent(out)      :: found              !! index in mesh%surface

    found = set_index(names_of(mesh, is_surface), name)
    call use_name(context, is_surface, name)
    if (found == 0) then
      call fault_of_missing_set(context, deck, mesh, is_surface, place, name)
    else if (size(mesh%surface(found)%element) == 0) then
      call fault(context, deck, place, "surface "//quoted(name)//" is empty: expected faces")
      found = 0
    end if
  end subroutine require_surface

  !> A set that is not there: undefined, or of another kind.
  pure subroutine fault_of_missing_set(context, deck, mesh, kind, place, name)
    type(build_context_t), intent(inout) :: context !! gets the error
    type(deck_t), intent(in)  :: deck               !! the deck
    type(mesh_t), intent(in)  :: mesh               !! with sets
    integer, intent(in)       :: kind               !! kind that was expected
    type(place_t), intent(in) :: place              !! where the name stands
    character(*), intent(in)  :: name               !! any case
    character(max_name), allocatable :: names(:)
    integer :: other

    do other = is_node_set, is_surface
      if (set_index(names_of(mesh, other), name) == 0) cycle
      call use_name(context, other, name)
      call fault(context, deck, place, quoted(name)//" is the wrong kind of set, " &
                 //article(other)//": expected "//article(kind))
      return
    end do
    names = names_of(mesh, kind)
    call fault(context, deck, place, trim(kind_text(kind))//" "//quoted(name) &
               //" is not defined: expected the name of "//article(kind), name_hint(name, names))
  end subroutine fault_of_missing_set

  !> A kind of set with its article.
  pure function article(kind) result(text)
    integer, intent(in) :: kind       !! is_*
    character(:), allocatable :: text !! such as "an element set"

    text = trim(merge("an", "a ", kind == is_element_set))//" "//trim(kind_text(kind))
  end function article

  !> Guess at a misspelt name, for the hint of a message.
  pure function name_hint(name, names) result(hint)
    character(*), intent(in) :: name      !! as written
    character(*), intent(in) :: names(:)  !! (n) names that exist
    character(:), allocatable :: hint     !! empty when none is near
    character(:), allocatable :: nearest

    nearest = nearest_word(name, names)
    hint = ""
    if (len(nearest) > 0) hint = "did you mean "//quoted(nearest)//"?"
  end function name_hint

  !> Names of the sets of one kind.
  pure function names_of(mesh, kind) result(names)
    type(mesh_t), intent(in) :: mesh             !! with sets
    integer, intent(in) :: kind                  !! is_node_set, is_element_set or is_surface
    character(max_name), allocatable :: names(:) !! (n)
    integer :: i

    select case (kind)
    case (is_node_set)
      names = set_names(mesh%node_set)
    case (is_element_set)
      names = set_names(mesh%element_set)
    case default
      allocate (names(size(mesh%surface)))
      do i = 1, size(names)
        names(i) = mesh%surface(i)%name
      end do
    end select
  end function names_of

  !> Names of sets of nodes or elements.
  pure function set_names(set) result(names)
    type(index_set_t), intent(in) :: set(:)      !! (n)
    character(max_name), allocatable :: names(:) !! (n)
    integer :: i

    allocate (names(size(set)))
    do i = 1, size(set)
      names(i) = set(i)%name
    end do
  end function set_names

  !> Position of a name in a list, 0 if it is not there.
  pure integer function set_index(names, name) result(found)
    character(*), intent(in) :: names(:) !! (n)
    character(*), intent(in) :: name     !! any case

    do found = 1, size(names)
      if (same_name(names(found), name)) return
    end do
    found = 0
  end function set_index

end module mpm_build_context
