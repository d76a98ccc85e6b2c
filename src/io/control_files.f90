!> Files that a user makes beside the results to speak to a run.
module mpm_control_files
  use mpm_file_exchange, only: remove_file
  implicit none
  private
  public :: take_request

contains

  !> Looks for a file and takes it away.
  subroutine take_request(asked, path)
    logical, intent(out) :: asked    !! it was there
    character(*), intent(in) :: path !! JOB.stop or JOB.restart

    inquire (file=path, exist=asked)
    if (asked) call remove_file(path)
  end subroutine take_request

end module mpm_control_files
