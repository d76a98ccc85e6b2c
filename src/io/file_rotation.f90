!> A new file takes the place of an old one, which is kept under another name.
! allow(assumed-size)
module mpm_file_rotation
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use mpm_error, only: error_t, exit_file, make_error
  implicit none
  private
  public :: remove_file, rotate_file, sync_file

  interface
    !> Gives a file another name, in one step.
    function c_rename(from, to) bind(c, name="rename") result(status)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_rename

    !> Gives a file a second name.
    function c_link(from, to) bind(c, name="link") result(status)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_link

    !> Takes a name away.
    function c_unlink(path) bind(c, name="unlink") result(status)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_unlink

    !> Opens a file; < 0 if it cannot be opened.
    function c_open(path, flags) bind(c, name="open") result(descriptor)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: flags
      integer(c_int) :: descriptor
    end function c_open

    !> Waits until a file is on the disk.
    function c_fsync(descriptor) bind(c, name="fsync") result(status)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_fsync

    !> Closes a file.
    function c_close(descriptor) bind(c, name="close") result(status)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_close
  end interface

contains

  !> Lets a complete new file take the place of the present one, which becomes the previous one.
  !! At every moment there is a complete file under one of the two names.
  subroutine rotate_file(new, present, previous, error)
    character(*), intent(in) :: new                  !! path of the new file
    character(*), intent(in) :: present              !! path that it gets
    character(*), intent(in) :: previous             !! path of the one that it replaces
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer :: ignored
    logical :: exists

    inquire (file=present, exist=exists)
    if (exists) then
      call remove_file(previous)
      ! Without second names on this file system it is renamed.
      if (c_link(present//c_null_char, previous//c_null_char) /= 0_c_int) then
        exists = c_rename(present//c_null_char, previous//c_null_char) == 0_c_int
      end if
    end if
    if (c_rename(new//c_null_char, present//c_null_char) == 0_c_int) then
      ! The new names, too, must outlive a loss of power; not every file system can do that.
      call sync_file(present(:index(present, "/", back=.true.))//".", ignored)
      return
    end if
    call make_error(error, exit_file, "error: cannot write '"//present//"': '"//new// &
                    "' is there, but cannot get this name")
  end subroutine rotate_file

  !> Removes a file; no effect if there is none.
  subroutine remove_file(path)
    character(*), intent(in) :: path !! file

    if (c_unlink(path//c_null_char) /= 0_c_int) return
  end subroutine remove_file

  !> Waits until a file, or the names in a folder, are on the disk.
  subroutine sync_file(path, status)
    character(*), intent(in) :: path !! file or folder
    integer, intent(out) :: status   !! not 0: failed
    integer(c_int), parameter :: read_only = 0_c_int
    integer(c_int) :: descriptor

    descriptor = c_open(path//c_null_char, read_only)
    status = 1
    if (descriptor < 0_c_int) return
    status = int(c_fsync(descriptor))
    if (c_close(descriptor) /= 0_c_int) status = 1
  end subroutine sync_file

end module mpm_file_rotation
