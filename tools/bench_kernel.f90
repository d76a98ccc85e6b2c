!> What the stress update of all points costs, and what the machine could do at most.
!!
!! Boxes of some thousand to a million points, all elastic or all plastic, in batches as the program
!! does it, with and without moduli, and point by point with the checked update. One line per
!! measurement; the same for the machine: multiply-adds in registers, and STREAM's triad.
program bench_kernel
  use, intrinsic :: iso_c_binding, only: c_double, c_long
  use kernel_body, only: body_t, make_body, update_by_point
  use mpm_constitutive_update, only: allocate_sums, element_sums_t, update_points
  use mpm_kinds, only: dp, ip
  implicit none

  integer, parameter :: n_cells(4) = [3, 5, 11, 25]  !! along an edge, of six tetrahedra each
  integer, parameter :: n_batches = 3                !! the best one counts
  integer, parameter :: n_updates = 200000           !! point updates of a batch at least
  integer, parameter :: way_batched = 1              !! as the program does it
  integer, parameter :: way_residual = 2             !! the same without moduli
  integer, parameter :: way_pointwise = 3            !! the checked update
  integer(c_long), parameter :: triad_length = 30000000_c_long !! 720 MB: more than caches hold

  !> Seconds of the best batch, per point.
  type :: cost_t
    real(dp) :: cpu = huge(1.0_dp)  !! of all threads [s]
    real(dp) :: wall = huge(1.0_dp) !! [s]
  end type cost_t

  interface
    !> Double precision rate of one thread [GFLOP/s].
    function peak_gflops() bind(c, name="peak_gflops") result(rate)
      import :: c_double
      implicit none
      real(c_double) :: rate
    end function peak_gflops

    !> Rate of the memory with one thread [GB/s].
    function triad_gbytes(n) bind(c, name="triad_gbytes") result(rate)
      import :: c_double, c_long
      implicit none
      integer(c_long), value :: n !! numbers in each of three arrays
      real(c_double) :: rate
    end function triad_gbytes
  end interface

  integer :: i

  write (*, "(a,1x,f0.3)") "peak_gflops", peak_gflops()
  write (*, "(a,1x,f0.3)") "triad_gbytes", triad_gbytes(triad_length)
  do i = 1, size(n_cells)
    call measure("elastic", 1.0e9_dp, n_cells(i))
    call measure("plastic", 0.85_dp, n_cells(i))
  end do

contains

  !> Measures all ways on one body and writes a line for each.
  subroutine measure(kind, strength, n_cells)
    character(*), intent(in) :: kind !! word of the line
    real(dp), intent(in) :: strength !! sqrt(3 J2) at yield [force/length^2]
    integer, intent(in) :: n_cells   !! along an edge
    type(body_t) :: body
    type(element_sums_t) :: batched, pointwise
    type(cost_t) :: cost
    real(dp) :: difference

    call make_body(body, n_cells, strength)
    call allocate_sums(batched, body%mesh%n_el)
    call allocate_sums(pointwise, body%mesh%n_el)
    call time_updates(cost, batched, body, way_residual)
    call write_line(kind, "residual", cost, body%points%n, batched%n_plastic)
    call time_updates(cost, batched, body, way_batched)
    call write_line(kind, "batched", cost, body%points%n, batched%n_plastic)
    call time_updates(cost, pointwise, body, way_pointwise)
    call write_line(kind, "pointwise", cost, body%points%n, pointwise%n_plastic)
    difference = maxval(abs(batched%stress - pointwise%stress))/maxval(abs(pointwise%stress))
    difference = max(difference, maxval(abs(batched%moduli - pointwise%moduli)) &
                     /maxval(abs(pointwise%moduli)))
    write (*, "(a,1x,a,1x,i0,1x,es10.3)") "difference", kind, body%points%n, difference
  end subroutine measure

  !> Times batches of updates from the same converged state; the first one warms up.
  subroutine time_updates(cost, sums, body, way)
    type(cost_t), intent(out) :: cost            !! of the best batch
    type(element_sums_t), intent(inout) :: sums  !! overwritten
    type(body_t), intent(in) :: body             !! converged state, increment
    integer, intent(in) :: way                   !! way_*
    real(dp) :: clock(2), scale
    integer(ip) :: ticks(2), rate
    integer :: batch, k, n

    n = max(1, n_updates/body%points%n)
    scale = 1.0_dp/(real(n, dp)*real(body%points%n, dp))
    do batch = 0, n_batches
      call cpu_time(clock(1))
      call system_clock(ticks(1))
      do k = 1, n
        if (way == way_pointwise) then
          call update_by_point(sums, body)
        else
          call update_points(sums, body%points, body%material, body%kinematics, &
                             body%element, with_moduli=way == way_batched)
        end if
      end do
      call system_clock(ticks(2), rate)
      call cpu_time(clock(2))
      if (batch == 0) cycle
      cost%cpu = min(cost%cpu, scale*(clock(2) - clock(1)))
      cost%wall = min(cost%wall, scale*real(ticks(2) - ticks(1), dp)/real(rate, dp))
    end do
  end subroutine time_updates

  !> Kind, way, points, points that flow, microseconds per point: CPU of all threads, and wall.
  subroutine write_line(kind, way, cost, n, n_plastic)
    character(*), intent(in) :: kind, way !! words
    type(cost_t), intent(in) :: cost      !! per point [s]
    integer, intent(in) :: n              !! points
    integer, intent(in) :: n_plastic      !! of them flow
    write (*, "(a,2(1x,a),2(1x,i0),2(1x,f0.5))") "kernel", kind, way, n, n_plastic, &
      1.0e6_dp*cost%cpu, 1.0e6_dp*cost%wall
  end subroutine write_line

end program bench_kernel
