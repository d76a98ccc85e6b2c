!> The surface of a *DSLOAD line: its faces must bound the body.
module mpm_loaded_surface
  use mpm_body_faces, only: face_inside_body, face_off_body, place_of_face
  use mpm_build_context, only: build_context_t, fault, place_t, require_surface
  use mpm_deck_card, only: deck_t, field_text, parameter_choice
  use mpm_diagnostics, only: quoted, warning_at_field
  use mpm_error, only: exit_model
  use mpm_external_force, only: load_t
  use mpm_model, only: model_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: take_surface

contains

  !> Sets the faces of a load and, with CARRIER=POINTS, the surface whose points carry it.
  subroutine take_surface(load, model, deck, context, place)
    type(load_t), intent(inout) :: load             !! card in; item, face and surface out
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors and warnings
    type(place_t), intent(in) :: place              !! the field with the surface
    integer :: found

    call require_surface(context, deck, model%mesh, place, &
                         field_text(deck%card(place%card)%data(place%line), place%field), found)
    if (found == 0) return
    load%item = model%mesh%surface(found)%element
    load%face = model%mesh%surface(found)%face
    if (parameter_choice(deck%card(load%card), "CARRIER", "MESH") == "POINTS") load%surface = found
    if (model%points%n > 0) call check_faces(found, model, deck, context, place)
  end subroutine take_surface

  !> A face without material is an error; faces with material on both sides deserve a warning.
  subroutine check_faces(i_surface, model, deck, context, place)
    integer, intent(in) :: i_surface                !! surface
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors and warnings
    type(place_t), intent(in) :: place              !! the field with the surface
    integer, allocatable :: where_face(:)
    integer :: i

    associate (mesh => model%mesh, faces => model%mesh%surface(i_surface))
      where_face = [(place_of_face(mesh, model%points, faces%element(i), faces%face(i)), &
                     i=1, size(faces%face))]
      do i = 1, size(where_face)
        if (where_face(i) /= face_off_body) cycle
        call fault(context, deck, place, "no material points at a face of element " &
                   //label_of(faces%element(i))//" in surface "//quoted(faces%name) &
                   //": expected faces of the body", code=exit_model)
        return
      end do
      if (all(where_face /= face_inside_body)) return
      i = findloc(where_face, face_inside_body, dim=1)
      call warning_at_field(context%diag, deck, place%card, place%line, place%field, &
                            integer_text(count(where_face == face_inside_body))//" of " &
                            //integer_text(size(where_face))//" faces of surface " &
                            //quoted(faces%name)//" have material on both sides, the first is of " &
                            //"element "//label_of(faces%element(i)) &
                            //": expected faces on the boundary of the body")
    end associate

  contains

    !> Number of an element in the input.
    pure function label_of(element) result(label)
      integer, intent(in) :: element !! linear element
      character(:), allocatable :: label

      label = integer_text(model%mesh%parent_label(model%mesh%parent(element)))
    end function label_of

  end subroutine check_faces

end module mpm_loaded_surface
