!> What a failed attempt leaves behind that tells why it failed, and where.
module mpm_failure_evidence
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_iterations, &
    outcome_material, outcome_memory, outcome_not_finite, outcome_singular
  use mpm_nodal_frames, only: part_along
  use mpm_system, only: body_t, system_t
  implicit none
  private
  public :: failure_evidence_t, convergence_ratio, fill_fractions, free_residual, gather_evidence

  real(dp), parameter :: nearly_empty = 0.05_dp   !! filled fraction below this is suspicious [-]
  real(dp), parameter :: quadratic_below = 1.0e-3_dp !! residual from which it falls fast [-]
  real(dp), parameter :: slow = 0.1_dp            !! ratio of residuals that is not quadratic [-]
  real(dp), parameter :: steady = 5.0_dp          !! largest over smallest ratio of one rate [-]
  integer, parameter  :: n_ratios = 3             !! ratios that must be alike

  !> Where an attempt failed and what speaks for which cause. Indices, not labels; 0 = none.
  type :: failure_evidence_t
    integer  :: outcome = outcome_converged !! of the last attempt
    integer  :: node = 0               !! largest residual, of the element below if it failed
    integer  :: element = 0            !! the failed one, else the most deformed one at the node
    integer  :: point = 0              !! the failed or lost one, else the nearest to the node in
                                       !! the element
    integer  :: empty_element = 0      !! least filled element at the node, if it is nearly empty
    real(dp) :: fill = 1.0_dp          !! its filled fraction [-]
    real(dp) :: ratio = 0.0_dp         !! steady ratio of small residuals, 0: none [-]
    logical  :: overshot = .false.     !! the first correction made the residual larger than the
                                       !! forces themselves
    logical  :: falling = .false.      !! the last residual was smaller than the one before
    logical  :: limit_load = .false.   !! load control met a limit load
  end type failure_evidence_t

