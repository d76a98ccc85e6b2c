!> Builds the sets that the deck defines: *NSET, *ELSET and *SURFACE.
module mpm_set_builder
  use mpm_box_set, only: add_elements_in_box, add_nodes_in_box
  use mpm_build_context, only: at_field, at_parameter, build_context_t, define_name, fault, &
    & is_element_set, is_node_set, name_hint, place_t, set_names, use_name
  use mpm_deck_card, only: deck_t, field_count, field_integer, field_is_integer, field_text, &
    & has_parameter, parameter_text
  use mpm_diagnostics, only: quoted
  use mpm_element_list, only: add_element_range, add_elements_of_field, element_list_t, &
    & fault_of_mesh_set, read_range
  use mpm_index_list, only: append_items, index_list_t, list_items
  use mpm_label_table, only: find_label
  use mpm_labelled_mesh, only: add_set, find_set, labelled_mesh_t
  use mpm_surface_builder, only: build_surface
  use mpm_text, only: integer_text
  implicit none
  private
  public :: build_sets

contains

  !> Adds the sets of the deck to those of the mesh: element sets, then node sets, then surfaces.
  subroutine build_sets(mesh, deck, context)
    type(labelled_mesh_t), intent(inout) :: mesh    !! sets are added
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes names and errors
    integer :: i

    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "ELSET") call build_element_set(mesh, deck, context, i)
    end do
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "NSET") call build_node_set(mesh, deck, context, i)
    end do
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "SURFACE") call build_surface(mesh, deck, context, i)
    end do
  end subroutine build_sets

  !> *ELSET.
  subroutine build_element_set(mesh, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! one set more
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the name and errors
    integer, intent(in) :: i_card                   !! *ELSET
    type(element_list_t) :: list
    character(:), allocatable :: name
    integer :: j, k, n_before

    name = parameter_text(deck%card(i_card), "ELSET", "")
    n_before = context%diag%n_errors
    call define_name(context, deck, is_element_set, at_parameter(i_card, "ELSET"), name)
    if (context%diag%n_errors > n_before) return
    if (find_set(mesh%parent%element_set, name) + find_set(mesh%parent%carrier_set, name) > 0) then
      call fault_of_mesh_set(deck, context, i_card, "ELSET")
      return
    end if
    do j = 1, size(deck%card(i_card)%data)
      if (has_parameter(deck%card(i_card), "GENERATE")) then
        call add_element_range(list, mesh, deck, context, [i_card, j])
        cycle
      else if (has_parameter(deck%card(i_card), "BOX")) then
        call add_elements_in_box(list%body, mesh%parent, deck, context, [i_card, j])
        cycle
      end if
      do k = 1, field_count(deck%card(i_card)%data(j))
        call add_elements_of_field(list, mesh, deck, context, at_field(i_card, j, k))
      end do
    end do
    if (context%diag%n_errors > n_before) then
      call add_set(mesh%parent%element_set, name, list_items(list%body))
    else
      call close_element_set(mesh, list, deck, context, i_card)
    end if
  end subroutine build_element_set

  !> Puts the elements of a list into a set of the right kind.
  subroutine close_element_set(mesh, list, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! one set more
    type(element_list_t), intent(in) :: list        !! elements
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *ELSET
    character(:), allocatable :: name

    name = parameter_text(deck%card(i_card), "ELSET", "")
    if (count([list%body%n, list%carrier%n, list%edge%n] > 0) > 1) then
      call fault(context, deck, at_parameter(i_card, "ELSET"), "element set "//quoted(name) &
                 //" mixes elements of the body and of its boundary: expected one kind")
    else if (list%carrier%n > 0) then
      call add_set(mesh%parent%carrier_set, name, list_items(list%carrier))
      if (find_set(mesh%parent%node_set, name) == 0) call add_set(mesh%parent%node_set, name, &
        & pack(mesh%carrier_node(:, list_items(list%carrier)), .true.))
    else if (list%edge%n > 0) then
      if (find_set(mesh%parent%node_set, name) == 0) call add_set(mesh%parent%node_set, name, &
        & pack(mesh%edge_node(:, list_items(list%edge)), .true.))
    else
      call add_set(mesh%parent%element_set, name, list_items(list%body))
    end if
  end subroutine close_element_set

  !> *NSET.
  subroutine build_node_set(mesh, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! one set more
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the name and errors
    integer, intent(in) :: i_card                   !! *NSET
    type(index_list_t) :: list
    character(:), allocatable :: name
    integer :: j, k, n_before

    name = parameter_text(deck%card(i_card), "NSET", "")
    n_before = context%diag%n_errors
    call define_name(context, deck, is_node_set, at_parameter(i_card, "NSET"), name)
    if (context%diag%n_errors > n_before) return
    if (find_set(mesh%parent%node_set, name) > 0) then
      call fault_of_mesh_set(deck, context, i_card, "NSET")
      return
    end if
    if (has_parameter(deck%card(i_card), "ELSET")) call add_nodes_of_elements(list, mesh, deck, &
      & context, i_card)
    do j = 1, size(deck%card(i_card)%data)
      if (has_parameter(deck%card(i_card), "GENERATE")) then
        call add_node_range(list, mesh, deck, context, [i_card, j])
        cycle
      else if (has_parameter(deck%card(i_card), "BOX")) then
        call add_nodes_in_box(list, mesh%parent, deck, context, [i_card, j])
        cycle
      end if
      do k = 1, field_count(deck%card(i_card)%data(j))
        call add_nodes_of_field(list, mesh, deck, context, at_field(i_card, j, k))
      end do
    end do
    call add_set(mesh%parent%node_set, name, list_items(list))
  end subroutine build_node_set

  !> Adds what a field names: a node by its number, or the nodes of a set.
  subroutine add_nodes_of_field(list, mesh, deck, context, place)
    type(index_list_t), intent(inout) :: list       !! more nodes
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! the field

    associate (line => deck%card(place%card)%data(place%line))
      if (field_is_integer(line, place%field)) then
        call add_node(list, mesh, deck, context, place, field_integer(line, place%field))
      else
        call add_named_nodes(list, mesh, deck, context, place)
      end if
    end associate
  end subroutine add_nodes_of_field

  !> Adds a node by its number.
  subroutine add_node(list, mesh, deck, context, place, label)
    type(index_list_t), intent(inout) :: list       !! one node more
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! where the number stands
    integer, intent(in) :: label                    !! number
    integer :: found

    found = find_label(mesh%node_table, label)
    if (found == 0) then
      call fault(context, deck, place, "node "//integer_text(label)//" is not defined: " &
                 //"expected a node of the mesh")
    else if (mesh%new_node(found) == 0) then
      call fault(context, deck, place, "node "//integer_text(label)//" belongs to no element of " &
                 //"the body: expected a node of the body")
    else
      call append_items(list, [mesh%new_node(found)])
    end if
  end subroutine add_node

  !> Adds the nodes first, first + step, ... last.
  subroutine add_node_range(list, mesh, deck, context, at)
    type(index_list_t), intent(inout) :: list       !! more nodes
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    integer :: first, last, step, label, n_before

    call read_range(first, last, step, deck, context, at)
    n_before = context%diag%n_errors
    do label = first, last, step
      call add_node(list, mesh, deck, context, at_field(at(1), at(2), 0), label)
      if (context%diag%n_errors > n_before) return
    end do
  end subroutine add_node_range

  !> Adds the nodes of another node set.
  subroutine add_named_nodes(list, mesh, deck, context, place)
    type(index_list_t), intent(inout) :: list       !! more nodes
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! field with the name
    character(:), allocatable :: name
    integer :: found

    name = field_text(deck%card(place%card)%data(place%line), place%field)
    call use_name(context, is_node_set, name)
    found = find_set(mesh%parent%node_set, name)
    if (found > 0) then
      call append_items(list, mesh%parent%node_set(found)%item)
    else if (find_set(mesh%parent%element_set, name) > 0) then
      call fault(context, deck, place, quoted(name)//" is the wrong kind of set, an element set: " &
                 //"expected a node set", "use *NSET, NSET=..., ELSET="//name)
    else
      call fault(context, deck, place, "node set "//quoted(name)//" is not defined: expected the " &
        & //"number of a node or the name of a node set", &
        & name_hint(name, set_names(mesh%parent%node_set)))
    end if
  end subroutine add_named_nodes

  !> Adds the nodes of an element set or of carriers.
  subroutine add_nodes_of_elements(list, mesh, deck, context, i_card)
    type(index_list_t), intent(inout) :: list       !! more nodes
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *NSET with ELSET=
    character(:), allocatable :: name
    integer :: i_body, i_nodes

    name = parameter_text(deck%card(i_card), "ELSET", "")
    call use_name(context, is_element_set, name)
    associate (parent => mesh%parent)
      i_body = find_set(parent%element_set, name)
      i_nodes = find_set(parent%node_set, name)
      if (i_body > 0) then
        call append_items(list, pack(parent%node(:, parent%element_set(i_body)%item), .true.))
      else if (find_set(parent%carrier_set, name) > 0 .and. i_nodes > 0) then
        call append_items(list, parent%node_set(i_nodes)%item)
      else
        call fault(context, deck, at_parameter(i_card, "ELSET"), "element set "//quoted(name) &
          & //" is not defined: expected the name of an element set", &
          & name_hint(name, [set_names(parent%element_set), set_names(parent%carrier_set)]))
      end if
    end associate
  end subroutine add_nodes_of_elements

end module mpm_set_builder
