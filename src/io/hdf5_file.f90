!> HDF5 files for writing, with their groups, texts and attributes.
!!
!! Every procedure but create_hdf5_file returns at once when `error` is set already, so that a
!! sequence of calls needs one check at its end.
module mpm_hdf5_file
  use, intrinsic :: iso_c_binding, only: c_char, c_loc
  use hdf5, only: h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_f, h5awrite_f, h5dclose_f, &
                  h5dcreate_f, h5dont_atexit_f, h5dwrite_f, h5eset_auto_f, h5f_acc_trunc_f, &
                  h5f_scope_local_f, h5fclose_f, h5fcreate_f, h5fflush_f, h5gclose_f, &
                  h5gcreate_f, h5kind_to_type, h5oclose_f, h5oopen_f, h5open_f, h5s_scalar_f, &
                  h5sclose_f, h5screate_f, h5screate_simple_f, h5t_c_s1, h5t_cset_ascii_f, &
                  h5t_cset_utf8_f, h5t_std_i64le, h5t_str_nullpad_f, h5tclose_f, h5tcopy_f, &
                  h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, h5_integer_kind, hid_t, hsize_t, &
                  size_t
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_hdf5_failure, only: hdf5_failure
  use mpm_kinds, only: ip
  implicit none
  private
  public :: hdf5_file_t, close_hdf5_file, create_hdf5_file, flush_hdf5_file, make_group
  public :: write_integers_attribute, write_text, write_text_attribute

  !> An open HDF5 file.
  type :: hdf5_file_t
    character(:), allocatable :: path
    integer(hid_t) :: id = -1_hid_t
    logical :: is_open = .false.
  end type hdf5_file_t

