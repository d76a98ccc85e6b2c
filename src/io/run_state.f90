!> What every writer is told: about the run as a whole, and after each increment.
module mpm_run_state
  use, intrinsic :: iso_c_binding, only: c_int
  use mpm_build_info, only: build_compiler => compiler, build_version => version, compiler_flags, &
                            git_revision
  use mpm_force_balance, only: force_imbalance, smallest_force
  use mpm_kinds, only: dp
  use mpm_library_text, only: library_text
  use mpm_locking_meter, only: measure_checkerboard, n_active_patches
  use mpm_model, only: model_t
  use mpm_patches, only: patches_t
  use mpm_publication, only: default_interval
  use mpm_system, only: body_t, system_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: run_info_t, run_state_t
  public :: end_of_run, estimated_time_left, make_run_info, make_run_state, note_balance
  public :: note_checkerboard, note_constraints, take_nodal_values

  !> What stays the same during a run and is no part of the model, or its name in the results.
  type :: run_info_t
    character(:), allocatable :: deck_name !! file name of the deck
    character(:), allocatable :: deck_text !! full text of the deck with its includes
    character(:), allocatable :: warnings  !! about the deck, empty if there is none
    character(:), allocatable :: formulation !! standard or fbar
    character(:), allocatable :: version   !! of the program
    character(:), allocatable :: git       !! revision of the source
    character(:), allocatable :: compiler  !! name and version of the compiler
    character(:), allocatable :: libraries !! names and versions of the libraries
    character(:), allocatable :: started   !! date and time of the start, ISO 8601
    character(:), allocatable :: run_id    !! no other run has it
    integer :: n_threads = 1               !! OpenMP threads
    logical :: quiet = .false.             !! .true.: no progress on the terminal
    logical :: verbose = .false.           !! .true.: every Newton iteration on the terminal
    real(dp) :: publish_interval = default_interval !! least time between publications [s]
  end type run_info_t

  !> Where a run stands after an attempt at an increment. The fields of an attempt that failed
  !! are those of the last accepted increment.
  type :: run_state_t
    integer  :: step = 0                !! number of the step, 0 before the first
    integer  :: increment = 0           !! number of the increment in the step
    integer  :: increment_total = 0     !! accepted increments in the run
    integer  :: attempt = 0             !! attempt at this increment, from 1
    real(dp) :: time = 0.0_dp           !! total time at the end of the increment
    real(dp) :: step_time = 0.0_dp      !! step time at the end of the increment
    real(dp) :: size = 0.0_dp           !! size of the increment in time
    integer  :: n_iterations = 0        !! corrections of Newton's method
    real(dp) :: residual = 0.0_dp       !! last relative residual [-]
    real(dp) :: started = 0.0_dp        !! reading of the system's clock at the start [s]
    real(dp) :: wall_seconds = 0.0_dp   !! since the start of the run [s]
    integer  :: n_active_elements = 0   !! elements that host a point
    integer  :: n_lost = 0              !! points lost so far
    integer  :: n_extrapolated = 0      !! points just outside the mesh
    integer  :: n_unknowns = 0          !! free displacements of the increment
    integer  :: n_nonzeros = 0          !! entries of its tangent
    integer  :: n_constraints = 0       !! its volumetric constraints
    integer  :: n_checked = 0           !! elements in the checkerboard index
    real(dp), allocatable :: checkerboard     !! index of the pressure [-]; unallocated: not asked
    integer  :: n_ghost_pairs = -1      !! pairs of elements of the ghost penalty, -1 without one
    real(dp) :: ghost_raise = 1.0_dp    !! factor on the ghost penalty in the increment [-]
    integer  :: n_cuts = 0              !! attempts of the run so far that failed
    real(dp) :: eigenvalue(2) = 0.0_dp  !! smallest and largest of the tangent, 0 if not asked for
    real(dp) :: ghost_share_now = 0.0_dp !! part of the load that the ghost penalty carries [-]
    real(dp) :: ghost_share = 0.0_dp    !! largest one of the run so far [-]
    real(dp) :: balance_now = 0.0_dp    !! forces that do not balance, part of all of them [-]
    real(dp) :: balance = 0.0_dp        !! largest one of the run so far [-]
    ! What belongs to the machine and not to the run; a restart file does not hold it.
    real(dp) :: factor_memory = 0.0_dp  !! most that a factorisation took so far [bytes]
    real(dp) :: location_seconds = 0.0_dp !! CPU of locating points so far [s]
    real(dp) :: point_loop_seconds = 0.0_dp !! wall time of stress updates so far [s]
    real(dp), allocatable :: reaction(:, :)   !! (n_dim, n_node)  internal minus applied force where
                                              !!                  prescribed, 0 elsewhere [force]
    real(dp), allocatable :: applied(:, :)    !! (n_dim, n_node)  external nodal forces [force]
    real(dp), allocatable :: delta_u(:, :)    !! (n_dim, n_node)  of the increment [length]
    real(dp), allocatable :: node_u(:, :)     !! (n_dim, n_node)  sum of the increments [length]
    real(dp), allocatable :: delta_j(:)       !! (n_el)           det Delta F of the increment [-]
    real(dp), allocatable :: delta_j_patch(:) !! (n_patch)        patch mean of delta_j [-]
  end type run_state_t

  interface
    !> Number of this process.
    function c_process() bind(c, name="getpid") result(number)
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function c_process
  end interface

