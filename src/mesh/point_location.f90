!> Host element of each material point: walk through neighbours, bins as fallback.
module mpm_point_location
  use mpm_element_bins, only: bin_of, build_bins, element_bins_t, is_current
  use mpm_kinds, only: dp, ip
  use mpm_material_points, only: group_points, points_t, status_extrapolated, status_frozen, &
    status_inside, status_removed
  use mpm_mesh, only: mesh_t
  use mpm_simplex, only: distance_to_simplex, simplex_shape, simplex_size
  implicit none
  private
  public :: is_inside, locate_points, locator_t, search_bins, walk
  public :: location_settings_t, location_report_t
  public :: lost_is_error, lost_is_frozen, lost_is_removed

  integer, parameter :: lost_is_error = 1   !! a lost point ends the run
  integer, parameter :: lost_is_frozen = 2  !! it stays in the results and takes no part any more
  integer, parameter :: lost_is_removed = 3 !! it leaves the results

  integer, parameter :: longest_walk = 128            !! elements after which a walk gives up
  real(dp), parameter :: inside_tolerance = 1.0e-12_dp !! least shape function of a point inside [-]

  !> What to do with points outside the mesh.
  type :: location_settings_t
    integer  :: lost_action = lost_is_error !! lost_is_*
    real(dp) :: tolerance = 0.1_dp !! farthest extrapolation, over element size [-]
  end type location_settings_t

  !> What a location of all points did.
  type :: location_report_t
    integer :: n_crossed = 0      !! points whose host changed
    integer :: n_extrapolated = 0 !! points kept although just outside
    integer :: n_lost = 0         !! points newly lost
    integer :: first_lost = 0     !! id of the first newly lost point, 0 if none
    integer :: n_walk_steps = 0   !! element tests spent in walks
    integer :: n_fallback = 0     !! points that needed the bins
    integer :: n_bin_tests = 0    !! element tests spent in bins
  end type location_report_t

  !> Search structure, built when a walk first fails and again when the mesh has moved since.
  type :: locator_t
    type(element_bins_t) :: bins !! elements by place
  end type locator_t

