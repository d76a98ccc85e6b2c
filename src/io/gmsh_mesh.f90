!> What a gmsh file holds, before it becomes a mesh of simplices.
module mpm_gmsh_mesh
  use mpm_kinds, only: dp
  use mpm_label_table, only: label_table_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: gmsh_mesh_t, gmsh_group_t, gmsh_block_t
  public :: first_storage, max_groups, grow, grow_blocks, grown_size
  public :: type_dimension, type_nodes, type_order, type_name, max_nodes

  integer, parameter :: max_nodes = 10 !! nodes of the largest known element
  integer, parameter :: max_groups = 2000    !! physical groups of a mesh
  integer, parameter :: first_storage = 1024 !! items before storage grows

  !> A physical group: several elements under one name.
  type :: gmsh_group_t
    integer :: dim = 0                !! dimension of its elements
    integer :: tag = 0                !! number in the file
    character(:), allocatable :: name !! as in the file; SURFACE_3 if it has none
    integer :: line = 0               !! where it is named, 0 if it has no name
  end type gmsh_group_t

  !> A run of elements of one geometric entity (4.1) or of one physical group (2.2).
  type :: gmsh_block_t
    integer :: dim = 0                !! dimension
    integer :: tag = 0                !! number of the entity or of the group
    integer :: first = 0              !! first element of the run (entities: unused)
    integer, allocatable :: group(:)  !! numbers of the physical groups
  end type gmsh_block_t

  !> The raw content.
  type :: gmsh_mesh_t
    integer :: version = 0                 !! 22 or 41
    type(gmsh_group_t), allocatable :: group(:)  !! named groups first
    type(gmsh_block_t), allocatable :: entity(:) !! 4.1: $Entities; `first` unused
    type(gmsh_block_t), allocatable :: block(:)  !! runs of elements, in order
    integer :: n_block = 0                 !! runs in use while the elements are read
    integer :: n_node = 0
    integer, allocatable  :: node_tag(:)   !! (n_node)
    integer, allocatable  :: node_line(:)  !! (n_node)     line in the file
    real(dp), allocatable :: x(:, :)       !! (3, n_node)  coordinates [length]
    type(label_table_t)   :: node_table    !! nodes by their tags
    integer :: n_el = 0
    integer, allocatable  :: el_tag(:)     !! (n_el)
    integer, allocatable  :: el_type(:)    !! (n_el)       gmsh type
    integer, allocatable  :: el_line(:)    !! (n_el)       line in the file
    integer, allocatable  :: node(:, :)    !! (max_nodes, n_el)  nodes, order of gmsh
  end type gmsh_mesh_t

contains

  !> The next size of storage that grows geometrically up to a size that was announced.
  pure integer function grown_size(n, most)
    integer, intent(in) :: n    !! size so far
    integer, intent(in) :: most !! largest size

    grown_size = most
    if (n < most/2) grown_size = min(max(2*n, first_storage), most)
  end function grown_size

  !> Makes a list longer; new entries are zero.
  pure subroutine grow(list, n)
    integer, allocatable, intent(inout) :: list(:) !! (n) on return
    integer, intent(in) :: n                       !! new size, not smaller
    integer, allocatable :: longer(:)

    allocate (longer(n), source=0)
    longer(:size(list)) = list
    call move_alloc(longer, list)
  end subroutine grow

  !> Makes room for a block or an entity.
  subroutine grow_blocks(list, i, most)
    type(gmsh_block_t), allocatable, intent(inout) :: list(:) !! room for item i
    integer, intent(in) :: i                                  !! item
    integer, intent(in) :: most                               !! items in the end, at least i
    type(gmsh_block_t), allocatable :: longer(:)
    integer :: j

    if (i <= size(list)) return
    allocate (longer(grown_size(size(list), most)))
    do j = 1, size(list)
      longer(j)%dim = list(j)%dim
      longer(j)%tag = list(j)%tag
      longer(j)%first = list(j)%first
      call move_alloc(list(j)%group, longer(j)%group)
    end do
    call move_alloc(longer, list)
  end subroutine grow_blocks

  !> Dimension of a gmsh element type that we know, -1 for others.
  pure integer function type_dimension(el_type) result(n_dim)
    integer, intent(in) :: el_type !! gmsh type

    select case (el_type)
    case (15)
      n_dim = 0
    case (1, 8)
      n_dim = 1
    case (2, 9)
      n_dim = 2
    case (4, 11)
      n_dim = 3
    case default
      n_dim = -1
    end select
  end function type_dimension

  !> Order of a gmsh element type: 1 or 2.
  pure integer function type_order(el_type) result(order)
    integer, intent(in) :: el_type !! gmsh type that we know

    order = merge(2, 1, el_type == 8 .or. el_type == 9 .or. el_type == 11)
  end function type_order

  !> Nodes of a gmsh element type that we know.
  pure integer function type_nodes(el_type) result(n_node)
    integer, intent(in) :: el_type !! gmsh type
    integer :: n_corner

    n_corner = type_dimension(el_type) + 1
    n_node = n_corner
    if (type_order(el_type) == 2) n_node = n_corner + n_corner*(n_corner - 1)/2
  end function type_nodes

  !> Name of a gmsh element type in words.
  pure function type_name(el_type) result(name)
    integer, intent(in) :: el_type    !! gmsh type
    character(:), allocatable :: name !! such as 10-node tetrahedron

    select case (el_type)
    case (1, 8)
      name = integer_text(type_nodes(el_type))//"-node line"
    case (2, 9)
      name = integer_text(type_nodes(el_type))//"-node triangle"
    case (4, 11)
      name = integer_text(type_nodes(el_type))//"-node tetrahedron"
    case (15)
      name = "point"
    case (3, 10, 16)
      name = "quadrangle"
    case (5, 12, 17)
      name = "hexahedron"
    case (6, 13, 18)
      name = "prism"
    case (7, 14, 19)
      name = "pyramid"
    case default
      name = "unknown element"
    end select
    name = name//" (gmsh type "//integer_text(el_type)//")"
  end function type_name

end module mpm_gmsh_mesh
