!> Everything that a run needs to go on bit for bit, and how it is written into a record file and
!! read back.
module mpm_restart_state
  use mpm_error, only: error_t
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp, ip
  use mpm_limit_load, only: limit_watch_t
  use mpm_material_points, only: points_t, status_inside, status_removed
  use mpm_model, only: model_t
  use mpm_record_file, only: record_t
  use mpm_record_values, only: exchange_integer, exchange_integers, exchange_logical, &
                               exchange_real, exchange_reals, exchange_text, &
                               refuse_value
  use mpm_recycled_solver, only: factor_memory_t
  use mpm_run_state, only: run_state_t
  use mpm_surface_points, only: surface_points_t
  implicit none
  private
  public :: restart_t
  public :: exchange_body, exchange_factors, exchange_run_state, exchange_schedule
  public :: exchange_starts, exchange_watch

  !> A run after an accepted increment.
  type :: restart_t
    type(schedule_t)  :: schedule              !! after the increment
    type(run_state_t) :: state                 !! after the increment
    real(dp), allocatable :: mesh_x(:, :)      !! (n_dim, n_node)  coordinates [length]
    real(dp), allocatable :: u_start(:, :)     !! (n_dim, n)  displacements of the points at the
                                               !!             start of the step [length]
    type(limit_watch_t) :: watch               !! of the loads
    type(factor_memory_t) :: factors           !! that the linear solver has kept
    type(points_t) :: points                   !! converged
    type(surface_points_t) :: surface          !! of the loads with CARRIER=POINTS
    character(:), allocatable :: written_by    !! version and revision of the program
    character(:), allocatable :: formulation   !! standard or fbar
    character(:), allocatable :: deck_signature  !! see mpm_deck_signature
    character(:), allocatable :: model_signature !! see mpm_model_signature
    character(:), allocatable :: output_mark   !! where its result files stand, see mpm_output_mark
    character(:), allocatable :: verdicts      !! expectations that were decided, a line each
    real(dp) :: seconds(5) = 0.0_dp            !! CPU by kind of work, for the log [s]
    integer  :: n_attempts = 0                 !! increments tried
    integer  :: n_iterations = 0               !! corrections of Newton's method
    logical  :: is_loaded = .false.            !! .true.: read from a file, to go on from
  end type restart_t

