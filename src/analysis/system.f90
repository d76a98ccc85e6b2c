!> Everything that one increment needs beside the model: unknowns, kinematics, sums, tangent.
module mpm_system
  use mpm_assembly, only: internal_force
  use mpm_constitutive_update, only: allocate_sums, element_sums_t, update_points
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_dof_map, only: dof_map_t
  use mpm_fbar, only: project_onto_patches
  use mpm_ghost_penalty, only: add_ghost_force, ghost_penalty_t, open_ghost
  use mpm_kinds, only: dp, ip
  use mpm_kinematics, only: allocate_kinematics, compute_kinematics, kinematics_t
  use mpm_linear_solver, only: free_solver, linear_solver_t
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_patches, only: patches_t
  use mpm_recycled_solver, only: recycler_t
  use mpm_sparsity, only: assembly_map_t
  use mpm_surface_points, only: surface_points_t
  implicit none
  private
  public :: system_t, body_t, evaluate, evaluate_force, find_active, free_system, open_system
  public :: evaluation_ok, evaluation_inverted, evaluation_failed

  integer, parameter :: evaluation_ok = 0       !! forces are there
  integer, parameter :: evaluation_inverted = 1 !! an active element is inside out
  integer, parameter :: evaluation_failed = 2   !! the state update of a point failed

  !> The body and its background: what the increments change.
  type :: body_t
    type(mesh_t)    :: mesh                     !! at the start of the increment
    type(patches_t) :: patches                  !! over which F-bar averages; single elements: standard method
    type(points_t)  :: points                   !! converged
    type(surface_points_t) :: surface           !! carry tractions with the body
    type(material_t), allocatable :: material(:)
    real(dp) :: ghost_gamma = 0.0_dp            !! factor of the ghost penalty [-], 0 = none
    logical  :: ghost_adapts = .false.          !! the run may raise it after failed attempts
  end type body_t

  !> Work space of an increment. It holds foreign handles: release it with `free_system`.
  type :: system_t
    logical, allocatable  :: active(:)      !! (n_el)           hosts a point
    integer, allocatable  :: element(:)     !! (n_active)       active elements, ascending
    real(dp), allocatable :: u(:, :)        !! (n_dim, n_node)  displacement of the increment [length]
    real(dp), allocatable :: u_last(:, :)   !! (n_dim, n_node)  that of the last accepted increment; a restart needs it [length]
    real(dp) :: guess_ratio = 0.0_dp        !! size of this increment over that of the last one, 0: start at rest
    real(dp), allocatable :: f_int(:, :)    !! (n_dim, n_node)  internal force and penalty [force]
    real(dp), allocatable :: f_ext(:, :)    !! (n_dim, n_node)  applied force [force]
    type(dof_map_t)       :: dofs
    type(kinematics_t)    :: kinematics
    type(element_sums_t)  :: sums
    type(ghost_penalty_t) :: ghost          !! faces of this active set
    type(assembly_map_t)  :: map
    type(csc_matrix_t)    :: tangent
    type(linear_solver_t) :: solver
    type(recycler_t)      :: recycler       !! its factors over corrections and increments
    integer :: n_judged = 0                 !! analyses of the solver whose memory was judged
    integer :: worst_element = 0            !! inverted element or element of the failed point
    integer :: worst_point = 0              !! failed point
    real(dp) :: seconds(2) = 0.0_dp         !! CPU of all evaluations: kinematics, stress with internal force [s]
    real(dp) :: point_loop_seconds = 0.0_dp !! wall time of all stress updates [s]
  end type system_t

contains

  !> Allocates the work space.
  subroutine open_system(system, body)
    type(system_t), intent(out) :: system
    type(body_t), intent(in)    :: body

    allocate (system%active(body%mesh%n_el), source=.false.)
    allocate (system%element(0))
    allocate (system%u(body%mesh%n_dim, body%mesh%n_node), source=0.0_dp)
    allocate (system%u_last, source=system%u)
    allocate (system%f_int, source=system%u)
    allocate (system%f_ext, source=system%u)
    call allocate_kinematics(system%kinematics, body%mesh)
    call allocate_sums(system%sums, body%mesh%n_el)
    call open_ghost(system%ghost, body%mesh%n_dim)
  end subroutine open_system

  !> Releases the factors of the linear solver and the tangent: what is large.
  subroutine free_system(system)
    type(system_t), intent(inout) :: system

    call free_solver(system%solver)
    system%tangent = csc_matrix_t()
    system%map = assembly_map_t()
  end subroutine free_system

  !> Active elements are those that host a point. Precondition: points are grouped by element.
  pure subroutine find_active(system, points)
    type(system_t), intent(inout) :: system
    type(points_t), intent(in)    :: points
    integer :: e

    system%active = points%first(2:) > points%first(:size(points%first) - 1)
    system%element = pack([(e, e=1, size(system%active))], system%active)
  end subroutine find_active

  !> Element sums and internal force at the displacement system%u: what a tangent
  !! needs.
  subroutine evaluate(system, body, outcome)
    type(system_t), intent(inout) :: system
    type(body_t), intent(in)      :: body
    integer, intent(out)          :: outcome !! evaluation_*

    call evaluate_sums(system, body, .true., outcome)
  end subroutine evaluate

  !> The same without moduli: for a step of which only the residual is asked.
  subroutine evaluate_force(system, body, outcome)
    type(system_t), intent(inout) :: system
    type(body_t), intent(in)      :: body
    integer, intent(out)          :: outcome !! evaluation_*

    call evaluate_sums(system, body, .false., outcome)
  end subroutine evaluate_force

  !> Kinematics, stresses, sums and internal force.
  subroutine evaluate_sums(system, body, with_moduli, outcome)
    type(system_t), intent(inout) :: system
    type(body_t), intent(in)      :: body
    logical, intent(in)           :: with_moduli
    integer, intent(out)          :: outcome !! evaluation_*
    real(dp) :: clock(3)
    integer(ip) :: ticks(2), rate

    outcome = evaluation_ok
    call cpu_time(clock(1))
    call compute_kinematics(system%kinematics, system%worst_element, body%mesh, system%element, system%u)
    if (system%worst_element > 0) then
      outcome = evaluation_inverted
      return
    end if
    call project_onto_patches(system%kinematics, body%mesh, body%patches, system%active)
    call cpu_time(clock(2))
    call system_clock(ticks(1))
    call update_points(system%sums, body%points, body%material, system%kinematics, &
                       system%element, with_moduli)
    call system_clock(ticks(2), rate)
    system%point_loop_seconds = system%point_loop_seconds &
                                + real(ticks(2) - ticks(1), dp)/real(rate, dp)
    system%worst_point = system%sums%failed_point
    if (system%worst_point > 0) then
      outcome = evaluation_failed
      system%worst_element = body%points%element(system%worst_point)
      return
    end if
    call internal_force(system%f_int, body%mesh, system%kinematics, system%sums, system%element)
    call add_ghost_force(system%f_int, system%ghost, system%u)
    call cpu_time(clock(3))
    system%seconds = system%seconds + (clock(2:3) - clock(1:2))
  end subroutine evaluate_sums

end module mpm_system
