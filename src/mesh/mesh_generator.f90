!> Graded boxes of simplices, 2-D and 3-D, linear or quadratic.
module mpm_mesh_generator
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_index_sort, only: sort_columns, sorted_small
  use mpm_kinds, only: dp
  use mpm_parent_mesh, only: parent_edge, parent_mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: box_settings_t, generate_box, graded_planes

  !> A box cut into cells by planes, and the cells into simplices.
  type :: box_settings_t
    integer :: n_dim = 3                    !! 2 or 3
    integer :: order = 1                    !! 1 linear, 2 quadratic
    integer :: split = 6                    !! simplices per cell: 2 or 4 (cross); 5 or 6
    integer :: orientation = 1              !! 1 or 2: way the first cell is cut (split 2, 5)
    real(dp), allocatable :: x(:)           !! (n_x+1)  planes, ascending [length]
    real(dp), allocatable :: y(:)           !! (n_y+1)  planes, ascending [length]
    real(dp), allocatable :: z(:)           !! (n_z+1)  planes, ascending; 3-D only [length]
    character(:), allocatable :: elset      !! name of the set of all elements, ALL if unallocated
  end type box_settings_t

  !> Corners of a cell are numbered 1 + i + 2 j + 4 k. A cell has two diagonals to cut along.
  integer, parameter :: two_triangles(3, 2, 2) = reshape( &
    [1, 2, 4, 1, 4, 3, 1, 2, 3, 2, 4, 3], [3, 2, 2])
  !> Four triangles around the middle of the cell, node 5.
  integer, parameter :: cross(3, 4) = reshape( &
    [1, 2, 5, 2, 4, 5, 4, 3, 5, 3, 1, 5], [3, 4])
  !> Four tetrahedra at every second corner and one between them, two ways.
  integer, parameter :: five_tetrahedra(4, 5, 2) = reshape( &
    [2, 4, 1, 6, 3, 1, 4, 7, 5, 6, 1, 7, 8, 4, 6, 7, 1, 4, 7, 6, &
     1, 2, 3, 5, 4, 3, 2, 8, 6, 5, 8, 2, 7, 8, 5, 3, 2, 3, 5, 8], [4, 5, 2])
  !> Kuhn's six tetrahedra around the diagonal from the first to the last corner.
  integer, parameter :: six_tetrahedra(4, 6) = reshape( &
    [1, 2, 4, 8, 1, 6, 2, 8, 1, 4, 3, 8, 1, 3, 7, 8, 1, 5, 6, 8, 1, 7, 5, 8], [4, 6])

