!> Stress update of all points, and the sums over the points of each element.
module mpm_constitutive_update
  use mpm_kinds, only: dp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_material_points, only: point_state_t, points_t
  use mpm_stress_update, only: point_response_t, update_stress
  implicit none
  private
  public :: element_sums_t, allocate_sums, update_points

  !> Sums over the points of an element, weighted with the current volume v_p.
  type :: element_sums_t
    real(dp), allocatable :: stress(:, :)     !! (6, n_el)     sum v sigma [force length]
    real(dp), allocatable :: moduli(:, :, :)  !! (6, 6, n_el)  sum v c/Jbar [force length]
    integer, allocatable :: plastic_in(:)     !! (n_el)        points that flow
    integer, allocatable :: failed_in(:)      !! (n_el)        first point whose update failed, 0 if none
    integer :: n_plastic = 0                  !! points that flow in this update
    integer :: failed_point = 0               !! first point whose update failed, 0 if none
  end type element_sums_t

contains

  !> Allocates the sums for n_el elements.
  pure subroutine allocate_sums(sums, n_el)
    type(element_sums_t), intent(out) :: sums
    integer, intent(in) :: n_el

    allocate (sums%stress(6, n_el), source=0.0_dp)
    allocate (sums%moduli(6, 6, n_el), source=0.0_dp)
    allocate (sums%plastic_in(n_el), sums%failed_in(n_el), source=0)
  end subroutine allocate_sums

  !> Trial state of all points in the active elements and the element sums.
  !! v sigma = (v_n/Jbar_n) tau because both v and Jbar grow by det dFbar. Source: theory.md (6)-(12).
  subroutine update_points(trial, sums, points, materials, kinematics, element)
    type(point_state_t), intent(inout)  :: trial        !! allocated like points%state
    type(element_sums_t), intent(inout) :: sums
    type(points_t), intent(in)          :: points       !! converged, grouped by element
    type(material_t), intent(in)        :: materials(:)
    type(kinematics_t), intent(in)      :: kinematics
    integer, intent(in)                 :: element(:)   !! active elements
    integer :: i

    !$omp parallel do default(shared) schedule(static)
    do i = 1, size(element)
      call update_element(trial, sums, points, materials, kinematics, element(i))
    end do
    !$omp end parallel do
    sums%n_plastic = sum(sums%plastic_in(element))
    sums%failed_point = 0
    do i = 1, size(element)
      sums%failed_point = sums%failed_in(element(i))
      if (sums%failed_point > 0) exit
    end do
  end subroutine update_points

  !> The points of one element, in the order of points%order.
  pure subroutine update_element(trial, sums, points, materials, kinematics, e)
    type(point_state_t), intent(inout)  :: trial
    type(element_sums_t), intent(inout) :: sums
    type(points_t), intent(in)          :: points
    type(material_t), intent(in)        :: materials(:)
    type(kinematics_t), intent(in)      :: kinematics
    integer, intent(in)                 :: e !! element
    type(point_response_t) :: response
    real(dp) :: stress(6), moduli(6, 6), factor
    integer :: i, p

    sums%plastic_in(e) = 0
    sums%failed_in(e) = 0
    stress = 0.0_dp
    moduli = 0.0_dp
    do i = points%first(e), points%first(e + 1) - 1
      p = points%order(i)
      call update_stress(response, materials(points%material(p)), kinematics%disp_grad_bar(:, :, e), &
                         points%state%left_cauchy_green_e_m1(:, p), points%state%hardening(1, p))
      if (response%failed) then
        sums%failed_in(e) = p
        exit
      end if
      if (response%flows) sums%plastic_in(e) = sums%plastic_in(e) + 1
      factor = points%volume(p)/points%state%jacobian_bar(p)
      stress = stress + factor*response%kirchhoff
      moduli = moduli + factor*response%moduli
      trial%strain_e(:, p) = response%strain_e
      trial%left_cauchy_green_e_m1(:, p) = response%left_cauchy_green_e_m1
      trial%hardening(1, p) = response%plastic_strain
      trial%jacobian_bar(p) = points%state%jacobian_bar(p)*(1.0_dp + kinematics%delta_j_bar_m1(e))
      trial%cauchy(:, p) = response%kirchhoff/trial%jacobian_bar(p)
    end do
    sums%stress(:, e) = stress
    sums%moduli(:, :, e) = moduli
  end subroutine update_element

end module mpm_constitutive_update
