!> JOB.vtkhdf and JOB_mesh.vtkhdf: fields of points and mesh per output increment.
!!
!! The group /tessera of JOB.vtkhdf holds everything else about the run, see mpm_run_tables.
module mpm_results_file
  use mpm_error, only: error_t
  use mpm_hdf5_series, only: kind_float32, kind_float64, kind_int32, series_layout_t
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t, status_removed
  use mpm_mesh, only: mesh_t
  use mpm_model, only: model_t, step_t
  use mpm_point_fields, only: gather_field, gather_indices, gather_vectors, is_integer_field, &
                              n_field_components
  use mpm_run_state, only: run_state_t
  use mpm_vtkhdf, only: add_field, begin_vtk_step, chunk_for, close_vtkhdf, create_vtkhdf, &
                        flush_vtkhdf, in_space, on_cells, on_points, repeat_field, vtk_tetra, &
                        vtk_triangle, vtk_vertex, vtkhdf_t, write_cells, write_field, &
                        write_integer_field
  implicit none
  private
  public :: results_file_t, close_results, field_names, is_field_output_due, is_single, open_results
  public :: publish_results, write_increment_fields

  character(8), parameter :: default_fields(12) = [character(8) :: "S", "TAU", "LE", "PEEQ", "J", &
    "JBAR", "U", "VOL", "MAT", "PATCH", "ELEMENT", "ID"]
  character(8), parameter :: constant_fields(2) = [character(8) :: "MAT", "ID"]
  real(dp), parameter :: time_tolerance = 1.0e-9_dp !! relative to the period of a step

  !> The two files.
  type :: results_file_t
    type(vtkhdf_t) :: points                !! material points
    type(vtkhdf_t) :: mesh                  !! background mesh
    character(8), allocatable :: field(:)   !! point fields
    integer :: n_written = -1               !! points of the step written last
  end type results_file_t

