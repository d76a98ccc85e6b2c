!> Small bodies on distorted meshes with quadratic parents, and the set-up of one increment on them.
module small_bodies
  use mpm_amplitude, only: amplitude_t, time_increment_t
  use mpm_dof_map, only: constraint_t, number_dofs, turn_prescribed
  use mpm_error, only: error_t
  use mpm_ghost_penalty, only: build_ghost
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: analyse
  use mpm_material, only: law_elastic, law_von_mises, material_t
  use mpm_material_points, only: generate_points, points_t
  use mpm_mesh, only: build_geometry, mesh_t
  use mpm_mesh_generator, only: box_settings_t, generate_box
  use mpm_nodal_frames, only: nodal_frames_t
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_parent_split, only: split_parents
  use mpm_patches, only: patches_from_parents, patches_of_single_elements
  use mpm_point_update, only: accept_points
  use mpm_sparsity, only: build_pattern
  use mpm_system, only: body_t, find_active, system_t
  use random_tensors, only: random_values
  implicit none
  private
  public :: accepted_points, affine, elastic, fill, hold, incline, make_body, move_mesh_along
  public :: on_boundary, plastic

contains

  !> A box of unit cells with interior nodes off their places, without points.
  subroutine make_body(body, n_cell, fbar)
    type(body_t), intent(out) :: body
    integer, intent(in) :: n_cell(:) !! (n_dim)  cells along each axis
    logical, intent(in) :: fbar      !! patches of the parents, else of single elements
    type(box_settings_t) :: box
    type(parent_mesh_t)  :: parent
    type(error_t), allocatable :: error
    integer :: i, bad

    box%n_dim = size(n_cell)
    box%order = 2
    box%split = merge(2, 6, box%n_dim == 2)
    box%x = [(real(i, dp), i=0, n_cell(1))]
    box%y = [(real(i, dp), i=0, n_cell(2))]
    if (box%n_dim == 3) box%z = [(real(i, dp), i=0, n_cell(3))]
    call generate_box(parent, box, error)
    call split_parents(parent, body%mesh, error)
    associate (mesh => body%mesh)
      do i = 1, mesh%n_node
        if (on_boundary(mesh, i)) cycle
        mesh%x(:, i) = mesh%x(:, i) + 0.06_dp*random_values(mesh%n_dim, i)
      end do
      call build_geometry(mesh, bad)
    end associate
    if (fbar) then
      call patches_from_parents(body%patches, body%mesh)
    else
      call patches_of_single_elements(body%patches, body%mesh%n_el)
    end if
    allocate (body%material(1))
    body%material(1) = elastic()
  end subroutine make_body

  !> Points in some elements, with unequal volumes that add up to those of the elements.
  subroutine fill(body, element, n_per_element)
    type(body_t), intent(inout) :: body
    integer, intent(in) :: element(:)    !! elements to fill
    integer, intent(in) :: n_per_element
    type(error_t), allocatable :: error
    real(dp) :: share(n_per_element)
    integer :: i, first

    call generate_points(body%points, body%mesh, element, 1, n_per_element, 2.0_dp, error)
    do i = 1, size(element)
      share = 1.0_dp + 0.5_dp*random_values(n_per_element, i)
      first = (i - 1)*n_per_element
      body%points%volume_0(first + 1:first + n_per_element) = &
        share/sum(share)*body%mesh%volume(element(i))
    end do
    body%points%volume = body%points%volume_0
    body%points%mass = 2.0_dp*body%points%volume_0
  end subroutine fill

  !> Elastic material, E = 100.
  function elastic() result(material)
    type(material_t) :: material

    material%law = law_elastic
    material%young = 100.0_dp
    material%poisson = 0.3_dp
  end function elastic

  !> Nearly incompressible, perfectly plastic material that yields at a strain of 1 %.
  function plastic() result(material)
    type(material_t) :: material

    material%law = law_von_mises
    material%young = 100.0_dp
    material%poisson = 0.48_dp
    material%yield_stress = [1.0_dp]
    material%plastic_strain = [0.0_dp]
  end function plastic

  !> Whether a node lies on the surface of the box.
  pure logical function on_boundary(mesh, node)
    type(mesh_t), intent(in) :: mesh !! the box
    integer, intent(in)      :: node
    real(dp), parameter :: near = 1.0e-9_dp

    on_boundary = any(mesh%x(:, node) < minval(mesh%x, dim=2) + near) .or. &
                  any(mesh%x(:, node) > maxval(mesh%x, dim=2) - near)
  end function on_boundary

  !> Nodal displacements H x of an affine motion.
  pure function affine(mesh, h) result(u)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in)     :: h(:, :)        !! (n_dim, n_dim)  displacement gradient
    real(dp) :: u(mesh%n_dim, mesh%n_node)

    u = matmul(h, mesh%x)
  end function affine

  !> Numbers the unknowns with given displacements on held nodes and builds the pattern.
  subroutine hold(system, body, held, u)
    type(system_t), intent(inout) :: system     !! open
    type(body_t), intent(in) :: body
    logical, intent(in)      :: held(:, :)      !! (n_dim, n_node)
    real(dp), intent(in)     :: u(:, :)         !! (n_dim, n_node)  displacements of the increment
    type(constraint_t) :: constraint(count(held))
    type(amplitude_t)  :: amplitude(0)
    integer :: i, a, k

    k = 0
    do a = 1, size(held, 2)
      do i = 1, size(held, 1)
        if (.not. held(i, a)) cycle
        k = k + 1
        constraint(k)%node = [a]
        constraint(k)%direction = i
        constraint(k)%value = u(i, a)
      end do
    end do
    call find_active(system, body%points)
    call number_dofs(system%dofs, body%mesh, system%active, constraint, &
                     time_increment_t(0.0_dp, 1.0_dp, 1.0_dp), amplitude)
    call build_ghost(system%ghost, body%ghost_gamma, body%mesh, body%points, body%material, &
                     system%active)
    call build_pattern(system%tangent, system%map, body%patches, body%mesh, system%dofs, &
                       system%active, system%ghost%node)
    call analyse(system%solver, system%tangent, k)
  end subroutine hold

  !> Turns the body, and what holds it, by giving all nodes the turned axes.
  subroutine incline(system, body, q)
    type(system_t), intent(inout) :: system !! held as the body was before
    type(body_t), intent(inout) :: body     !! turned about the origin
    real(dp), intent(in) :: q(:, :)         !! (n_dim, n_dim)  rotation
    type(nodal_frames_t) :: frames
    integer :: i

    body%mesh%x = matmul(q, body%mesh%x)
    call build_geometry(body%mesh, i)
    frames%of_node = [(1, i=1, body%mesh%n_node)]
    frames%rotation = reshape(transpose(q), [size(q, 1), size(q, 1), 1])
    call turn_prescribed(system%dofs, frames)
    call build_ghost(system%ghost, body%ghost_gamma, body%mesh, body%points, body%material, &
                     system%active)
    call build_pattern(system%tangent, system%map, body%patches, body%mesh, system%dofs, &
                       system%active, system%ghost%node)
    call analyse(system%solver, system%tangent, i)
  end subroutine incline

  !> The points as they would be if the trial state were accepted.
  function accepted_points(body, system) result(points)
    type(body_t), intent(in)   :: body
    type(system_t), intent(in) :: system !! evaluated
    type(points_t) :: points
    type(body_t) :: next

    next = body
    call accept_points(next, system)
    points = next%points
  end function accepted_points

  !> Moves all nodes of the mesh; points keep their hosts and shape functions.
  subroutine move_mesh_along(body, u)
    type(body_t), intent(inout) :: body
    real(dp), intent(in) :: u(:, :) !! (n_dim, n_node)
    integer :: bad

    body%mesh%x = body%mesh%x + u
    call build_geometry(body%mesh, bad)
  end subroutine move_mesh_along

end module small_bodies
