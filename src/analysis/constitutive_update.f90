!> Stress update of all points, and the sums over the points of each element.
module mpm_constitutive_update
  use mpm_kinds, only: dp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  use mpm_stress_batch, only: batch_size, put_point, set_material, stress_batch_t, update_batch, &
    voigt_pair
  implicit none
  private
  public :: element_sums_t, allocate_sums, update_points

  integer, parameter :: chunk_size = 64 !! elements that a thread takes at a time

  !> Sums over the points of an element, weighted with the current volume v_p.
  type :: element_sums_t
    real(dp), allocatable :: stress(:, :)     !! (6, n_el)     sum v sigma [force length]
    real(dp), allocatable :: moduli(:, :, :)  !! (6, 6, n_el)  sum v c/Jbar [force length]
    integer, allocatable :: plastic_in(:)     !! (n_el)        points that flow
    integer, allocatable :: failed_in(:)      !! (n_el)        first point whose update failed, 0 if none
    integer :: n_plastic = 0                  !! points that flow in this update
    integer :: failed_point = 0               !! first point whose update failed, 0 if none
    logical :: has_moduli = .false.           !! moduli belong to this update
  end type element_sums_t

  !> Points of a chunk of elements on their way through the stress update.
  type :: passage_t
    type(stress_batch_t) :: batch
    integer  :: n = 0                 !! points in the batch
    integer  :: point(batch_size) = 0 !! which ones
    integer  :: element = 0           !! element whose points are being summed, 0 before the first
    real(dp) :: stress(6) = 0.0_dp    !! sum of its points so far [force length]
    real(dp) :: moduli(21) = 0.0_dp   !! sum of its points so far, upper triangle [force length]
  end type passage_t

contains

  !> Allocates the sums for n_el elements.
  pure subroutine allocate_sums(sums, n_el)
    type(element_sums_t), intent(out) :: sums
    integer, intent(in) :: n_el

    allocate (sums%stress(6, n_el), source=0.0_dp)
    allocate (sums%moduli(6, 6, n_el), source=0.0_dp)
    allocate (sums%plastic_in(n_el), sums%failed_in(n_el), source=0)
  end subroutine allocate_sums

  !> Element sums of the stresses and moduli that the points would have. Their states are not kept:
  !! they follow from the kinematics once more when the increment is accepted.
  !! v sigma = (v_n/Jbar_n) tau because both v and Jbar grow by det dFbar. Every point and every sum
  !! is independent of the others: the result does not depend on the number of threads.
  !! Source: theory.md (6)-(12).
  subroutine update_points(sums, points, materials, kinematics, element, with_moduli)
    type(element_sums_t), intent(inout) :: sums
    type(points_t), intent(in)          :: points       !! converged, grouped by element
    type(material_t), intent(in)        :: materials(:)
    type(kinematics_t), intent(in)      :: kinematics
    integer, intent(in)                 :: element(:)   !! active elements
    logical, intent(in)                 :: with_moduli  !! .false.: stresses are enough
    integer :: first, i

    sums%has_moduli = with_moduli
    !$omp parallel do default(shared) schedule(dynamic)
    do first = 1, size(element), chunk_size
      call update_chunk(sums, points, materials, kinematics, &
                        element(first:min(first + chunk_size - 1, size(element))))
    end do
    !$omp end parallel do
    sums%n_plastic = sum(sums%plastic_in(element))
    sums%failed_point = 0
    do i = 1, size(element)
      sums%failed_point = sums%failed_in(element(i))
      if (sums%failed_point > 0) exit
    end do
  end subroutine update_points

  !> The points of some elements, batch by batch in the order of points%order.
  pure subroutine update_chunk(sums, points, materials, kinematics, element)
    type(element_sums_t), intent(inout) :: sums
    type(points_t), intent(in)          :: points
    type(material_t), intent(in)        :: materials(:)
    type(kinematics_t), intent(in)      :: kinematics
    integer, intent(in)                 :: element(:) !! active elements
    type(passage_t) :: passage
    integer :: e, i, j, p

    do j = 1, size(element)
      e = element(j)
      sums%plastic_in(e) = 0
      sums%failed_in(e) = 0
      do i = points%first(e), points%first(e + 1) - 1
        p = points%order(i)
        passage%n = passage%n + 1
        passage%point(passage%n) = p
        call put_point(passage%batch, passage%n, kinematics%disp_grad_bar(:, :, e), &
                       points%state%left_cauchy_green_e_m1(:, p), points%state%hardening(1, p))
        call set_material(passage%batch, passage%n, points%material(p), &
                          materials(points%material(p)))
        if (passage%n == batch_size) call pass(passage, sums, points, materials)
      end do
    end do
    if (passage%n > 0) call pass(passage, sums, points, materials)
    call close_sum(passage, sums)
  end subroutine update_chunk

  !> Updates a batch and adds to the sums, point by point.
  pure subroutine pass(passage, sums, points, materials)
    type(passage_t), intent(inout)      :: passage !! out: batch empty
    type(element_sums_t), intent(inout) :: sums
    type(points_t), intent(in)          :: points
    type(material_t), intent(in)        :: materials(:)
    real(dp) :: factor
    integer :: e, l, p

    associate (batch => passage%batch)
      ! Nothing happens in places without a point.
      batch%disp_grad_bar(passage%n + 1:, :, :) = 0.0_dp
      batch%cg_e_m1(passage%n + 1:, :) = 0.0_dp
      call update_batch(batch, materials, sums%has_moduli)
      do l = 1, passage%n
        p = passage%point(l)
        e = points%element(p)
        if (e /= passage%element) then
          call close_sum(passage, sums)
          passage%element = e
        end if
        if (batch%failed(l)) then
          if (sums%failed_in(e) == 0) sums%failed_in(e) = p
          cycle
        end if
        if (batch%flows(l)) sums%plastic_in(e) = sums%plastic_in(e) + 1
        factor = points%volume(p)/points%state%jacobian_bar(p)
        passage%stress = passage%stress + factor*batch%kirchhoff(l, :)
        if (sums%has_moduli) passage%moduli = passage%moduli + factor*batch%moduli(l, :)
      end do
    end associate
    passage%n = 0
  end subroutine pass

  !> Writes the sums of an element whose points have all been added, and begins anew.
  pure subroutine close_sum(passage, sums)
    type(passage_t), intent(inout)      :: passage
    type(element_sums_t), intent(inout) :: sums
    integer :: v, w

    if (passage%element == 0) return
    sums%stress(:, passage%element) = passage%stress
    passage%stress = 0.0_dp
    if (.not. sums%has_moduli) return
    do w = 1, 6
      do v = 1, 6
        sums%moduli(v, w, passage%element) = passage%moduli(voigt_pair(v, w))
      end do
    end do
    passage%moduli = 0.0_dp
  end subroutine close_sum

end module mpm_constitutive_update
