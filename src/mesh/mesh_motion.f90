!> Where the nodes of the background mesh go after an accepted increment.
module mpm_mesh_motion
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_mesh, only: build_geometry, mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: check_motion, mesh_motion_t, move_mesh

  real(dp), parameter :: planar = 1.0e-6_dp !! farthest node off its plane, in sizes of the mesh

  !> The moving mesh: driver and fixed plane with their common normal.
  type :: mesh_motion_t
    logical :: active = .false.          !! .false.: the mesh is reset to where it was
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
    call build_geometry(mesh, error_element)
    if (error_element == 0) return
    mesh%x = x_old
    call build_geometry(mesh, a)
  end subroutine move_mesh

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

    if (.not. motion%active) return
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
