!> Reads datasets and attributes of HDF5 files back.
module hdf5_samples
  use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
  use hdf5, only: h5aclose_f, h5aopen_f, h5aread_f, h5dclose_f, h5dget_space_f, h5dget_type_f, &
                  h5dopen_f, h5dread_f, h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, h5kind_to_type, &
                  h5lexists_f, h5oclose_f, h5oopen_f, h5open_f, h5sclose_f, h5sget_simple_extent_npoints_f, &
                  h5tclose_f, h5tget_size_f, h5_integer_kind, h5_real_kind, hid_t, hsize_t, size_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: attribute_of, has_object, integers_of, reals_of, text_of

contains

  !> All numbers of a dataset, in the order of the file.
  function reals_of(path, name) result(values)
    character(*), intent(in) :: path, name
    real(dp), allocatable :: values(:)
    real(dp), allocatable, target :: buffer(:)
    type(c_ptr) :: address
    integer(hid_t) :: file, id
    integer(hsize_t) :: n
    integer :: status

    call open_dataset(path, name, file, id, n)
    allocate (buffer(n), source=-999.0_dp)
    address = c_loc(buffer)
    if (n > 0) call h5dread_f(id, h5kind_to_type(dp, h5_real_kind), address, status)
    call h5dclose_f(id, status)
    call h5fclose_f(file, status)
    call move_alloc(buffer, values)
  end function reals_of

  !> All numbers of a dataset of integers.
  function integers_of(path, name) result(values)
    character(*), intent(in) :: path, name
    integer, allocatable :: values(:)
    real(dp), allocatable :: buffer(:)

    buffer = reals_of(path, name)
    allocate (values(size(buffer)))
    values(:) = nint(buffer)
  end function integers_of

  !> A scalar dataset of text.
  function text_of(path, name) result(text)
    character(*), intent(in) :: path, name
    character(:), allocatable :: text
    character(kind=c_char), allocatable, target :: letters(:)
    type(c_ptr) :: address
    integer(hid_t) :: file, id, type_id
    integer(hsize_t) :: n
    integer(size_t)  :: length
    integer :: i, status

    call open_dataset(path, name, file, id, n)
    call h5dget_type_f(id, type_id, status)
    call h5tget_size_f(type_id, length, status)
    allocate (letters(length))
    address = c_loc(letters)
    call h5dread_f(id, type_id, address, status)
    call h5tclose_f(type_id, status)
    call h5dclose_f(id, status)
    call h5fclose_f(file, status)
    text = repeat(" ", int(length))
    do i = 1, int(length)
      text(i:i) = letters(i)
    end do
  end function text_of

  !> A scalar attribute of integers, -999 if it cannot be read.
  function attribute_of(path, object, name) result(number)
    character(*), intent(in) :: path, object, name
    integer :: number
    integer(ip), target :: value
    type(c_ptr) :: address
    integer(hid_t) :: attribute, file, id
    integer :: status

    value = -999_ip
    call h5open_f(status)
    call h5fopen_f(path, h5f_acc_rdonly_f, file, status)
    call h5oopen_f(file, object, id, status)
    call h5aopen_f(id, name, attribute, status)
    address = c_loc(value)
    call h5aread_f(attribute, h5kind_to_type(ip, h5_integer_kind), address, status)
    call h5aclose_f(attribute, status)
    call h5oclose_f(id, status)
    call h5fclose_f(file, status)
    number = int(value)
  end function attribute_of

  !> Whether a file has an object below its root group.
  function has_object(path, name) result(yes)
    character(*), intent(in) :: path, name
    logical :: yes
    integer(hid_t) :: file
    integer :: status

    call h5open_f(status)
    call h5fopen_f(path, h5f_acc_rdonly_f, file, status)
    yes = .false.
    if (status < 0) return
    call h5lexists_f(file, name, yes, status)
    call h5fclose_f(file, status)
  end function has_object

  !> Opens a dataset and counts its numbers.
  subroutine open_dataset(path, name, file, id, n)
    character(*), intent(in) :: path, name
    integer(hid_t), intent(out) :: file, id
    integer(hsize_t), intent(out) :: n
    integer(hid_t) :: space
    integer :: status

    call h5open_f(status)
    call h5fopen_f(path, h5f_acc_rdonly_f, file, status)
    call h5dopen_f(file, name, id, status)
    call h5dget_space_f(id, space, status)
    call h5sget_simple_extent_npoints_f(space, n, status)
    call h5sclose_f(space, status)
  end subroutine open_dataset

end module hdf5_samples
