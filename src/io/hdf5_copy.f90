!> Chunks of a dataset as they are stored. Rows are copied to a dataset of the same layout in
!! another file without unpacking them. A chunk holds all columns of its rows.
! allow(assumed-size)
module mpm_hdf5_copy
  use, intrinsic :: iso_c_binding, only: c_int, c_int32_t, c_int64_t, c_loc, c_ptr, c_size_t
  use hdf5, only: h5dget_create_plist_f, h5dget_space_f, h5dset_extent_f, h5pclose_f, &
                  h5pget_chunk_f, h5sclose_f, h5sget_simple_extent_dims_f, &
                  h5sget_simple_extent_ndims_f, hid_t, hsize_t
  use mpm_kinds, only: ip
  implicit none
  private
  public :: copy_rows, dataset_rows, dataset_shape, put_chunk

  integer(c_int64_t), parameter :: default_transfer = 0_c_int64_t !! H5P_DEFAULT

  interface
    !> Bytes of a stored chunk, 0 if it is not stored.
    function h5_chunk_size(dataset, offset, n_bytes) bind(c, name="H5Dget_chunk_storage_size") &
      result(status)
      import :: c_int, c_int64_t
      implicit none
      integer(c_int64_t), value :: dataset
      integer(c_int64_t), intent(in)  :: offset(*)
      integer(c_int64_t), intent(out) :: n_bytes
      integer(c_int) :: status
    end function h5_chunk_size

    !> Reads a chunk as it is stored.
    function h5_read_chunk(dataset, transfer, offset, filters, bytes) &
      bind(c, name="H5Dread_chunk") result(status)
      import :: c_int, c_int32_t, c_int64_t
      implicit none
      integer(c_int64_t), value :: dataset, transfer
      integer(c_int64_t), intent(in)   :: offset(*)
      integer(c_int32_t), intent(out)  :: filters
      integer(c_int32_t), intent(inout) :: bytes(*)
      integer(c_int) :: status
    end function h5_read_chunk

    !> Writes a chunk as it is to be stored.
    function h5_write_chunk(dataset, transfer, filters, offset, n_bytes, bytes) &
      bind(c, name="H5Dwrite_chunk") result(status)
      import :: c_int, c_int32_t, c_int64_t, c_ptr, c_size_t
      implicit none
      integer(c_int64_t), value :: dataset, transfer
      integer(c_int32_t), value :: filters
      integer(c_int64_t), intent(in) :: offset(*)
      integer(c_size_t), value :: n_bytes
      type(c_ptr), value :: bytes
      integer(c_int) :: status
    end function h5_write_chunk
  end interface

contains

  !> Rows of a dataset of one or two dimensions.
  subroutine dataset_rows(dataset, n_rows, status)
    integer(hid_t), intent(in) :: dataset !! open
    integer(ip), intent(out)   :: n_rows  !! 0 after a failure
    integer, intent(out)       :: status  !! < 0: failed
    integer(hsize_t) :: extent(2)
    integer :: rank

    call dataset_shape(dataset, rank, extent, status)
    n_rows = 0_ip
    if (status >= 0) n_rows = int(extent(rank), ip)
  end subroutine dataset_rows

  !> Gives a dataset the first rows of another one. Its own rows, which the other one begins with,
  !! are not read again but for those of an incomplete chunk.
  subroutine copy_rows(from, to, n_rows, status)
    integer(hid_t), intent(in) :: from   !! open, has n_rows rows or more
    integer(hid_t), intent(in) :: to     !! open, has n_rows rows or fewer; the same layout
    integer(ip), intent(in)    :: n_rows !! that it shall have
    integer, intent(out)       :: status !! < 0: failed
    integer(hsize_t) :: chunk(2), extent(2)
    integer(hid_t)   :: properties
    integer(ip) :: first
    integer :: rank

    call dataset_shape(to, rank, extent, status)
    if (status < 0) return
    call h5dget_create_plist_f(to, properties, status)
    if (status < 0) return
    call h5pget_chunk_f(properties, rank, chunk(:rank), status)
    call h5pclose_f(properties, status)
    if (status < 0) return
    first = int(extent(rank)/chunk(rank)*chunk(rank), ip)
    extent(rank) = int(n_rows, hsize_t)
    call h5dset_extent_f(to, extent(:rank), status)
    do while (first < n_rows .and. status >= 0)
      call copy_chunk(from, to, first, status)
      first = first + int(chunk(rank), ip)
    end do
  end subroutine copy_rows

  !> Copies the chunk that begins with a row.
  subroutine copy_chunk(from, to, first, status)
    integer(hid_t), intent(in) :: from   !! open
    integer(hid_t), intent(in) :: to     !! open
    integer(ip), intent(in)    :: first  !! number of the row, from 0
    integer, intent(out)       :: status !! < 0: failed
    integer(c_int32_t), allocatable, target :: bytes(:)
    integer(c_int64_t) :: n_bytes, offset(2)
    integer(c_int32_t) :: filters
    character(80) :: reason
    integer :: problem

    offset = [int(first, c_int64_t), 0_c_int64_t] ! in the order of C
    status = int(h5_chunk_size(from, offset, n_bytes))
    if (status < 0 .or. n_bytes == 0_c_int64_t) return
    allocate (bytes((n_bytes + 3_c_int64_t)/4_c_int64_t), stat=problem, errmsg=reason)
    if (problem /= 0) then
      status = -1
      return
    end if
    status = int(h5_read_chunk(from, default_transfer, offset, filters, bytes))
    if (status < 0) return
    status = int(h5_write_chunk(to, default_transfer, filters, offset, int(n_bytes, c_size_t), &
                                c_loc(bytes)))
  end subroutine copy_chunk

  !> Stores a chunk that has been through all filters.
  subroutine put_chunk(dataset, first, bytes, n_bytes, status)
    integer(hid_t), intent(in) :: dataset       !! open, its extent covers the chunk
    integer(ip), intent(in)    :: first         !! number of its first row, from 0
    type(c_ptr), intent(in)    :: bytes         !! as they are to be stored
    integer(ip), intent(in)    :: n_bytes       !! that count
    integer, intent(out)       :: status        !! < 0: failed
    integer(c_int32_t), parameter :: all_filters = 0_c_int32_t
    integer(c_int64_t) :: offset(2)

    offset = [int(first, c_int64_t), 0_c_int64_t] ! in the order of C
    status = int(h5_write_chunk(dataset, default_transfer, all_filters, offset, &
                                int(n_bytes, c_size_t), bytes))
  end subroutine put_chunk

  !> Extents of a dataset, in the order of Fortran: rows are last.
  subroutine dataset_shape(dataset, rank, extent, status)
    integer(hid_t), intent(in)    :: dataset   !! open
    integer, intent(out)          :: rank      !! 1 or 2
    integer(hsize_t), intent(out) :: extent(2) !! the first rank count
    integer, intent(out)          :: status    !! < 0: failed, or another rank
    integer(hsize_t) :: largest(2)
    integer(hid_t)   :: space
    integer :: ignored

    rank = 1
    extent = 0_hsize_t
    call h5dget_space_f(dataset, space, status)
    if (status < 0) return
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (status >= 0 .and. (rank < 1 .or. rank > 2)) status = -1
    if (status >= 0) call h5sget_simple_extent_dims_f(space, extent(:rank), largest(:rank), status)
    call h5sclose_f(space, ignored)
    if (status < 0) rank = 1
  end subroutine dataset_shape

end module mpm_hdf5_copy
