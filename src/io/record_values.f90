!> Named values of a record file: each procedure writes what it is given, or reads it back into
!! the same place, so that one list of calls serves both ways.
!!
!! Arrays have the shape that the caller gives them; a file with another shape or type is refused,
!! so that no size of a file decides how much memory is taken. Every procedure returns at once when
!! `error` is set already.
! allow(assumed-size)
module mpm_record_values
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
  use hdf5, only: h5d_contiguous_f, h5dclose_f, h5dcreate_f, h5dget_create_plist_f, &
                  h5dget_space_f, h5dget_type_f, h5dopen_f, h5dread_f, h5dwrite_f, &
                  h5l_type_hard_f, h5lget_info_f, h5pclose_f, h5pget_external_count_f, &
                  h5pget_layout_f, h5pget_nfilters_f, h5kind_to_type, h5sclose_f, &
                  h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
                  h5t_float_f, h5t_ieee_f64le, h5t_integer_f, h5t_std_i64le, h5t_std_u8le, &
                  h5tclose_f, h5tget_class_f, h5tget_size_f, h5_integer_kind, h5_real_kind, &
                  hid_t, hsize_t, size_t
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_hdf5_failure, only: hdf5_failure
  use mpm_kinds, only: dp, ip
  use mpm_record_file, only: record_t
  implicit none
  private
  public :: exchange_integer, exchange_integers, exchange_logical, exchange_real, exchange_reals
  public :: exchange_text, refuse_value

  integer, parameter :: max_rank = 3            !! of arrays
  integer, parameter :: longest_text = 100000000 !! characters

