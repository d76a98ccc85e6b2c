!> Spectral decomposition of a symmetric 3x3 tensor.
module mpm_symmetric_eigen
  use mpm_kinds, only: dp
  use mpm_tensor, only: tensor_from_voigt
  implicit none
  private
  public :: eigen_symmetric, isotropic_voigt

contains

  !> Eigenvalues and orthonormal eigenvectors by cyclic Jacobi rotations.
  !! Works for any multiplicity; the error of a value is a few ulp of the largest entry.
  !! Source: Jacobi 1846; the stable rotation of Rutishauser 1966.
  pure subroutine eigen_symmetric(voigt, value, vector)
    real(dp), intent(in)  :: voigt(6)     !! symmetric tensor 11, 22, 33, 12, 23, 13
    real(dp), intent(out) :: value(3)     !! eigenvalues, in no order
    real(dp), intent(out) :: vector(3, 3) !! eigenvector i in column i
    integer, parameter :: max_sweeps = 12
    real(dp) :: a(3, 3)
    integer :: sweep

    a = tensor_from_voigt(voigt)
    vector = reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
    do sweep = 1, max_sweeps
      if (is_diagonal(a)) exit
      call rotate(a, vector, 1, 2, 3)
      call rotate(a, vector, 1, 3, 2)
      call rotate(a, vector, 2, 3, 1)
    end do
    value = [a(1, 1), a(2, 2), a(3, 3)]
  end subroutine eigen_symmetric

  !> .true. when no off-diagonal entry can change a diagonal one any more. Next to the mean the
  !! spread of the diagonal counts too: the deviator must be as accurate as the tensor.
  pure function is_diagonal(a) result(diagonal)
    real(dp), intent(in) :: a(3, 3)
    logical :: diagonal
    real(dp) :: off

    off = abs(a(1, 2)) + abs(a(1, 3)) + abs(a(2, 3))
    diagonal = off <= 1.0e-18_dp*(abs(a(1, 1)) + abs(a(2, 2)) + abs(a(3, 3)))
  end function is_diagonal

  !> One rotation in the plane (p, q); r is the third index.
  pure subroutine rotate(a, vector, p, q, r)
    real(dp), intent(inout) :: a(3, 3)      !! symmetric, becomes more diagonal
    real(dp), intent(inout) :: vector(3, 3) !! product of the rotations
    integer, intent(in) :: p, q, r          !! a permutation of 1, 2, 3
    real(dp) :: theta, t, c, s, tau, arp, arq, v(3)

    if (abs(a(p, q)) <= tiny(1.0_dp)) then
      a(p, q) = 0.0_dp
      a(q, p) = 0.0_dp
      return
    end if
    theta = 0.5_dp*(a(q, q) - a(p, p))
    t = a(p, q)/(abs(theta) + hypot(theta, a(p, q)))
    if (theta < 0.0_dp) t = -t
    c = 1.0_dp/sqrt(1.0_dp + t*t)
    s = t*c
    tau = s/(1.0_dp + c)
    a(p, p) = a(p, p) - t*a(p, q)
    a(q, q) = a(q, q) + t*a(p, q)
    a(p, q) = 0.0_dp
    a(q, p) = 0.0_dp
    arp = a(r, p)
    arq = a(r, q)
    a(r, p) = arp - s*(arq + tau*arp)
    a(r, q) = arq + s*(arp - tau*arq)
    a(p, r) = a(r, p)
    a(q, r) = a(r, q)
    v = vector(:, p)
    vector(:, p) = v - s*(vector(:, q) + tau*v)
    vector(:, q) = vector(:, q) + s*(v - tau*vector(:, q))
  end subroutine rotate

  !> Symmetric tensor with given eigenvalues and eigenvectors: sum of value_i n_i (x) n_i.
  pure function isotropic_voigt(value, vector) result(voigt)
    real(dp), intent(in) :: value(3)     !! eigenvalues
    real(dp), intent(in) :: vector(3, 3) !! eigenvector i in column i
    real(dp) :: voigt(6)                 !! 11, 22, 33, 12, 23, 13
    real(dp) :: s(3, 3)

    s(:, 1) = value(1)*vector(:, 1)
    s(:, 2) = value(2)*vector(:, 2)
    s(:, 3) = value(3)*vector(:, 3)
    voigt(1) = s(1, 1)*vector(1, 1) + s(1, 2)*vector(1, 2) + s(1, 3)*vector(1, 3)
    voigt(2) = s(2, 1)*vector(2, 1) + s(2, 2)*vector(2, 2) + s(2, 3)*vector(2, 3)
    voigt(3) = s(3, 1)*vector(3, 1) + s(3, 2)*vector(3, 2) + s(3, 3)*vector(3, 3)
    voigt(4) = s(1, 1)*vector(2, 1) + s(1, 2)*vector(2, 2) + s(1, 3)*vector(2, 3)
    voigt(5) = s(2, 1)*vector(3, 1) + s(2, 2)*vector(3, 2) + s(2, 3)*vector(3, 3)
    voigt(6) = s(1, 1)*vector(3, 1) + s(1, 2)*vector(3, 2) + s(1, 3)*vector(3, 3)
  end function isotropic_voigt

end module mpm_symmetric_eigen
