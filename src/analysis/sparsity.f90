!> Pattern of the tangent, the way from its blocks into it, and a colouring of the blocks.
!!
!! F-bar couples all nodes of a patch: the pattern is the union of one dense block per patch, over
!! the nodes of its active elements. Pairs of elements of the ghost penalty are further blocks, each
!! over the nodes of its two elements; they are numbered after the patches.
module mpm_sparsity
  use mpm_csc_matrix, only: allocate_entries, csc_matrix_t
  use mpm_dof_map, only: dof_map_t
  use mpm_kinds, only: dp, ip
  use mpm_mesh, only: mesh_t
  use mpm_nodal_frames, only: nodal_frames_t, rotate_block
  use mpm_patches, only: patches_t
  implicit none
  private
  public :: assembly_map_t, lists_t, build_pattern, pattern_is_current, turn_block

  !> How blocks enter the tangent: block P is patch P, block n_patch + K is pair K of the ghost
  !! penalty. Local equation (a-1)*n_dim + i of a block is component i of its node a. Blocks of a
  !! colour share no node, so they may be assembled at the same time; taking colours in turn makes
  !! every sum independent of the number of threads.
  type :: assembly_map_t
    integer :: n_patch = 0
    integer :: n_block = 0                        !! patches and pairs
    integer :: n_color = 0                        !! colours of patches
    integer :: n_pair_color = 0                   !! colours of pairs
    integer, allocatable :: node_first(:)         !! (n_block+1)  nodes of block P are
                                                  !! node(node_first(P):node_first(P+1)-1)
    integer, allocatable :: node(:)               !! nodes of the active elements of each patch,
                                                  !! then of the two elements of each pair
    integer, allocatable :: element_local(:, :)   !! (n_dim+1, n_el)  number of an element's node
                                                  !! within its patch, 0 if inactive
    integer(ip), allocatable :: position_first(:) !! (n_block+1)  block P is position(
                                                  !! position_first(P):position_first(P+1)-1)
    integer, allocatable :: position(:)           !! place in val of each block entry, column by
                                                  !! column; -1 = leave out
    integer, allocatable :: color_first(:)        !! (n_color+1)  patches of colour c are
                                                  !! color_patch(color_first(c):color_first(c+1)-1)
    integer, allocatable :: color_patch(:)        !! patches with active elements, ascending in
                                                  !! each colour
    integer, allocatable :: pair_color_first(:)   !! (n_pair_color+1)  pairs of colour c are
                                                  !! color_pair(pair_color_first(c):...)
    integer, allocatable :: color_pair(:)         !! pairs, ascending in each colour
    logical, allocatable :: active_element(:)     !! (n_el)  elements that the map was built for
    logical, allocatable :: fixed(:, :)           !! (n_dim, n_node)  constraints likewise
    type(nodal_frames_t) :: frames                !! axes of the nodes, the same in all increments
  end type assembly_map_t

  !> Lists of integers, one after another: list i is item(first(i):first(i+1)-1).
  type :: lists_t
    integer, allocatable :: first(:) !! (n+1)
    integer, allocatable :: item(:)
  end type lists_t

