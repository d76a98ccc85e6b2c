!> Spectral decomposition, logarithm and exponential of many symmetric 3x3 tensors at once.
!!
!! The tensors of a batch lie side by side, so that the compiler makes one vector instruction of
!! what is done to each of them. No value of a tensor depends on its neighbours in the batch: the
!! result is the same to the last bit wherever in a batch a tensor stands.
module mpm_eigen_batch
  use mpm_kinds, only: dp
  use mpm_tensor, only: expm1, log1p
  implicit none
  private
  public :: batch_size, eigen_of_batch, expm1_of_batch, log1p_of_batch, log_ratio_of_batch

  integer, parameter :: batch_size = 32 !! tensors of a batch: what stays in the first-level cache

  integer, parameter  :: max_sweeps = 12
  integer, parameter  :: plane(5, 3) = reshape([1, 2, 1, 3, 2, 1, 3, 3, 1, 2, 2, 3, 2, 1, 3], &
                                               [5, 3])
    !! p, q and the places of pq, pr, qr among the entries 12, 23, 13
  real(dp), parameter :: negligible = 3.0e-19_dp !! off-diagonal entry over the largest entries [-]
  real(dp), parameter :: smallest = 1.0e-140_dp  !! entry whose square is still a normal number
  real(dp), parameter :: series_reach = 0.4_dp   !! argument up to which the series are used
  real(dp), parameter :: inverse_odd(12) = [1.0_dp/3.0_dp, 1.0_dp/5.0_dp, 1.0_dp/7.0_dp, &
    1.0_dp/9.0_dp, 1.0_dp/11.0_dp, 1.0_dp/13.0_dp, 1.0_dp/15.0_dp, 1.0_dp/17.0_dp, 1.0_dp/19.0_dp, &
    1.0_dp/21.0_dp, 1.0_dp/23.0_dp, 1.0_dp/25.0_dp] !! of artanh
  real(dp), parameter :: inverse_factorial(2:15) = [1.0_dp/2.0_dp, 1.0_dp/6.0_dp, 1.0_dp/24.0_dp, &
    1.0_dp/120.0_dp, 1.0_dp/720.0_dp, 1.0_dp/5040.0_dp, 1.0_dp/40320.0_dp, 1.0_dp/362880.0_dp, &
    1.0_dp/3628800.0_dp, 1.0_dp/39916800.0_dp, 1.0_dp/479001600.0_dp, 1.0_dp/6227020800.0_dp, &
    1.0_dp/87178291200.0_dp, 1.0_dp/1307674368000.0_dp] !! of exp

