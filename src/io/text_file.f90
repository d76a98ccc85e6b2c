!> Text files that are complete up to the last line whatever happens to the program.
!!
!! Through the C library: the flush of Fortran's run-time library does not report a full disk.
! allow(assumed-size)
module mpm_text_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, &
                                         c_intptr_t, c_null_char, c_null_ptr, c_ptr, c_size_t
  use mpm_error, only: error_t, exit_file, make_error
  implicit none
  private
  public :: text_file_t, close_text_file, ignore_size_signal, open_text_file, write_line

  integer(c_int), parameter :: size_signal = 25_c_int      !! SIGXFSZ of Linux
  integer(c_intptr_t), parameter :: ignored = 1_c_intptr_t !! SIG_IGN

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

    !> Writes bytes; returns how many of them.
    function c_write(bytes, size, n, stream) bind(c, name="fwrite") result(n_written)
      import :: c_char, c_ptr, c_size_t
      implicit none
      character(kind=c_char), intent(in) :: bytes(*)
      integer(c_size_t), value :: size, n
      type(c_ptr), value :: stream
      integer(c_size_t) :: n_written
    end function c_write

    !> Hands what was written to the operating system; not 0 if that fails.
    function c_flush(stream) bind(c, name="fflush") result(status)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_flush

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

    !> Where the number of the last error is.
    function c_error_number() bind(c, name="__errno_location") result(address)
      import :: c_ptr
      implicit none
      type(c_ptr) :: address
    end function c_error_number

    !> Text of an error number.
    function c_error_text(number) bind(c, name="strerror") result(text)
      import :: c_int, c_ptr
      implicit none
      integer(c_int), value :: number
      type(c_ptr) :: text
    end function c_error_text

    !> Length of a C string.
    pure function c_length(text) bind(c, name="strlen") result(length)
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_length
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
    integer(c_size_t) :: length, n_written
    integer(c_int) :: status

    length = len(line, c_size_t) + 1_c_size_t
    n_written = c_write(line//new_line("a"), 1_c_size_t, length, file%stream)
    status = 0_c_int
    if (n_written == length) status = c_flush(file%stream)
    if (n_written /= length .or. status /= 0_c_int) call system_failure(error, "write", file%path)
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

  !> Turns the failure of the last call into an error with the reason of the operating system.
  subroutine system_failure(error, action, path)
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(*), intent(in) :: action               !! what was tried
    character(*), intent(in) :: path                 !! file
    integer(c_int), pointer :: number
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: text
    character(:), allocatable :: reason
    integer :: i

    call c_f_pointer(c_error_number(), number)
    text = c_error_text(number)
    call c_f_pointer(text, letters, [c_length(text)])
    reason = ""
    do i = 1, size(letters)
      reason = reason//letters(i)
    end do
    call make_error(error, exit_file, "error: cannot "//action//" '"//path//"': "//reason)
  end subroutine system_failure

end module mpm_text_file
