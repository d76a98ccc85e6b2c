!> Reads whole files of the user: no wait for a pipe, no failure of an allocation.
! allow(assumed-size)
module mpm_input_file
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
  use mpm_kinds, only: dp, ip
  use mpm_text, only: real_text
  implicit none
  private
  public :: check_input, load_input

  integer(c_int), parameter :: without_wait = 2048_c_int !! O_RDONLY and O_NONBLOCK of Linux
  integer(c_int), parameter :: from_end = 2_c_int        !! SEEK_END

  interface
    !> Opens a file; below 0 if it cannot be opened.
    function c_open(path, flags, mode) bind(c, name="open") result(descriptor)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: flags, mode
      integer(c_int) :: descriptor
    end function c_open

    !> Goes to a place in a file; below 0 if it has no places, such as a pipe.
    function c_seek(descriptor, offset, whence) bind(c, name="lseek") result(place)
      import :: c_int, c_long
      implicit none
      integer(c_int), value :: descriptor, whence
      integer(c_long), value :: offset
      integer(c_long) :: place
    end function c_seek

    !> Closes a file.
    function c_close(descriptor) bind(c, name="close") result(status)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_close
  end interface

contains

  !> Whether a file can be read.
  subroutine check_input(path, reason)
    character(*), intent(in) :: path                 !! file
    character(:), allocatable, intent(out) :: reason !! why it cannot, empty if it can
    integer(ip) :: n_bytes
    integer :: unit

    call open_input(unit, n_bytes, path, reason)
    if (len(reason) == 0) close (unit)
  end subroutine check_input

  !> Reads a whole file.
  subroutine load_input(text, path, reason)
    character(:), allocatable, intent(out) :: text   !! its bytes, none if it cannot be read
    character(*), intent(in) :: path                 !! file
    character(:), allocatable, intent(out) :: reason !! why it cannot be read, empty if it was
    character(256) :: message
    integer(ip) :: n_bytes
    integer :: status, unit

    text = ""
    call open_input(unit, n_bytes, path, reason)
    if (len(reason) > 0) return
    if (n_bytes > 0) then
      deallocate (text)
      allocate (character(n_bytes) :: text, stat=status, errmsg=message)
      message = "not enough memory for its "//real_text(real(n_bytes, dp))//" bytes"
      if (status == 0) read (unit, iostat=status, iomsg=message) text
      if (status /= 0) then
        reason = trim(message)
        text = ""
      end if
    end if
    close (unit)
  end subroutine load_input

  !> Opens a file and looks at its first byte: a folder can be opened, but not read.
  subroutine open_input(unit, n_bytes, path, reason)
    integer, intent(out)     :: unit                 !! open, without a reason
    integer(ip), intent(out) :: n_bytes              !! its size
    character(*), intent(in) :: path                 !! file
    character(:), allocatable, intent(out) :: reason !! why it cannot be read, empty if it can
    character(256) :: message
    character(1)   :: first
    integer :: status

    reason = ""
    n_bytes = 0
    unit = 0
    if (is_stream(path)) then
      reason = "it is a pipe or a device, no file"
      return
    end if
    open (newunit=unit, file=path, action="read", status="old", access="stream", &
          form="unformatted", iostat=status, iomsg=message)
    if (status == 0) then
      inquire (unit=unit, size=n_bytes)
      if (n_bytes > 0) read (unit, pos=1, iostat=status, iomsg=message) first
      rewind (unit)
      if (status /= 0) close (unit)
    end if
    if (status /= 0) reason = trim(message)
  end subroutine open_input

  !> Whether something can be opened but has no places to go to: reading it could take for ever.
  function is_stream(path) result(is_pipe)
    character(*), intent(in) :: path !! file
    logical :: is_pipe               !! .true.: a pipe or a device
    integer(c_int) :: descriptor, status
    integer(c_long) :: place

    is_pipe = .false.
    descriptor = c_open(trim(path)//c_null_char, without_wait, 0_c_int)
    if (descriptor < 0_c_int) return
    place = c_seek(descriptor, 0_c_long, from_end)
    is_pipe = place < 0_c_long
    status = c_close(descriptor)
  end function is_stream

end module mpm_input_file
