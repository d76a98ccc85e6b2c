!> JOB_history.csv: the quantities of *HISTORY after every accepted increment.
module mpm_history
  use mpm_error, only: error_t
  use mpm_history_columns, only: history_column_t
  use mpm_kinds, only: dp
  use mpm_model, only: model_t
  use mpm_run_state, only: run_info_t, run_state_t
  use mpm_text, only: integer_text
  use mpm_text_file, only: open_text_file, text_file_t, write_counted_line
  implicit none
  private
  public :: exact_text, open_history, units_of, write_history_row

contains

  !> Opens the file and writes its head: comments, then the names of the columns.
  subroutine open_history(file, path, columns, model, info, error)
    type(text_file_t), intent(out) :: file             !! open
    character(*), intent(in) :: path                   !! file
    type(history_column_t), intent(in) :: columns(:)   !! what is written
    type(model_t), intent(in)    :: model              !! heading and units
    type(run_info_t), intent(in) :: info               !! deck and program
    type(error_t), allocatable, intent(out) :: error   !! exit_file
    character(:), allocatable :: head
    integer :: i

    call open_text_file(file, path, error)
    if (allocated(error)) return
    head = "# job "//model%job//", deck "//info%deck_name//", Tessera "//info%version//" "// &
           info%git//new_line("a")
    if (allocated(model%heading)) then
      if (len(model%heading) > 0) head = head//"# "//one_line(model%heading)//new_line("a")
    end if
    head = head//"# units: "//units_of(model)//new_line("a") &
           //"# RF: reaction, sum over the set; CF: applied force, sum; U: displacement, mean;" &
           //new_line("a")//"# of a point: its value; time: total time; row 0: before loading" &
           //new_line("a")//"step,increment,time"
    do i = 1, size(columns)
      head = head//","//columns(i)%name
    end do
    call write_counted_line(file, head, error)
  end subroutine open_history

  !> Writes a row.
  subroutine write_history_row(file, state, values, error)
    type(text_file_t), intent(inout) :: file           !! open
    type(run_state_t), intent(in) :: state             !! step, increment, time
    real(dp), intent(in) :: values(:)                  !! of the columns
    type(error_t), allocatable, intent(out) :: error   !! exit_file
    character(:), allocatable :: row
    integer :: i

    row = integer_text(state%step)//","//integer_text(state%increment)//","//exact_text(state%time)
    do i = 1, size(values)
      row = row//","//exact_text(values(i))
    end do
    call write_counted_line(file, row, error)
  end subroutine write_history_row

  !> The labels of *UNITS.
  pure function units_of(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text

    text = ""
    if (allocated(model%unit_length)) then
      if (len(model%unit_length) > 0) text = "length "//model%unit_length
    end if
    if (allocated(model%unit_force)) then
      if (len(model%unit_force) > 0) text = trim(text//" force "//model%unit_force)
    end if
    if (len(text) == 0) text = "any consistent system"
    text = trim(adjustl(text))
  end function units_of

  !> A text with blanks for its line ends.
  pure function one_line(text) result(line)
    character(*), intent(in) :: text
    character(len(text)) :: line
    integer :: i

    do i = 1, len(text)
      line(i:i) = merge(" ", text(i:i), text(i:i) == new_line("a"))
    end do
  end function one_line

  !> A real number with 17 significant digits: reading it back gives the same number.
  pure function exact_text(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, "(es24.16e3)") value
    text = trim(adjustl(buffer))
  end function exact_text

end module mpm_history
