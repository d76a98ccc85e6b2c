!> Builds the loads of each step; they carry over from step to step.
module mpm_load_builder
  use mpm_amplitude, only: amplitude_t, amplitude_value
  use mpm_boundary_builder, only: boundary_state_t, check_operation, find_amplitude, nodes_of_field
  use mpm_build_context, only: at_field, build_context_t, fault, place_t, require_element_set
  use mpm_deck_card, only: deck_t, field_count, field_integer, field_real, field_text
  use mpm_diagnostics, only: quoted
  use mpm_external_force, only: load_gravity, load_nodal, load_pressure, load_t, load_traction
  use mpm_kinds, only: dp
  use mpm_loaded_surface, only: take_surface
  use mpm_model, only: model_t
  use mpm_nodal_frames, only: node_axes
  use mpm_text, only: integer_text, real_text, to_upper
  implicit none
  private
  public :: load_state_t, add_loads, begin_load_step, close_load_step

  character(6), parameter :: load_keyword(3) = ["CLOAD ", "DLOAD ", "DSLOAD"]

  !> A load with what tells it from others: the set, and the direction of nodal forces.
  type :: load_entry_t
    type(load_t) :: load
    character(:), allocatable :: key !! kind, direction and set, upper case
    character(:), allocatable :: surface !! of *DSLOAD, upper case; empty for other loads
    integer :: line = 0              !! data line
    logical :: new = .false.         !! given by this step itself
    logical :: ends = .false.        !! goes back to zero in this step
  end type load_entry_t

  !> Loads in force.
  type :: load_state_t
    integer :: n = 0
    type(load_entry_t), allocatable :: entry(:) !! (>= n)
  end type load_state_t

