!> Texts and attributes of HDF5 files, by the identifiers of HDF5.
module mpm_hdf5_attribute
  use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
  use hdf5, only: h5aclose_f, h5acreate_f, h5aexists_f, h5aget_type_f, h5aopen_f, h5aread_f, &
                  h5awrite_f, h5dclose_f, h5dcreate_f, h5dwrite_f, h5kind_to_type, h5oclose_f, &
                  h5oopen_f, h5s_scalar_f, h5sclose_f, h5screate_f, h5screate_simple_f, h5t_c_s1, &
                  h5t_cset_ascii_f, h5t_cset_utf8_f, h5t_std_i64le, h5t_str_nullpad_f, &
                  h5tclose_f, h5tcopy_f, h5tget_size_f, h5tis_variable_str_f, h5tset_cset_f, &
                  h5tset_size_f, h5tset_strpad_f, h5_integer_kind, hid_t, hsize_t, size_t
  use mpm_kinds, only: ip
  implicit none
  private
  public :: get_text_attribute, put_integers_attribute, put_text, put_text_attribute

  integer, parameter :: longest_text = 1000 !! of an attribute that is read [bytes]

contains

  !> Writes a text as a scalar dataset of fixed length, UTF-8.
  subroutine put_text(file, name, text, status)
    integer(hid_t), intent(in) :: file !! open
    character(*), intent(in) :: name   !! absolute path of the dataset
    character(*), intent(in) :: text   !! any length
    integer, intent(out) :: status     !! < 0: failed
    character(kind=c_char), allocatable, target :: letters(:)
    integer(hid_t) :: id, space, type_id

    allocate (letters(max(1, len(text))))
    letters(:) = letters_of(text)
    call make_text_type(type_id, size(letters), h5t_cset_utf8_f, status)
    if (status >= 0) call h5screate_f(h5s_scalar_f, space, status)
    if (status >= 0) call h5dcreate_f(file, name, type_id, space, id, status)
    if (status >= 0) call h5dwrite_f(id, type_id, c_loc(letters), status)
    if (status >= 0) call h5dclose_f(id, status)
    if (status >= 0) call h5sclose_f(space, status)
    if (status >= 0) call h5tclose_f(type_id, status)
  end subroutine put_text

  !> Writes a text as an attribute of fixed length, ASCII.
  subroutine put_text_attribute(file, object, name, text, status)
    integer(hid_t), intent(in) :: file !! open
    character(*), intent(in) :: object !! absolute path of a group
    character(*), intent(in) :: name   !! of the attribute
    character(*), intent(in) :: text   !! short text
    integer, intent(out) :: status     !! < 0: failed
    character(kind=c_char), allocatable, target :: letters(:)
    integer(hid_t) :: attribute, id, space, type_id

    allocate (letters(max(1, len(text))))
    letters(:) = letters_of(text)
    call make_text_type(type_id, size(letters), h5t_cset_ascii_f, status)
    if (status >= 0) call h5oopen_f(file, object, id, status)
    if (status >= 0) call h5screate_f(h5s_scalar_f, space, status)
    if (status >= 0) call h5acreate_f(id, name, type_id, space, attribute, status)
    if (status >= 0) call h5awrite_f(attribute, type_id, c_loc(letters), status)
    if (status >= 0) call h5aclose_f(attribute, status)
    if (status >= 0) call h5sclose_f(space, status)
    if (status >= 0) call h5oclose_f(id, status)
    if (status >= 0) call h5tclose_f(type_id, status)
  end subroutine put_text_attribute

  !> Reads a text of fixed length from an attribute.
  subroutine get_text_attribute(file, object, name, text, status)
    integer(hid_t), intent(in) :: file !! open
    character(*), intent(in) :: object !! absolute path of a group
    character(*), intent(in) :: name   !! of the attribute
    character(:), allocatable, intent(out) :: text !! empty after a failure
    integer, intent(out) :: status     !! < 0: not there, or no such text
    integer(hid_t)  :: attribute, id
    integer :: ignored

    text = ""
    call h5oopen_f(file, object, id, status)
    if (status < 0) return
    call h5aopen_f(id, name, attribute, status)
    if (status >= 0) then
      call read_letters(attribute, text, status)
      call h5aclose_f(attribute, ignored)
    end if
    call h5oclose_f(id, ignored)
  end subroutine get_text_attribute

  !> Reads the text of an attribute.
  subroutine read_letters(attribute, text, status)
    integer(hid_t), intent(in) :: attribute          !! open
    character(:), allocatable, intent(inout) :: text !! what it holds
    integer, intent(out) :: status                   !! < 0: no text of fixed length
    character(kind=c_char), allocatable, target :: letters(:)
    type(c_ptr) :: address
    integer(hid_t) :: type_id
    integer :: i, ignored, length

    call find_length(attribute, length, status)
    if (status < 0) return
    allocate (letters(length))
    letters = achar(0)
    call make_text_type(type_id, length, h5t_cset_ascii_f, status)
    if (status < 0) return
    address = c_loc(letters)
    call h5aread_f(attribute, type_id, address, status)
    call h5tclose_f(type_id, ignored)
    if (status < 0) return
    do i = 1, length
      if (letters(i) /= achar(0)) text = text//letters(i)
    end do
  end subroutine read_letters

  !> Length of the text of an attribute.
  subroutine find_length(attribute, length, status)
    integer(hid_t), intent(in) :: attribute !! open
    integer, intent(out) :: length          !! bytes
    integer, intent(out) :: status          !! < 0: no text of fixed length, or a long one
    integer(hid_t)  :: type_id
    integer(size_t) :: n_bytes
    integer :: ignored
    logical :: is_variable

    length = 0
    call h5aget_type_f(attribute, type_id, status)
    if (status < 0) return
    call h5tis_variable_str_f(type_id, is_variable, status)
    if (status >= 0) call h5tget_size_f(type_id, n_bytes, status)
    call h5tclose_f(type_id, ignored)
    if (status < 0) return
    if (is_variable .or. n_bytes > longest_text) status = -1
    if (status >= 0) length = int(n_bytes)
  end subroutine find_length

  !> Writes integers as an attribute: a scalar if there is one. An attribute of that name and
  !! shape is overwritten.
  subroutine put_integers_attribute(file, object, name, values, status)
    integer(hid_t), intent(in) :: file   !! open
    character(*), intent(in) :: object   !! absolute path of a group
    character(*), intent(in) :: name     !! of the attribute
    integer(ip), intent(in) :: values(:) !! one or more
    integer, intent(out) :: status       !! < 0: failed
    integer(ip), allocatable, target :: buffer(:)
    integer(hid_t) :: attribute, id
    logical :: exists

    allocate (buffer(size(values)))
    buffer(:) = values
    call h5oopen_f(file, object, id, status)
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
    if (status >= 0) call h5aclose_f(attribute, status)
    if (status >= 0) call h5oclose_f(id, status)
  end subroutine put_integers_attribute

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

end module mpm_hdf5_attribute
