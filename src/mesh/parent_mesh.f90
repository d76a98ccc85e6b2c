!> The mesh as the user gives it: linear or quadratic simplices, surface carriers and sets.
module mpm_parent_mesh
  use mpm_kinds, only: dp
  use mpm_mesh, only: face_set_t, index_set_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: parent_mesh_t, element_text, node_text, parent_edge

  !> Corners of the edges in the order of the mid-edge nodes; a triangle has the first three.
  integer, parameter :: parent_edge(2, 6) = reshape([1, 2, 2, 3, 3, 1, 1, 4, 2, 4, 3, 4], [2, 6])

  !> Node order of a parent: corners first, then mid-edge nodes in the order of Abaqus:
  !! CPE6 (1,2) (2,3) (3,1); C3D10 (1,2) (2,3) (3,1) (1,4) (2,4) (3,4).
  type :: parent_mesh_t
    integer :: n_dim = 0   !! 2 or 3
    integer :: order = 0   !! 1 linear, 2 quadratic
    integer :: n_node = 0
    integer :: n_el = 0
    real(dp), allocatable :: x(:, :)         !! (n_dim, n_node)   coordinates [length]
    integer, allocatable  :: node(:, :)      !! (n_en, n_el)      n_en = 3, 6, 4 or 10
    integer, allocatable  :: node_label(:)   !! (n_node)          number in the input
    integer, allocatable  :: element_label(:) !! (n_el)           number in the input
    integer, allocatable  :: carrier(:, :)   !! (n_dim, n_carrier) corners of surface carriers
    type(index_set_t), allocatable :: node_set(:)    !! of nodes
    type(index_set_t), allocatable :: element_set(:) !! of parents
    type(index_set_t), allocatable :: carrier_set(:) !! of carriers
    type(face_set_t), allocatable  :: surface(:)     !! of parent faces (local face = node opposite)
  end type parent_mesh_t

contains

  !> An element as messages call it: "element" and its number in the input.
  pure function element_text(parent, element) result(text)
    type(parent_mesh_t), intent(in) :: parent !! mesh
    integer, intent(in) :: element            !! index of the element
    character(:), allocatable :: text         !! such as "element 17"

    text = "element "//integer_text(parent%element_label(element))
  end function element_text

  !> A node as messages call it: "node" and its number in the input.
  pure function node_text(parent, node) result(text)
    type(parent_mesh_t), intent(in) :: parent !! mesh
    integer, intent(in) :: node               !! index of the node
    character(:), allocatable :: text         !! such as "node 4"

    text = "node "//integer_text(parent%node_label(node))
  end function node_text

end module mpm_parent_mesh
