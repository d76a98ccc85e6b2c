!> Von Mises plasticity with piecewise linear isotropic hardening: closed-form radial return
!! and consistent moduli in principal logarithmic strains.
module mpm_von_mises
  use mpm_hencky, only: hencky_moduli, hencky_stress
  use mpm_kinds, only: dp
  use mpm_material, only: bulk_modulus, material_t, shear_modulus, yield_stress_at
  implicit none
  private
  public :: compare_strength, plastic_flow, principal_state_t, return_radially, yield_tolerance

  !> A point that was returned to the yield surface stays elastic at rest: without this margin
  !! rounding would decide, and the first tangent of an increment would depend on the compiler.
  real(dp), parameter :: yield_tolerance = 1.0e-12_dp

  !> Result of a stress update in principal axes.
  type :: principal_state_t
    real(dp) :: kirchhoff(3) = 0.0_dp              !! [force/length^2]
    real(dp) :: strain_e(3) = 0.0_dp               !! elastic logarithmic strain after the return [-]
    real(dp) :: d_kirchhoff_d_strain(3, 3) = 0.0_dp !! consistent moduli [force/length^2]
    real(dp) :: secant = 0.0_dp                    !! (tau_i - tau_j)/(eps_i - eps_j) [force/length^2]
    real(dp) :: plastic_strain = 0.0_dp            !! accumulated, uniaxial measure [-]
    logical  :: flows = .false.                    !! plastic flow in this update
  end type principal_state_t

contains

  !> Radial return from the trial strain. Source: theory.md (8); de Souza Neto et al. 2008, 7.3.
  !! Precondition: the slope of the hardening table is above -3 G everywhere.
  pure subroutine return_radially(state, material, strain, plastic_strain)
    type(principal_state_t), intent(out) :: state
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: strain(3)      !! principal trial logarithmic strains [-]
    real(dp), intent(in) :: plastic_strain !! accumulated so far [-]
    real(dp) :: shear, bulk, deviator(3), equivalent, flow, slope, ratio

    shear = shear_modulus(material)
    bulk = bulk_modulus(material)
    state%plastic_strain = plastic_strain
    state%strain_e = strain
    deviator = deviator_of(strain)
    equivalent = shear*sqrt(6.0_dp)*norm2(deviator)
    call plastic_flow(flow, slope, material, equivalent, plastic_strain)
    state%flows = flow > 0.0_dp
    state%secant = 2.0_dp*shear
    state%d_kirchhoff_d_strain = hencky_moduli(bulk, shear)
    if (state%flows) then
      ratio = 3.0_dp*shear*flow/equivalent
      state%plastic_strain = plastic_strain + flow
      state%strain_e = strain - ratio*deviator
      state%secant = 2.0_dp*shear*(1.0_dp - ratio)
      call soften_moduli(state, deviator, shear, ratio, slope)
    end if
    state%kirchhoff = hencky_stress(bulk, shear, state%strain_e)
  end subroutine return_radially

  !> A stress against the strength without plastic strain. Source: theory.md 4.3.
  pure subroutine compare_strength(outside, found, allowed, material, kirchhoff)
    logical, intent(out)  :: outside       !! .true.: outside the yield surface
    real(dp), intent(out) :: found         !! sqrt(3 J2) of the stress [force/length^2]
    real(dp), intent(out) :: allowed       !! sqrt(3 J2) at first yield [force/length^2]
    type(material_t), intent(in) :: material
    real(dp), intent(in)  :: kirchhoff(3)  !! principal Kirchhoff stress [force/length^2]
    real(dp) :: slope, segment_end

    call yield_stress_at(material, 0.0_dp, allowed, slope, segment_end)
    found = sqrt(1.5_dp)*norm2(deviator_of(kirchhoff))
    outside = found > allowed*(1.0_dp + yield_tolerance)
  end subroutine compare_strength

  !> Deviatoric part of three principal values, from differences so that no pressure enters.
  pure function deviator_of(principal) result(deviator)
    real(dp), intent(in) :: principal(3)
    real(dp) :: deviator(3)
    real(dp) :: a, b, c

    a = principal(1) - principal(2)
    b = principal(2) - principal(3)
    c = principal(3) - principal(1)
    deviator = [a - c, b - a, c - b]/3.0_dp
  end function deviator_of

  !> Plastic strain increment on the piecewise linear table; 0 when the trial is elastic.
  pure subroutine plastic_flow(flow, slope, material, equivalent, plastic_strain)
    real(dp), intent(out) :: flow          !! increment of the accumulated plastic strain [-]
    real(dp), intent(out) :: slope         !! hardening slope where the return ends [force/length^2]
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: equivalent     !! trial sqrt(3 J2) [force/length^2]
    real(dp), intent(in) :: plastic_strain !! accumulated so far [-]
    real(dp) :: shear_3, strength, segment_end, reached

    flow = 0.0_dp
    slope = 0.0_dp
    shear_3 = 3.0_dp*shear_modulus(material)
    call yield_stress_at(material, plastic_strain, strength, slope, segment_end)
    if (equivalent <= strength*(1.0_dp + yield_tolerance)) return
    reached = plastic_strain
    do
      flow = (reached - plastic_strain) &
             + (equivalent - shear_3*(reached - plastic_strain) - strength)/(shear_3 + slope)
      if (plastic_strain + flow <= segment_end) return
      reached = segment_end
      call yield_stress_at(material, reached, strength, slope, segment_end)
    end do
  end subroutine plastic_flow

  !> Consistent elastoplastic moduli
  !! K 1(x)1 + 2 G (1 - ratio) I_dev - 2 G (3 G/(3 G + H) - ratio) n(x)n. Source: theory.md (8).
  pure subroutine soften_moduli(state, deviator, shear, ratio, slope)
    type(principal_state_t), intent(inout) :: state
    real(dp), intent(in) :: deviator(3) !! of the trial strain [-]
    real(dp), intent(in) :: shear       !! G [force/length^2]
    real(dp), intent(in) :: ratio       !! 3 G flow over the trial sqrt(3 J2) [-]
    real(dp), intent(in) :: slope       !! H [force/length^2]
    real(dp) :: n(3), along
    integer :: i, j

    n = deviator/norm2(deviator)
    along = 2.0_dp*shear*(3.0_dp*shear/(3.0_dp*shear + slope) - ratio)
    do j = 1, 3
      do i = 1, 3
        state%d_kirchhoff_d_strain(i, j) = state%d_kirchhoff_d_strain(i, j) &
                                           + 2.0_dp*shear*ratio/3.0_dp - along*n(i)*n(j)
      end do
      state%d_kirchhoff_d_strain(j, j) = state%d_kirchhoff_d_strain(j, j) - 2.0_dp*shear*ratio
    end do
  end subroutine soften_moduli

end module mpm_von_mises
