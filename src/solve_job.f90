!> The analysis of a job: increments of equilibrium from the first step to the last.
module mpm_solve_job
  use mpm_amplitude, only: time_increment_t
  use mpm_analysis_run, only: analysis_t
  use mpm_clock, only: wall_time
  use mpm_dof_map, only: number_dofs, start_where_nodes_stand, turn_prescribed
  use mpm_equilibrium, only: find_equilibrium, method_for
  use mpm_error, only: error_t, exit_model, exit_no_convergence, exit_solver, make_error
  use mpm_external_force, only: check_applied, external_force, prepare_loads
  use mpm_geostatic_step, only: report_move
  use mpm_ghost_penalty, only: build_ghost
  use mpm_increments, only: accept_step, begin_step, guess_ratio, keep_below_stretch, schedule_t, &
                            start_increment
  use mpm_kinds, only: dp
  use mpm_limit_load, only: begin_watch, watch_increment
  use mpm_limit_note, only: note_limit_load
  use mpm_linear_method, only: library_of
  use mpm_linear_solver, only: choose_library, is_analysed, solver_memory, solver_ok
  use mpm_material_points, only: hand_over, points_t, sort_points
  use mpm_memory, only: give_back_memory
  use mpm_mesh_layout, only: lay_out_mesh
  use mpm_model, only: formulation_fbar, formulation_standard, model_t
  use mpm_model_signature, only: model_signature
  use mpm_newton_report, only: outcome_converged, outcome_interrupted
  use mpm_patches, only: patches_of_single_elements
  use mpm_point_location, only: locate_points, location_report_t, lost_is_error
  use mpm_point_update, only: accept_points
  use mpm_recycled_solver, only: prepare_factors
  use mpm_restart_load, only: restore_point
  use mpm_restart_output, only: restore_output
  use mpm_restart_point, only: keep_point, obey_requests, save_point
  use mpm_restart_state, only: restart_t
  use mpm_run_failure, only: check_count, check_held, memory_error, place_of, record_failure, &
    refuse_mechanism, report_lost_point, shorten
  use mpm_run_log, only: log_message
  use mpm_run_memory, only: check_limit
  use mpm_run_notes, only: note_attempt, note_equilibrium, note_location
  use mpm_run_output, only: run_output_t, write_attempt, write_increment, write_last_state
  use mpm_run_state, only: make_run_state, note_checkerboard, run_state_t, take_nodal_values
  use mpm_sparsity, only: build_pattern, pattern_is_current
  use mpm_surface_points, only: locate_surface_points
  use mpm_system, only: body_t, find_active, free_system, open_system, system_t
  implicit none
  private
  public :: make_body, prepare_increment, solve_job, stop_times

