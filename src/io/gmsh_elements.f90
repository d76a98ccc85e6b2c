!> The section $Elements of a gmsh file.
module mpm_gmsh_elements
  use mpm_gmsh_mesh, only: first_storage, gmsh_block_t, gmsh_mesh_t, grow, grow_blocks, &
    & grown_size, max_nodes, type_dimension, type_name, type_nodes
  use mpm_gmsh_scanner, only: end_line, fail_at_line, fail_at_token, failed, gmsh_scanner_t, &
    & next_count, next_integer, next_line, number_failure, read_count
  use mpm_label_table, only: build_label_table, find_label, label_table_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: read_elements_22, read_elements_41

contains

  !> $Elements (2.2): number, type, tags, nodes.
  subroutine read_elements_22(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! elements are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    integer :: n, i, j, n_tag, tag, physical

    call read_count(scanner, n, "the number of elements")
    call allocate_elements(raw, n)
    do i = 1, n
      call grow_elements(raw, i)
      call next_line(scanner, "the number of an element")
      call next_integer(scanner, raw%el_tag(i), "the number of an element")
      call next_integer(scanner, raw%el_type(i), "the type of an element")
      call check_type(scanner, raw%el_type(i))
      call next_count(scanner, n_tag, "the number of tags of an element")
      physical = 0
      do j = 1, n_tag
        call next_integer(scanner, tag, "a tag of an element")
        if (j == 1) physical = abs(tag)
      end do
      call read_element_nodes(raw, scanner, i)
      if (failed(scanner)) then
        call number_failure(scanner, "the number of an element", element_expected(i, n))
        return
      end if
      call note_block(raw, i, type_dimension(raw%el_type(i)), physical)
    end do
    raw%block = raw%block(:raw%n_block)
    call check_elements(raw, scanner)
  end subroutine read_elements_22

  !> Begins a new block when dimension or physical group change (2.2).
  subroutine note_block(raw, i, dim, physical)
    type(gmsh_mesh_t), intent(inout) :: raw !! blocks
    integer, intent(in) :: i                !! element
    integer, intent(in) :: dim              !! its dimension
    integer, intent(in) :: physical         !! its group, 0 if none

    associate (n => raw%n_block)
      if (n > 0) then
        if (raw%block(n)%dim == dim .and. raw%block(n)%tag == physical) return
      end if
      n = n + 1
      call grow_blocks(raw%block, n, raw%n_el)
      raw%block(n) = gmsh_block_t(dim, physical, i)
      raw%block(n)%group = pack([physical], [physical > 0])
    end associate
  end subroutine note_block

  !> $Elements (4.1): blocks of elements of one entity and type.
  subroutine read_elements_41(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! elements are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    integer :: n_block, n, i_block, first, last, bound

    call next_line(scanner, "the numbers of blocks and elements")
    call next_count(scanner, n_block, "the number of blocks of elements")
    call next_count(scanner, n, "the number of elements")
    call next_integer(scanner, bound, "the smallest number of an element")
    call next_integer(scanner, bound, "the largest number of an element")
    call end_line(scanner, "four numbers")
    call allocate_elements(raw, n)
    last = 0
    do i_block = 1, n_block
      first = last + 1
      call grow_blocks(raw%block, i_block, n_block)
      call read_element_block(raw, scanner, raw%block(i_block), first, last)
      if (failed(scanner)) return
    end do
    if (last < n) call fail_at_line(scanner, scanner%line, "the blocks hold "//integer_text(last) &
      & //" elements: expected "//integer_text(n)//" as announced")
    call check_elements(raw, scanner)
  end subroutine read_elements_41

  !> One block of $Elements (4.1).
  subroutine read_element_block(raw, scanner, block, first, last)
    type(gmsh_mesh_t), intent(inout) :: raw        !! elements first..last are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the block
    type(gmsh_block_t), intent(out) :: block       !! entity and groups of the block
    integer, intent(in)  :: first                  !! first element of the block
    integer, intent(out) :: last                   !! last element of the block
    integer :: el_type, i, n

    last = first - 1
    block%first = first
    call next_line(scanner, "a block of elements")
    call next_integer(scanner, block%dim, "the dimension of the entity of a block of elements")
    call next_integer(scanner, block%tag, "the number of the entity of a block of elements")
    block%group = groups_of_entity(raw, block%dim, block%tag)
    call next_integer(scanner, el_type, "the type of the elements in the block")
    call check_type(scanner, el_type)
    if (.not. failed(scanner) .and. type_dimension(el_type) /= block%dim) &
      call fail_at_token(scanner, type_name(el_type)//" in an entity of dimension " &
                         //integer_text(block%dim)//": expected elements of this dimension")
    call next_count(scanner, n, "the number of elements in the block")
    if (first - 1 + n > raw%n_el) call fail_at_token(scanner, "more elements than the " &
      & //integer_text(raw%n_el)//" announced: expected at most " &
      & //integer_text(raw%n_el - first + 1)//" in this block")
    call end_line(scanner, "four numbers")
    if (failed(scanner)) return
    last = first - 1 + n
    do i = first, last
      call grow_elements(raw, i)
      raw%el_type(i) = el_type
      call next_line(scanner, "the number of an element")
      call next_integer(scanner, raw%el_tag(i), "the number of an element")
      call read_element_nodes(raw, scanner, i)
      if (failed(scanner)) then
        call number_failure(scanner, "the number of an element", element_expected(i, raw%n_el))
        return
      end if
    end do
  end subroutine read_element_block

  !> Physical groups of an entity; none when the file does not list it.
  pure function groups_of_entity(raw, dim, tag) result(group)
    type(gmsh_mesh_t), intent(in) :: raw !! with entities
    integer, intent(in) :: dim, tag      !! dimension and number of the entity
    integer, allocatable :: group(:)     !! (n) numbers of groups
    integer :: i

    do i = 1, size(raw%entity)
      if (raw%entity(i)%dim == dim .and. raw%entity(i)%tag == tag) then
        group = raw%entity(i)%group
        return
      end if
    end do
    allocate (group(0))
  end function groups_of_entity

  !> What is expected where the number of an element should be.
  pure function element_expected(i, n) result(expected)
    integer, intent(in) :: i, n           !! element i of n
    character(:), allocatable :: expected !! for messages

    expected = "the number of element "//integer_text(i)//" of "//integer_text(n)
  end function element_expected

  !> Storage for the first elements.
  subroutine allocate_elements(raw, n)
    type(gmsh_mesh_t), intent(inout) :: raw !! element arrays are allocated
    integer, intent(in) :: n                !! elements

    raw%n_el = n
    associate (n_first => min(n, first_storage))
      allocate (raw%el_tag(n_first), raw%el_type(n_first), raw%el_line(n_first), source=0)
      allocate (raw%node(max_nodes, n_first), source=0)
    end associate
  end subroutine allocate_elements

  !> Makes room for an element. Storage grows with what the file holds, not with what it announces.
  subroutine grow_elements(raw, i)
    type(gmsh_mesh_t), intent(inout) :: raw !! room for element i, never for more than n_el
    integer, intent(in) :: i                !! element
    integer, allocatable :: longer(:, :)
    integer :: n

    if (i <= size(raw%el_tag)) return
    n = grown_size(size(raw%el_tag), raw%n_el)
    call grow(raw%el_tag, n)
    call grow(raw%el_type, n)
    call grow(raw%el_line, n)
    allocate (longer(max_nodes, n), source=0)
    longer(:, :size(raw%node, 2)) = raw%node
    call move_alloc(longer, raw%node)
  end subroutine grow_elements

  !> Only simplices of order 1 and 2 are known.
  subroutine check_type(scanner, el_type)
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the type
    integer, intent(in) :: el_type                 !! gmsh type

    if (failed(scanner)) return
    if (type_dimension(el_type) < 0) call fail_at_token(scanner, type_name(el_type) &
      & //" cannot be used: expected lines, triangles, tetrahedra or points " &
      & //"(gmsh types 1, 2, 4, 8, 9, 11, 15)")
  end subroutine check_type

  !> Nodes of an element: all must exist.
  subroutine read_element_nodes(raw, scanner, i)
    type(gmsh_mesh_t), intent(inout) :: raw        !! nodes and line of the element are set
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the next line afterwards
    integer, intent(in) :: i                       !! element
    integer :: j, n, tag

    n = type_nodes(raw%el_type(i))
    do j = 1, n
      call next_integer(scanner, tag, "a node of the element")
      if (failed(scanner)) return
      raw%node(j, i) = find_label(raw%node_table, tag)
      if (raw%node(j, i) == 0) then
        call fail_at_token(scanner, "node "//integer_text(tag)//" does not exist: expected a " &
                           //"node of $Nodes")
        return
      end if
    end do
    raw%el_line(i) = scanner%line
    call end_line(scanner, "no more nodes")
    if (failed(scanner)) call number_failure(scanner, "no more nodes", integer_text(n) &
      & //" nodes of a "//type_name(raw%el_type(i)))
  end subroutine read_element_nodes

  !> Element numbers must differ.
  subroutine check_elements(raw, scanner)
    type(gmsh_mesh_t), intent(in) :: raw           !! with elements
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    type(label_table_t) :: table
    integer :: duplicate

    if (failed(scanner)) return
    call build_label_table(table, raw%el_tag, duplicate)
    if (duplicate > 0) call fail_at_line(scanner, raw%el_line(duplicate), "element " &
      & //integer_text(raw%el_tag(duplicate))//" is defined twice: expected every number once")
  end subroutine check_elements

end module mpm_gmsh_elements
