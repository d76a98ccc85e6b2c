!> External nodal forces: weight, tractions on faces, forces on nodes.
module mpm_external_force
  use mpm_amplitude, only: amplitude_t, step_fraction, time_increment_t
  use mpm_dof_map, only: dof_map_t
  use mpm_error, only: error_t, exit_lost_point, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: face_nodes, mesh_t
  use mpm_place_text, only: place_text
  use mpm_surface_points, only: surface_of_point, surface_points_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: load_t, load_gravity, load_pressure, load_traction, load_nodal
  public :: check_applied, external_force, loaded_inactive_node, load_value, prepare_loads

  integer, parameter :: load_gravity = 1  !! *DLOAD GRAV: acceleration on the mass of points
  integer, parameter :: load_pressure = 2 !! *DSLOAD P: dead pressure, positive towards the body
  integer, parameter :: load_traction = 3 !! *DSLOAD TRVEC: dead traction per initial area
  integer, parameter :: load_nodal = 4    !! *CLOAD: force on each node of a set

  !> One load of a step. The value in force at step time t is
  !! start + (value - start)*t/period without an amplitude, value*amplitude(t) with one.
  type :: load_t
    integer  :: kind = 0                 !! load_*
    integer, allocatable :: item(:)      !! gravity: elements of the initial mesh whose points
                                         !! are loaded; nodal: nodes; surface: elements
    integer, allocatable :: face(:)      !! surface: local face of each element
    integer  :: surface = 0              !! surface of the mesh whose points carry the load, 0: the
                                         !! nodes of its faces do
    real(dp) :: value(3) = 0.0_dp        !! at the end of the step: acceleration, (p, 0, 0),
                                         !! traction vector or nodal force vector
    real(dp) :: start(3) = 0.0_dp        !! at the start of the step
    real(dp), allocatable :: axes(:, :, :) !! (n_dim, n_dim, n)  nodal: rows are the axes of each
                                         !! node of item; unallocated: global axes
    integer  :: amplitude = 0            !! index of the amplitude, 0 = linear ramp over the step
    integer  :: card = 0                 !! index of the card in the deck, for messages
    logical, allocatable  :: point(:)    !! (n_point)  gravity: loaded points; by prepare_loads
    real(dp), allocatable :: nodal(:, :) !! (n_dim, n_node)  others: force per unit value; by
                                         !! prepare_loads
  end type load_t

