!> The section $Nodes of a gmsh file.
module mpm_gmsh_nodes
  use mpm_gmsh_mesh, only: first_storage, gmsh_mesh_t, grow, grown_size
  use mpm_gmsh_scanner, only: end_line, fail_at_line, fail_at_token, failed, gmsh_scanner_t, &
    & next_count, next_integer, next_line, next_real, number_failure, read_count, rest_of_line
  use mpm_kinds, only: dp
  use mpm_label_table, only: build_label_table
  use mpm_text, only: integer_text
  implicit none
  private
  public :: read_nodes_22, read_nodes_41

contains

  !> $Nodes (2.2): number and coordinates.
  subroutine read_nodes_22(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! nodes are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    integer :: i, n

    call read_count(scanner, n, "the number of nodes")
    call allocate_nodes(raw, n)
    do i = 1, n
      call grow_nodes(raw, i)
      call next_line(scanner, "another node")
      call next_integer(scanner, raw%node_tag(i), "the number of a node")
      call read_coordinates(raw, scanner, i)
      call end_line(scanner, "number, x, y and z of a node")
      if (failed(scanner)) then
        call number_failure(scanner, "the number of a node", node_expected(i, n))
        call number_failure(scanner, "another node", "node "//integer_text(i)//" of " &
                            //integer_text(n))
        return
      end if
    end do
    call check_nodes(raw, scanner)
  end subroutine read_nodes_22

  !> $Nodes (4.1): blocks of numbers, then coordinates.
  subroutine read_nodes_41(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! nodes are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    integer :: n_block, n, first, last, i_block, bound

    call next_line(scanner, "the numbers of blocks and nodes")
    call next_count(scanner, n_block, "the number of blocks of nodes")
    call next_count(scanner, n, "the number of nodes")
    call next_integer(scanner, bound, "the smallest number of a node")
    call next_integer(scanner, bound, "the largest number of a node")
    call end_line(scanner, "four numbers")
    call allocate_nodes(raw, n)
    last = 0
    do i_block = 1, n_block
      first = last + 1
      call read_node_block(raw, scanner, first, last)
      if (failed(scanner)) return
    end do
    if (last < n) call fail_at_line(scanner, scanner%line, "the blocks hold "//integer_text(last) &
      & //" nodes: expected "//integer_text(n)//" as announced")
    call check_nodes(raw, scanner)
  end subroutine read_nodes_41

  !> One block of $Nodes (4.1).
  subroutine read_node_block(raw, scanner, first, last)
    type(gmsh_mesh_t), intent(inout) :: raw        !! nodes first..last are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the block
    integer, intent(in)  :: first                  !! first node of the block
    integer, intent(out) :: last                   !! last node of the block
    character(:), allocatable :: rest
    integer :: parametric, i, n, unused

    last = first - 1
    call next_line(scanner, "a block of nodes")
    call next_integer(scanner, unused, "the dimension of the entity of a block of nodes")
    call next_integer(scanner, unused, "the number of the entity of a block of nodes")
    call next_integer(scanner, parametric, "0 or 1, parametric coordinates")
    call next_count(scanner, n, "the number of nodes in the block")
    if (first - 1 + n > raw%n_node) call fail_at_token(scanner, "more nodes than the " &
      & //integer_text(raw%n_node)//" announced: expected at most " &
      & //integer_text(raw%n_node - first + 1)//" in this block")
    call end_line(scanner, "four numbers")
    if (failed(scanner)) return
    last = first - 1 + n
    do i = first, last
      call grow_nodes(raw, i)
      call next_line(scanner, "the number of a node")
      call next_integer(scanner, raw%node_tag(i), "the number of a node")
      call end_line(scanner, "only the number of a node")
      if (failed(scanner)) then
        call number_failure(scanner, "the number of a node", node_expected(i, raw%n_node))
        return
      end if
    end do
    do i = first, last
      call next_line(scanner, "coordinates of a node")
      call read_coordinates(raw, scanner, i)
      if (parametric == 0) call end_line(scanner, "x, y and z of a node")
      if (parametric /= 0) call rest_of_line(scanner, rest)
      if (failed(scanner)) then
        call number_failure(scanner, "coordinates of a node", "coordinates of node " &
                            //integer_text(raw%node_tag(i)))
        return
      end if
    end do
  end subroutine read_node_block

  !> What is expected where the number of a node should be.
  pure function node_expected(i, n) result(expected)
    integer, intent(in) :: i, n           !! node i of n
    character(:), allocatable :: expected !! for messages

    expected = "the number of node "//integer_text(i)//" of "//integer_text(n)
  end function node_expected

  !> Storage for the first nodes.
  subroutine allocate_nodes(raw, n)
    type(gmsh_mesh_t), intent(inout) :: raw !! node arrays are allocated
    integer, intent(in) :: n                !! nodes

    raw%n_node = n
    associate (n_first => min(n, first_storage))
      allocate (raw%node_tag(n_first), raw%node_line(n_first), source=0)
      allocate (raw%x(3, n_first), source=0.0_dp)
    end associate
  end subroutine allocate_nodes

  !> Makes room for a node. Storage grows with what the file holds, not with what it announces.
  subroutine grow_nodes(raw, i)
    type(gmsh_mesh_t), intent(inout) :: raw !! room for node i, never for more than n_node
    integer, intent(in) :: i                !! node
    real(dp), allocatable :: longer(:, :)
    integer :: n

    if (i <= size(raw%node_tag)) return
    n = grown_size(size(raw%node_tag), raw%n_node)
    call grow(raw%node_tag, n)
    call grow(raw%node_line, n)
    allocate (longer(3, n), source=0.0_dp)
    longer(:, :size(raw%x, 2)) = raw%x
    call move_alloc(longer, raw%x)
  end subroutine grow_nodes

  !> Coordinates of a node.
  subroutine read_coordinates(raw, scanner, i)
    type(gmsh_mesh_t), intent(inout) :: raw        !! coordinates and line are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the numbers
    integer, intent(in) :: i                       !! node
    character(1), parameter :: axis(3) = ["x", "y", "z"]
    integer :: j

    do j = 1, 3
      call next_real(scanner, raw%x(j, i), axis(j)//" of a node")
    end do
    raw%node_line(i) = scanner%line
  end subroutine read_coordinates

  !> Node numbers must be positive and differ.
  subroutine check_nodes(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! nodes are indexed
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    integer :: duplicate

    if (failed(scanner)) return
    call build_label_table(raw%node_table, raw%node_tag, duplicate)
    if (duplicate > 0) call fail_at_line(scanner, raw%node_line(duplicate), "node " &
      & //integer_text(raw%node_tag(duplicate))//" is defined twice: expected every number once")
  end subroutine check_nodes

end module mpm_gmsh_nodes