contains

  !> State at time zero: no force, no displacement, no change of volume.
  pure subroutine make_run_state(state, n_dim, n_node, n_el, n_patch)
    type(run_state_t), intent(out) :: state !! at time zero
    integer, intent(in) :: n_dim            !! 2 or 3
    integer, intent(in) :: n_node           !! nodes of the mesh
    integer, intent(in) :: n_el             !! elements of the mesh
    integer, intent(in) :: n_patch          !! patches

    allocate (state%reaction(n_dim, n_node), source=0.0_dp)
    allocate (state%applied(n_dim, n_node), source=0.0_dp)
    allocate (state%delta_u(n_dim, n_node), source=0.0_dp)
    allocate (state%node_u(n_dim, n_node), source=0.0_dp)
    allocate (state%delta_j(n_el), source=1.0_dp)
    allocate (state%delta_j_patch(n_patch), source=1.0_dp)
  end subroutine make_run_state

  !> Takes back nodal values and changes of volume to those of another state.
  pure subroutine take_nodal_values(state, other)
    type(run_state_t), intent(inout) :: state !! keeps everything else
    type(run_state_t), intent(in) :: other    !! of the same mesh

    state%reaction = other%reaction
    state%applied = other%applied
    state%delta_u = other%delta_u
    state%node_u = other%node_u
    state%delta_j = other%delta_j
    state%delta_j_patch = other%delta_j_patch
  end subroutine take_nodal_values

  !> Unknowns, entries of the tangent and volumetric constraints of an increment. Source: theory.md (22).
  pure subroutine note_constraints(state, patches, system)
    type(run_state_t), intent(inout) :: state !! takes the counts
    type(patches_t), intent(in) :: patches    !! those of the formulation
    type(system_t), intent(in)  :: system     !! solved; its active set is that of the increment

    state%n_unknowns = system%dofs%n
    state%n_nonzeros = int(system%tangent%nnz)
    state%factor_memory = system%solver%most_memory
    state%n_constraints = n_active_patches(patches, system%element)
  end subroutine note_constraints

  !> Whether reactions and loads of an increment balance. Source: theory.md (15e).
  pure subroutine note_balance(state, system)
    type(run_state_t), intent(inout) :: state !! with reactions and loads; takes the imbalance
    type(system_t), intent(in) :: system      !! solved

    state%balance_now = force_imbalance(state%reaction, state%applied, &
                                        smallest_force(system%tangent%val, system%u))
    state%balance = max(state%balance, state%balance_now)
  end subroutine note_balance

  !> Checkerboard index of the state after an increment. Source: theory.md (22b).
  pure subroutine note_checkerboard(state, body)
    type(run_state_t), intent(inout) :: state !! takes index and number of elements
    type(body_t), intent(in) :: body          !! converged, points located in the new mesh

    if (.not. allocated(state%checkerboard)) allocate (state%checkerboard)
    call measure_checkerboard(state%checkerboard, state%n_checked, body%mesh, body%points)
  end subroutine note_checkerboard

  !> Total time at the end of the last step.
  pure function end_of_run(model) result(time)
    type(model_t), intent(in) :: model !! with its steps
    real(dp) :: time                   !! sum of the periods
    integer :: i

    time = 0.0_dp
    do i = 1, size(model%step)
      time = time + model%step(i)%schedule%period
    end do
  end function end_of_run

  !> Wall time that the rest of the run takes at the mean pace so far.
  pure function estimated_time_left(state, end_time) result(seconds)
    type(run_state_t), intent(in) :: state !! time and wall time now
    real(dp), intent(in) :: end_time       !! total time at the end of the run
    real(dp) :: seconds                    !! [s], 0 while nothing is known

    seconds = 0.0_dp
    if (state%time > 0.0_dp) then
      seconds = state%wall_seconds*max(end_time - state%time, 0.0_dp)/state%time
    end if
  end function estimated_time_left

  !> What a run tells about itself: the deck, this program and the clock of the machine.
  subroutine make_run_info(info, deck_path, deck_text, n_threads, quiet)
    type(run_info_t), intent(out) :: info   !! complete
    character(*), intent(in) :: deck_path   !! file of the deck
    character(*), intent(in) :: deck_text   !! full text of the deck with its includes
    integer, intent(in) :: n_threads        !! OpenMP threads
    logical, intent(in) :: quiet            !! no progress on the terminal
    character(8)  :: date
    character(10) :: time
    character(5)  :: zone

    info%deck_name = deck_path(index(deck_path, "/", back=.true.) + 1:)
    info%deck_text = deck_text
    info%warnings = ""
    info%formulation = ""
    info%n_threads = n_threads
    info%quiet = quiet
    info%version = build_version
    info%git = git_revision
    info%compiler = build_compiler//" "//compiler_flags
    info%libraries = library_text()
    call date_and_time(date, time, zone)
    info%started = date(1:4)//"-"//date(5:6)//"-"//date(7:8)//"T"//time(1:2)//":"//time(3:4) &
                   //":"//time(5:6)//zone(1:3)//":"//zone(4:5)
    info%run_id = date//"T"//trim(time)//zone//"-"//integer_text(int(c_process()))
  end subroutine make_run_info

end module mpm_run_state
