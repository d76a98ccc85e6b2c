!> State of an undeformed point that starts under stress.
module mpm_initial_state
  use mpm_hencky, only: hencky_strain
  use mpm_kinds, only: dp
  use mpm_material, only: bulk_modulus, law_von_mises, material_t, shear_modulus
  use mpm_symmetric_eigen, only: eigen_symmetric, isotropic_voigt
  use mpm_tensor, only: expm1
  use mpm_von_mises, only: compare_strength
  implicit none
  private
  public :: initial_state_t, largest_strain, state_of_stress

  real(dp), parameter :: largest_strain = 1.0_dp !! elastic logarithmic strain to start with [-]

  !> What a stress makes of a point with F = I and Jbar = 1; Voigt order 11, 22, 33, 12, 23, 13.
  type :: initial_state_t
    real(dp) :: strain_e(6) = 0.0_dp               !! elastic logarithmic strain [-]
    real(dp) :: left_cauchy_green_e_m1(6) = 0.0_dp !! b_e - 1 [-]
    logical  :: too_large = .false.                !! .true.: strains beyond any use, nothing else is set
    logical  :: outside = .false.                  !! .true.: outside the yield surface
    real(dp) :: found = 0.0_dp                     !! sqrt(3 J2), where there is a strength
    real(dp) :: allowed = 0.0_dp                   !! sqrt(3 J2) at first yield [force/length^2]
  end type initial_state_t

contains

  !> Elastic strain of a stress in its principal axes, and b_e - 1 from it. With Jbar = 1 the Cauchy
  !! stress is the Kirchhoff stress. Source: theory.md (21a).
  pure subroutine state_of_stress(state, material, cauchy)
    type(initial_state_t), intent(out) :: state
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: cauchy(6) !! initial stress [force/length^2]
    real(dp) :: stress(3), strain(3), stretch_m1(3), vector(3, 3)
    integer :: i

    ! Far above the moduli even the squares of the stress may not be numbers.
    state%too_large = .not. maxval(abs(cauchy)) < 10.0_dp*(bulk_modulus(material) &
                                                           + shear_modulus(material))
    if (state%too_large) return
    call eigen_symmetric(cauchy, stress, vector)
    strain = hencky_strain(bulk_modulus(material), shear_modulus(material), stress)
    state%too_large = maxval(abs(strain)) > largest_strain
    if (state%too_large) return
    do i = 1, 3
      stretch_m1(i) = expm1(2.0_dp*strain(i))
    end do
    state%strain_e = isotropic_voigt(strain, vector)
    state%left_cauchy_green_e_m1 = isotropic_voigt(stretch_m1, vector)
    if (material%law == law_von_mises) then
      call compare_strength(state%outside, state%found, state%allowed, material, stress)
    end if
  end subroutine state_of_stress

end module mpm_initial_state