contains

  !> A real number.
  subroutine exchange_real(record, name, value, error)
    type(record_t), intent(in) :: record               !! open
    character(*), intent(in)   :: name                 !! of the value
    real(dp), intent(inout)    :: value                !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    real(dp) :: values(1)

    values = value
    call exchange_reals(record, name, [1], values, error)
    value = values(1)
  end subroutine exchange_real

  !> An integer.
  subroutine exchange_integer(record, name, value, error)
    type(record_t), intent(in) :: record               !! open
    character(*), intent(in)   :: name                 !! of the value
    integer, intent(inout)     :: value                !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: values(1)

    values = value
    call exchange_integers(record, name, [1], values, error)
    value = values(1)
  end subroutine exchange_integer

  !> A logical.
  subroutine exchange_logical(record, name, value, error)
    type(record_t), intent(in) :: record               !! open
    character(*), intent(in)   :: name                 !! of the value
    logical, intent(inout)     :: value                !! written, or read
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: number

    number = merge(1, 0, value)
    call exchange_integer(record, name, number, error)
    if (allocated(error)) return
    if (number /= 0 .and. number /= 1) call refuse_value(record, name, "0 or 1", error)
    value = number == 1
  end subroutine exchange_logical

  !> Reals; those read are finite.
  subroutine exchange_reals(record, name, extents, values, error)
    type(record_t), intent(in) :: record               !! open
    character(*), intent(in)   :: name                 !! of the array
    integer, intent(in)        :: extents(:)           !! shape of the array
    real(dp), intent(inout), target :: values(*)       !! as many as the extents say
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t) :: memory_type
    integer(ip) :: n

    if (allocated(error)) return
    memory_type = h5kind_to_type(dp, h5_real_kind)
    if (record%writing) then
      call write_block(record, name, extents, [h5t_ieee_f64le, memory_type], c_loc(values), error)
      return
    end if
    call read_block(record, name, extents, [int(h5t_float_f, hid_t), memory_type], c_loc(values), &
                    error)
    if (allocated(error)) return
    n = product(int(extents, ip))
    if (.not. all(ieee_is_finite(values(:n)))) then
      call refuse_value(record, name, "finite numbers", error)
    end if
  end subroutine exchange_reals

  !> Integers.
  subroutine exchange_integers(record, name, extents, values, error)
    type(record_t), intent(in) :: record               !! open
    character(*), intent(in)   :: name                 !! of the array
    integer, intent(in)        :: extents(:)           !! shape of the array
    integer, intent(inout)     :: values(*)            !! as many as the extents say
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(ip), allocatable, target :: long(:)
    integer(hid_t) :: memory_type
    integer(ip) :: n

    if (allocated(error)) return
    n = product(int(extents, ip))
    allocate (long(n))
    memory_type = h5kind_to_type(ip, h5_integer_kind)
    if (record%writing) then
      long(:) = values(:n)
      call write_block(record, name, extents, [h5t_std_i64le, memory_type], c_loc(long), error)
      return
    end if
    call read_block(record, name, extents, [int(h5t_integer_f, hid_t), memory_type], c_loc(long), &
                    error)
    if (allocated(error)) return
    if (any(long < -huge(1) .or. long > huge(1))) then
      call refuse_value(record, name, "integers of 32 bits", error)
      return
    end if
    values(:n) = int(long)
  end subroutine exchange_integers

  !> A text, as bytes.
  subroutine exchange_text(record, name, text, error)
    type(record_t), intent(in) :: record                     !! open
    character(*), intent(in)   :: name                       !! of the text
    character(:), allocatable, intent(inout) :: text         !! written, or read
    type(error_t), allocatable, intent(inout) :: error       !! exit_file
    character(kind=c_char), allocatable, target :: letter(:)
    integer :: i, n

    if (allocated(error)) return
    n = 0
    if (record%writing) n = len(text)
    call exchange_integer(record, name//"_length", n, error)
    if (allocated(error)) return
    if (n < 0 .or. n > longest_text .or. (.not. record%writing .and. int(n, ip) > record%n_bytes)) then
      call refuse_value(record, name//"_length", "the length of a text", error)
      return
    end if
    allocate (letter(max(1, n)))
    letter = " "
    if (record%writing) then
      do i = 1, n
        letter(i) = text(i:i)
      end do
      call write_block(record, name, [size(letter)], [h5t_std_u8le, h5t_std_u8le], c_loc(letter), &
                       error)
      return
    end if
    call read_block(record, name, [size(letter)], [int(h5t_integer_f, hid_t), h5t_std_u8le], &
                    c_loc(letter), error)
    if (allocated(error)) return
    text = repeat(" ", n)
    do i = 1, n
      text(i:i) = letter(i)
    end do
  end subroutine exchange_text

  !> Writes an array.
  subroutine write_block(record, name, extents, types, address, error)
    type(record_t), intent(in) :: record             !! open for writing
    character(*), intent(in)   :: name               !! of the array
    integer, intent(in)        :: extents(:)         !! shape
    integer(hid_t), intent(in) :: types(2)           !! in the file, in memory
    type(c_ptr), intent(in)    :: address            !! of the values
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer(hid_t) :: dataset, space
    integer :: status

    call h5screate_simple_f(size(extents), int(extents, hsize_t), space, status)
    if (status >= 0) call h5dcreate_f(record%id, name, types(1), space, dataset, status)
    if (status >= 0 .and. all(extents > 0)) call h5dwrite_f(dataset, types(2), address, status)
    if (status < 0) then
      call hdf5_failure(error, record%path, "write")
      return
    end if
    call h5dclose_f(dataset, status)
    if (status < 0) call hdf5_failure(error, record%path, "write")
    call h5sclose_f(space, status)
  end subroutine write_block

  !> Reads an array of a known shape and kind.
  subroutine read_block(record, name, extents, kinds, address, error)
    type(record_t), intent(in) :: record             !! open for reading
    character(*), intent(in)   :: name               !! of the array
    integer, intent(in)        :: extents(:)         !! shape expected
    integer(hid_t), intent(in) :: kinds(2)           !! class in the file, type in memory
    type(c_ptr), intent(in)    :: address            !! of the values
    type(error_t), allocatable, intent(out) :: error !! exit_file: not there, other shape or class
    integer(hid_t) :: dataset
    type(c_ptr) :: buffer
    integer :: status
    logical :: fits

    status = -1
    if (is_in_file(record%id, name)) call h5dopen_f(record%id, name, dataset, status)
    if (status < 0) then
      call refuse_value(record, name, "to be there", error)
      return
    end if
    fits = has_shape(dataset, extents) .and. has_class(dataset, int(kinds(1))) .and. &
           is_stored_plainly(dataset)
    if (.not. fits) then
      call refuse_value(record, name, "the shape and the type that the deck gives it", error)
    else if (all(extents > 0)) then
      buffer = address
      call h5dread_f(dataset, kinds(2), buffer, status)
      if (status < 0) call hdf5_failure(error, record%path, "read")
    end if
    call h5dclose_f(dataset, status)
  end subroutine read_block

  !> Whether a name stands for an object of the file itself, not of another one.
  function is_in_file(file, name) result(is_there)
    integer(hid_t), intent(in) :: file !! open
    character(*), intent(in)   :: name !! of a dataset
    logical :: is_there
    integer(hsize_t) :: address
    integer(size_t)  :: length
    integer :: character_set, order, link_type, status
    logical :: is_ordered

    call h5lget_info_f(file, name, character_set, order, is_ordered, link_type, address, length, &
                       status)
    is_there = status >= 0
    if (is_there) is_there = link_type == h5l_type_hard_f
  end function is_in_file

  !> Whether the values of a dataset lie in the file itself as they are: not in other files, nor
  !! behind a filter.
  function is_stored_plainly(dataset) result(is_plain)
    integer(hid_t), intent(in) :: dataset !! open
    logical :: is_plain
    integer(hid_t) :: properties
    integer :: layout, n_external, n_filters, status

    is_plain = .false.
    call h5dget_create_plist_f(dataset, properties, status)
    if (status < 0) return
    call h5pget_layout_f(properties, layout, status)
    if (status >= 0) call h5pget_external_count_f(properties, n_external, status)
    if (status >= 0) call h5pget_nfilters_f(properties, n_filters, status)
    if (status >= 0) is_plain = layout == h5d_contiguous_f .and. n_external == 0 .and. &
                                n_filters == 0
    call h5pclose_f(properties, status)
  end function is_stored_plainly

  !> Whether a dataset has a shape.
  function has_shape(dataset, extents) result(fits)
    integer(hid_t), intent(in) :: dataset    !! open
    integer, intent(in)        :: extents(:) !! expected
    logical :: fits
    integer(hsize_t) :: found(max_rank), largest(max_rank)
    integer(hid_t) :: space
    integer :: rank, status

    fits = .false.
    call h5dget_space_f(dataset, space, status)
    if (status < 0) return
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (status >= 0 .and. rank == size(extents)) then
      call h5sget_simple_extent_dims_f(space, found(:rank), largest(:rank), status)
      if (status >= 0) fits = all(found(:rank) == extents)
    end if
    call h5sclose_f(space, status)
  end function has_shape

  !> Whether the values of a dataset are of a class, with at most eight bytes each.
  function has_class(dataset, class) result(fits)
    integer(hid_t), intent(in) :: dataset !! open
    integer, intent(in)        :: class   !! of HDF5
    logical :: fits
    integer(hid_t)  :: type_id
    integer(size_t) :: length
    integer :: found, status

    fits = .false.
    call h5dget_type_f(dataset, type_id, status)
    if (status < 0) return
    call h5tget_class_f(type_id, found, status)
    if (status >= 0) call h5tget_size_f(type_id, length, status)
    if (status >= 0) fits = found == class .and. length <= 8_size_t
    call h5tclose_f(type_id, status)
  end function has_class

  !> Refuses a file for one of its values.
  subroutine refuse_value(record, name, expected, error)
    type(record_t), intent(in) :: record             !! open
    character(*), intent(in)   :: name               !! of the value
    character(*), intent(in)   :: expected           !! what it should be
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call make_error(error, exit_file, "error: restart file '"//record%path//"' does not fit: "// &
                    name//": expected "//expected)
  end subroutine refuse_value

end module mpm_record_values
