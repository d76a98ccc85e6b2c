!> JOB.sta: one line per attempted increment.
module mpm_status_file
  use mpm_driver_check, only: is_driver_prescribed
  use mpm_error, only: error_t
  use mpm_kinds, only: dp
  use mpm_model, only: model_t
  use mpm_nodal_frames, only: in_local_axes, nodal_frames_t
  use mpm_output_mark, only: text_mark_t
  use mpm_run_state, only: end_of_run, estimated_time_left, run_state_t
  use mpm_text_file, only: open_text_file, resume_text_file, text_file_t, write_counted_line
  implicit none
  private
  public :: status_file_t, driver_reaction, open_status, resume_status, write_status

  !> The open file, and the reaction that it follows.
  type :: status_file_t
    type(text_file_t) :: file
    integer, allocatable :: driver(:)      !! nodes of the driver set, perhaps none
    real(dp) :: direction(3) = 0.0_dp      !! unit vector of their reaction, along their axes
    type(nodal_frames_t) :: frames         !! axes of the nodes
    real(dp) :: end_time = 0.0_dp          !! total time at the end of the run
  end type status_file_t

contains

  !> Opens the file and writes the names of its columns.
  subroutine open_status(status, path, model, error)
    type(status_file_t), intent(out) :: status       !! open
    character(*), intent(in) :: path                 !! file
    type(model_t), intent(in) :: model               !! driver, periods
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(*), parameter :: head = "# step  inc  att iter        time         size" &
      //"      reaction     residual  active    lost    wall s    left s  outcome"

    status%end_time = end_of_run(model)
    call find_driver(status, model)
    call open_text_file(status%file, path, error)
    if (.not. allocated(error)) call write_counted_line(status%file, head, error)
  end subroutine open_status

  !> Opens the file of an interrupted run behind a mark.
  subroutine resume_status(status, path, model, mark, error)
    type(status_file_t), intent(out) :: status       !! open
    character(*), intent(in) :: path                 !! file that was checked
    type(model_t), intent(in) :: model               !! driver, periods
    type(text_mark_t), intent(in) :: mark            !! where it stood
    type(error_t), allocatable, intent(out) :: error !! exit_file

    status%end_time = end_of_run(model)
    call find_driver(status, model)
    call resume_text_file(status%file, path, mark, error)
  end subroutine resume_status

  !> The driver is that of the moving mesh where a step prescribes it, else the set of the first
  !! displacement that is not 0: a plane that the mesh only follows has no reaction.
  pure subroutine find_driver(status, model)
    type(status_file_t), intent(inout) :: status !! its driver and direction are set
    type(model_t), intent(in) :: model           !! moving mesh and prescribed displacements
    integer :: i, j

    if (pushes(model)) then
      status%driver = model%motion%driver
      status%direction = model%motion%direction
      return
    end if
    status%frames = model%frames
    do i = 1, size(model%step)
      if (.not. allocated(model%step(i)%constraint)) cycle
      do j = 1, size(model%step(i)%constraint)
        associate (constraint => model%step(i)%constraint(j))
          if (abs(constraint%value) <= 0.0_dp) cycle
          status%driver = constraint%node
          status%direction(constraint%direction) = 1.0_dp
          return
        end associate
      end do
    end do
    allocate (status%driver(0))
  end subroutine find_driver

  !> Whether the mesh has a driver that pushes the body in some step.
  pure logical function pushes(model) result(found)
    type(model_t), intent(in) :: model !! moving mesh and prescribed displacements
    integer :: i

    found = .false.
    if (.not. model%motion%active .or. model%motion%with_body) return
    do i = 1, size(model%step)
      found = found .or. is_driver_prescribed(model, i)
    end do
  end function pushes

  !> Reaction of the driver set in its direction.
  pure function driver_reaction(status, state) result(reaction)
    type(status_file_t), intent(in) :: status !! driver set
    type(run_state_t), intent(in) :: state    !! reactions
    real(dp) :: reaction
    real(dp) :: total(size(state%reaction, 1))
    integer :: i

    total = 0.0_dp
    do i = 1, size(status%driver)
      total = total + in_local_axes(status%frames, status%driver(i), &
                                    state%reaction(:, status%driver(i)))
    end do
    reaction = dot_product(status%direction(:size(total)), total)
  end function driver_reaction

  !> Writes the line of an attempt.
  subroutine write_status(status, state, outcome, error)
    type(status_file_t), intent(inout) :: status     !! open
    type(run_state_t), intent(in) :: state           !! after the attempt
    character(*), intent(in) :: outcome              !! in words
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(160) :: line

    write (line, "(i6,2i5,i4,2es13.5,es14.6,es13.4,2i8,2f10.1)") state%step, state%increment, &
      state%attempt, state%n_iterations, state%time, state%size, driver_reaction(status, state), &
      state%residual, state%n_active_elements, state%n_lost, state%wall_seconds, &
      estimated_time_left(state, status%end_time)
    call write_counted_line(status%file, trim(line)//"  "//outcome, error)
  end subroutine write_status

end module mpm_status_file
