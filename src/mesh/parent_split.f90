!> The linear mesh from the mesh of the user: quadratic parents become 4 triangles or 8 tetrahedra.
module mpm_parent_split
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_mesh, only: build_geometry, find_neighbours, mesh_t
  use mpm_parent_checks, only: check_parents
  use mpm_parent_mesh, only: element_text, parent_mesh_t
  use mpm_parent_sets, only: expand_sets
  use mpm_text, only: real_text
  implicit none
  private
  public :: split_parents

  real(dp), parameter :: tie = 1.0e-12_dp !! relative difference of diagonals that are equal

  !> Children of a 6-node triangle: the corners, then the middle.
  integer, parameter :: triangle(3, 4) = reshape( &
    [1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, 4])

  !> Corner children of a 10-node tetrahedron.
  integer, parameter :: corner_tetrahedron(4, 4) = reshape( &
    [1, 5, 7, 8, 5, 2, 6, 9, 7, 6, 3, 10, 8, 9, 10, 4], [4, 4])

  !> Ends of the diagonals of the octahedron, then the other four nodes in a ring around it.
  integer, parameter :: octahedron(6, 3) = reshape( &
    [5, 10, 7, 8, 9, 6, 7, 9, 5, 6, 10, 8, 8, 6, 5, 7, 10, 9], [6, 3])

contains

  !> Splits the parents, expands their sets to linear elements and faces, and completes the mesh.
  !! Faults of the user's mesh come back as model errors that name the element by its label.
  !! Source: formulation, patches and points.
  pure subroutine split_parents(parent, mesh, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh as read or generated
    type(mesh_t), intent(out)       :: mesh          !! linear mesh, complete
    type(error_t), allocatable, intent(out) :: error !! fault of the mesh

    integer :: bad_element, n_child, p

    call check_parents(parent, error)
    if (allocated(error)) return
    n_child = 1
    if (parent%order == 2) n_child = 2**parent%n_dim
    mesh%n_dim = parent%n_dim
    mesh%n_node = parent%n_node
    mesh%n_el = n_child*parent%n_el
    mesh%x = parent%x
    mesh%node_label = parent%node_label
    mesh%parent_label = parent%element_label
    allocate (mesh%node(mesh%n_dim + 1, mesh%n_el), mesh%parent(mesh%n_el))
    allocate (mesh%parent_child_1(parent%n_el + 1))
    mesh%parent_child_1(1) = 1
    do p = 1, parent%n_el
      associate (first => mesh%parent_child_1(p))
        mesh%node(:, first:first + n_child - 1) = children(parent, p, n_child)
        mesh%parent(first:first + n_child - 1) = p
        mesh%parent_child_1(p + 1) = first + n_child
      end associate
    end do
    call build_geometry(mesh, bad_element)
    if (bad_element > 0) then
      call make_error(error, exit_model, element_text(parent, mesh%parent(bad_element))// &
        ": negative volume "//real_text(mesh%volume(bad_element))// &
        " of one of its linear parts: expected mid-edge nodes nearer to the middles of the edges")
      return
    end if
    call find_neighbours(mesh)
    call expand_sets(parent, mesh, error)
  end subroutine split_parents

  !> Nodes of the linear elements that a parent becomes.
  pure function children(parent, p, n_child) result(node)
    type(parent_mesh_t), intent(in) :: parent      !! mesh
    integer, intent(in) :: p                       !! parent
    integer, intent(in) :: n_child                 !! 1, 4 or 8
    integer :: node(parent%n_dim + 1, n_child)     !! (n_dim+1, n_child)  corners first, positive

    integer :: c

    associate (parent_node => parent%node(:, p))
      select case (n_child)
      case (1)
        node(:, 1) = parent_node
      case (4)
        do c = 1, 4
          node(:, c) = parent_node(triangle(:, c))
        end do
      case default
        do c = 1, 4
          node(:, c) = parent_node(corner_tetrahedron(:, c))
        end do
        node(:, 5:) = octahedron_children(parent_node, &
          shortest_diagonal(parent%x(:, parent_node)))
      end select
    end associate
  end function children

  !> The octahedron cut along a diagonal into four tetrahedra around it.
  pure function octahedron_children(parent_node, diagonal) result(node)
    integer, intent(in) :: parent_node(:) !! (10)    nodes of the parent
    integer, intent(in) :: diagonal       !!         column of octahedron
    integer :: node(4, 4)                 !! (4, 4)  nodes of the tetrahedra

    integer :: c, ring(5)

    ring = octahedron([3, 4, 5, 6, 3], diagonal)
    do c = 1, 4
      node(:, c) = parent_node([octahedron(1:2, diagonal), ring(c:c + 1)])
    end do
  end function octahedron_children

  !> The shortest diagonal of the octahedron; of equally long ones the first.
  pure integer function shortest_diagonal(x) result(shortest)
    real(dp), intent(in) :: x(:, :) !! (3, 10)  nodes of the parent [length]

    real(dp) :: length(3)
    integer :: d

    do d = 1, 3
      length(d) = sqrt(sum((x(:, octahedron(1, d)) - x(:, octahedron(2, d)))**2))
    end do
    shortest = findloc(length <= (1.0_dp + tie)*minval(length), .true., dim=1)
  end function shortest_diagonal

end module mpm_parent_split
