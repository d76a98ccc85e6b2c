!> A dataset that grows by few rows at a time: they wait in memory and are written together.
module mpm_row_buffer
  use mpm_error, only: error_t
  use mpm_hdf5_file, only: hdf5_file_t
  use mpm_hdf5_series, only: append_rows, create_series, kind_float64, series_layout_t, series_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: row_buffer_t, add_waiting, create_buffer, hold_rows, write_buffer

  integer, parameter :: first_capacity = 64 !! rows

  !> A dataset and the rows that wait.
  type :: row_buffer_t
    type(series_t) :: series
    integer :: n_waiting = 0                   !! rows
    real(dp), allocatable :: reals(:, :)       !! (n_columns, capacity) rows of reals
    integer(ip), allocatable :: integers(:, :) !! (1, capacity)         rows of integers
  end type row_buffer_t

  !> Holds scalar rows of reals or of integers, or rows of several reals.
  interface hold_rows
    module procedure hold_reals, hold_real_rows, hold_integers
  end interface hold_rows

  !> Writes the rows that wait, of one dataset or of several.
  interface write_buffer
    module procedure write_one, write_several
  end interface write_buffer

  !> Adds the rows that wait, of one dataset or of several, to those that their file has.
  interface add_waiting
    module procedure add_of_one, add_of_several
  end interface add_waiting

contains

  !> Creates a dataset without rows.
  subroutine create_buffer(buffer, file, name, layout, error)
    type(row_buffer_t), intent(out) :: buffer          !! empty
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path of the dataset
    type(series_layout_t), intent(in) :: layout        !! of its rows
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    logical :: of_reals

    call create_series(buffer%series, file, name, layout, error)
    of_reals = layout%kind == kind_float64
    allocate (buffer%reals(max(1, layout%n_columns), merge(first_capacity, 0, of_reals)))
    allocate (buffer%integers(1, merge(0, first_capacity, of_reals)))
  end subroutine create_buffer

  !> Holds scalar rows of reals.
  pure subroutine hold_reals(buffer, values)
    type(row_buffer_t), intent(inout) :: buffer !! of reals; longer
    real(dp), intent(in) :: values(:)           !! (n_rows)

    call hold_real_rows(buffer, reshape(values, [1, size(values)]))
  end subroutine hold_reals

  !> Holds rows of several reals.
  pure subroutine hold_real_rows(buffer, values)
    type(row_buffer_t), intent(inout) :: buffer !! of reals; longer
    real(dp), intent(in) :: values(:, :)        !! (n_columns, n_rows)
    real(dp), allocatable :: longer(:, :)
    integer :: n

    n = buffer%n_waiting + size(values, 2)
    if (n > size(buffer%reals, 2)) then
      allocate (longer(size(buffer%reals, 1), 2*n))
      longer(:, :buffer%n_waiting) = buffer%reals(:, :buffer%n_waiting)
      call move_alloc(longer, buffer%reals)
    end if
    buffer%reals(:, buffer%n_waiting + 1:n) = values
    buffer%n_waiting = n
  end subroutine hold_real_rows

  !> Holds scalar rows of integers.
  pure subroutine hold_integers(buffer, values)
    type(row_buffer_t), intent(inout) :: buffer !! of integers; longer
    integer(ip), intent(in) :: values(:)        !! (n_rows)
    integer(ip), allocatable :: longer(:, :)
    integer :: n

    n = buffer%n_waiting + size(values)
    if (n > size(buffer%integers, 2)) then
      allocate (longer(1, 2*n))
      longer(:, :buffer%n_waiting) = buffer%integers(:, :buffer%n_waiting)
      call move_alloc(longer, buffer%integers)
    end if
    buffer%integers(1, buffer%n_waiting + 1:n) = values
    buffer%n_waiting = n
  end subroutine hold_integers

  !> Writes the rows that wait behind those of the dataset.
  subroutine write_one(buffer, file, error)
    type(row_buffer_t), intent(inout) :: buffer        !! nothing waits
    type(hdf5_file_t), intent(inout) :: file           !! that holds the dataset
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (buffer%n_waiting == 0) return
    if (buffer%series%layout%kind /= kind_float64) then
      call append_rows(buffer%series, file, buffer%integers(1, :buffer%n_waiting), error)
    else if (buffer%series%layout%n_columns == 0) then
      call append_rows(buffer%series, file, buffer%reals(1, :buffer%n_waiting), error)
    else
      call append_rows(buffer%series, file, buffer%reals(:, :buffer%n_waiting), error)
    end if
    buffer%n_waiting = 0
  end subroutine write_one

  !> The same of several datasets.
  subroutine write_several(buffer, file, error)
    type(row_buffer_t), intent(inout) :: buffer(:)     !! nothing waits
    type(hdf5_file_t), intent(inout) :: file           !! that holds the datasets
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: i

    do i = 1, size(buffer)
      call write_one(buffer(i), file, error)
    end do
  end subroutine write_several

  !> Adds the rows that wait to those that a file has.
  pure subroutine add_of_one(buffer, n_rows)
    type(row_buffer_t), intent(in) :: buffer
    integer(ip), intent(inout) :: n_rows(:) !! (datasets of the file)

    associate (n => n_rows(buffer%series%number))
      n = n + int(buffer%n_waiting, ip)
    end associate
  end subroutine add_of_one

  !> The same of several datasets.
  pure subroutine add_of_several(buffer, n_rows)
    type(row_buffer_t), intent(in) :: buffer(:)
    integer(ip), intent(inout) :: n_rows(:) !! (datasets of the file)
    integer :: i

    do i = 1, size(buffer)
      call add_of_one(buffer(i), n_rows)
    end do
  end subroutine add_of_several

end module mpm_row_buffer
