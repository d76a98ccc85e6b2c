!> Small meshes for the tests of the mesh layer.
module mesh_samples
  use mpm_error, only: error_t
  use mpm_kinds, only: dp
  use mpm_mesh, only: build_geometry, mesh_t
  use mpm_mesh_generator, only: box_settings_t, generate_box, graded_planes
  use mpm_parent_mesh, only: parent_edge, parent_mesh_t
  use mpm_parent_split, only: split_parents
  implicit none
  private
  public :: box_mesh, box_parents, distort, reference_parent

contains

  !> Unit box of n cells per direction.
  subroutine box_parents(parent, n_dim, n, order, split)
    type(parent_mesh_t), intent(out) :: parent !! mesh
    integer, intent(in) :: n_dim               !! 2 or 3
    integer, intent(in) :: n                   !! cells per direction
    integer, intent(in) :: order               !! 1 or 2
    integer, intent(in) :: split               !! simplices per cell

    type(box_settings_t) :: box
    type(error_t), allocatable :: error

    box%n_dim = n_dim
    box%order = order
    box%split = split
    box%x = graded_planes(0.0_dp, 1.0_dp, n, 1.0_dp)
    box%y = box%x
    box%z = box%x
    call generate_box(parent, box, error)
  end subroutine box_parents

  !> The same, split into linear elements.
  subroutine box_mesh(mesh, n_dim, n, order, split)
    type(mesh_t), intent(out) :: mesh !! mesh
    integer, intent(in) :: n_dim      !! 2 or 3
    integer, intent(in) :: n          !! cells per direction
    integer, intent(in) :: order      !! 1 or 2
    integer, intent(in) :: split      !! simplices per cell

    type(parent_mesh_t) :: parent
    type(error_t), allocatable :: error

    call box_parents(parent, n_dim, n, order, split)
    call split_parents(parent, mesh, error)
  end subroutine box_mesh

  !> Moves the nodes inside a unit box smoothly.
  subroutine distort(mesh, amount)
    type(mesh_t), intent(inout) :: mesh !! mesh, out moved
    real(dp), intent(in) :: amount      !! largest displacement [length]

    integer :: a, bad_element, i

    do a = 1, mesh%n_node
      do i = 1, mesh%n_dim
        mesh%x(i, a) = mesh%x(i, a) + amount*16.0_dp**(mesh%n_dim - 1)* &
          product(mesh%x(:, a)*(1.0_dp - mesh%x(:, a)))*cos(real(i, dp) + 5.0_dp*sum(mesh%x(:, a)))
      end do
    end do
    call build_geometry(mesh, bad_element)
  end subroutine distort

  !> One parent on the reference simplex: node labels 10 times the index, element label 17.
  subroutine reference_parent(parent, n_dim, order)
    type(parent_mesh_t), intent(out) :: parent !! mesh
    integer, intent(in) :: n_dim               !! 2 or 3
    integer, intent(in) :: order               !! 1 or 2

    integer :: i, n_edge

    n_edge = 0
    if (order == 2) n_edge = n_dim*(n_dim + 1)/2
    parent%n_dim = n_dim
    parent%order = order
    parent%n_el = 1
    parent%n_node = n_dim + 1 + n_edge
    allocate (parent%x(n_dim, parent%n_node), source=0.0_dp)
    do i = 1, n_dim
      parent%x(i, i + 1) = 1.0_dp
    end do
    do i = 1, n_edge
      parent%x(:, n_dim + 1 + i) = sum(parent%x(:, parent_edge(:, i)), dim=2)/2.0_dp
    end do
    parent%node = reshape([(i, i=1, parent%n_node)], [parent%n_node, 1])
    parent%node_label = [(10*i, i=1, parent%n_node)]
    parent%element_label = [17]
  end subroutine reference_parent

end module mesh_samples
