!> Whether every step tells the moving mesh how its driver moves.
module mpm_driver_check
  use mpm_build_context, only: at_parameter, build_context_t, fault
  use mpm_deck_card, only: deck_t
  use mpm_error, only: exit_model
  use mpm_kinds, only: dp
  use mpm_mesh_motion, only: is_along
  use mpm_model, only: model_t, step_t
  use mpm_nodal_frames, only: in_local_axes
  use mpm_text, only: integer_text
  implicit none
  private
  public :: check_driver, is_driver_prescribed

contains

  !> The mesh follows the displacement of its driver: in every step all nodes of the driver have the
  !! same prescribed one, or none has any and the mesh follows the computed one.
  subroutine check_driver(model, deck, context)
    type(model_t), intent(in) :: model              !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: i, card

    if (.not. model%motion%active .or. model%motion%with_body) return
    card = card_of_motion(deck)
    do i = 1, size(model%step)
      if (is_driver_prescribed(model, i)) then
        call check_axes(model, deck, context, card)
        if (context%diag%n_errors > 0) return
        call check_values(model, deck, context, i, card)
      else if (.not. touches_body(model)) then
        call fault(context, deck, at_parameter(card, "DRIVER"), "the driver has no prescribed " &
          & //"displacement in step "//model%step(i)%name//" and touches no element with " &
          & //"material points: expected a *BOUNDARY value for the set, or nodes of the body", &
          & code=exit_model)
      end if
    end do
  end subroutine check_driver

  !> The *MOVING MESH of a deck.
  pure integer function card_of_motion(deck) result(card)
    type(deck_t), intent(in) :: deck !! with one such card

    do card = size(deck%card), 1, -1
      if (deck%card(card)%keyword == "MOVING MESH") return
    end do
  end function card_of_motion

  !> Whether a step prescribes the displacement of any driver node along the motion.
  pure logical function is_driver_prescribed(model, i_step) result(prescribed)
    type(model_t), intent(in) :: model !! with steps and motion
    integer, intent(in) :: i_step      !! step
    real(dp) :: normal(model%mesh%n_dim)
    integer :: a, i

    prescribed = .false.
    if (.not. allocated(model%step(i_step)%constraint)) return
    do i = 1, size(model%step(i_step)%constraint)
      associate (constraint => model%step(i_step)%constraint(i))
        do a = 1, size(model%motion%driver)
          if (all(constraint%node /= model%motion%driver(a))) cycle
          normal = driver_normal(model, a)
          prescribed = prescribed .or. is_along(normal(constraint%direction))
        end do
      end associate
    end do
  end function is_driver_prescribed

  !> Direction of the motion along the axes of a node of the driver. Source: theory.md (19).
  pure function driver_normal(model, i) result(normal)
    type(model_t), intent(in) :: model      !! with motion
    integer, intent(in) :: i                !! index of the node in the driver
    real(dp) :: normal(model%mesh%n_dim)    !! unit vector

    normal = in_local_axes(model%frames, model%motion%driver(i), &
                           model%motion%direction(:model%mesh%n_dim))
  end function driver_normal

  !> Whether a driver node belongs to an element with material points.
  pure logical function touches_body(model) result(touches)
    type(model_t), intent(in) :: model !! with points and motion
    logical :: filled(model%mesh%n_node)
    integer :: p

    filled = .false.
    do p = 1, model%points%n
      filled(model%mesh%node(:, model%points%element(p))) = .true.
    end do
    touches = any(filled(model%motion%driver))
  end function touches_body

  !> All driver nodes see the direction of the motion along the same components.
  subroutine check_axes(model, deck, context, card)
    type(model_t), intent(in) :: model              !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: card                     !! *MOVING MESH
    real(dp) :: normal(model%mesh%n_dim)
    integer :: j

    normal = driver_normal(model, 1)
    do j = 2, size(model%motion%driver)
      if (.not. any(is_along(driver_normal(model, j) - normal))) cycle
      call fault(context, deck, at_parameter(card, "DRIVER"), "node " &
        & //integer_text(model%mesh%node_label(model%motion%driver(j)))//" of the driver has " &
        & //"other axes than the rest: expected one *TRANSFORM for the set, or none", &
        & code=exit_model)
      return
    end do
  end subroutine check_axes

  !> All driver nodes have the same prescribed displacement in a step; the first other one is told.
  subroutine check_values(model, deck, context, i_step, card)
    type(model_t), intent(in) :: model              !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_step                   !! step
    integer, intent(in) :: card                     !! *MOVING MESH
    real(dp) :: normal(model%mesh%n_dim)
    integer :: d, j

    normal = driver_normal(model, 1)
    associate (motion => model%motion, step => model%step(i_step))
      do d = 1, model%mesh%n_dim
        if (.not. is_along(normal(d))) cycle
        do j = 1, size(motion%driver)
          if (is_driven(step, motion%driver(j), motion%driver(1), d)) cycle
          call fault(context, deck, at_parameter(card, "DRIVER"), "node " &
            & //integer_text(model%mesh%node_label(motion%driver(j)))//" of the driver has no " &
            & //"displacement in direction "//integer_text(d)//", or another one than the rest, " &
            & //"in step "//step%name//": expected one *BOUNDARY value for the set, or none", &
            & code=exit_model)
          return
        end do
      end do
    end associate
  end subroutine check_values

  !> Whether a node moves like the first node of the driver.
  pure logical function is_driven(step, node, first, direction) result(driven)
    type(step_t), intent(in) :: step !! with constraints
    integer, intent(in) :: node      !! node of the driver
    integer, intent(in) :: first     !! first node of the driver
    integer, intent(in) :: direction !! 1..n_dim
    integer :: i_node, i_first

    i_node = constraint_of(step, node, direction)
    i_first = constraint_of(step, first, direction)
    driven = i_node > 0 .and. i_first > 0
    if (.not. driven .or. i_node == i_first) return
    associate (a => step%constraint(i_node), b => step%constraint(i_first))
      driven = abs(a%value - b%value) <= 0.0_dp .and. abs(a%start - b%start) <= 0.0_dp &
                  .and. (a%was_free .eqv. b%was_free) .and. a%amplitude == b%amplitude
    end associate
  end function is_driven

  !> The last constraint of a step that holds a node in a direction, 0 if none does.
  pure integer function constraint_of(step, node, direction) result(found)
    type(step_t), intent(in) :: step !! with constraints
    integer, intent(in) :: node      !! node
    integer, intent(in) :: direction !! 1..n_dim

    do found = size(step%constraint), 1, -1
      if (step%constraint(found)%direction /= direction) cycle
      if (any(step%constraint(found)%node == node)) return
    end do
  end function constraint_of

end module mpm_driver_check
