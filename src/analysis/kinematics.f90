!> Kinematics of an increment, constant in each element.
module mpm_kinematics
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_symmetric_eigen, only: eigen_symmetric
  use mpm_tensor, only: det_m1, identity, inverse, log1p, voigt_from_tensor
  implicit none
  private
  public :: kinematics_t, allocate_kinematics, compute_kinematics, find_largest_stretch

  real(dp), parameter :: flat = 1.0e-12_dp !! J_e below this is rounding, not volume [-]

  !> Element and patch arrays of the increment; entries of inactive elements keep the values of no motion.
  type :: kinematics_t
    real(dp), allocatable :: disp_grad(:, :, :)     !! (3, 3, n_el)  H = dF - I [-]
    real(dp), allocatable :: disp_grad_bar(:, :, :) !! (3, 3, n_el)  dFbar - I [-]
    real(dp), allocatable :: delta_j_m1(:)          !! (n_el)        J_e - 1 [-]
    real(dp), allocatable :: delta_j_bar_m1(:)      !! (n_el)        det dFbar_e - 1 = theta_P - 1 [-]
    real(dp), allocatable :: weight(:)              !! (n_el)        w_s of theory.md (13), 0 if inactive [-]
    real(dp), allocatable :: grad_shape(:, :, :)    !! (n_dim, n_dim+1, n_el)  current gradients [1/length]
  end type kinematics_t

contains

  !> Allocates for a mesh and sets the state of no motion.
  pure subroutine allocate_kinematics(kinematics, mesh)
    type(kinematics_t), intent(out) :: kinematics
    type(mesh_t), intent(in) :: mesh

    allocate (kinematics%disp_grad(3, 3, mesh%n_el), source=0.0_dp)
    allocate (kinematics%disp_grad_bar(3, 3, mesh%n_el), source=0.0_dp)
    allocate (kinematics%delta_j_m1(mesh%n_el), source=0.0_dp)
    allocate (kinematics%delta_j_bar_m1(mesh%n_el), source=0.0_dp)
    allocate (kinematics%weight(mesh%n_el), source=0.0_dp)
    allocate (kinematics%grad_shape, source=mesh%grad_shape)
  end subroutine allocate_kinematics

  !> dF_e - I, J_e - 1 and current gradients of active elements. Source: theory.md (1)-(3).
  !! Independent per element: the result does not depend on the number of threads.
  subroutine compute_kinematics(kinematics, inverted, mesh, element, u)
    type(kinematics_t), intent(inout) :: kinematics
    integer, intent(out)     :: inverted   !! first element that is flat or inside out, 0 if none
    type(mesh_t), intent(in) :: mesh       !! at the start of the increment
    integer, intent(in)      :: element(:) !! active elements
    real(dp), intent(in)     :: u(:, :)    !! (n_dim, n_node)  displacement of the increment [length]
    integer :: i, e, n_dim
    real(dp) :: h(3, 3), delta_j_m1, inverse_f(3, 3)

    n_dim = mesh%n_dim
    inverted = huge(inverted)
    !$omp parallel do default(shared) private(e, h, delta_j_m1, inverse_f) reduction(min: inverted)
    do i = 1, size(element)
      e = element(i)
      h = 0.0_dp
      h(1:n_dim, 1:n_dim) = matmul(u(:, mesh%node(:, e)), transpose(mesh%grad_shape(:, :, e)))
      delta_j_m1 = det_m1(h)
      kinematics%disp_grad(:, :, e) = h
      kinematics%delta_j_m1(e) = delta_j_m1
      if (.not. delta_j_m1 > flat - 1.0_dp) then
        inverted = min(inverted, e)
        cycle
      end if
      inverse_f = inverse(identity + h)
      kinematics%grad_shape(:, :, e) = matmul(transpose(inverse_f(1:n_dim, 1:n_dim)), &
                                              mesh%grad_shape(:, :, e))
    end do
    !$omp end parallel do
    if (inverted == huge(inverted)) inverted = 0
  end subroutine compute_kinematics

  !> The active element that an increment stretches or squeezes most. Source: theory.md (15b).
  pure subroutine find_largest_stretch(stretch, worst, kinematics, element)
    real(dp), intent(out) :: stretch             !! largest |ln(principal stretch)| of dF [-]
    integer, intent(out)  :: worst               !! its element, of equal ones the first; 0 at rest
    type(kinematics_t), intent(in) :: kinematics !! computed
    integer, intent(in)   :: element(:)          !! active elements, not inverted
    real(dp) :: h(3, 3), square_m1(3), axes(3, 3), here
    integer  :: i

    stretch = 0.0_dp
    worst = 0
    do i = 1, size(element)
      h = kinematics%disp_grad(:, :, element(i))
      call eigen_symmetric(voigt_from_tensor(h + transpose(h) + matmul(transpose(h), h)), &
                           square_m1, axes)
      here = 0.5_dp*max(log1p(maxval(square_m1)), &
                        -log1p(max(minval(square_m1), flat - 1.0_dp)))
      if (here <= stretch) cycle
      stretch = here
      worst = element(i)
    end do
  end subroutine find_largest_stretch

end module mpm_kinematics
