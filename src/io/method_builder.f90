!> Builds formulation, patches, material points, moving mesh and what happens to lost points.
module mpm_method_builder
  use mpm_build_context, only: at_card, at_parameter, build_context_t, fault, fault_of, &
    & is_material, name_hint, require_element_set, require_node_set, use_name
  use mpm_deck_card, only: deck_t, has_parameter, parameter_choice, parameter_integer, &
    & parameter_real, parameter_reals, parameter_text
  use mpm_diagnostics, only: quoted
  use mpm_error, only: error_t
  use mpm_ghost_penalty, only: default_gamma
  use mpm_kinds, only: dp
  use mpm_material_points, only: generate_points
  use mpm_mesh_motion, only: check_motion
  use mpm_model, only: formulation_fbar, formulation_standard, model_t
  use mpm_patches, only: patches_from_graph, patches_from_parents, patches_of_single_elements
  use mpm_point_location, only: lost_is_error, lost_is_frozen, lost_is_removed
  use mpm_point_rules, only: available_rules, point_rule
  use mpm_text, only: integer_text, same_name
  implicit none
  private
  public :: build_method, build_points

contains

  !> Formulation, patches, moving mesh and lost points.
  subroutine build_method(model, deck, context, order)
    type(model_t), intent(inout) :: model           !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: order                    !! of the elements of the user, 1 or 2
    integer :: i, i_patch
    logical :: has_formulation

    i_patch = 0
    has_formulation = .false.
    do i = 1, size(deck%card)
      select case (deck%card(i)%keyword)
      case ("FORMULATION")
        has_formulation = .true.
        model%formulation = merge(formulation_standard, formulation_fbar, &
                                  parameter_choice(deck%card(i), "TYPE", "") == "STANDARD")
      case ("PATCH")
        i_patch = i
      case ("MOVING MESH")
        call build_motion(model, deck, context, i)
      case ("LOST POINTS")
        call build_location(model, deck, i)
      case ("LOCKING METER")
        model%locking_meter = .true.
      case ("GHOST PENALTY")
        model%ghost_gamma = parameter_real(deck%card(i), "GAMMA", default_gamma)
        model%ghost_adapts = .not. has_parameter(deck%card(i), "GAMMA")
      case default
        cycle
      end select
    end do
    if (.not. has_formulation) call fault(context, deck, at_card(1), "the deck has no " &
      & //"*FORMULATION: expected TYPE=FBAR PATCH or TYPE=STANDARD in the model part")
    call build_patches(model, deck, context, i_patch, order)
  end subroutine build_method

  !> Patches. Without *PATCH a quadratic mesh gives its elements, a linear one is partitioned.
  subroutine build_patches(model, deck, context, i_card, order)
    type(model_t), intent(inout) :: model           !! patches are set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *PATCH, 0 if there is none
    integer, intent(in) :: order                    !! of the elements of the user, 1 or 2
    type(error_t), allocatable :: error

    model%patch_source = "METIS"
    if (order == 2) model%patch_source = "QUADRATIC"
    model%patch_size = merge(4, 8, model%mesh%n_dim == 2)
    if (i_card > 0) then
      model%patch_source = parameter_choice(deck%card(i_card), "SOURCE", "")
      model%patch_size = parameter_integer(deck%card(i_card), "SIZE", model%patch_size)
    end if
    select case (model%patch_source)
    case ("QUADRATIC")
      if (order == 1) then
        call fault(context, deck, at_parameter(i_card, "SOURCE"), "the mesh is linear, it has no " &
                   //"quadratic elements: expected METIS or NONE", "use SOURCE=METIS, SIZE=" &
                   //integer_text(model%patch_size))
        return
      end if
      call patches_from_parents(model%patches, model%mesh)
    case ("METIS")
      call patches_from_graph(model%patches, model%mesh, model%patch_size, error)
      call fault_of(context, deck, at_card(max(1, i_card)), error)
    case default
      call patches_of_single_elements(model%patches, model%mesh%n_el)
    end select
  end subroutine build_patches

  !> *MOVING MESH.
  subroutine build_motion(model, deck, context, i_card)
    type(model_t), intent(inout) :: model           !! motion is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *MOVING MESH
    type(error_t), allocatable :: error
    real(dp), allocatable :: direction(:)
    integer :: driver, fixed

    associate (card => deck%card(i_card))
      model%motion%with_body = parameter_choice(card, "TYPE", "DRIVER") == "LAGRANGIAN"
      model%motion%active = model%motion%with_body
      if (model%motion%with_body) return
      call require_node_set(context, deck, model%mesh, at_parameter(i_card, "DRIVER"), &
                            parameter_text(card, "DRIVER", ""), driver)
      call require_node_set(context, deck, model%mesh, at_parameter(i_card, "FIXED"), &
                            parameter_text(card, "FIXED", ""), fixed)
      direction = parameter_reals(card, "DIRECTION")
    end associate
    if (.not. is_direction(direction, model%mesh%n_dim)) then
      call fault(context, deck, at_parameter(i_card, "DIRECTION"), "wrong direction: expected " &
                 //integer_text(model%mesh%n_dim)//" numbers, not all zero")
      return
    end if
    if (driver == 0 .or. fixed == 0) return
    model%motion%active = .true.
    model%motion%driver = model%mesh%node_set(driver)%item
    model%motion%fixed = model%mesh%node_set(fixed)%item
    model%motion%direction(:size(direction)) = direction/norm2(direction)
    call check_motion(model%motion, model%mesh, error)
    call fault_of(context, deck, at_card(i_card), error)
  end subroutine build_motion

  !> Whether numbers are a direction in the space of the mesh; in the plane a zero z may be given.
  pure logical function is_direction(direction, n_dim) result(valid)
    real(dp), intent(in) :: direction(:) !! (n) numbers of the deck
    integer, intent(in) :: n_dim         !! 2 or 3

    valid = size(direction) == n_dim
    if (n_dim == 2 .and. size(direction) == 3) valid = abs(direction(3)) <= 0.0_dp
    if (valid) valid = norm2(direction) > 0.0_dp
  end function is_direction

  !> *LOST POINTS.
  subroutine build_location(model, deck, i_card)
    type(model_t), intent(inout) :: model !! location is set
    type(deck_t), intent(in) :: deck      !! the deck
    integer, intent(in) :: i_card         !! *LOST POINTS

    model%location%tolerance = parameter_real(deck%card(i_card), "TOLERANCE", &
                                              model%location%tolerance)
    select case (parameter_choice(deck%card(i_card), "ACTION", "ERROR"))
    case ("FREEZE")
      model%location%lost_action = lost_is_frozen
    case ("REMOVE")
      model%location%lost_action = lost_is_removed
    case default
      model%location%lost_action = lost_is_error
    end select
  end subroutine build_location

  !> *MATERIAL POINTS: fills the elements of sets.
  subroutine build_points(model, deck, context)
    type(model_t), intent(inout) :: model           !! with mesh and materials; points are set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: i, n

    n = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "MATERIAL POINTS") cycle
      n = n + 1
      call fill_set(model, deck, context, i)
    end do
    if (n == 0) call fault(context, deck, at_card(1), "the deck has no material points: expected " &
      & //"*MATERIAL POINTS in the model part")
  end subroutine build_points

  !> One *MATERIAL POINTS card.
  subroutine fill_set(model, deck, context, i_card)
    type(model_t), intent(inout) :: model           !! more points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *MATERIAL POINTS
    type(error_t), allocatable :: error
    real(dp), allocatable :: barycentric(:, :), weight(:)
    integer :: i_set, i_material, n
    logical :: found

    associate (card => deck%card(i_card))
      call require_element_set(context, deck, model%mesh, at_parameter(i_card, "ELSET"), &
                               parameter_text(card, "ELSET", ""), i_set)
      call find_material(i_material, model, deck, context, i_card)
      n = parameter_integer(card, "PER ELEMENT", 1)
      call point_rule(model%mesh%n_dim, n, barycentric, weight, found)
      if (.not. found) call fault(context, deck, at_parameter(i_card, "PER ELEMENT"), &
        & integer_text(n)//" points per element: expected "//available_rules(model%mesh%n_dim))
    end associate
    if (i_set == 0 .or. i_material == 0 .or. .not. found) return
    call generate_points(model%points, model%mesh, model%mesh%element_set(i_set)%item, i_material, &
                         n, model%material(i_material)%density, error)
    call fault_of(context, deck, at_parameter(i_card, "ELSET"), error)
  end subroutine fill_set

  !> The material of a *MATERIAL POINTS card.
  subroutine find_material(found, model, deck, context, i_card)
    integer, intent(out) :: found                   !! index of the material, 0 after an error
    type(model_t), intent(in) :: model              !! with materials
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! marks the use, takes errors
    integer, intent(in) :: i_card                   !! *MATERIAL POINTS
    character(80), allocatable :: names(:)
    character(:), allocatable :: name
    integer :: i

    name = parameter_text(deck%card(i_card), "MATERIAL", "")
    allocate (names(size(model%material)))
    do i = 1, size(names)
      names(i) = model%material(i)%name
    end do
    call use_name(context, is_material, name)
    do found = 1, size(names)
      if (same_name(names(found), name)) return
    end do
    found = 0
    call fault(context, deck, at_parameter(i_card, "MATERIAL"), "material "//quoted(name) &
               //" is not defined: expected the NAME of a *MATERIAL", name_hint(name, names))
  end subroutine find_material

end module mpm_method_builder