contains

  !> Finds the host and the shape functions of every point that is not frozen or removed, then
  !! groups the points by host. Points just outside stay with the nearest element; what becomes of
  !! those further out is in the settings and in the report. With lost_is_error a lost point keeps
  !! its host, shape functions and status. Source: formulation, end of an increment (17).
  subroutine locate_points(points, mesh, locator, settings, report)
    type(points_t), intent(inout)  :: points   !! in x and old host, out host, shape, status, groups
    type(mesh_t), intent(in)       :: mesh     !! mesh with neighbours and gradients
    type(locator_t), intent(inout) :: locator  !! bins of this mesh or of an earlier one
    type(location_settings_t), intent(in) :: settings !! what to do outside the mesh
    type(location_report_t), intent(out)  :: report   !! what was done

    real(dp) :: shape(mesh%n_dim + 1)
    integer, allocatable :: host(:)
    integer :: n_steps, n_walk_steps, p

    allocate (host(points%n), source=0)
    n_walk_steps = 0
    !$omp parallel do default(shared) private(p, shape, n_steps) reduction(+:n_walk_steps)
    do p = 1, points%n
      if (points%status(p) == status_frozen .or. points%status(p) == status_removed) cycle
      call walk(mesh, points%x(:, p), points%element(p), p, host(p), shape, n_steps)
      n_walk_steps = n_walk_steps + n_steps
      if (host(p) == 0) cycle
      points%shape(:, p) = shape
      points%status(p) = status_inside
    end do
    !$omp end parallel do
    report%n_walk_steps = n_walk_steps
    call search_all(points, mesh, locator, settings, host, report)
    report%n_crossed = count(host > 0 .and. host /= points%element)
    where (host > 0) points%element = host
    call group_points(points, mesh%n_el)
  end subroutine locate_points

  !> The points that no walk found: bins, extrapolation, loss.
  subroutine search_all(points, mesh, locator, settings, host, report)
    type(points_t), intent(inout)  :: points   !! out shape and status
    type(mesh_t), intent(in)       :: mesh     !! mesh
    type(locator_t), intent(inout) :: locator  !! bins, made when needed
    type(location_settings_t), intent(in)    :: settings !! what to do outside the mesh
    integer, intent(inout)         :: host(:)  !! (n)  in 0: the walk failed, out found
    type(location_report_t), intent(inout)   :: report   !! counts

    real(dp) :: shape(mesh%n_dim + 1)
    logical, allocatable :: eligible(:)
    integer, allocatable :: stray(:)
    integer :: i, n_bin_tests, n_tests, p

    stray = pack([(p, p=1, points%n)], host == 0 .and. points%status /= status_frozen &
      .and. points%status /= status_removed)
    if (size(stray) == 0) return
    report%n_fallback = size(stray)
    if (.not. is_current(locator%bins, mesh, settings%tolerance)) then
      call build_bins(locator%bins, mesh, settings%tolerance)
    end if
    allocate (eligible(mesh%n_el), source=.true.)
    n_bin_tests = 0
    !$omp parallel do default(shared) private(i, p, shape, n_tests) reduction(+:n_bin_tests)
    do i = 1, size(stray)
      p = stray(i)
      call search_bins(locator%bins, mesh, eligible, points%x(:, p), host(p), shape, n_tests)
      n_bin_tests = n_bin_tests + n_tests
      if (host(p) == 0) cycle
      points%shape(:, p) = shape
      points%status(p) = merge(status_inside, status_extrapolated, is_inside(shape))
    end do
    !$omp end parallel do
    report%n_bin_tests = n_bin_tests
    report%n_extrapolated = count(points%status(stray) == status_extrapolated .and. host(stray) > 0)
    stray = pack(stray, host(stray) == 0)
    do i = 1, size(stray)
      call lose(points, stray(i), settings, report)
    end do
  end subroutine search_all

  !> Treats a lost point as the settings say.
  pure subroutine lose(points, p, settings, report)
    type(points_t), intent(inout) :: points               !! out host and status of the point
    integer, intent(in)           :: p                    !! the point
    type(location_settings_t), intent(in)  :: settings    !! what to do with it
    type(location_report_t), intent(inout) :: report      !! one loss more

    report%n_lost = report%n_lost + 1
    if (report%first_lost == 0 .or. points%id(p) < report%first_lost) report%first_lost = points%id(p)
    select case (settings%lost_action)
    case (lost_is_frozen)
      points%status(p) = status_frozen
      points%element(p) = 0
    case (lost_is_removed)
      points%status(p) = status_removed
      points%element(p) = 0
    case default
      return
    end select
  end subroutine lose

  !> Walks through neighbours: leaves an element through the face of the most negative shape
  !! function and, once an element comes up again, through a random one of the negative faces.
  !! Gives up at the boundary of the mesh. Source: Devillers, Pion and Teillaud 2002.
  pure subroutine walk(mesh, x, start, seed, element, shape, n_steps)
    type(mesh_t), intent(in) :: mesh     !! mesh with neighbours and gradients
    real(dp), intent(in)     :: x(:)     !! (n_dim)    position [length]
    integer, intent(in)      :: start    !!            first element, 0 if none
    integer, intent(in)      :: seed     !!            of the random choices
    integer, intent(out)     :: element  !!            element around the position, 0 if none
    real(dp), intent(out)    :: shape(:) !! (n_dim+1)  shape functions there [-]
    integer, intent(out)     :: n_steps  !!            elements tested

    integer(ip) :: random
    integer :: face, visited(longest_walk)
    logical :: at_random

    element = start
    n_steps = 0
    random = int(seed, ip)
    at_random = .false.
    shape = 0.0_dp
    do while (element > 0)
      if (n_steps == longest_walk) exit
      n_steps = n_steps + 1
      visited(n_steps) = element
      shape = simplex_shape(mesh%x(:, mesh%node(1, element)), mesh%grad_shape(:, :, element), x)
      if (is_inside(shape)) return
      if (.not. at_random) at_random = any(visited(:n_steps - 1) == element)
      face = minloc(shape, dim=1)
      if (at_random) call choose_negative(shape, random, face)
      element = mesh%neighbour(face, element)
    end do
    element = 0
  end subroutine walk

  !> Chooses one of the negative shape functions with a linear congruential generator.
  pure subroutine choose_negative(shape, random, face)
    real(dp), intent(in)       :: shape(:) !! (n_dim+1)  shape functions, at least one negative [-]
    integer(ip), intent(inout) :: random   !!            state of the generator
    integer, intent(out)       :: face     !!            local node opposite the face

    integer, allocatable :: negative(:)
    integer :: a

    negative = pack([(a, a=1, size(shape))], shape < -inside_tolerance)
    random = mod(1103515245_ip*random + 12345_ip, 2147483648_ip)
    face = negative(int(mod(random/65536_ip, int(size(negative), ip))) + 1)
  end subroutine choose_negative

  !> Whether shape functions are those of a position inside their element.
  pure logical function is_inside(shape) result(inside)
    real(dp), intent(in) :: shape(:) !! (n_dim+1)  shape functions [-]

    inside = all(shape >= -inside_tolerance)
  end function is_inside

  !> Tests the eligible elements of the bin that holds a position: the first one that contains it,
  !! else the nearest of those that are nearer than the reach of the bins times their own size.
  pure subroutine search_bins(bins, mesh, eligible, x, element, shape, n_tests)
    type(element_bins_t), intent(in) :: bins !! bins of this mesh
    type(mesh_t), intent(in) :: mesh         !! mesh
    logical, intent(in)      :: eligible(:)  !! (n_el)     may be the host
    real(dp), intent(in)     :: x(:)         !! (n_dim)    position [length]
    integer, intent(out)     :: element      !!            host, 0 if there is none
    real(dp), intent(out)    :: shape(:)     !! (n_dim+1)  shape functions of the host [-]
    integer, intent(out)     :: n_tests      !!            elements tested

    real(dp) :: distance, least
    integer :: bin, e, i

    element = 0
    n_tests = 0
    shape = 0.0_dp
    least = huge(1.0_dp)
    bin = bin_of(bins, x)
    if (bin == 0) return
    do i = bins%first(bin), bins%first(bin + 1) - 1
      e = bins%element(i)
      n_tests = n_tests + 1
      if (.not. eligible(e)) cycle
      if (any(x < bins%box(:, 1, e)) .or. any(x > bins%box(:, 2, e))) cycle
      shape = simplex_shape(mesh%x(:, mesh%node(1, e)), mesh%grad_shape(:, :, e), x)
      if (is_inside(shape)) then
        element = e
        return
      end if
      distance = distance_to_simplex(x, mesh%x(:, mesh%node(:, e)))
      if (distance >= min(least, bins%reach*simplex_size(mesh%n_dim, mesh%volume(e)))) cycle
      least = distance
      element = e
    end do
    if (element == 0) return
    shape = simplex_shape(mesh%x(:, mesh%node(1, element)), mesh%grad_shape(:, :, element), x)
  end subroutine search_bins

end module mpm_point_location
