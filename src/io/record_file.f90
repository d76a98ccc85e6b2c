!> HDF5 files that keep named values: written once and sealed, read back after the seal was checked.
!!
!! In front of the HDF5 part stands a line of text per property: what the file is, the version of
!! its format, length and checksum of everything behind. A file that was cut short or changed by
!! accident is refused before HDF5 sees it.
module mpm_record_file
  use hdf5, only: h5eset_auto_f, h5f_acc_rdonly_f, h5f_acc_trunc_f, h5fclose_f, h5fcreate_f, &
                  h5fopen_f, h5open_f, h5p_default_f, h5p_file_create_f, h5pclose_f, h5pcreate_f, &
                  h5pset_userblock_f, hid_t, hsize_t
  use mpm_checksum, only: checksum_of_text, checksum_text
  use mpm_error, only: error_t, exit_file, make_error
  use mpm_file_exchange, only: sync_file
  use mpm_hdf5_failure, only: hdf5_failure
  use mpm_input_file, only: check_input
  use mpm_kinds, only: ip
  use mpm_source_excerpt, only: printable
  use mpm_text, only: integer_text, parse_integer
  implicit none
  private
  public :: record_t, check_seal, close_record, create_record, open_record, seal_record

  integer, parameter :: seal_length = 512      !! bytes in front of the HDF5 part
  integer, parameter :: block_length = 1048576 !! bytes read at a time
  integer, parameter :: format_version = 3     !! of the restart file
  character(*), parameter :: title = "Tessera restart file"

  !> An open file.
  type :: record_t
    character(:), allocatable :: path
    integer(hid_t) :: id = -1_hid_t
    integer(ip) :: n_bytes = 0_ip  !! of the file that is read
    logical :: is_open = .false.
    logical :: writing = .false.   !! .false.: values are read
  end type record_t

