!> The background mesh of linear simplices: triangles in plane strain or tetrahedra.
module mpm_mesh
  use mpm_face_table, only: build_face_table, corners_of_face, face_table_t, match_faces
  use mpm_index_sort, only: unique_sorted
  use mpm_kinds, only: dp
  use mpm_simplex, only: simplex_gradients
  use mpm_text, only: same_name
  implicit none
  private
  public :: mesh_t, index_set_t, face_set_t
  public :: build_geometry, face_geometry, face_nodes, find_neighbours, surface_nodes
  public :: find_element_set, find_node_set, find_surface

  real(dp), parameter :: flat = 1.0e-14_dp !! least volume over cubed (2-D: squared) longest edge

  !> A named set of nodes or elements.
  type :: index_set_t
    character(:), allocatable :: name !! as written in the deck; compared without case
    integer, allocatable :: item(:)   !! (n) indices, ascending, unique
  end type index_set_t

  !> A named set of element faces.
  type :: face_set_t
    character(:), allocatable :: name  !! as written in the deck; compared without case
    integer, allocatable :: element(:) !! (n) element of each face
    integer, allocatable :: face(:)    !! (n) local face = local number of the node opposite
  end type face_set_t

  !> Linear simplex mesh with everything that location and kinematics need.
  type :: mesh_t
    integer :: n_dim = 0  !! 2 plane strain, 3 solid
    integer :: n_node = 0 !! nodes
    integer :: n_el = 0   !! linear elements (after the split of quadratic parents)
    real(dp), allocatable :: x(:, :)              !! (n_dim, n_node)  coordinates [length]
    integer, allocatable  :: node(:, :)           !! (n_dim+1, n_el)  nodes of an element
    integer, allocatable  :: neighbour(:, :) !! (n_dim+1, n_el)  element behind a face, 0 outside
    real(dp), allocatable :: grad_shape(:, :, :)  !! (n_dim, n_dim+1, n_el)  gradients [1/length]
    real(dp), allocatable :: volume(:)            !! (n_el)  volume (2-D: area) [length^n_dim]
    integer, allocatable  :: parent(:)            !! (n_el)  index of the user's element
    integer, allocatable  :: node_label(:)        !! (n_node)  number of a node in the input
    integer, allocatable  :: parent_label(:)      !! (n_parent)  number of an element in the input
    integer, allocatable  :: parent_child_1(:)    !! (n_parent+1)  first linear element of each
    type(index_set_t), allocatable :: node_set(:)
    type(index_set_t), allocatable :: element_set(:) !! of linear elements
    type(face_set_t), allocatable  :: surface(:)     !! of linear faces
  end type mesh_t

