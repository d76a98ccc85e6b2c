!> Bins over the elements of a mesh: which elements may hold a position, or lie near it.
module mpm_element_bins
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_simplex, only: simplex_size
  implicit none
  private
  public :: bin_of, build_bins, element_bins_t, is_current

  integer, parameter :: n_histogram = 4096 !! classes from which the planes between bins are chosen

  !> A grid of bins whose planes follow the density of the elements. An element stands in every bin
  !! that its bounding box, widened by the reach, touches.
  type :: element_bins_t
    integer  :: n(3) = 0                      !! bins per direction
    real(dp) :: reach = 0.0_dp                !! widening over element size [-]
    real(dp), allocatable :: plane(:, :)      !! (n+1, n_dim)   planes, ascending [length]
    integer, allocatable  :: first(:)         !! (n_bin+1)      start of each bin in element
    integer, allocatable  :: element(:)       !! (n_entry)      ascending within a bin
    real(dp), allocatable :: box(:, :, :)     !! (n_dim, 2, n_el) widened bounding boxes [length]
    real(dp), allocatable :: x(:, :)          !! (n_dim, n_node) of the mesh when built [length]
  end type element_bins_t

contains

  !> Whether bins belong to the mesh as it is now.
  pure logical function is_current(bins, mesh, reach) result(current)
    type(element_bins_t), intent(in) :: bins  !! bins
    type(mesh_t), intent(in)         :: mesh  !! mesh
    real(dp), intent(in)             :: reach !! widening over element size [-]

    current = .false.
    if (.not. allocated(bins%x)) return
    if (any(shape(bins%x) /= shape(mesh%x)) .or. size(bins%box, 3) /= mesh%n_el) return
    if (abs(bins%reach - reach) > 0.0_dp) return
    current = all(abs(bins%x - mesh%x) <= 0.0_dp)
  end function is_current

  !> Sorts the elements into about as many bins as there are elements.
  pure subroutine build_bins(bins, mesh, reach)
    type(element_bins_t), intent(out) :: bins  !! bins
    type(mesh_t), intent(in)          :: mesh  !! mesh
    real(dp), intent(in)              :: reach !! widening over element size [-]

    integer, allocatable :: next(:), touched(:)
    integer :: b, e, i

    bins%reach = reach
    bins%x = mesh%x
    call widen_boxes(bins, mesh)
    call choose_planes(bins, mesh)
    allocate (bins%first(product(bins%n) + 1), source=0)
    do e = 1, mesh%n_el
      touched = touched_bins(bins, bins%box(:, :, e))
      bins%first(touched + 1) = bins%first(touched + 1) + 1
    end do
    bins%first(1) = 1
    do b = 1, product(bins%n)
      bins%first(b + 1) = bins%first(b + 1) + bins%first(b)
    end do
    next = bins%first
    allocate (bins%element(bins%first(product(bins%n) + 1) - 1))
    do e = 1, mesh%n_el
      touched = touched_bins(bins, bins%box(:, :, e))
      do i = 1, size(touched)
        bins%element(next(touched(i))) = e
      end do
      next(touched) = next(touched) + 1
    end do
  end subroutine build_bins

  !> Bounding boxes, widened by the reach times the size of the element.
  pure subroutine widen_boxes(bins, mesh)
    type(element_bins_t), intent(inout) :: bins !! in reach, out box
    type(mesh_t), intent(in)            :: mesh !! mesh

    real(dp) :: margin
    integer :: e

    allocate (bins%box(mesh%n_dim, 2, mesh%n_el))
    do e = 1, mesh%n_el
      margin = bins%reach*simplex_size(mesh%n_dim, mesh%volume(e))
      bins%box(:, 1, e) = minval(mesh%x(:, mesh%node(:, e)), dim=2) - margin
      bins%box(:, 2, e) = maxval(mesh%x(:, mesh%node(:, e)), dim=2) + margin
    end do
  end subroutine widen_boxes

  !> Planes that put about as many elements between any two of them.
  pure subroutine choose_planes(bins, mesh)
    type(element_bins_t), intent(inout) :: bins !! in box, out n and plane
    type(mesh_t), intent(in)            :: mesh !! mesh

    integer :: i, per_direction

    per_direction = max(1, nint(real(mesh%n_el, dp)**(1.0_dp/real(mesh%n_dim, dp))))
    allocate (bins%plane(per_direction + 1, mesh%n_dim), source=0.0_dp)
    bins%n = 1
    do i = 1, mesh%n_dim
      call choose_planes_along(bins%box(i, :, :), bins%plane(:, i), bins%n(i))
    end do
  end subroutine choose_planes

  !> The planes of one direction, from a histogram of the middles of the boxes.
  pure subroutine choose_planes_along(span, plane, n)
    real(dp), intent(in)  :: span(:, :) !! (2, n_el)  lower and upper end of each element [length]
    real(dp), intent(out) :: plane(:)   !! (most bins + 1)  planes, the last ones equal [length]
    integer, intent(out)  :: n          !! bins, at least 1

    real(dp) :: low, share, width
    integer :: class, e, histogram(n_histogram), passed

    low = minval(span(1, :))
    width = (maxval(span(2, :)) - low)/real(n_histogram, dp)
    share = real(size(span, 2), dp)/real(size(plane) - 1, dp)
    histogram = 0
    do e = 1, size(span, 2)
      class = min(n_histogram, int((sum(span(:, e))/2.0_dp - low)/width) + 1)
      histogram(class) = histogram(class) + 1
    end do
    plane(1) = low
    n = 1
    passed = 0
    do class = 1, n_histogram - 1
      if (n == size(plane) - 1) exit
      if (int(real(passed + histogram(class), dp)/share) > int(real(passed, dp)/share)) then
        n = n + 1
        plane(n) = low + width*real(class, dp)
      end if
      passed = passed + histogram(class)
    end do
    plane(n + 1:) = maxval(span(2, :))
  end subroutine choose_planes_along

  !> Bins that a box touches.
  pure function touched_bins(bins, box) result(touched)
    type(element_bins_t), intent(in) :: bins !! bins with planes
    real(dp), intent(in) :: box(:, :)        !! (n_dim, 2)  lower and upper corner [length]
    integer, allocatable :: touched(:)       !! (n)         bins, each once

    integer :: c, i, low(3), n(3)

    low = 1
    n = 1
    do i = 1, size(box, 1)
      low(i) = interval(bins%plane(:bins%n(i) + 1, i), box(i, 1))
      n(i) = interval(bins%plane(:bins%n(i) + 1, i), box(i, 2)) - low(i) + 1
    end do
    touched = [(number_of(bins, low + [mod(c, n(1)), mod(c/n(1), n(2)), c/(n(1)*n(2))]), &
      c=0, product(n) - 1)]
  end function touched_bins

  !> Bin of a position, 0 outside all of them.
  pure integer function bin_of(bins, x) result(bin)
    type(element_bins_t), intent(in) :: bins !! bins
    real(dp), intent(in) :: x(:)             !! (n_dim)  position [length]

    integer :: i, cell(3)

    bin = 0
    cell = 1
    do i = 1, size(x)
      if (x(i) < bins%plane(1, i) .or. x(i) > bins%plane(bins%n(i) + 1, i)) return
      cell(i) = interval(bins%plane(:bins%n(i) + 1, i), x(i))
    end do
    bin = number_of(bins, cell)
  end function bin_of

  !> Number of a bin from its place in the grid.
  pure integer function number_of(bins, cell) result(bin)
    type(element_bins_t), intent(in) :: bins !! bins
    integer, intent(in) :: cell(3)           !! (3)  place per direction, from 1

    bin = cell(1) + bins%n(1)*(cell(2) - 1 + bins%n(2)*(cell(3) - 1))
  end function number_of

  !> The interval between planes that holds a coordinate; the first or last for one outside.
  pure integer function interval(plane, coordinate) result(low)
    real(dp), intent(in) :: plane(:)   !! (n+1)  planes, ascending [length]
    real(dp), intent(in) :: coordinate !!        coordinate [length]

    integer :: high, middle

    low = 1
    high = size(plane)
    do while (high - low > 1)
      middle = (low + high)/2
      if (coordinate >= plane(middle)) then
        low = middle
      else
        high = middle
      end if
    end do
  end function interval

end module mpm_element_bins
