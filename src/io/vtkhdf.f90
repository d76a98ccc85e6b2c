!> Files of Kitware's VTKHDF format: an unstructured grid that changes in time.
!!
!! What describes a step waits in memory until the next flush; its values are written at once.
!! A grid of the same cells as at the step before refers to the cells written then; a field that
!! has not changed refers to the values written before. Every procedure but create_vtkhdf returns
!! at once when `error` is set already.
module mpm_vtkhdf
  use mpm_error, only: error_t
  use mpm_hdf5_file, only: close_hdf5_file, create_hdf5_file, hdf5_file_t, make_group, &
                           publish_hdf5_file, write_integers_attribute, write_text_attribute
  use mpm_hdf5_series, only: append_rows, create_series, kind_float64, kind_int32, &
                             kind_int64, kind_uint8, row_count, series_layout_t, series_t
  use mpm_hdf5_resume, only: refuse_resume, resume_rows
  use mpm_kinds, only: dp, ip
  use mpm_output_mark, only: file_mark_t
  use mpm_row_buffer, only: add_waiting, create_buffer, hold_rows, row_buffer_t, write_buffer
  implicit none
  private
  public :: vtkhdf_t, close_vtkhdf, create_vtkhdf, flush_vtkhdf, mark_vtkhdf, resume_vtkhdf
  public :: add_field, begin_vtk_step, repeat_field, write_cells, write_field, write_integer_field
  public :: on_cells, on_points, vtk_tetra, vtk_triangle, vtk_vertex, chunk_for, in_space

  integer, parameter :: vtk_vertex = 1    !! cell of one node
  integer, parameter :: vtk_triangle = 5  !! cell of three nodes
  integer, parameter :: vtk_tetra = 10    !! cell of four nodes
  integer, parameter :: on_points = 1     !! a field with one value per point
  integer, parameter :: on_cells = 2      !! a field with one value per cell
  ! Datasets with a row per step.
  integer, parameter :: step_time = 1, step_part = 2, step_n_parts = 3, step_point = 4
  integer, parameter :: step_cell = 5, step_id = 6
  integer, parameter :: rows_at_once = 8388608 !! largest chunk: a field of a step in one piece
  character(*), parameter :: folder_of(2) = ["PointData", "CellData "]

  !> A field of a file.
  type :: field_t
    character(:), allocatable :: name
    type(series_t) :: values           !! all values, one step after the other
    type(row_buffer_t) :: offsets      !! first row of each step
    integer(ip) :: last_offset = 0_ip  !! first row of the values written last
  end type field_t

  !> The datasets that describe the grid, each with a row per set of cells.
  type :: cells_t
    type(series_t) :: n_points, n_cells, n_ids     !! counts
    type(series_t) :: connectivity, offsets, types
    integer(ip) :: first_cell = 0_ip !! of the cells written last
    integer(ip) :: first_id = 0_ip   !! of the connectivity written last
  end type cells_t

  !> An open file.
  type :: vtkhdf_t
    type(hdf5_file_t) :: file
    integer :: n_steps = 0
    type(cells_t)  :: cells
    type(row_buffer_t) :: step(6)      !! step_*, a row per step each
    type(series_t) :: points
    type(field_t), allocatable :: field(:)
  end type vtkhdf_t

