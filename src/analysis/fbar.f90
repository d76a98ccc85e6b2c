!> F-bar patch: the volume change of an element is replaced by that of its patch.
module mpm_fbar
  use mpm_kinds, only: dp
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh, only: mesh_t
  use mpm_patches, only: patches_t
  use mpm_tensor, only: expm1, identity, log1p
  implicit none
  private
  public :: project_onto_patches

contains

  !> Patch mean theta_P of the volume change, dFbar_e and the weights of the linearisation.
  !! A patch with one active element gets dFbar = dF to the last bit. Source: theory.md (4), (5), (13).
  subroutine project_onto_patches(kinematics, mesh, patches, active)
    type(kinematics_t), intent(inout) :: kinematics
    type(mesh_t), intent(in)    :: mesh      !! at the start of the increment
    type(patches_t), intent(in) :: patches
    logical, intent(in)         :: active(:) !! (n_el)
    integer :: i

    !$omp parallel do default(shared)
    do i = 1, patches%n
      call project_patch(kinematics, mesh, active, &
                         patches%element(patches%first(i):patches%first(i + 1) - 1))
    end do
    !$omp end parallel do
  end subroutine project_onto_patches

  !> One patch. Works with J - 1 and theta - 1, never with J: increments may be tiny.
  pure subroutine project_patch(kinematics, mesh, active, element)
    type(kinematics_t), intent(inout) :: kinematics
    type(mesh_t), intent(in) :: mesh
    logical, intent(in)      :: active(:)  !! (n_el)
    integer, intent(in)      :: element(:) !! elements of the patch
    real(dp) :: volume, change, theta_m1
    integer :: i, e, n_active

    volume = 0.0_dp
    change = 0.0_dp
    n_active = 0
    do i = 1, size(element)
      e = element(i)
      if (.not. active(e)) cycle
      n_active = n_active + 1
      volume = volume + mesh%volume(e)
      change = change + mesh%volume(e)*kinematics%delta_j_m1(e)
    end do
    kinematics%weight(element) = 0.0_dp
    if (n_active == 0) return
    theta_m1 = change/volume
    do i = 1, size(element)
      e = element(i)
      if (.not. active(e)) cycle
      if (n_active == 1) then
        call keep_ordinary(kinematics, e)
      else
        kinematics%weight(e) = mesh%volume(e)*(1.0_dp + kinematics%delta_j_m1(e)) &
                               /(volume*(1.0_dp + theta_m1))
        call scale_volume(kinematics, mesh%n_dim, e, theta_m1)
      end if
    end do
  end subroutine project_patch

  !> dFbar = dF for an element alone in its patch.
  pure subroutine keep_ordinary(kinematics, e)
    type(kinematics_t), intent(inout) :: kinematics
    integer, intent(in) :: e !! element

    kinematics%weight(e) = 1.0_dp
    kinematics%delta_j_bar_m1(e) = kinematics%delta_j_m1(e)
    kinematics%disp_grad_bar(:, :, e) = kinematics%disp_grad(:, :, e)
  end subroutine keep_ordinary

  !> dFbar - I = H + s (I + H) with s = (theta/J)^(1/n) - 1; plane strain scales in the plane only.
  pure subroutine scale_volume(kinematics, n_dim, e, theta_m1)
    type(kinematics_t), intent(inout) :: kinematics
    integer, intent(in)  :: n_dim    !! 2 or 3
    integer, intent(in)  :: e        !! element
    real(dp), intent(in) :: theta_m1 !! theta_P - 1 [-]
    real(dp) :: s, delta_j_m1

    delta_j_m1 = kinematics%delta_j_m1(e)
    s = expm1(log1p((theta_m1 - delta_j_m1)/(1.0_dp + delta_j_m1))/real(n_dim, dp))
    kinematics%delta_j_bar_m1(e) = theta_m1
    kinematics%disp_grad_bar(:, :, e) = kinematics%disp_grad(:, :, e)
    kinematics%disp_grad_bar(1:n_dim, 1:n_dim, e) = kinematics%disp_grad(1:n_dim, 1:n_dim, e) &
      + s*(identity(1:n_dim, 1:n_dim) + kinematics%disp_grad(1:n_dim, 1:n_dim, e))
  end subroutine scale_volume

end module mpm_fbar
