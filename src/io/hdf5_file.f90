!> HDF5 files for writing, with their groups, texts, attributes and datasets.
!!
!! What a reader finds under the path is complete and closed at every moment, also after a kill:
!! all writing goes to a copy with another name, and publishing exchanges the two. The file that a
!! reader had before then catches up and becomes the copy, unless he still holds it: then there is
!! a new copy. Every procedure but create_hdf5_file returns at once when `error` is set already,
!! so that a sequence of calls needs one check at its end; after a failure nothing is published.
module mpm_hdf5_file
  use hdf5, only: h5dclose_f, h5dont_atexit_f, h5dopen_f, h5eset_auto_f, h5f_acc_rdonly_f, &
                  h5f_acc_rdwr_f, h5f_acc_trunc_f, h5f_close_strong_f, h5f_scope_local_f, &
                  h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, h5gclose_f, h5gcreate_f, &
                  h5open_f, h5p_file_access_f, h5pclose_f, h5pcreate_f, h5pset_fclose_degree_f, &
                  hid_t
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_file_bytes, only: copy_file
  use mpm_file_exchange, only: exchange_file, remove_file, replace_file, sync_file
  use mpm_hdf5_attribute, only: put_integers_attribute, put_text, put_text_attribute
  use mpm_hdf5_copy, only: copy_rows, dataset_rows
  use mpm_hdf5_failure, only: hdf5_failure
  use mpm_kinds, only: ip
  implicit none
  private
  public :: hdf5_file_t, close_hdf5_file, create_hdf5_file, publish_hdf5_file
  public :: make_group, write_integers_attribute, write_text, write_text_attribute
  public :: add_dataset, check_writable, fail_hdf5_file, note_rows, open_dataset

  character(*), parameter :: suffix = ".next" !! of the copy that is written to

  !> A dataset that grows.
  type :: dataset_t
    character(:), allocatable :: name
    integer(hid_t) :: id = -1_hid_t       !! in the copy that is written to, -1 = not open
    integer(ip) :: n_rows = 0_ip          !! in the copy
    integer(ip) :: n_published = 0_ip     !! in the published file
  end type dataset_t

  !> Integers of an attribute that were written since the last publication.
  type :: attribute_t
    character(:), allocatable :: object, name
    integer(ip), allocatable :: values(:)
  end type attribute_t

  !> An open HDF5 file.
  type :: hdf5_file_t
    character(:), allocatable :: path        !! of the published file
    integer(hid_t) :: id = -1_hid_t          !! of the copy that is written to
    logical :: is_open = .false.             !! between creation and closing
    logical :: is_published = .false.        !! a complete file has the path
    logical :: has_news = .false.            !! the copy holds more than the published file
    logical :: has_new_objects = .false.     !! not only rows and integers of attributes
    logical :: has_failed = .false.          !! a write has failed: nothing is published any more
    type(dataset_t), allocatable :: dataset(:)     !! in the order of their creation
    type(attribute_t), allocatable :: attribute(:) !! to be written into the other copy, too
  end type hdf5_file_t