contains

  !> Fixes on the initial mesh what a load acts on: points for gravity, nodal forces per unit
  !! value for the rest, which are dead loads. Call it before any point or node has moved.
  pure subroutine prepare_loads(loads, mesh, points)
    type(load_t), intent(inout) :: loads(:)  !! loads of a step
    type(mesh_t), intent(in)    :: mesh      !! initial mesh
    type(points_t), intent(in)  :: points    !! initial points with their hosts
    integer :: i

    do i = 1, size(loads)
      if (loads(i)%kind == load_gravity) then
        call mark_points(loads(i), mesh, points)
        cycle
      end if
      if (allocated(loads(i)%axes) .or. loads(i)%surface > 0) cycle
      if (allocated(loads(i)%nodal)) deallocate (loads(i)%nodal)
      allocate (loads(i)%nodal(mesh%n_dim, mesh%n_node), source=0.0_dp)
      if (loads(i)%kind == load_nodal) then
        loads(i)%nodal(:, loads(i)%item) = 1.0_dp
      else
        call add_faces(loads(i), mesh)
      end if
    end do
  end subroutine prepare_loads

  !> Marks the points generated in the elements of a gravity load.
  pure subroutine mark_points(load, mesh, points)
    type(load_t), intent(inout) :: load    !! gravity
    type(mesh_t), intent(in)    :: mesh    !! initial mesh
    type(points_t), intent(in)  :: points  !! initial points with their hosts
    logical, allocatable :: loaded(:)

    allocate (loaded(0:mesh%n_el), source=.false.)
    loaded(load%item) = .true.
    loaded(0) = .false.
    load%point = loaded(points%element(points%place))
  end subroutine mark_points

  !> Nodal forces of a unit pressure or of unit tractions, an equal share to each node of a face,
  !! which is exact for a constant traction. The gradient of the shape function of the opposite
  !! node, times the volume, is the inward normal times area over n_dim.
  pure subroutine add_faces(load, mesh)
    type(load_t), intent(inout) :: load !! pressure or traction; nodal is added to
    type(mesh_t), intent(in)    :: mesh !! initial mesh
    real(dp) :: share(mesh%n_dim)
    integer :: node(mesh%n_dim)
    integer :: a, e, i

    do i = 1, size(load%item)
      e = load%item(i)
      share = mesh%volume(e)*mesh%grad_shape(:, load%face(i), e)
      if (load%kind == load_traction) share = norm2(share)
      node = face_nodes(mesh, e, load%face(i))
      do a = 1, mesh%n_dim
        load%nodal(:, node(a)) = load%nodal(:, node(a)) + share
      end do
    end do
  end subroutine add_faces

  !> External nodal forces at the end of an increment.
  pure subroutine external_force(f, loads, mesh, points, surface, increment, amplitudes)
    real(dp), intent(out) :: f(:, :)                 !! (n_dim, n_node)  [force]
    type(load_t), intent(in) :: loads(:)             !! prepared loads of the step
    type(mesh_t), intent(in) :: mesh                 !! connectivity
    type(points_t), intent(in) :: points             !! hosts, shape functions and masses
    type(surface_points_t), intent(in) :: surface    !! hosts and shape functions
    type(time_increment_t), intent(in) :: increment  !! place of the increment in the step
    type(amplitude_t), intent(in) :: amplitudes(:)   !! all amplitudes of the model
    real(dp) :: value(3)
    integer :: i, j

    f = 0.0_dp
    do i = 1, size(loads)
      value = load_value(loads(i), increment%start + increment%size, increment%period, amplitudes)
      if (loads(i)%surface > 0) then
        call add_carried(f, loads(i), value, mesh, surface)
        cycle
      end if
      select case (loads(i)%kind)
      case (load_gravity)
        call add_weight(f, loads(i)%point, value(:mesh%n_dim), mesh, points)
      case (load_pressure)
        f = f + value(1)*loads(i)%nodal
      case default
        if (allocated(loads(i)%axes)) then
          call add_turned(f, loads(i), value(:mesh%n_dim))
          cycle
        end if
        do j = 1, mesh%n_dim
          f(j, :) = f(j, :) + value(j)*loads(i)%nodal(j, :)
        end do
      end select
    end do
  end subroutine external_force

  !> Adds forces on nodes that have axes of their own. Source: theory.md (19).
  pure subroutine add_turned(f, load, value)
    real(dp), intent(inout) :: f(:, :) !! (n_dim, n_node)  [force]
    type(load_t), intent(in) :: load   !! nodal, with axes
    real(dp), intent(in) :: value(:)   !! (n_dim)  along the axes of each node [force]
    integer :: i

    do i = 1, size(load%item)
      f(:, load%item(i)) = f(:, load%item(i)) + matmul(value, load%axes(:, :, i))
    end do
  end subroutine add_turned

  !> Value of a load at a step time.
  pure function load_value(load, time, period, amplitudes) result(value)
    type(load_t), intent(in) :: load               !! load
    real(dp), intent(in) :: time                   !! step time
    real(dp), intent(in) :: period                 !! length of the step
    type(amplitude_t), intent(in) :: amplitudes(:) !! all amplitudes of the model
    real(dp) :: value(3)                           !! in the unit of load%value
    real(dp) :: base(3)

    base = merge(load%start, 0.0_dp, load%amplitude == 0)
    value = base + (load%value - base)*step_fraction(load%amplitude, time, period, amplitudes)
  end function load_value

  !> Adds sum_p m_p S_a(x_p) g over the loaded points that have a host.
  pure subroutine add_weight(f, loaded, acceleration, mesh, points)
    real(dp), intent(inout) :: f(:, :)            !! (n_dim, n_node)  [force]
    logical, intent(in)     :: loaded(:)          !! (n_point)  the load acts on the point with an id
    real(dp), intent(in)    :: acceleration(:)    !! (n_dim)  [length/time^2]
    type(mesh_t), intent(in)   :: mesh            !! connectivity
    type(points_t), intent(in) :: points          !! hosts, shape functions and masses
    integer :: a, node, p

    do p = 1, points%n
      if (.not. loaded(points%id(p)) .or. points%element(p) == 0) cycle
      do a = 1, mesh%n_dim + 1
        node = mesh%node(a, points%element(p))
        f(:, node) = f(:, node) + points%mass(p)*points%shape(a, p)*acceleration
      end do
    end do
  end subroutine add_weight

  !> Adds sum_s S_a(x_s) t_s A_s over the points of a surface. Source: theory.md (20).
  pure subroutine add_carried(f, load, value, mesh, surface)
    real(dp), intent(inout) :: f(:, :)            !! (n_dim, n_node)  [force]
    type(load_t), intent(in) :: load              !! pressure or traction, carried by points
    real(dp), intent(in) :: value(3)              !! (p, 0, 0) or traction vector
    type(mesh_t), intent(in) :: mesh              !! connectivity
    type(surface_points_t), intent(in) :: surface !! hosts and shape functions
    real(dp) :: force(mesh%n_dim)
    integer :: a, node, s

    do s = surface%first(load%surface), surface%first(load%surface + 1) - 1
      if (surface%element(s) == 0) cycle
      force = value(:mesh%n_dim)
      if (load%kind == load_pressure) force = -value(1)*surface%normal(:, s)
      force = surface%area(s)*force
      do a = 1, mesh%n_dim + 1
        node = mesh%node(a, surface%element(s))
        f(:, node) = f(:, node) + surface%shape(a, s)*force
      end do
    end do
  end subroutine add_carried

  !> The loads must act on the body: not on nodes without material, nor on lost surface points.
  pure subroutine check_applied(error, f, loads, dofs, mesh, surface)
    type(error_t), allocatable, intent(out) :: error !! exit_model or exit_lost_point
    real(dp), intent(in) :: f(:, :)                  !! (n_dim, n_node)  external forces
    type(load_t), intent(in) :: loads(:)             !! loads of the step
    type(dof_map_t), intent(in) :: dofs              !! active nodes
    type(mesh_t), intent(in) :: mesh                 !! labels and surfaces
    type(surface_points_t), intent(in) :: surface    !! located
    integer :: lost, node

    node = loaded_inactive_node(f, dofs)
    if (node > 0) then
      call make_error(error, exit_model, "error: node "//integer_text(mesh%node_label(node))// &
                      " carries a load but belongs to no element that holds material points: "// &
                      "expected loads on the body only")
      return
    end if
    lost = lost_surface_point(loads, surface)
    if (lost == 0) return
    call make_error(error, exit_lost_point, "error: the loaded surface '"// &
                    mesh%surface(surface_of_point(surface, lost))%name//"' lost the body at ("// &
                    place_text(surface%x(:, lost))//"): expected an element with material "// &
                    "points nearer than its own size")
  end subroutine check_applied

  !> First surface point of a load that has no element to act on.
  pure function lost_surface_point(loads, surface) result(lost)
    type(load_t), intent(in) :: loads(:)          !! loads of the step
    type(surface_points_t), intent(in) :: surface !! located
    integer :: lost                               !! 0 if there is none
    integer :: i

    do i = 1, size(loads)
      if (loads(i)%surface == 0) cycle
      do lost = surface%first(loads(i)%surface), surface%first(loads(i)%surface + 1) - 1
        if (surface%element(lost) == 0) return
      end do
    end do
    lost = 0
  end function lost_surface_point

  !> First node that carries a force but belongs to no active element.
  pure function loaded_inactive_node(f, dofs) result(node)
    real(dp), intent(in) :: f(:, :)     !! (n_dim, n_node)  external forces
    type(dof_map_t), intent(in) :: dofs !! active nodes
    integer :: node                     !! 0 if there is none

    do node = 1, size(f, 2)
      if (.not. dofs%active(node) .and. any(abs(f(:, node)) > 0.0_dp)) return
    end do
    node = 0
  end function loaded_inactive_node

end module mpm_external_force
