!> Errors as values: what went wrong, in words for the user, and the exit code that it means.
module mpm_error
  implicit none
  private
  public :: error_t, make_error
  public :: exit_ok, exit_usage, exit_deck, exit_model, exit_no_convergence, exit_solver
  public :: exit_lost_point, exit_expectation, exit_file, exit_interrupted, exit_terminated

  integer, parameter :: exit_ok = 0             !! finished, every *EXPECT met
  integer, parameter :: exit_usage = 1          !! wrong command line
  integer, parameter :: exit_deck = 2           !! wrong deck
  integer, parameter :: exit_model = 3          !! wrong mesh or model
  integer, parameter :: exit_no_convergence = 4 !! no convergence at the smallest increment
  integer, parameter :: exit_solver = 5         !! linear solver or memory
  integer, parameter :: exit_lost_point = 6     !! a material point was lost
  integer, parameter :: exit_expectation = 7    !! finished, but an *EXPECT failed
  integer, parameter :: exit_file = 8           !! file or HDF5 error
  integer, parameter :: exit_interrupted = 130  !! ended by SIGINT or JOB.stop, restart written
  integer, parameter :: exit_terminated = 143   !! ended by SIGTERM, restart written

  !> A failure on its way up to the main program. Unallocated means success.
  type :: error_t
    integer :: code = exit_ok              !! exit code of the program, one of exit_*
    character(:), allocatable :: message   !! complete text for the user, may hold several lines
  end type error_t

contains

  !> Allocates an error.
  pure subroutine make_error(error, code, message)
    type(error_t), allocatable, intent(out) :: error !! the new error
    integer, intent(in)      :: code                 !! exit code, one of exit_*
    character(*), intent(in) :: message              !! text for the user

    allocate (error)
    error%code = code
    error%message = message
  end subroutine make_error

end module mpm_error
