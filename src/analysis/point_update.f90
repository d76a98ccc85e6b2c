!> End of an increment: the points move and take their new states.
module mpm_point_update
  use mpm_kinds, only: dp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_stress_batch, only: accept_batch, batch_size, put_point, set_material, stress_batch_t
  use mpm_surface_points, only: move_surface_points
  use mpm_system, only: body_t, system_t
  use mpm_tensor, only: identity
  implicit none
  private
  public :: accept_points, find_largest_move

contains

  !> Positions, displacements, F = dF F, v = det(dFbar) v_n, and the states, which the kinematics of
  !! the solution give once more. Source: theory.md (6)-(10), (16).
  subroutine accept_points(body, system)
    type(body_t), intent(inout) :: body      !! points are updated, the mesh is not
    type(system_t), intent(in)  :: system    !! converged
    integer :: first, last

    !$omp parallel do default(shared) private(last)
    do first = 1, size(body%points%order), batch_size
      last = min(first + batch_size - 1, size(body%points%order))
      call move_points(body%points, body%mesh, system, first, last)
      call accept_states(body%points, body%material, system%kinematics, first, last)
    end do
    !$omp end parallel do
    call move_surface_points(body%surface, body%mesh, system%u)
  end subroutine accept_points

  !> Motion and volumes of some points.
  pure subroutine move_points(points, mesh, system, first, last)
    type(points_t), intent(inout) :: points
    type(mesh_t), intent(in)      :: mesh
    type(system_t), intent(in)    :: system      !! converged
    integer, intent(in)           :: first, last !! range of points%order
    real(dp) :: move(mesh%n_dim)
    integer  :: e, i, p

    do i = first, last
      p = points%order(i)
      e = points%element(p)
      move = matmul(system%u(:, mesh%node(:, e)), points%shape(:, p))
      points%x(:, p) = points%x(:, p) + move
      points%u(:, p) = points%u(:, p) + move
      points%def_grad(:, :, p) = matmul(identity + system%kinematics%disp_grad(:, :, e), &
                                        points%def_grad(:, :, p))
      points%volume(p) = points%volume(p)*(1.0_dp + system%kinematics%delta_j_bar_m1(e))
    end do
  end subroutine move_points

  !> The states that the increment ends in, with the strains and stresses that belong to them.
  pure subroutine accept_states(points, materials, kinematics, first, last)
    type(points_t), intent(inout)  :: points
    type(material_t), intent(in)   :: materials(:)
    type(kinematics_t), intent(in) :: kinematics  !! of the last evaluation
    integer, intent(in)            :: first, last !! range of points%order, at most batch_size
    type(stress_batch_t) :: batch
    real(dp) :: strain(batch_size, 6)
    integer  :: i, l, p

    do i = first, last
      p = points%order(i)
      l = i - first + 1
      call put_point(batch, l, kinematics%disp_grad_bar(:, :, points%element(p)), &
                     points%state%left_cauchy_green_e_m1(:, p), points%state%hardening(1, p))
      call set_material(batch, l, points%material(p), materials(points%material(p)))
    end do
    call accept_batch(strain, batch, materials)
    associate (state => points%state)
      do i = first, last
        p = points%order(i)
        l = i - first + 1
        state%left_cauchy_green_e_m1(:, p) = batch%cg_e_m1(l, :)
        state%hardening(1, p) = batch%plastic_strain(l)
        state%jacobian_bar(p) = state%jacobian_bar(p) &
                                *(1.0_dp + kinematics%delta_j_bar_m1(points%element(p)))
        state%strain_e(:, p) = strain(l, :)
        state%cauchy(:, p) = batch%kirchhoff(l, :)/state%jacobian_bar(p)
      end do
    end associate
  end subroutine accept_states

  !> The point with a host that has moved farthest since its displacements were noted.
  pure subroutine find_largest_move(point, distance, points, u_before)
    integer, intent(out)       :: point          !! its id, of equal ones the first, 0 without points
    real(dp), intent(out)      :: distance       !! length of its way [length]
    type(points_t), intent(in) :: points         !! converged
    real(dp), intent(in)       :: u_before(:, :) !! (n_dim, n)  displacements before, by id [length]
    real(dp) :: way
    integer  :: i, p

    point = 0
    distance = 0.0_dp
    do i = 1, points%n
      p = points%place(i)
      if (points%element(p) == 0) cycle
      way = norm2(points%u(:, p) - u_before(:, i))
      if (point > 0 .and. way <= distance) cycle
      point = i
      distance = way
    end do
  end subroutine find_largest_move

end module mpm_point_update
