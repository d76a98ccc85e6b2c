!> JOB_fail.vtkhdf: the attempt that ended a run, on the background mesh as the attempt found it.
module mpm_fail_file
  use mpm_error, only: error_t
  use mpm_failure_evidence, only: failure_evidence_t, fill_fractions, free_residual
  use mpm_failure_text, only: element_label
  use mpm_hdf5_file, only: hdf5_file_t, make_group, write_integers_attribute, write_text, &
                           write_text_attribute
  use mpm_hdf5_series, only: append_rows, create_series, kind_int32, series_layout_t, series_t
  use mpm_kinds, only: dp, ip
  use mpm_system, only: body_t, system_t
  use mpm_vtkhdf, only: add_field, begin_vtk_step, chunk_for, close_vtkhdf, create_vtkhdf, &
                        flush_vtkhdf, in_space, on_cells, on_points, vtk_tetra, vtk_triangle, &
                        vtkhdf_t, write_cells, write_field, write_integer_field
  implicit none
  private
  public :: failure_t, write_fail_file

  !> What the file tells beside the fields.
  type :: failure_t
    integer  :: exit_code = 0                 !! of the program
    integer  :: step = 0                      !! number of the step
    integer  :: increment = 0                 !! number of the increment in the step
    integer  :: attempt = 0                   !! at this increment; 0: it had been accepted
    real(dp) :: time = 0.0_dp                 !! total time at the end of the attempt
    character(:), allocatable :: outcome      !! of the last attempt, in words
    character(:), allocatable :: message      !! complete text for the user
    type(failure_evidence_t)  :: evidence     !! worst node, element and point
  end type failure_t

