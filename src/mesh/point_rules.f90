!> Positions and weights of material points inside a simplex.
module mpm_point_rules
  use mpm_kinds, only: dp
  implicit none
  private
  public :: available_rules, point_rule

  integer, parameter :: finest_lattice = 20 !! most divisions of an edge

  !> Orbits of the 6-point triangle rule, lambda = 1/3 + s (2/3, -1/3, -1/3): the mean of s^2 is
  !! 1/4 and of s^3 is 1/10, which makes equal weights exact for cubics.
  real(dp), parameter :: orbit_6(2) = &
    [0.620546482672006325890460343617_dp, -0.339001567612011718735960572874_dp]

contains

  !> The rule of a number of points; all weights equal, all points strictly inside.
  !! 3-D: 4 is the Gauss rule, 11 exact for quadratics; 2-D: 3 and 12 (3 in each quarter) exact for
  !! quadratics, 6 for cubics; k^n_dim points are the centroids of a lattice of equal sub-simplices.
  !! Source: formulation, patches and points.
  pure subroutine point_rule(n_dim, n_points, barycentric, weight, found)
    integer, intent(in)                :: n_dim             !! 2 or 3
    integer, intent(in)                :: n_points          !! points per element
    real(dp), allocatable, intent(out) :: barycentric(:, :) !! (n_dim+1, n)  coordinates [-]
    real(dp), allocatable, intent(out) :: weight(:)         !! (n)  fractions, sum 1 [-]
    logical, intent(out)               :: found             !!      whether there is such a rule

    if (n_dim == 2) then
      call triangle_rule(n_points, barycentric)
    else
      call tetrahedron_rule(n_points, barycentric)
    end if
    found = size(barycentric, 2) > 0
    allocate (weight(size(barycentric, 2)))
    weight = 1.0_dp/real(max(1, size(weight)), dp)
  end subroutine point_rule

  !> Points in a triangle.
  pure subroutine triangle_rule(n_points, barycentric)
    integer, intent(in)                :: n_points          !! points wanted
    real(dp), allocatable, intent(out) :: barycentric(:, :) !! (3, n)  none if there is no rule [-]

    select case (n_points)
    case (3)
      barycentric = vertex_orbit(2, 0.5_dp)
    case (6)
      barycentric = reshape([vertex_orbit(2, orbit_6(1)), vertex_orbit(2, orbit_6(2))], [3, 6])
    case (12)
      barycentric = rule_12()
    case default
      barycentric = lattice(2, divisions(2, n_points))
    end select
  end subroutine triangle_rule

  !> Points in a tetrahedron.
  pure subroutine tetrahedron_rule(n_points, barycentric)
    integer, intent(in)                :: n_points          !! points wanted
    real(dp), allocatable, intent(out) :: barycentric(:, :) !! (4, n)  none if there is no rule [-]

    select case (n_points)
    case (4)
      barycentric = vertex_orbit(3, 1.0_dp/sqrt(5.0_dp))
    case (11)
      barycentric = rule_11()
    case default
      barycentric = lattice(3, divisions(3, n_points))
    end select
  end subroutine tetrahedron_rule

  !> The numbers of points there are rules for, in words.
  pure function available_rules(n_dim) result(text)
    integer, intent(in)       :: n_dim !! 2 or 3
    character(:), allocatable :: text  !! such as "1, 4, 8, 11 or a cube such as 27"

    if (n_dim == 2) then
      text = "1, 3, 4, 6, 12, 16 or another square such as 9 or 25"
    else
      text = "1, 4, 8, 11 or another cube such as 27 or 64"
    end if
  end function available_rules

  !> Divisions of an edge in the lattice of so many sub-simplices, 0 if there is no such lattice.
  pure integer function divisions(n_dim, n_points) result(k)
    integer, intent(in) :: n_dim    !! 2 or 3
    integer, intent(in) :: n_points !! points wanted

    do k = finest_lattice, 1, -1
      if (k**n_dim == n_points) return
    end do
    k = 0
  end function divisions

  !> One point on the way from the centroid to each vertex.
  pure function vertex_orbit(n_dim, s) result(barycentric)
    integer, intent(in)  :: n_dim !! 2 or 3
    real(dp), intent(in) :: s     !! fraction of the way, negative: away from the vertex [-]
    real(dp) :: barycentric(n_dim + 1, n_dim + 1) !! (n_dim+1, n_dim+1)  coordinates [-]

    integer :: a

    barycentric = (1.0_dp - s)/real(n_dim + 1, dp)
    do a = 1, n_dim + 1
      barycentric(a, a) = barycentric(a, a) + s
    end do
  end function vertex_orbit

  !> Centroid, 4 points towards the vertices, 6 towards the middles of the edges.
  pure function rule_11() result(barycentric)
    real(dp) :: barycentric(4, 11) !! (4, 11)  coordinates [-]

    real(dp) :: t
    integer :: a, b, n

    t = sqrt(0.7_dp)
    barycentric(:, 1) = 0.25_dp
    barycentric(:, 2:5) = vertex_orbit(3, 1.0_dp/sqrt(5.0_dp))
    n = 5
    do a = 1, 3
      do b = a + 1, 4
        n = n + 1
        barycentric(:, n) = 0.25_dp*(1.0_dp - t)
        barycentric([a, b], n) = 0.25_dp*(1.0_dp + t)
      end do
    end do
  end function rule_11

  !> The 3-point rule in each of the four triangles between vertices and middles of edges.
  pure function rule_12() result(barycentric)
    real(dp) :: barycentric(3, 12) !! (3, 12)  coordinates [-]

    real(dp) :: corner(3, 3)
    integer :: a, b

    do a = 1, 3
      do b = 1, 3
        corner(:, b) = 0.0_dp
        corner(a, b) = 0.5_dp
        corner(b, b) = corner(b, b) + 0.5_dp
      end do
      barycentric(:, 3*a - 2:3*a) = matmul(corner, vertex_orbit(2, 0.5_dp))
    end do
    corner = 0.5_dp
    do a = 1, 3
      corner(a, a) = 0.0_dp
    end do
    barycentric(:, 10:12) = matmul(corner, vertex_orbit(2, 0.5_dp))
  end function rule_12

  !> Centroids of the k^n_dim equal simplices of Freudenthal's lattice. In the cumulative
  !! coordinates y_1 >= y_2 >= ... the simplex is a union of cells' paths: the centroid of a
  !! sub-simplex is a cell corner plus a permutation of (1, ..., n_dim)/(n_dim+1).
  pure function lattice(n_dim, k) result(barycentric)
    integer, intent(in) :: n_dim !! 2 or 3
    integer, intent(in) :: k     !! divisions of an edge, none of 0
    real(dp) :: barycentric(n_dim + 1, k**n_dim) !! (n_dim+1, k^n_dim)  coordinates [-]

    integer :: y(n_dim), i, m, n, span

    span = k*(n_dim + 1)
    n = 0
    do i = 0, span**n_dim - 1
      y = [(mod(i/span**m, span), m=n_dim - 1, 0, -1)]
      if (.not. is_centroid(y)) cycle
      n = n + 1
      barycentric(1, n) = real(span - y(1), dp)
      do m = 1, n_dim - 1
        barycentric(m + 1, n) = real(y(m) - y(m + 1), dp)
      end do
      barycentric(n_dim + 1, n) = real(y(n_dim), dp)
      barycentric(:, n) = barycentric(:, n)/real(span, dp)
    end do
  end function lattice

  !> Whether a position, in units of a cell over n_dim+1, is the centroid of a sub-simplex.
  pure logical function is_centroid(y) result(centroid)
    integer, intent(in) :: y(:) !! (n_dim)  cumulative coordinates

    integer :: m, n_dim

    n_dim = size(y)
    centroid = all(y(:n_dim - 1) > y(2:))
    do m = 1, n_dim
      centroid = centroid .and. any(mod(y, n_dim + 1) == m)
    end do
  end function is_centroid

end module mpm_point_rules
