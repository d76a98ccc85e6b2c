!> Lays the background mesh out anew after an accepted increment.
module mpm_mesh_layout
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_mesh_motion, only: carry_mesh, is_along, mesh_motion_t, move_mesh
  use mpm_nodal_frames, only: in_local_axes
  use mpm_system, only: body_t, system_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: driver_displacement, lay_out_mesh

contains

  !> Moves the mesh with its driver or with the body, or leaves it where it was.
  !! Source: theory.md (17), (17b).
  pure subroutine lay_out_mesh(body, system, motion, error)
    type(body_t), intent(inout)     :: body          !! its mesh moves
    type(system_t), intent(in)      :: system        !! converged
    type(mesh_motion_t), intent(in) :: motion        !! what the mesh follows
    type(error_t), allocatable, intent(out) :: error !! an element would invert, or no driver node
                                                     !! touches the body; the mesh stays
    real(dp) :: displacement
    integer :: inverted

    if (.not. motion%active) return
    if (motion%with_body) then
      call carry_mesh(body%mesh, system%u, system%dofs%active, inverted)
    else
      call driver_displacement(displacement, system, motion, error)
      if (allocated(error)) return
      call move_mesh(body%mesh, motion, displacement, inverted)
    end if
    if (inverted == 0) return
    call make_error(error, exit_model, "error: *MOVING MESH would turn element "// &
                    integer_text(body%mesh%parent_label(body%mesh%parent(inverted)))// &
                    " inside out: expected "//remedy(motion))
  end subroutine lay_out_mesh

  !> What a motion needs so that no element inverts.
  pure function remedy(motion) result(text)
    type(mesh_motion_t), intent(in) :: motion !! what the mesh follows
    character(:), allocatable :: text

    text = "a driver that stays on its side of the fixed plane"
    if (motion%with_body) text = "a mesh that the body leaves room for, or TYPE=DRIVER"
  end function remedy

  !> Displacement of the driver along the direction: the mean over its nodes that belong to active
  !! elements, of the prescribed displacements or else of the computed ones. A prescribed
  !! displacement that is the same at all nodes is taken as it is. Source: theory.md (17b).
  pure subroutine driver_displacement(displacement, system, motion, error)
    real(dp), intent(out)           :: displacement  !! of the increment [length]
    type(system_t), intent(in)      :: system        !! converged
    type(mesh_motion_t), intent(in) :: motion        !! driver and direction
    type(error_t), allocatable, intent(out) :: error !! no driver node touches the body
    real(dp), allocatable :: normal(:), beyond(:)
    integer, allocatable :: node(:)
    integer :: n_dim

    n_dim = size(system%u, 1)
    associate (direction => motion%direction(:n_dim), first => motion%driver(1))
      normal = in_local_axes(system%dofs%frames, first, direction)
      node = pack(motion%driver, system%dofs%active(motion%driver))
      if (all(system%dofs%fixed(:, first) .or. .not. is_along(normal))) then
        displacement = dot_product(direction, system%dofs%prescribed(:, first))
        beyond = matmul(direction, system%dofs%prescribed(:, node)) - displacement
        displacement = displacement + sum(beyond)/real(max(1, size(node)), dp)
        return
      end if
      displacement = 0.0_dp
      if (size(node) > 0) then
        displacement = sum(matmul(direction, system%u(:, node)))/real(size(node), dp)
        return
      end if
    end associate
    call make_error(error, exit_model, "error: *MOVING MESH follows a driver whose "// &
                    "displacement is not prescribed, and none of its nodes belongs to an "// &
                    "element that holds material points: expected a driver that touches the body")
  end subroutine driver_displacement

end module mpm_mesh_layout