contains

  !> Writes the file, which gets its name when it is complete.
  subroutine write_fail_file(path, failure, body, system, error)
    character(*), intent(in)     :: path             !! JOB_fail.vtkhdf
    type(failure_t), intent(in)  :: failure
    type(body_t), intent(in)     :: body             !! as the attempt found it
    type(system_t), intent(in)   :: system           !! as the attempt left it
    type(error_t), allocatable, intent(out) :: error !! exit_file
    type(vtkhdf_t) :: vtk
    type(error_t), allocatable :: late

    associate (mesh => body%mesh)
      call create_vtkhdf(vtk, path, mesh%n_node, mesh%n_el, error)
      call add_fields(vtk, mesh%n_node, mesh%n_el, error)
      call write_cells(vtk, merge(vtk_triangle, vtk_tetra, mesh%n_dim == 2), mesh%node, &
                       mesh%n_node, error)
      call begin_vtk_step(vtk, failure%time, mesh%x, error)
    end associate
    call write_fields(vtk, failure%evidence, body, system, error)
    call write_facts(vtk%file, failure, body, error)
    call flush_vtkhdf(vtk, error)
    call close_vtkhdf(vtk, late)
    if (.not. allocated(error)) call move_alloc(late, error)
  end subroutine write_fail_file

  !> Adds the fields in the order in which write_fields writes them.
  subroutine add_fields(vtk, n_node, n_el, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! without fields
    integer, intent(in) :: n_node                      !! nodes
    integer, intent(in) :: n_el                        !! elements
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(series_layout_t) :: flag_layout, index_layout, scalar_layout, vector_layout

    vector_layout = series_layout_t(n_columns=3, chunk_rows=chunk_for(n_node), compressed=.true.)
    flag_layout = series_layout_t(kind_int32, 0, chunk_for(n_node), .true.)
    scalar_layout = series_layout_t(chunk_rows=chunk_for(n_el), compressed=.true.)
    index_layout = series_layout_t(kind_int32, 0, chunk_for(n_el), .true.)
    call add_field(vtk, "U_INC", on_points, vector_layout, error)
    call add_field(vtk, "RESIDUAL", on_points, vector_layout, error)
    call add_field(vtk, "WORST", on_points, flag_layout, error)
    call add_field(vtk, "PATCH", on_cells, index_layout, error)
    call add_field(vtk, "NPOINTS", on_cells, index_layout, error)
    call add_field(vtk, "ACTIVE", on_cells, index_layout, error)
    call add_field(vtk, "FILL", on_cells, scalar_layout, error)
    call add_field(vtk, "J", on_cells, scalar_layout, error)
    call add_field(vtk, "WORST", on_cells, index_layout, error)
  end subroutine add_fields

  !> Writes the fields.
  subroutine write_fields(vtk, evidence, body, system, error)
    type(vtkhdf_t), intent(inout) :: vtk               !! in its step
    type(failure_evidence_t), intent(in) :: evidence   !! worst node and element
    type(body_t), intent(in)   :: body                 !! as the attempt found it
    type(system_t), intent(in) :: system               !! as the attempt left it
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    integer :: n_points(body%mesh%n_el), worst_node(body%mesh%n_node), worst(body%mesh%n_el)
    real(dp) :: det_f(body%mesh%n_el)

    if (allocated(error)) return
    n_points = body%points%first(2:) - body%points%first(:body%mesh%n_el)
    det_f = merge(1.0_dp + system%kinematics%delta_j_m1, 1.0_dp, n_points > 0)
    worst_node = 0
    worst = 0
    if (evidence%node > 0) worst_node(evidence%node) = 1
    if (evidence%element > 0) worst(evidence%element) = 1
    call write_field(vtk, 1, in_space(system%u), error)
    call write_field(vtk, 2, in_space(free_residual(system)), error)
    call write_integer_field(vtk, 3, worst_node, error)
    call write_integer_field(vtk, 4, body%patches%of_element, error)
    call write_integer_field(vtk, 5, n_points, error)
    call write_integer_field(vtk, 6, merge(1, 0, n_points > 0), error)
    call write_field(vtk, 7, reshape(fill_fractions(body%mesh, body%points), &
                                     [1, body%mesh%n_el]), error)
    call write_field(vtk, 8, reshape(det_f, [1, body%mesh%n_el]), error)
    call write_integer_field(vtk, 9, worst, error)
  end subroutine write_fields

  !> Writes the group /tessera.
  subroutine write_facts(file, failure, body, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    type(failure_t), intent(in)   :: failure
    type(body_t), intent(in)      :: body              !! as the attempt found it
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    character(*), parameter :: group = "/tessera"

    call make_group(file, group, error)
    call write_text(file, group//"/message", failure%message, error)
    call write_text_attribute(file, group, "outcome", failure%outcome, error)
    call write_integers_attribute(file, group, "exit_code", [int(failure%exit_code, ip)], error)
    call write_integers_attribute(file, group, "step", [int(failure%step, ip)], error)
    call write_integers_attribute(file, group, "increment", [int(failure%increment, ip)], error)
    call write_integers_attribute(file, group, "attempt", [int(failure%attempt, ip)], error)
    associate (evidence => failure%evidence, mesh => body%mesh)
      if (evidence%node > 0) call write_place(file, group//"/worst_node", &
        mesh%node_label(evidence%node), mesh%x(:, [evidence%node]), error)
      if (evidence%element > 0) call write_place(file, group//"/worst_element", &
        element_label(mesh, evidence%element), mesh%x(:, mesh%node(:, evidence%element)), error)
      if (evidence%point > 0) call write_place(file, group//"/worst_point", &
        body%points%id(evidence%point), body%points%x(:, [evidence%point]), error)
    end associate
  end subroutine write_facts

  !> Writes the middle of some positions, with the number of what is there as attribute `label`.
  subroutine write_place(file, name, label, x, error)
    type(hdf5_file_t), intent(inout) :: file           !! open
    character(*), intent(in) :: name                   !! absolute path of the dataset
    integer, intent(in)      :: label                  !! number in the input
    real(dp), intent(in)     :: x(:, :)                !! (n_dim, n)  positions [length]
    type(error_t), allocatable, intent(inout) :: error !! exit_file
    type(series_t) :: series

    call create_series(series, file, name, series_layout_t(chunk_rows=size(x, 1)), error)
    call append_rows(series, file, sum(x, dim=2)/real(size(x, 2), dp), error)
    call write_integers_attribute(file, name, "label", [int(label, ip)], error)
  end subroutine write_place

end module mpm_fail_file
