!> Why a call of HDF5 failed, in the words of the operating system where there are any.
module mpm_hdf5_failure
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_funloc, c_funptr, c_int, c_int64_t, c_loc, &
                                         c_ptr
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_system_failure, only: fortran_text
  implicit none
  private
  public :: hdf5_failure

  integer, parameter :: length_of_reason = 512   !! characters kept of a description
  integer(c_int64_t), parameter :: stack_of_last_call = 0_c_int64_t !! H5E_DEFAULT
  integer(c_int), parameter :: cause_first = 0_c_int                !! H5E_WALK_UPWARD

  !> H5E_error2_t.
  type, bind(c) :: hdf5_entry_t
    integer(c_int64_t) :: class
    integer(c_int64_t) :: major
    integer(c_int64_t) :: minor
    integer(c_int)     :: line
    type(c_ptr)        :: function_name
    type(c_ptr)        :: file_name
    type(c_ptr)        :: description
  end type hdf5_entry_t

  !> What the walk along the error stack has found.
  type :: finding_t
    character(length_of_reason) :: cause = "" !! description of the innermost entry
    character(length_of_reason) :: system = "" !! message of the operating system
  end type finding_t

  interface
    !> Calls a function for each entry of an error stack.
    function h5_walk_errors(stack, direction, visit, finding) bind(c, name="H5Ewalk2") &
      result(status)
      import :: c_funptr, c_int, c_int64_t, c_ptr
      implicit none
      integer(c_int64_t), value :: stack
      integer(c_int), value :: direction
      type(c_funptr), value :: visit
      type(c_ptr), value :: finding
      integer(c_int) :: status
    end function h5_walk_errors
  end interface

contains

  !> Turns the failure of the last HDF5 call into an error. No other HDF5 call may come between.
  subroutine hdf5_failure(error, path, action)
    type(error_t), allocatable, intent(out) :: error !! exit_file with path and reason
    character(*), intent(in) :: path                 !! file
    character(*), intent(in) :: action               !! what was tried, "create", "write" ...
    type(finding_t), target :: finding
    character(:), allocatable :: reason
    integer(c_int) :: status

    finding%cause = ""
    finding%system = ""
    status = h5_walk_errors(stack_of_last_call, cause_first, c_funloc(visit_entry), c_loc(finding))
    reason = "HDF5 gives no reason"
    if (status >= 0 .and. len_trim(finding%cause) > 0) reason = trim(finding%cause)
    if (len_trim(finding%system) > 0) reason = trim(finding%system)
    call make_error(error, exit_file, "error: cannot "//action//" '"//path//"': "//reason)
  end subroutine hdf5_failure

  !> Looks at one entry of the stack; called by HDF5.
  function visit_entry(level, entry, finding) bind(c) result(status)
    integer(c_int), value :: level    !! 0 = innermost
    type(c_ptr), value :: entry       !! hdf5_entry_t
    type(c_ptr), value :: finding     !! finding_t
    integer(c_int) :: status          !! 0: go on
    type(hdf5_entry_t), pointer :: this
    type(finding_t), pointer :: found
    character(:), allocatable :: description

    status = 0
    call c_f_pointer(entry, this)
    call c_f_pointer(finding, found)
    description = fortran_text(this%description)
    if (level == 0) found%cause = description
    if (len_trim(found%system) == 0) found%system = system_message(description)
  end function visit_entry

  !> The part of a description that comes from the operating system.
  pure function system_message(description) result(message)
    character(*), intent(in) :: description
    character(:), allocatable :: message !! empty if there is none
    character(*), parameter :: key = "error message = '"
    integer :: first, length

    message = ""
    first = index(description, key)
    if (first == 0) return
    first = first + len(key)
    length = index(description(first:), "'") - 1
    if (length > 0) message = description(first:first + length - 1)
  end function system_message

end module mpm_hdf5_failure
