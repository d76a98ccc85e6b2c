!> Collects elements that a card names by number, range or set.
module mpm_element_list
  use mpm_build_context, only: at_field, at_parameter, build_context_t, fault, is_element_set, &
    & name_hint, place_t, set_names, use_name
  use mpm_deck_card, only: deck_t, field_count, field_integer, field_is_integer, field_text, &
    & parameter_text
  use mpm_diagnostics, only: quoted
  use mpm_index_list, only: append_items, index_list_t
  use mpm_label_table, only: find_label
  use mpm_labelled_mesh, only: body_element, carrier_element, find_set, &
    & labelled_mesh_t
  use mpm_text, only: integer_text, same_name
  implicit none
  private
  public :: element_list_t, add_element_range, add_elements_of_field
  public :: fault_of_mesh_set, read_range

  !> Elements of a set, by kind.
  type :: element_list_t
    type(index_list_t) :: body    !! elements of the mesh
    type(index_list_t) :: carrier !! surface carriers
    type(index_list_t) :: edge    !! edges in 3-D
  end type element_list_t

contains

  !> Adds what a field names: an element by its number, or the elements of a set.
  subroutine add_elements_of_field(list, mesh, deck, context, place)
    type(element_list_t), intent(inout) :: list     !! more elements
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! the field

    associate (line => deck%card(place%card)%data(place%line))
      if (field_is_integer(line, place%field)) then
        call add_element(list, mesh, deck, context, place, field_integer(line, place%field))
      else
        call add_named_elements(list, mesh, deck, context, place)
      end if
    end associate
  end subroutine add_elements_of_field

  !> Adds an element by its number.
  subroutine add_element(list, mesh, deck, context, place, label)
    type(element_list_t), intent(inout) :: list     !! one element more
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! where the number stands
    integer, intent(in) :: label                    !! number
    integer :: found

    found = find_label(mesh%element_table, label)
    if (found == 0) then
      call fault(context, deck, place, "element "//integer_text(label)//" is not defined: " &
                 //"expected an element of the mesh")
      return
    end if
    select case (mesh%kind(found))
    case (body_element)
      call append_items(list%body, [mesh%item(found)])
    case (carrier_element)
      call append_items(list%carrier, [mesh%item(found)])
    case default
      call append_items(list%edge, [mesh%item(found)])
    end select
  end subroutine add_element

  !> Adds the elements first, first + step, ... last.
  subroutine add_element_range(list, mesh, deck, context, at)
    type(element_list_t), intent(inout) :: list     !! more elements
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    integer :: first, last, step, label, n_before

    call read_range(first, last, step, deck, context, at)
    n_before = context%diag%n_errors
    do label = first, last, step
      call add_element(list, mesh, deck, context, at_field(at(1), at(2), 0), label)
      if (context%diag%n_errors > n_before) return
    end do
  end subroutine add_element_range

  !> First, last and step of a line with GENERATE; an empty range after an error.
  subroutine read_range(first, last, step, deck, context, at)
    integer, intent(out) :: first, last, step       !! numbers
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line

    associate (line => deck%card(at(1))%data(at(2)))
      first = field_integer(line, 1)
      last = field_integer(line, 2)
      step = 1
      if (field_count(line) > 2) step = field_integer(line, 3)
      if (last < first) call fault(context, deck, at_field(at(1), at(2), 2), "the range ends at " &
        & //integer_text(last)//" before it starts: expected at least "//integer_text(first))
    end associate
  end subroutine read_range

  !> Adds the elements of another set.
  subroutine add_named_elements(list, mesh, deck, context, place)
    type(element_list_t), intent(inout) :: list     !! more elements
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! field with the name
    character(:), allocatable :: name
    integer :: i_body, i_carrier

    name = field_text(deck%card(place%card)%data(place%line), place%field)
    call use_name(context, is_element_set, name)
    associate (parent => mesh%parent)
      i_body = find_set(parent%element_set, name)
      i_carrier = find_set(parent%carrier_set, name)
      if (i_body > 0) then
        call append_items(list%body, parent%element_set(i_body)%item)
      else if (i_carrier > 0) then
        call append_items(list%carrier, parent%carrier_set(i_carrier)%item)
      else if (find_set(parent%node_set, name) > 0 .or. is_node_set_of_deck(deck, name)) then
        call fault(context, deck, place, quoted(name)//" is the wrong kind of set, a node set: " &
                   //"expected an element set")
      else
        call fault(context, deck, place, "element set "//quoted(name)//" is not defined: " &
          & //"expected the number of an element or the name of an element set", &
          & name_hint(name, [set_names(parent%element_set), set_names(parent%carrier_set)]))
      end if
    end associate
  end subroutine add_named_elements

  !> Whether a *NSET card defines a name; these are built after the element sets.
  pure logical function is_node_set_of_deck(deck, name) result(found)
    type(deck_t), intent(in) :: deck !! the deck
    character(*), intent(in) :: name !! any case
    integer :: i

    found = .true.
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "NSET") cycle
      if (same_name(parameter_text(deck%card(i), "NSET", ""), name)) return
    end do
    found = .false.
  end function is_node_set_of_deck

  !> A set of this name came with the mesh.
  subroutine fault_of_mesh_set(deck, context, i_card, parameter)
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_card                   !! card
    character(*), intent(in) :: parameter           !! parameter with the name

    call fault(context, deck, at_parameter(i_card, parameter), "the mesh has a set " &
      & //quoted(parameter_text(deck%card(i_card), parameter, ""))//" already: expected a new name")
  end subroutine fault_of_mesh_set

end module mpm_element_list
