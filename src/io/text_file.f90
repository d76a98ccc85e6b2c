!> Text files that are complete up to the last line whatever happens to the program.
!!
!! Through the C library: the flush of Fortran's run-time library does not report a full disk. A
!! line goes to the operating system in one call.
! allow(assumed-size)
module mpm_text_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_intptr_t, c_long, &
                                         c_null_char, c_null_ptr, c_ptr
  use mpm_checksum, only: checksum_of_text
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_file_bytes, only: put_bytes
  use mpm_kinds, only: ip
  use mpm_output_mark, only: text_mark_t
  use mpm_system_failure, only: system_failure
  implicit none
  private
  public :: text_file_t, close_text_file, ignore_size_signal, open_text_file, write_line
  public :: append_to_text_file, check_text_file, resume_text_file, write_counted_line

  integer(c_int), parameter :: size_signal = 25_c_int      !! SIGXFSZ of Linux
  integer(c_intptr_t), parameter :: ignored = 1_c_intptr_t !! SIG_IGN
  integer, parameter :: block_size = 65536                 !! bytes read at once

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path
    type(c_ptr) :: stream = c_null_ptr !! FILE of C
    logical :: is_open = .false.
    type(text_mark_t) :: mark          !! where it stands, if all its lines were counted
  end type text_file_t

  interface
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

    !> Cuts an open file to a length; not 0 if that fails.
    function c_truncate(descriptor, length) bind(c, name="ftruncate") result(status)
      import :: c_int, c_long
      implicit none
      integer(c_int), value :: descriptor
      integer(c_long), value :: length
      integer(c_int) :: status
    end function c_truncate

    !> Closes a file; not 0 if that fails.
    function c_close(stream) bind(c, name="fclose") result(status)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_close

    !> Sets what happens at a signal.
    function c_signal(number, action) bind(c, name="signal") result(previous)
      import :: c_int, c_intptr_t
      implicit none
      integer(c_int), value :: number
      integer(c_intptr_t), value :: action
      integer(c_intptr_t) :: previous
    end function c_signal
  end interface

contains

  !> Makes a limit of the file size an error of the write that hits it; by default the system
  !! ends the program.
  subroutine ignore_size_signal()
    integer(c_intptr_t) :: previous

    previous = c_signal(size_signal, ignored)
  end subroutine ignore_size_signal

  !> Opens a file for writing; what was in it is lost.
  subroutine open_text_file(file, path, error)
    type(text_file_t), intent(out) :: file           !! ready for write_line
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file

    file%path = path
    file%stream = c_open(path//c_null_char, "w"//c_null_char)
    file%is_open = c_associated(file%stream)
    if (.not. file%is_open) call system_failure(error, "write", path)
  end subroutine open_text_file

  !> Writes a line and hands it to the operating system.
  subroutine write_line(file, line, error)
    type(text_file_t), intent(in) :: file            !! open file
    character(*), intent(in) :: line                 !! without line end; may hold several lines
    type(error_t), allocatable, intent(out) :: error !! exit_file, for example a full disk
    character(kind=c_char), allocatable :: bytes(:)
    integer :: i
    logical :: done

    allocate (bytes(len(line) + 1))
    do i = 1, len(line)
      bytes(i) = line(i:i)
    end do
    bytes(size(bytes)) = new_line("a")
    call put_bytes(c_descriptor(file%stream), bytes, done)
    if (.not. done) call system_failure(error, "write", file%path)
  end subroutine write_line

  !> Writes a line and keeps count of length and checksum of the file.
  subroutine write_counted_line(file, line, error)
    type(text_file_t), intent(inout) :: file         !! open file; its mark moves on
    character(*), intent(in) :: line                 !! without line end; may hold several lines
    type(error_t), allocatable, intent(out) :: error !! exit_file, for example a full disk

    call write_line(file, line, error)
    if (allocated(error)) return
    file%mark%n_bytes = file%mark%n_bytes + len(line, ip) + 1_ip
    file%mark%checksum = checksum_of_text(file%mark%checksum, line//new_line("a"))
  end subroutine write_counted_line

  !> Whether a file begins with what was written into it up to a mark.
  subroutine check_text_file(path, mark, error)
    character(*), intent(in) :: path                 !! file
    type(text_mark_t), intent(in) :: mark            !! where it stood
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(200) :: problem, reason
    integer(ip) :: checksum
    integer :: closed, status, unit

    open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
          action="read", iostat=status, iomsg=reason)
    if (status == 0) then
      call sum_up(unit, mark%n_bytes, checksum, status, reason)
      close (unit, iostat=closed, iomsg=problem)
      if (status == 0 .and. closed /= 0) then
        status = closed
        reason = problem
      else if (status == 0 .and. checksum /= mark%checksum) then
        status = -1
        reason = "its first lines are not those that were written"
      end if
    end if
    if (status == 0) return
    call make_error(error, exit_file, "error: cannot go on with '"//path//"': "//trim(reason) &
                    //": expected the file of the interrupted run, or another folder (-o DIR)")
  end subroutine check_text_file

  !> Checksum of the first bytes of a file.
  subroutine sum_up(unit, n_bytes, checksum, status, reason)
    integer, intent(in) :: unit             !! open at its first byte
    integer(ip), intent(in) :: n_bytes      !! how many
    integer(ip), intent(out) :: checksum    !! see mpm_checksum
    integer, intent(out) :: status          !! not 0: failed, or fewer bytes
    character(200), intent(inout) :: reason !! of a failure
    character(block_size) :: block
    integer(ip) :: left, n_there
    integer :: n

    checksum = 0_ip
    left = n_bytes
    inquire (unit=unit, size=n_there, iostat=status, iomsg=reason)
    if (status == 0 .and. n_there < left) then
      status = -1
      reason = "it is shorter than it was"
    end if
    do while (status == 0 .and. left > 0_ip)
      n = int(min(left, int(block_size, ip)))
      read (unit, iostat=status, iomsg=reason) block(:n)
      if (status /= 0) exit
      checksum = checksum_of_text(checksum, block(:n))
      left = left - n
    end do
  end subroutine sum_up

  !> Opens a file to go on behind a mark; what is behind it is lost.
  subroutine resume_text_file(file, path, mark, error)
    type(text_file_t), intent(out) :: file           !! ready for write_line
    character(*), intent(in) :: path                 !! file that was checked
    type(text_mark_t), intent(in) :: mark            !! where it stood
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call append_to_text_file(file, path, error)
    if (allocated(error)) return
    file%mark = mark
    if (c_truncate(c_descriptor(file%stream), int(mark%n_bytes, c_long)) /= 0_c_int) then
      call system_failure(error, "write", path)
    end if
  end subroutine resume_text_file

  !> Opens a file for writing behind what is there.
  subroutine append_to_text_file(file, path, error)
    type(text_file_t), intent(out) :: file           !! ready for write_line
    character(*), intent(in) :: path                 !! file; need not be there
    type(error_t), allocatable, intent(out) :: error !! exit_file

    file%path = path
    file%stream = c_open(path//c_null_char, "a"//c_null_char)
    file%is_open = c_associated(file%stream)
    if (.not. file%is_open) call system_failure(error, "write", path)
  end subroutine append_to_text_file

  !> Closes a file; no effect on a closed one.
  subroutine close_text_file(file, error)
    type(text_file_t), intent(inout) :: file         !! closed afterwards
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer(c_int) :: status

    if (.not. file%is_open) return
    file%is_open = .false.
    status = c_close(file%stream)
    if (status /= 0_c_int) call system_failure(error, "close", file%path)
  end subroutine close_text_file

end module mpm_text_file
