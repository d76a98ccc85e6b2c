!> --estimate: what a job will need, told before anything is solved or written.
module mpm_estimate_job
  use mpm_assembly, only: assemble_tangent
  use mpm_error, only: error_t
  use mpm_factor_estimate, only: factor_seconds, measure_flop_rate
  use mpm_increments, only: accept_step, begin_step, schedule_t, start_increment
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: is_exact
  use mpm_material_points, only: hand_over, unsort_points
  use mpm_model, only: model_t
  use mpm_results_file, only: is_field_output_due
  use mpm_results_size, only: bytes_of_output, bytes_once
  use mpm_run_estimate, only: run_estimate_t
  use mpm_run_memory, only: check_limit, keeps_factors, memory_of_run
  use mpm_run_state, only: run_state_t
  use mpm_solve_job, only: make_body, prepare_increment, stop_times
  use mpm_system, only: body_t, evaluate, evaluation_ok, free_system, open_system, system_t
  use omp_lib, only: omp_get_max_threads, omp_set_num_threads
  implicit none
  private
  public :: estimate_job

  integer, parameter  :: easy = 5              !! iterations of an increment that is not to shrink
  real(dp), parameter :: evaluations = 2.0_dp  !! in an iteration, with those at the start of the
                                               !! increment and those of halved corrections

contains

  !> Builds the equations of the first increment and analyses them.
  subroutine estimate_job(estimate, model, max_memory, measured, error)
    type(run_estimate_t), intent(out) :: estimate    !! complete if there is no error but the limit
    type(model_t), intent(inout) :: model            !! its conditions are prepared
    real(dp), intent(in) :: max_memory               !! allowed [GB], 0 = any
    logical, intent(in)  :: measured                 !! also times, which takes some seconds
    type(error_t), allocatable, intent(out) :: error !! what is wrong with the first increment, or
                                                     !! more memory than is allowed
    type(body_t)     :: body
    type(system_t)   :: system
    type(schedule_t) :: schedule

    call make_body(body, model)
    call open_system(system, body)
    call begin_step(schedule, 1, model%step(1)%schedule, [real(dp) ::])
    call start_increment(schedule)
    call prepare_increment(system, body, model, schedule, 0.0_dp, error)
    if (.not. allocated(error)) then
      call note_sizes(estimate, system, body, model)
      if (measured) call note_seconds(estimate, system, body)
      call note_results(estimate, model)
      call check_limit(error, system, model, max_memory)
    end if
    call free_system(system)
    call unsort_points(body%points, body%mesh%n_el)
    call hand_over(body%points, model%points)
  end subroutine estimate_job

  !> Counts and memory.
  subroutine note_sizes(estimate, system, body, model)
    type(run_estimate_t), intent(inout) :: estimate
    type(system_t), intent(in) :: system !! analysed
    type(body_t), intent(in)   :: body
    type(model_t), intent(in)  :: model

    estimate%job = model%job
    estimate%n_elements = body%mesh%n_el
    estimate%n_active = size(system%element)
    estimate%n_points = body%points%n
    estimate%n_patches = body%patches%n
    estimate%n_unknowns = system%dofs%n
    estimate%n_nonzeros = system%tangent%nnz
    estimate%memory = memory_of_run(system, model)
    estimate%keeps_factors = keeps_factors(system, model)
  end subroutine note_sizes

  !> Times one evaluation with its tangent, and dense products, on one thread: threads that wait for
  !! each other count as busy.
  subroutine note_seconds(estimate, system, body)
    type(run_estimate_t), intent(inout) :: estimate
    type(system_t), intent(inout) :: system !! analysed; evaluated
    type(body_t), intent(in) :: body
    real(dp) :: clock(3), rate
    integer  :: n_threads, outcome

    n_threads = omp_get_max_threads()
    call omp_set_num_threads(1)
    system%u = sheared(body)
    call evaluate(system, body, outcome) ! memory is touched for the first time
    if (outcome /= evaluation_ok) system%u = 0.0_dp
    call cpu_time(clock(1))
    call evaluate(system, body, outcome)
    call cpu_time(clock(2))
    if (outcome == evaluation_ok) then
      call assemble_tangent(system%tangent, system%map, body%mesh, body%patches, &
                            system%kinematics, system%sums)
    end if
    call cpu_time(clock(3))
    call omp_set_num_threads(n_threads)
    estimate%point_seconds = evaluations*(clock(2) - clock(1)) + clock(3) - clock(2)
    call measure_flop_rate(rate)
    estimate%factor_seconds = factor_seconds(estimate%memory%factors%flops, rate, &
                                             is_exact(system%solver))
  end subroutine note_seconds

  !> A shear of all the body, at which most materials flow.
  pure function sheared(body) result(u)
    type(body_t), intent(in) :: body
    real(dp), allocatable :: u(:, :)          !! (n_dim, n_node) [length]
    real(dp), parameter   :: angle = 0.02_dp  !! [-]

    allocate (u, source=0.0_dp*body%mesh%x)
    u(1, :) = angle*(body%mesh%x(2, :) - minval(body%mesh%x(2, :)))
  end function sheared

  !> Goes through the schedule as if every increment converged; counts are only told where the
  !! deck fixes the increments.
  subroutine note_results(estimate, model)
    type(run_estimate_t), intent(inout) :: estimate
    type(model_t), intent(in) :: model
    type(schedule_t)  :: schedule
    type(run_state_t) :: state
    integer :: i

    estimate%output_bytes = bytes_of_output(model)
    estimate%once_bytes = bytes_once(model)
    if (.not. all(model%step%schedule%direct)) return
    estimate%n_outputs = 1 ! increment 0
    do i = 1, size(model%step)
      call begin_step(schedule, i, model%step(i)%schedule, &
                      stop_times(model, i, schedule%total_time))
      do while (.not. schedule%finished)
        call start_increment(schedule)
        state%increment = schedule%increment
        call accept_step(schedule, easy)
        state%step_time = schedule%step_time
        if (is_field_output_due(model%step(i), state)) estimate%n_outputs = estimate%n_outputs + 1
        if (schedule%increment >= schedule%settings%max_increments) exit
      end do
    end do
    estimate%n_increments = schedule%increment_total
  end subroutine note_results

end module mpm_estimate_job