contains

  !> Begins a step: loads of the step before stay, or go back to zero with OP=NEW.
  subroutine begin_load_step(state, deck, context, first, last)
    type(load_state_t), intent(inout) :: state      !! of the step before
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: first, last              !! cards of the step
    logical :: replace
    integer :: i, k

    if (.not. allocated(state%entry)) allocate (state%entry(4))
    do i = 1, state%n
      state%entry(i)%new = .false.
    end do
    do k = 1, size(load_keyword)
      call check_operation(replace, deck, context, [load_keyword(k)], [first, last])
      if (.not. replace) cycle
      do i = 1, state%n
        if (keyword_of(state%entry(i)%load) /= load_keyword(k)) cycle
        state%entry(i)%ends = .true.
        state%entry(i)%load%value = 0.0_dp
      end do
    end do
  end subroutine begin_load_step

  !> Keyword of a load.
  pure function keyword_of(load) result(keyword)
    type(load_t), intent(in) :: load !! any load
    character(6) :: keyword          !! one of load_keyword

    select case (load%kind)
    case (load_nodal)
      keyword = "CLOAD"
    case (load_gravity)
      keyword = "DLOAD"
    case default
      keyword = "DSLOAD"
    end select
  end function keyword_of

  !> Adds the lines of a *CLOAD, *DLOAD or *DSLOAD card.
  subroutine add_loads(state, boundary, model, deck, context, i_card)
    type(load_state_t), intent(inout) :: state       !! more loads
    type(boundary_state_t), intent(in) :: boundary   !! labels and filled nodes
    type(model_t), intent(in) :: model               !! with mesh, points and amplitudes
    type(deck_t), intent(in) :: deck                 !! the deck
    type(build_context_t), intent(inout) :: context  !! takes errors
    integer, intent(in) :: i_card                    !! card
    type(load_entry_t) :: new
    integer :: j, n_before

    call find_amplitude(new%load%amplitude, model, deck, context, i_card)
    do j = 1, size(deck%card(i_card)%data)
      n_before = context%diag%n_errors
      new%load = load_t(amplitude=new%load%amplitude, card=i_card)
      new%line = j
      new%new = .true.
      new%surface = ""
      select case (deck%card(i_card)%keyword)
      case ("CLOAD")
        call build_nodal(new, boundary, model, deck, context)
      case ("DLOAD")
        call build_gravity(new, model, deck, context)
      case default
        call build_surface_load(new, model, deck, context)
      end select
      if (context%diag%n_errors == n_before) call put_load(state, deck, context, new)
    end do
  end subroutine add_loads

  !> A line of *CLOAD: set or node, direction, force.
  subroutine build_nodal(new, boundary, model, deck, context)
    type(load_entry_t), intent(inout) :: new        !! card and line in, load out
    type(boundary_state_t), intent(in) :: boundary  !! labels and filled nodes
    type(model_t), intent(in) :: model              !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: direction

    associate (line => deck%card(new%load%card)%data(new%line))
      new%load%kind = load_nodal
      call nodes_of_field(new%load%item, boundary, model%mesh, deck, context, &
                          at_field(new%load%card, new%line, 1))
      direction = field_integer(line, 2)
      if (direction > model%mesh%n_dim) then
        call fault(context, deck, at_field(new%load%card, new%line, 2), "direction " &
                   //integer_text(direction)//" in a plane mesh: expected 1 or 2")
        return
      end if
      new%load%value(direction) = field_real(line, 3)
      if (allocated(model%frames%of_node)) then
        new%load%axes = node_axes(model%frames, new%load%item)
      end if
      new%key = "CLOAD "//integer_text(direction)//" "//to_upper(field_text(line, 1))
    end associate
  end subroutine build_nodal

  !> A line of *DLOAD: set, GRAV, acceleration, direction.
  subroutine build_gravity(new, model, deck, context)
    type(load_entry_t), intent(inout) :: new        !! card and line in, load out
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: found

    associate (line => deck%card(new%load%card)%data(new%line))
      new%load%kind = load_gravity
      call require_element_set(context, deck, model%mesh, at_field(new%load%card, new%line, 1), &
                               field_text(line, 1), found)
      call read_vector(new, model%mesh%n_dim, deck, context)
      new%key = "DLOAD 0 "//to_upper(field_text(line, 1))
      if (found == 0) return
      new%load%item = model%mesh%element_set(found)%item
      call check_density(new%load%item, model, deck, context, &
                         at_field(new%load%card, new%line, 1))
    end associate
  end subroutine build_gravity

  !> Weight needs points with mass.
  subroutine check_density(element, model, deck, context, place)
    integer, intent(in) :: element(:)               !! (n) loaded elements
    type(model_t), intent(in) :: model              !! with mesh, points, materials
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! the field with the set
    logical, allocatable :: loaded(:)
    integer :: p, n

    allocate (loaded(model%mesh%n_el), source=.false.)
    loaded(element) = .true.
    n = 0
    do p = 1, model%points%n
      if (.not. loaded(model%points%element(p))) cycle
      n = n + 1
      associate (material => model%material(model%points%material(p)))
        if (material%density > 0.0_dp) cycle
        call fault(context, deck, place, "weight of material "//quoted(material%name) &
                   //" without density: expected *DENSITY below its *MATERIAL")
        return
      end associate
    end do
    if (n == 0 .and. model%points%n > 0) call fault(context, deck, place, "no material points in " &
      & //"the loaded elements: expected elements of the body")
  end subroutine check_density

  !> A line of *DSLOAD: surface, P and pressure, or TRVEC, magnitude and direction.
  subroutine build_surface_load(new, model, deck, context)
    type(load_entry_t), intent(inout) :: new        !! card and line in, load out
    type(model_t), intent(in) :: model              !! with mesh and points
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors

    associate (line => deck%card(new%load%card)%data(new%line))
      new%surface = to_upper(field_text(line, 1))
      call take_surface(new%load, model, deck, context, at_field(new%load%card, new%line, 1))
      if (to_upper(field_text(line, 2)) == "P") then
        new%load%kind = load_pressure
        new%load%value(1) = field_real(line, 3)
        new%key = "DSLOAD P "//new%surface
      else
        new%load%kind = load_traction
        call read_vector(new, model%mesh%n_dim, deck, context)
        new%key = "DSLOAD T "//new%surface
      end if
    end associate
  end subroutine build_surface_load

  !> Magnitude and direction in the fields from the third on.
  subroutine read_vector(new, n_dim, deck, context)
    type(load_entry_t), intent(inout) :: new        !! value of the load is set
    integer, intent(in) :: n_dim                    !! 2 or 3
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    real(dp) :: direction(3)
    integer :: k

    associate (line => deck%card(new%load%card)%data(new%line))
      direction = 0.0_dp
      do k = 4, field_count(line)
        direction(k - 3) = field_real(line, k)
      end do
      if (field_count(line) < 3 + n_dim) then
        call fault(context, deck, at_field(new%load%card, new%line, 6), "a direction of two " &
                   //"numbers in a 3-D mesh: expected x, y, z")
      else if (n_dim == 2 .and. abs(direction(3)) > 0.0_dp) then
        call fault(context, deck, at_field(new%load%card, new%line, 6), "a direction with z = " &
                   //real_text(direction(3))//" in a plane mesh: expected x, y")
      else if (norm2(direction) <= 0.0_dp) then
        call fault(context, deck, at_field(new%load%card, new%line, 4), "a direction of length " &
                   //"zero: expected a vector")
      else
        new%load%value = field_real(line, 3)*direction/norm2(direction)
      end if
    end associate
  end subroutine read_vector

  !> Adds a load, or changes the one on the same set that is in force.
  subroutine put_load(state, deck, context, new)
    type(load_state_t), intent(inout) :: state      !! perhaps one load more
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(load_entry_t), intent(in) :: new           !! with key
    type(load_entry_t), allocatable :: longer(:)
    integer :: i

    i = other_carrier(state, new)
    if (i > 0) then
      associate (old => state%entry(i))
        call fault(context, deck, at_field(new%load%card, new%line, 1), "this surface is " &
          & //"loaded through the other CARRIER in line " &
          & //integer_text(deck%card(old%load%card)%data(old%line)%number) &
          & //": expected the same one, or OP=NEW")
      end associate
      return
    end if
    do i = 1, state%n
      associate (old => state%entry(i))
        if (old%key /= new%key .or. old%load%surface /= new%load%surface) cycle
        if (old%new) then
          call fault(context, deck, at_field(new%load%card, new%line, 1), "this load is given in " &
            & //"line "//integer_text(deck%card(old%load%card)%data(old%line)%number) &
            & //" of the same step already: expected it once")
          return
        end if
        old%load%value = new%load%value
        old%load%amplitude = new%load%amplitude
        old%load%card = new%load%card
        old%line = new%line
        old%new = .true.
        old%ends = .false.
        return
      end associate
    end do
    if (state%n == size(state%entry)) then
      allocate (longer(2*state%n))
      longer(:state%n) = state%entry
      call move_alloc(longer, state%entry)
    end if
    state%n = state%n + 1
    state%entry(state%n) = new
  end subroutine put_load

  !> A load in force on the same surface through the other carrier, 0 if there is none.
  pure integer function other_carrier(state, new) result(found)
    type(load_state_t), intent(in) :: state !! loads in force
    type(load_entry_t), intent(in) :: new   !! load to be added

    if (len(new%surface) > 0) then
      do found = 1, state%n
        associate (old => state%entry(found))
          if (old%ends .or. old%surface /= new%surface) cycle
          if (old%load%surface /= new%load%surface) return
        end associate
      end do
    end if
    found = 0
  end function other_carrier

  !> Loads of the step, and the values with which the next one starts.
  subroutine close_load_step(load, state, period, amplitude)
    type(load_t), allocatable, intent(out) :: load(:) !! in force in the step
    type(load_state_t), intent(inout) :: state        !! ready for the next step
    real(dp), intent(in) :: period                    !! length of the step
    type(amplitude_t), intent(in) :: amplitude(:)     !! amplitudes of the model
    integer :: i, n

    allocate (load(state%n))
    n = 0
    do i = 1, state%n
      load(i) = state%entry(i)%load
      if (state%entry(i)%ends) cycle
      n = n + 1
      state%entry(n) = state%entry(i)
      associate (kept => state%entry(n)%load)
        if (kept%amplitude > 0) kept%value = kept%value &
          & *amplitude_value(amplitude(kept%amplitude), period)
        kept%amplitude = 0
        kept%start = kept%value
      end associate
    end do
    state%n = n
  end subroutine close_load_step

end module mpm_load_builder
