!> Material points: position, host element, history and stress, as structure of arrays.
module mpm_material_points
  use mpm_error, only: error_t, exit_model, exit_solver, make_error
  use mpm_kinds, only: dp, ip
  use mpm_memory, only: has_room, megabytes
  use mpm_mesh, only: mesh_t
  use mpm_point_rules, only: available_rules, point_rule
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: points_t, point_state_t, n_hardening
  public :: allocate_points, allocate_state, bytes_of_points, generate_points
  public :: group_points, hand_over, sort_points, unsort_points
  public :: centre_of_mass, nearest_point, total_mass, total_volume
  public :: status_inside, status_extrapolated, status_frozen, status_removed

  integer, parameter :: n_hardening = 1         !! hardening variables of a point: 1 = PEEQ
  integer, parameter :: status_inside = 0       !! inside its host element
  integer, parameter :: status_extrapolated = 1 !! just outside the mesh, kept by its host
  integer, parameter :: status_frozen = 2       !! lost, kept in the file, without host
  integer, parameter :: status_removed = 3      !! lost and taken out, without host

  !> The converged state of the points.
  !! Voigt order 11, 22, 33, 12, 23, 13, tensor components (never engineering shear).
  type :: point_state_t
    real(dp), allocatable :: strain_e(:, :)    !! (6, n)  elastic logarithmic strain [-]
    real(dp), allocatable :: left_cauchy_green_e_m1(:, :) !! (6, n)  b_e - 1 [-]
    real(dp), allocatable :: hardening(:, :)   !! (n_hardening, n)  accumulated plastic strain [-]
    real(dp), allocatable :: cauchy(:, :)      !! (6, n)  Cauchy stress [force/length^2]
    real(dp), allocatable :: jacobian_bar(:)   !! (n)     product of all det dFbar [-]
  end type point_state_t

  !> The points; item index last.
  type :: points_t
    integer :: n = 0
    real(dp), allocatable :: x(:, :)        !! (n_dim, n)    position [length]
    real(dp), allocatable :: u(:, :)        !! (n_dim, n)    total displacement [length]
    integer, allocatable  :: id(:)          !! (n)           1..n, constant over the run
    integer, allocatable  :: place(:)       !! (n)           where the point with an id stands
    integer, allocatable  :: element(:)     !! (n)           host element, 0 when frozen or removed
    integer, allocatable  :: material(:)    !! (n)           index of the material
    integer, allocatable  :: status(:)      !! (n)           status_*
    real(dp), allocatable :: shape(:, :)    !! (n_dim+1, n)  shape functions of the host
    real(dp), allocatable :: volume_0(:)    !! (n)           reference volume (2-D: area)
    real(dp), allocatable :: volume(:)      !! (n)           volume, converged
    real(dp), allocatable :: mass(:)        !! (n)           density times reference volume
    real(dp), allocatable :: def_grad(:, :, :) !! (3, 3, n)  F, converged
    integer, allocatable  :: first(:)       !! (n_el+1)      start of each element in order
    integer, allocatable  :: order(:)       !! (n with a host)
    type(point_state_t)   :: state          !! converged state
  end type points_t