contains

  !> Creates a file. One with its path stays what it is until the first publication. HDF5 prints
  !! nothing by itself from then on, and does not try to close a file at the end of the program
  !! that could not be written.
  subroutine create_hdf5_file(file, path, error)
    type(hdf5_file_t), intent(out) :: file           !! open
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer :: status

    file%path = path
    allocate (file%dataset(0), file%attribute(0))
    call h5dont_atexit_f(status)
    call h5open_f(status)
    if (status < 0) then
      call make_error(error, exit_file, "error: HDF5 cannot be started")
      return
    end if
    call h5eset_auto_f(0, status)
    call open_copy(file, .true., status)
    file%is_open = status >= 0
    file%has_news = .true.
    file%has_new_objects = .true.
    if (file%is_open) return
    call hdf5_failure(error, path, "create")
    call remove_file(path//suffix) ! may have been made, but not written
  end subroutine create_hdf5_file

  !> Opens the copy that is written to.
  subroutine open_copy(file, new, status)
    type(hdf5_file_t), intent(inout) :: file !! its copy is open
    logical, intent(in)  :: new              !! .true.: without anything in it
    integer, intent(out) :: status           !! < 0: failed
    integer(hid_t) :: access

    call h5pcreate_f(h5p_file_access_f, access, status)
    if (status < 0) return
    call h5pset_fclose_degree_f(access, h5f_close_strong_f, status)
    if (status >= 0) then
      if (new) then
        call h5fcreate_f(file%path//suffix, h5f_acc_trunc_f, file%id, status, access_prp=access)
      else
        call h5fopen_f(file%path//suffix, h5f_acc_rdwr_f, file%id, status, access)
        if (status < 0) file%id = -1_hid_t
      end if
    end if
    if (status >= 0) call h5pclose_f(access, status) ! would hide the reason of a failure
  end subroutine open_copy

  !> Makes everything written so far what a reader finds under the path.
  subroutine publish_hdf5_file(file, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file, for example a full disk
    logical :: kept

    call check_writable(file, error)
    if (allocated(error) .or. .not. file%has_news) return
    call hand_over(file, kept, error)
    if (allocated(error)) return
    call prepare_copy(file, kept, error)
    file%has_news = .false.
    file%has_new_objects = .false.
  end subroutine publish_hdf5_file

  !> Closes the copy and gives it the path.
  subroutine hand_over(file, kept, error)
    type(hdf5_file_t), intent(inout) :: file           !! its copy is closed
    logical, intent(out) :: kept                       !! the former file is the copy now
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: status

    kept = .false.
    call h5fflush_f(file%id, h5f_scope_local_f, status)
    if (status < 0) then
      call fail_hdf5_file(file, "write", error)
      return
    end if
    call h5fclose_f(file%id, status) ! also the datasets
    file%dataset%id = -1_hid_t
    file%id = -1_hid_t
    if (status < 0) then
      call fail_hdf5_file(file, "write", error)
    else if (file%is_published) then
      call exchange_file(file%path//suffix, file%path, kept, error)
    else
      call replace_file(file%path//suffix, file%path, error)
    end if
    if (allocated(error)) file%has_failed = .true.
    file%is_published = .not. allocated(error)
  end subroutine hand_over

  !> Makes a copy of the published file to go on with.
  subroutine prepare_copy(file, kept, error)
    type(hdf5_file_t), intent(inout) :: file           !! its copy is open and complete
    logical, intent(in) :: kept                        !! the file published before can catch up
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: ignored, status

    status = -1
    if (kept .and. .not. file%has_new_objects) call catch_up(file, status)
    if (status < 0) then ! a reader holds the former file, or somebody has put another one there
      if (file%id >= 0_hid_t) call h5fclose_f(file%id, ignored)
      file%dataset%id = -1_hid_t
      file%id = -1_hid_t
      call remove_file(file%path//suffix)
      call copy_file(file%path, file%path//suffix, error)
      file%has_failed = allocated(error)
      if (allocated(error)) return
      call open_copy(file, .false., status)
      if (status < 0) call fail_hdf5_file(file, "write", error)
    end if
    file%dataset%n_published = file%dataset%n_rows
    deallocate (file%attribute)
    allocate (file%attribute(0))
  end subroutine prepare_copy

  !> Brings the file that was published before to the state of the one that is published now.
  subroutine catch_up(file, status)
    type(hdf5_file_t), intent(inout) :: file !! its copy is open
    integer, intent(out) :: status           !! < 0: failed
    integer(hid_t) :: source
    integer :: i, ignored

    call open_copy(file, .false., status)
    if (status < 0) return
    call h5fopen_f(file%path, h5f_acc_rdonly_f, source, status)
    if (status < 0) return
    call copy_new_rows(file, source, status)
    call h5fclose_f(source, ignored)
    do i = 1, size(file%attribute)
      if (status < 0) return
      associate (attribute => file%attribute(i))
        call put_integers_attribute(file%id, attribute%object, attribute%name, attribute%values, &
                                    status)
      end associate
    end do
  end subroutine catch_up

  !> Copies the rows that the published file has got last.
  subroutine copy_new_rows(file, source, status)
    type(hdf5_file_t), intent(inout) :: file !! its copy is open
    integer(hid_t), intent(in) :: source     !! published file
    integer, intent(out) :: status           !! < 0: failed
    integer(hid_t) :: from, to
    integer(ip) :: n_rows
    integer :: i, ignored

    status = 0
    do i = 1, size(file%dataset)
      associate (dataset => file%dataset(i))
        if (dataset%n_rows == dataset%n_published) cycle
        call open_dataset(file, i, to, status)
        if (status >= 0) call dataset_rows(to, n_rows, status)
        if (status >= 0 .and. n_rows /= dataset%n_published) status = -1
        if (status >= 0) call h5dopen_f(source, dataset%name, from, status)
        if (status < 0) return
        call copy_rows(from, to, dataset%n_rows, status)
        call h5dclose_f(from, ignored)
        if (status < 0) return
      end associate
    end do
  end subroutine copy_new_rows

  !> Publishes what is new and closes a file; no effect on a closed one. After an error it is
  !! closed without being published.
  subroutine close_hdf5_file(file, error)
    type(hdf5_file_t), intent(inout) :: file           !! closed
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: ignored

    if (.not. file%is_open) return
    if (.not. allocated(error) .and. .not. file%has_failed) call publish_last(file, error)
    file%is_open = .false.
    if (file%id >= 0_hid_t) call h5fclose_f(file%id, ignored)
    file%id = -1_hid_t
    file%dataset%id = -1_hid_t
    call remove_file(file%path//suffix)
  end subroutine close_hdf5_file

  !> Publishes what is new and brings the file to the disk.
  subroutine publish_last(file, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    logical :: kept

    if (file%has_news) call hand_over(file, kept, error)
    if (.not. allocated(error)) call sync_file(file%path, error)
  end subroutine publish_last

  !> Sets an error after an earlier failure, which may have been forgotten.
  pure subroutine check_writable(file, error)
    type(hdf5_file_t), intent(in) :: file              !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error) .or. .not. file%has_failed) return
    call make_error(error, exit_file, "error: cannot write '"//file%path &
                    //"' after an earlier failure")
  end subroutine check_writable

  !> The last call of HDF5 failed: nothing is published any more.
  subroutine fail_hdf5_file(file, action, error)
    type(hdf5_file_t), intent(inout) :: file           !! has failed
    character(*), intent(in) :: action                 !! what was tried
    type(error_t), allocatable, intent(inout) :: error !! exit_file with path and reason

    file%has_failed = .true.
    call hdf5_failure(error, file%path, action)
  end subroutine fail_hdf5_file

  !> Puts a new dataset without rows on the list of those that grow.
  subroutine add_dataset(file, name, id, number)
    type(hdf5_file_t), intent(inout) :: file !! has one dataset more
    character(*), intent(in) :: name         !! absolute path of the dataset
    integer(hid_t), intent(in) :: id         !! open
    integer, intent(out) :: number           !! in the list
    type(dataset_t), allocatable :: longer(:)

    number = size(file%dataset) + 1
    allocate (longer(number))
    longer(:number - 1) = file%dataset
    longer(number)%name = name
    longer(number)%id = id
    call move_alloc(longer, file%dataset)
    call note_news(file)
  end subroutine add_dataset

  !> A dataset of the copy that is written to.
  subroutine open_dataset(file, number, id, status)
    type(hdf5_file_t), intent(inout) :: file !! the dataset is open
    integer, intent(in) :: number            !! in the list
    integer(hid_t), intent(out) :: id        !! closed with the file
    integer, intent(out) :: status           !! < 0: failed

    status = 0
    associate (dataset => file%dataset(number))
      if (dataset%id < 0_hid_t) call h5dopen_f(file%id, dataset%name, dataset%id, status)
      if (status < 0) dataset%id = -1_hid_t
      id = dataset%id
    end associate
  end subroutine open_dataset

  !> A dataset has grown.
  pure subroutine note_rows(file, number, n_rows)
    type(hdf5_file_t), intent(inout) :: file !! has news
    integer, intent(in) :: number            !! of the dataset in the list
    integer(ip), intent(in) :: n_rows        !! that it has now

    file%dataset(number)%n_rows = n_rows
    file%has_news = .true.
  end subroutine note_rows

  !> The copy has got objects that cannot catch up by rows.
  pure subroutine note_news(file)
    type(hdf5_file_t), intent(inout) :: file

    file%has_news = .true.
    file%has_new_objects = .true.
  end subroutine note_news

  !> Creates a group.
  subroutine make_group(file, name, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path of the group
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(hid_t) :: id
    integer :: status

    call check_writable(file, error)
    if (allocated(error)) return
    call note_news(file)
    call h5gcreate_f(file%id, name, id, status)
    if (status >= 0) call h5gclose_f(id, status)
    if (status < 0) call fail_hdf5_file(file, "write", error)
  end subroutine make_group

  !> Writes a text as a scalar dataset of fixed length, UTF-8.
  subroutine write_text(file, name, text, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path of the dataset
    character(*), intent(in) :: text                   !! any length
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: status

    call check_writable(file, error)
    if (allocated(error)) return
    call note_news(file)
    call put_text(file%id, name, text, status)
    if (status < 0) call fail_hdf5_file(file, "write", error)
  end subroutine write_text

  !> Writes a text as an attribute of fixed length, ASCII as the VTKHDF format wants it.
  subroutine write_text_attribute(file, object, name, text, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: object                 !! absolute path of a group
    character(*), intent(in) :: name                   !! of the attribute
    character(*), intent(in) :: text                   !! short text
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: status

    call check_writable(file, error)
    if (allocated(error)) return
    call note_news(file)
    call put_text_attribute(file%id, object, name, text, status)
    if (status < 0) call fail_hdf5_file(file, "write", error)
  end subroutine write_text_attribute

  !> Writes integers as an attribute: a scalar if there is one. An attribute of that name and
  !! shape is overwritten.
  subroutine write_integers_attribute(file, object, name, values, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: object                 !! absolute path of a group
    character(*), intent(in) :: name                   !! of the attribute
    integer(ip), intent(in)  :: values(:)              !! one or more
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: status

    call check_writable(file, error)
    if (allocated(error)) return
    file%has_news = .true.
    file%attribute = [file%attribute, attribute_t(object, name, values)]
    call put_integers_attribute(file%id, object, name, values, status)
    if (status < 0) call fail_hdf5_file(file, "write", error)
  end subroutine write_integers_attribute

end module mpm_hdf5_file
