!> A new file takes the name under which readers look for it; that name is never missing.
! allow(assumed-size)
module mpm_file_exchange
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_ptr
  use mpm_error, only: error_t
  use mpm_system_failure, only: system_failure
  implicit none
  private
  public :: exchange_file, remove_file, replace_file, rotate_file, sync_file

  integer(c_int), parameter :: current_folder = -100_c_int !! AT_FDCWD of Linux
  integer(c_int), parameter :: exchange_names = 2_c_int    !! RENAME_EXCHANGE of Linux
  character(*), parameter :: suffix = ".former" !! of the old file while names change one by one

  interface
    !> Gives a file another name, in one step; one that has the name already is gone.
    function c_rename(from, to) bind(c, name="rename") result(status)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_rename

    !> The same with flags; Linux only.
    function c_rename_with_flags(from_folder, from, to_folder, to, flags) &
      bind(c, name="renameat2") result(status)
      import :: c_char, c_int
      implicit none
      integer(c_int), value :: from_folder, to_folder, flags
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_rename_with_flags

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

    !> Opens a file; null if it cannot be opened.
    function c_open(path, mode) bind(c, name="fopen") result(stream)
      import :: c_char, c_ptr
      implicit none
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: stream
    end function c_open

    !> Number by which the operating system knows an open file.
    function c_descriptor(stream) bind(c, name="fileno") result(descriptor)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: descriptor
    end function c_descriptor

    !> Brings a file to the disk; not 0 if that fails.
    function c_sync(descriptor) bind(c, name="fsync") result(status)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_sync

    !> Closes a file; not 0 if that fails.
    function c_close(stream) bind(c, name="fclose") result(status)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_close
  end interface

contains

  !> Gives a file the name of another one, which is gone afterwards if it was there.
  subroutine replace_file(new, path, error)
    character(*), intent(in) :: new                  !! complete file
    character(*), intent(in) :: path                 !! name that it gets
    type(error_t), allocatable, intent(out) :: error !! exit_file

    if (c_rename(new//c_null_char, path//c_null_char) /= 0_c_int) then
      call system_failure(error, "write", path)
    end if
  end subroutine replace_file

  !> Exchanges the names of two files: in one step, else by a second name for the old one. On a
  !! file system that can do neither, and when there is no old file, the new one replaces it.
  subroutine exchange_file(new, path, kept, error)
    character(*), intent(in) :: new                  !! complete file
    character(*), intent(in) :: path                 !! name that it gets
    logical, intent(out) :: kept                     !! the old file has the name new now
    type(error_t), allocatable, intent(out) :: error !! exit_file

    kept = c_rename_with_flags(current_folder, new//c_null_char, current_folder, &
                               path//c_null_char, exchange_names) == 0_c_int
    if (kept) return
    call remove_file(path//suffix) ! may be there since a kill
    kept = c_link(path//c_null_char, path//suffix//c_null_char) == 0_c_int
    call replace_file(new, path, error)
    if (allocated(error)) then
      call remove_file(path//suffix)
    else if (kept) then
      kept = c_rename(path//suffix//c_null_char, new//c_null_char) == 0_c_int
    end if
  end subroutine exchange_file

  !> Lets a complete new file take the place of the present one, which becomes the previous one.
  !! At every moment there is a complete file under one of the two names.
  subroutine rotate_file(new, present, previous, error)
    character(*), intent(in) :: new                  !! path of the new file
    character(*), intent(in) :: present              !! path that it gets
    character(*), intent(in) :: previous             !! path of the one that it replaces
    type(error_t), allocatable, intent(out) :: error !! exit_file
    type(error_t), allocatable :: ignored
    integer(c_int) :: status

    call remove_file(previous)
    ! Without second names on this file system it is renamed; there may be none.
    status = c_link(present//c_null_char, previous//c_null_char)
    if (status /= 0_c_int) status = c_rename(present//c_null_char, previous//c_null_char)
    call replace_file(new, present, error)
    if (allocated(error)) return
    ! The names, too, must outlive a power cut; not every file system can do that.
    call sync_file(present(:index(present, "/", back=.true.))//".", ignored)
  end subroutine rotate_file

  !> Removes a file; no effect if there is none.
  subroutine remove_file(path)
    character(*), intent(in) :: path !! file

    if (c_unlink(path//c_null_char) /= 0_c_int) return
  end subroutine remove_file

  !> Brings a file to the disk: it outlives a power cut from then on.
  subroutine sync_file(path, error)
    character(*), intent(in) :: path                 !! closed file, or folder for the names in it
    type(error_t), allocatable, intent(out) :: error !! exit_file
    type(c_ptr) :: stream

    stream = c_open(path//c_null_char, "r"//c_null_char)
    if (.not. c_associated(stream)) then
      call system_failure(error, "write", path)
      return
    end if
    if (c_sync(c_descriptor(stream)) /= 0_c_int) call system_failure(error, "write", path)
    if (c_close(stream) /= 0_c_int .and. .not. allocated(error)) then
      call system_failure(error, "close", path)
    end if
  end subroutine sync_file

end module mpm_file_exchange
