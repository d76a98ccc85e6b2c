!> Simple deformations, and rates of stress for the finite-difference tests of moduli.
module tangent_checks
  use mpm_kinds, only: dp
  use mpm_tensor, only: tensor_from_voigt, voigt_from_tensor
  implicit none
  private
  public :: lie_derivative, moduli_times, shear_gradient, stretched

  !> Product of spatial moduli with a velocity gradient or with a rate of deformation.
  interface moduli_times
    module procedure times_velocity, times_rate
  end interface moduli_times

contains

  !> c : d with d the symmetric part of a velocity gradient.
  pure function times_velocity(c, velocity) result(rate)
    real(dp), intent(in) :: c(6, 6)        !! Voigt, tensor components
    real(dp), intent(in) :: velocity(3, 3)
    real(dp) :: rate(6)

    rate = times_rate(c, voigt_from_tensor(0.5_dp*(velocity + transpose(velocity))))
  end function times_velocity

  !> c : d; the sum over nine components counts each shear twice.
  pure function times_rate(c, d) result(rate)
    real(dp), intent(in) :: c(6, 6) !! Voigt, tensor components
    real(dp), intent(in) :: d(6)    !! Voigt, tensor components
    real(dp) :: rate(6)

    rate = matmul(c(:, 1:3), d(1:3)) + 2.0_dp*matmul(c(:, 4:6), d(4:6))
  end function times_rate

  !> L tau = d tau/dt - l tau - tau l^T.
  pure function lie_derivative(rate, velocity, kirchhoff) result(lie)
    real(dp), intent(in) :: rate(6)        !! d tau/dt
    real(dp), intent(in) :: velocity(3, 3) !! l
    real(dp), intent(in) :: kirchhoff(6)   !! tau
    real(dp) :: lie(6)
    real(dp) :: carried(3, 3)

    carried = matmul(velocity, tensor_from_voigt(kirchhoff))
    lie = rate - voigt_from_tensor(carried + transpose(carried))
  end function lie_derivative

  !> F - I of stretches along the axes.
  pure function stretched(a, b, c) result(h)
    real(dp), intent(in) :: a, b, c !! stretches [-]
    real(dp) :: h(3, 3)

    h = 0.0_dp
    h(1, 1) = a - 1.0_dp
    h(2, 2) = b - 1.0_dp
    h(3, 3) = c - 1.0_dp
  end function stretched

  !> F - I of a simple shear.
  pure function shear_gradient(gamma) result(h)
    real(dp), intent(in) :: gamma !! amount of shear [-]
    real(dp) :: h(3, 3)

    h = 0.0_dp
    h(1, 2) = gamma
  end function shear_gradient

end module tangent_checks