contains

  !> Creates a file without steps.
  subroutine create_vtkhdf(vtk, path, n_points, n_cells, error, kind)
    type(vtkhdf_t), intent(out) :: vtk               !! open
    character(*), intent(in) :: path                 !! file
    integer, intent(in) :: n_points                  !! expected points of a step
    integer, intent(in) :: n_cells                   !! expected cells of a step
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer, intent(in), optional :: kind            !! of coordinates: kind_float64 or kind_float32
    integer :: of_coordinates

    of_coordinates = kind_float64
    if (present(kind)) of_coordinates = kind
    allocate (vtk%field(0))
    call create_hdf5_file(vtk%file, path, error)
    call make_group(vtk%file, "/VTKHDF", error)
    call write_integers_attribute(vtk%file, "/VTKHDF", "Version", [2_ip, 1_ip], error)
    call write_text_attribute(vtk%file, "/VTKHDF", "Type", "UnstructuredGrid", error)
    call make_group(vtk%file, "/VTKHDF/PointData", error)
    call make_group(vtk%file, "/VTKHDF/CellData", error)
    call create_series(vtk%points, vtk%file, "/VTKHDF/Points", &
                       series_layout_t(of_coordinates, 3, chunk_for(n_points)), error)
    call create_cells(vtk%cells, vtk%file, n_cells, error)
    call create_steps(vtk%step, vtk%file, error)
  end subroutine create_vtkhdf

  !> Creates the datasets of the grid.
  subroutine create_cells(cells, file, n_cells, error)
    type(cells_t), intent(out) :: cells                !! open
    type(hdf5_file_t), intent(inout) :: file           !! open
    integer, intent(in) :: n_cells                     !! expected cells
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(series_layout_t) :: index_layout

    index_layout = series_layout_t(kind_int64, 0, chunk_for(n_cells), .true.)
    call create_counter(cells%n_points, file, "/VTKHDF/NumberOfPoints", error)
    call create_counter(cells%n_cells, file, "/VTKHDF/NumberOfCells", error)
    call create_counter(cells%n_ids, file, "/VTKHDF/NumberOfConnectivityIds", error)
    call create_series(cells%connectivity, file, "/VTKHDF/Connectivity", index_layout, error)
    call create_series(cells%offsets, file, "/VTKHDF/Offsets", index_layout, error)
    call create_series(cells%types, file, "/VTKHDF/Types", &
                       series_layout_t(kind_uint8, 0, chunk_for(n_cells), .true.), error)
  end subroutine create_cells

  !> Creates the datasets of the steps.
  subroutine create_steps(step, file, error)
    type(row_buffer_t), intent(out) :: step(:)         !! (6) open
    type(hdf5_file_t), intent(inout) :: file           !! open
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(series_layout_t) :: counter, row

    call make_group(file, "/VTKHDF/Steps", error)
    call write_integers_attribute(file, "/VTKHDF/Steps", "NSteps", [0_ip], error)
    call make_group(file, "/VTKHDF/Steps/PointDataOffsets", error)
    call make_group(file, "/VTKHDF/Steps/CellDataOffsets", error)
    counter = series_layout_t(kind_int64)
    row = series_layout_t(kind_int64, 1)
    call create_buffer(step(step_time), file, "/VTKHDF/Steps/Values", series_layout_t(), error)
    call create_buffer(step(step_part), file, "/VTKHDF/Steps/PartOffsets", counter, error)
    call create_buffer(step(step_n_parts), file, "/VTKHDF/Steps/NumberOfParts", counter, error)
    call create_buffer(step(step_point), file, "/VTKHDF/Steps/PointOffsets", counter, error)
    call create_buffer(step(step_cell), file, "/VTKHDF/Steps/CellOffsets", row, error)
    call create_buffer(step(step_id), file, "/VTKHDF/Steps/ConnectivityIdOffsets", row, error)
  end subroutine create_steps

  !> Creates a dataset of counts or offsets.
  subroutine create_counter(series, file, name, error)
    type(series_t), intent(out) :: series              !! open
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call create_series(series, file, name, series_layout_t(kind_int64), error)
  end subroutine create_counter

  !> Adds a field before the first step; fields are known by the order of their addition.
  subroutine add_field(vtk, name, place, layout, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! has one field more
    character(*), intent(in) :: name                   !! of the field
    integer, intent(in) :: place                       !! on_points or on_cells
    type(series_layout_t), intent(in) :: layout        !! of its values
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(field_t), allocatable :: longer(:)
    integer :: n

    if (allocated(error)) return
    n = size(vtk%field)
    allocate (longer(n + 1))
    longer(:n) = vtk%field
    longer(n + 1)%name = name
    call create_series(longer(n + 1)%values, vtk%file, &
                       "/VTKHDF/"//trim(folder_of(place))//"/"//name, layout, error)
    call create_buffer(longer(n + 1)%offsets, vtk%file, &
                       "/VTKHDF/Steps/"//trim(folder_of(place))//"Offsets/"//name, &
                       series_layout_t(kind_int64), error)
    call move_alloc(longer, vtk%field)
  end subroutine add_field

  !> Writes the cells of the steps to come, all of one type.
  subroutine write_cells(vtk, cell_type, node, n_points, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! its cells from now on
    integer, intent(in) :: cell_type                   !! vtk_*
    integer, intent(in) :: node(:, :)                  !! (nodes of a cell, n_cells) from 1
    integer, intent(in) :: n_points                    !! points of the grid
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer(ip) :: i, n_cells, n_corners

    n_corners = size(node, 1, ip)
    n_cells = size(node, 2, ip)
    associate (cells => vtk%cells, file => vtk%file)
      cells%first_cell = row_count(cells%types, file)
      cells%first_id = row_count(cells%connectivity, file)
      call append_rows(cells%n_points, file, [int(n_points, ip)], error)
      call append_rows(cells%n_cells, file, [n_cells], error)
      call append_rows(cells%n_ids, file, [n_corners*n_cells], error)
      call append_rows(cells%connectivity, file, reshape(int(node - 1, ip), [n_corners*n_cells]), &
                       error)
      call append_rows(cells%offsets, file, [(n_corners*i, i=0, n_cells)], error)
      call append_rows(cells%types, file, [(int(cell_type, ip), i=1, n_cells)], error)
    end associate
  end subroutine write_cells

  !> Starts a step: its time, its points, the cells written last. All fields must follow.
  subroutine begin_vtk_step(vtk, time, x, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! has one step more after its flush
    real(dp), intent(in) :: time                       !! total time
    real(dp), intent(in) :: x(:, :)                    !! (2 or 3, n) coordinates [length]
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    vtk%n_steps = vtk%n_steps + 1
    associate (step => vtk%step, file => vtk%file)
      call hold_rows(step(step_time), [time])
      call hold_rows(step(step_part), [row_count(vtk%cells%n_points, file) - 1_ip])
      call hold_rows(step(step_n_parts), [1_ip])
      call hold_rows(step(step_point), [row_count(vtk%points, file)])
      call hold_rows(step(step_cell), [vtk%cells%first_cell])
      call hold_rows(step(step_id), [vtk%cells%first_id])
    end associate
    if (size(x, 1) == 3) then
      call append_rows(vtk%points, vtk%file, x, error)
    else
      call append_rows(vtk%points, vtk%file, in_space(x), error)
    end if
  end subroutine begin_vtk_step

  !> Writes a field of reals.
  subroutine write_field(vtk, i, values, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! in a step
    integer, intent(in)  :: i                          !! number of the field
    real(dp), intent(in) :: values(:, :)               !! (components, n)
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    vtk%field(i)%last_offset = row_count(vtk%field(i)%values, vtk%file)
    call repeat_field(vtk, i, error)
    call append_rows(vtk%field(i)%values, vtk%file, values, error)
  end subroutine write_field

  !> Writes a field of integers.
  subroutine write_integer_field(vtk, i, values, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! in a step
    integer, intent(in) :: i                           !! number of the field
    integer, intent(in) :: values(:)                   !! (n)
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    vtk%field(i)%last_offset = row_count(vtk%field(i)%values, vtk%file)
    call repeat_field(vtk, i, error)
    call append_rows(vtk%field(i)%values, vtk%file, values, error)
  end subroutine write_integer_field

  !> Gives a field the values that were written last.
  subroutine repeat_field(vtk, i, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! in a step
    integer, intent(in) :: i                           !! number of the field
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (.not. allocated(error)) call hold_rows(vtk%field(i)%offsets, [vtk%field(i)%last_offset])
  end subroutine repeat_field

  !> Makes the steps written so far visible to a reader.
  subroutine flush_vtkhdf(vtk, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! after the last field of a step
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call count_steps(vtk, error)
    call publish_hdf5_file(vtk%file, error)
  end subroutine flush_vtkhdf

  !> Writes what describes the steps, and how many there are, if any are new.
  subroutine count_steps(vtk, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! after the last field of a step
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: i

    if (.not. vtk%file%has_news) return
    call write_buffer(vtk%step, vtk%file, error)
    do i = 1, size(vtk%field)
      call write_buffer(vtk%field(i)%offsets, vtk%file, error)
    end do
    call write_integers_attribute(vtk%file, "/VTKHDF/Steps", "NSteps", [int(vtk%n_steps, ip)], &
                                  error)
  end subroutine count_steps

  !> Where a file stands after a step.
  pure subroutine mark_vtkhdf(vtk, mark)
    type(vtkhdf_t), intent(in) :: vtk       !! open
    type(file_mark_t), intent(out) :: mark
    integer :: i

    mark%n_steps = int(vtk%n_steps, ip)
    mark%first_cell = vtk%cells%first_cell
    mark%first_id = vtk%cells%first_id
    mark%last_offset = vtk%field%last_offset
    mark%n_rows = vtk%file%dataset%n_rows
    call add_waiting(vtk%step, mark%n_rows)
    do i = 1, size(vtk%field)
      call add_waiting(vtk%field(i)%offsets, mark%n_rows)
    end do
  end subroutine mark_vtkhdf

  !> Takes the steps up to a mark from the file with the same path, which the run to go on with
  !! has left; all fields must have been added.
  subroutine resume_vtkhdf(vtk, mark, object, run_id, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! without steps; stands at the mark then
    type(file_mark_t), intent(in) :: mark              !! where the file stood
    character(*), intent(in) :: object                 !! group with the attribute run
    character(*), intent(in) :: run_id                 !! of the run to go on with
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (allocated(error)) return
    if (size(mark%last_offset) /= size(vtk%field)) then
      call refuse_resume(error, vtk%file%path, "the deck asks for other fields")
      return
    end if
    call resume_rows(vtk%file, mark%n_rows, object, run_id, error)
    vtk%n_steps = int(mark%n_steps)
    vtk%cells%first_cell = mark%first_cell
    vtk%cells%first_id = mark%first_id
    vtk%field%last_offset = mark%last_offset
    call write_integers_attribute(vtk%file, "/VTKHDF/Steps", "NSteps", [mark%n_steps], error)
  end subroutine resume_vtkhdf

  !> Flushes and closes a file; no effect on a closed one. After an error the steps since the last
  !! flush are lost, and a file that was never flushed is not there.
  subroutine close_vtkhdf(vtk, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! closed
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    if (vtk%file%is_open .and. .not. vtk%file%has_failed) call count_steps(vtk, error)
    call close_hdf5_file(vtk%file, error)
  end subroutine close_vtkhdf

  !> Rows stored together when each step writes n of them.
  pure function chunk_for(n) result(rows)
    integer, intent(in) :: n !! rows of a step
    integer :: rows

    rows = max(1, min(n, rows_at_once))
  end function chunk_for

  !> Coordinates or vectors with three components, the third 0 in the plane.
  pure function in_space(x) result(x_3)
    real(dp), intent(in) :: x(:, :)      !! (2 or 3, n)
    real(dp), allocatable :: x_3(:, :)   !! (3, n)

    allocate (x_3(3, size(x, 2)), source=0.0_dp)
    x_3(:size(x, 1), :) = x
  end function in_space

end module mpm_vtkhdf
