!> Files that a user makes beside the results to speak to a run.
module mpm_control_files
  use mpm_file_exchange, only: remove_file
  implicit none
  private
  public :: take_request

contains

  !> Looks for a file and takes it away; what cannot be taken away, such as a folder, is none.
  subroutine take_request(asked, path)
    logical, intent(out) :: asked    !! it was there
    character(*), intent(in) :: path !! JOB.stop or JOB.restart
    logical :: remains

    inquire (file=path, exist=asked)
    if (.not. asked) return
    call remove_file(path)
    inquire (file=path, exist=remains)
    asked = .not. remains
  end subroutine take_request

end module mpm_control_files
