!> Builds *EXPECT: what the run must reach.
module mpm_expectation_builder
  use mpm_build_context, only: at_card, at_parameter, build_context_t, fault, require_element_set, &
    & require_node_set
  use mpm_deck_card, only: deck_t, field_count, field_real, field_text, has_parameter, &
    & parameter_choice, parameter_integer, parameter_real, parameter_text
  use mpm_kinds, only: dp
  use mpm_mesh, only: find_element_set, find_node_set
  use mpm_model, only: expectation_t, model_t
  use mpm_text, only: integer_text, real_text, to_upper
  implicit none
  private
  public :: build_expectation

contains

  !> *EXPECT: one expectation per data line.
  subroutine build_expectation(list, model, deck, context, i_card, time)
    type(expectation_t), allocatable, intent(inout) :: list(:) !! longer
    type(model_t), intent(in) :: model                         !! with mesh
    type(deck_t), intent(in) :: deck                           !! the deck
    type(build_context_t), intent(inout) :: context            !! takes errors
    integer, intent(in) :: i_card                              !! *EXPECT
    real(dp), intent(in) :: time(2)                            !! (2) start and end of the step
    type(expectation_t) :: new
    integer :: j

    associate (card => deck%card(i_card))
      new%quantity = parameter_choice(card, "QUANTITY", "")
      new%component = parameter_integer(card, "COMPONENT", 0)
      new%statistic = parameter_choice(card, "STATISTIC", trim(merge("SUM ", "MEAN", &
        & new%quantity == "RF")))
      new%time = parameter_real(card, "TIME", time(2))
      new%card = i_card
      call check_time(new, deck, context, time)
      call check_component(new, model, deck, context)
      new%set = parameter_text(card, "SET", "")
      select case (new%quantity)
      case ("CHECKERBOARD", "GHOST SHARE", "BALANCE")
        call check_scalar(new, model, deck, context)
      case default
        call find_items(new, model, deck, context)
      end select
      do j = 1, size(card%data)
        associate (line => card%data(j))
          new%analytic = to_upper(field_text(line, 1)) == "ANALYTIC"
          new%value = field_real(line, 2)
          new%rtol = field_real(line, 3)
          new%atol = 0.0_dp
          if (field_count(line) > 3) new%atol = field_real(line, 4)
          new%line = j
          new%origin = deck%file(line%file)%path//":"//integer_text(line%number)
        end associate
        list = [list, new]
      end do
    end associate
  end subroutine build_expectation

  !> The time lies in the step.
  subroutine check_time(new, deck, context, time)
    type(expectation_t), intent(in) :: new          !! with time
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    real(dp), intent(in) :: time(2)                 !! (2) total time at start and end of the step
    real(dp) :: tolerance

    tolerance = 1.0e-9_dp*(time(2) - time(1))
    if (new%time > time(1) + tolerance .and. new%time <= time(2) + tolerance) return
    call fault(context, deck, at_parameter(new%card, "TIME"), "total time "//real_text(new%time) &
               //" is outside the step: expected more than "//real_text(time(1))//" and at most " &
               //real_text(time(2)))
  end subroutine check_time

  !> A component where the quantity has components, none where it is a number.
  subroutine check_component(new, model, deck, context)
    type(expectation_t), intent(in) :: new          !! with quantity and component
    type(model_t), intent(in) :: model              !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: n

    select case (new%quantity)
    case ("RF", "U")
      n = model%mesh%n_dim
    case ("S", "TAU", "LE")
      n = 6
    case ("F")
      n = 9
    case default
      n = 0
    end select
    if (n == 0 .and. has_parameter(deck%card(new%card), "COMPONENT")) then
      call fault(context, deck, at_parameter(new%card, "COMPONENT"), new%quantity &
                 //" is a number without components: expected no COMPONENT")
    else if (n > 0 .and. new%component == 0) then
      call fault(context, deck, at_card(new%card), new%quantity//" without COMPONENT: expected " &
                 //"COMPONENT=1 to "//integer_text(n))
    else if (new%component > n) then
      call fault(context, deck, at_parameter(new%card, "COMPONENT"), "component " &
                 //integer_text(new%component)//" of "//new%quantity//": expected 1 to " &
                 //integer_text(n))
    end if
  end subroutine check_component

  !> One number of the run takes neither set nor statistic.
  subroutine check_scalar(new, model, deck, context)
    type(expectation_t), intent(in) :: new          !! with quantity
    type(model_t), intent(in) :: model              !! with the penalty
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(9), parameter :: parameter_name(2) = [character(9) :: "SET", "STATISTIC"]
    integer :: i

    do i = 1, size(parameter_name)
      if (.not. has_parameter(deck%card(new%card), trim(parameter_name(i)))) cycle
      call fault(context, deck, at_parameter(new%card, trim(parameter_name(i))), new%quantity &
                 //" is one number of the run: expected no "//trim(parameter_name(i)))
    end do
    if (new%quantity /= "GHOST SHARE" .or. model%ghost_gamma > 0.0_dp) return
    call fault(context, deck, at_parameter(new%card, "QUANTITY"), "GHOST SHARE without " &
               //"*GHOST PENALTY: expected *GHOST PENALTY in the model part")
  end subroutine check_scalar

  !> Nodes of a node set for RF and U, else elements of an element set; all points without a set.
  subroutine find_items(new, model, deck, context)
    type(expectation_t), intent(inout) :: new       !! with quantity and set; items are set
    type(model_t), intent(in) :: model              !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: found

    new%of_nodes = new%quantity == "RF"
    if (new%quantity == "U" .and. len(new%set) > 0) new%of_nodes = &
      & find_node_set(model%mesh, new%set) > 0 .or. find_element_set(model%mesh, new%set) == 0
    if (len(new%set) == 0) then
      if (new%of_nodes) call fault(context, deck, at_card(new%card), "RF without SET: expected " &
        & //"the name of a node set")
    else if (new%of_nodes) then
      call require_node_set(context, deck, model%mesh, at_parameter(new%card, "SET"), new%set, &
                            found)
      if (found > 0) new%item = model%mesh%node_set(found)%item
    else
      call require_element_set(context, deck, model%mesh, at_parameter(new%card, "SET"), new%set, &
                               found)
      if (found > 0) new%item = model%mesh%element_set(found)%item
    end if
  end subroutine find_items

end module mpm_expectation_builder
