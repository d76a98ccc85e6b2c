!> Builds what a step writes: *OUTPUT and *HISTORY.
module mpm_output_builder
  use mpm_build_context, only: at_field, at_parameter, build_context_t, fault, require_node_set, &
    & require_surface
  use mpm_deck_card, only: deck_t, field_count, field_text, has_parameter, &
    & parameter_choice, parameter_integer, parameter_real, parameter_reals, parameter_text
  use mpm_diagnostics, only: quoted
  use mpm_kinds, only: dp
  use mpm_material_points, only: nearest_point
  use mpm_mesh, only: surface_nodes
  use mpm_model, only: field_output_t, history_of_point, &
    & history_request_t, model_t
  use mpm_simplex, only: simplex_size
  use mpm_text, only: integer_text, real_text, to_upper
  implicit none
  private
  public :: build_field_output, build_history

contains

  !> *OUTPUT, FIELD. The precision stays what it was in earlier steps.
  subroutine build_field_output(output, model, deck, context, i_card)
    type(field_output_t), intent(inout) :: output   !! fields, when and how
    type(model_t), intent(in) :: model              !! with the steps before
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *OUTPUT

    character(:), allocatable :: before
    integer :: i

    call read_words(output%field, deck, context, i_card)
    output%frequency = parameter_integer(deck%card(i_card), "FREQUENCY", 1)
    output%time_interval = parameter_real(deck%card(i_card), "TIME INTERVAL", 0.0_dp)
    before = trim(merge("SINGLE", "DOUBLE", output%single))
    output%single = parameter_choice(deck%card(i_card), "PRECISION", before) == "SINGLE"
    do i = 1, size(model%step) - 1
      if (.not. model%step(i)%has_field_output) cycle
      if (model%step(i)%field_output%single .eqv. output%single) cycle
      call fault(context, deck, at_parameter(i_card, "PRECISION"), "a run has one precision: "// &
                 "expected PRECISION="//before//" as in step "//quoted(model%step(i)%name))
      return
    end do
  end subroutine build_field_output

  !> The words of all data lines, each once.
  subroutine read_words(words, deck, context, i_card)
    character(8), allocatable, intent(out) :: words(:) !! (n) upper case
    type(deck_t), intent(in) :: deck                   !! the deck
    type(build_context_t), intent(inout) :: context    !! takes errors
    integer, intent(in) :: i_card                      !! card
    character(8) :: word
    integer :: j, k

    allocate (words(0))
    do j = 1, size(deck%card(i_card)%data)
      do k = 1, field_count(deck%card(i_card)%data(j))
        word = to_upper(field_text(deck%card(i_card)%data(j), k))
        if (any(words == word)) then
          call fault(context, deck, at_field(i_card, j, k), quoted(trim(word)) &
                     //" is in the list already: expected every name once")
        else
          words = [words, word]
        end if
      end do
    end do
  end subroutine read_words

  !> *HISTORY.
  subroutine build_history(request, model, deck, context, i_card)
    type(history_request_t), intent(out) :: request !! what is written
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *HISTORY
    integer :: found

    request%card = i_card
    call read_words(request%quantity, deck, context, i_card)
    associate (card => deck%card(i_card))
      if (has_parameter(card, "POINT")) then
        request%kind = history_of_point
        request%label = parameter_text(card, "POINT", "")
        call find_point(request%point, model, deck, context, i_card)
      else if (has_parameter(card, "SURFACE")) then
        request%label = parameter_text(card, "SURFACE", "")
        call require_surface(context, deck, model%mesh, at_parameter(i_card, "SURFACE"), &
                             request%label, found)
        if (found > 0) request%node = surface_nodes(model%mesh, model%mesh%surface(found))
      else
        request%label = parameter_text(card, "NSET", "")
        call require_node_set(context, deck, model%mesh, at_parameter(i_card, "NSET"), &
                              request%label, found)
        if (found > 0) request%node = model%mesh%node_set(found)%item
      end if
    end associate
  end subroutine build_history

  !> The material point nearest to POINT=; it must not be farther away than one element.
  subroutine find_point(point, model, deck, context, i_card)
    integer, intent(out) :: point                   !! index, 0 after an error
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *HISTORY
    real(dp), allocatable :: x(:)
    real(dp) :: distance, element_size

    point = 0
    x = parameter_reals(deck%card(i_card), "POINT")
    if (size(x) /= model%mesh%n_dim) then
      call fault(context, deck, at_parameter(i_card, "POINT"), "a point of " &
                 //integer_text(size(x))//" numbers: expected "//integer_text(model%mesh%n_dim))
      return
    end if
    if (model%points%n == 0) return
    point = nearest_point(model%points, x)
    distance = norm2(model%points%x(:, point) - x)
    associate (e => model%points%element(point))
      element_size = simplex_size(model%mesh%n_dim, model%mesh%volume(e))
    end associate
    if (distance <= element_size) return
    call fault(context, deck, at_parameter(i_card, "POINT"), "the nearest material point is " &
               //real_text(distance)//" away: expected a point in the body")
    point = 0
  end subroutine find_point

end module mpm_output_builder