contains

  !> The schedule; settings and stops come from the deck.
  subroutine exchange_schedule(record, schedule, error)
    type(record_t), intent(in) :: record               !! open
    type(schedule_t), intent(inout) :: schedule        !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_integer(record, "schedule_step", schedule%step, error)
    call exchange_integer(record, "schedule_increment", schedule%increment, error)
    call exchange_integer(record, "schedule_increment_total", schedule%increment_total, error)
    call exchange_integer(record, "schedule_attempt", schedule%attempt, error)
    call exchange_real(record, "schedule_step_time", schedule%step_time, error)
    call exchange_real(record, "schedule_total_time", schedule%total_time, error)
    call exchange_real(record, "schedule_total_start", schedule%total_start, error)
    call exchange_real(record, "schedule_size", schedule%size, error)
    call exchange_real(record, "schedule_planned", schedule%planned, error)
    call exchange_integer(record, "schedule_n_cuts", schedule%n_cuts, error)
    call exchange_real(record, "schedule_last_size", schedule%last_size, error)
    call exchange_real(record, "schedule_ghost_raise", schedule%ghost_raise, error)
    call exchange_logical(record, "schedule_finished", schedule%finished, error)
  end subroutine exchange_schedule

  !> What is known about the loads of the step.
  subroutine exchange_watch(record, watch, error)
    type(record_t), intent(in) :: record               !! open
    type(limit_watch_t), intent(inout) :: watch        !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_real(record, "watch_flexibility", watch%flexibility, error)
    call exchange_real(record, "watch_softness", watch%softness, error)
    call exchange_real(record, "watch_load", watch%load, error)
    call exchange_logical(record, "watch_told", watch%told, error)
  end subroutine exchange_watch

  !> Factors that the linear solver keeps: the matrix from which they are made again.
  subroutine exchange_factors(record, factors, error)
    type(record_t), intent(in) :: record               !! open
    type(factor_memory_t), intent(inout) :: factors    !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(:), allocatable :: pattern

    call exchange_logical(record, "factors_are_there", factors%is_there, error)
    call exchange_logical(record, "factors_need_double", factors%needs_double, error)
    if (allocated(error) .or. .not. factors%is_there) return
    pattern = factors%pattern
    call exchange_text(record, "factors_pattern", pattern, error)
    call exchange_integer(record, "factors_n", factors%n, error)
    call exchange_integer(record, "factors_nnz", factors%nnz, error)
    call exchange_real(record, "factors_work", factors%work, error)
    call exchange_real(record, "factors_digits", factors%digits, error)
    call exchange_real(record, "factors_rate", factors%rate, error)
    if (allocated(error)) return
    if (.not. record%writing) then
      factors%pattern = pattern
      if (factors%n < 1 .or. factors%nnz < 1 .or. 8_ip*factors%nnz > record%n_bytes) then
        call refuse_value(record, "factors_nnz", "the size of a matrix", error)
        return
      end if
      allocate (factors%val(factors%nnz), source=0.0_dp)
    end if
    call exchange_reals(record, "factors_val", [factors%nnz], factors%val, error)
  end subroutine exchange_factors

  !> What the writers are told. The arrays have the sizes of the model.
  subroutine exchange_run_state(record, state, error)
    type(record_t), intent(in) :: record               !! open
    type(run_state_t), intent(inout) :: state          !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    logical :: has_index

    call exchange_integer(record, "state_step", state%step, error)
    call exchange_integer(record, "state_increment", state%increment, error)
    call exchange_integer(record, "state_increment_total", state%increment_total, error)
    call exchange_integer(record, "state_attempt", state%attempt, error)
    call exchange_real(record, "state_time", state%time, error)
    call exchange_real(record, "state_step_time", state%step_time, error)
    call exchange_real(record, "state_size", state%size, error)
    call exchange_integer(record, "state_n_iterations", state%n_iterations, error)
    call exchange_real(record, "state_residual", state%residual, error)
    call exchange_real(record, "state_wall_seconds", state%wall_seconds, error)
    call exchange_integer(record, "state_n_active_elements", state%n_active_elements, error)
    call exchange_integer(record, "state_n_cuts", state%n_cuts, error)
    call exchange_integer(record, "state_n_lost", state%n_lost, error)
    call exchange_integer(record, "state_n_extrapolated", state%n_extrapolated, error)
    call exchange_integer(record, "state_n_unknowns", state%n_unknowns, error)
    call exchange_integer(record, "state_n_nonzeros", state%n_nonzeros, error)
    call exchange_integer(record, "state_n_constraints", state%n_constraints, error)
    call exchange_integer(record, "state_n_checked", state%n_checked, error)
    has_index = allocated(state%checkerboard)
    call exchange_logical(record, "state_has_checkerboard", has_index, error)
    if (has_index .and. .not. allocated(state%checkerboard)) then
      allocate (state%checkerboard, source=0.0_dp)
    end if
    if (has_index) call exchange_real(record, "state_checkerboard", state%checkerboard, error)
    call exchange_integer(record, "state_n_ghost_pairs", state%n_ghost_pairs, error)
    call exchange_reals(record, "state_eigenvalue", [2], state%eigenvalue, error)
    call exchange_real(record, "state_ghost_share_now", state%ghost_share_now, error)
    call exchange_real(record, "state_ghost_share", state%ghost_share, error)
    call exchange_real(record, "state_ghost_raise", state%ghost_raise, error)
    call exchange_real(record, "state_balance_now", state%balance_now, error)
    call exchange_real(record, "state_balance", state%balance, error)
    call exchange_reals(record, "reaction", shape(state%reaction), state%reaction, error)
    call exchange_reals(record, "applied", shape(state%applied), state%applied, error)
    call exchange_reals(record, "delta_u", shape(state%delta_u), state%delta_u, error)
    call exchange_reals(record, "node_u", shape(state%node_u), state%node_u, error)
    call exchange_reals(record, "delta_j", shape(state%delta_j), state%delta_j, error)
    call exchange_reals(record, "delta_j_patch", shape(state%delta_j_patch), &
                        state%delta_j_patch, error)
  end subroutine exchange_run_state

  !> Mesh and points: what changes in a run. The arrays have the sizes of the model.
  subroutine exchange_body(record, restart, n_el, error)
    type(record_t), intent(in) :: record               !! open
    type(restart_t), intent(inout) :: restart          !! written, or read
    integer, intent(in) :: n_el                        !! elements of the mesh
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_reals(record, "mesh_x", shape(restart%mesh_x), restart%mesh_x, error)
    if (size(restart%u_start) > 0) then
      call exchange_reals(record, "u_start", shape(restart%u_start), restart%u_start, error)
    end if
    call exchange_points(record, restart%points, n_el, error)
    if (restart%surface%n == 0 .or. allocated(error)) return
    associate (surface => restart%surface)
      call exchange_reals(record, "surface_x", shape(surface%x), surface%x, error)
      call exchange_reals(record, "surface_shape", shape(surface%shape), surface%shape, error)
      call exchange_integers(record, "surface_element", shape(surface%element), surface%element, &
                             error)
      if (allocated(error)) return
      if (any(surface%element < 0 .or. surface%element > n_el)) then
        call refuse_value(record, "surface_element", "elements of the mesh", error)
      end if
    end associate
  end subroutine exchange_body

  !> The material points.
  subroutine exchange_points(record, points, n_el, error)
    type(record_t), intent(in) :: record               !! open
    type(points_t), intent(inout) :: points            !! written, or read
    integer, intent(in) :: n_el                        !! elements of the mesh
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call exchange_order(record, points, error)
    if (allocated(error)) return
    call exchange_reals(record, "point_x", shape(points%x), points%x, error)
    call exchange_reals(record, "point_u", shape(points%u), points%u, error)
    call exchange_integers(record, "point_element", shape(points%element), points%element, error)
    call exchange_integers(record, "point_status", shape(points%status), points%status, error)
    call exchange_reals(record, "point_shape", shape(points%shape), points%shape, error)
    call exchange_reals(record, "point_volume", shape(points%volume), points%volume, error)
    call exchange_reals(record, "point_def_grad", shape(points%def_grad), points%def_grad, error)
    associate (state => points%state)
      call exchange_reals(record, "point_strain_e", shape(state%strain_e), state%strain_e, error)
      call exchange_reals(record, "point_left_cauchy_green_e_m1", &
                          shape(state%left_cauchy_green_e_m1), state%left_cauchy_green_e_m1, error)
      call exchange_reals(record, "point_hardening", shape(state%hardening), state%hardening, error)
      call exchange_reals(record, "point_cauchy", shape(state%cauchy), state%cauchy, error)
      call exchange_reals(record, "point_jacobian_bar", shape(state%jacobian_bar), &
                          state%jacobian_bar, error)
    end associate
    if (allocated(error) .or. record%writing) return
    if (any(points%element < 0 .or. points%element > n_el)) then
      call refuse_value(record, "point_element", "elements of the mesh", error)
    else if (any(points%status < status_inside .or. points%status > status_removed)) then
      call refuse_value(record, "point_status", "the number of a status", error)
    else if (any(points%volume <= 0.0_dp) .or. any(points%state%jacobian_bar <= 0.0_dp)) then
      call refuse_value(record, "point_volume", "volumes above 0", error)
    end if
  end subroutine exchange_points

  !> Where the points stand: those read follow the points written, with what never changes.
  subroutine exchange_order(record, points, error)
    type(record_t), intent(in) :: record               !! open
    type(points_t), intent(inout) :: points            !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer, allocatable :: id(:)
    logical, allocatable :: there(:)
    integer :: p

    id = points%id
    call exchange_integers(record, "point_id", shape(id), id, error)
    if (allocated(error) .or. record%writing) return
    allocate (there(points%n), source=.false.)
    do p = 1, points%n
      if (id(p) >= 1 .and. id(p) <= points%n) there(id(p)) = .true.
    end do
    if (.not. all(there)) then
      call refuse_value(record, "point_id", "every number up to that of points", error)
      return
    end if
    ! The points of the model stand in the order of their ids.
    points%id = id
    points%place(id) = [(p, p=1, points%n)]
    points%material = points%material(id)
    points%mass = points%mass(id)
    points%volume_0 = points%volume_0(id)
  end subroutine exchange_order

  !> Where the nodes of constraints stood that were free before the step.
  subroutine exchange_starts(record, model, i_step, error)
    type(record_t), intent(in) :: record               !! open
    type(model_t), intent(inout) :: model              !! constraints of the step get their starts
    integer, intent(in) :: i_step                      !! number of the step, 0: none has begun
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(12) :: number
    integer :: i

    if (allocated(error) .or. i_step == 0) return
    do i = 1, size(model%step(i_step)%constraint)
      associate (constraint => model%step(i_step)%constraint(i))
        if (.not. constraint%was_free) cycle
        if (.not. allocated(constraint%from)) then
          allocate (constraint%from(size(constraint%node)), source=0.0_dp)
        end if
        write (number, "(i0)") i
        call exchange_reals(record, "start_of_constraint_"//trim(number), &
                            shape(constraint%from), constraint%from, error)
      end associate
    end do
  end subroutine exchange_starts

end module mpm_restart_state
