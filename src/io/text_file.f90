!> Text files that are complete up to the last line whatever happens to the program.
!!
!! Through the C library: the flush of Fortran's run-time library does not report a full disk. A
!! line goes to the operating system in one call.
! allow(assumed-size)
module mpm_text_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_intptr_t, c_loc, &
                                         c_null_char, c_null_ptr, c_ptr, c_size_t
  use mpm_error, only: error_t
  use mpm_system_failure, only: error_number, system_failure
  implicit none
  private
  public :: text_file_t, close_text_file, ignore_size_signal, open_text_file, write_line

  integer(c_int), parameter :: size_signal = 25_c_int      !! SIGXFSZ of Linux
  integer(c_intptr_t), parameter :: ignored = 1_c_intptr_t !! SIG_IGN
  integer(c_int), parameter :: interrupted = 4_c_int       !! EINTR of Linux

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path
    type(c_ptr) :: stream = c_null_ptr !! FILE of C
    logical :: is_open = .false.
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

    !> Hands bytes to the operating system; returns how many it took, -1 if that fails.
    function c_write(descriptor, bytes, n) bind(c, name="write") result(n_written)
      import :: c_int, c_ptr, c_size_t
      implicit none
      integer(c_int), value :: descriptor
      type(c_ptr), value :: bytes
      integer(c_size_t), value :: n
      integer(c_size_t) :: n_written
    end function c_write

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
    character(kind=c_char), allocatable, target :: bytes(:)
    integer(c_size_t) :: n_done, n_taken
    integer :: i

    allocate (bytes(len(line) + 1))
    do i = 1, len(line)
      bytes(i) = line(i:i)
    end do
    bytes(size(bytes)) = new_line("a")
    n_done = 0_c_size_t
    do while (n_done < size(bytes, kind=c_size_t))
      n_taken = c_write(c_descriptor(file%stream), c_loc(bytes(n_done + 1)), &
                        size(bytes, kind=c_size_t) - n_done)
      if (n_taken > 0_c_size_t) then
        n_done = n_done + n_taken
      else if (n_taken == 0_c_size_t .or. error_number() /= interrupted) then
        call system_failure(error, "write", file%path)
        return
      end if
    end do
  end subroutine write_line

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
