!> Massless points on loaded surfaces of the body: they move with it and carry dead tractions.
module mpm_surface_points
  use mpm_element_bins, only: build_bins, is_current
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: face_geometry, mesh_t
  use mpm_point_location, only: locator_t, search_bins, walk
  use mpm_point_rules, only: point_rule
  implicit none
  private
  public :: surface_points_t
  public :: locate_surface_points, move_surface_points, sample_surfaces, surface_of_point

  !> A surface point with an empty element acts on the nearest active one, when it is nearer to it
  !! than so many times the size of that element [-].
  real(dp), parameter :: surface_reach = 1.0_dp

  !> The points, surface by surface; item index last.
  type :: surface_points_t
    integer :: n = 0
    integer, allocatable  :: first(:)     !! (n_surface+1)  first point of each surface of the mesh
    real(dp), allocatable :: x(:, :)      !! (n_dim, n)    position [length]
    integer, allocatable  :: element(:)   !! (n)           element it acts on, 0 when lost
    real(dp), allocatable :: shape(:, :)  !! (n_dim+1, n)  shape functions of that element [-]
    real(dp), allocatable :: area(:)      !! (n)           share of the initial area (2-D: length)
    real(dp), allocatable :: normal(:, :) !! (n_dim, n)    initial outward unit normal [-]
    type(locator_t) :: locator            !! search structure
  end type surface_points_t

