!> End of an increment: the trial state is accepted and the points move.
module mpm_point_update
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_surface_points, only: move_surface_points
  use mpm_system, only: body_t, system_t
  use mpm_tensor, only: identity
  implicit none
  private
  public :: accept_points, find_largest_move

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

  !> The point with a host that has moved farthest since its displacements were noted.
  pure subroutine find_largest_move(point, distance, points, u_before)
    integer, intent(out)       :: point          !! of equal ones the first, 0 without points
    real(dp), intent(out)      :: distance       !! length of its way [length]
    type(points_t), intent(in) :: points         !! converged
    real(dp), intent(in)       :: u_before(:, :) !! (n_dim, n)  displacements before [length]
    real(dp) :: way
    integer  :: p

    point = 0
    distance = 0.0_dp
    do p = 1, points%n
      if (points%element(p) == 0) cycle
      way = norm2(points%u(:, p) - u_before(:, p))
      if (point > 0 .and. way <= distance) cycle
      point = p
      distance = way
    end do
  end subroutine find_largest_move

end module mpm_point_update
