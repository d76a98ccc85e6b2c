!> Second-order tensors of three dimensions: the one place that fixes the Voigt order.
!!
!! Voigt order 11, 22, 33, 12, 23, 13 with tensor components; engineering shear never appears.
!! Small strains are 1e-5 and smaller: every formula here keeps the relative accuracy of F - 1.
module mpm_tensor
  use, intrinsic :: iso_c_binding, only: c_double
  use mpm_kinds, only: dp
  implicit none
  private
  public :: cross_product, deviator_norm, expm1, inverse, log1p, det_m1, tensor_from_voigt, trace
  public :: push_forward_m1, voigt_from_tensor, voigt_row, voigt_column, voigt_index, identity

  integer, parameter :: voigt_row(6) = [1, 2, 3, 1, 2, 1]    !! first index of a Voigt component
  integer, parameter :: voigt_column(6) = [1, 2, 3, 2, 3, 3] !! second index of a Voigt component
  integer, parameter :: voigt_index(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
    !! Voigt component of a pair of indices
  real(dp), parameter :: identity(3, 3) = &
    reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])

  interface
    !> ln(1 + x) without cancellation, of the C library.
    pure function log1p(x) bind(c, name="log1p") result(y)
      import :: c_double
      real(c_double), value, intent(in) :: x
      real(c_double) :: y
    end function log1p

    !> exp(x) - 1 without cancellation, of the C library.
    pure function expm1(x) bind(c, name="expm1") result(y)
      import :: c_double
      real(c_double), value, intent(in) :: x
      real(c_double) :: y
    end function expm1
  end interface

contains

  !> Symmetric tensor from its Voigt components.
  pure function tensor_from_voigt(voigt) result(tensor)
    real(dp), intent(in) :: voigt(6)  !! 11, 22, 33, 12, 23, 13
    real(dp) :: tensor(3, 3)

    tensor(:, 1) = [voigt(1), voigt(4), voigt(6)]
    tensor(:, 2) = [voigt(4), voigt(2), voigt(5)]
    tensor(:, 3) = [voigt(6), voigt(5), voigt(3)]
  end function tensor_from_voigt

  !> Voigt components of a symmetric tensor (the upper triangle is read).
  pure function voigt_from_tensor(tensor) result(voigt)
    real(dp), intent(in) :: tensor(3, 3)
    real(dp) :: voigt(6)              !! 11, 22, 33, 12, 23, 13

    voigt = [tensor(1, 1), tensor(2, 2), tensor(3, 3), tensor(1, 2), tensor(2, 3), tensor(1, 3)]
  end function voigt_from_tensor

  !> Trace of a 3x3 tensor.
  pure function trace(tensor) result(t)
    real(dp), intent(in) :: tensor(3, 3)
    real(dp) :: t

    t = tensor(1, 1) + tensor(2, 2) + tensor(3, 3)
  end function trace

  !> det(I + H) - 1 = tr H + II(H) + det H, exact also for tiny H. Source: theory.md (2).
  pure function det_m1(h) result(d)
    real(dp), intent(in) :: h(3, 3) !! displacement gradient H [-]
    real(dp) :: d                   !! [-]
    real(dp) :: minor_1, minor_2, minor_3

    minor_1 = h(2, 2)*h(3, 3) - h(2, 3)*h(3, 2)
    minor_2 = h(1, 1)*h(3, 3) - h(1, 3)*h(3, 1)
    minor_3 = h(1, 1)*h(2, 2) - h(1, 2)*h(2, 1)
    d = h(1, 1)*minor_1 &
        - h(1, 2)*(h(2, 1)*h(3, 3) - h(2, 3)*h(3, 1)) &
        + h(1, 3)*(h(2, 1)*h(3, 2) - h(2, 2)*h(3, 1))
    d = trace(h) + ((minor_1 + minor_2 + minor_3) + d)
  end function det_m1

  !> Inverse of a 3x3 tensor by cofactors. Precondition: det(a) /= 0.
  pure function inverse(a) result(b)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: b(3, 3)

    b(1, 1) = a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)
    b(2, 1) = a(2, 3)*a(3, 1) - a(2, 1)*a(3, 3)
    b(3, 1) = a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1)
    b(1, 2) = a(1, 3)*a(3, 2) - a(1, 2)*a(3, 3)
    b(2, 2) = a(1, 1)*a(3, 3) - a(1, 3)*a(3, 1)
    b(3, 2) = a(1, 2)*a(3, 1) - a(1, 1)*a(3, 2)
    b(1, 3) = a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2)
    b(2, 3) = a(1, 3)*a(2, 1) - a(1, 1)*a(2, 3)
    b(3, 3) = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    b = b/dot_product(a(1, :), b(:, 1))
  end function inverse

  !> (I + H)(I + C)(I + H)^T - I without forming 1 + small numbers. Source: theory.md (6).
  pure function push_forward_m1(h, c) result(c_new)
    real(dp), intent(in) :: h(3, 3) !! H = F - I [-]
    real(dp), intent(in) :: c(6)    !! b - 1, Voigt [-]
    real(dp) :: c_new(6)            !! F b F^T - 1, Voigt [-]
    real(dp) :: b(3, 3), half(3, 3)
    integer :: v, i, j

    b = tensor_from_voigt(c)
    half = b + matmul(h, b)
    do v = 1, 6
      i = voigt_row(v)
      j = voigt_column(v)
      c_new(v) = (h(i, j) + h(j, i)) &
                 + (half(i, j) + (h(i, 1)*h(j, 1) + half(i, 1)*h(j, 1)) &
                    + (h(i, 2)*h(j, 2) + half(i, 2)*h(j, 2)) &
                    + (h(i, 3)*h(j, 3) + half(i, 3)*h(j, 3)))
    end do
  end function push_forward_m1

  !> Frobenius norm of the deviator of a symmetric tensor.
  pure function deviator_norm(voigt) result(norm)
    real(dp), intent(in) :: voigt(6) !! 11, 22, 33, 12, 23, 13
    real(dp) :: norm
    real(dp) :: mean

    mean = sum(voigt(1:3))/3.0_dp
    norm = sqrt(sum((voigt(1:3) - mean)**2) + 2.0_dp*sum(voigt(4:6)**2))
  end function deviator_norm

  !> Vector product.
  pure function cross_product(a, b) result(c)
    real(dp), intent(in) :: a(3) !! (3)  first factor
    real(dp), intent(in) :: b(3) !! (3)  second factor
    real(dp) :: c(3)             !! (3)  a x b

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross_product

end module mpm_tensor