contains

  !> Builds pattern, zero values, map and colours. Too little memory: map%position is unallocated.
  pure subroutine build_pattern(matrix, map, patches, mesh, dofs, active_element, pair_node)
    type(csc_matrix_t), intent(out)   :: matrix  !! pattern, values zero
    type(assembly_map_t), intent(out) :: map     !! from blocks into the matrix
    type(patches_t), intent(in) :: patches       !! patches of elements
    type(mesh_t), intent(in)    :: mesh          !! connectivity
    type(dof_map_t), intent(in) :: dofs          !! equation numbers
    logical, intent(in) :: active_element(:)     !! (n_el)  hosts a point
    type(lists_t), intent(in) :: pair_node       !! nodes of each pair of the ghost penalty
    type(lists_t) :: blocks_of_node, neighbours

    map%n_patch = patches%n
    map%n_block = patches%n + size(pair_node%first) - 1
    map%active_element = active_element
    map%fixed = dofs%fixed
    map%frames = dofs%frames
    call collect_nodes(map, patches, mesh)
    call append_pairs(map, pair_node, mesh%n_dim)
    call invert_lists(blocks_of_node, lists_t(map%node_first, map%node), mesh%n_node)
    call link_nodes(neighbours, map, blocks_of_node)
    call fill_columns(matrix, neighbours, dofs)
    if (.not. allocated(matrix%val)) return
    call place_blocks(map, matrix, neighbours, blocks_of_node, dofs)
    if (.not. allocated(map%position)) return
    call color_blocks(map%color_first, map%color_patch, map, blocks_of_node, [1, map%n_patch])
    map%n_color = size(map%color_first) - 1
    call color_blocks(map%pair_color_first, map%color_pair, map, blocks_of_node, &
                      [map%n_patch + 1, map%n_block])
    map%n_pair_color = size(map%pair_color_first) - 1
  end subroutine build_pattern

  !> Tells whether a map and its pattern still hold for a set of active elements, constraints and
  !! pairs. The same active set may have other pairs: they depend on how full its elements are.
  pure function pattern_is_current(map, active_element, dofs, pair_node) result(is_current)
    type(assembly_map_t), intent(in) :: map      !! map, possibly never built
    logical, intent(in) :: active_element(:)     !! (n_el)  hosts a point
    type(dof_map_t), intent(in) :: dofs          !! equation numbers
    type(lists_t), intent(in) :: pair_node       !! nodes of each pair of the ghost penalty
    logical :: is_current

    is_current = .false.
    if (.not. allocated(map%active_element)) return
    if (size(map%active_element) /= size(active_element)) return
    if (any(shape(map%fixed) /= shape(dofs%fixed))) return
    is_current = all(map%active_element .eqv. active_element) .and. all(map%fixed .eqv. dofs%fixed)
    if (is_current) is_current = has_pairs(map, pair_node)
  end function pattern_is_current

  !> Tells whether the blocks after those of the patches are these pairs, node by node.
  pure function has_pairs(map, pair_node) result(same)
    type(assembly_map_t), intent(in) :: map      !! built
    type(lists_t), intent(in) :: pair_node       !! nodes of each pair of the ghost penalty
    logical :: same

    associate (first => map%node_first(map%n_patch + 1:))
      same = size(first) == size(pair_node%first)
      if (same) same = all(first - first(1) == pair_node%first - pair_node%first(1))
      if (same) same = all(map%node(first(1):) == pair_node%item)
    end associate
  end function has_pairs

  !> Turns the block of a patch into the axes of its nodes. Source: theory.md (19e).
  pure subroutine turn_block(block, map, patch)
    real(dp), intent(inout) :: block(:, :)       !! (n_eq, n_eq)  along the global axes
    type(assembly_map_t), intent(in) :: map
    integer, intent(in) :: patch

    call rotate_block(block, map%frames, &
                      map%node(map%node_first(patch):map%node_first(patch + 1) - 1))
  end subroutine turn_block

  !> Lists the nodes of each patch in the order in which its active elements name them.
  pure subroutine collect_nodes(map, patches, mesh)
    type(assembly_map_t), intent(inout) :: map   !! node lists and local numbers are set
    type(patches_t), intent(in) :: patches       !! patches of elements
    type(mesh_t), intent(in)    :: mesh          !! connectivity
    integer, allocatable :: local(:), node(:)
    integer :: a, e, k, n, patch

    allocate (map%node_first(map%n_block + 1), map%position_first(map%n_block + 1))
    allocate (map%element_local(mesh%n_dim + 1, mesh%n_el), source=0)
    allocate (local(mesh%n_node), source=0)
    allocate (node((mesh%n_dim + 1)*mesh%n_el))
    n = 0
    map%position_first(1) = 1_ip
    do patch = 1, patches%n
      map%node_first(patch) = n + 1
      do k = patches%first(patch), patches%first(patch + 1) - 1
        e = patches%element(k)
        if (.not. map%active_element(e)) cycle
        do a = 1, mesh%n_dim + 1
          if (local(mesh%node(a, e)) == 0) then
            n = n + 1
            node(n) = mesh%node(a, e)
            local(node(n)) = n - map%node_first(patch) + 1
          end if
          map%element_local(a, e) = local(mesh%node(a, e))
        end do
      end do
      local(node(map%node_first(patch):n)) = 0
      map%position_first(patch + 1) = map%position_first(patch) &
                                      + int((n - map%node_first(patch) + 1)*mesh%n_dim, ip)**2
    end do
    map%node_first(patches%n + 1) = n + 1
    map%node = node(:n)
  end subroutine collect_nodes

  !> Adds the blocks of the pairs after those of the patches.
  pure subroutine append_pairs(map, pair_node, n_dim)
    type(assembly_map_t), intent(inout) :: map !! node lists are longer
    type(lists_t), intent(in) :: pair_node     !! nodes of each pair
    integer, intent(in) :: n_dim               !! 2 or 3
    integer :: block, n, pair

    do pair = 1, map%n_block - map%n_patch
      block = map%n_patch + pair
      n = pair_node%first(pair + 1) - pair_node%first(pair)
      map%node_first(block + 1) = map%node_first(block) + n
      map%position_first(block + 1) = map%position_first(block) + int(n*n_dim, ip)**2
    end do
    if (map%n_block > map%n_patch) map%node = [map%node, pair_node%item]
  end subroutine append_pairs

  !> Inverts lists of items: which lists hold item j, in ascending order.
  pure subroutine invert_lists(inverse, lists, n_item)
    type(lists_t), intent(out) :: inverse !! n_item lists
    type(lists_t), intent(in)  :: lists   !! items 1..n_item, none twice in one list
    integer, intent(in) :: n_item         !! number of lists to make
    integer, allocatable :: next(:)
    integer :: i, k

    allocate (inverse%first(n_item + 1), source=0)
    allocate (inverse%item(size(lists%item)))
    do k = 1, size(lists%item)
      inverse%first(lists%item(k) + 1) = inverse%first(lists%item(k) + 1) + 1
    end do
    inverse%first(1) = 1
    do i = 1, n_item
      inverse%first(i + 1) = inverse%first(i) + inverse%first(i + 1)
    end do
    next = inverse%first(:n_item)
    do i = 1, size(lists%first) - 1
      do k = lists%first(i), lists%first(i + 1) - 1
        inverse%item(next(lists%item(k))) = i
        next(lists%item(k)) = next(lists%item(k)) + 1
      end do
    end do
  end subroutine invert_lists

  !> Lists for each node the nodes that share a block with it, itself included, ascending.
  pure subroutine link_nodes(neighbours, map, blocks_of_node)
    type(lists_t), intent(out) :: neighbours     !! one list per node
    type(assembly_map_t), intent(in) :: map      !! nodes of each block
    type(lists_t), intent(in) :: blocks_of_node !! blocks of each node
    type(lists_t) :: unsorted
    integer, allocatable :: seen_by(:)
    integer :: a, b, k, m, n, n_node, sweep

    n_node = size(blocks_of_node%first) - 1
    allocate (unsorted%first(n_node + 1))
    do sweep = 1, 2
      ! The first sweep counts, the second writes.
      n = 0
      seen_by = [(0, a=1, n_node)]
      do a = 1, n_node
        unsorted%first(a) = n + 1
        do k = blocks_of_node%first(a), blocks_of_node%first(a + 1) - 1
          do m = map%node_first(blocks_of_node%item(k)), &
            map%node_first(blocks_of_node%item(k) + 1) - 1
            b = map%node(m)
            if (seen_by(b) == a) cycle
            seen_by(b) = a
            n = n + 1
            if (sweep == 2) unsorted%item(n) = b
          end do
        end do
      end do
      unsorted%first(n_node + 1) = n + 1
      if (sweep == 1) allocate (unsorted%item(n))
    end do
    ! The relation is symmetric, so its inverse is itself, with every list in order.
    call invert_lists(neighbours, unsorted, n_node)
  end subroutine link_nodes

  !> Writes the columns: below each other the equations of the neighbours, which ascend because
  !! equations are numbered node by node.
  pure subroutine fill_columns(matrix, neighbours, dofs)
    type(csc_matrix_t), intent(out) :: matrix !! pattern, values zero; val unallocated: no memory
    type(lists_t), intent(in) :: neighbours   !! neighbours of each node
    type(dof_map_t), intent(in) :: dofs       !! equation numbers
    integer, allocatable :: n_free(:)
    integer :: b, i, j, k, column
    integer(ip) :: n

    n_free = count(dofs%id > 0, dim=1)
    matrix%n = dofs%n
    allocate (matrix%col_ptr(0:dofs%n), source=0_ip)
    do b = 1, size(n_free)
      n = sum(int(n_free(neighbours%item(neighbours%first(b):neighbours%first(b + 1) - 1)), ip))
      do j = 1, size(dofs%id, 1)
        column = dofs%id(j, b)
        if (column > 0) matrix%col_ptr(column) = matrix%col_ptr(column - 1) + n
      end do
    end do
    call allocate_entries(matrix)
    if (.not. allocated(matrix%val)) return
    n = 0_ip
    do b = 1, size(n_free)
      do j = 1, n_free(b)
        do k = neighbours%first(b), neighbours%first(b + 1) - 1
          do i = 1, size(dofs%id, 1)
            if (dofs%id(i, neighbours%item(k)) == 0) cycle
            matrix%row(n) = int(dofs%id(i, neighbours%item(k)) - 1, ip)
            n = n + 1_ip
          end do
        end do
      end do
    end do
  end subroutine fill_columns

  !> Finds the place in `val` of every entry of every block, node column by node column.
  pure subroutine place_blocks(map, matrix, neighbours, blocks_of_node, dofs)
    type(assembly_map_t), intent(inout) :: map   !! position is set, unallocated: no memory
    type(csc_matrix_t), intent(in) :: matrix     !! pattern
    type(lists_t), intent(in) :: neighbours      !! neighbours of each node
    type(lists_t), intent(in) :: blocks_of_node !! blocks of each node
    type(dof_map_t), intent(in) :: dofs          !! equation numbers
    integer, allocatable :: offset(:, :)
    character(80) :: reason
    integer :: b, k, block, status

    if (matrix%nnz > int(huge(1), ip)) return ! such a tangent has no room anywhere
    allocate (map%position(map%position_first(map%n_block + 1) - 1_ip), stat=status, errmsg=reason)
    if (status /= 0) return
    allocate (offset(size(dofs%id, 1), size(dofs%id, 2)), source=-1)
    do b = 1, size(dofs%id, 2)
      call number_rows(offset, neighbours%item(neighbours%first(b):neighbours%first(b + 1) - 1), &
                       dofs)
      do k = blocks_of_node%first(b), blocks_of_node%first(b + 1) - 1
        block = blocks_of_node%item(k)
        call place_node_columns(map%position(map%position_first(block): &
                                             map%position_first(block + 1) - 1_ip), &
                                map%node(map%node_first(block):map%node_first(block + 1) - 1), &
                                b, offset, dofs%id(:, b), matrix)
      end do
    end do
  end subroutine place_blocks

  !> Numbers the rows of a node's columns from 0.
  pure subroutine number_rows(offset, nodes, dofs)
    integer, intent(inout) :: offset(:, :)  !! (n_dim, n_node)  place in the column
    integer, intent(in)    :: nodes(:)      !! neighbours of the node, ascending
    type(dof_map_t), intent(in) :: dofs     !! equation numbers
    integer :: i, k, n

    n = 0
    do k = 1, size(nodes)
      do i = 1, size(offset, 1)
        offset(i, nodes(k)) = -1
        if (dofs%id(i, nodes(k)) == 0) cycle
        offset(i, nodes(k)) = n
        n = n + 1
      end do
    end do
  end subroutine number_rows

  !> Writes the columns of one node in one block.
  pure subroutine place_node_columns(position, nodes, node, offset, equations, matrix)
    integer, intent(inout) :: position(:)      !! ((n_dim*n_nodes)**2)  block by columns
    integer, intent(in) :: nodes(:)            !! nodes of the block
    integer, intent(in) :: node                !! node whose columns are written, one of them
    integer, intent(in) :: offset(:, :)        !! (n_dim, n_node)  place of a row in the columns
    integer, intent(in) :: equations(:)        !! (n_dim)  equations of the node
    type(csc_matrix_t), intent(in) :: matrix   !! pattern
    integer :: a, b, i, j, k, n_dim

    n_dim = size(equations)
    do b = 1, size(nodes)
      if (nodes(b) == node) exit
    end do
    k = (b - 1)*n_dim*n_dim*size(nodes)
    do j = 1, n_dim
      do a = 1, size(nodes)
        do i = 1, n_dim
          k = k + 1
          position(k) = -1
          if (equations(j) == 0 .or. offset(i, nodes(a)) < 0) cycle
          position(k) = int(matrix%col_ptr(equations(j) - 1)) + offset(i, nodes(a))
        end do
      end do
    end do
  end subroutine place_node_columns

  !> Colours a range of blocks greedily, each with the first colour that no neighbour of the
  !! range has.
  pure subroutine color_blocks(color_first, color_item, map, blocks_of_node, range)
    integer, allocatable, intent(out) :: color_first(:) !! (n_color+1)  items of colour c are
                                                        !! color_item(color_first(c):...)
    integer, allocatable, intent(out) :: color_item(:)  !! blocks with nodes, numbered in the range
    type(assembly_map_t), intent(in) :: map             !! nodes of each block
    type(lists_t), intent(in) :: blocks_of_node         !! blocks of each node
    integer, intent(in) :: range(2)                     !! first and last block
    integer, allocatable :: color(:), used_by(:)
    type(lists_t) :: color_of, of_color
    integer :: block, c, i, n

    n = range(2) - range(1) + 1
    allocate (color(map%n_block), source=0)
    allocate (used_by(0:n), source=0)
    do block = range(1), range(2)
      if (map%node_first(block) == map%node_first(block + 1)) cycle
      call mark_colors(used_by, map, blocks_of_node, color, block)
      do c = 1, n
        if (used_by(c) /= block) exit
      end do
      color(block) = c
    end do
    color = color(range(1):range(2))
    color_of%item = pack(color, color > 0)
    allocate (color_of%first(n + 1), source=1)
    do i = 1, n
      color_of%first(i + 1) = color_of%first(i) + merge(1, 0, color(i) > 0)
    end do
    call invert_lists(of_color, color_of, maxval([0, color]))
    call move_alloc(of_color%first, color_first)
    call move_alloc(of_color%item, color_item)
  end subroutine color_blocks

  !> Marks the colours of all blocks that share a node with a block.
  pure subroutine mark_colors(used_by, map, blocks_of_node, color, block)
    integer, intent(inout) :: used_by(0:)         !! (0:n)  the block, at the colours it may not get
    type(assembly_map_t), intent(in) :: map       !! nodes of each block
    type(lists_t), intent(in) :: blocks_of_node   !! blocks of each node
    integer, intent(in) :: color(:)               !! (n_block)  0 = none yet
    integer, intent(in) :: block                  !! the block
    integer :: k, m

    do k = map%node_first(block), map%node_first(block + 1) - 1
      do m = blocks_of_node%first(map%node(k)), blocks_of_node%first(map%node(k) + 1) - 1
        used_by(color(blocks_of_node%item(m))) = block
      end do
    end do
  end subroutine mark_colors

end module mpm_sparsity
