!> Builds the surfaces of the deck: *SURFACE.
module mpm_surface_builder
  use mpm_build_context, only: at_field, at_parameter, build_context_t, define_name, fault, &
    & is_surface, place_t
  use mpm_deck_card, only: deck_t, field_count, field_text, parameter_text
  use mpm_element_list, only: add_elements_of_field, element_list_t, fault_of_mesh_set
  use mpm_face_table, only: build_face_table, face_table_t, find_face
  use mpm_index_list, only: append_items, index_list_t, list_items
  use mpm_labelled_mesh, only: add_surface, find_set, labelled_mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: build_surface

  !> Faces of a surface.
  type :: face_list_t
    type(index_list_t) :: element !! elements
    type(index_list_t) :: face    !! local faces
  end type face_list_t

contains

  !> *SURFACE: element faces, or a set of carriers.
  subroutine build_surface(mesh, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! one surface more
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the name and errors
    integer, intent(in) :: i_card                   !! *SURFACE
    type(face_list_t) :: list
    character(:), allocatable :: name
    integer :: j, n_before

    name = parameter_text(deck%card(i_card), "NAME", "")
    n_before = context%diag%n_errors
    call define_name(context, deck, is_surface, at_parameter(i_card, "NAME"), name)
    if (context%diag%n_errors > n_before) return
    if (find_set(mesh%parent%carrier_set, name) > 0) then
      call fault_of_mesh_set(deck, context, i_card, "NAME")
      return
    end if
    do j = 1, size(deck%card(i_card)%data)
      call add_faces(list, mesh, deck, context, at_field(i_card, j, 1))
    end do
    call add_surface(mesh%parent%surface, name, list_items(list%element), list_items(list%face))
  end subroutine build_surface

  !> Faces of one line of *SURFACE: a face of elements, or carriers.
  subroutine add_faces(list, mesh, deck, context, place)
    type(face_list_t), intent(inout) :: list        !! more faces
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! first field of the line
    type(element_list_t) :: elements
    type(place_t) :: face_place
    integer :: face

    face_place = at_field(place%card, place%line, 2)
    associate (line => deck%card(place%card)%data(place%line))
      call add_elements_of_field(elements, mesh, deck, context, place)
      face = 0
      if (field_count(line) > 1) face = opposite_node(field_text(line, 2), mesh%parent%n_dim)
      if (elements%body%n > 0 .and. field_count(line) == 1) then
        call fault(context, deck, face_place, "a surface of elements needs their face: expected " &
                   //"S1 to S"//integer_text(mesh%parent%n_dim + 1))
      else if (elements%body%n > 0 .and. face == 0) then
        call fault(context, deck, face_place, "triangles have no face "//field_text(line, 2) &
                   //": expected S1, S2 or S3")
      else if (elements%body%n == 0 .and. field_count(line) > 1 .and. &
               elements%carrier%n > 0) then
        call fault(context, deck, face_place, "these elements are faces themselves: expected no " &
                   //"second field")
      else if (elements%body%n > 0) then
        call append_items(list%element, list_items(elements%body))
        call append_items(list%face, spread(face, 1, elements%body%n))
      else
        call add_carrier_faces(list, mesh, deck, context, place, &
                               list_items(elements%carrier))
      end if
    end associate
  end subroutine add_faces

  !> Local node opposite a face of Abaqus' numbering, 0 if there is no such face.
  pure integer function opposite_node(face, n_dim) result(node)
    character(*), intent(in) :: face !! S1 to S4, any case
    integer, intent(in) :: n_dim     !! 2 or 3
    integer, parameter :: opposite(4, 2:3) = reshape([3, 1, 2, 0, 4, 3, 1, 2], [4, 2])

    node = opposite(index("1234", face(2:2)), n_dim)
  end function opposite_node

  !> Faces of the body on which carriers lie.
  subroutine add_carrier_faces(list, mesh, deck, context, place, carrier)
    type(face_list_t), intent(inout) :: list        !! more faces
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! where the carriers stand
    integer, intent(in) :: carrier(:)               !! (n) carriers
    type(face_table_t) :: table
    integer :: i, element, face

    if (size(carrier) == 0) return
    associate (parent => mesh%parent)
      call build_face_table(table, parent%node(:parent%n_dim + 1, :), parent%n_node)
      do i = 1, size(carrier)
        call find_face(table, parent%carrier(:, carrier(i)), element, face)
        if (element == 0) then
          call fault(context, deck, place, "a boundary element here is no face of the body: " &
                     //"expected faces of the body")
          return
        end if
        call append_items(list%element, [element])
        call append_items(list%face, [face])
      end do
    end associate
  end subroutine add_carrier_faces

end module mpm_surface_builder
