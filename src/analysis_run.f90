!> What an analysis carries from increment to increment.
module mpm_analysis_run
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp
  use mpm_limit_load, only: limit_watch_t
  use mpm_newton_report, only: newton_report_t
  use mpm_point_location, only: locator_t
  use mpm_restart_state, only: restart_t
  use mpm_system, only: body_t, system_t
  implicit none
  private
  public :: analysis_t

  !> The body, the work space of an increment, and the last state to go on from.
  type :: analysis_t
    type(body_t)     :: body
    type(system_t)   :: system
    type(schedule_t) :: schedule
    type(locator_t)  :: locator
    type(newton_report_t) :: report           !! of the last attempt
    type(limit_watch_t) :: watch              !! of the loads
    type(restart_t)  :: kept                  !! the run after the last accepted increment, without
                                              !! mesh and points, which change in none but that
    real(dp), allocatable :: u_start(:, :)    !! (n_dim, n)  displacements of the points at the
                                              !!             start of the step [length]
    logical  :: is_tentative = .false.        !! the state shows an attempt that is not accepted yet
    real(dp) :: max_memory = 0.0_dp           !! that the run may take [GB], 0 = any
    real(dp) :: last_written = 0.0_dp         !! wall time of the last restart file [s]
  end type analysis_t

end module mpm_analysis_run