contains

  !> Eigenvalues and orthonormal eigenvectors by cyclic Jacobi rotations, which need no special case
  !! for equal eigenvalues: the error of a value is a few ulp of the largest entry.
  !! Precondition: entries are finite and below 1e100 in size. Source: `eigen_symmetric`.
  pure subroutine eigen_of_batch(value, vector, voigt)
    real(dp), intent(out) :: value(batch_size, 3)     !! eigenvalues, in no order
    real(dp), intent(out) :: vector(batch_size, 3, 3) !! eigenvector i of tensor l in (l, :, i)
    real(dp), intent(in)  :: voigt(batch_size, 6)     !! symmetric tensors 11, 22, 33, 12, 23, 13
    real(dp) :: off(batch_size, 3), limit(batch_size)
    integer  :: i, l, sweep

    value = voigt(:, 1:3)
    off = voigt(:, 4:6) ! 12, 23, 13
    vector = 0.0_dp
    do i = 1, 3
      vector(:, i, i) = 1.0_dp
    end do
    do l = 1, batch_size
      limit(l) = abs(voigt(l, 1)) + abs(voigt(l, 2)) + abs(voigt(l, 3)) &
                 + abs(voigt(l, 4)) + abs(voigt(l, 5)) + abs(voigt(l, 6))
      limit(l) = max(smallest, negligible*limit(l))
    end do
    do sweep = 1, max_sweeps
      if (all(abs(off(:, 1)) <= limit .and. abs(off(:, 2)) <= limit &
              .and. abs(off(:, 3)) <= limit)) exit
      do i = 1, 3
        call rotate(value, off, vector, plane(:, i), limit)
      end do
    end do
  end subroutine eigen_of_batch

  !> One rotation in the plane (p, q); r is the third index. Tensors whose entry (p, q) is
  !! negligible stay as they are, to the last bit.
  pure subroutine rotate(value, off, vector, plane, limit)
    real(dp), intent(inout) :: value(batch_size, 3)     !! diagonal
    real(dp), intent(inout) :: off(batch_size, 3)       !! entries 12, 23, 13; one becomes zero
    real(dp), intent(inout) :: vector(batch_size, 3, 3) !! rotated with them
    integer, intent(in)     :: plane(5)                 !! p, q, and the places of pq, pr, qr in off
    real(dp), intent(in)    :: limit(batch_size)        !! what is negligible
    real(dp) :: across, d, p, q, root, s, signed, t, tau, theta, w
    integer  :: l

    !$omp simd private(across, d, p, q, root, s, signed, t, tau, theta, w)
    do l = 1, batch_size
      across = merge(off(l, plane(3)), 0.0_dp, abs(off(l, plane(3))) > limit(l))
      theta = 0.5_dp*(value(l, plane(2)) - value(l, plane(1)))
      root = sqrt(theta*theta + across*across)
      root = merge(root, 1.0_dp, abs(across) > 0.0_dp)
      d = abs(theta) + root
      w = sqrt(2.0_dp*root*d)
      ! tan, sin and tan of the half angle as a/d, a/w and a/(w + d): one division less.
      signed = sign(across, across*theta)
      t = signed/d
      tau = signed/(w*(w + d))
      s = tau*(w + d)
      tau = tau*w
      value(l, plane(1)) = value(l, plane(1)) - t*across
      value(l, plane(2)) = value(l, plane(2)) + t*across
      off(l, plane(3)) = off(l, plane(3)) - across
      p = off(l, plane(4))
      q = off(l, plane(5))
      off(l, plane(4)) = p - s*(q + tau*p)
      off(l, plane(5)) = q + s*(p - tau*q)
      p = vector(l, 1, plane(1))
      q = vector(l, 1, plane(2))
      vector(l, 1, plane(1)) = p - s*(q + tau*p)
      vector(l, 1, plane(2)) = q + s*(p - tau*q)
      p = vector(l, 2, plane(1))
      q = vector(l, 2, plane(2))
      vector(l, 2, plane(1)) = p - s*(q + tau*p)
      vector(l, 2, plane(2)) = q + s*(p - tau*q)
      p = vector(l, 3, plane(1))
      q = vector(l, 3, plane(2))
      vector(l, 3, plane(1)) = p - s*(q + tau*p)
      vector(l, 3, plane(2)) = q + s*(p - tau*q)
    end do
  end subroutine rotate

  !> ln(1 + x) of each tensor's value: 2 artanh(x/(2 + x)) as a series, of the C library where that
  !! is too short. Precondition: x > -1.
  pure subroutine log1p_of_batch(y, x)
    real(dp), intent(out) :: y(batch_size) !! ln(1 + x)
    real(dp), intent(in)  :: x(batch_size)
    real(dp) :: s
    integer  :: l

    !$omp simd private(s)
    do l = 1, batch_size
      s = x(l)/(2.0_dp + x(l))
      y(l) = x(l) - s*(x(l) - 2.0_dp*artanh_excess(s*s))
    end do
    if (all(abs(x) <= series_reach)) return
    do l = 1, batch_size
      if (abs(x(l)) > series_reach) y(l) = log1p(x(l))
    end do
  end subroutine log1p_of_batch

  !> ln(1 + x)/x of each tensor's value, smooth through x = 0. Precondition: x > -1.
  pure subroutine log_ratio_of_batch(y, x)
    real(dp), intent(out) :: y(batch_size) !! ln(1 + x)/x
    real(dp), intent(in)  :: x(batch_size)
    real(dp) :: s
    integer  :: l

    !$omp simd private(s)
    do l = 1, batch_size
      s = x(l)/(2.0_dp + x(l))
      y(l) = 2.0_dp*(1.0_dp + artanh_excess(s*s))/(2.0_dp + x(l))
    end do
    if (all(abs(x) <= series_reach)) return
    do l = 1, batch_size
      if (abs(x(l)) > series_reach) y(l) = log1p(x(l))/x(l)
    end do
  end subroutine log_ratio_of_batch

  !> artanh(s)/s - 1 as a series in z = s**2, for |s| up to series_reach/(2 - series_reach).
  pure function artanh_excess(z) result(excess)
    real(dp), intent(in) :: z !! s**2
    real(dp) :: excess

    excess = inverse_odd(11) + z*inverse_odd(12)
    excess = inverse_odd(10) + z*excess
    excess = inverse_odd(9) + z*excess
    excess = inverse_odd(8) + z*excess
    excess = inverse_odd(7) + z*excess
    excess = inverse_odd(6) + z*excess
    excess = inverse_odd(5) + z*excess
    excess = inverse_odd(4) + z*excess
    excess = inverse_odd(3) + z*excess
    excess = inverse_odd(2) + z*excess
    excess = z*(inverse_odd(1) + z*excess)
  end function artanh_excess

  !> exp(x) - 1 of each tensor's value, as a series, of the C library where that is too short.
  pure subroutine expm1_of_batch(y, x)
    real(dp), intent(out) :: y(batch_size) !! exp(x) - 1
    real(dp), intent(in)  :: x(batch_size)
    real(dp) :: tail, z
    integer  :: l

    !$omp simd private(tail, z)
    do l = 1, batch_size
      z = min(max(x(l), -1.0_dp), 1.0_dp)
      tail = inverse_factorial(15)
      tail = inverse_factorial(14) + z*tail
      tail = inverse_factorial(13) + z*tail
      tail = inverse_factorial(12) + z*tail
      tail = inverse_factorial(11) + z*tail
      tail = inverse_factorial(10) + z*tail
      tail = inverse_factorial(9) + z*tail
      tail = inverse_factorial(8) + z*tail
      tail = inverse_factorial(7) + z*tail
      tail = inverse_factorial(6) + z*tail
      tail = inverse_factorial(5) + z*tail
      tail = inverse_factorial(4) + z*tail
      tail = inverse_factorial(3) + z*tail
      tail = inverse_factorial(2) + z*tail
      y(l) = z + z*z*tail
    end do
    if (all(abs(x) <= series_reach)) return
    do l = 1, batch_size
      if (abs(x(l)) > series_reach) y(l) = expm1(x(l))
    end do
  end subroutine expm1_of_batch

end module mpm_eigen_batch
