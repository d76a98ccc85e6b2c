!> Boxes of simplices and patches on them for the tests of this layer.
module box_meshes
  use mpm_kinds, only: dp
  use mpm_mesh, only: build_geometry, find_neighbours, mesh_t
  use mpm_patches, only: patches_t
  implicit none
  private
  public :: boundary_faces, make_box, patches_of_size

  integer, parameter :: order_2(2, 2) = reshape([1, 2, 2, 1], [2, 2])
  integer, parameter :: order_3(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, &
                                                 2, 1, 3, 1, 3, 2, 3, 2, 1], [3, 6])

contains

  !> A box of unit cells, each cut into n_dim! simplices around its diagonal, stretched and
  !! sheared along the first axis.
  subroutine make_box(mesh, n_cell)
    type(mesh_t), intent(out) :: mesh !! with gradients, volumes and neighbours
    integer, intent(in) :: n_cell(:)  !! (n_dim)  cells along each axis
    integer :: bad, cell, i, k, n_cells
    integer :: corner(size(n_cell))
    integer, allocatable :: order(:, :)

    if (size(n_cell) == 2) then
      order = order_2
    else
      order = order_3
    end if
    mesh%n_dim = size(n_cell)
    mesh%n_node = product(n_cell + 1)
    n_cells = product(n_cell)
    mesh%n_el = n_cells*size(order, 2)
    allocate (mesh%x(mesh%n_dim, mesh%n_node), mesh%node(mesh%n_dim + 1, mesh%n_el))
    do i = 1, mesh%n_node
      mesh%x(:, i) = real(place(i, n_cell + 1), dp)
      mesh%x(1, i) = 1.2_dp*mesh%x(1, i) + 0.1_dp*mesh%x(2, i)
    end do
    do cell = 1, n_cells
      corner = place(cell, n_cell)
      do k = 1, size(order, 2)
        i = k + (cell - 1)*size(order, 2)
        call cut_simplex(mesh%node(:, i), corner, order(:, k), n_cell + 1, &
                         k > size(order, 2)/2)
      end do
    end do
    call build_geometry(mesh, bad)
    call find_neighbours(mesh)
  end subroutine make_box

  !> One simplex of a cell: from its first corner along the axes in a given order.
  subroutine cut_simplex(node, corner, order, n, odd)
    integer, intent(out) :: node(:)   !! (n_dim+1)
    integer, intent(in)  :: corner(:) !! (n_dim)  first corner of the cell, from 0
    integer, intent(in)  :: order(:)  !! (n_dim)  axes
    integer, intent(in)  :: n(:)      !! (n_dim)  nodes along each axis
    logical, intent(in)  :: odd       !! the order is an odd permutation
    integer :: at(size(corner)), i, last

    at = corner
    node(1) = number(at, n)
    do i = 1, size(order)
      at(order(i)) = at(order(i)) + 1
      node(i + 1) = number(at, n)
    end do
    if (.not. odd) return
    last = node(size(node))
    node(size(node)) = node(size(node) - 1)
    node(size(node) - 1) = last
  end subroutine cut_simplex

  !> Place of item i on a grid, from 0, first axis fastest.
  pure function place(i, n) result(at)
    integer, intent(in) :: i    !! item, from 1
    integer, intent(in) :: n(:) !! items along each axis
    integer :: at(size(n)), k, rest

    rest = i - 1
    do k = 1, size(n)
      at(k) = mod(rest, n(k))
      rest = rest/n(k)
    end do
  end function place

  !> Item at a place on a grid.
  pure integer function number(at, n)
    integer, intent(in) :: at(:) !! place, from 0
    integer, intent(in) :: n(:)  !! items along each axis
    integer :: k

    number = 0
    do k = size(n), 1, -1
      number = number*n(k) + at(k)
    end do
    number = number + 1
  end function number

  !> Patches of so many successive elements each; the last one may be smaller.
  subroutine patches_of_size(patches, n_el, size_of_patch)
    type(patches_t), intent(out) :: patches !! covers all elements
    integer, intent(in) :: n_el             !! elements
    integer, intent(in) :: size_of_patch    !! elements of a patch
    integer :: e, p

    patches%n = (n_el + size_of_patch - 1)/size_of_patch
    patches%of_element = [((e - 1)/size_of_patch + 1, e=1, n_el)]
    patches%first = [(min((p - 1)*size_of_patch, n_el) + 1, p=1, patches%n + 1)]
    patches%element = [(e, e=1, n_el)]
  end subroutine patches_of_size

  !> Faces without a neighbour: the closed surface of the box.
  subroutine boundary_faces(mesh, element, face)
    type(mesh_t), intent(in) :: mesh                  !! with neighbours
    integer, allocatable, intent(out) :: element(:)   !! element of each face
    integer, allocatable, intent(out) :: face(:)      !! local face
    integer :: a, e

    element = pack(spread([(e, e=1, mesh%n_el)], 1, mesh%n_dim + 1), mesh%neighbour == 0)
    face = pack(spread([(a, a=1, mesh%n_dim + 1)], 2, mesh%n_el), mesh%neighbour == 0)
  end subroutine boundary_faces

end module box_meshes
