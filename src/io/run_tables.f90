!> The group /tessera of JOB.vtkhdf: the deck, the program, and tables over the run.
!!
!! Rows of the tables wait in memory until write_tables.
module mpm_run_tables
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use mpm_error, only: error_t
  use mpm_hdf5_file, only: hdf5_file_t, make_group, write_integers_attribute, write_text, &
                           write_text_attribute
  use mpm_hdf5_series, only: kind_float64, kind_int32, kind_int64, series_layout_t
  use mpm_history_columns, only: history_column_t
  use mpm_kinds, only: dp, ip
  use mpm_ledger, only: ledger_t
  use mpm_newton_report, only: newton_report_t
  use mpm_row_buffer, only: add_waiting, create_buffer, hold_rows, row_buffer_t, write_buffer
  use mpm_run_state, only: run_info_t, run_state_t
  implicit none
  private
  public :: run_tables_t, open_tables
  public :: append_history, append_iterations, append_ledger
  public :: add_waiting_tables, n_waiting, write_tables

  character(13), parameter :: iteration_columns(12) = [character(13) :: "step", "increment", &
    "attempt", "iteration", "residual", "kinematics", "stress", "assembly", "factorisation", &
    "solve", "gmres", "new_factors"]
  integer, parameter :: column_of_gmres = 11
  character(13), parameter :: ledger_columns(20) = [character(13) :: "step", "increment", "time", &
    "count", "mass", "volume", "lost", "extrapolated", "centre", "checkerboard", "ghost_share", &
    "eigen_min", "eigen_max", "balance", "unknowns", "nonzeros", "factor_memory", "location", &
    "output", "point_loop"]
  integer, parameter :: column_of_centre = 9
  integer, parameter :: column_of_checkerboard = 10
  integer, parameter :: column_of_share = 11
  integer, parameter :: column_of_balance = 14
  integer, parameter :: column_of_unknowns = 15
  integer, parameter :: column_of_location = 18

  !> The tables; each column is a dataset.
  type :: run_tables_t
    type(row_buffer_t), allocatable :: history(:)    !! step, increment, time, those of *HISTORY
    type(row_buffer_t), allocatable :: iterations(:) !! (12)
    type(row_buffer_t), allocatable :: ledger(:)     !! (20)
  end type run_tables_t