contains

  !> Puts points on the faces of surfaces, as densely as the material points lie in their elements.
  !! Linear functions are integrated exactly. Source: theory.md (20).
  pure subroutine sample_surfaces(surface, mesh, points, sampled)
    type(surface_points_t), intent(out) :: surface !! points on their faces
    type(mesh_t), intent(in)   :: mesh             !! initial mesh
    type(points_t), intent(in) :: points           !! initial points, grouped by host
    logical, intent(in)        :: sampled(:)       !! (n_surface)  gets points

    real(dp), allocatable :: area(:), normal(:, :), weight(:, :)
    integer :: i, k, n, s

    surface%first = [(1, i=0, size(sampled))]
    do k = 1, size(sampled)
      n = 0
      if (sampled(k)) n = sum([(size(face_rule(mesh, points, mesh%surface(k)%element(i)), 2), &
                                i=1, size(mesh%surface(k)%element))])
      surface%first(k + 1) = surface%first(k) + n
    end do
    surface%n = surface%first(size(sampled) + 1) - 1
    call allocate_surface_points(surface, mesh%n_dim)
    do k = 1, size(sampled)
      if (.not. sampled(k)) cycle
      call face_geometry(mesh, mesh%surface(k), area, normal)
      s = surface%first(k)
      do i = 1, size(area)
        weight = face_rule(mesh, points, mesh%surface(k)%element(i))
        n = size(weight, 2)
        surface%area(s:s + n - 1) = area(i)/real(n, dp)
        surface%normal(:, s:s + n - 1) = spread(normal(:, i), 2, n)
        call place_on_face(surface, s, mesh, [mesh%surface(k)%element(i), &
          mesh%surface(k)%face(i)], weight)
        s = s + n
      end do
    end do
  end subroutine sample_surfaces

  !> Makes room for the points.
  pure subroutine allocate_surface_points(surface, n_dim)
    type(surface_points_t), intent(inout) :: surface !! n is set
    integer, intent(in) :: n_dim                     !! 2 or 3

    allocate (surface%x(n_dim, surface%n), source=0.0_dp)
    allocate (surface%normal, source=surface%x)
    allocate (surface%shape(n_dim + 1, surface%n), source=0.0_dp)
    allocate (surface%area(surface%n), source=0.0_dp)
    allocate (surface%element(surface%n), source=0)
  end subroutine allocate_surface_points

  !> Coordinates of the points of a face over its corners; the points have equal weights. Two Gauss
  !! points on an edge, three points on a triangle; with more than two material points along an edge
  !! of the element, as many on the edge, or the centroids of so many sub-triangles squared.
  pure function face_rule(mesh, points, element) result(weight)
    type(mesh_t), intent(in)   :: mesh    !! initial mesh
    type(points_t), intent(in) :: points  !! initial points, grouped by host
    integer, intent(in)        :: element !! element of the face
    real(dp), allocatable :: weight(:, :) !! (n_dim, n)  shape functions of the face, per point [-]

    real(dp), allocatable :: equal(:)
    real(dp), parameter :: gauss = 0.5_dp/sqrt(3.0_dp)
    integer :: i, along
    logical :: found

    along = nint(real(points%first(element + 1) - points%first(element), dp) &
                 **(1.0_dp/real(mesh%n_dim, dp)))
    if (mesh%n_dim == 3) then
      call point_rule(2, merge(3, along**2, along <= 2), weight, equal, found)
    else if (along <= 2) then
      weight = reshape([0.5_dp + gauss, 0.5_dp - gauss, 0.5_dp - gauss, 0.5_dp + gauss], [2, 2])
    else
      equal = [((real(i, dp) - 0.5_dp)/real(along, dp), i=1, along)]
      weight = transpose(reshape([1.0_dp - equal, equal], [along, 2]))
    end if
  end function face_rule

  !> Places the points of one face.
  pure subroutine place_on_face(surface, s, mesh, face, weight)
    type(surface_points_t), intent(inout) :: surface !! element, shape, x of n points are set
    integer, intent(in)      :: s             !! first point of the face
    type(mesh_t), intent(in) :: mesh          !! initial mesh
    integer, intent(in)      :: face(2)       !! (2)  element, local node opposite the face
    real(dp), intent(in)     :: weight(:, :)  !! (n_dim, n)  coordinates over the corners [-]

    integer :: a, corner(mesh%n_dim), i

    corner = pack([(a, a=1, mesh%n_dim + 1)], [(a /= face(2), a=1, mesh%n_dim + 1)])
    do i = 1, size(weight, 2)
      surface%element(s + i - 1) = face(1)
      surface%shape(corner, s + i - 1) = weight(:, i)
      surface%x(:, s + i - 1) = matmul(mesh%x(:, mesh%node(corner, face(1))), weight(:, i))
    end do
  end subroutine place_on_face

  !> Moves the points with the displacement of an increment, like material points.
  !! Source: theory.md (16).
  pure subroutine move_surface_points(surface, mesh, u)
    type(surface_points_t), intent(inout) :: surface !! x is updated
    type(mesh_t), intent(in) :: mesh                 !! connectivity
    real(dp), intent(in)     :: u(:, :)              !! (n_dim, n_node)  displacement [length]

    integer :: s

    do s = 1, surface%n
      if (surface%element(s) == 0) cycle
      surface%x(:, s) = surface%x(:, s) &
                        + matmul(u(:, mesh%node(:, surface%element(s))), surface%shape(:, s))
    end do
  end subroutine move_surface_points

  !> Finds the active element that each point acts on: the one that holds it, else the nearest
  !! within reach, whose shape functions extrapolate. A point beyond the reach loses its element.
  pure subroutine locate_surface_points(surface, mesh, active)
    type(surface_points_t), intent(inout) :: surface !! element and shape are updated
    type(mesh_t), intent(in) :: mesh                 !! where it is now
    logical, intent(in)      :: active(:)            !! (n_el)  hosts a material point

    real(dp) :: shape(mesh%n_dim + 1)
    integer  :: host, n_tests, s
    logical  :: found

    do s = 1, surface%n
      if (surface%element(s) == 0) cycle
      call walk(mesh, surface%x(:, s), surface%element(s), s, host, shape, n_tests)
      found = host > 0
      if (found) found = active(host)
      if (.not. found) then
        if (.not. is_current(surface%locator%bins, mesh, surface_reach)) then
          call build_bins(surface%locator%bins, mesh, surface_reach)
        end if
        call search_bins(surface%locator%bins, mesh, active, surface%x(:, s), host, shape, n_tests)
      end if
      surface%element(s) = host
      surface%shape(:, s) = shape
    end do
  end subroutine locate_surface_points

  !> The surface that a point belongs to.
  pure integer function surface_of_point(surface, s) result(k)
    type(surface_points_t), intent(in) :: surface !! points
    integer, intent(in) :: s                      !! point

    k = count(surface%first <= s)
  end function surface_of_point

end module mpm_surface_points
