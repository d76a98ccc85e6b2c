!> The model in words, for the log.
module mpm_log_model
  use mpm_equilibrium, only: newton_settings_t
  use mpm_initial_stress, only: initial_stress_t
  use mpm_kinds, only: dp
  use mpm_linear_method, only: library_of, method_automatic, method_name, method_recycled
  use mpm_linear_solver, only: library_single
  use mpm_material, only: law_von_mises, material_t
  use mpm_mesh, only: face_set_t, mesh_t
  use mpm_mesh_motion, only: mesh_motion_t
  use mpm_model, only: formulation_fbar, model_t, step_t
  use mpm_point_location, only: lost_is_error, lost_is_frozen
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: freedom_ratio_text, model_text, set_text

  character(*), parameter :: line_end = new_line("a")

contains

  !> Every setting in force, from the deck or by default.
  pure function model_text(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    integer :: i

    text = "settings in force, from the deck or by default"//line_end &
           //"  formulation: "//trim(merge("F-bar patch", "standard   ", &
                                           model%formulation == formulation_fbar))//line_end &
           //"  patches: source "//model%patch_source
    if (model%patch_source == "METIS") text = text//", size "//integer_text(model%patch_size)
    text = text//line_end//"  mesh: "//motion_text(model%motion)
    text = text//line_end//"  axes of nodes: "//axes_text(model)
    text = text//line_end//"  lost points: "//lost_action_text(model%location%lost_action) &
           //", tolerance "//real_text(model%location%tolerance)//line_end &
           //"  ghost penalty: "//ghost_text(model%ghost_gamma)//line_end
    if (model%locking_meter) text = text//"  locking meter: the continuum has " &
      & //integer_text(model%mesh%n_dim)//" unknowns per volumetric constraint"//line_end
    do i = 1, size(model%material)
      text = text//material_text(model%material(i))
    end do
    if (allocated(model%initial_stress)) text = text//initial_text(model%initial_stress)
    do i = 1, size(model%step)
      text = text//step_text(model%step(i), i)
    end do
    text = text//mesh_text(model)
  end function model_text

  !> What the mesh does after an increment.
  pure function motion_text(motion) result(text)
    type(mesh_motion_t), intent(in) :: motion
    character(:), allocatable :: text

    text = "reset"
    if (motion%with_body) then
      text = "moving with the body"
    else if (motion%active) then
      text = "moving, driver "//integer_text(size(motion%driver))//" nodes, fixed " &
             //integer_text(size(motion%fixed))//" nodes, direction"//reals_text(motion%direction)
    end if
  end function motion_text

  !> How many nodes have axes of their own.
  pure function axes_text(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text

    text = "global"
    if (allocated(model%frames%of_node)) text = integer_text(count(model%frames%of_node > 0)) &
      & //" nodes rotated, the rest global"
  end function axes_text

  !> The factor of the ghost penalty.
  pure function ghost_text(gamma) result(text)
    real(dp), intent(in) :: gamma !! [-], 0 = none
    character(:), allocatable :: text

    text = "none"
    if (gamma > 0.0_dp) text = "gamma "//real_text(gamma)
  end function ghost_text

  !> One material.
  pure function material_text(material) result(text)
    type(material_t), intent(in) :: material
    character(:), allocatable :: text

    text = "  material "//material%name//": density "//real_text(material%density)//", E " &
           //real_text(material%young)//", nu "//real_text(material%poisson)
    if (material%law == law_von_mises) then
      text = text//", von Mises sqrt(3 J2) ="//reals_text(material%yield_stress) &
             //" at plastic strain"//reals_text(material%plastic_strain)
    end if
    text = text//line_end
  end function material_text

  !> Initial stress, line by line.
  pure function initial_text(initial) result(text)
    type(initial_stress_t), intent(in) :: initial(:)
    character(:), allocatable :: text
    integer :: i

    text = ""
    do i = 1, size(initial)
      text = text//"  initial stress of "//integer_text(size(initial(i)%element)) &
             //" linear elements:"//reals_text(initial(i)%cauchy)
      if (any(abs(initial(i)%slope) > 0.0_dp)) text = text//" at height " &
        & //real_text(initial(i)%height)//", change with height"//reals_text(initial(i)%slope)
      text = text//line_end
    end do
  end function initial_text

  !> Schedule, controls, conditions and output of one step.
  pure function step_text(step, number) result(text)
    type(step_t), intent(in) :: step !! with everything in force in it
    integer, intent(in) :: number    !! of the step
    character(:), allocatable :: text

    text = "  step "//integer_text(number)
    if (allocated(step%name)) text = text//" "//step%name
    text = text//": "//trim(merge("direct   ", "automatic", step%schedule%direct)) &
           //", initial "//real_text(step%schedule%initial) &
           //", period "//real_text(step%schedule%period) &
           //", minimum "//real_text(step%schedule%minimum) &
           //", maximum "//real_text(step%schedule%maximum) &
           //", at most "//integer_text(step%schedule%max_increments)//" increments"//line_end &
           //"    Newton: tolerance "//real_text(step%newton%tolerance) &
           //", at most "//integer_text(step%newton%max_iterations)//" iterations and " &
           //integer_text(step%newton%max_backtracks)//" backtracks, prediction " &
           //trim(merge("on ", "off", step%newton%prediction))//", stretch at most " &
           //real_text(step%newton%max_stretch)//line_end &
           //"    linear solver: "//solver_text(step%newton)//line_end
    if (step%newton%eigenvalues) text = text//"    eigenvalues of the tangent: " &
      & //"in every increment"//line_end
    if (allocated(step%constraint)) then
      text = text//"    prescribed displacements: "//integer_text(size(step%constraint))//line_end
    end if
    if (allocated(step%load)) text = text//"    loads: "//integer_text(size(step%load))//line_end
    if (step%geostatic) text = text//"    geostatic: loads in force from the beginning" &
      & //accepted_text(step%largest_move)//line_end
    text = text//"    fields: at the end of the step"//output_text(step)//line_end
  end function step_text

  !> How the systems of the corrections are solved.
  pure function solver_text(newton) result(text)
    type(newton_settings_t), intent(in) :: newton
    character(:), allocatable :: text

    select case (newton%linear_solver)
    case (method_automatic)
      text = "DIRECT"
      if (newton%least_recycled < huge(newton%least_recycled)) text = "RECYCLED from "// &
        integer_text(newton%least_recycled)//" unknowns on, DIRECT below"
    case default
      text = method_name(newton%linear_solver)
    end select
    if (index(text, "RECYCLED") > 0 .and. library_of(method_recycled, newton%eigenvalues) &
        == library_single) text = text//"; factors that are kept: single precision, by MUMPS"
  end function solver_text

  !> The largest displacement that a geostatic step accepts.
  pure function accepted_text(largest_move) result(text)
    real(dp), intent(in) :: largest_move !! [length], 0 = any
    character(:), allocatable :: text

    text = ""
    if (largest_move > 0.0_dp) text = ", displacement accepted up to "//real_text(largest_move)
  end function accepted_text

  !> When fields are written besides.
  pure function output_text(step) result(text)
    type(step_t), intent(in) :: step !! with its output request
    character(:), allocatable :: text

    text = ""
    if (.not. step%has_field_output) return
    if (step%field_output%time_interval > 0.0_dp) then
      text = " and every "//real_text(step%field_output%time_interval)//" of time"
    else if (step%field_output%frequency > 0) then
      text = " and every "//integer_text(step%field_output%frequency)//" increments"
    end if
  end function output_text

  !> Sizes of mesh, points and patches.
  pure function mesh_text(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    integer :: sizes(model%patches%n)

    text = "mesh: "//integer_text(model%mesh%n_node)//" nodes, "//integer_text(model%mesh%n_el) &
           //" linear elements, volume "//real_text(sum(model%mesh%volume))//line_end &
           //"points: "//integer_text(model%points%n)//", volume " &
           //real_text(sum(model%points%volume))//", mass "//real_text(sum(model%points%mass)) &
           //line_end//surface_text(model)//"patches: "//integer_text(model%patches%n)
    if (model%patches%n > 0) then
      sizes = model%patches%first(2:) - model%patches%first(:model%patches%n)
      text = text//", elements per patch: "//integer_text(minval(sizes))//" to " &
             //integer_text(maxval(sizes))//", mean "//real_text(sum(sizes)/real(size(sizes), dp))
    end if
    ! A model with a free rigid-body mode has been refused by mpm_support_check.
    text = text//line_end//"rigid-body modes left free: none"//line_end
  end function mesh_text

  !> Points that carry tractions; empty if there are none.
  pure function surface_text(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text

    text = ""
    if (model%surface%n == 0) return
    text = "surface points: "//integer_text(model%surface%n)//", area " &
           //real_text(sum(model%surface%area))//line_end
  end function surface_text

  !> Free unknowns per volume that the material wants to keep, with and without patches.
  pure function freedom_ratio_text(model) result(text)
    type(model_t), intent(in) :: model !! at time zero, points located
    character(:), allocatable :: text
    logical :: active_element(model%mesh%n_el), active_patch(model%patches%n)
    logical :: free(model%mesh%n_dim, model%mesh%n_node)
    integer :: e, i, n_elements, n_free, n_patches

    active_element = .false.
    do i = 1, model%points%n
      if (model%points%element(i) > 0) active_element(model%points%element(i)) = .true.
    end do
    active_patch = .false.
    free = .false.
    do e = 1, model%mesh%n_el
      if (.not. active_element(e)) cycle
      free(:, model%mesh%node(:, e)) = .true.
      if (model%patches%n > 0) active_patch(model%patches%of_element(e)) = .true.
    end do
    if (size(model%step) > 0) call remove_prescribed(free, model%step(1))
    n_free = count(free)
    n_elements = max(1, count(active_element))
    n_patches = max(1, count(active_patch))
    text = "unknowns: "//integer_text(n_free)//" free; per volumetric constraint: " &
           //real_text(n_free/real(n_elements, dp))//" with one constraint per active element, " &
           //real_text(n_free/real(n_patches, dp))//" with one per active patch"//line_end
  end function freedom_ratio_text

  !> Takes the prescribed displacements of a step from the free ones.
  pure subroutine remove_prescribed(free, step)
    logical, intent(inout) :: free(:, :) !! (n_dim, n_node)
    type(step_t), intent(in) :: step     !! with everything in force in it
    integer :: i

    if (.not. allocated(step%constraint)) return
    do i = 1, size(step%constraint)
      free(step%constraint(i)%direction, step%constraint(i)%node) = .false.
    end do
  end subroutine remove_prescribed

  !> All sets with counts, volumes and areas.
  pure function set_text(mesh) result(text)
    type(mesh_t), intent(in) :: mesh !! at time zero
    character(:), allocatable :: text
    integer :: i

    text = "sets"//line_end
    do i = 1, size(mesh%node_set)
      text = text//"  nodes "//mesh%node_set(i)%name//": " &
             //integer_text(size(mesh%node_set(i)%item))//line_end
    end do
    do i = 1, size(mesh%element_set)
      text = text//"  elements "//mesh%element_set(i)%name//": " &
             //integer_text(size(mesh%element_set(i)%item))//", volume " &
             //real_text(sum(mesh%volume(mesh%element_set(i)%item)))//line_end
    end do
    do i = 1, size(mesh%surface)
      text = text//"  surface "//mesh%surface(i)%name//": " &
             //integer_text(size(mesh%surface(i)%face))//" faces, area " &
             //real_text(area_of(mesh, mesh%surface(i)))//line_end
    end do
  end function set_text

  !> Area (in the plane: length) of a surface.
  pure function area_of(mesh, surface) result(area)
    type(mesh_t), intent(in) :: mesh         !! coordinates
    type(face_set_t), intent(in) :: surface  !! faces
    real(dp) :: area
    real(dp) :: edge_1(3), edge_2(3), normal(3)
    integer  :: corner(size(mesh%node, 1)), i

    area = 0.0_dp
    edge_1 = 0.0_dp
    edge_2 = [0.0_dp, 0.0_dp, 2.0_dp]
    do i = 1, size(surface%face)
      corner = cshift(mesh%node(:, surface%element(i)), surface%face(i))
      edge_1(:mesh%n_dim) = mesh%x(:, corner(2)) - mesh%x(:, corner(1))
      if (mesh%n_dim == 3) edge_2 = mesh%x(:, corner(3)) - mesh%x(:, corner(1))
      normal = cshift(edge_1, 1)*cshift(edge_2, 2) - cshift(edge_1, 2)*cshift(edge_2, 1)
      area = area + 0.5_dp*norm2(normal)
    end do
  end function area_of

  !> What happens to lost points.
  pure function lost_action_text(action) result(text)
    integer, intent(in) :: action !! lost_is_*
    character(:), allocatable :: text

    text = "removed"
    if (action == lost_is_error) text = "error"
    if (action == lost_is_frozen) text = "frozen"
  end function lost_action_text

  !> Numbers with a blank before each.
  pure function reals_text(values) result(text)
    real(dp), intent(in) :: values(:)
    character(:), allocatable :: text
    integer :: i

    text = ""
    do i = 1, size(values)
      text = text//" "//real_text(merge(values(i), 0.0_dp, abs(values(i)) > 0.0_dp)) ! no -0
    end do
  end function reals_text

end module mpm_log_model