contains

  !> Recomputes gradients and volumes from the coordinates.
  pure subroutine build_geometry(mesh, bad_element)
    type(mesh_t), intent(inout) :: mesh    !! in x and node, out grad_shape and volume
    integer, intent(out) :: bad_element    !! first inverted or flat element, 0 if none

    real(dp) :: longest
    integer :: a, b, e

    if (.not. allocated(mesh%volume)) allocate (mesh%volume(mesh%n_el))
    if (.not. allocated(mesh%grad_shape)) then
      allocate (mesh%grad_shape(mesh%n_dim, mesh%n_dim + 1, mesh%n_el))
    end if
    bad_element = 0
    do e = 1, mesh%n_el
      call simplex_gradients(mesh%x(:, mesh%node(:, e)), mesh%grad_shape(:, :, e), mesh%volume(e))
      if (bad_element > 0) cycle
      longest = 0.0_dp
      do a = 2, mesh%n_dim + 1
        do b = 1, a - 1
          longest = max(longest, sum((mesh%x(:, mesh%node(a, e)) - mesh%x(:, mesh%node(b, e)))**2))
        end do
      end do
      if (mesh%volume(e) <= flat*sqrt(longest)**mesh%n_dim) bad_element = e
    end do
  end subroutine build_geometry

  !> Finds the element behind every face.
  pure subroutine find_neighbours(mesh)
    type(mesh_t), intent(inout) :: mesh !! in node, out neighbour

    type(face_table_t) :: table
    integer :: crowded

    if (.not. allocated(mesh%neighbour)) allocate (mesh%neighbour(mesh%n_dim + 1, mesh%n_el))
    call build_face_table(table, mesh%node, mesh%n_node)
    call match_faces(table, mesh%neighbour, crowded)
  end subroutine find_neighbours

  !> Areas (2-D: lengths) and outward unit normals of faces.
  pure subroutine face_geometry(mesh, faces, area, normal)
    type(mesh_t), intent(in)     :: mesh                !! mesh with gradients and volumes
    type(face_set_t), intent(in) :: faces               !! faces
    real(dp), allocatable, intent(out) :: area(:)       !! (n)         areas [length^(n_dim-1)]
    real(dp), allocatable, intent(out) :: normal(:, :)  !! (n_dim, n)  outward unit normals [-]

    real(dp) :: steepness
    integer :: e, i

    allocate (area(size(faces%element)), normal(mesh%n_dim, size(faces%element)))
    do i = 1, size(faces%element)
      e = faces%element(i)
      normal(:, i) = -mesh%grad_shape(:, faces%face(i), e)
      steepness = sqrt(sum(normal(:, i)**2))
      normal(:, i) = normal(:, i)/steepness
      area(i) = real(mesh%n_dim, dp)*mesh%volume(e)*steepness
    end do
  end subroutine face_geometry

  !> Nodes of one face.
  pure function face_nodes(mesh, element, face) result(node)
    type(mesh_t), intent(in) :: mesh    !! mesh
    integer, intent(in)      :: element !! element
    integer, intent(in)      :: face    !! local node opposite
    integer :: node(mesh%n_dim)         !! (n_dim)  nodes of the face

    node = corners_of_face(mesh%node(:, element), face)
  end function face_nodes

  !> Nodes of a surface.
  pure function surface_nodes(mesh, faces) result(node)
    type(mesh_t), intent(in)     :: mesh  !! mesh
    type(face_set_t), intent(in) :: faces !! faces
    integer, allocatable :: node(:)       !! (n)  nodes, ascending, each once

    integer, allocatable :: corner(:, :)
    integer :: i

    allocate (corner(mesh%n_dim, size(faces%element)))
    do i = 1, size(faces%element)
      corner(:, i) = face_nodes(mesh, faces%element(i), faces%face(i))
    end do
    node = unique_sorted(reshape(corner, [size(corner)]), mesh%n_node)
  end function surface_nodes

  !> Index of a node set, 0 if there is none of that name.
  pure integer function find_node_set(mesh, name) result(found)
    type(mesh_t), intent(in) :: mesh !! mesh
    character(*), intent(in) :: name !! name in any case

    found = 0
    if (allocated(mesh%node_set)) found = find_index_set(mesh%node_set, name)
  end function find_node_set

  !> Index of an element set, 0 if there is none of that name.
  pure integer function find_element_set(mesh, name) result(found)
    type(mesh_t), intent(in) :: mesh !! mesh
    character(*), intent(in) :: name !! name in any case

    found = 0
    if (allocated(mesh%element_set)) found = find_index_set(mesh%element_set, name)
  end function find_element_set

  !> Index of a surface, 0 if there is none of that name.
  pure integer function find_surface(mesh, name) result(found)
    type(mesh_t), intent(in) :: mesh !! mesh
    character(*), intent(in) :: name !! name in any case

    integer :: i

    found = 0
    if (.not. allocated(mesh%surface)) return
    do i = 1, size(mesh%surface)
      if (.not. same_name(mesh%surface(i)%name, name)) cycle
      found = i
      return
    end do
  end function find_surface

  !> Index of a set in a list, 0 if there is none of that name.
  pure integer function find_index_set(set, name) result(found)
    type(index_set_t), intent(in) :: set(:) !! (n)  sets
    character(*), intent(in)      :: name   !!      name in any case

    integer :: i

    found = 0
    do i = 1, size(set)
      if (.not. same_name(set(i)%name, name)) cycle
      found = i
      return
    end do
  end function find_index_set

end module mpm_mesh
