!> What Newton's method did in an attempt at an increment, and how that ended.
module mpm_newton_report
  use mpm_eigenvalues, only: eigenvalues_t
  use mpm_kinds, only: dp
  implicit none
  private
  public :: newton_report_t, close_report, open_report, outcome_text
  public :: outcome_converged, outcome_inverted, outcome_material, outcome_stagnated
  public :: outcome_iterations, outcome_singular, outcome_memory, outcome_interrupted
  public :: outcome_not_finite, outcome_stretched

  integer, parameter :: outcome_converged = 0  !! equilibrium found
  integer, parameter :: outcome_inverted = 1   !! an active element turned inside out
  integer, parameter :: outcome_material = 2   !! the state update of a point failed
  integer, parameter :: outcome_stagnated = 3  !! residual does not fall, or NaN
  integer, parameter :: outcome_iterations = 4 !! too many iterations
  integer, parameter :: outcome_singular = 5   !! tangent singular
  integer, parameter :: outcome_memory = 6     !! linear solver out of memory
  integer, parameter :: outcome_interrupted = 7 !! a signal asks to end
  integer, parameter :: outcome_not_finite = 8 !! displacements or forces are infinite or no numbers
  integer, parameter :: outcome_stretched = 9  !! equilibrium found, but the increment is too large

  !> What Newton's method did in one attempt at an increment.
  type :: newton_report_t
    integer :: outcome = outcome_converged
    integer :: n_iterations = 0
    real(dp), allocatable :: residual(:)   !! (0:n_iterations)  relative residual [-], index 0 before the
                                           !! first correction
    integer, allocatable  :: backtracks(:) !! (n_iterations)
    real(dp), allocatable :: seconds(:, :) !! (5, n_iterations)  CPU: kinematics, stress, assembly,
                                           !! factorisation, solve [s]
    integer, allocatable  :: gmres(:)      !! (n_iterations)  iterations of GMRES, 0 = none
    logical, allocatable  :: is_new(:)     !! (n_iterations)  the factors are of this tangent
    logical :: left_single = .false.       !! factors of single precision no longer serve
    integer :: worst_node = 0              !! node of the largest residual
    integer :: worst_element = 0           !! inverted, or with a failed point, 0 if none
    integer :: worst_point = 0             !! id of a failed point, 0 if none
    integer :: n_plastic = 0               !! points that flowed in the last evaluation
    integer, allocatable :: flowing(:)     !! (0:n_iterations)  points that flow
    real(dp) :: rcond = 1.0_dp             !! smallest over largest pivot, least of all factors [-]
    real(dp) :: at_rest = 0.0_dp           !! relative residual without any displacement [-]
    logical  :: at_limit_load = .false.    !! load control has met a limit load, see mpm_limit_load
    logical  :: predicted = .false.        !! began with the motion of the last increment
    integer  :: n_given_up = 0             !! corrections after a prediction that led nowhere
    integer  :: n_inexact = 0              !! corrections of limited accuracy that led nowhere
    real(dp) :: stretch = 0.0_dp           !! largest one of an active element, in equilibrium [-]
    real(dp) :: reach = 0.0_dp             !! largest way of the load in one correction [length]
    type(eigenvalues_t) :: eigenvalues     !! of the last tangent, if they were asked for
  end type newton_report_t

contains

  !> Room for all iterations.
  pure subroutine open_report(report, max_iterations)
    type(newton_report_t), intent(out) :: report
    integer, intent(in) :: max_iterations

    allocate (report%residual(0:max_iterations), source=0.0_dp)
    allocate (report%flowing(0:max_iterations), source=0)
    allocate (report%backtracks(max_iterations), source=0)
    allocate (report%gmres(max_iterations), source=0)
    allocate (report%is_new(max_iterations), source=.false.)
    allocate (report%seconds(5, max_iterations), source=0.0_dp)
  end subroutine open_report

  !> Cuts the room to the iterations made.
  pure subroutine close_report(report)
    type(newton_report_t), intent(inout) :: report
    real(dp), allocatable :: residual(:)
    integer, allocatable :: flowing(:)

    allocate (residual(0:report%n_iterations), source=report%residual(0:report%n_iterations))
    call move_alloc(residual, report%residual)
    allocate (flowing(0:report%n_iterations), source=report%flowing(0:report%n_iterations))
    call move_alloc(flowing, report%flowing)
    report%backtracks = report%backtracks(:report%n_iterations)
    report%seconds = report%seconds(:, :report%n_iterations)
    report%gmres = report%gmres(:report%n_iterations)
    report%is_new = report%is_new(:report%n_iterations)
  end subroutine close_report

  !> What an outcome means, for messages.
  pure function outcome_text(outcome) result(text)
    integer, intent(in) :: outcome !! outcome_*
    character(:), allocatable :: text

    select case (outcome)
    case (outcome_converged); text = "converged"
    case (outcome_inverted); text = "an element turned inside out"
    case (outcome_material); text = "the stress update of a material point failed"
    case (outcome_stagnated); text = "the residual did not fall"
    case (outcome_iterations); text = "too many iterations"
    case (outcome_singular); text = "the tangent is singular"
    case (outcome_memory); text = "the linear solver ran out of memory"
    case (outcome_interrupted); text = "interrupted"
    case (outcome_not_finite); text = "displacements or forces are not finite"
    case (outcome_stretched); text = "an element was stretched beyond MAX STRETCH"
    case default; text = "unknown outcome"
    end select
  end function outcome_text

end module mpm_newton_report