contains

  !> Planes of a direction whose cells grow geometrically.
  pure function graded_planes(start, end, n, ratio) result(plane)
    real(dp), intent(in) :: start !! first plane [length]
    real(dp), intent(in) :: end   !! last plane [length]
    integer, intent(in)  :: n     !! cells, at least 1
    real(dp), intent(in) :: ratio !! size of the last cell over that of the first, positive [-]
    real(dp) :: plane(n + 1)      !! (n+1)  planes [length]

    real(dp) :: cell(n)
    integer :: i

    cell = 1.0_dp
    if (n > 1) cell = [(ratio**(real(i - 1, dp)/real(n - 1, dp)), i=1, n)]
    plane(1) = start
    do i = 1, n - 1
      plane(i + 1) = start + (end - start)*sum(cell(:i))/sum(cell)
    end do
    plane(n + 1) = end
  end function graded_planes

  !> Generates the box with node sets and carrier sets X0, X1, Y0, Y1 (and Z0, Z1) on its faces and
  !! a set of all elements.
  pure subroutine generate_box(parent, box, error)
    type(parent_mesh_t), intent(out) :: parent       !! mesh, positive orientation, labels from 1
    type(box_settings_t), intent(in) :: box          !! what to generate
    type(error_t), allocatable, intent(out) :: error !! contradictory settings

    integer :: i

    call check_box(box, error)
    if (allocated(error)) return
    call check_all_planes(box, error)
    if (allocated(error)) return
    parent%n_dim = box%n_dim
    parent%order = 1
    call place_nodes(parent, box)
    call cut_cells(parent, box)
    parent%n_el = size(parent%node, 2)
    if (box%order == 2) call add_mid_nodes(parent)
    parent%n_node = size(parent%x, 2)
    parent%node_label = [(i, i=1, parent%n_node)]
    parent%element_label = [(i, i=1, parent%n_el)]
    allocate (parent%element_set(1), parent%surface(0))
    parent%element_set(1)%name = "ALL"
    if (allocated(box%elset)) parent%element_set(1)%name = box%elset
    parent%element_set(1)%item = parent%element_label
    call collect_sides(parent)
  end subroutine generate_box

  !> The numbers make sense together.
  pure subroutine check_box(box, error)
    type(box_settings_t), intent(in) :: box          !! settings
    type(error_t), allocatable, intent(out) :: error !! the first fault

    if (box%n_dim /= 2 .and. box%n_dim /= 3) then
      call make_error(error, exit_model, "box of "//integer_text(box%n_dim)// &
        " dimensions: expected 2 or 3")
    else if (box%order /= 1 .and. box%order /= 2) then
      call make_error(error, exit_model, "box of order "//integer_text(box%order)// &
        ": expected 1 or 2")
    else if (all(box%split /= merge([2, 4], [5, 6], box%n_dim == 2))) then
      call make_error(error, exit_model, "box with "//integer_text(box%split)// &
        " elements per cell: expected 2 or 4 in 2-D, 5 or 6 in 3-D")
    else if (box%orientation /= 1 .and. box%orientation /= 2) then
      call make_error(error, exit_model, "box of orientation "//integer_text(box%orientation)// &
        ": expected 1 or 2")
    end if
  end subroutine check_box

  !> The planes of every direction ascend.
  pure subroutine check_all_planes(box, error)
    type(box_settings_t), intent(in) :: box          !! settings
    type(error_t), allocatable, intent(out) :: error !! the first fault

    call check_planes(box%x, "x", error)
    if (allocated(error)) return
    call check_planes(box%y, "y", error)
    if (allocated(error) .or. box%n_dim == 2) return
    call check_planes(box%z, "z", error)
  end subroutine check_all_planes

  !> The planes of a direction ascend.
  pure subroutine check_planes(plane, direction, error)
    real(dp), allocatable, intent(in) :: plane(:)     !! (n+1)  planes [length]
    character(*), intent(in)          :: direction    !! its name
    type(error_t), allocatable, intent(out) :: error  !! too few or not ascending

    integer :: n

    n = 0
    if (allocated(plane)) n = size(plane)
    if (n < 2) then
      call make_error(error, exit_model, "box with "//integer_text(n)//" planes in "// &
        direction//": expected at least 2")
    else if (any(plane(2:) <= plane(:n - 1))) then
      call make_error(error, exit_model, "box with planes in "//direction// &
        " out of order: expected ascending coordinates")
    end if
  end subroutine check_planes

  !> Nodes where the planes cross, x fastest, then the middles of the cells if they are needed.
  pure subroutine place_nodes(parent, box)
    type(parent_mesh_t), intent(inout) :: parent !! out coordinates
    type(box_settings_t), intent(in)   :: box    !! planes

    real(dp), allocatable :: x(:, :), z(:)
    integer :: i, j, k

    if (box%n_dim == 3) then
      allocate (z, source=box%z)
    else
      allocate (z(1), source=0.0_dp)
    end if
    allocate (x(3, size(box%x)*size(box%y)*size(z)))
    do k = 1, size(z)
      do j = 1, size(box%y)
        do i = 1, size(box%x)
          x(:, i + size(box%x)*(j - 1 + size(box%y)*(k - 1))) = [box%x(i), box%y(j), z(k)]
        end do
      end do
    end do
    if (box%split == 4) then
      x = reshape([x, [(([(box%x(i) + box%x(i + 1))/2.0_dp, (box%y(j) + box%y(j + 1))/2.0_dp, &
        0.0_dp], i=1, size(box%x) - 1), j=1, size(box%y) - 1)]], &
        [3, size(x, 2) + (size(box%x) - 1)*(size(box%y) - 1)])
    end if
    parent%x = x(:box%n_dim, :)
  end subroutine place_nodes

  !> Cuts every cell into simplices; neighbouring cells agree on the cuts of their common faces.
  pure subroutine cut_cells(parent, box)
    type(parent_mesh_t), intent(inout) :: parent !! out nodes of the elements
    type(box_settings_t), intent(in)   :: box    !! planes, kind of cut

    integer :: c, cell(3), corner(9), way, n(3)

    n = 1
    n(1:2) = [size(box%x), size(box%y)] - 1
    if (box%n_dim == 3) n(3) = size(box%z) - 1
    allocate (parent%node(box%n_dim + 1, box%split*product(n)))
    do c = 0, product(n) - 1
      cell = [mod(c, n(1)), mod(c/n(1), n(2)), c/(n(1)*n(2))]
      corner(:8) = cell_corners(cell, n)
      corner(9) = (n(1) + 1)*(n(2) + 1) + c + 1
      way = 1 + mod(sum(cell) + box%orientation - 1, 2)
      parent%node(:, box%split*c + 1:box%split*(c + 1)) = &
        reshape(corner(cuts(box%split, way)), [box%n_dim + 1, box%split])
    end do
  end subroutine cut_cells

  !> Nodes at the corners of a cell.
  pure function cell_corners(cell, n) result(corner)
    integer, intent(in) :: cell(3) !! (3)  place of the cell, from 0
    integer, intent(in) :: n(3)    !! (3)  cells per direction
    integer :: corner(8)           !! (8)  nodes; the last four exist in 3-D only

    integer :: b, i(3)

    do b = 0, 7
      i = cell + [mod(b, 2), mod(b/2, 2), b/4]
      corner(b + 1) = 1 + i(1) + (n(1) + 1)*(i(2) + (n(2) + 1)*i(3))
    end do
  end function cell_corners

  !> Corners of the simplices of a cell, one after the other; 9 is the middle of the cell.
  pure function cuts(split, way) result(corner)
    integer, intent(in)  :: split     !! simplices per cell
    integer, intent(in)  :: way       !! 1 or 2
    integer, allocatable :: corner(:) !! ((n_dim+1)*split)  numbers of corners

    select case (split)
    case (2)
      corner = reshape(two_triangles(:, :, way), [6])
    case (4)
      corner = reshape(merge(9, cross, cross == 5), [12])
    case (5)
      corner = reshape(five_tetrahedra(:, :, way), [20])
    case default
      corner = reshape(six_tetrahedra, [24])
    end select
  end function cuts

  !> Puts one node in the middle of every edge and makes the elements quadratic.
  pure subroutine add_mid_nodes(parent)
    type(parent_mesh_t), intent(inout) :: parent !! in linear, out quadratic mesh

    integer, allocatable :: edge(:, :), mid(:), node(:, :), order(:), first(:)
    integer :: e, i, j, n_corner, n_edge, n_node

    n_corner = parent%n_dim + 1
    n_edge = n_corner*parent%n_dim/2
    n_node = size(parent%x, 2)
    allocate (edge(2, n_edge*parent%n_el), mid(n_edge*parent%n_el))
    do e = 1, parent%n_el
      do i = 1, n_edge
        edge(:, n_edge*(e - 1) + i) = sorted_small(parent%node(parent_edge(:, i), e))
      end do
    end do
    call sort_columns(edge, n_node, order)
    allocate (first(size(order)))
    j = 0
    do i = 1, size(order)
      if (i == 1) then
        j = 1
      else if (any(edge(:, order(i)) /= edge(:, order(i - 1)))) then
        j = j + 1
      end if
      mid(order(i)) = n_node + j
      first(j) = order(i)
    end do
    allocate (node(n_corner + n_edge, parent%n_el))
    node(:n_corner, :) = parent%node
    node(n_corner + 1:, :) = reshape(mid, [n_edge, parent%n_el])
    call move_alloc(node, parent%node)
    parent%x = reshape([parent%x, (parent%x(:, edge(1, first(:j))) + &
      parent%x(:, edge(2, first(:j))))/2.0_dp], [parent%n_dim, n_node + j])
    parent%order = 2
  end subroutine add_mid_nodes

  !> Node sets and carrier sets of the sides of the box.
  pure subroutine collect_sides(parent)
    type(parent_mesh_t), intent(inout) :: parent !! in nodes and elements, out sets and carriers

    character(2), parameter :: name(6) = ["X0", "X1", "Y0", "Y1", "Z0", "Z1"]
    logical, allocatable :: on_side(:)
    integer, allocatable :: carrier(:, :)
    real(dp) :: plane
    integer :: a, i, n_carrier

    allocate (parent%node_set(2*parent%n_dim), parent%carrier_set(2*parent%n_dim))
    allocate (parent%carrier(parent%n_dim, 0))
    do i = 1, 2*parent%n_dim
      plane = minval(parent%x((i + 1)/2, :))
      if (mod(i, 2) == 0) plane = maxval(parent%x((i + 1)/2, :))
      on_side = abs(parent%x((i + 1)/2, :) - plane) <= 0.0_dp
      parent%node_set(i)%name = name(i)
      parent%node_set(i)%item = pack([(a, a=1, parent%n_node)], on_side)
      carrier = side_faces(parent, on_side)
      n_carrier = size(parent%carrier, 2)
      parent%carrier_set(i)%name = name(i)
      parent%carrier_set(i)%item = [(n_carrier + a, a=1, size(carrier, 2))]
      parent%carrier = reshape([parent%carrier, carrier], &
        [parent%n_dim, n_carrier + size(carrier, 2)])
    end do
  end subroutine collect_sides

  !> Corner nodes of the element faces that lie on a side.
  pure function side_faces(parent, on_side) result(carrier)
    type(parent_mesh_t), intent(in) :: parent     !! mesh
    logical, intent(in)             :: on_side(:) !! (n_node)  nodes of the side
    integer, allocatable :: carrier(:, :)         !! (n_dim, n)  corner nodes

    integer, allocatable :: element(:)
    integer :: corner(parent%n_dim + 1), e, i

    element = pack([(e, e=1, parent%n_el)], &
      [(count(on_side(parent%node(:parent%n_dim + 1, e))) == parent%n_dim, e=1, parent%n_el)])
    allocate (carrier(parent%n_dim, size(element)))
    do i = 1, size(element)
      corner = parent%node(:parent%n_dim + 1, element(i))
      carrier(:, i) = pack(corner, on_side(corner))
    end do
  end function side_faces

end module mpm_mesh_generator
