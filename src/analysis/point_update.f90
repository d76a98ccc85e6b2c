!> End of an increment: the trial state is accepted and the points move.
module mpm_point_update
  use mpm_kinds, only: dp
  use mpm_surface_points, only: move_surface_points
  use mpm_system, only: body_t, system_t
  use mpm_tensor, only: identity
  implicit none
  private
  public :: accept_points

contains

  !> Positions, displacements, F = dF F, v = det(dFbar) v_n, and the trial state become the
  !! converged ones. Source: theory.md (10), (16).
  subroutine accept_points(body, system)
    type(body_t), intent(inout) :: body      !! points are updated, the mesh is not
    type(system_t), intent(in)  :: system    !! converged
    integer :: i, p, e
    real(dp) :: move(body%mesh%n_dim)

    associate (points => body%points)
      !$omp parallel do default(shared) private(p, e, move)
      do i = 1, size(points%order)
        p = points%order(i)
        e = points%element(p)
        move = matmul(system%u(:, body%mesh%node(:, e)), points%shape(:, p))
        points%x(:, p) = points%x(:, p) + move
        points%u(:, p) = points%u(:, p) + move
        points%def_grad(:, :, p) = matmul(identity + system%kinematics%disp_grad(:, :, e), &
                                          points%def_grad(:, :, p))
        points%volume(p) = points%volume(p)*(1.0_dp + system%kinematics%delta_j_bar_m1(e))
      end do
      !$omp end parallel do
      points%state = system%trial
    end associate
    call move_surface_points(body%surface, body%mesh, system%u)
  end subroutine accept_points

end module mpm_point_update
