!> Builds the stress with which material points start.
module mpm_initial_builder
  use mpm_build_context, only: at_field, build_context_t, fault, place_t, require_element_set
  use mpm_deck_card, only: deck_t, field_count, field_real, field_text, has_parameter
  use mpm_diagnostics, only: quoted
  use mpm_initial_state, only: largest_strain
  use mpm_initial_stress, only: geostatic_stress, initial_stress_t, set_initial_stress, &
    & yield_breach_t
  use mpm_kinds, only: dp
  use mpm_model, only: model_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: build_initial_stress

  real(dp), parameter :: least_height = 1.0e-30_dp !! that stress can be divided by [length]

contains

  !> *INITIAL CONDITIONS, TYPE=STRESS: all lines of all cards.
  subroutine build_initial_stress(model, deck, context)
    type(model_t), intent(inout) :: model           !! with points; their state is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(initial_stress_t) :: new
    integer :: source(model%mesh%n_el)
    integer :: i, j, n_before

    source = 0
    allocate (model%initial_stress(0))
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "INITIAL CONDITIONS") cycle
      do j = 1, size(deck%card(i)%data)
        n_before = context%diag%n_errors
        call read_stress(new, model, deck, context, [i, j])
        call find_elements(new, source, model, deck, context, [i, j])
        if (context%diag%n_errors > n_before) cycle
        model%initial_stress = [model%initial_stress, new]
        call stress_points(model, new, deck, context, [i, j])
      end do
    end do
  end subroutine build_initial_stress

  !> The stress of a line: uniform, or linear in the height.
  subroutine read_stress(new, model, deck, context, at)
    type(initial_stress_t), intent(out) :: new      !! without elements
    type(model_t), intent(in) :: model              !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    real(dp) :: value(2:7)
    integer :: k, n

    associate (line => deck%card(at(1))%data(at(2)))
      n = field_count(line)
      value = 0.0_dp
      do k = 2, n
        value(k) = field_real(line, k)
      end do
      if (.not. has_parameter(deck%card(at(1)), "GEOSTATIC")) then
        new%cauchy = value
        if (model%mesh%n_dim == 2 .and. any(abs(value(6:)) > 0.0_dp)) call fault(context, deck, &
          & at_field(at(1), at(2), merge(6, 7, abs(value(6)) > 0.0_dp)), "shear stress out of " &
          & //"the plane in plane strain: expected s11, s22, s33, s12 and nothing but 0 after them")
      else if (abs(value(5) - value(3)) <= least_height) then
        call fault(context, deck, at_field(at(1), at(2), 5), "both heights are " &
                   //real_text(value(5))//": expected two different ones")
      else
        if (n < 7) value(7) = value(6)
        new = geostatic_stress(model%mesh%n_dim, [value(2), value(4)], [value(3), value(5)], &
                               value(6:7))
      end if
    end associate
  end subroutine read_stress

  !> The elements of the set of a line: with points, and without another initial stress.
  subroutine find_elements(new, source, model, deck, context, at)
    type(initial_stress_t), intent(inout) :: new    !! gets its elements
    integer, intent(inout) :: source(:)             !! (n_el) number of the line that stresses each
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    type(place_t) :: place
    integer :: found, i

    place = at_field(at(1), at(2), 1)
    associate (line => deck%card(at(1))%data(at(2)))
      call require_element_set(context, deck, model%mesh, place, field_text(line, 1), found)
      if (found == 0) return
      new%element = model%mesh%element_set(found)%item
      do i = 1, size(new%element)
        associate (e => new%element(i))
          if (source(e) > 0) then
            call fault(context, deck, place, "element " &
              & //integer_text(model%mesh%parent_label(model%mesh%parent(e))) &
              & //" has an initial stress by line "//integer_text(source(e)) &
              & //" already: expected sets that do not overlap")
            return
          end if
          source(e) = line%number
        end associate
      end do
    end associate
  end subroutine find_elements

  !> Sets the state of the points; there must be some, none outside its yield surface.
  subroutine stress_points(model, new, deck, context, at)
    type(model_t), intent(inout) :: model           !! state of its points is set
    type(initial_stress_t), intent(in) :: new       !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    type(yield_breach_t) :: breach
    character(:), allocatable :: what
    integer :: e, n

    if (model%points%n == 0) return
    call set_initial_stress(model%points, n, breach, new, model%mesh%n_el, model%material)
    if (n == 0) then
      call fault(context, deck, at_field(at(1), at(2), 1), "no material points in the elements " &
                 //"of "//quoted(field_text(deck%card(at(1))%data(at(2)), 1)) &
                 //": expected elements of the body")
      return
    end if
    if (breach%point == 0) return
    e = model%points%element(breach%point)
    what = " is outside the yield surface, sqrt(3 J2) = "//real_text(breach%found) &
      & //": expected at most "//real_text(breach%allowed)
    if (breach%too_large) what = " needs an elastic strain above "//real_text(largest_strain) &
      & //": expected a stress well below the moduli of *ELASTIC"
    call fault(context, deck, at_field(at(1), at(2), 1), "the initial stress of material point " &
      & //integer_text(breach%point)//" in element " &
      & //integer_text(model%mesh%parent_label(model%mesh%parent(e)))//what)
  end subroutine stress_points

end module mpm_initial_builder
