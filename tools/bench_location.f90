!> Cost of locating the points of a moved body, as a share of testing every element.
!!
!! Two figures: element tests of the walks and bins over points times elements, and CPU time of the
!! location over that of a search which tests every element for a part of the points, scaled to all
!! of them. The hosts of that part must agree.
program bench_location
  use mpm_kinds, only: dp, ip
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_point_location, only: locate_points, location_report_t, location_settings_t, locator_t
  use mpm_simplex, only: simplex_shape
  use moved_box, only: make_moved_box
  implicit none

  integer, parameter :: n_repeats = 25       !! locations timed
  integer, parameter :: stride = 50          !! every so many points are searched naively
  real(dp), parameter :: inside = -1.0e-12_dp !! least shape function of a point inside [-]

  type(mesh_t)   :: mesh
  type(points_t) :: points
  type(location_report_t) :: report
  integer, allocatable :: found(:)
  real(dp) :: naive_seconds, seconds, moved
  integer(ip) :: n_tests

  call make_moved_box(mesh, points, moved)
  call time_location(seconds, report, points, mesh)
  call search_naively(found, naive_seconds, points, mesh)

  n_tests = int(report%n_walk_steps, ip) + int(report%n_bin_tests, ip)
  write (*, "(a,1x,i0)") "elements", mesh%n_el
  write (*, "(a,1x,i0)") "points", points%n
  write (*, "(a,1x,f6.4)") "mean_move_in_element_sizes", moved
  write (*, "(a,1x,i0)") "crossed", report%n_crossed
  write (*, "(a,1x,i0)") "fallback", report%n_fallback
  write (*, "(a,1x,i0)") "lost", report%n_lost
  write (*, "(a,1x,i0)") "walk_tests", report%n_walk_steps
  write (*, "(a,1x,i0)") "bin_tests", report%n_bin_tests
  write (*, "(a,1x,es12.5)") "share_of_tests", &
    real(n_tests, dp)/(real(points%n, dp)*real(mesh%n_el, dp))
  write (*, "(a,1x,es12.5)") "location_seconds", seconds
  write (*, "(a,1x,i0)") "naive_points", size(found)
  write (*, "(a,1x,es12.5)") "naive_seconds_scaled", naive_seconds
  write (*, "(a,1x,es12.5)") "share_of_time", seconds/naive_seconds
  write (*, "(a,1x,i0)") "disagreements", count(found /= points%element(1::stride))

contains

  !> Locates copies of the points; every copy starts from the hosts before the move.
  subroutine time_location(seconds, report, points, mesh)
    real(dp), intent(out) :: seconds                !! CPU time of one location, mean [s]
    type(location_report_t), intent(out) :: report  !! of each of them
    type(points_t), intent(inout) :: points         !! out located
    type(mesh_t), intent(in)      :: mesh           !! mesh
    type(points_t)  :: copy
    type(locator_t) :: locator
    real(dp) :: after, before
    integer :: i

    seconds = 0.0_dp
    do i = 1, n_repeats
      copy = points
      call cpu_time(before)
      call locate_points(copy, mesh, locator, location_settings_t(), report)
      call cpu_time(after)
      seconds = seconds + (after - before)/real(n_repeats, dp)
    end do
    points = copy
  end subroutine time_location

  !> Tests element after element for a part of the points, all elements even when the host is found.
  subroutine search_naively(found, seconds, points, mesh)
    integer, allocatable, intent(out) :: found(:) !! (n)  hosts of every stride-th point, 0 if none
    real(dp), intent(out) :: seconds              !! CPU time, scaled to all points [s]
    type(points_t), intent(in) :: points          !! points
    type(mesh_t), intent(in)   :: mesh            !! mesh
    real(dp) :: before, after
    integer :: e, i, p

    allocate (found((points%n - 1)/stride + 1), source=0)
    call cpu_time(before)
    do i = 1, size(found)
      p = 1 + (i - 1)*stride
      do e = 1, mesh%n_el
        if (all(simplex_shape(mesh%x(:, mesh%node(1, e)), mesh%grad_shape(:, :, e), &
                              points%x(:, p)) >= inside)) found(i) = e
      end do
    end do
    call cpu_time(after)
    seconds = (after - before)*real(points%n, dp)/real(size(found), dp)
  end subroutine search_naively

end program bench_location
