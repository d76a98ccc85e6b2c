!> What a factorisation will take, from the analysis of its pattern alone.
!!
!! UMFPACK's own estimates are upper bounds for any choice of pivots. The symmetric strategy nearly
!! always keeps the pivots on the diagonal, and then the fill of the symmetric ordering, which the
!! analysis knows too, is the fill of the factors. MUMPS tells what the factors are if no pivot is
!! put off, and foresees some room for those that are. The constants here were fitted to
!! factorisations of 2,481 to 85,529 unknowns: see docs/estimate.md.
module mpm_factor_estimate
  use, intrinsic :: iso_c_binding, only: c_int
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: is_exact, library_umfpack, linear_solver_t
  use mpm_openblas_binding, only: dgemm, openblas_set_num_threads
  use mpm_umfpack_binding, only: info_entries_l, info_entries_u, info_flops_estimate, &
    info_peak_estimate, info_symmetric_entries, info_symmetric_flops, info_unit, &
    info_variable_peak
  implicit none
  private
  public :: factor_estimate_t, factor_estimate, factor_seconds, measure_flop_rate

  real(dp), parameter :: bytes_of_entry = 53.0_dp !! of the matrix, in copies while it is factorised
  real(dp), parameter :: bytes_in_mumps = 24.0_dp !! the same with MUMPS
  real(dp), parameter :: room_taken = 0.86_dp    !! of what MUMPS foresees
  real(dp), parameter :: of_single = 0.43_dp     !! time of a factorisation in single precision over
                                                 !! that of UMFPACK
  real(dp), parameter :: half_speed = 2.5e11_dp  !! flops of a factorisation that runs at half the
                                                 !! speed of dense products

  !> What a factorisation takes: expected, and at most. Bounds are what is expected if none is known.
  type :: factor_estimate_t
    logical  :: has_bounds = .true.
    real(dp) :: entries = 0.0_dp       !! of L and U
    real(dp) :: entries_bound = 0.0_dp
    real(dp) :: flops = 0.0_dp
    real(dp) :: flops_bound = 0.0_dp
    real(dp) :: kept = 0.0_dp          !! memory of the factors [bytes]
    real(dp) :: peak = 0.0_dp          !! memory while factors are made [bytes]
    real(dp) :: peak_bound = 0.0_dp    !! [bytes]
  end type factor_estimate_t

contains

  !> Reads the analysis; entries and flops stay zero if they are not known. Without the fill of a
  !! symmetric ordering the bounds are expected.
  pure function factor_estimate(solver, nnz) result(estimate)
    type(linear_solver_t), intent(in) :: solver !! analysed
    real(dp), intent(in) :: nnz                 !! stored entries of the matrix
    type(factor_estimate_t) :: estimate         !! zero for a matrix without rows
    real(dp) :: of_matrix

    associate (info => solver%info)
      of_matrix = bytes_of_entry*nnz
      if (solver%library /= library_umfpack) then
        estimate = estimate_of_mumps(solver, nnz)
        return
      end if
      estimate%entries_bound = info(info_entries_l) + info(info_entries_u)
      estimate%flops_bound = info(info_flops_estimate)
      estimate%peak_bound = info(info_peak_estimate)*info(info_unit) + of_matrix
      estimate%entries = estimate%entries_bound
      estimate%flops = estimate%flops_bound
      estimate%peak = estimate%peak_bound
      if (info(info_symmetric_entries) > 0.0_dp) then
        estimate%entries = min(info(info_symmetric_entries), estimate%entries_bound)
        estimate%flops = min(info(info_symmetric_flops), estimate%flops_bound)
        estimate%peak = min(estimate%peak_bound, of_matrix + info(info_unit) &
                            *info(info_variable_peak)*estimate%entries/estimate%entries_bound)
      end if
      estimate%kept = 8.0_dp*estimate%entries
    end associate
  end function factor_estimate

  !> The same of MUMPS.
  pure function estimate_of_mumps(solver, nnz) result(estimate)
    type(linear_solver_t), intent(in) :: solver !! analysed
    real(dp), intent(in) :: nnz                 !! stored entries of the matrix
    type(factor_estimate_t) :: estimate

    estimate%entries = solver%entries
    estimate%entries_bound = solver%entries
    estimate%flops = solver%flops
    estimate%flops_bound = solver%flops
    estimate%kept = merge(8.0_dp, 4.0_dp, is_exact(solver))*solver%entries
    estimate%peak = room_taken*solver%memory + bytes_in_mumps*nnz
    estimate%peak_bound = estimate%peak
    estimate%has_bounds = .false.
  end function estimate_of_mumps

  !> Seconds of a factorisation: large ones run at the speed of dense products, small ones far
  !! below it.
  pure real(dp) function factor_seconds(flops, rate, exactly) result(seconds)
    real(dp), intent(in) :: flops   !! of the factorisation
    real(dp), intent(in) :: rate    !! of dense products in double precision [1/s]
    logical, intent(in)  :: exactly !! in double precision

    seconds = 0.0_dp
    if (flops > 0.0_dp) seconds = flops/rate*(1.0_dp + (half_speed/flops)**(1.0_dp/3.0_dp))
    if (.not. exactly) seconds = of_single*seconds
  end function factor_seconds

  !> Measures the speed of dense products on one core: the best of some trials.
  subroutine measure_flop_rate(rate)
    real(dp), intent(out) :: rate !! [1/s]
    integer, parameter :: n = 512, n_trials = 6
    real(dp), allocatable :: a(:, :), b(:, :), c(:, :)
    real(dp) :: clock(2), seconds
    integer  :: i

    allocate (a(n, n), source=1.0_dp)
    allocate (b(n, n), source=1.0_dp)
    allocate (c(n, n), source=0.0_dp)
    call openblas_set_num_threads(1_c_int)
    seconds = huge(seconds)
    do i = 1, n_trials
      call cpu_time(clock(1))
      call dgemm("N", "N", int(n, c_int), int(n, c_int), int(n, c_int), 1.0_dp, a, &
                 int(n, c_int), b, int(n, c_int), 0.0_dp, c, int(n, c_int))
      call cpu_time(clock(2))
      if (i > 1) seconds = min(seconds, clock(2) - clock(1)) ! the first one also wakes the library
    end do
    rate = 2.0_dp*real(n, dp)**3/max(seconds, 1.0e-6_dp)
  end subroutine measure_flop_rate

end module mpm_factor_estimate
