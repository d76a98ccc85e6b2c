!> The rows of an earlier file, for one that goes on where a run was interrupted.
module mpm_hdf5_resume
  use hdf5, only: h5dclose_f, h5dget_create_plist_f, h5dget_type_f, h5dopen_f, h5f_acc_rdonly_f, &
                  h5fclose_f, h5fopen_f, h5pclose_f, h5pget_chunk_f, h5pget_nfilters_f, &
                  h5tclose_f, h5tequal_f, hid_t, hsize_t
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_hdf5_attribute, only: get_text_attribute
  use mpm_hdf5_copy, only: copy_rows, dataset_rows, dataset_shape
  use mpm_hdf5_failure, only: hdf5_failure
  use mpm_hdf5_file, only: check_writable, fail_hdf5_file, hdf5_file_t, note_rows, open_dataset
  use mpm_kinds, only: ip
  implicit none
  private
  public :: refuse_resume, resume_rows

contains

  !> Takes the first rows of every dataset from the published file with the same path, which the
  !! run to go on with must have written. That file is not changed.
  subroutine resume_rows(file, n_rows, object, run_id, error)
    type(hdf5_file_t), intent(inout) :: file           !! all datasets are there, without rows
    integer(ip), intent(in)  :: n_rows(:)              !! of each dataset, in order of creation
    character(*), intent(in) :: object                 !! group with the attribute run
    character(*), intent(in) :: run_id                 !! of the run to go on with
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t) :: source
    integer :: i, ignored, status

    call check_writable(file, error)
    if (allocated(error)) return
    if (size(n_rows) /= size(file%dataset)) then
      call refuse_resume(error, file%path, "the deck asks for other output")
      return
    end if
    call h5fopen_f(file%path, h5f_acc_rdonly_f, source, status)
    if (status < 0) then
      call hdf5_failure(error, file%path, "go on with")
      return
    end if
    call check_run(source, file%path, object, run_id, error)
    do i = 1, size(n_rows)
      if (allocated(error)) exit
      call resume_dataset(file, source, i, n_rows(i), error)
    end do
    call h5fclose_f(source, ignored)
  end subroutine resume_rows

  !> Whether a file is of the run to go on with.
  subroutine check_run(source, path, object, run_id, error)
    integer(hid_t), intent(in) :: source               !! open file
    character(*), intent(in) :: path                   !! of the file
    character(*), intent(in) :: object                 !! group with the attribute run
    character(*), intent(in) :: run_id                 !! of the run to go on with
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(:), allocatable :: found
    integer :: status

    call get_text_attribute(source, object, "run", found, status)
    if (status < 0) then
      call refuse_resume(error, path, "it does not tell its run")
    else if (found /= run_id) then
      call refuse_resume(error, path, "it is of the run "//found//", not of "//run_id)
    end if
  end subroutine check_run

  !> Takes the first rows of one dataset.
  subroutine resume_dataset(file, source, number, n_rows, error)
    type(hdf5_file_t), intent(inout) :: file           !! dataset without rows
    integer(hid_t), intent(in) :: source               !! open file
    integer, intent(in) :: number                      !! of the dataset
    integer(ip), intent(in) :: n_rows                  !! rows to take
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(:), allocatable :: name
    integer(ip) :: n_there
    integer(hid_t) :: from, to
    integer :: ignored, status
    logical :: alike

    name = file%dataset(number)%name
    call open_dataset(file, number, to, status)
    if (status >= 0) call h5dopen_f(source, name, from, status)
    if (status < 0) then
      call refuse_resume(error, file%path, "it has no dataset "//name)
      return
    end if
    call compare_layouts(from, to, alike)
    call dataset_rows(from, n_there, status)
    if (.not. alike) then
      call refuse_resume(error, file%path, "its dataset "//name//" is stored in another way")
    else if (status < 0 .or. n_there < n_rows) then
      call refuse_resume(error, file%path, "its dataset "//name//" lacks rows")
    else
      call copy_rows(from, to, n_rows, status)
      if (status < 0) call fail_hdf5_file(file, "write", error)
      call note_rows(file, number, n_rows)
    end if
    call h5dclose_f(from, ignored)
  end subroutine resume_dataset

  !> Whether chunks of one dataset may become chunks of another one.
  subroutine compare_layouts(first, second, alike)
    integer(hid_t), intent(in) :: first, second !! open
    logical, intent(out) :: alike
    integer(hsize_t) :: extent(2, 2), chunk(2, 2)
    integer :: n_filters(2), rank(2), status(2)
    integer(hid_t) :: type_id(2)
    integer :: ignored

    call dataset_shape(first, rank(1), extent(:, 1), status(1))
    call dataset_shape(second, rank(2), extent(:, 2), status(2))
    alike = all(status >= 0) .and. rank(1) == rank(2)
    if (alike .and. rank(1) == 2) alike = extent(1, 1) == extent(1, 2)
    if (.not. alike) return
    call find_chunks(first, rank(1), chunk(:, 1), n_filters(1), status(1))
    call find_chunks(second, rank(1), chunk(:, 2), n_filters(2), status(2))
    alike = all(status >= 0) .and. all(chunk(:, 1) == chunk(:, 2)) .and. &
            n_filters(1) == n_filters(2)
    if (.not. alike) return
    call h5dget_type_f(first, type_id(1), status(1))
    call h5dget_type_f(second, type_id(2), status(2))
    call h5tequal_f(type_id(1), type_id(2), alike, ignored)
    call h5tclose_f(type_id(1), ignored)
    call h5tclose_f(type_id(2), ignored)
  end subroutine compare_layouts

  !> Extents of the chunks of a dataset, and how many filters they pass.
  subroutine find_chunks(dataset, rank, chunk, n_filters, status)
    integer(hid_t), intent(in)    :: dataset   !! open
    integer, intent(in)           :: rank      !! 1 or 2
    integer(hsize_t), intent(out) :: chunk(2)  !! the first rank count
    integer, intent(out)          :: n_filters
    integer, intent(out)          :: status    !! < 0: failed, or not stored in chunks
    integer(hid_t) :: properties
    integer :: ignored

    chunk = 0_hsize_t
    n_filters = 0
    call h5dget_create_plist_f(dataset, properties, status)
    if (status < 0) return
    call h5pget_chunk_f(properties, rank, chunk(:rank), status)
    if (status >= 0) call h5pget_nfilters_f(properties, n_filters, status)
    call h5pclose_f(properties, ignored)
  end subroutine find_chunks

  !> A file with which a run cannot go on.
  pure subroutine refuse_resume(error, path, reason)
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(*), intent(in) :: path                   !! file
    character(*), intent(in) :: reason                 !! in words

    if (allocated(error)) return
    call make_error(error, exit_file, "error: cannot go on with '"//path//"': "//reason &
                    //": expected the file of the interrupted run, or another folder (-o DIR)")
  end subroutine refuse_resume

end module mpm_hdf5_resume
