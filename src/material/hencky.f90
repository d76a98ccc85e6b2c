!> Hencky elasticity: Kirchhoff stress linear in the logarithmic strain, in principal axes,
!! and the spatial moduli that any isotropic law in principal logarithmic strains has.
module mpm_hencky
  use mpm_kinds, only: dp
  use mpm_tensor, only: log1p
  implicit none
  private
  public :: hencky_moduli, hencky_strain, hencky_stress, spatial_moduli

contains

  !> Principal Kirchhoff stress tau = K tr(eps) + 2 G dev(eps). Source: theory.md (7).
  pure function hencky_stress(bulk, shear, strain) result(kirchhoff)
    real(dp), intent(in) :: bulk, shear !! K and G [force/length^2]
    real(dp), intent(in) :: strain(3)   !! principal elastic logarithmic strains [-]
    real(dp) :: kirchhoff(3)            !! [force/length^2]
    real(dp) :: volumetric

    volumetric = sum(strain)
    kirchhoff = (bulk - 2.0_dp/3.0_dp*shear)*volumetric + 2.0_dp*shear*strain
  end function hencky_stress

  !> Principal elastic logarithmic strain of a stress, the inverse of `hencky_stress`:
  !! eps = dev(tau)/(2 G) + tr(tau)/(9 K). Source: theory.md (21a).
  pure function hencky_strain(bulk, shear, kirchhoff) result(strain)
    real(dp), intent(in) :: bulk, shear  !! K and G [force/length^2]
    real(dp), intent(in) :: kirchhoff(3) !! principal Kirchhoff stress [force/length^2]
    real(dp) :: strain(3)                !! [-]
    real(dp) :: mean

    mean = sum(kirchhoff)/3.0_dp
    strain = (kirchhoff - mean)/(2.0_dp*shear) + mean/(3.0_dp*bulk)
  end function hencky_strain

  !> Principal moduli d tau_i / d eps_j. Source: theory.md (7).
  pure function hencky_moduli(bulk, shear) result(d_kirchhoff_d_strain)
    real(dp), intent(in) :: bulk, shear        !! K and G [force/length^2]
    real(dp) :: d_kirchhoff_d_strain(3, 3)     !! [force/length^2]
    integer :: i

    d_kirchhoff_d_strain = bulk - 2.0_dp/3.0_dp*shear
    do i = 1, 3
      d_kirchhoff_d_strain(i, i) = d_kirchhoff_d_strain(i, i) + 2.0_dp*shear
    end do
  end function hencky_moduli

  !> Moduli c of the Lie derivative of the Kirchhoff stress, L tau = c : d, in the global frame:
  !! c_iijj = d tau_i / d eps_j - 2 tau_i delta_ij,  c_ijij = (tau_i b_j - tau_j b_i)/(b_i - b_j).
  !! Source: theory.md (12). Equal eigenvalues need no special case: the shear moduli are written
  !! with the smooth function ln(b_i/b_j)/(b_i - b_j).
  pure subroutine spatial_moduli(c, vector, cg_m1, kirchhoff, d_kirchhoff_d_strain, secant)
    real(dp), intent(out) :: c(6, 6)      !! Voigt, tensor components: L tau_v = c(v, w) d_w, sum over 9
    real(dp), intent(in)  :: vector(3, 3) !! principal directions in columns
    real(dp), intent(in)  :: cg_m1(3)     !! eigenvalues of the trial b - 1 [-]
    real(dp), intent(in)  :: kirchhoff(3) !! principal Kirchhoff stress [force/length^2]
    real(dp), intent(in)  :: d_kirchhoff_d_strain(3, 3) !! principal moduli [force/length^2]
    real(dp), intent(in)  :: secant       !! (tau_i - tau_j)/(eps_i - eps_j) [force/length^2]
    integer, parameter :: first(3) = [1, 2, 1], second(3) = [2, 3, 3]
    real(dp) :: m(6, 3), p(6), normal(3, 3), cm(6), shear
    integer :: i, j, k, w

    normal = d_kirchhoff_d_strain
    do i = 1, 3
      m(:, i) = dyad(vector(:, i), vector(:, i))
      normal(i, i) = normal(i, i) - 2.0_dp*kirchhoff(i)
    end do
    c = 0.0_dp
    do j = 1, 3
      cm = normal(1, j)*m(:, 1) + normal(2, j)*m(:, 2) + normal(3, j)*m(:, 3)
      do w = 1, 6
        c(:, w) = c(:, w) + m(w, j)*cm
      end do
    end do
    do k = 1, 3
      i = first(k)
      j = second(k)
      shear = 0.5_dp*secant*log_ratio((cg_m1(i) - cg_m1(j))/(1.0_dp + cg_m1(j))) - kirchhoff(j)
      p = dyad(vector(:, i), vector(:, j))
      do w = 1, 6
        c(:, w) = c(:, w) + (4.0_dp*shear*p(w))*p
      end do
    end do
  end subroutine spatial_moduli

  !> ln(1 + x)/x, smooth through x = 0.
  pure function log_ratio(x) result(ratio)
    real(dp), intent(in) :: x !! [-]
    real(dp) :: ratio         !! [-]

    if (abs(x) < 1.0e-8_dp) then
      ratio = 1.0_dp - 0.5_dp*x
    else
      ratio = log1p(x)/x
    end if
  end function log_ratio

  !> Symmetric part of a (x) b in Voigt components.
  pure function dyad(a, b) result(voigt)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: voigt(6) !! 11, 22, 33, 12, 23, 13

    voigt(1:3) = a*b
    voigt(4) = 0.5_dp*(a(1)*b(2) + a(2)*b(1))
    voigt(5) = 0.5_dp*(a(2)*b(3) + a(3)*b(2))
    voigt(6) = 0.5_dp*(a(1)*b(3) + a(3)*b(1))
  end function dyad

end module mpm_hencky
