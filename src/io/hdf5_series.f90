!> HDF5 datasets that grow by rows.
!!
!! They are open as long as their file. Every procedure returns at once when `error` is set already.
! allow(assumed-size)
module mpm_hdf5_series
  use, intrinsic :: iso_c_binding, only: c_float, c_int32_t, c_loc, c_null_ptr, c_ptr
  use hdf5, only: h5dcreate_f, h5dget_space_f, h5dset_extent_f, h5dwrite_f, &
                  h5kind_to_type, h5p_dataset_create_f, h5pclose_f, h5pcreate_f, h5pset_chunk_f, &
                  h5pset_deflate_f, h5pset_shuffle_f, h5s_select_set_f, h5s_unlimited_f, &
                  h5sclose_f, h5screate_simple_f, h5sselect_hyperslab_f, h5t_ieee_f32le, &
                  h5t_ieee_f64le, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, h5_integer_kind, &
                  h5_real_kind, hid_t, hsize_t
  use mpm_chunk_packing, only: pack_chunk
  use mpm_error, only: error_t
  use mpm_hdf5_copy, only: put_chunk
  use mpm_hdf5_file, only: add_dataset, check_writable, fail_hdf5_file, hdf5_file_t, &
                           note_rows, open_dataset
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: series_layout_t, series_t, append_rows, create_series, row_count
  public :: kind_float32, kind_float64, kind_int32, kind_int64, kind_uint8

  integer, parameter :: kind_float64 = 1
  integer, parameter :: kind_int32 = 2
  integer, parameter :: kind_int64 = 3
  integer, parameter :: kind_uint8 = 4
  integer, parameter :: kind_float32 = 5
  logical, parameter :: is_little_endian = iachar(transfer(1_ip, "a")) == 1 !! as the files are
  integer, parameter :: deflate_level = 1 !! nearly twice as fast as 4, files hardly larger

  !> How the rows of a dataset are stored.
  type :: series_layout_t
    integer :: kind = kind_float64     !! kind_*
    integer :: n_columns = 0           !! 0: a row is a scalar, the dataset has one dimension
    integer :: chunk_rows = 256        !! rows stored together
    logical :: compressed = .false.    !! shuffle and deflate
  end type series_layout_t

  !> A dataset.
  type :: series_t
    type(series_layout_t) :: layout
    integer :: number = 0 !! in the list of its file, 0 = not created
  end type series_t

  !> Rows on their way into a dataset.
  type :: rows_t
    integer(hid_t) :: memory_type = -1_hid_t     !! of the plain values
    type(c_ptr)    :: plain = c_null_ptr         !! the values, row by row
    integer(c_int32_t), allocatable :: packed(:) !! the chunk that they are, as it is stored
    integer(ip)    :: n_bytes = 0_ip             !! of it, 0: HDF5 packs, if anybody does
    integer(ip)    :: n_plain = 0_ip             !! bytes of the values if they are the chunk
  end type rows_t

  !> Appends rows of reals or of integers.
  interface append_rows
    module procedure append_reals, append_real_rows, append_integers, append_indices
  end interface append_rows