contains

  !> Creates a file for writing; what was in it is lost.
  subroutine create_record(record, path, error)
    type(record_t), intent(out) :: record            !! open
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer(hid_t) :: properties
    integer :: status

    record%path = path
    record%writing = .true.
    call h5open_f(status)
    call h5eset_auto_f(0, status)
    call h5pcreate_f(h5p_file_create_f, properties, status)
    if (status >= 0) call h5pset_userblock_f(properties, int(seal_length, hsize_t), status)
    if (status >= 0) call h5fcreate_f(path, h5f_acc_trunc_f, record%id, status, properties, &
                                      h5p_default_f)
    record%is_open = status >= 0
    if (status < 0) then
      call hdf5_failure(error, path, "write")
      return
    end if
    call h5pclose_f(properties, status)
  end subroutine create_record

  !> Opens a file for reading, after its seal was checked.
  subroutine open_record(record, path, error)
    type(record_t), intent(out) :: record            !! open
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file: no such file, damaged ...
    integer :: status

    record%path = path
    call check_seal(record%n_bytes, path, error)
    if (allocated(error)) return
    call h5open_f(status)
    call h5eset_auto_f(0, status)
    call h5fopen_f(path, h5f_acc_rdonly_f, record%id, status)
    record%is_open = status >= 0
    if (status < 0) call hdf5_failure(error, path, "read")
  end subroutine open_record

  !> Closes a file; no effect on a closed one.
  subroutine close_record(record, error)
    type(record_t), intent(inout) :: record            !! closed
    type(error_t), allocatable, intent(inout) :: error !! exit_file, unless there is an error already
    integer :: status

    if (.not. record%is_open) return
    record%is_open = .false.
    call h5fclose_f(record%id, status)
    if (status < 0 .and. .not. allocated(error)) call hdf5_failure(error, record%path, "write")
  end subroutine close_record

  !> Seals a file that was written and closed, and waits until all of it is on the disk.
  subroutine seal_record(path, error)
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(seal_length) :: seal
    character(200) :: reason
    integer(ip) :: checksum, length
    integer :: status, unit

    call sum_up(checksum, length, path, error)
    if (allocated(error)) return
    seal = title//new_line("a")//"format "//integer_text(format_version)//new_line("a")// &
           "length "//length_text(length)//new_line("a")//"checksum "//checksum_text(checksum)// &
           new_line("a")
    open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
          action="readwrite", iostat=status, iomsg=reason)
    if (status == 0) write (unit, pos=1, iostat=status, iomsg=reason) seal
    if (status == 0) then
      close (unit, iostat=status, iomsg=reason)
    else
      close (unit, iostat=status)
      status = 1
    end if
    if (status == 0) then
      call sync_file(path, error)
    else
      call make_error(error, exit_file, "error: cannot write '"//path//"': "//trim(reason))
    end if
  end subroutine seal_record

  !> Compares a file with its seal.
  subroutine check_seal(n_bytes, path, error)
    integer(ip), intent(out) :: n_bytes              !! length of the file
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file: none, of another kind, damaged
    character(seal_length) :: seal
    character(:), allocatable :: reason
    integer(ip) :: checksum, length
    integer :: status, unit, version
    logical :: ok

    seal = ""
    inquire (file=path, size=n_bytes)
    call check_input(path, reason) ! a pipe would let us wait
    status = len(reason)
    if (status == 0) open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
          action="read", iostat=status)
    if (status == 0) then
      read (unit, iostat=status) seal
      close (unit)
      if (status /= 0) seal = ""
      status = 0
    end if
    if (status /= 0) then
      call make_error(error, exit_file, "error: restart file '"//path//"' cannot be opened: "// &
                      "expected a file that a run of Tessera has written")
    else if (index(seal, title//new_line("a")) /= 1) then
      call make_error(error, exit_file, "error: '"//path//"' is no restart file: expected one "// &
                      "that a run of Tessera has written, as JOB.restart.h5")
    end if
    if (allocated(error)) return
    call parse_integer(property(seal, "format"), version, ok)
    if (.not. ok .or. version /= format_version) then
      call make_error(error, exit_file, "error: restart file '"//path//"' has format '"// &
                      property(seal, "format")//"': this version of Tessera expects format "// &
                      integer_text(format_version))
      return
    end if
    call sum_up(checksum, length, path, error)
    if (allocated(error)) return
    if (property(seal, "length") /= length_text(length)) then
      call make_error(error, exit_file, "error: restart file '"//path//"' is cut short or "// &
                      "longer than it was: "//length_text(length)//" bytes of data, expected "// &
                      property(seal, "length"))
    else if (property(seal, "checksum") /= checksum_text(checksum)) then
      call make_error(error, exit_file, "error: restart file '"//path//"' is damaged: checksum "// &
                      checksum_text(checksum)//", expected "//property(seal, "checksum"))
    end if
  end subroutine check_seal

  !> A property of a seal.
  pure function property(seal, name) result(value)
    character(*), intent(in) :: seal !! lines of name and value
    character(*), intent(in) :: name !! of the property
    character(:), allocatable :: value !! empty if it is not there
    integer :: first, length

    value = ""
    first = index(seal, new_line("a")//name//" ")
    if (first == 0) return
    first = first + len(name) + 2
    length = index(seal(first:), new_line("a")) - 1
    if (length > 0) value = printable(seal(first:first + min(length, 40) - 1))
  end function property

  !> A length as text.
  pure function length_text(length) result(text)
    integer(ip), intent(in) :: length !! [bytes]
    character(:), allocatable :: text
    character(20) :: buffer

    write (buffer, "(i0)") length
    text = trim(buffer)
  end function length_text

  !> Length and checksum of everything behind the seal.
  subroutine sum_up(checksum, length, path, error)
    integer(ip), intent(out) :: checksum             !! 0 .. 2^32 - 1
    integer(ip), intent(out) :: length               !! [bytes]
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file: cannot be read
    character(:), allocatable :: buffer
    character(200) :: reason
    integer(ip) :: n_bytes, done
    integer :: n, status, unit

    checksum = 0_ip
    allocate (character(block_length) :: buffer)
    done = int(seal_length, ip)
    inquire (file=path, size=n_bytes)
    length = max(0_ip, n_bytes - done)
    open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
          action="read", iostat=status, iomsg=reason)
    do while (status == 0 .and. done < n_bytes)
      n = int(min(n_bytes - done, int(block_length, ip)))
      read (unit, pos=done + 1_ip, iostat=status, iomsg=reason) buffer(:n)
      if (status == 0) checksum = checksum_of_text(checksum, buffer(:n))
      done = done + int(n, ip)
    end do
    if (status == 0) close (unit, iostat=status, iomsg=reason)
    if (status /= 0) call make_error(error, exit_file, "error: cannot read '"//path//"': "// &
                                     trim(reason))
  end subroutine sum_up

end module mpm_record_file