contains

  !> Creates a file; what was in it is lost. HDF5 prints nothing by itself from then on, and does
  !! not try to close a file at the end of the program that could not be written.
  subroutine create_hdf5_file(file, path, error)
    type(hdf5_file_t), intent(out) :: file           !! open
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer :: status

    file%path = path
    call h5dont_atexit_f(status)
    call h5open_f(status)
    if (status < 0) then
      call make_error(error, exit_file, "error: HDF5 cannot be started")
      return
    end if
    call h5eset_auto_f(0, status)
    call h5fcreate_f(path, h5f_acc_trunc_f, file%id, status)
    file%is_open = status >= 0
    if (status < 0) call hdf5_failure(error, path, "create")
  end subroutine create_hdf5_file

  !> Hands everything written so far to the operating system.
  subroutine flush_hdf5_file(file, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file, for example a full disk
    integer :: status

    if (allocated(error)) return
    call h5fflush_f(file%id, h5f_scope_local_f, status)
    if (status < 0) call hdf5_failure(error, file%path, "write")
  end subroutine flush_hdf5_file

  !> Closes a file whose datasets are closed; no effect on a closed one.
  subroutine close_hdf5_file(file, error)
    type(hdf5_file_t), intent(inout) :: file           !! closed
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: status

    if (.not. file%is_open) return
    file%is_open = .false.
    call h5fclose_f(file%id, status)
    if (status < 0 .and. .not. allocated(error)) call hdf5_failure(error, file%path, "close")
  end subroutine close_hdf5_file

  !> Creates a group.
  subroutine make_group(file, name, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    character(*), intent(in) :: name                   !! absolute path of the group
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t) :: id
    integer :: status

    if (allocated(error)) return
    call h5gcreate_f(file%id, name, id, status)
    if (status >= 0) call h5gclose_f(id, status)
    if (status < 0) call hdf5_failure(error, file%path, "write")
  end subroutine make_group

  !> Writes a text as a scalar dataset of fixed length, UTF-8.
  subroutine write_text(file, name, text, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    character(*), intent(in) :: name                   !! absolute path of the dataset
    character(*), intent(in) :: text                   !! any length
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(kind=c_char), allocatable, target :: letters(:)
    integer(hid_t) :: id, space, type_id
    integer :: status

    if (allocated(error)) return
    allocate (letters(max(1, len(text))))
    letters(:) = letters_of(text)
    call make_text_type(type_id, size(letters), h5t_cset_utf8_f, status)
    if (status >= 0) call h5screate_f(h5s_scalar_f, space, status)
    if (status >= 0) call h5dcreate_f(file%id, name, type_id, space, id, status)
    if (status >= 0) call h5dwrite_f(id, type_id, c_loc(letters), status)
    if (status < 0) then
      call hdf5_failure(error, file%path, "write")
      return
    end if
    call h5dclose_f(id, status)
    call h5sclose_f(space, status)
    call h5tclose_f(type_id, status)
  end subroutine write_text

  !> Writes a text as an attribute of fixed length, ASCII as the VTKHDF format wants it.
  subroutine write_text_attribute(file, object, name, text, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    character(*), intent(in) :: object                 !! absolute path of a group
    character(*), intent(in) :: name                   !! of the attribute
    character(*), intent(in) :: text                   !! short text
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(kind=c_char), allocatable, target :: letters(:)
    integer(hid_t) :: attribute, id, space, type_id
    integer :: status

    if (allocated(error)) return
    allocate (letters(max(1, len(text))))
    letters(:) = letters_of(text)
    call make_text_type(type_id, size(letters), h5t_cset_ascii_f, status)
    if (status >= 0) call h5oopen_f(file%id, object, id, status)
    if (status >= 0) call h5screate_f(h5s_scalar_f, space, status)
    if (status >= 0) call h5acreate_f(id, name, type_id, space, attribute, status)
    if (status >= 0) call h5awrite_f(attribute, type_id, c_loc(letters), status)
    if (status < 0) then
      call hdf5_failure(error, file%path, "write")
      return
    end if
    call h5aclose_f(attribute, status)
    call h5sclose_f(space, status)
    call h5oclose_f(id, status)
    call h5tclose_f(type_id, status)
  end subroutine write_text_attribute

  !> Writes integers as an attribute: a scalar if there is one. An attribute of that name and
  !! shape is overwritten.
  subroutine write_integers_attribute(file, object, name, values, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    character(*), intent(in) :: object                 !! absolute path of a group
    character(*), intent(in) :: name                   !! of the attribute
    integer(ip), intent(in)  :: values(:)              !! one or more
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(ip), allocatable, target :: buffer(:)
    integer(hid_t) :: attribute, id
    integer :: status
    logical :: exists

    if (allocated(error)) return
    allocate (buffer(size(values)))
    buffer(:) = values
    call h5oopen_f(file%id, object, id, status)
    if (status >= 0) call h5aexists_f(id, name, exists, status)
    if (status >= 0) then
      if (exists) then
        call h5aopen_f(id, name, attribute, status)
      else
        call create_integers_attribute(id, name, size(values), attribute, status)
      end if
    end if
    if (status >= 0) then
      call h5awrite_f(attribute, h5kind_to_type(ip, h5_integer_kind), c_loc(buffer), status)
    end if
    if (status < 0) then
      call hdf5_failure(error, file%path, "write")
      return
    end if
    call h5aclose_f(attribute, status)
    call h5oclose_f(id, status)
  end subroutine write_integers_attribute

  !> Creates an attribute of 64-bit integers.
  subroutine create_integers_attribute(id, name, n, attribute, status)
    integer(hid_t), intent(in)  :: id        !! object
    character(*), intent(in)    :: name      !! of the attribute
    integer, intent(in)         :: n         !! 1: scalar
    integer(hid_t), intent(out) :: attribute !! open
    integer, intent(out)        :: status    !! < 0: failed
    integer(hid_t) :: space

    if (n == 1) then
      call h5screate_f(h5s_scalar_f, space, status)
    else
      call h5screate_simple_f(1, [int(n, hsize_t)], space, status)
    end if
    if (status >= 0) call h5acreate_f(id, name, h5t_std_i64le, space, attribute, status)
    if (status >= 0) call h5sclose_f(space, status)
  end subroutine create_integers_attribute

  !> Type of a text of fixed length, padded with null characters.
  subroutine make_text_type(type_id, length, character_set, status)
    integer(hid_t), intent(out) :: type_id !! to be closed by the caller
    integer, intent(in)  :: length         !! bytes, at least 1
    integer, intent(in)  :: character_set  !! of HDF5
    integer, intent(out) :: status         !! < 0: failed

    call h5tcopy_f(h5t_c_s1, type_id, status)
    if (status >= 0) call h5tset_size_f(type_id, int(length, size_t), status)
    if (status >= 0) call h5tset_strpad_f(type_id, h5t_str_nullpad_f, status)
    if (status >= 0) call h5tset_cset_f(type_id, character_set, status)
  end subroutine make_text_type

  !> The letters of a text, a null character if it is empty.
  pure function letters_of(text) result(letters)
    character(*), intent(in) :: text
    character(kind=c_char) :: letters(max(1, len(text)))
    integer :: i

    letters = achar(0)
    do i = 1, len(text)
      letters(i) = text(i:i)
    end do
  end function letters_of

end module mpm_hdf5_file
