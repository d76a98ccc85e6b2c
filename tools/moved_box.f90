!> A box of about 31,000 tetrahedra with one point each, moved by a smooth displacement of 0.3
!! element sizes in the mean, for bench_location.
module moved_box
  use mpm_error, only: error_t
  use mpm_kinds, only: dp
  use mpm_material_points, only: generate_points, group_points, points_t
  use mpm_mesh, only: mesh_t
  use mpm_mesh_generator, only: box_settings_t, generate_box, graded_planes
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_parent_split, only: split_parents
  use mpm_simplex, only: simplex_size
  implicit none
  private
  public :: make_moved_box

  integer, parameter :: n_cells(3) = [17, 17, 18] !! of six tetrahedra, with edges of 1
  real(dp), parameter :: shift = 0.37_dp          !! largest component over element size [-]
  real(dp), parameter :: tau = 8.0_dp*atan(1.0_dp)

contains

  !> Makes the box with points in their old hosts at their new positions.
  subroutine make_moved_box(mesh, points, moved)
    type(mesh_t), intent(out)   :: mesh   !! complete
    type(points_t), intent(out) :: points !! grouped, moved, not located
    real(dp), intent(out)       :: moved  !! mean displacement over element size [-]

    call make_body(mesh, points)
    call move_points(points, mesh, moved)
  end subroutine make_moved_box

  !> The box, distorted inside so that no face lies on a plane of the grid, with one point per
  !! element.
  subroutine make_body(mesh, points)
    type(mesh_t), intent(out)   :: mesh   !! complete
    type(points_t), intent(out) :: points !! grouped
    type(parent_mesh_t) :: parent
    type(box_settings_t) :: box
    type(error_t), allocatable :: error
    integer :: a, e

    box%x = graded_planes(0.0_dp, real(n_cells(1), dp), n_cells(1), 1.0_dp)
    box%y = graded_planes(0.0_dp, real(n_cells(2), dp), n_cells(2), 1.0_dp)
    box%z = graded_planes(0.0_dp, real(n_cells(3), dp), n_cells(3), 1.0_dp)
    call generate_box(parent, box, error)
    call must_work(error)
    do a = 1, parent%n_node
      parent%x(:, a) = parent%x(:, a) + 0.35_dp*bubble(parent%x(:, a))* &
        [sin(3.1_dp*parent%x(2, a)), sin(2.7_dp*parent%x(3, a)), sin(3.7_dp*parent%x(1, a))]
    end do
    call split_parents(parent, mesh, error)
    call must_work(error)
    call generate_points(points, mesh, [(e, e=1, mesh%n_el)], 1, 1, 1.0_dp, error)
    call must_work(error)
    call group_points(points, mesh%n_el)
  end subroutine make_body

  !> Moves the points; on the sides of the box only along them.
  subroutine move_points(points, mesh, moved)
    type(points_t), intent(inout) :: points !! out x
    type(mesh_t), intent(in)      :: mesh   !! mesh
    real(dp), intent(out)         :: moved  !! mean displacement over element size [-]
    real(dp) :: u(3), size_of_elements, x(3)
    integer :: p

    size_of_elements = simplex_size(3, sum(mesh%volume)/real(mesh%n_el, dp))
    moved = 0.0_dp
    do p = 1, points%n
      x = tau*points%x(:, p)/real(n_cells, dp)
      u = shift*size_of_elements*[sin(x(1)/2.0_dp)*cos(x(2)), sin(x(2)/2.0_dp)*cos(x(3)), &
                                  sin(x(3)/2.0_dp)*cos(x(1))]
      points%x(:, p) = points%x(:, p) + u
      moved = moved + norm2(u)/(size_of_elements*real(points%n, dp))
    end do
  end subroutine move_points

  !> Zero on the sides of the box, one in its middle.
  pure function bubble(x) result(height)
    real(dp), intent(in) :: x(3) !! (3)  position [length]
    real(dp) :: height           !! [-]

    height = product(sin(0.5_dp*tau*x/real(n_cells, dp)))
  end function bubble

  !> Ends the program when the body could not be made.
  subroutine must_work(error)
    type(error_t), allocatable, intent(in) :: error !! unallocated if all is well

    if (.not. allocated(error)) return
    write (*, "(a)") "bench_location: "//error%message
    stop 1
  end subroutine must_work

end module moved_box
