!> Stress update of one point: from the increment of deformation to Kirchhoff stress and moduli.
module mpm_stress_update
  use mpm_hencky, only: hencky_moduli, hencky_stress, spatial_moduli
  use mpm_kinds, only: dp
  use mpm_material, only: bulk_modulus, law_von_mises, material_t, shear_modulus
  use mpm_symmetric_eigen, only: eigen_symmetric, isotropic_voigt
  use mpm_tensor, only: expm1, log1p, push_forward_m1
  use mpm_von_mises, only: principal_state_t, return_radially
  implicit none
  private
  public :: point_response_t, update_stress

  !> What the update of a point gives; Voigt order 11, 22, 33, 12, 23, 13, tensor components.
  type :: point_response_t
    real(dp) :: strain_e(6)               !! elastic logarithmic strain [-]
    real(dp) :: left_cauchy_green_e_m1(6) !! b_e - 1 [-]
    real(dp) :: kirchhoff(6)              !! [force/length^2]
    real(dp) :: moduli(6, 6)              !! c of theory.md (12), Kirchhoff [force/length^2]
    real(dp) :: plastic_strain            !! accumulated [-]
    logical  :: flows                     !! plastic flow in this update
    logical  :: failed                    !! trial b_e not positive definite or not a number
  end type point_response_t

contains

  !> Trial state by push-forward, return mapping in principal axes, spatial moduli.
  !! Source: theory.md (6)-(8), (12).
  pure subroutine update_stress(response, material, disp_grad_bar, cg_e_m1, plastic_strain)
    type(point_response_t), intent(out) :: response
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: disp_grad_bar(3, 3) !! dFbar - I [-]
    real(dp), intent(in) :: cg_e_m1(6)          !! converged b_e - 1 [-]
    real(dp), intent(in) :: plastic_strain      !! converged, accumulated [-]
    type(principal_state_t) :: state
    real(dp) :: value(3), vector(3, 3), strain(3)
    integer :: i

    call eigen_symmetric(push_forward_m1(disp_grad_bar, cg_e_m1), value, vector)
    response%failed = .not. (minval(value) > -1.0_dp .and. maxval(value) < huge(1.0_dp))
    if (response%failed) return
    do i = 1, 3
      strain(i) = 0.5_dp*log1p(value(i))
    end do
    select case (material%law)
    case (law_von_mises)
      call return_radially(state, material, strain, plastic_strain)
    case default
      call stay_elastic(state, material, strain, plastic_strain)
    end select
    response%flows = state%flows
    response%plastic_strain = state%plastic_strain
    response%strain_e = isotropic_voigt(state%strain_e, vector)
    response%kirchhoff = isotropic_voigt(state%kirchhoff, vector)
    call spatial_moduli(response%moduli, vector, value, state%kirchhoff, &
                        state%d_kirchhoff_d_strain, state%secant)
    if (state%flows) then
      do i = 1, 3
        value(i) = expm1(2.0_dp*state%strain_e(i))
      end do
    end if
    response%left_cauchy_green_e_m1 = isotropic_voigt(value, vector)
  end subroutine update_stress

  !> Hencky elasticity alone. Source: theory.md (7).
  pure subroutine stay_elastic(state, material, strain, plastic_strain)
    type(principal_state_t), intent(out) :: state
    type(material_t), intent(in) :: material
    real(dp), intent(in) :: strain(3)      !! principal trial logarithmic strains [-]
    real(dp), intent(in) :: plastic_strain !! accumulated so far [-]

    state%strain_e = strain
    state%plastic_strain = plastic_strain
    state%secant = 2.0_dp*shear_modulus(material)
    state%d_kirchhoff_d_strain = hencky_moduli(bulk_modulus(material), shear_modulus(material))
    state%kirchhoff = hencky_stress(bulk_modulus(material), shear_modulus(material), strain)
  end subroutine stay_elastic

end module mpm_stress_update