contains

  !> Solves all steps of a model and hands every attempt and every increment to the output.
  subroutine solve_job(output, state, model, restart, only_check, max_memory, error)
    type(run_output_t), intent(inout) :: output        !! open
    type(run_state_t), intent(out)    :: state         !! after the last accepted increment
    type(model_t), intent(inout)      :: model         !! at time zero; its points are handed over
    type(restart_t), intent(inout)    :: restart       !! what run it is, perhaps loaded; emptied
    logical, intent(in)               :: only_check    !! write increment 0, do not solve
    real(dp), intent(in)              :: max_memory    !! allowed [GB], 0 = any
    type(error_t), allocatable, intent(out) :: error   !! no convergence, lost point, file ...
    type(analysis_t) :: analysis
    integer :: i, first

    restart%model_signature = model_signature(model)
    call make_body(analysis%body, model)
    call open_system(analysis%system, analysis%body)
    analysis%max_memory = max_memory
    call begin_run(analysis, output, state, model, restart, error)
    first = max(1, analysis%schedule%step)
    do i = first, size(model%step)
      if (allocated(error) .or. only_check) exit
      if (i > analysis%schedule%step) then
        call start_where_nodes_stand(model%step(i)%constraint, model%frames, state%node_u)
        call begin_step(analysis%schedule, i, model%step(i)%schedule, &
                        stop_times(model, i, analysis%schedule%total_time))
        analysis%u_start = displacements(analysis%body%points, model%step(i)%geostatic)
        call begin_watch(analysis%watch)
      end if
      call solve_step(analysis, output, state, model, error)
    end do
    call free_system(analysis%system)
    if (allocated(error)) then
      call keep_last_state(analysis, output, state, model, error%code)
      analysis%report%at_limit_load = analysis%watch%told
      call record_failure(error, output%paths%failure, analysis%body, analysis%system, &
                          analysis%report, analysis%schedule, model)
    end if
  end subroutine solve_job

  !> The run at time zero, or where its restart file was written.
  subroutine begin_run(analysis, output, state, model, restart, error)
    type(analysis_t), intent(inout)   :: analysis !! body at time zero, system open
    type(run_output_t), intent(inout) :: output   !! open
    type(run_state_t), intent(out)    :: state
    type(model_t), intent(in)         :: model
    type(restart_t), intent(inout)    :: restart  !! perhaps loaded
    type(error_t), allocatable, intent(out) :: error
    type(points_t) :: points
    logical :: loaded

    loaded = restart%is_loaded
    if (loaded) call hand_over(restart%points, points) ! they are large: no copy
    analysis%kept = restart
    if (loaded) call hand_over(points, analysis%kept%points)
    if (allocated(restart%factors%val)) deallocate (restart%factors%val)
    analysis%last_written = wall_time()
    if (loaded) then
      call restore_output(output, restart, model, error)
      if (allocated(error)) return
      call restore_point(analysis, state, model, stops_of_restart(restart, model), error)
      if (allocated(error)) return
      if (analysis%system%recycler%now%needs_double) then
        call log_message(output%log, "factors that are kept are of double precision", error)
        if (allocated(error)) return
      end if
    else
      call make_run_state(state, model%mesh%n_dim, model%mesh%n_node, model%mesh%n_el, &
                          model%patches%n)
      state%started = wall_time()
      analysis%u_start = displacements(analysis%body%points, .false.)
    end if
    call find_active(analysis%system, analysis%body%points)
    if (output%metered .and. .not. loaded) call note_checkerboard(state, analysis%body)
    if (.not. output%is_resumed) then
      call write_increment(output, model, analysis%body%mesh, analysis%body%points, state, error)
    end if
    call keep_point(analysis, output, state)
  end subroutine begin_run

  !> Displacements of the points by their id, none where nobody asks for them.
  pure function displacements(points, wanted) result(u)
    type(points_t), intent(in) :: points
    logical, intent(in) :: wanted
    real(dp), allocatable :: u(:, :) !! (n_dim, n) or (n_dim, 0) [length]

    allocate (u(size(points%u, 1), merge(points%n, 0, wanted)))
    if (wanted) u(:, :) = points%u(:, points%place)
  end function displacements

  !> Step times that increments must hit in the step that a restart goes on in.
  pure function stops_of_restart(restart, model) result(times)
    type(restart_t), intent(in) :: restart
    type(model_t), intent(in) :: model
    real(dp), allocatable :: times(:)

    times = [real(dp) ::]
    if (restart%schedule%step > 0) then
      times = stop_times(model, restart%schedule%step, restart%schedule%total_start)
    end if
  end function stops_of_restart

  !> Before a run ends early: a restart file and the fields of the last accepted increment. The
  !! failure that ends the run is the one to tell; one more while saving is not.
  subroutine keep_last_state(analysis, output, state, model, code)
    type(analysis_t), intent(inout)   :: analysis
    type(run_output_t), intent(inout) :: output
    type(run_state_t), intent(inout)  :: state    !! back at the last accepted increment
    type(model_t), intent(inout)      :: model    !! not changed
    integer, intent(in)               :: code     !! exit code of the failure
    type(error_t), allocatable :: ignored

    state%time = analysis%schedule%total_time
    state%step_time = analysis%schedule%step_time
    ! After other failures the points may have moved on, or nothing can be written.
    if (any(code == [exit_model, exit_no_convergence, exit_solver])) then
      call save_point(analysis, output, model, ignored)
    end if
    if (analysis%is_tentative) call take_nodal_values(state, analysis%kept%state)
    call write_last_state(output, model, analysis%body%mesh, analysis%body%points, state, ignored)
  end subroutine keep_last_state

  !> The increments of one step: the algorithm.
  subroutine solve_step(analysis, output, state, model, error)
    type(analysis_t), intent(inout)   :: analysis !! in the step
    type(run_output_t), intent(inout) :: output
    type(run_state_t), intent(inout)  :: state
    type(model_t), intent(inout)      :: model    !! not changed
    type(error_t), allocatable, intent(out) :: error

    call check_count(analysis%schedule, model, error) ! of a restart
    if (allocated(error)) return
    associate (body => analysis%body, system => analysis%system, schedule => analysis%schedule, &
               report => analysis%report)
      do while (.not. schedule%finished)
        call start_increment(schedule) ! size from the last outcome
        ! Unknowns, pattern, loads.
        call prepare_increment(system, body, model, schedule, analysis%max_memory, error)
        if (allocated(error)) then
          error%message = error%message//place_of(schedule, model)
          return
        end if
        system%guess_ratio = guess_ratio(schedule)
        call find_equilibrium(system, report, body, model%step(schedule%step)%newton, output)
        call refuse_mechanism(report, body, system%u, schedule, model)
        call note_attempt(state, schedule, report, system, body)
        analysis%is_tentative = report%outcome == outcome_converged
        if (analysis%is_tentative) call note_equilibrium(state, system, body, model)
        call write_attempt(output, state, report, error)
        if (allocated(error)) return
        if (report%outcome == outcome_interrupted) then
          call obey_requests(analysis, output, model, error)
          return
        else if (report%outcome /= outcome_converged) then
          call note_limit_load(analysis%watch, output, system, report, schedule, error)
          if (allocated(error)) return
          call check_held(error, body, report, schedule, model)
          if (allocated(error)) return
          call shorten(schedule, report, system, model, error)
          if (allocated(error)) return
          call keep_below_stretch(schedule, report%stretch, &
                                  model%step(schedule%step)%newton%max_stretch)
          cycle
        end if
        call watch_increment(analysis%watch, system, report)
        call note_limit_load(analysis%watch, output, system, report, schedule, error)
        if (allocated(error)) return
        call close_increment(analysis, output, state, model, report%n_iterations, error)
        if (allocated(error)) return
      end do
      call report_move(output%log, model%step(schedule%step), body%points, analysis%u_start, error)
    end associate
  end subroutine solve_step

  !> A converged increment becomes history: points and mesh move, points are located again, the
  !! results are written. Source: theory.md (16), (17).
  subroutine close_increment(analysis, output, state, model, n_iterations, error)
    type(analysis_t), intent(inout)   :: analysis
    type(run_output_t), intent(inout) :: output
    type(run_state_t), intent(inout)  :: state
    type(model_t), intent(inout)      :: model        !! not changed
    integer, intent(in)               :: n_iterations !! of the increment
    type(error_t), allocatable, intent(out) :: error  !! lost point, inverted mesh, file, too many
    type(location_report_t) :: location
    real(dp) :: clock(2)

    associate (body => analysis%body, system => analysis%system, schedule => analysis%schedule)
      ! First, because it may fail: the last increment is then the one before.
      call lay_out_mesh(body, system, model%motion, error)
      if (allocated(error)) then
        error%message = error%message//place_of(schedule, model)
        return
      end if
      call accept_points(body, system)
      analysis%is_tentative = .false.
      system%u_last = system%u
      call accept_step(schedule, n_iterations)
      call keep_below_stretch(schedule, analysis%report%stretch, &
                              model%step(schedule%step)%newton%max_stretch)
      call cpu_time(clock(1))
      call locate_points(body%points, body%mesh, analysis%locator, model%location, location)
      call sort_points(body%points)
      call find_active(system, body%points)
      call locate_surface_points(body%surface, body%mesh, system%active)
      call cpu_time(clock(2))
      state%location_seconds = state%location_seconds + clock(2) - clock(1)
      call note_location(state, schedule, location)
      analysis%report%worst_point = merge(location%first_lost, 0, &
                                          model%location%lost_action == lost_is_error)
      if (output%metered) call note_checkerboard(state, body)
      call write_increment(output, model, body%mesh, body%points, state, error)
      if (allocated(error)) return
      if (location%first_lost > 0 .and. model%location%lost_action == lost_is_error) then
        call report_lost_point(error, body, location, model, schedule)
        return
      end if
      call keep_point(analysis, output, state)
      call check_count(schedule, model, error)
    end associate
    if (.not. allocated(error)) call obey_requests(analysis, output, model, error)
  end subroutine close_increment

  !> The body at time zero; with the standard formulation every element is its own patch. Loads are
  !! prepared while the model still has its points: they become those of the body, without a copy.
  subroutine make_body(body, model)
    type(body_t), intent(out)    :: body
    type(model_t), intent(inout) :: model !! out: of its points only their number is left
    integer :: i

    do i = 1, size(model%step)
      call prepare_loads(model%step(i)%load, model%mesh, model%points)
    end do
    body%mesh = model%mesh
    call hand_over(model%points, body%points)
    call sort_points(body%points)
    body%surface = model%surface
    body%material = model%material
    body%ghost_gamma = model%ghost_gamma
    body%ghost_adapts = model%ghost_adapts
    select case (model%formulation)
    case (formulation_fbar)
      body%patches = model%patches
    case (formulation_standard)
      call patches_of_single_elements(body%patches, model%mesh%n_el)
    end select
  end subroutine make_body

  !> Step times that increments must hit: those of expectations and of timed output.
  pure function stop_times(model, i_step, start) result(times)
    type(model_t), intent(in) :: model
    integer, intent(in)  :: i_step   !! number of the step
    real(dp), intent(in) :: start    !! total time at the start of the step
    real(dp), allocatable :: times(:)
    real(dp) :: interval
    integer :: i

    associate (step => model%step(i_step))
      times = [real(dp) ::]
      if (allocated(step%expectation)) times = step%expectation%time - start
      interval = step%field_output%time_interval
      if (step%has_field_output .and. interval > 0.0_dp) &
        times = [times, (real(i, dp)*interval, i=1, int(step%schedule%period/interval))]
    end associate
  end function stop_times

  !> Active elements, unknowns, external force; pattern and symbolic analysis only when the
  !! active set or the constraints have changed.
  subroutine prepare_increment(system, body, model, schedule, max_memory, error)
    type(system_t), intent(inout) :: system
    type(body_t), intent(in)      :: body
    type(model_t), intent(in)     :: model
    type(schedule_t), intent(in)  :: schedule
    real(dp), intent(in)          :: max_memory !! allowed for the run [GB], 0 = any
    type(error_t), allocatable, intent(out) :: error
    type(time_increment_t) :: increment
    integer :: outcome
    logical :: gives_back

    increment = time_increment_t(schedule%step_time, schedule%size, schedule%settings%period)
    associate (step => model%step(schedule%step))
      call find_active(system, body%points)
      call number_dofs(system%dofs, body%mesh, system%active, step%constraint, increment, &
                       model%amplitude)
      call turn_prescribed(system%dofs, model%frames)
      call external_force(system%f_ext, step%load, body%mesh, body%points, body%surface, &
                          increment, model%amplitude)
      call check_applied(error, system%f_ext, step%load, system%dofs, body%mesh, body%surface)
    end associate
    if (allocated(error)) return
    call build_ghost(system%ghost, ghost_factor(body, schedule), body%mesh, body%points, &
                     body%material, system%active)
    associate (newton => model%step(schedule%step)%newton)
      call choose_library(system%solver, library_of(method_for(newton, system%dofs%n), &
                                                    newton%eigenvalues .or. &
                                                    system%recycler%now%needs_double))
    end associate
    if (is_analysed(system%solver) .and. pattern_is_current(system%map, system%active, &
                                                            system%dofs, system%ghost%node)) then
      ! Another library may have taken over meanwhile.
      if (system%n_judged < system%solver%n_analyses) then
        call check_limit(error, system, model, max_memory)
      end if
      system%n_judged = system%solver%n_analyses
      return
    end if
    call build_pattern(system%tangent, system%map, body%patches, body%mesh, system%dofs, &
                       system%active, system%ghost%node)
    if (.not. allocated(system%map%position)) then
      call memory_error(error, system, "pattern")
      return
    end if
    call prepare_factors(system%recycler, system%solver, system%tangent, outcome)
    gives_back = give_back_memory() ! the analysis needed much, the factors need most of all
    if (outcome == solver_memory) then
      call memory_error(error, system, "analysis")
    else if (outcome /= solver_ok) then
      call make_error(error, exit_solver, "error: the pattern of the tangent cannot be analysed")
    else
      call check_limit(error, system, model, max_memory)
      system%n_judged = system%solver%n_analyses
    end if
  end subroutine prepare_increment

  !> Factor of the ghost penalty in an attempt, raised where the deck leaves it to the run.
  pure real(dp) function ghost_factor(body, schedule) result(gamma)
    type(body_t), intent(in)     :: body
    type(schedule_t), intent(in) :: schedule

    gamma = body%ghost_gamma
    if (body%ghost_adapts) gamma = gamma*schedule%ghost_raise
  end function ghost_factor

end module mpm_solve_job
