!> Where the faces of surfaces lie with respect to the body: on its boundary, inside, or off it.
module mpm_body_faces
  use mpm_material_points, only: points_t
  use mpm_mesh, only: face_set_t, mesh_t
  implicit none
  private
  public :: place_of_face, turn_faces_to_body
  public :: face_on_boundary, face_inside_body, face_off_body

  integer, parameter :: face_on_boundary = 0 !! material on its own side only
  integer, parameter :: face_inside_body = 1 !! material on both sides
  integer, parameter :: face_off_body = 2    !! no material on its own side

contains

  !> Gives the faces between an empty and a filled element to the filled one, so that a pressure on
  !! them acts towards the body. Faces with material on both sides, or on none, stay as they are. A
  !! face that a surface names from both sides is one face.
  pure subroutine turn_faces_to_body(mesh, points)
    type(mesh_t), intent(inout) :: mesh   !! surfaces are turned
    type(points_t), intent(in)  :: points !! initial points, grouped by host

    integer :: e, face, i, k

    do k = 1, size(mesh%surface)
      do i = 1, size(mesh%surface(k)%face)
        e = mesh%surface(k)%element(i)
        face = mesh%surface(k)%face(i)
        if (is_filled(points, e) .or. .not. is_filled(points, mesh%neighbour(face, e))) cycle
        mesh%surface(k)%element(i) = mesh%neighbour(face, e)
        mesh%surface(k)%face(i) = findloc(mesh%neighbour(:, mesh%neighbour(face, e)), e, dim=1)
      end do
      call drop_repeated_faces(mesh%surface(k), mesh%n_dim + 1, mesh%n_el)
    end do
  end subroutine turn_faces_to_body

  !> Leaves the first of equal faces.
  pure subroutine drop_repeated_faces(surface, n_face, n_el)
    type(face_set_t), intent(inout) :: surface !! perhaps fewer faces
    integer, intent(in) :: n_face              !! faces of an element
    integer, intent(in) :: n_el                !! elements of the mesh
    logical, allocatable :: seen(:, :), first(:)
    integer :: i

    allocate (seen(n_face, n_el), source=.false.)
    allocate (first(size(surface%face)))
    do i = 1, size(surface%face)
      associate (e => surface%element(i), face => surface%face(i))
        first(i) = .not. seen(face, e)
        seen(face, e) = .true.
      end associate
    end do
    if (all(first)) return
    surface%element = pack(surface%element, first)
    surface%face = pack(surface%face, first)
  end subroutine drop_repeated_faces

  !> Where a face lies.
  pure integer function place_of_face(mesh, points, element, face) result(place)
    type(mesh_t), intent(in)   :: mesh    !! initial mesh
    type(points_t), intent(in) :: points  !! initial points, grouped by host
    integer, intent(in)        :: element !! element of the face
    integer, intent(in)        :: face    !! local node opposite

    place = face_on_boundary
    if (.not. is_filled(points, element)) then
      place = face_off_body
    else if (is_filled(points, mesh%neighbour(face, element))) then
      place = face_inside_body
    end if
  end function place_of_face

  !> Whether an element holds material points.
  pure logical function is_filled(points, element) result(filled)
    type(points_t), intent(in) :: points  !! grouped by host
    integer, intent(in)        :: element !! element, 0 outside the mesh

    filled = .false.
    if (element > 0) filled = points%first(element + 1) > points%first(element)
  end function is_filled

end module mpm_body_faces
