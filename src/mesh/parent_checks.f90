!> What a mesh must fulfil before it is split: nodes, orientation, mid-edge nodes, shared faces.
module mpm_parent_checks
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_face_table, only: build_face_table, face_table_t, match_faces
  use mpm_index_sort, only: sort_columns, sorted_small
  use mpm_kinds, only: dp
  use mpm_parent_mesh, only: element_text, node_text, parent_edge, parent_mesh_t
  use mpm_simplex, only: simplex_volume
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: check_parents

  real(dp), parameter :: off_centre = 0.25_dp !! farthest mid-edge node off the middle, in edges
  real(dp), parameter :: flat = 1.0e-14_dp    !! least volume over cubed (2-D: squared) longest edge
  real(dp), parameter :: shortest = 1.0e-30_dp !! longest edge: below it, squares vanish

contains

  !> Checks the mesh of the user; the message of a failure names the element by its label.
  pure subroutine check_parents(parent, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh as read or generated
    type(error_t), allocatable, intent(out) :: error !! first fault found

    integer :: e

    if (parent%n_el < 1) then
      call make_error(error, exit_model, "the mesh has no elements: expected at least one")
      return
    end if
    do e = 1, parent%n_el
      call check_nodes(parent, e, error)
      if (allocated(error)) return
    end do
    do e = 1, parent%n_el
      call check_volume(parent, e, error)
      if (allocated(error)) return
      if (parent%order == 2) call check_mid_nodes(parent, e, error)
      if (allocated(error)) return
    end do
    call check_faces(parent, error)
    if (allocated(error)) return
    if (parent%order == 2) call check_edges(parent, error)
  end subroutine check_parents

  !> The nodes of an element exist and differ.
  pure subroutine check_nodes(parent, e, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh
    integer, intent(in) :: e                         !! element
    type(error_t), allocatable, intent(out) :: error !! fault of this element

    integer :: a, node

    do a = 1, size(parent%node, 1)
      node = parent%node(a, e)
      if (node < 1 .or. node > parent%n_node) then
        call make_error(error, exit_model, element_text(parent, e)//": its node "// &
          integer_text(a)//" does not exist: expected a defined node")
        return
      end if
      if (any(parent%node(:a - 1, e) == node)) then
        call make_error(error, exit_model, element_text(parent, e)//": "// &
          node_text(parent, node)//" appears twice: expected different nodes")
        return
      end if
    end do
  end subroutine check_nodes

  !> The corners of an element span a positive volume.
  pure subroutine check_volume(parent, e, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh
    integer, intent(in) :: e                         !! element
    type(error_t), allocatable, intent(out) :: error !! fault of this element

    real(dp) :: volume, edge
    character(:), allocatable :: kind
    integer :: a, b

    edge = 0.0_dp
    associate (corner => parent%node(:parent%n_dim + 1, e))
      volume = simplex_volume(parent%x(:, corner))
      do a = 2, size(corner)
        do b = 1, a - 1
          edge = max(edge, norm2(parent%x(:, corner(a)) - parent%x(:, corner(b))))
        end do
      end do
    end associate
    if (volume > flat*edge**parent%n_dim .and. edge > shortest) return
    kind = "zero volume"
    if (volume < -flat*edge**parent%n_dim) kind = "negative volume "//real_text(volume)
    call make_error(error, exit_model, element_text(parent, e)//": "//kind// &
      ": expected corner nodes in positive order, "//positive_order(parent%n_dim))
  end subroutine check_volume

  !> The order of corners that gives a positive volume, in words.
  pure function positive_order(n_dim) result(text)
    integer, intent(in) :: n_dim      !! 2 or 3
    character(:), allocatable :: text !! words

    text = "counter-clockwise"
    if (n_dim == 3) text = "the first three counter-clockwise as seen from the fourth"
  end function positive_order

  !> Mid-edge nodes lie near the middles of their edges.
  pure subroutine check_mid_nodes(parent, e, error)
    type(parent_mesh_t), intent(in) :: parent        !! quadratic mesh
    integer, intent(in) :: e                         !! element
    type(error_t), allocatable, intent(out) :: error !! fault of this element

    real(dp) :: edge(parent%n_dim), gap(parent%n_dim), ratio
    integer :: i, mid

    do i = 1, size(parent%node, 1) - parent%n_dim - 1
      mid = parent%node(parent%n_dim + 1 + i, e)
      associate (x_1 => parent%x(:, parent%node(parent_edge(1, i), e)), &
          x_2 => parent%x(:, parent%node(parent_edge(2, i), e)))
        edge = x_2 - x_1
        gap = parent%x(:, mid) - (x_1 + x_2)/2.0_dp
      end associate
      ratio = sqrt(sum(gap**2)/sum(edge**2))
      if (ratio <= off_centre) cycle
      call make_error(error, exit_model, element_text(parent, e)//": mid-edge "// &
        node_text(parent, mid)//" lies "//real_text(ratio)// &
        " edge lengths off the middle of its edge: expected at most "//real_text(off_centre))
      return
    end do
  end subroutine check_mid_nodes

  !> A face belongs to at most two elements.
  pure subroutine check_faces(parent, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh
    type(error_t), allocatable, intent(out) :: error !! fault

    type(face_table_t) :: table
    integer, allocatable :: neighbour(:, :)
    integer :: crowded

    allocate (neighbour(parent%n_dim + 1, parent%n_el))
    call build_face_table(table, parent%node(:parent%n_dim + 1, :), parent%n_node)
    call match_faces(table, neighbour, crowded)
    if (crowded == 0) return
    call make_error(error, exit_model, element_text(parent, crowded)// &
      ": one of its faces belongs to more than two elements: expected a face of at most two")
  end subroutine check_faces

  !> Elements that share an edge share its mid-edge node, and a mid-edge node has one edge only.
  pure subroutine check_edges(parent, error)
    type(parent_mesh_t), intent(in) :: parent        !! quadratic mesh
    type(error_t), allocatable, intent(out) :: error !! fault

    integer, allocatable :: corner(:, :), mid(:), order(:), edge_of_mid(:)
    integer :: e, i, j, k, n_edge, previous

    n_edge = size(parent%node, 1) - parent%n_dim - 1
    allocate (corner(2, n_edge*parent%n_el), mid(n_edge*parent%n_el))
    allocate (edge_of_mid(parent%n_node), source=0)
    do e = 1, parent%n_el
      do i = 1, n_edge
        j = n_edge*(e - 1) + i
        corner(:, j) = sorted_small(parent%node(parent_edge(:, i), e))
        mid(j) = parent%node(parent%n_dim + 1 + i, e)
        edge_of_mid(corner(:, j)) = -1
      end do
    end do
    call sort_columns(corner, parent%n_node, order)
    previous = 0
    do k = 1, size(order)
      j = order(k)
      if (k > 1) previous = order(k - 1)
      if (previous > 0) then
        if (all(corner(:, previous) == corner(:, j))) then
          if (mid(previous) == mid(j)) cycle
          call make_error(error, exit_model, element_text(parent, (j - 1)/n_edge + 1)// &
            ": mid-edge "//node_text(parent, mid(j))//" is "//node_text(parent, mid(previous))// &
            " in a neighbour: expected one mid-edge node per edge")
          return
        end if
      end if
      if (edge_of_mid(mid(j)) /= 0) then
        call make_error(error, exit_model, element_text(parent, (j - 1)/n_edge + 1)// &
          ": mid-edge "//node_text(parent, mid(j))// &
          " is a corner or lies on another edge elsewhere: expected a node of this edge only")
        return
      end if
      edge_of_mid(mid(j)) = j
    end do
  end subroutine check_edges

end module mpm_parent_checks
