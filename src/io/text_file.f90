!> Text files that are complete up to the last line whatever happens to the program.
module mpm_text_file
  use mpm_error, only: error_t, exit_file, make_error
  implicit none
  private
  public :: text_file_t, close_text_file, open_text_file, write_line

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path
    integer :: unit = 0 !! Fortran unit
    logical :: is_open = .false.
  end type text_file_t

  integer, parameter :: length_of_reason = 256 !! characters of a message of the system

contains

  !> Opens a file for writing; what was in it is lost.
  subroutine open_text_file(file, path, error)
    type(text_file_t), intent(out) :: file           !! ready for write_line
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(length_of_reason) :: reason
    integer :: status

    file%path = path
    open (newunit=file%unit, file=path, status="replace", action="write", iostat=status, &
          iomsg=reason)
    file%is_open = status == 0
    if (status /= 0) then
      call make_error(error, exit_file, "error: cannot write '"//path//"': "//trim(reason))
    end if
  end subroutine open_text_file

  !> Writes a line and hands it to the operating system.
  subroutine write_line(file, line, error)
    type(text_file_t), intent(in) :: file            !! open file
    character(*), intent(in) :: line                 !! without line end; may hold several lines
    type(error_t), allocatable, intent(out) :: error !! exit_file, for example a full disk
    character(length_of_reason) :: reason
    integer :: status

    write (file%unit, "(a)", iostat=status, iomsg=reason) line
    if (status == 0) flush (file%unit, iostat=status, iomsg=reason)
    if (status /= 0) then
      call make_error(error, exit_file, "error: cannot write '"//file%path//"': "//trim(reason))
    end if
  end subroutine write_line

  !> Closes a file; no effect on a closed one.
  subroutine close_text_file(file, error)
    type(text_file_t), intent(inout) :: file         !! closed afterwards
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(length_of_reason) :: reason
    integer :: status

    if (.not. file%is_open) return
    file%is_open = .false.
    close (file%unit, iostat=status, iomsg=reason)
    if (status /= 0) then
      call make_error(error, exit_file, "error: cannot close '"//file%path//"': "//trim(reason))
    end if
  end subroutine close_text_file

end module mpm_text_file