contains

  !> Opens both files without steps.
  subroutine open_results(results, points_path, mesh_path, model, error)
    type(results_file_t), intent(out) :: results     !! open
    character(*), intent(in) :: points_path          !! JOB.vtkhdf
    character(*), intent(in) :: mesh_path            !! JOB_mesh.vtkhdf
    type(model_t), intent(in) :: model               !! mesh, points, output requests
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer :: i, kind

    results%field = field_names(model)
    kind = merge(kind_float32, kind_float64, is_single(model))
    call create_vtkhdf(results%points, points_path, model%points%n, model%points%n, error, kind)
    do i = 1, size(results%field)
      call add_field(results%points, trim(results%field(i)), on_points, &
                     point_layout(results%field(i), model%points%n, kind), error)
    end do
    if (allocated(error)) return
    call create_vtkhdf(results%mesh, mesh_path, model%mesh%n_node, model%mesh%n_el, error)
    call add_mesh_fields(results%mesh, model%mesh, error)
  end subroutine open_results

  !> Adds the fields of the mesh in the order in which write_mesh writes them.
  subroutine add_mesh_fields(vtk, mesh, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! without fields
    type(mesh_t), intent(in) :: mesh                   !! for its sizes
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(series_layout_t) :: force_layout, index_layout, scalar_layout, vector_layout

    vector_layout = series_layout_t(n_columns=3, chunk_rows=chunk_for(mesh%n_node))
    force_layout = series_layout_t(n_columns=3, chunk_rows=chunk_for(mesh%n_node), &
                                   compressed=.true.)
    scalar_layout = series_layout_t(chunk_rows=chunk_for(mesh%n_el), compressed=.true.)
    index_layout = series_layout_t(kind_int32, 0, chunk_for(mesh%n_el), .true.)
    call add_field(vtk, "U_INC", on_points, vector_layout, error)
    call add_field(vtk, "U", on_points, vector_layout, error)
    call add_field(vtk, "RF", on_points, force_layout, error)
    call add_field(vtk, "PATCH", on_cells, index_layout, error)
    call add_field(vtk, "NPOINTS", on_cells, index_layout, error)
    call add_field(vtk, "ACTIVE", on_cells, index_layout, error)
    call add_field(vtk, "J", on_cells, scalar_layout, error)
    call add_field(vtk, "JPATCH", on_cells, scalar_layout, error)
  end subroutine add_mesh_fields

  !> Writes points and mesh of an increment.
  subroutine write_increment_fields(results, model, mesh, points, state, error)
    type(results_file_t), intent(inout) :: results   !! has one step more
    type(model_t), intent(in)     :: model           !! patches
    type(mesh_t), intent(in)      :: mesh            !! where it is now
    type(points_t), intent(in)    :: points          !! converged state
    type(run_state_t), intent(in) :: state           !! time and nodal values
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call write_points(results, model, points, state%time, error)
    call write_mesh(results%mesh, model, mesh, points, state, error)
  end subroutine write_increment_fields

  !> Writes the material points that were not removed.
  subroutine write_points(results, model, points, time, error)
    type(results_file_t), intent(inout) :: results     !! has one step more
    type(model_t), intent(in)  :: model                !! patches
    type(points_t), intent(in) :: points               !! converged state
    real(dp), intent(in) :: time                       !! total time
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer, allocatable :: kept(:), numbers(:)
    real(dp), allocatable :: values(:, :)
    logical :: same_points
    integer :: i, n

    n = count(points%status /= status_removed)
    kept = points%place ! by id
    if (n < points%n) kept = pack(kept, points%status(kept) /= status_removed)
    same_points = n == results%n_written ! points may leave, but none comes back
    if (.not. same_points) then
      call write_cells(results%points, vtk_vertex, reshape([(i, i=1, n)], [1, n]), n, error)
    end if
    results%n_written = n
    call gather_vectors(values, points%x, kept)
    call begin_vtk_step(results%points, time, values, error)
    do i = 1, size(results%field)
      if (allocated(error)) return
      if (same_points .and. any(results%field(i) == constant_fields)) then
        call repeat_field(results%points, i, error)
        cycle
      end if
      if (is_integer_field(trim(results%field(i)))) then
        call gather_indices(numbers, points, model%patches, trim(results%field(i)), kept)
        call write_integer_field(results%points, i, numbers, error)
      else
        call gather_field(values, points, trim(results%field(i)), kept)
        call write_field(results%points, i, values, error)
      end if
    end do
  end subroutine write_points

  !> Writes the background mesh: the cells once, everything that changes per step.
  subroutine write_mesh(vtk, model, mesh, points, state, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! has one step more
    type(model_t), intent(in)     :: model             !! patches
    type(mesh_t), intent(in)      :: mesh              !! where it is now
    type(points_t), intent(in)    :: points            !! their host elements
    type(run_state_t), intent(in) :: state             !! time and nodal values
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer, allocatable :: n_points(:)

    n_points = points_of_elements(points, mesh%n_el)
    if (vtk%n_steps == 0) then
      call write_cells(vtk, merge(vtk_triangle, vtk_tetra, mesh%n_dim == 2), mesh%node, &
                       mesh%n_node, error)
    end if
    call begin_vtk_step(vtk, state%time, mesh%x, error)
    call write_field(vtk, 1, in_space(state%delta_u), error)
    call write_field(vtk, 2, in_space(state%node_u), error)
    call write_field(vtk, 3, in_space(state%reaction), error)
    if (vtk%n_steps == 1) then
      call write_integer_field(vtk, 4, model%patches%of_element, error)
    else
      call repeat_field(vtk, 4, error)
    end if
    call write_integer_field(vtk, 5, n_points, error)
    call write_integer_field(vtk, 6, merge(1, 0, n_points > 0), error)
    call write_field(vtk, 7, reshape(state%delta_j, [1, mesh%n_el]), error)
    call write_field(vtk, 8, reshape(state%delta_j_patch(model%patches%of_element), &
                                     [1, mesh%n_el]), error)
  end subroutine write_mesh

  !> Makes what was written visible to a reader: points first, so that no mesh is without them.
  subroutine publish_results(results, error)
    type(results_file_t), intent(inout) :: results     !! after the last field of an increment
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    call flush_vtkhdf(results%points, error)
    call flush_vtkhdf(results%mesh, error)
  end subroutine publish_results

  !> Publishes and closes both files; no effect on closed ones. After an error nothing new gets into
  !! them, nor after a failure of the points into the mesh.
  subroutine close_results(results, error)
    type(results_file_t), intent(inout) :: results     !! closed
    type(error_t), allocatable, intent(inout) :: error !! exit_file

    results%mesh%file%has_failed = results%mesh%file%has_failed .or. results%points%file%has_failed
    call close_vtkhdf(results%points, error)
    call close_vtkhdf(results%mesh, error)
  end subroutine close_results

  !> Point fields that any step asks for; all of them are written at every output.
  pure function field_names(model) result(names)
    type(model_t), intent(in) :: model
    character(8), allocatable :: names(:) !! each once, ID always among them
    integer :: i

    allocate (names(0))
    do i = 1, size(model%step)
      if (.not. model%step(i)%has_field_output) cycle
      if (size(model%step(i)%field_output%field) == 0) then
        call add_names(names, default_fields)
      else
        call add_names(names, model%step(i)%field_output%field)
      end if
    end do
    if (size(names) == 0) call add_names(names, default_fields)
    call add_names(names, ["ID      "])
  end function field_names

  !> Whether the fields of points are stored in single precision: all steps that ask for fields
  !! agree.
  pure logical function is_single(model)
    type(model_t), intent(in) :: model

    is_single = any(model%step%has_field_output .and. model%step%field_output%single)
  end function is_single

  !> Adds the names that are not there yet.
  pure subroutine add_names(names, new)
    character(8), allocatable, intent(inout) :: names(:) !! perhaps longer
    character(8), intent(in) :: new(:)                   !! candidates
    integer :: i

    do i = 1, size(new)
      if (.not. any(names == new(i))) names = [names, new(i)]
    end do
  end subroutine add_names

  !> Whether the fields of an accepted increment are to be written: as the step asks, and at
  !! the end of every step.
  pure function is_field_output_due(step, state) result(due)
    type(step_t), intent(in) :: step       !! the step of the increment
    type(run_state_t), intent(in) :: state !! after the increment
    logical :: due
    real(dp) :: intervals, tolerance

    tolerance = time_tolerance*step%schedule%period
    due = state%step_time >= step%schedule%period - tolerance
    if (due .or. .not. step%has_field_output) return
    if (step%field_output%time_interval > 0.0_dp) then
      intervals = state%step_time/step%field_output%time_interval
      due = abs(intervals - anint(intervals))*step%field_output%time_interval <= tolerance
    else if (step%field_output%frequency > 0) then
      due = mod(state%increment, step%field_output%frequency) == 0
    end if
  end function is_field_output_due

  !> How the values of a point field are stored. Displacements, as coordinates, differ from point to
  !! point in all their digits: they would cost most time and gain an eighth.
  pure function point_layout(name, n_points, kind) result(layout)
    character(*), intent(in) :: name    !! of the field
    integer, intent(in) :: n_points     !! points of a step
    integer, intent(in) :: kind         !! of reals
    type(series_layout_t) :: layout

    layout%kind = kind
    layout%chunk_rows = chunk_for(n_points)
    layout%compressed = name /= "U"
    layout%n_columns = n_field_components(trim(name))
    if (layout%n_columns == 1) layout%n_columns = 0
    if (is_integer_field(trim(name))) layout%kind = kind_int32
  end function point_layout

  !> Number of points in each element.
  pure function points_of_elements(points, n_el) result(n_points)
    type(points_t), intent(in) :: points !! their host elements
    integer, intent(in) :: n_el          !! elements
    integer :: n_points(n_el)
    integer :: p

    n_points = 0
    do p = 1, points%n
      if (points%element(p) > 0) n_points(points%element(p)) = n_points(points%element(p)) + 1
    end do
  end function points_of_elements

end module mpm_results_file