contains

  !> Fills elements with points by a rule and appends them to the points there are.
  !! An element that already holds points, or stands twice in the list, is a model error; too
  !! little memory for the points has the code exit_solver.
  subroutine generate_points(points, mesh, elements, material, n_per_element, density, error)
    type(points_t), intent(inout) :: points          !! points, out the new ones appended
    type(mesh_t), intent(in) :: mesh                 !! mesh with gradients and volumes
    integer, intent(in)      :: elements(:)          !! (m)  linear elements to fill
    integer, intent(in)      :: material             !! index of the material
    integer, intent(in)      :: n_per_element        !! points per element
    real(dp), intent(in)     :: density              !! mass per reference volume
    type(error_t), allocatable, intent(out) :: error !! no such rule, or an element filled twice

    real(dp), allocatable :: barycentric(:, :), weight(:)
    logical :: found
    integer :: i, k, n_old, p

    call point_rule(mesh%n_dim, n_per_element, barycentric, weight, found)
    if (.not. found) then
      call make_error(error, exit_model, integer_text(n_per_element)// &
        " points per element: expected "//available_rules(mesh%n_dim))
      return
    end if
    call check_empty(points, mesh, elements, error)
    if (allocated(error)) return
    n_old = points%n
    call check_memory(n_old + n_per_element*size(elements), mesh%n_dim, error)
    if (allocated(error)) return
    call append_blank_points(points, mesh%n_dim, n_per_element*size(elements))
    do i = 1, size(elements)
      do k = 1, n_per_element
        p = n_old + n_per_element*(i - 1) + k
        points%element(p) = elements(i)
        points%shape(:, p) = barycentric(:, k)
        points%x(:, p) = matmul(mesh%x(:, mesh%node(:, elements(i))), barycentric(:, k))
        points%volume_0(p) = weight(k)*mesh%volume(elements(i))
      end do
    end do
    points%material(n_old + 1:) = material
    points%volume(n_old + 1:) = points%volume_0(n_old + 1:)
    points%mass(n_old + 1:) = density*points%volume_0(n_old + 1:)
    call group_points(points, mesh%n_el)
  end subroutine generate_points

  !> There is memory for so many points, three times while they are put together.
  subroutine check_memory(n, n_dim, error)
    integer, intent(in) :: n                         !! points
    integer, intent(in) :: n_dim                     !! 2 or 3
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    integer(ip) :: n_bytes

    n_bytes = 3_ip*bytes_of_points(n, n_dim)
    if (has_room(n_bytes)) return
    call make_error(error, exit_solver, "not enough memory for "//integer_text(n)// &
      " material points, about "//real_text(megabytes(real(n_bytes, dp)))// &
      " MB are needed: expected fewer points per element, or fewer elements with points")
  end subroutine check_memory

  !> Memory of points and their state.
  pure integer(ip) function bytes_of_points(n, n_dim) result(n_bytes)
    integer, intent(in) :: n     !! points
    integer, intent(in) :: n_dim !! 2 or 3
    integer, parameter :: reals_of_state = 3*6 + n_hardening + 1

    n_bytes = int(n, ip)*(6*storage_size(n)/8 + (reals_of_state + 3*n_dim + 1 + 3 + 9) &
                          *(storage_size(1.0_dp)/8))
  end function bytes_of_points

  !> None of the elements holds a point, and none stands twice in the list.
  pure subroutine check_empty(points, mesh, elements, error)
    type(points_t), intent(in) :: points             !! points there are
    type(mesh_t), intent(in)   :: mesh               !! mesh
    integer, intent(in)        :: elements(:)        !! (m)  linear elements to fill
    type(error_t), allocatable, intent(out) :: error !! the first filled element

    logical, allocatable :: filled(:)
    integer :: i, p

    allocate (filled(mesh%n_el), source=.false.)
    do p = 1, points%n
      if (points%element(p) > 0) filled(points%element(p)) = .true.
    end do
    do i = 1, size(elements)
      if (filled(elements(i))) then
        call make_error(error, exit_model, "element "// &
          integer_text(mesh%parent_label(mesh%parent(elements(i))))// &
          " already holds material points: expected regions that do not overlap")
        return
      end if
      filled(elements(i)) = .true.
    end do
  end subroutine check_empty

  !> Makes room for more points; the old ones keep their values, the new ones are undeformed,
  !! without stress and without host.
  pure subroutine append_blank_points(points, n_dim, n_new)
    type(points_t), intent(inout) :: points !! points, out n_new more
    integer, intent(in)           :: n_dim  !! 2 or 3
    integer, intent(in)           :: n_new  !! points to add

    type(points_t) :: longer

    call allocate_points(longer, n_dim, points%n + n_new)
    associate (n => points%n)
      if (n > 0) then
        longer%x(:, :n) = points%x
        longer%u(:, :n) = points%u
        longer%element(:n) = points%element
        longer%material(:n) = points%material
        longer%status(:n) = points%status
        longer%shape(:, :n) = points%shape
        longer%volume_0(:n) = points%volume_0
        longer%volume(:n) = points%volume
        longer%mass(:n) = points%mass
        longer%def_grad(:, :, :n) = points%def_grad
        longer%state%strain_e(:, :n) = points%state%strain_e
        longer%state%left_cauchy_green_e_m1(:, :n) = points%state%left_cauchy_green_e_m1
        longer%state%hardening(:, :n) = points%state%hardening
        longer%state%cauchy(:, :n) = points%state%cauchy
        longer%state%jacobian_bar(:n) = points%state%jacobian_bar
      end if
    end associate
    points = longer
  end subroutine append_blank_points

  !> Allocates undeformed points without stress and without host, numbered from 1.
  pure subroutine allocate_points(points, n_dim, n)
    type(points_t), intent(out) :: points !! points
    integer, intent(in)         :: n_dim  !! 2 or 3
    integer, intent(in)         :: n      !! number of points

    integer :: i, p

    points%n = n
    points%id = [(p, p=1, n)]
    points%place = points%id
    allocate (points%x(n_dim, n), points%u(n_dim, n), points%shape(n_dim + 1, n), source=0.0_dp)
    allocate (points%element(n), points%material(n), source=0)
    allocate (points%status(n), source=status_inside)
    allocate (points%volume_0(n), points%volume(n), points%mass(n), source=0.0_dp)
    allocate (points%def_grad(3, 3, n), source=0.0_dp)
    do i = 1, 3
      points%def_grad(i, i, :) = 1.0_dp
    end do
    call allocate_state(points%state, n)
  end subroutine allocate_points

  !> Allocates the state of undeformed points without stress.
  pure subroutine allocate_state(state, n)
    type(point_state_t), intent(out) :: state !! state
    integer, intent(in)              :: n     !! number of points

    allocate (state%strain_e(6, n), state%left_cauchy_green_e_m1(6, n), source=0.0_dp)
    allocate (state%hardening(n_hardening, n), state%cauchy(6, n), source=0.0_dp)
    allocate (state%jacobian_bar(n), source=1.0_dp)
  end subroutine allocate_state

  !> Groups the points that have a host by it, in ascending order of their id within an element: sums
  !! over the points of an element do not depend on where the points stand.
  pure subroutine group_points(points, n_el)
    type(points_t), intent(inout) :: points !! in element, out first and order
    integer, intent(in)           :: n_el   !! elements of the mesh

    integer, allocatable :: next(:)
    integer :: e, p

    if (allocated(points%first)) deallocate (points%first)
    if (allocated(points%order)) deallocate (points%order)
    allocate (points%first(n_el + 1), source=0)
    allocate (points%order(count(points%element > 0)))
    do p = 1, points%n
      e = points%element(p)
      if (e > 0) points%first(e + 1) = points%first(e + 1) + 1
    end do
    points%first(1) = 1
    do e = 1, n_el
      points%first(e + 1) = points%first(e + 1) + points%first(e)
    end do
    next = points%first
    do p = 1, points%n
      e = points%element(p)
      if (e == 0) cycle
      points%order(next(e)) = p
      next(e) = next(e) + 1
    end do
    do e = 1, n_el
      call sort_by_id(points%order(points%first(e):points%first(e + 1) - 1), points%id)
    end do
  end subroutine group_points

  !> Sorts a few points, nearly in order, by insertion.
  pure subroutine sort_by_id(order, id)
    integer, intent(inout) :: order(:) !! points
    integer, intent(in)    :: id(:)    !! (n)
    integer :: i, k, p

    do i = 2, size(order)
      p = order(i)
      do k = i - 1, 1, -1
        if (id(order(k)) <= id(p)) exit
        order(k + 1) = order(k)
      end do
      order(k + 1) = p
    end do
  end subroutine sort_by_id

  !> Moves the points so that they stand in the order of their groups, those without a host last:
  !! what is done to all points of an element then walks along the memory.
  pure subroutine sort_points(points)
    type(points_t), intent(inout) :: points !! grouped; every array in the new order
    integer :: p

    call permute(points, [points%order, pack(points%place, points%element(points%place) == 0)])
    points%order = [(p, p=1, size(points%order))]
  end subroutine sort_points

  !> Moves the points back into the order of their ids.
  pure subroutine unsort_points(points, n_el)
    type(points_t), intent(inout) :: points !! in the order of their ids, grouped
    integer, intent(in)           :: n_el   !! elements of the mesh

    call permute(points, points%place)
    call group_points(points, n_el)
  end subroutine unsort_points

  !> Gives the points another order; their groups are those of the former.
  pure subroutine permute(points, order)
    type(points_t), intent(inout) :: points
    integer, intent(in)           :: order(:) !! (n)  former places in the new order
    integer :: p

    if (all(order == [(p, p=1, points%n)])) return
    points%x = points%x(:, order)
    points%u = points%u(:, order)
    points%id = points%id(order)
    points%element = points%element(order)
    points%material = points%material(order)
    points%status = points%status(order)
    points%shape = points%shape(:, order)
    points%volume_0 = points%volume_0(order)
    points%volume = points%volume(order)
    points%mass = points%mass(order)
    points%def_grad = points%def_grad(:, :, order)
    associate (state => points%state)
      state%strain_e = state%strain_e(:, order)
      state%left_cauchy_green_e_m1 = state%left_cauchy_green_e_m1(:, order)
      state%hardening = state%hardening(:, order)
      state%cauchy = state%cauchy(:, order)
      state%jacobian_bar = state%jacobian_bar(order)
    end associate
    points%place(points%id) = [(p, p=1, points%n)]
  end subroutine permute

  !> Gives the arrays of all points away without copying them.
  pure subroutine hand_over(from, to)
    type(points_t), intent(inout) :: from !! without arrays afterwards; n still tells how many there were
    type(points_t), intent(out)   :: to

    to%n = from%n
    call move_alloc(from%x, to%x)
    call move_alloc(from%u, to%u)
    call move_alloc(from%id, to%id)
    call move_alloc(from%place, to%place)
    call move_alloc(from%element, to%element)
    call move_alloc(from%material, to%material)
    call move_alloc(from%status, to%status)
    call move_alloc(from%shape, to%shape)
    call move_alloc(from%volume_0, to%volume_0)
    call move_alloc(from%volume, to%volume)
    call move_alloc(from%mass, to%mass)
    call move_alloc(from%def_grad, to%def_grad)
    call move_alloc(from%first, to%first)
    call move_alloc(from%order, to%order)
    call move_alloc(from%state%strain_e, to%state%strain_e)
    call move_alloc(from%state%left_cauchy_green_e_m1, to%state%left_cauchy_green_e_m1)
    call move_alloc(from%state%hardening, to%state%hardening)
    call move_alloc(from%state%cauchy, to%state%cauchy)
    call move_alloc(from%state%jacobian_bar, to%state%jacobian_bar)
  end subroutine hand_over

  !> Volume of all points that have a host (2-D: area).
  pure real(dp) function total_volume(points) result(volume)
    type(points_t), intent(in) :: points !! points

    volume = sum(points%volume, mask=points%element > 0)
  end function total_volume

  !> Mass of all points that have a host.
  pure real(dp) function total_mass(points) result(mass)
    type(points_t), intent(in) :: points !! points

    mass = sum(points%mass, mask=points%element > 0)
  end function total_mass

  !> Centre of mass of all points that have a host; of their volume where they have no mass.
  pure function centre_of_mass(points) result(centre)
    type(points_t), intent(in) :: points     !! points
    real(dp) :: centre(size(points%x, 1))    !! (n_dim)  position, zero without points [length]

    real(dp), allocatable :: weight(:)
    integer :: i

    weight = merge(points%mass, 0.0_dp, points%element > 0)
    if (sum(weight) <= 0.0_dp) weight = merge(points%volume, 0.0_dp, points%element > 0)
    centre = 0.0_dp
    if (sum(weight) <= 0.0_dp) return
    do i = 1, size(centre)
      centre(i) = sum(weight*points%x(i, :))/sum(weight)
    end do
  end function centre_of_mass

  !> The point with a host nearest to a position, of equally near ones the first; 0 without points.
  pure integer function nearest_point(points, x) result(nearest)
    type(points_t), intent(in) :: points !! points
    real(dp), intent(in)       :: x(:)   !! (n_dim)  position [length]

    real(dp) :: distance, least
    integer :: p

    nearest = 0
    least = huge(1.0_dp)
    do p = 1, points%n
      if (points%element(p) == 0) cycle
      distance = sum((points%x(:, p) - x)**2)
      if (distance >= least) cycle
      nearest = p
      least = distance
    end do
  end function nearest_point

end module mpm_material_points
