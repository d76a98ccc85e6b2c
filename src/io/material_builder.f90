!> Builds materials and amplitudes from their cards.
module mpm_material_builder
  use mpm_amplitude, only: amplitude_t
  use mpm_build_context, only: at_card, at_field, at_parameter, build_context_t, define_name, &
    & fault, is_amplitude, is_material
  use mpm_deck_card, only: deck_card_t, deck_t, field_count, field_real, parameter_choice, &
    & parameter_text
  use mpm_kinds, only: dp
  use mpm_material, only: law_von_mises, material_t
  use mpm_text, only: real_text
  implicit none
  private
  public :: build_amplitudes, build_materials

contains

  !> Builds all materials: *MATERIAL with the cards that follow it.
  subroutine build_materials(material, deck, context)
    type(material_t), allocatable, intent(out) :: material(:) !! (n) in the order of the deck
    type(deck_t), intent(in) :: deck                          !! the deck
    type(build_context_t), intent(inout) :: context           !! takes names and errors
    integer :: i, n

    n = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "MATERIAL") n = n + 1
    end do
    allocate (material(n))
    n = 0
    do i = 1, size(deck%card)
      select case (deck%card(i)%keyword)
      case ("MATERIAL")
        n = n + 1
        material(n)%name = parameter_text(deck%card(i), "NAME", "")
        ! Never unallocated: a copy of the material would look at bounds that were never set.
        allocate (material(n)%yield_stress(0), material(n)%plastic_strain(0))
        call define_name(context, deck, is_material, at_parameter(i, "NAME"), material(n)%name)
        call require_elasticity(deck, context, i)
      case ("DENSITY")
        material(n)%density = field_real(deck%card(i)%data(1), 1)
      case ("ELASTIC")
        material(n)%young = field_real(deck%card(i)%data(1), 1)
        material(n)%poisson = field_real(deck%card(i)%data(1), 2)
      case ("PLASTIC")
        call build_plasticity(material(n), deck, context, i)
      case default
        cycle
      end select
    end do
    if (n == 0) call fault(context, deck, at_card(1), "the deck has no *MATERIAL: expected " &
      & //"at least one in the model part")
  end subroutine build_materials

  !> A material needs *ELASTIC before the next *MATERIAL.
  subroutine require_elasticity(deck, context, i_card)
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_card                   !! the *MATERIAL card
    integer :: i

    do i = i_card + 1, size(deck%card)
      if (deck%card(i)%keyword == "MATERIAL") exit
      if (deck%card(i)%keyword == "ELASTIC") return
    end do
    call fault(context, deck, at_card(i_card), "material '" &
      & //parameter_text(deck%card(i_card), "NAME", "")//"' has no *ELASTIC: expected it " &
      & //"below *MATERIAL")
  end subroutine require_elasticity

  !> *PLASTIC: yield stress over plastic strain, converted to the uniaxial measure.
  subroutine build_plasticity(material, deck, context, i_card)
    type(material_t), intent(inout) :: material     !! gets the law and its table
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! card
    real(dp) :: measure
    integer :: i, n

    associate (card => deck%card(i_card))
      n = size(card%data)
      material%law = law_von_mises
      material%yield_stress = spread(0.0_dp, 1, n)
      material%plastic_strain = spread(0.0_dp, 1, n)
      do i = 1, n
        material%yield_stress(i) = field_real(card%data(i), 1)
        if (field_count(card%data(i)) > 1) material%plastic_strain(i) = field_real(card%data(i), 2)
        call check_hardening(material, deck, context, i_card, i)
      end do
      measure = measure_of(card)
      material%yield_stress = measure*material%yield_stress
      material%plastic_strain = material%plastic_strain/measure
    end associate
  end subroutine build_plasticity

  !> Uniaxial stress over the stress measure of the deck: sqrt(3 J2) over sqrt(3 J2), sqrt(J2) or
  !! sqrt(2 J2). Plastic strains convert the other way round, so that the work is the same.
  pure real(dp) function measure_of(card) result(measure)
    type(deck_card_t), intent(in) :: card !! *PLASTIC

    select case (parameter_choice(card, "STRENGTH", ""))
    case ("SHEAR")
      measure = sqrt(3.0_dp)
    case ("RADIUS")
      measure = sqrt(1.5_dp)
    case default
      measure = 1.0_dp
    end select
  end function measure_of

  !> One line of a hardening table.
  subroutine check_hardening(material, deck, context, i_card, i)
    type(material_t), intent(in) :: material        !! table so far, in the measure of the deck
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card, i                !! card and data line

    associate (strain => material%plastic_strain)
      if (i == 1) then
        if (abs(strain(1)) > 0.0_dp) call fault(context, deck, at_field(i_card, 1, 2), &
          & "the table starts with plastic strain "//real_text(strain(1))//": expected 0")
      else if (field_count(deck%card(i_card)%data(i)) < 2) then
        call fault(context, deck, at_field(i_card, i, 2), "a table of hardening needs a plastic " &
                   //"strain in every line: expected 'yield stress, plastic strain'")
      else if (strain(i) <= strain(i - 1)) then
        call fault(context, deck, at_field(i_card, i, 2), "plastic strain "//real_text(strain(i)) &
                   //" after "//real_text(strain(i - 1))//": expected ascending plastic strains")
      end if
    end associate
  end subroutine check_hardening

  !> Builds all amplitudes: *AMPLITUDE with pairs of time and value, several in a line.
  subroutine build_amplitudes(amplitude, deck, context)
    type(amplitude_t), allocatable, intent(out) :: amplitude(:) !! (n) in the order of the deck
    type(deck_t), intent(in) :: deck                            !! the deck
    type(build_context_t), intent(inout) :: context             !! takes names and errors
    type(amplitude_t) :: new
    integer :: i, j, k

    allocate (amplitude(0))
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "AMPLITUDE") cycle
      new%name = parameter_text(deck%card(i), "NAME", "")
      call define_name(context, deck, is_amplitude, at_parameter(i, "NAME"), new%name)
      new%time = [real(dp) ::]
      new%value = [real(dp) ::]
      do j = 1, size(deck%card(i)%data)
        associate (line => deck%card(i)%data(j))
          do k = 1, field_count(line) - 1, 2
            call check_time(new, deck, context, field_real(line, k), [i, j, k])
            new%time = [new%time, field_real(line, k)]
            new%value = [new%value, field_real(line, k + 1)]
          end do
        end associate
      end do
      amplitude = [amplitude, new]
    end do
  end subroutine build_amplitudes

  !> Times of an amplitude ascend and are not negative.
  subroutine check_time(amplitude, deck, context, time, at)
    type(amplitude_t), intent(in) :: amplitude      !! table so far
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    real(dp), intent(in) :: time                    !! next time
    integer, intent(in) :: at(3)                    !! (3) card, line, field
    integer :: n

    n = size(amplitude%time)
    if (n == 0) return
    if (time <= amplitude%time(n)) call fault(context, deck, at_field(at(1), at(2), at(3)), &
      & "time "//real_text(time)//" after "//real_text(amplitude%time(n)) &
      & //": expected ascending times")
  end subroutine check_time

end module mpm_material_builder
