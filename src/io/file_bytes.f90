!> Bytes for the operating system, and files copied byte by byte.
! allow(assumed-size)
module mpm_file_bytes
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_loc, c_null_char, c_ptr, &
                                         c_size_t
  use mpm_error, only: error_t
  use mpm_system_failure, only: error_number, system_failure
  implicit none
  private
  public :: copy_file, put_bytes

  integer(c_int), parameter :: interrupted = 4_c_int !! EINTR of Linux
  integer, parameter :: block_size = 1048576         !! bytes copied at once

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

    !> Takes bytes from a file; returns how many, 0 at its end, -1 if that fails.
    function c_read(descriptor, bytes, n) bind(c, name="read") result(n_read)
      import :: c_int, c_ptr, c_size_t
      implicit none
      integer(c_int), value :: descriptor
      type(c_ptr), value :: bytes
      integer(c_size_t), value :: n
      integer(c_size_t) :: n_read
    end function c_read

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
  end interface

contains

  !> Hands bytes to the operating system, in one call as far as it goes: a call that was
  !! interrupted, or took a part only, is gone on with.
  subroutine put_bytes(descriptor, bytes, done)
    integer(c_int), intent(in) :: descriptor                         !! of an open file
    character(kind=c_char), intent(in), target, contiguous :: bytes(:) !! (n)
    logical, intent(out) :: done                                     !! .false.: it failed
    integer(c_size_t) :: n, n_done, n_taken

    n = size(bytes, kind=c_size_t)
    n_done = 0_c_size_t
    do while (n_done < n)
      n_taken = c_write(descriptor, c_loc(bytes(n_done + 1)), n - n_done)
      if (n_taken > 0_c_size_t) then
        n_done = n_done + n_taken
      else if (n_taken == 0_c_size_t .or. error_number() /= interrupted) then
        exit
      end if
    end do
    done = n_done == n
  end subroutine put_bytes

  !> Copies a file. After a failure what was copied stays.
  subroutine copy_file(from, to, error)
    character(*), intent(in) :: from                 !! complete file
    character(*), intent(in) :: to                   !! its copy; what was in it is lost
    type(error_t), allocatable, intent(out) :: error !! exit_file
    type(c_ptr) :: source, target_file

    source = c_open(from//c_null_char, "r"//c_null_char)
    if (.not. c_associated(source)) then
      call system_failure(error, "read", from)
      return
    end if
    target_file = c_open(to//c_null_char, "w"//c_null_char)
    if (c_associated(target_file)) then
      call copy_bytes(c_descriptor(source), c_descriptor(target_file), from, to, error)
      if (c_close(target_file) /= 0_c_int .and. .not. allocated(error)) then
        call system_failure(error, "close", to)
      end if
    else
      call system_failure(error, "write", to)
    end if
    if (c_close(source) /= 0_c_int .and. .not. allocated(error)) then
      call system_failure(error, "close", from)
    end if
  end subroutine copy_file

  !> Copies from one open file to another.
  subroutine copy_bytes(source, sink, from, to, error)
    integer(c_int), intent(in) :: source, sink       !! open files
    character(*), intent(in) :: from, to             !! their paths
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(kind=c_char), allocatable, target :: bytes(:)
    integer(c_size_t) :: n
    logical :: done

    allocate (bytes(block_size))
    do
      n = c_read(source, c_loc(bytes), int(block_size, c_size_t))
      if (n == 0_c_size_t) return
      if (n < 0_c_size_t) then
        if (error_number() == interrupted) cycle
        call system_failure(error, "read", from)
        return
      end if
      call put_bytes(sink, bytes(:n), done)
      if (.not. done) then
        call system_failure(error, "write", to)
        return
      end if
    end do
  end subroutine copy_bytes

end module mpm_file_bytes
