!> Builds the model that a deck describes. All faults are collected, each with its place.
module mpm_model_builder
  use mpm_body_faces, only: turn_faces_to_body
  use mpm_build_context, only: at_card, build_context_t, fault, report_unused
  use mpm_deck_card, only: deck_t, parameter_text
  use mpm_diagnostics, only: diagnostics_t, to_error
  use mpm_driver_check, only: check_driver
  use mpm_error, only: error_t, exit_model
  use mpm_frame_builder, only: build_frames
  use mpm_frame_check, only: check_frames_used
  use mpm_initial_builder, only: build_initial_stress
  use mpm_labelled_mesh, only: labelled_mesh_t
  use mpm_material_builder, only: build_amplitudes, build_materials
  use mpm_mesh_builder, only: build_linear_mesh, build_parents
  use mpm_method_builder, only: build_method, build_points
  use mpm_model, only: model_t
  use mpm_set_builder, only: build_sets
  use mpm_step_builder, only: build_steps
  use mpm_support_check, only: find_free_modes, suggest_support
  use mpm_surface_points, only: sample_surfaces
  use mpm_text, only: integer_text
  implicit none
  private
  public :: build_model

contains

  !> Builds the model. The error holds all messages; its code is exit_deck if one of them is about
  !! the deck, else exit_model (exit_file for a mesh file that cannot be read).
  subroutine build_model(model, deck, lax, diag, error)
    type(model_t), intent(out) :: model              !! complete when there is no error
    type(deck_t), intent(in) :: deck                 !! checked against the schema
    logical, intent(in) :: lax                       !! names that nothing uses are only warnings
    type(diagnostics_t), intent(inout) :: diag       !! gets all messages
    type(error_t), allocatable, intent(out) :: error !! deck or model errors
    type(build_context_t) :: context
    type(labelled_mesh_t) :: mesh

    context%lax = lax
    context%diag = diag
    call build_texts(model, deck)
    call build_materials(model%material, deck, context)
    call build_amplitudes(model%amplitude, deck, context)
    call build_meshes(model, mesh, deck, context)
    if (model%mesh%n_el > 0) then
      call build_method(model, deck, context, mesh%parent%order)
      call build_points(model, deck, context)
      call build_frames(model%frames, model%mesh, deck, context)
      if (model%points%n > 0) call turn_faces_to_body(model%mesh, model%points)
      call build_initial_stress(model, deck, context)
      call build_steps(model, deck, context)
      if (model%points%n > 0) call sample_surfaces(model%surface, model%mesh, model%points, &
                                                   carrying_surfaces(model))
      if (context%diag%n_errors == 0) call report_unused(context, deck)
      if (context%diag%n_errors == 0) call check_frames_used(model, deck, context)
      if (context%diag%n_errors == 0) call check_supports(model, deck, context)
      if (context%diag%n_errors == 0) call check_driver(model, deck, context)
    end if
    diag = context%diag
    call to_error(diag, context%code, error)
  end subroutine build_model

  !> Job, heading and units.
  subroutine build_texts(model, deck)
    type(model_t), intent(inout) :: model !! texts are set
    type(deck_t), intent(in) :: deck      !! the deck
    integer :: i, j

    model%job = deck%name
    model%heading = ""
    model%unit_length = ""
    model%unit_force = ""
    do i = 1, size(deck%card)
      select case (deck%card(i)%keyword)
      case ("HEADING")
        do j = 1, size(deck%card(i)%data)
          if (j > 1) model%heading = model%heading//new_line("a")
          model%heading = model%heading//trim(adjustl(deck%card(i)%data(j)%text))
        end do
      case ("UNITS")
        model%unit_length = parameter_text(deck%card(i), "LENGTH", "")
        model%unit_force = parameter_text(deck%card(i), "FORCE", "")
      case default
        cycle
      end select
    end do
  end subroutine build_texts

  !> The mesh of the user with the sets of the deck, and the linear mesh; none after an error.
  subroutine build_meshes(model, mesh, deck, context)
    type(model_t), intent(inout) :: model           !! mesh is set, with elements when all is well
    type(labelled_mesh_t), intent(out) :: mesh      !! mesh of the user
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: source, n_before

    n_before = context%diag%n_errors
    call build_parents(mesh, source, deck, context)
    if (source == 0 .or. context%diag%n_errors > n_before) return
    call build_sets(mesh, deck, context)
    call build_linear_mesh(model%mesh, mesh, deck, context, source)
  end subroutine build_meshes

  !> Which surfaces carry a load on points of the body in some step.
  pure function carrying_surfaces(model) result(carries)
    type(model_t), intent(in) :: model !! with mesh and steps
    logical, allocatable :: carries(:) !! (n_surface)
    integer :: i, j

    allocate (carries(size(model%mesh%surface)), source=.false.)
    do i = 1, size(model%step)
      do j = 1, size(model%step(i)%load)
        if (model%step(i)%load(j)%surface > 0) carries(model%step(i)%load(j)%surface) = .true.
      end do
    end do
  end function carrying_surfaces

  !> Every body must be held in every step.
  subroutine check_supports(model, deck, context)
    type(model_t), intent(in) :: model              !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(:), allocatable :: advice, modes
    integer :: i, element

    do i = 1, size(model%step)
      call find_free_modes(modes, element, model%mesh, model%points, model%step(i)%constraint, &
                           model%frames)
      if (element == 0) cycle
      advice = suggest_support(element, model%mesh, model%points, model%step(i)%constraint, &
                               model%frames)
      if (len(advice) > 0) advice = ", such as "//advice
      call fault(context, deck, at_card(model%step(i)%card), "the body of element " &
                 //integer_text(model%mesh%parent_label(model%mesh%parent(element))) &
                 //" is free to move in this step ("//modes//"): expected *BOUNDARY conditions " &
                 //"that hold it"//advice, code=exit_model)
    end do
  end subroutine check_supports

end module mpm_model_builder