contains

  !> Creates a dataset without rows.
  subroutine create_series(series, file, name, layout, error)
    type(series_t), intent(out) :: series              !! ready for append_rows
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path of the dataset
    type(series_layout_t), intent(in) :: layout        !! of its rows
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t)   :: id, properties, space
    integer(hsize_t) :: first(2), largest(2), chunk(2)
    integer :: rank, status

    call check_writable(file, error)
    if (allocated(error)) return
    series%layout = layout
    rank = merge(1, 2, layout%n_columns == 0)
    first = row_shape(layout, 0_hsize_t)
    largest = row_shape(layout, h5s_unlimited_f)
    chunk = row_shape(layout, int(max(1, layout%chunk_rows), hsize_t))
    call h5screate_simple_f(rank, first(:rank), space, status, largest(:rank))
    if (status >= 0) call h5pcreate_f(h5p_dataset_create_f, properties, status)
    if (status >= 0) call h5pset_chunk_f(properties, rank, chunk(:rank), status)
    if (layout%compressed) then
      if (status >= 0) call h5pset_shuffle_f(properties, status)
      if (status >= 0) call h5pset_deflate_f(properties, deflate_level, status)
    end if
    if (status >= 0) then
      call h5dcreate_f(file%id, name, stored_type(layout%kind), space, id, status, &
                       properties)
    end if
    if (status < 0) then
      call fail_hdf5_file(file, "write", error)
      return
    end if
    call add_dataset(file, name, id, series%number)
    call h5pclose_f(properties, status)
    call h5sclose_f(space, status)
  end subroutine create_series

  !> Appends scalar rows of reals.
  subroutine append_reals(series, file, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    real(dp), intent(in) :: values(:)                  !! (n_rows)
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    call write_reals(series, file, size(values), values, error)
  end subroutine append_reals

  !> Appends rows of several reals.
  subroutine append_real_rows(series, file, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    real(dp), intent(in) :: values(:, :)               !! (n_columns, n_rows)
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    call write_reals(series, file, size(values, 2), values, error)
  end subroutine append_real_rows

  !> Appends scalar rows of integers.
  subroutine append_integers(series, file, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    integer(ip), intent(in) :: values(:)               !! (n_rows)
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(ip), parameter :: largest = int(huge(0_c_int32_t), ip), least = -largest - 1_ip
    integer(ip), allocatable, target :: buffer(:)
    type(rows_t) :: rows

    call check_writable(file, error)
    if (allocated(error)) return
    if (series%layout%kind == kind_int32) then ! HDF5 would clear a megabyte to convert a number
      call append_indices(series, file, int(max(least, min(largest, values)), c_int32_t), error)
      return
    end if
    allocate (buffer(size(values)))
    buffer(:) = values
    rows%memory_type = h5kind_to_type(ip, h5_integer_kind)
    rows%plain = c_loc(buffer)
    call write_rows(series, file, size(values), rows, error)
  end subroutine append_integers

  !> Appends scalar rows of indices.
  subroutine append_indices(series, file, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    integer(c_int32_t), intent(in) :: values(:)        !! (n_rows)
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    call write_indices(series, file, size(values), values, error)
  end subroutine append_indices

  !> Writes indices behind the last row.
  subroutine write_indices(series, file, n_rows, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    integer, intent(in) :: n_rows                      !! rows in values
    integer(c_int32_t), intent(in), target :: values(*) !! row by row
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(rows_t) :: rows

    call check_writable(file, error)
    if (allocated(error)) return
    rows%memory_type = h5kind_to_type(c_int32_t, h5_integer_kind)
    rows%plain = c_loc(values)
    if (series%layout%kind == kind_int32) call fill_chunk(rows, series, file, n_rows, 4)
    call write_rows(series, file, n_rows, rows, error)
  end subroutine write_indices

  !> Writes reals behind the last row.
  subroutine write_reals(series, file, n_rows, values, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    integer, intent(in) :: n_rows                      !! rows in values
    real(dp), intent(in), target :: values(*)          !! row by row
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    real(c_float), allocatable, target :: short(:)
    type(rows_t) :: rows
    integer :: n_values

    call check_writable(file, error)
    if (allocated(error)) return
    if (series%layout%kind == kind_float32) then
      n_values = n_rows*max(1, series%layout%n_columns)
      allocate (short(n_values))
      short(:) = shortened(values(:n_values))
      rows%memory_type = h5kind_to_type(c_float, h5_real_kind)
      rows%plain = c_loc(short)
    else
      rows%memory_type = h5kind_to_type(dp, h5_real_kind)
      rows%plain = c_loc(values)
    end if
    call fill_chunk(rows, series, file, n_rows, merge(4, 8, series%layout%kind == kind_float32))
    call write_rows(series, file, n_rows, rows, error)
  end subroutine write_reals

  !> A value in single precision; a number beyond its range becomes the largest one.
  elemental real(c_float) function shortened(value) result(short)
    real(dp), intent(in) :: value
    real(dp), parameter :: largest = real(huge(short), dp)

    short = real(max(-largest, min(largest, value)), c_float)
  end function shortened

  !> Writes rows behind the last one. Those that fill a chunk are stored as they are, without a copy
  !! in HDF5.
  subroutine write_rows(series, file, n_rows, rows, error)
    type(series_t), intent(in) :: series               !! grows
    type(hdf5_file_t), intent(inout) :: file           !! that holds it
    integer, intent(in) :: n_rows                      !! new rows
    type(rows_t), intent(in), target :: rows           !! as they are, perhaps also packed
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t) :: id, memory, space
    integer(ip) :: first
    integer :: status

    first = row_count(series, file)
    call grow(series, file, n_rows, id, status)
    if (status >= 0) then
      if (rows%n_bytes > 0_ip) then
        call put_chunk(id, first, c_loc(rows%packed), rows%n_bytes, status)
      else if (rows%n_plain > 0_ip) then
        call put_chunk(id, first, rows%plain, rows%n_plain, status)
      else
        call select_rows(series, id, first, n_rows, memory, space, status)
        if (status >= 0) call h5dwrite_f(id, rows%memory_type, rows%plain, status, memory, space)
        if (status >= 0) call h5sclose_f(memory, status)
        if (status >= 0) call h5sclose_f(space, status)
      end if
    end if
    if (status < 0) call fail_hdf5_file(file, "write", error)
  end subroutine write_rows

  !> Prepares values of the type of the file that fill a new chunk: packed, or to be stored as they
  !! are.
  subroutine fill_chunk(rows, series, file, n_rows, bytes_of_value)
    type(rows_t), intent(inout) :: rows   !! with plain values
    type(series_t), intent(in) :: series  !! dataset
    type(hdf5_file_t), intent(in) :: file !! that holds it
    integer, intent(in) :: n_rows         !! new rows
    integer, intent(in) :: bytes_of_value !! 4 or 8
    integer :: n_values

    if (n_rows /= series%layout%chunk_rows) return
    if (mod(row_count(series, file), int(max(1, n_rows), ip)) /= 0_ip) return
    if (.not. is_little_endian) return
    n_values = n_rows*max(1, series%layout%n_columns)
    if (series%layout%compressed) then
      call pack_chunk(rows%packed, rows%n_bytes, rows%plain, n_values, bytes_of_value)
    else
      rows%n_plain = int(n_values, ip)*int(bytes_of_value, ip)
    end if
  end subroutine fill_chunk

  !> Makes room for rows.
  subroutine grow(series, file, n_rows, id, status)
    type(series_t), intent(in) :: series     !! has n_rows rows more
    type(hdf5_file_t), intent(inout) :: file !! that holds it
    integer, intent(in) :: n_rows            !! new rows
    integer(hid_t), intent(out) :: id        !! dataset
    integer, intent(out) :: status           !! < 0: failed
    integer(hsize_t) :: total(2)
    integer(ip) :: n_after
    integer :: rank

    rank = merge(1, 2, series%layout%n_columns == 0)
    n_after = row_count(series, file) + n_rows
    total = row_shape(series%layout, int(n_after, hsize_t))
    call open_dataset(file, series%number, id, status)
    if (status >= 0) call h5dset_extent_f(id, total(:rank), status)
    if (status >= 0) call note_rows(file, series%number, n_after)
  end subroutine grow

  !> Selects rows of a dataset.
  subroutine select_rows(series, id, first, n_rows, memory, space, status)
    type(series_t), intent(in) :: series  !! dataset
    integer(hid_t), intent(in) :: id      !! of the dataset
    integer(ip), intent(in) :: first      !! number of the first row, from 0
    integer, intent(in) :: n_rows         !! rows
    integer(hid_t), intent(out) :: memory !! dataspace of the rows
    integer(hid_t), intent(out) :: space  !! dataspace of the file, the rows selected
    integer, intent(out) :: status        !! < 0: failed
    integer(hsize_t) :: begin(2), extent(2)
    integer :: rank

    rank = merge(1, 2, series%layout%n_columns == 0)
    begin = 0_hsize_t
    begin(rank) = int(first, hsize_t)
    extent = row_shape(series%layout, int(n_rows, hsize_t))
    call h5screate_simple_f(rank, extent(:rank), memory, status)
    if (status >= 0) call h5dget_space_f(id, space, status)
    if (status >= 0) then
      call h5sselect_hyperslab_f(space, h5s_select_set_f, begin(:rank), extent(:rank), status)
    end if
  end subroutine select_rows

  !> Rows of a dataset.
  pure function row_count(series, file) result(n_rows)
    type(series_t), intent(in) :: series  !! dataset
    type(hdf5_file_t), intent(in) :: file !! that holds it
    integer(ip) :: n_rows                 !! written so far, 0 if it was not created

    n_rows = 0_ip
    if (series%number > 0) n_rows = file%dataset(series%number)%n_rows
  end function row_count

  !> Extents of a number of rows, in the order of Fortran.
  pure function row_shape(layout, n_rows) result(extents)
    type(series_layout_t), intent(in) :: layout !! of the rows
    integer(hsize_t), intent(in) :: n_rows      !! rows
    integer(hsize_t) :: extents(2)              !! the first one counts if a row is a scalar

    extents = [n_rows, 1_hsize_t]
    if (layout%n_columns > 0) extents = [int(layout%n_columns, hsize_t), n_rows]
  end function row_shape

  !> Type of the numbers in the file.
  function stored_type(kind) result(type_id)
    integer, intent(in) :: kind !! kind_*
    integer(hid_t) :: type_id

    select case (kind)
    case (kind_int32)
      type_id = h5t_std_i32le
    case (kind_int64)
      type_id = h5t_std_i64le
    case (kind_uint8)
      type_id = h5t_std_u8le
    case (kind_float32)
      type_id = h5t_ieee_f32le
    case default
      type_id = h5t_ieee_f64le
    end select
  end function stored_type

end module mpm_hdf5_series
