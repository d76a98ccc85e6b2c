!> Why a call of the C library failed, in the words of the operating system.
module mpm_system_failure
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_ptr, c_size_t
  use mpm_error, only: error_t, exit_file, make_error
  implicit none
  private
  public :: error_number, fortran_text, system_failure

  interface
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

  !> Number of the last error of the C library.
  function error_number() result(number)
    integer(c_int) :: number
    integer(c_int), pointer :: last

    call c_f_pointer(c_error_number(), last)
    number = last
  end function error_number

  !> Turns the failure of the last call into an error with the reason of the operating system.
  subroutine system_failure(error, action, path)
    type(error_t), allocatable, intent(out) :: error !! exit_file with path and reason
    character(*), intent(in) :: action               !! what was tried
    character(*), intent(in) :: path                 !! file

    call make_error(error, exit_file, "error: cannot "//action//" '"//path//"': "// &
                    fortran_text(c_error_text(error_number())))
  end subroutine system_failure

  !> A C string as Fortran text.
  function fortran_text(text) result(copy)
    type(c_ptr), intent(in) :: text !! may be null
    character(:), allocatable :: copy
    character(kind=c_char), pointer :: letters(:)
    integer :: i

    copy = ""
    if (.not. c_associated(text)) return
    call c_f_pointer(text, letters, [c_length(text)])
    do i = 1, size(letters)
      copy = copy//letters(i)
    end do
  end function fortran_text

end module mpm_system_failure
