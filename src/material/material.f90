!> Parameters of a material: Hencky elasticity with an optional von Mises limit.
module mpm_material
  use mpm_kinds, only: dp
  implicit none
  private
  public :: material_t, law_elastic, law_von_mises
  public :: bulk_modulus, shear_modulus, yield_stress_at

  integer, parameter :: law_elastic = 1   !! Hencky elasticity
  integer, parameter :: law_von_mises = 2 !! Hencky elasticity with von Mises plasticity

  !> One material. Yield stress and plastic strain are stored in the uniaxial measure,
  !! sqrt(3 J2) and its work conjugate, whatever the deck used.
  type :: material_t
    character(:), allocatable :: name
    integer  :: law = law_elastic
    real(dp) :: density = 0.0_dp !! [mass/length^3]
    real(dp) :: young = 0.0_dp   !! [force/length^2]
    real(dp) :: poisson = 0.0_dp !! [-]
    real(dp), allocatable :: yield_stress(:)   !! (n)  sqrt(3 J2) of the Kirchhoff stress at yield
    real(dp), allocatable :: plastic_strain(:) !! (n)  accumulated plastic strain, 0 first, ascending;
                                               !!      linear between, constant beyond the last
  end type material_t

contains

  !> Shear modulus. Source: G = E/(2 (1 + nu)).
  pure function shear_modulus(material) result(shear)
    type(material_t), intent(in) :: material
    real(dp) :: shear !! [force/length^2]

    shear = material%young/(2.0_dp*(1.0_dp + material%poisson))
  end function shear_modulus

  !> Bulk modulus. Source: K = E/(3 (1 - 2 nu)).
  pure function bulk_modulus(material) result(bulk)
    type(material_t), intent(in) :: material
    real(dp) :: bulk !! [force/length^2]

    bulk = material%young/(3.0_dp*(1.0_dp - 2.0_dp*material%poisson))
  end function bulk_modulus

  !> Yield stress and slope of the hardening table at an accumulated plastic strain.
  pure subroutine yield_stress_at(material, strain, stress, slope, segment_end)
    type(material_t), intent(in) :: material
    real(dp), intent(in)  :: strain      !! accumulated plastic strain, >= 0 [-]
    real(dp), intent(out) :: stress      !! sqrt(3 J2) at yield [force/length^2]
    real(dp), intent(out) :: slope       !! d stress / d strain to the right of strain [force/length^2]
    real(dp), intent(out) :: segment_end !! strain up to which the slope holds, huge in the last
    integer :: i, n

    n = size(material%yield_stress)
    stress = material%yield_stress(n)
    slope = 0.0_dp
    segment_end = huge(1.0_dp)
    do i = 2, n
      if (strain < material%plastic_strain(i)) then
        slope = (material%yield_stress(i) - material%yield_stress(i - 1)) &
                /(material%plastic_strain(i) - material%plastic_strain(i - 1))
        stress = material%yield_stress(i - 1) + slope*(strain - material%plastic_strain(i - 1))
        segment_end = material%plastic_strain(i)
        return
      end if
    end do
  end subroutine yield_stress_at

end module mpm_material
