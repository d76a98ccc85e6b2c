!> Reads a gmsh mesh of simplices, formats 2.2 and 4.1 ASCII; physical groups become sets.
module mpm_gmsh_reader
  use mpm_diagnostics, only: diagnostics_t, error_in_file
  use mpm_gmsh_mesh, only: gmsh_group_t, gmsh_mesh_t, max_groups, type_dimension, &
    & type_name, type_nodes, type_order
  use mpm_gmsh_scanner, only: fail_at_line, failed, gmsh_scanner_t, line_text, load_text
  use mpm_gmsh_sections, only: read_sections
  use mpm_mesh, only: index_set_t
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: read_gmsh

  !> Where the elements of the file went.
  type :: element_map_t
    integer, allocatable :: new(:)  !! (n_el in the file) element or carrier, 0 = dropped
    integer :: n_el = 0            !! elements of the body
    integer :: n_carrier = 0       !! surface carriers
    integer, allocatable :: node(:) !! (n_node in the file) index of the node, 0 if dropped
    logical, allocatable :: grouped(:) !! (n_el in the file) in a physical group
  end type element_map_t

contains

  !> Reads a mesh. Tetrahedra make a 3-D mesh, triangles without tetrahedra a plane one. Groups of
  !! the body become sets of elements, groups one dimension below carrier sets; every group also
  !! becomes a set of its nodes. Nodes that belong to no element of the body are dropped.
  subroutine read_gmsh(parent, path, diag)
    type(parent_mesh_t), intent(out) :: parent    !! mesh; incomplete after an error
    character(*), intent(in) :: path              !! file
    type(diagnostics_t), intent(inout) :: diag    !! gets at most one error more
    type(gmsh_scanner_t) :: scanner
    type(gmsh_mesh_t) :: raw

    call load_text(scanner, path)
    if (.not. failed(scanner)) call read_sections(raw, scanner)
    if (.not. failed(scanner)) call convert(parent, raw, scanner)
    if (failed(scanner)) call error_in_file(diag, path, scanner%error_line, scanner%error_column, &
                                            line_text(scanner, scanner%error_line), scanner%message)
  end subroutine read_gmsh

  !> Turns the content of the file into a mesh.
  subroutine convert(parent, raw, scanner)
    type(parent_mesh_t), intent(out) :: parent     !! mesh; incomplete after a failure
    type(gmsh_mesh_t), intent(inout) :: raw        !! content; unnamed groups are added
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    type(element_map_t) :: map

    call choose_kind(parent, raw, scanner)
    if (failed(scanner)) return
    call map_elements(map, parent, raw)
    call check_plane(parent, raw, map, scanner)
    call check_carriers(parent, raw, map, scanner)
    if (failed(scanner)) return
    call fill_mesh(parent, raw, map)
    call add_unnamed_groups(raw, scanner)
    if (failed(scanner)) return
    call fill_sets(parent, raw, map)
  end subroutine convert

  !> Dimension and order of the mesh; all elements must be of one order.
  subroutine choose_kind(parent, raw, scanner)
    type(parent_mesh_t), intent(inout) :: parent   !! n_dim and order are set
    type(gmsh_mesh_t), intent(in) :: raw           !! content
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    integer :: i, i_first

    i_first = 0
    do i = 1, raw%n_el
      if (i_first > 0) then
        if (type_dimension(raw%el_type(i)) <= parent%n_dim) cycle
      end if
      parent%n_dim = type_dimension(raw%el_type(i))
      i_first = i
    end do
    if (parent%n_dim < 2) then
      call fail_at_line(scanner, 0, "the mesh holds no triangles and no tetrahedra: expected " &
                        //"elements of gmsh type 2, 4, 9 or 11")
      return
    end if
    parent%order = type_order(raw%el_type(i_first))
    do i = 1, raw%n_el
      if (raw%el_type(i) == 15 .or. type_dimension(raw%el_type(i)) < parent%n_dim - 1) cycle
      if (type_order(raw%el_type(i)) /= parent%order) then
        call fail_at_line(scanner, raw%el_line(i), "element "//integer_text(raw%el_tag(i)) &
          & //" is a "//type_name(raw%el_type(i))//" in a mesh of "//trim(merge("linear   ", &
          & "quadratic", parent%order == 1))//" elements: expected elements of one order")
        return
      end if
    end do
  end subroutine choose_kind

  !> Numbers elements, carriers and nodes anew. An element that is written once per group (2.2) is
  !! one element.
  subroutine map_elements(map, parent, raw)
    type(element_map_t), intent(out) :: map     !! new numbers
    type(parent_mesh_t), intent(in)  :: parent  !! with n_dim
    type(gmsh_mesh_t), intent(in)    :: raw     !! content
    logical, allocatable :: used(:)
    integer :: i, dim
    logical :: again

    allocate (map%new(raw%n_el), map%node(raw%n_node), source=0)
    allocate (used(raw%n_node), map%grouped(raw%n_el), source=.false.)
    do i = 1, size(raw%block)
      map%grouped(raw%block(i)%first:block_end(raw, i)) = size(raw%block(i)%group) > 0
    end do
    do i = 1, raw%n_el
      dim = type_dimension(raw%el_type(i))
      again = .false.
      if (i > 1) again = raw%el_type(i) == raw%el_type(i - 1) .and. &
                         all(raw%node(:, i) == raw%node(:, i - 1))
      if (again) then
        map%new(i) = map%new(i - 1)
      else if (dim == parent%n_dim) then
        map%n_el = map%n_el + 1
        map%new(i) = map%n_el
        used(raw%node(:type_nodes(raw%el_type(i)), i)) = .true.
      else if (dim == parent%n_dim - 1 .and. map%grouped(i)) then
        map%n_carrier = map%n_carrier + 1
        map%new(i) = map%n_carrier
      end if
    end do
    dim = 0
    do i = 1, raw%n_node
      if (.not. used(i)) cycle
      dim = dim + 1
      map%node(i) = dim
    end do
  end subroutine map_elements

  !> A mesh of triangles must lie in the plane z = 0.
  subroutine check_plane(parent, raw, map, scanner)
    type(parent_mesh_t), intent(in)  :: parent     !! with n_dim
    type(gmsh_mesh_t), intent(in)    :: raw        !! content
    type(element_map_t), intent(in)  :: map        !! new numbers
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    integer :: i

    if (parent%n_dim == 3) return
    do i = 1, raw%n_node
      if (map%node(i) == 0 .or. abs(raw%x(3, i)) <= tiny(raw%x)) cycle
      call fail_at_line(scanner, raw%node_line(i), "node "//integer_text(raw%node_tag(i)) &
        & //" of a mesh of triangles has z = "//real_text(raw%x(3, i))//": expected z = 0, or " &
        & //"tetrahedra")
      return
    end do
  end subroutine check_plane

  !> A carrier must hang on the body.
  subroutine check_carriers(parent, raw, map, scanner)
    type(parent_mesh_t), intent(in)  :: parent     !! with n_dim
    type(gmsh_mesh_t), intent(in)    :: raw        !! content
    type(element_map_t), intent(in)  :: map        !! new numbers
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    integer :: i, j

    do i = 1, raw%n_el
      if (map%new(i) == 0 .or. type_dimension(raw%el_type(i)) == parent%n_dim) cycle
      do j = 1, type_nodes(raw%el_type(i))
        if (map%node(raw%node(j, i)) > 0) cycle
        call fail_at_line(scanner, raw%el_line(i), "element "//integer_text(raw%el_tag(i)) &
          & //" of a boundary group uses node "//integer_text(raw%node_tag(raw%node(j, i))) &
          & //", which no "//trim(merge("triangle   ", "tetrahedron", parent%n_dim == 2)) &
          & //" uses: expected boundaries that consist of faces of the body")
        return
      end do
    end do
  end subroutine check_carriers

  !> Last element of a block.
  pure integer function block_end(raw, i_block) result(last)
    type(gmsh_mesh_t), intent(in) :: raw !! content
    integer, intent(in) :: i_block       !! block

    last = raw%n_el
    if (i_block < size(raw%block)) last = raw%block(i_block + 1)%first - 1
  end function block_end

  !> Nodes, elements and carriers. Our order of the mid-edge nodes of a tetrahedron differs from
  !! that of gmsh in the last two.
  subroutine fill_mesh(parent, raw, map)
    type(parent_mesh_t), intent(inout) :: parent !! n_dim and order in, everything but sets out
    type(gmsh_mesh_t), intent(in)   :: raw       !! content
    type(element_map_t), intent(in) :: map       !! new numbers
    integer :: i, dim, n

    parent%n_node = maxval([0, map%node])
    parent%n_el = map%n_el
    n = merge(parent%n_dim + 1, (parent%n_dim + 1)*(parent%n_dim + 2)/2, parent%order == 1)
    allocate (parent%x(parent%n_dim, parent%n_node), parent%node_label(parent%n_node))
    allocate (parent%node(n, map%n_el), parent%element_label(map%n_el))
    allocate (parent%carrier(parent%n_dim, map%n_carrier))
    do i = 1, raw%n_node
      if (map%node(i) == 0) cycle
      parent%x(:, map%node(i)) = raw%x(:parent%n_dim, i)
      parent%node_label(map%node(i)) = raw%node_tag(i)
    end do
    do i = raw%n_el, 1, -1
      dim = type_dimension(raw%el_type(i))
      if (dim == parent%n_dim) then
        parent%element_label(map%new(i)) = raw%el_tag(i)
        parent%node(:, map%new(i)) = map%node(raw%node(:n, i))
        if (n == 10) parent%node(9:10, map%new(i)) = map%node(raw%node([10, 9], i))
      else if (map%new(i) > 0) then
        parent%carrier(:, map%new(i)) = map%node(raw%node(:parent%n_dim, i))
      end if
    end do
  end subroutine fill_mesh

  !> Groups without a name get one: POINT_4, CURVE_3, SURFACE_2, VOLUME_1.
  subroutine add_unnamed_groups(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! groups are added
    type(gmsh_scanner_t), intent(inout) :: scanner !! takes the failure
    character(7), parameter :: kind(0:3) = ["POINT  ", "CURVE  ", "SURFACE", "VOLUME "]
    integer :: i_block, i, dim, tag

    do i_block = 1, size(raw%block)
      dim = raw%block(i_block)%dim
      do i = 1, size(raw%block(i_block)%group)
        tag = raw%block(i_block)%group(i)
        if (any(raw%group%dim == dim .and. raw%group%tag == tag)) cycle
        if (size(raw%group) >= max_groups) then
          call fail_at_line(scanner, 0, "too many physical groups: expected at most " &
                            //integer_text(max_groups))
          return
        end if
        raw%group = [raw%group, gmsh_group_t(dim, tag, trim(kind(dim))//"_"//integer_text(tag))]
      end do
    end do
  end subroutine add_unnamed_groups

  !> Sets of every group.
  subroutine fill_sets(parent, raw, map)
    type(parent_mesh_t), intent(inout) :: parent !! sets are added
    type(gmsh_mesh_t), intent(in)   :: raw       !! content
    type(element_map_t), intent(in) :: map       !! new numbers
    logical, allocatable :: in_set(:), has_node(:)
    integer :: i_group, i_block, i

    allocate (parent%node_set(0), parent%element_set(0), parent%carrier_set(0), parent%surface(0))
    do i_group = 1, size(raw%group)
      associate (group => raw%group(i_group))
        allocate (has_node(parent%n_node), in_set(max(map%n_el, map%n_carrier)), source=.false.)
        do i_block = 1, size(raw%block)
          if (raw%block(i_block)%dim /= group%dim) cycle
          if (all(raw%block(i_block)%group /= group%tag)) cycle
          do i = raw%block(i_block)%first, block_end(raw, i_block)
            if (map%new(i) > 0) in_set(map%new(i)) = .true.
            call mark_nodes(has_node, raw, map, i)
          end do
        end do
        call append_set(parent%node_set, group%name, has_node)
        if (group%dim == parent%n_dim) call append_set(parent%element_set, group%name, in_set)
        if (group%dim == parent%n_dim - 1) call append_set(parent%carrier_set, group%name, in_set)
        deallocate (has_node, in_set)
      end associate
    end do
  end subroutine fill_sets

  !> Marks the nodes of an element.
  subroutine mark_nodes(has_node, raw, map, i)
    logical, intent(inout) :: has_node(:)   !! (n_node) in the set
    type(gmsh_mesh_t), intent(in)   :: raw  !! content
    type(element_map_t), intent(in) :: map  !! new numbers
    integer, intent(in) :: i                !! element of the file
    integer :: j, node

    do j = 1, type_nodes(raw%el_type(i))
      node = map%node(raw%node(j, i))
      if (node > 0) has_node(node) = .true.
    end do
  end subroutine mark_nodes

  !> Appends a set of the items that are marked.
  subroutine append_set(set, name, marked)
    type(index_set_t), allocatable, intent(inout) :: set(:) !! one set more
    character(*), intent(in) :: name                        !! its name
    logical, intent(in) :: marked(:)                        !! (n) items
    type(index_set_t), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(set) + 1))
    do i = 1, size(set)
      call move_alloc(set(i)%name, longer(i)%name)
      call move_alloc(set(i)%item, longer(i)%item)
    end do
    longer(size(longer))%name = name
    longer(size(longer))%item = pack([(i, i=1, size(marked))], marked)
    call move_alloc(longer, set)
  end subroutine append_set

end module mpm_gmsh_reader