contains

  !> Gathers the evidence of the last attempt, or of the last increment if a point was lost.
  !! report%worst_point is then that point.
  pure subroutine gather_evidence(evidence, body, system, report)
    type(failure_evidence_t), intent(out) :: evidence
    type(body_t), intent(in)          :: body    !! converged
    type(system_t), intent(in)        :: system  !! as the attempt left it
    type(newton_report_t), intent(in) :: report  !! of the attempt

    evidence%outcome = report%outcome
    evidence%limit_load = report%at_limit_load
    call find_place(evidence, body, system, report)
    call find_empty_element(evidence, body, system)
    if (.not. allocated(report%residual)) return
    associate (residual => report%residual, n => ubound(report%residual, 1))
      evidence%ratio = convergence_ratio(residual)
      if (report%outcome == outcome_converged) return
      if (n >= 1) evidence%overshot = residual(1) > 1.0_dp
      if (n >= 1) evidence%falling = residual(n) < residual(n - 1)
    end associate
  end subroutine gather_evidence

  !> Node, element and point where it is worst.
  pure subroutine find_place(evidence, body, system, report)
    type(failure_evidence_t), intent(inout) :: evidence
    type(body_t), intent(in)          :: body    !! converged
    type(system_t), intent(in)        :: system  !! as the attempt left it
    type(newton_report_t), intent(in) :: report  !! of the attempt
    real(dp), allocatable :: residual(:, :)

    residual = free_residual(system)
    select case (report%outcome)
    case (outcome_converged, outcome_material)
      if (report%worst_point > 0) evidence%point = body%points%place(report%worst_point)
      if (evidence%point > 0) evidence%element = body%points%element(evidence%point)
    case (outcome_iterations, outcome_singular, outcome_memory, outcome_not_finite)
      evidence%element = 0 ! the report may name an element of an earlier iteration
    case default
      evidence%element = report%worst_element
    end select
    if (evidence%element > 0) then
      associate (node => body%mesh%node(:, evidence%element))
        evidence%node = node(maxloc(sum(residual(:, node)**2, dim=1), dim=1))
      end associate
    else
      evidence%node = maxloc(sum(residual**2, dim=1), dim=1, mask=active_nodes(body, system))
      if (report%outcome == outcome_not_finite) evidence%node = report%worst_node
      if (evidence%node > 0) evidence%element = most_deformed(evidence%node, body, system)
    end if
    if (evidence%point == 0) evidence%point = point_near(evidence, body)
  end subroutine find_place

  !> Residual along the free directions; 0 where there is no number.
  pure function free_residual(system) result(residual)
    type(system_t), intent(in) :: system
    real(dp), allocatable :: residual(:, :) !! (n_dim, n_node)  along the global axes [force]

    allocate (residual(size(system%u, 1), size(system%u, 2)), source=0.0_dp)
    if (.not. allocated(system%dofs%id)) return
    residual = part_along(system%dofs%frames, system%f_ext - system%f_int, system%dofs%id > 0)
    where (.not. ieee_is_finite(residual)) residual = 0.0_dp
  end function free_residual

  !> Nodes of active elements.
  pure function active_nodes(body, system) result(active)
    type(body_t), intent(in)   :: body
    type(system_t), intent(in) :: system
    logical :: active(body%mesh%n_node)
    integer :: i

    active = .false.
    do i = 1, size(system%element)
      active(body%mesh%node(:, system%element(i))) = .true.
    end do
  end function active_nodes

  !> The active element at a node whose volume changes most in the attempt; of equal ones the first.
  pure integer function most_deformed(node, body, system) result(found)
    integer, intent(in) :: node
    type(body_t), intent(in)   :: body
    type(system_t), intent(in) :: system
    real(dp) :: change, largest
    integer :: e, i

    found = 0
    largest = -1.0_dp
    do i = 1, size(system%element)
      e = system%element(i)
      if (all(body%mesh%node(:, e) /= node)) cycle
      change = abs(system%kinematics%delta_j_m1(e))
      if (change <= largest) cycle
      largest = change
      found = e
    end do
  end function most_deformed

  !> The point of the worst element that is nearest to the worst node, 0 without points.
  pure integer function point_near(evidence, body) result(found)
    type(failure_evidence_t), intent(in) :: evidence !! node and element
    type(body_t), intent(in) :: body
    real(dp) :: distance, least
    integer :: i, p

    found = 0
    if (evidence%element == 0) return
    least = huge(1.0_dp)
    do i = body%points%first(evidence%element), body%points%first(evidence%element + 1) - 1
      p = body%points%order(i)
      distance = sum((body%points%x(:, p) - body%mesh%x(:, evidence%node))**2)
      if (distance >= least) cycle
      least = distance
      found = p
    end do
  end function point_near

  !> The least filled of the elements with material at the worst node, if it is nearly empty.
  pure subroutine find_empty_element(evidence, body, system)
    type(failure_evidence_t), intent(inout) :: evidence !! node is known
    type(body_t), intent(in)   :: body
    type(system_t), intent(in) :: system
    real(dp) :: fill(body%mesh%n_el)
    integer :: e, i

    if (evidence%node == 0) return
    fill = fill_fractions(body%mesh, body%points)
    evidence%fill = nearly_empty
    do i = 1, size(system%element)
      e = system%element(i)
      if (all(body%mesh%node(:, e) /= evidence%node) .or. fill(e) >= evidence%fill) cycle
      evidence%empty_element = e
      evidence%fill = fill(e)
    end do
  end subroutine find_empty_element

  !> Volume of the points of each element over the volume of the element.
  pure function fill_fractions(mesh, points) result(fill)
    type(mesh_t), intent(in)   :: mesh
    type(points_t), intent(in) :: points !! located in this mesh
    real(dp) :: fill(mesh%n_el)          !! (n_el)  0 = empty [-]
    integer :: e

    do e = 1, mesh%n_el
      fill(e) = sum(points%volume(points%order(points%first(e):points%first(e + 1) - 1))) &
                /mesh%volume(e)
    end do
  end function fill_fractions

  !> Ratio r_(k+1)/r_k of the last residuals when they are small and yet fall at one slow rate, as
  !! quadratic convergence never does. Source: theory.md, section 7.
  pure real(dp) function convergence_ratio(residual) result(ratio)
    real(dp), intent(in) :: residual(:) !! relative, one per iteration [-]
    real(dp) :: ratios(n_ratios)
    integer :: n

    ratio = 0.0_dp
    n = size(residual)
    if (n <= n_ratios) return
    associate (before => residual(n - n_ratios:n - 1), after => residual(n - n_ratios + 1:n))
      if (any(before <= 0.0_dp) .or. any(before >= quadratic_below)) return
      ratios = after/before
    end associate
    if (any(ratios <= slow) .or. any(ratios >= 1.0_dp)) return
    if (maxval(ratios) > steady*minval(ratios)) return
    ratio = product(ratios)**(1.0_dp/real(n_ratios, dp))
  end function convergence_ratio

end module mpm_failure_evidence
