!> Where the nodes of the background mesh go after an accepted increment.
module mpm_mesh_motion
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_mesh, only: build_geometry, mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: carry_mesh, check_motion, is_along, mesh_motion_t, move_mesh

  real(dp), parameter :: planar = 1.0e-6_dp !! farthest node off its plane, in sizes of the mesh

  !> The moving mesh: driver and fixed plane with their common normal, or a mesh that the body
  !! carries along.
  type :: mesh_motion_t
    logical :: active = .false.          !! .false.: the mesh is reset to where it was
    logical :: with_body = .false.       !! .true.: nodes keep their displacement, no planes
    integer, allocatable :: driver(:)    !! nodes of the driver plane
    integer, allocatable :: fixed(:)     !! nodes of the fixed plane
    real(dp) :: direction(3) = 0.0_dp    !! unit normal of both planes
  end type mesh_motion_t

contains

  !> Moves the nodes along the direction: the driver plane by the displacement, the fixed plane not,
  !! in between linear in the distance from the fixed plane, beyond the driver plane rigidly, beyond
  !! the fixed plane not. Gradients and volumes follow. Without motion the mesh stays.
  !! Source: formulation, moving mesh. An element that would invert leaves the mesh as it was.
  pure subroutine move_mesh(mesh, motion, displacement, error_element)
    type(mesh_t), intent(inout)     :: mesh          !! mesh, out coordinates, gradients, volumes
    type(mesh_motion_t), intent(in) :: motion        !! driver, fixed plane, direction
    real(dp), intent(in)            :: displacement  !! of the driver along the direction [length]
    integer, intent(out)            :: error_element !! first element that would invert, 0 if none

    real(dp), allocatable :: x_old(:, :)
    real(dp) :: at_driver, at_fixed, fraction
    integer :: a

    error_element = 0
    if (.not. motion%active) return
    at_driver = mean_height(mesh, motion, motion%driver)
    at_fixed = mean_height(mesh, motion, motion%fixed)
    x_old = mesh%x
    associate (direction => motion%direction(:mesh%n_dim))
      do a = 1, mesh%n_node
        fraction = (dot_product(mesh%x(:, a), direction) - at_fixed)/(at_driver - at_fixed)
        fraction = min(1.0_dp, max(0.0_dp, fraction))
        mesh%x(:, a) = mesh%x(:, a) + fraction*displacement*direction
      end do
    end associate
    call renew_geometry(mesh, x_old, error_element)
  end subroutine move_mesh

  !> Lets the nodes of the body keep a displacement; the others stay where they are. Gradients and
  !! volumes follow. Source: theory.md (17b). An element that would invert leaves the mesh as it
  !! was.
  pure subroutine carry_mesh(mesh, u, carried, error_element)
    type(mesh_t), intent(inout) :: mesh          !! mesh, out coordinates, gradients, volumes
    real(dp), intent(in)        :: u(:, :)       !! (n_dim, n_node)  displacement [length]
    logical, intent(in)         :: carried(:)    !! (n_node)         node of an active element
    integer, intent(out)        :: error_element !! first element that would invert, 0 if none

    real(dp), allocatable :: x_old(:, :)

    x_old = mesh%x
    mesh%x = mesh%x + merge(u, 0.0_dp, spread(carried, 1, mesh%n_dim))
    call renew_geometry(mesh, x_old, error_element)
  end subroutine carry_mesh

  !> Gradients and volumes at the new coordinates; the old coordinates when an element inverts.
  pure subroutine renew_geometry(mesh, x_old, error_element)
    type(mesh_t), intent(inout) :: mesh          !! with new coordinates
    real(dp), intent(in)        :: x_old(:, :)   !! (n_dim, n_node)  coordinates before [length]
    integer, intent(out)        :: error_element !! first element that would invert, 0 if none
    integer :: none

    call build_geometry(mesh, error_element)
    if (error_element == 0) return
    mesh%x = x_old
    call build_geometry(mesh, none)
  end subroutine renew_geometry

  !> Whether a motion has a component along an axis.
  elemental logical function is_along(component) result(along)
    real(dp), intent(in) :: component !! of the unit direction of the motion [-]

    along = abs(component) > 1.0e-12_dp
  end function is_along

  !> Mean position of some nodes along the direction of motion.
  pure real(dp) function mean_height(mesh, motion, node) result(height)
    type(mesh_t), intent(in)        :: mesh    !! mesh
    type(mesh_motion_t), intent(in) :: motion  !! direction
    integer, intent(in)             :: node(:) !! (n)  nodes of a plane

    height = sum(matmul(motion%direction(:mesh%n_dim), mesh%x(:, node)))/real(size(node), dp)
  end function mean_height

  !> The driver and the fixed nodes lie in two different planes normal to the direction.
  pure subroutine check_motion(motion, mesh, error)
    type(mesh_motion_t), intent(in) :: motion        !! driver, fixed plane, direction
    type(mesh_t), intent(in)        :: mesh          !! mesh
    type(error_t), allocatable, intent(out) :: error !! what is wrong with the motion

    real(dp) :: mesh_size

    if (.not. motion%active .or. motion%with_body) return
    if (abs(sum(motion%direction(:mesh%n_dim)**2) - 1.0_dp) > planar) then
      call make_error(error, exit_model, &
        "moving mesh: wrong direction: expected a unit vector in the space of the mesh")
      return
    end if
    mesh_size = maxval(maxval(mesh%x, dim=2) - minval(mesh%x, dim=2))
    call check_plane(motion, mesh, motion%driver, "driver", error)
    if (allocated(error)) return
    call check_plane(motion, mesh, motion%fixed, "fixed", error)
    if (allocated(error)) return
    if (abs(mean_height(mesh, motion, motion%driver) - mean_height(mesh, motion, motion%fixed)) > &
      planar*mesh_size) return
    call make_error(error, exit_model, &
      "moving mesh: driver and fixed nodes lie in the same plane: expected two planes")
  end subroutine check_motion

  !> Some nodes lie in one plane normal to the direction.
  pure subroutine check_plane(motion, mesh, node, role, error)
    type(mesh_motion_t), intent(in) :: motion        !! direction
    type(mesh_t), intent(in)        :: mesh          !! mesh
    integer, allocatable, intent(in) :: node(:)      !! (n)  nodes of the plane
    character(*), intent(in)        :: role          !! "driver" or "fixed"
    type(error_t), allocatable, intent(out) :: error !! the first node off the plane

    real(dp) :: height, mesh_size
    integer :: i

    i = 0
    if (allocated(node)) i = size(node)
    if (i == 0) then
      call make_error(error, exit_model, "moving mesh: no "//role// &
        " nodes: expected the nodes of a plane")
      return
    end if
    mesh_size = maxval(maxval(mesh%x, dim=2) - minval(mesh%x, dim=2))
    height = dot_product(motion%direction(:mesh%n_dim), mesh%x(:, node(1)))
    do i = 2, size(node)
      if (abs(dot_product(motion%direction(:mesh%n_dim), mesh%x(:, node(i))) - height) <= &
        planar*mesh_size) cycle
      call make_error(error, exit_model, "moving mesh: "//role//" node "// &
        integer_text(mesh%node_label(node(i)))//" is off the plane of "//role//" node "// &
        integer_text(mesh%node_label(node(1)))// &
        ": expected nodes of one plane normal to the direction")
      return
    end do
  end subroutine check_plane

end module mpm_mesh_motion
