!> Axes of their own for some nodes: rectangular, cylindrical or spherical.
module mpm_nodal_frames
  use mpm_kinds, only: dp
  use mpm_tensor, only: cross_product, identity
  implicit none
  private
  public :: nodal_frames_t, frame_rectangular, frame_cylindrical, frame_spherical
  public :: axes_at, frame_is_defined, has_frame, in_global_axes, in_local_axes, node_axes, &
    part_along, rotate_block

  integer, parameter :: frame_rectangular = 1 !! a on axis 1, b in the plane of axes 1 and 2
  integer, parameter :: frame_cylindrical = 2 !! a and b on the axis: radial, tangential, axial
  integer, parameter :: frame_spherical = 3   !! centre a, b on the polar axis: radial,
                                              !! circumferential, meridional

  real(dp), parameter :: tolerance = 1.0e-9_dp !! length that has no direction, over coordinates

  !> The axes of all nodes.
  type :: nodal_frames_t
    integer, allocatable  :: of_node(:)        !! (n_node)  index of the rotation, 0 = global axes;
                                               !! unallocated: all nodes have global axes
    real(dp), allocatable :: rotation(:, :, :) !! (n_dim, n_dim, n)  its rows are the local axes
  end type nodal_frames_t

contains

  !> Whether two points define a frame: they, and what they span, must have directions.
  pure logical function frame_is_defined(kind, a, b) result(defined)
    integer, intent(in)  :: kind !! frame_*
    real(dp), intent(in) :: a(3) !! (3)  first point [length]
    real(dp), intent(in) :: b(3) !! (3)  second point [length]

    if (kind == frame_rectangular) then
      defined = norm2(cross_product(a, b)) > tolerance*norm2(a)*norm2(b)
    else
      defined = norm2(b - a) > tolerance*max(norm2(a), norm2(b))
    end if
  end function frame_is_defined

  !> Local axes at a place. Source: theory.md (19a)-(19c). Precondition: frame_is_defined.
  pure subroutine axes_at(axes, defined, kind, a, b, x)
    real(dp), intent(out) :: axes(3, 3) !! (3, 3)  its rows are the axes, right-handed
    logical, intent(out)  :: defined    !! .false.: x is where the frame has no directions
    integer, intent(in)   :: kind       !! frame_*
    real(dp), intent(in)  :: a(3)       !! (3)  first point [length]
    real(dp), intent(in)  :: b(3)       !! (3)  second point [length]
    real(dp), intent(in)  :: x(3)       !! (3)  place of the node [length]
    real(dp) :: first(3), second(3), third(3), radius(3), smallest

    axes = 0.0_dp
    smallest = tolerance*max(norm2(a), norm2(b), norm2(x))
    radius = x - a
    select case (kind)
    case (frame_rectangular)
      defined = .true.
      first = unit(a)
      third = unit(cross_product(a, b))
      second = cross_product(third, first)
    case (frame_cylindrical)
      third = unit(b - a)
      radius = radius - dot_product(radius, third)*third
      defined = norm2(radius) > smallest
      if (.not. defined) return
      first = unit(radius)
      second = cross_product(third, first)
    case default
      second = cross_product(unit(b - a), radius)
      defined = norm2(second) > smallest
      if (.not. defined) return
      first = unit(radius)
      second = unit(second)
      third = cross_product(first, second)
    end select
    axes = transpose(reshape([first, second, third], [3, 3]))
  end subroutine axes_at

  !> A vector of length 1.
  pure function unit(vector) result(direction)
    real(dp), intent(in) :: vector(3) !! (3)  not zero
    real(dp) :: direction(3)          !! (3)

    direction = vector/norm2(vector)
  end function unit

  !> Whether a node has axes of its own.
  pure logical function has_frame(frames, node) result(has)
    type(nodal_frames_t), intent(in) :: frames
    integer, intent(in) :: node !! a node

    has = .false.
    if (allocated(frames%of_node)) has = frames%of_node(node) > 0
  end function has_frame

  !> Axes of some nodes, own or global. Precondition: some nodes have their own.
  pure function node_axes(frames, node) result(axes)
    type(nodal_frames_t), intent(in) :: frames
    integer, intent(in) :: node(:)           !! (n)  nodes
    real(dp), allocatable :: axes(:, :, :)   !! (n_dim, n_dim, n)  rows are the axes
    integer :: i, n_dim

    n_dim = size(frames%rotation, 1)
    allocate (axes(n_dim, n_dim, size(node)))
    do i = 1, size(node)
      axes(:, :, i) = identity(:n_dim, :n_dim)
      if (has_frame(frames, node(i))) axes(:, :, i) = frames%rotation(:, :, frames%of_node(node(i)))
    end do
  end function node_axes

  !> Components of a nodal vector along the axes of its node. Source: theory.md (19).
  pure function in_local_axes(frames, node, vector) result(local)
    type(nodal_frames_t), intent(in) :: frames
    integer, intent(in)  :: node       !! a node
    real(dp), intent(in) :: vector(:)  !! (n_dim)  along the global axes
    real(dp) :: local(size(vector))    !! (n_dim)  along those of the node

    local = vector
    if (has_frame(frames, node)) local = matmul(frames%rotation(:, :, frames%of_node(node)), vector)
  end function in_local_axes

  !> Components along the global axes of a vector along those of its node. Source: theory.md (19).
  pure function in_global_axes(frames, node, local) result(vector)
    type(nodal_frames_t), intent(in) :: frames
    integer, intent(in)  :: node      !! a node
    real(dp), intent(in) :: local(:)  !! (n_dim)  along the axes of the node
    real(dp) :: vector(size(local))   !! (n_dim)  along the global axes

    vector = local
    if (has_frame(frames, node)) vector = matmul(local, frames%rotation(:, :, frames%of_node(node)))
  end function in_global_axes

  !> The part of nodal vectors along some of the axes of their nodes. Source: theory.md (19d).
  pure function part_along(frames, nodal, wanted) result(part)
    type(nodal_frames_t), intent(in) :: frames
    real(dp), intent(in) :: nodal(:, :)                !! (n_dim, n_node)  along the global axes
    logical, intent(in)  :: wanted(:, :)               !! (n_dim, n_node)  axes of the node
    real(dp) :: part(size(nodal, 1), size(nodal, 2))   !! (n_dim, n_node)  along the global axes
    integer :: a

    part = merge(nodal, 0.0_dp, wanted)
    if (.not. allocated(frames%of_node)) return
    do a = 1, size(nodal, 2)
      if (frames%of_node(a) == 0) cycle
      part(:, a) = merge(in_local_axes(frames, a, nodal(:, a)), 0.0_dp, wanted(:, a))
      part(:, a) = in_global_axes(frames, a, part(:, a))
    end do
  end function part_along

  !> Turns the rows and columns of a dense block into the axes of its nodes.
  !! Source: theory.md (19e).
  pure subroutine rotate_block(block, frames, node)
    real(dp), intent(inout) :: block(:, :) !! (n_eq, n_eq)  equation (a-1)*n_dim + i is component i
                                           !! of node a
    type(nodal_frames_t), intent(in) :: frames
    integer, intent(in) :: node(:)         !! (n_eq/n_dim)  nodes of the block
    integer :: a, first, last

    if (.not. allocated(frames%of_node)) return
    do a = 1, size(node)
      if (frames%of_node(node(a)) == 0) cycle
      last = a*size(frames%rotation, 1)
      first = last - size(frames%rotation, 1) + 1
      associate (rotation => frames%rotation(:, :, frames%of_node(node(a))))
        block(first:last, :) = matmul(rotation, block(first:last, :))
        block(:, first:last) = matmul(block(:, first:last), transpose(rotation))
      end associate
    end do
  end subroutine rotate_block

end module mpm_nodal_frames
