!> Repeatable random tensors and rotations for tests.
module random_tensors
  use, intrinsic :: iso_fortran_env, only: int64
  use mpm_kinds, only: dp
  use mpm_tensor, only: tensor_from_voigt, voigt_from_tensor
  implicit none
  private
  public :: random_rotation, random_tensor, random_values, rotated, rotated_voigt

contains

  !> n numbers between -1 and 1, always the same for a seed.
  pure function random_values(n, seed) result(value)
    integer, intent(in) :: n    !! how many
    integer, intent(in) :: seed !! any positive number
    real(dp) :: value(n)
    integer(int64), parameter :: modulus = 2147483647_int64
    integer(int64) :: state
    integer :: i

    state = 1_int64 + mod(7919_int64*int(seed, int64), modulus - 1_int64)
    do i = 1, 3
      state = mod(16807_int64*state, modulus)
    end do
    do i = 1, n
      state = mod(16807_int64*state, modulus)
      value(i) = 2.0_dp*real(state, dp)/real(modulus, dp) - 1.0_dp
    end do
  end function random_values

  !> A 3x3 tensor with entries between -1 and 1.
  pure function random_tensor(seed) result(tensor)
    integer, intent(in) :: seed
    real(dp) :: tensor(3, 3)

    tensor = reshape(random_values(9, seed), [3, 3])
  end function random_tensor

  !> A proper rotation, from a random unit quaternion.
  pure function random_rotation(seed) result(q)
    integer, intent(in) :: seed
    real(dp) :: q(3, 3)
    real(dp) :: w, v(3), r(4), cross(3, 3)

    r = random_values(4, seed)
    r = r/norm2(r)
    w = r(4)
    v = r(1:3)
    cross = reshape([0.0_dp, v(3), -v(2), -v(3), 0.0_dp, v(1), v(2), -v(1), 0.0_dp], [3, 3])
    q = 2.0_dp*w*cross + 2.0_dp*matmul(cross, cross)
    q(1, 1) = q(1, 1) + 1.0_dp
    q(2, 2) = q(2, 2) + 1.0_dp
    q(3, 3) = q(3, 3) + 1.0_dp
  end function random_rotation

  !> q a q^T.
  pure function rotated(q, a) result(b)
    real(dp), intent(in) :: q(3, 3) !! rotation
    real(dp), intent(in) :: a(3, 3) !! tensor
    real(dp) :: b(3, 3)

    b = matmul(q, matmul(a, transpose(q)))
  end function rotated

  !> q a q^T of a symmetric tensor in Voigt components.
  pure function rotated_voigt(q, a) result(b)
    real(dp), intent(in) :: q(3, 3) !! rotation
    real(dp), intent(in) :: a(6)    !! 11, 22, 33, 12, 23, 13
    real(dp) :: b(6)

    b = voigt_from_tensor(rotated(q, tensor_from_voigt(a)))
  end function rotated_voigt

end module random_tensors
