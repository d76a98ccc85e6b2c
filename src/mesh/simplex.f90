!> The linear simplex: 3-node triangle and 4-node tetrahedron.
module mpm_simplex
  use mpm_kinds, only: dp
  use mpm_tensor, only: cross_product
  implicit none
  private
  public :: distance_to_simplex, simplex_gradients, simplex_shape, simplex_size, simplex_volume

contains

  !> Signed volume (2-D: area), positive when the nodes are ordered as the mesh wants them:
  !! a triangle counter-clockwise, the fourth node of a tetrahedron to the left of the first three.
  pure real(dp) function simplex_volume(x) result(volume)
    real(dp), intent(in) :: x(:, :) !! (n_dim, n_dim+1)  nodes [length]

    real(dp) :: edge(size(x, 1), size(x, 1))
    integer :: a

    do a = 1, size(x, 1)
      edge(:, a) = x(:, a + 1) - x(:, 1)
    end do
    if (size(x, 1) == 2) then
      volume = (edge(1, 1)*edge(2, 2) - edge(2, 1)*edge(1, 2))/2.0_dp
    else
      volume = dot_product(edge(:, 1), cross_product(edge(:, 2), edge(:, 3)))/6.0_dp
    end if
  end function simplex_volume

  !> Gradients of the shape functions, constant over the element, and its signed volume.
  !! The gradients are zero when the volume is.
  pure subroutine simplex_gradients(x, grad_shape, volume)
    real(dp), intent(in)  :: x(:, :)          !! (n_dim, n_dim+1)  nodes [length]
    real(dp), intent(out) :: grad_shape(:, :) !! (n_dim, n_dim+1)  gradients [1/length]
    real(dp), intent(out) :: volume           !!                   signed volume [length^n_dim]

    integer :: a

    volume = simplex_volume(x)
    grad_shape = 0.0_dp
    if (abs(volume) <= 0.0_dp) return
    if (size(x, 1) == 2) then
      grad_shape(:, 2) = [x(2, 3) - x(2, 1), x(1, 1) - x(1, 3)]/(2.0_dp*volume)
      grad_shape(:, 3) = [x(2, 1) - x(2, 2), x(1, 2) - x(1, 1)]/(2.0_dp*volume)
    else
      grad_shape(:, 2) = cross_product(x(:, 3) - x(:, 1), x(:, 4) - x(:, 1))/(6.0_dp*volume)
      grad_shape(:, 3) = cross_product(x(:, 4) - x(:, 1), x(:, 2) - x(:, 1))/(6.0_dp*volume)
      grad_shape(:, 4) = cross_product(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))/(6.0_dp*volume)
    end if
    do a = 2, size(x, 2)
      grad_shape(:, 1) = grad_shape(:, 1) - grad_shape(:, a)
    end do
  end subroutine simplex_gradients

  !> Shape functions (barycentric coordinates) at a position from the stored gradients.
  !! They add up to one to the last bit but rounding; outside the element some are negative.
  pure function simplex_shape(x_node_1, grad_shape, x) result(shape)
    real(dp), intent(in) :: x_node_1(:)      !! (n_dim)           first node [length]
    real(dp), intent(in) :: grad_shape(:, :) !! (n_dim, n_dim+1)  gradients [1/length]
    real(dp), intent(in) :: x(:)             !! (n_dim)           position [length]
    real(dp) :: shape(size(grad_shape, 2))   !! (n_dim+1)         shape functions [-]

    integer :: a

    do a = 2, size(grad_shape, 2)
      shape(a) = dot_product(grad_shape(:, a), x - x_node_1)
    end do
    shape(1) = 1.0_dp - sum(shape(2:))
  end function simplex_shape

  !> Size of an element: the leg of the right-angled simplex of the same volume.
  pure real(dp) function simplex_size(n_dim, volume) result(length)
    integer, intent(in)  :: n_dim  !! 2 or 3
    real(dp), intent(in) :: volume !! volume (2-D: area), positive [length^n_dim]

    if (n_dim == 2) then
      length = sqrt(2.0_dp*volume)
    else
      length = (6.0_dp*volume)**(1.0_dp/3.0_dp)
    end if
  end function simplex_size

  !> Distance of a position from a simplex of any dimension (point, edge, triangle, tetrahedron),
  !! zero inside. The foot point lies on a facet opposite a vertex whose coordinate is negative.
  pure recursive real(dp) function distance_to_simplex(x, vertex) result(distance)
    real(dp), intent(in) :: x(:)         !! (n_dim)     position [length]
    real(dp), intent(in) :: vertex(:, :) !! (n_dim, m)  vertices, m >= 1 [length]

    real(dp) :: shape(size(vertex, 2)), foot(size(x))
    integer :: a, b, m

    m = size(vertex, 2)
    shape = projected_shape(x, vertex)
    if (all(shape >= 0.0_dp)) then
      foot = matmul(vertex, shape)
      distance = sqrt(sum((x - foot)**2))
      if (m == size(x) + 1) distance = 0.0_dp
      return
    end if
    distance = huge(1.0_dp)
    do a = 1, m
      if (shape(a) >= 0.0_dp) cycle
      distance = min(distance, distance_to_simplex(x, vertex(:, pack([(b, b=1, m)], &
        [(b /= a, b=1, m)]))))
    end do
  end function distance_to_simplex

  !> Barycentric coordinates of the projection of a position onto the flat of a simplex.
  pure function projected_shape(x, vertex) result(shape)
    real(dp), intent(in) :: x(:)         !! (n_dim)     position [length]
    real(dp), intent(in) :: vertex(:, :) !! (n_dim, m)  vertices, m >= 1 [length]
    real(dp) :: shape(size(vertex, 2))   !! (m)         coordinates, sum 1 [-]

    real(dp) :: edge(size(x), size(vertex, 2) - 1), gram(size(vertex, 2) - 1, size(vertex, 2))
    integer :: i, k, m

    m = size(vertex, 2) - 1
    do i = 1, m
      edge(:, i) = vertex(:, i + 1) - vertex(:, 1)
    end do
    gram(:, :m) = matmul(transpose(edge), edge)
    gram(:, m + 1) = matmul(x - vertex(:, 1), edge)
    do k = 1, m
      gram(k, k:) = gram(k, k:)/gram(k, k)
      do i = 1, m
        if (i /= k) gram(i, k:) = gram(i, k:) - gram(i, k)*gram(k, k:)
      end do
    end do
    shape(2:) = gram(:, m + 1)
    shape(1) = 1.0_dp - sum(shape(2:))
  end function projected_shape

end module mpm_simplex
