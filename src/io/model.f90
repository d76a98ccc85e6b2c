!> The model that a deck describes: what the main program works on.
module mpm_model
  use mpm_amplitude, only: amplitude_t
  use mpm_dof_map, only: constraint_t
  use mpm_equilibrium, only: newton_settings_t
  use mpm_external_force, only: load_t
  use mpm_increments, only: schedule_settings_t
  use mpm_initial_stress, only: initial_stress_t
  use mpm_kinds, only: dp
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_mesh_motion, only: mesh_motion_t
  use mpm_nodal_frames, only: nodal_frames_t
  use mpm_patches, only: patches_t
  use mpm_point_location, only: location_settings_t
  use mpm_surface_points, only: surface_points_t
  implicit none
  private
  public :: model_t, step_t, field_output_t, history_request_t, expectation_t
  public :: formulation_standard, formulation_fbar, history_of_nodes, history_of_point
  public :: restart_by_clock

  integer, parameter :: formulation_standard = 1 !! dFbar = dF
  integer, parameter :: formulation_fbar = 2     !! F-bar patch
  integer, parameter :: restart_by_clock = -1    !! no *RESTART: when time has passed
  integer, parameter :: history_of_nodes = 1     !! *HISTORY, NSET= or SURFACE=
  integer, parameter :: history_of_point = 2     !! *HISTORY, POINT=

  !> *OUTPUT, FIELD
  type :: field_output_t
    character(8), allocatable :: field(:)  !! deck names of point fields, upper case; empty = the default set
    integer  :: frequency = 1              !! every so many increments; 0 = only the end of the step
    real(dp) :: time_interval = 0.0_dp     !! > 0: at multiples of this step time instead (increments are cut to hit them)
    logical  :: single = .false.           !! reals are stored in single precision
  end type field_output_t

  !> *HISTORY
  type :: history_request_t
    integer :: kind = history_of_nodes
    character(:), allocatable :: label     !! set name, or "x,y,z" as in the deck
    integer, allocatable :: node(:)        !! nodes of the set
    integer :: point = 0                   !! index (= id) of the material point nearest to POINT=
    character(8), allocatable :: quantity(:) !! deck names, upper case
    integer :: card = 0
  end type history_request_t

  !> One data line of an *EXPECT.
  type :: expectation_t
    character(:), allocatable :: quantity   !! RF, U, S, TAU, PEEQ ...
    character(:), allocatable :: set        !! node set, element set or empty (all points)
    integer, allocatable :: item(:)         !! nodes or elements of the set; unallocated: all points
    integer  :: component = 0               !! 1..6, 0 = scalar
    real(dp) :: time = 0.0_dp               !! total time
    character(:), allocatable :: statistic  !! SUM, MEAN, MIN, MAX, STD
    logical  :: analytic = .true.           !! .false.: frozen
    real(dp) :: value = 0.0_dp
    real(dp) :: rtol = 0.0_dp
    real(dp) :: atol = 0.0_dp
    integer  :: card = 0
    integer  :: line = 0
    logical  :: of_nodes = .true.           !! items are nodes; .false.: elements
    character(:), allocatable :: origin     !! "file:line" of the data line, for the verdict
  end type expectation_t

  !> A step with everything in force in it (carried-over conditions included).
  type :: step_t
    character(:), allocatable :: name
    logical                   :: geostatic = .false. !! *GEOSTATIC: loads from the beginning
    real(dp)                  :: largest_move = 0.0_dp !! > 0: UTOL of *GEOSTATIC [length]
    type(schedule_settings_t) :: schedule
    type(newton_settings_t)   :: newton
    type(constraint_t), allocatable :: constraint(:)
    type(load_t), allocatable       :: load(:)
    type(field_output_t)            :: field_output
    logical                         :: has_field_output = .false.
    integer                         :: restart_frequency = restart_by_clock !! of *RESTART
    type(history_request_t), allocatable :: history(:)
    type(expectation_t), allocatable     :: expectation(:)
    integer :: card = 0
  end type step_t

  !> The whole model at time zero.
  type :: model_t
    character(:), allocatable :: job          !! name of the deck without folder and extension
    character(:), allocatable :: heading      !! text of *HEADING
    character(:), allocatable :: unit_length  !! label, empty if none
    character(:), allocatable :: unit_force   !! label, empty if none
    integer                   :: formulation = formulation_fbar
    character(:), allocatable :: patch_source !! QUADRATIC, METIS or NONE
    integer                   :: patch_size = 8 !! requested size of METIS patches
    type(mesh_t)              :: mesh
    type(patches_t)           :: patches      !! those of the deck, also with the standard formulation
    type(material_t), allocatable  :: material(:)
    type(points_t)            :: points
    type(surface_points_t)    :: surface      !! of the loads with CARRIER=POINTS
    type(initial_stress_t), allocatable :: initial_stress(:) !! set in the points already
    type(mesh_motion_t)       :: motion
    type(nodal_frames_t)      :: frames       !! axes of the nodes
    type(location_settings_t) :: location
    logical                   :: locking_meter = .false. !! lines of the meter in the log
    real(dp)                  :: ghost_gamma = 0.0_dp !! factor of *GHOST PENALTY, 0 = none
    logical                   :: ghost_adapts = .false. !! without GAMMA: raised where cuts do not help
    type(amplitude_t), allocatable :: amplitude(:)
    type(step_t), allocatable :: step(:)
  end type model_t

end module mpm_model
