!> How large a residual is, and where.
module mpm_residual_norm
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_kinds, only: dp
  use mpm_nodal_frames, only: in_local_axes, part_along
  use mpm_system, only: system_t
  implicit none
  private
  public :: force_scale, node_of_largest, relative

contains

  !> Norm of external force and reactions, at least a millionth of stiffness times displacement:
  !! a body that moves without stress has no other forces than rounding errors.
  pure function force_scale(stiffness, system) result(scale)
    real(dp), intent(in)       :: stiffness !! largest entry of the tangent [force/length]
    type(system_t), intent(in) :: system
    real(dp) :: scale                       !! [force]
    logical :: reacts(size(system%u, 1), size(system%u, 2))

    reacts = system%dofs%fixed .and. spread(system%dofs%active, 1, size(system%u, 1))
    scale = max(norm2(part_along(system%dofs%frames, system%f_int, reacts) &
                      + part_along(system%dofs%frames, system%f_ext, .not. reacts)), &
                1.0e-6_dp*stiffness*maxval(abs(system%u)))
  end function force_scale

  !> Residual over the scale of the forces; 0 when both vanish.
  pure function relative(norm, scale) result(ratio)
    real(dp), intent(in) :: norm, scale !! [force]
    real(dp) :: ratio                   !! [-]

    if (norm <= 0.0_dp) then
      ratio = 0.0_dp
    else
      ratio = norm/max(scale, tiny(1.0_dp)/epsilon(1.0_dp), norm*1.0e-30_dp)
    end if
  end function relative

  !> Node with the largest residual; the first one where it is no number, if there is any.
  pure function node_of_largest(system) result(node)
    type(system_t), intent(in) :: system
    integer :: node
    real(dp) :: largest, here, local(size(system%u, 1))
    integer :: a

    node = 0
    largest = -1.0_dp
    do a = 1, size(system%u, 2)
      local = in_local_axes(system%dofs%frames, a, system%f_ext(:, a) - system%f_int(:, a))
      local = merge(local, 0.0_dp, system%dofs%id(:, a) > 0)
      if (.not. all(ieee_is_finite(local))) then
        node = a
        return
      end if
      here = norm2(local)
      if (here > largest) then
        largest = here
        node = a
      end if
    end do
  end function node_of_largest

end module mpm_residual_norm