contains

  !> Creates the group with the deck and the attributes, and the tables without rows.
  subroutine open_tables(tables, file, columns, info, units, error)
    type(run_tables_t), intent(out) :: tables          !! without rows
    type(hdf5_file_t), intent(inout) :: file           !! JOB.vtkhdf
    type(history_column_t), intent(in) :: columns(:)   !! of *HISTORY
    type(run_info_t), intent(in) :: info               !! deck and program
    character(*), intent(in) :: units                  !! labels of *UNITS
    type(error_t), allocatable, intent(out) :: error   !! exit_file

    call make_group(file, "/tessera", error)
    call write_text(file, "/tessera/deck", info%deck_text, error)
    call write_text(file, "/tessera/deck_name", info%deck_name, error)
    call write_text_attribute(file, "/tessera", "version", info%version, error)
    call write_text_attribute(file, "/tessera", "git", info%git, error)
    call write_text_attribute(file, "/tessera", "compiler", info%compiler, error)
    call write_text_attribute(file, "/tessera", "libraries", info%libraries, error)
    call write_text_attribute(file, "/tessera", "units", units, error)
    call write_text_attribute(file, "/tessera", "formulation", info%formulation, error)
    call write_text_attribute(file, "/tessera", "started", info%started, error)
    call write_text_attribute(file, "/tessera", "run", info%run_id, error)
    call write_integers_attribute(file, "/tessera", "threads", [int(info%n_threads, ip)], error)
    call create_history(tables%history, file, columns, error)
    call create_iterations(tables%iterations, file, error)
    call create_ledger(tables%ledger, file, error)
  end subroutine open_tables

  !> Creates the columns of the history.
  subroutine create_history(series, file, columns, error)
    type(row_buffer_t), allocatable, intent(out) :: series(:) !! without rows
    type(hdf5_file_t), intent(inout) :: file              !! JOB.vtkhdf
    type(history_column_t), intent(in) :: columns(:)      !! of *HISTORY
    type(error_t), allocatable, intent(inout) :: error    !! exit_file
    integer :: i

    allocate (series(size(columns) + 3))
    call make_group(file, "/tessera/history", error)
    call create_buffer(series(1), file, "/tessera/history/step", series_layout_t(kind_int32), error)
    call create_buffer(series(2), file, "/tessera/history/increment", &
                       series_layout_t(kind_int32), error)
    call create_buffer(series(3), file, "/tessera/history/time", series_layout_t(), error)
    do i = 1, size(columns)
      call create_buffer(series(i + 3), file, "/tessera/history/"//link_name(columns(i)%name), &
                         series_layout_t(), error)
    end do
  end subroutine create_history

  !> Creates the columns of the iterations.
  subroutine create_iterations(series, file, error)
    type(row_buffer_t), allocatable, intent(out) :: series(:) !! without rows
    type(hdf5_file_t), intent(inout) :: file              !! JOB.vtkhdf
    type(error_t), allocatable, intent(inout) :: error    !! exit_file
    integer :: i, kind

    allocate (series(size(iteration_columns)))
    call make_group(file, "/tessera/iterations", error)
    do i = 1, size(series)
      select case (iteration_columns(i))
      case ("step", "increment", "attempt", "iteration", "gmres", "new_factors")
        kind = kind_int32
      case default
        kind = kind_float64
      end select
      call create_buffer(series(i), file, "/tessera/iterations/"//trim(iteration_columns(i)), &
                         series_layout_t(kind), error)
    end do
  end subroutine create_iterations

  !> Creates the columns of the ledger.
  subroutine create_ledger(series, file, error)
    type(row_buffer_t), allocatable, intent(out) :: series(:) !! without rows
    type(hdf5_file_t), intent(inout) :: file              !! JOB.vtkhdf
    type(error_t), allocatable, intent(inout) :: error    !! exit_file
    type(series_layout_t) :: layout
    integer :: i

    allocate (series(size(ledger_columns)))
    call make_group(file, "/tessera/ledger", error)
    do i = 1, size(series)
      layout = series_layout_t()
      select case (ledger_columns(i))
      case ("step", "increment", "count", "lost", "extrapolated", "unknowns", "nonzeros")
        layout%kind = kind_int64
      case ("centre")
        layout%n_columns = 3
      case default
        layout%kind = kind_float64
      end select
      call create_buffer(series(i), file, "/tessera/ledger/"//trim(ledger_columns(i)), layout, &
                         error)
    end do
  end subroutine create_ledger

  !> Appends the values of *HISTORY.
  pure subroutine append_history(tables, state, values)
    type(run_tables_t), intent(inout) :: tables !! longer
    type(run_state_t), intent(in) :: state      !! step, increment, time
    real(dp), intent(in) :: values(:)           !! of the columns
    integer :: i

    call hold_rows(tables%history(1), [int(state%step, ip)])
    call hold_rows(tables%history(2), [int(state%increment, ip)])
    call hold_rows(tables%history(3), [state%time])
    do i = 1, size(values)
      call hold_rows(tables%history(i + 3), values(i:i))
    end do
  end subroutine append_history

  !> Appends the iterations of an attempt, from the residual before the first correction on.
  pure subroutine append_iterations(tables, state, report)
    type(run_tables_t), intent(inout) :: tables !! longer
    type(run_state_t), intent(in) :: state      !! step, increment, attempt
    type(newton_report_t), intent(in) :: report !! of the attempt
    real(dp), allocatable :: seconds(:, :)
    integer, allocatable  :: linear(:, :)
    integer :: i, j, n

    if (.not. allocated(report%residual)) return
    n = ubound(report%residual, 1)
    allocate (seconds(0:n, 5), source=0.0_dp)
    allocate (linear(0:n, 2), source=0)
    do i = 1, n
      if (allocated(report%gmres)) then
        if (i <= size(report%gmres)) linear(i, :) = [report%gmres(i), merge(1, 0, report%is_new(i))]
      end if
      if (allocated(report%seconds)) then
        if (i <= size(report%seconds, 2)) seconds(i, :) = report%seconds(:, i)
      end if
    end do
    call hold_rows(tables%iterations(1), [(int(state%step, ip), i=0, n)])
    call hold_rows(tables%iterations(2), [(int(state%increment, ip), i=0, n)])
    call hold_rows(tables%iterations(3), [(int(state%attempt, ip), i=0, n)])
    call hold_rows(tables%iterations(4), [(int(i, ip), i=0, n)])
    call hold_rows(tables%iterations(5), report%residual(0:n))
    do j = 1, size(seconds, 2)
      call hold_rows(tables%iterations(j + 5), seconds(:, j))
    end do
    do j = 1, size(linear, 2)
      call hold_rows(tables%iterations(column_of_gmres + j - 1), int(linear(:, j), ip))
    end do
  end subroutine append_iterations

  !> Appends the ledger of an increment.
  pure subroutine append_ledger(tables, state, ledger, seconds)
    type(run_tables_t), intent(inout) :: tables !! longer
    type(run_state_t), intent(in) :: state      !! step, increment, time, checkerboard
    type(ledger_t), intent(in) :: ledger        !! after the increment
    real(dp), intent(in) :: seconds(3)          !! since the last row: location of points and
                                                !! output (CPU), point loop (wall) [s]
    real(dp) :: checkerboard(1)
    integer :: i

    checkerboard = ieee_value(1.0_dp, ieee_quiet_nan)
    if (allocated(state%checkerboard)) checkerboard = state%checkerboard
    call hold_rows(tables%ledger(1), [int(state%step, ip)])
    call hold_rows(tables%ledger(2), [int(state%increment, ip)])
    call hold_rows(tables%ledger(3), [state%time])
    call hold_rows(tables%ledger(4), [int(ledger%n_points, ip)])
    call hold_rows(tables%ledger(5), [ledger%mass])
    call hold_rows(tables%ledger(6), [ledger%volume])
    call hold_rows(tables%ledger(7), [int(ledger%n_lost, ip)])
    call hold_rows(tables%ledger(8), [int(ledger%n_extrapolated, ip)])
    call hold_rows(tables%ledger(column_of_centre), reshape(ledger%centre, [3, 1]))
    call hold_rows(tables%ledger(column_of_checkerboard), checkerboard)
    call hold_rows(tables%ledger(column_of_share), [state%ghost_share_now])
    call hold_rows(tables%ledger(column_of_share + 1), state%eigenvalue(1:1))
    call hold_rows(tables%ledger(column_of_share + 2), state%eigenvalue(2:2))
    call hold_rows(tables%ledger(column_of_balance), [state%balance_now])
    call hold_rows(tables%ledger(column_of_unknowns), [int(state%n_unknowns, ip)])
    call hold_rows(tables%ledger(column_of_unknowns + 1), [int(state%n_nonzeros, ip)])
    call hold_rows(tables%ledger(column_of_unknowns + 2), [state%factor_memory])
    do i = 1, size(seconds)
      call hold_rows(tables%ledger(column_of_location + i - 1), seconds(i:i))
    end do
  end subroutine append_ledger

  !> Writes the rows that wait, a block per column.
  subroutine write_tables(tables, file, error)
    type(run_tables_t), intent(inout) :: tables        !! nothing waits
    type(hdf5_file_t), intent(inout) :: file           !! JOB.vtkhdf
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call write_buffer(tables%history, file, error)
    call write_buffer(tables%iterations, file, error)
    call write_buffer(tables%ledger, file, error)
  end subroutine write_tables

  !> Rows of the longest table that wait.
  pure integer function n_waiting(tables) result(n)
    type(run_tables_t), intent(in) :: tables

    n = max(tables%history(1)%n_waiting, tables%iterations(1)%n_waiting, &
            tables%ledger(1)%n_waiting)
  end function n_waiting

  !> Adds the rows that wait to those that a file has.
  pure subroutine add_waiting_tables(tables, n_rows)
    type(run_tables_t), intent(in) :: tables
    integer(ip), intent(inout) :: n_rows(:) !! (datasets of JOB.vtkhdf)

    call add_waiting(tables%history, n_rows)
    call add_waiting(tables%iterations, n_rows)
    call add_waiting(tables%ledger, n_rows)
  end subroutine add_waiting_tables

  !> A name without the separator of HDF5 paths.
  pure function link_name(name) result(link)
    character(*), intent(in) :: name
    character(len(name)) :: link
    integer :: i

    do i = 1, len(name)
      link(i:i) = merge("_", name(i:i), name(i:i) == "/")
    end do
  end function link_name

end module mpm_run_tables
