!> Where the result files of a run stand after an increment: what a restart needs to go on with
!! them.
module mpm_output_mark
  use mpm_kinds, only: ip
  implicit none
  private
  public :: file_mark_t, output_mark_t, text_mark_t, mark_text, read_mark

  integer, parameter :: most_numbers = 100000 !! in a list of a mark
  character(*), parameter :: first_line = "output mark 1" !! kind and version of the text

  !> Where a text file stands.
  type :: text_mark_t
    integer(ip) :: n_bytes = 0_ip  !! length
    integer(ip) :: checksum = 0_ip !! of these bytes, see mpm_checksum
  end type text_mark_t

  !> Where a .vtkhdf file stands.
  type :: file_mark_t
    integer(ip) :: n_steps = 0_ip    !! outputs
    integer(ip) :: first_cell = 0_ip !! of the cells written last
    integer(ip) :: first_id = 0_ip   !! of the connectivity written last
    integer(ip), allocatable :: last_offset(:) !! (fields)   first row of the values written last
    integer(ip), allocatable :: n_rows(:)      !! (datasets) rows, in the order of creation
  end type file_mark_t

  !> Where all files of a run stand.
  type :: output_mark_t
    character(:), allocatable :: run_id !! of the run that wrote them
    type(text_mark_t) :: status         !! JOB.sta
    type(text_mark_t) :: history        !! JOB_history.csv
    type(file_mark_t) :: points         !! JOB.vtkhdf
    type(file_mark_t) :: mesh           !! JOB_mesh.vtkhdf
    integer(ip) :: n_written = -1_ip    !! points of the output written last
    integer(ip) :: n_shown = -1_ip      !! accepted increments at the last output
  end type output_mark_t

contains

  !> A mark as a text.
  pure function mark_text(mark) result(text)
    type(output_mark_t), intent(in) :: mark
    character(:), allocatable :: text

    text = first_line//new_line("a")//mark%run_id//new_line("a") &
           //line_of([mark%status%n_bytes, mark%status%checksum, mark%history%n_bytes, &
                      mark%history%checksum, mark%n_written, mark%n_shown]) &
           //file_text(mark%points)//file_text(mark%mesh)
  end function mark_text

  !> The lines of a .vtkhdf file.
  pure function file_text(mark) result(text)
    type(file_mark_t), intent(in) :: mark
    character(:), allocatable :: text

    text = line_of([mark%n_steps, mark%first_cell, mark%first_id]) &
           //line_of(mark%last_offset)//line_of(mark%n_rows)
  end function file_text

  !> How many numbers there are, and the numbers.
  pure function line_of(numbers) result(line)
    integer(ip), intent(in) :: numbers(:)
    character(:), allocatable :: line
    character(20) :: buffer
    integer :: i

    write (buffer, "(i0)") size(numbers)
    line = trim(buffer)
    do i = 1, size(numbers)
      write (buffer, "(i0)") numbers(i)
      line = line//" "//trim(buffer)
    end do
    line = line//new_line("a")
  end function line_of

  !> Reads a mark back from its text.
  subroutine read_mark(mark, text, is_mark)
    type(output_mark_t), intent(out) :: mark
    character(*), intent(in) :: text !! by mark_text, perhaps damaged
    logical, intent(out) :: is_mark  !! .false.: it is no mark
    character(:), allocatable :: line
    integer(ip), allocatable :: numbers(:)
    integer :: at

    at = 1
    call next_line(line, text, at)
    is_mark = line == first_line
    if (.not. is_mark) return
    call next_line(mark%run_id, text, at)
    call next_numbers(numbers, text, at)
    is_mark = size(numbers) == 6
    if (is_mark) is_mark = all(numbers(:4) >= 0_ip) .and. all(numbers(5:) >= -1_ip) .and. &
                           all(numbers(5:) <= int(huge(1), ip))
    if (.not. is_mark) return
    mark%status = text_mark_t(numbers(1), numbers(2))
    mark%history = text_mark_t(numbers(3), numbers(4))
    mark%n_written = numbers(5)
    mark%n_shown = numbers(6)
    call read_file_mark(mark%points, text, at, is_mark)
    if (is_mark) call read_file_mark(mark%mesh, text, at, is_mark)
  end subroutine read_mark

  !> Reads the lines of a .vtkhdf file.
  subroutine read_file_mark(mark, text, at, is_mark)
    type(file_mark_t), intent(out) :: mark
    character(*), intent(in) :: text !! of the whole mark
    integer, intent(inout) :: at     !! where its lines begin; behind them on return
    logical, intent(out) :: is_mark  !! .false.: they are not there
    integer(ip), allocatable :: numbers(:)

    call next_numbers(numbers, text, at)
    is_mark = size(numbers) == 3
    if (.not. is_mark) return
    mark%n_steps = numbers(1)
    mark%first_cell = numbers(2)
    mark%first_id = numbers(3)
    call next_numbers(mark%last_offset, text, at)
    call next_numbers(mark%n_rows, text, at)
    is_mark = size(mark%last_offset) > 0 .and. size(mark%n_rows) > 0 .and. &
              all(numbers >= 0_ip) .and. all(mark%last_offset >= 0_ip) .and. &
              all(mark%n_rows >= 0_ip)
  end subroutine read_file_mark

  !> Reads a line of numbers.
  subroutine next_numbers(numbers, text, at)
    integer(ip), allocatable, intent(out) :: numbers(:) !! none if the line does not hold them
    character(*), intent(in) :: text                    !! of the whole mark
    integer, intent(inout) :: at                        !! start of the line; of the next on return
    character(:), allocatable :: line
    character(80) :: reason
    integer :: n, status

    call next_line(line, text, at)
    n = 0
    read (line, *, iostat=status, iomsg=reason) n
    if (status /= 0 .or. n < 0 .or. n > most_numbers) n = 0
    allocate (numbers(n))
    if (n == 0) return
    read (line, *, iostat=status, iomsg=reason) n, numbers
    if (status /= 0) numbers = [integer(ip) ::]
  end subroutine next_numbers

  !> The line that begins at a place.
  pure subroutine next_line(line, text, at)
    character(:), allocatable, intent(out) :: line !! without line end
    character(*), intent(in) :: text               !! of the whole mark
    integer, intent(inout) :: at                   !! start of the line; of the next on return
    integer :: length

    line = ""
    if (at > len(text)) return
    length = index(text(at:), new_line("a")) - 1
    if (length < 0) length = len(text) - at + 1
    line = text(at:at + length - 1)
    at = at + length + 1
  end subroutine next_line

end module mpm_output_mark
