!> Builds the prescribed displacements of each step; they carry over from step to step.
module mpm_boundary_builder
  use mpm_amplitude, only: amplitude_t, amplitude_value
  use mpm_build_context, only: at_field, at_parameter, build_context_t, fault, &
    & is_amplitude, name_hint, place_t, require_node_set, use_name
  use mpm_deck_card, only: deck_card_t, deck_line_t, deck_t, field_count, field_integer, &
    & field_is_integer, field_real, field_text, has_parameter, parameter_choice, parameter_text
  use mpm_diagnostics, only: quoted, warning_at_parameter
  use mpm_dof_map, only: constraint_t
  use mpm_error, only: exit_model
  use mpm_kinds, only: dp
  use mpm_label_table, only: build_label_table, find_label, label_table_t
  use mpm_mesh, only: mesh_t
  use mpm_model, only: model_t
  use mpm_text, only: integer_text, real_text, same_name
  implicit none
  private
  public :: boundary_state_t, open_boundary, fix_boundary, begin_boundary_step, add_boundary
  public :: warn_released, close_boundary_step, find_amplitude, nodes_of_field, check_operation

  !> What is prescribed at each degree of freedom.
  type :: boundary_state_t
    type(label_table_t) :: label                   !! nodes by number
    logical, allocatable  :: filled(:)             !! (n_node)         is in an element with points
    logical, allocatable  :: fixed(:, :)           !! (n_dim, n_node)  prescribed in the step
    logical, allocatable  :: was_free(:, :)        !! (n_dim, n_node)  not so in the step before
    real(dp), allocatable :: start(:, :)           !! (n_dim, n_node)  total at the step's start
    real(dp), allocatable :: value(:, :)           !! (n_dim, n_node)  total at the step's end
    integer, allocatable  :: amplitude(:, :)       !! (n_dim, n_node)  amplitude, 0 = ramp
    integer, allocatable  :: card(:, :)            !! (n_dim, n_node)  card that prescribes it
    integer, allocatable  :: line(:, :)            !! (n_dim, n_node)  data line of that card
    logical, allocatable  :: new(:, :)             !! (n_dim, n_node)  given by this step itself
    logical, allocatable  :: support(:, :)         !! (n_dim, n_node)  as the model part gave it
  end type boundary_state_t

contains

  !> Nothing is prescribed.
  subroutine open_boundary(state, model)
    type(boundary_state_t), intent(out) :: state !! empty
    type(model_t), intent(in) :: model           !! with mesh and points
    integer :: duplicate, p

    associate (mesh => model%mesh)
      call build_label_table(state%label, mesh%node_label, duplicate)
      allocate (state%filled(mesh%n_node), source=.false.)
      allocate (state%fixed(mesh%n_dim, mesh%n_node), source=.false.)
      allocate (state%was_free(mesh%n_dim, mesh%n_node), source=.false.)
      allocate (state%start(mesh%n_dim, mesh%n_node), source=0.0_dp)
      allocate (state%value(mesh%n_dim, mesh%n_node), source=0.0_dp)
      allocate (state%amplitude(mesh%n_dim, mesh%n_node), source=0)
      allocate (state%card(mesh%n_dim, mesh%n_node), source=0)
      allocate (state%line(mesh%n_dim, mesh%n_node), source=0)
      allocate (state%new(mesh%n_dim, mesh%n_node), source=.false.)
      allocate (state%support(mesh%n_dim, mesh%n_node), source=.false.)
      do p = 1, model%points%n
        state%filled(mesh%node(:, model%points%element(p))) = .true.
      end do
    end associate
  end subroutine open_boundary

  !> *BOUNDARY in the model part: fixed from the start.
  subroutine fix_boundary(state, model, deck, context, i_card)
    type(boundary_state_t), intent(inout) :: state  !! more is fixed
    type(model_t), intent(in) :: model              !! with mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *BOUNDARY
    integer :: j

    if (has_parameter(deck%card(i_card), "AMPLITUDE")) call fault(context, deck, &
      & at_parameter(i_card, "AMPLITUDE"), "an amplitude in the model part, where *BOUNDARY fixes" &
      & //": expected it inside a step")
    if (has_parameter(deck%card(i_card), "OP")) call fault(context, deck, &
      & at_parameter(i_card, "OP"), "OP in the model part, where nothing is carried over: " &
      & //"expected it inside a step")
    do j = 1, size(deck%card(i_card)%data)
      associate (line => deck%card(i_card)%data(j))
        if (field_count(line) > 3) then
          if (abs(field_real(line, 4)) > 0.0_dp) call fault(context, deck, at_field(i_card, j, 4), &
            & "a displacement in the model part, where *BOUNDARY fixes: expected it inside a step")
        end if
      end associate
    end do
    call add_boundary(state, model, deck, context, i_card)
    state%support = state%fixed
  end subroutine fix_boundary

  !> Begins a step: what was prescribed stays where it is, or is released with OP=NEW.
  subroutine begin_boundary_step(state, deck, context, first, last)
    type(boundary_state_t), intent(inout) :: state  !! of the step before, or of the model part
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: first, last              !! cards of the step
    logical :: replace

    state%new = .false.
    call check_operation(replace, deck, context, ["BOUNDARY"], [first, last])
    if (replace) state%fixed = .false.
  end subroutine begin_boundary_step

  !> Whether the cards of some keywords in a step say OP=NEW; all must say the same.
  subroutine check_operation(replace, deck, context, keywords, range)
    logical, intent(out) :: replace                 !! OP=NEW
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(*), intent(in) :: keywords(:)         !! canonical
    integer, intent(in) :: range(2)                 !! (2) first and last card of the step
    logical :: is_new
    integer :: i, first

    replace = .false.
    first = 0
    do i = range(1), range(2)
      if (all(deck%card(i)%keyword /= keywords)) cycle
      is_new = parameter_choice(deck%card(i), "OP", "MOD") == "NEW"
      if (first == 0) then
        first = i
        replace = is_new
      else if (is_new .neqv. replace) then
        call fault(context, deck, at_parameter(i, "OP"), "OP differs from that of line " &
          & //integer_text(deck%card(first)%head%number)//": expected the same OP on every *" &
          & //deck%card(i)%keyword//" of a step")
      end if
    end do
  end subroutine check_operation

  !> Adds the lines of a *BOUNDARY card.
  subroutine add_boundary(state, model, deck, context, i_card)
    type(boundary_state_t), intent(inout) :: state  !! more is prescribed
    type(model_t), intent(in) :: model              !! with mesh and amplitudes
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *BOUNDARY
    integer, allocatable :: node(:)
    integer :: j, first, last, amplitude, direction
    real(dp) :: value

    call find_amplitude(amplitude, model, deck, context, i_card)
    do j = 1, size(deck%card(i_card)%data)
      associate (line => deck%card(i_card)%data(j))
        call nodes_of_field(node, state, model%mesh, deck, context, at_field(i_card, j, 1))
        first = field_integer(line, 2)
        last = first
        value = 0.0_dp
        if (field_count(line) > 2) last = field_integer(line, 3)
        if (field_count(line) > 3) value = field_real(line, 4)
        call check_directions(first, last, model%mesh%n_dim, deck, context, [i_card, j])
        do direction = first, min(last, model%mesh%n_dim)
          call prescribe(state, model%mesh, deck, context, node, direction, &
                         constraint_t(value=value, amplitude=amplitude, card=i_card, line=j))
        end do
      end associate
    end do
  end subroutine add_boundary

  !> Directions exist and are in order.
  subroutine check_directions(first, last, n_dim, deck, context, at)
    integer, intent(in) :: first, last              !! directions
    integer, intent(in) :: n_dim                    !! 2 or 3
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line

    if (first > n_dim) then
      call fault(context, deck, at_field(at(1), at(2), 2), "direction "//integer_text(first) &
                 //" in a plane mesh: expected 1 or 2")
    else if (last > n_dim) then
      call fault(context, deck, at_field(at(1), at(2), 3), "direction "//integer_text(last) &
                 //" in a plane mesh: expected 1 or 2")
    else if (last < first) then
      call fault(context, deck, at_field(at(1), at(2), 3), "the last direction is " &
                 //integer_text(last)//": expected at least the first, "//integer_text(first))
    end if
  end subroutine check_directions

  !> Prescribes one direction of some nodes. Twice in one step must mean the same.
  subroutine prescribe(state, mesh, deck, context, node, direction, condition)
    type(boundary_state_t), intent(inout) :: state  !! more is prescribed
    type(mesh_t), intent(in) :: mesh                !! labels
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: node(:)                  !! (n) nodes
    integer, intent(in) :: direction                !! 1..n_dim
    type(constraint_t), intent(in) :: condition     !! value, amplitude, card, line
    integer :: i
    logical :: reported

    reported = .false.
    do i = 1, size(node)
      associate (a => node(i), d => direction)
        if (state%new(d, a)) then
          if (abs(state%value(d, a) - condition%value) <= 0.0_dp .and. &
              state%amplitude(d, a) == condition%amplitude) cycle
          if (.not. reported) call fault(context, deck, &
            & at_field(condition%card, condition%line, 1), "node " &
            & //integer_text(mesh%node_label(a))//" direction "//integer_text(d)//" is " &
            & //real_text(condition%value)//" here and "//real_text(state%value(d, a)) &
            & //" in line "//integer_text(line_number(deck, state%card(d, a), state%line(d, a))) &
            & //": expected one displacement")
          reported = .true.
          cycle
        end if
        state%new(d, a) = .true.
        state%fixed(d, a) = .true.
        state%value(d, a) = condition%value
        state%amplitude(d, a) = condition%amplitude
        state%card(d, a) = condition%card
        state%line(d, a) = condition%line
      end associate
    end do
  end subroutine prescribe

  !> Number of a data line in its file.
  pure integer function line_number(deck, i_card, i_line) result(number)
    type(deck_t), intent(in) :: deck      !! the deck
    integer, intent(in) :: i_card, i_line !! card and data line

    number = deck%card(i_card)%data(i_line)%number
  end function line_number

  !> A warning where OP=NEW takes back supports of the model part that the step does not give again.
  subroutine warn_released(state, mesh, deck, context, range)
    type(boundary_state_t), intent(inout) :: state  !! with the lines of the step
    type(mesh_t), intent(in) :: mesh                !! labels
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the warning
    integer, intent(in) :: range(2)                 !! (2) first and last card of the step
    logical :: released(size(state%fixed, 1), size(state%fixed, 2))
    integer :: i, d, a

    released = state%support .and. .not. state%fixed
    state%support = state%support .and. state%fixed .and. .not. state%new
    if (.not. any(released)) return
    a = findloc(any(released, dim=1), .true., dim=1)
    d = findloc(released(:, a), .true., dim=1)
    do i = range(1), range(2) - 1
      if (deck%card(i)%keyword == "BOUNDARY") exit
    end do
    call warning_at_parameter(context%diag, deck, i, "OP", "OP=NEW releases supports of the " &
      & //"model part, in all "//integer_text(count(released))//", the first is direction " &
      & //integer_text(d)//" of node "//integer_text(mesh%node_label(a))//" in line " &
      & //integer_text(line_number(deck, state%card(d, a), state%line(d, a))) &
      & //": expected them in this step again, unless they are to be free")
  end subroutine warn_released

  !> Constraints of the step from what is prescribed, and the totals with which the next one starts.
  subroutine close_boundary_step(constraint, state, period, amplitude)
    type(constraint_t), allocatable, intent(out) :: constraint(:) !! one per line and direction
    type(boundary_state_t), intent(inout) :: state                !! ready for the next step
    real(dp), intent(in) :: period                                !! length of the step
    type(amplitude_t), intent(in) :: amplitude(:)                 !! amplitudes of the model
    type(constraint_t) :: next
    logical, allocatable :: left(:)
    integer :: a, d, n_node

    n_node = size(state%filled)
    allocate (constraint(0))
    do d = 1, size(state%fixed, 1)
      left = state%fixed(d, :)
      do a = 1, n_node
        if (.not. left(a)) cycle
        next = alike(state, left, d, a)
        constraint = [constraint, next]
        left(constraint(size(constraint))%node) = .false.
      end do
      do a = 1, n_node
        if (.not. state%fixed(d, a)) cycle
        if (state%amplitude(d, a) > 0) state%value(d, a) = state%value(d, a) &
          & *amplitude_value(amplitude(state%amplitude(d, a)), period)
      end do
    end do
    state%amplitude = 0
    state%was_free = .not. state%fixed
    state%start = merge(state%value, 0.0_dp, state%fixed)
  end subroutine close_boundary_step

  !> The constraint of all nodes that are prescribed like one node, by the same line.
  pure function alike(state, left, d, a) result(constraint)
    type(boundary_state_t), intent(in) :: state !! what is prescribed
    logical, intent(in) :: left(:)              !! (n_node) nodes without a constraint so far
    integer, intent(in) :: d, a                 !! direction and node
    type(constraint_t) :: constraint            !! of this node and those like it
    integer :: i

    constraint%direction = d
    constraint%value = state%value(d, a)
    constraint%start = state%start(d, a)
    constraint%was_free = state%was_free(d, a)
    constraint%amplitude = state%amplitude(d, a)
    constraint%card = state%card(d, a)
    constraint%line = state%line(d, a)
    constraint%node = pack([(i, i=1, size(left))], left .and. state%card(d, :) == constraint%card &
      & .and. state%line(d, :) == constraint%line &
      & .and. (state%was_free(d, :) .eqv. constraint%was_free) &
      & .and. abs(state%start(d, :) - constraint%start) <= 0.0_dp &
      & .and. abs(state%value(d, :) - constraint%value) <= 0.0_dp)
  end function alike

  !> The amplitude that a card names, 0 if it names none.
  subroutine find_amplitude(found, model, deck, context, i_card)
    integer, intent(out) :: found                   !! index of the amplitude
    type(model_t), intent(in) :: model              !! with amplitudes
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! marks the use, takes errors
    integer, intent(in) :: i_card                   !! card with AMPLITUDE=
    character(80), allocatable :: names(:)
    character(:), allocatable :: name
    integer :: i

    found = 0
    if (.not. has_parameter(deck%card(i_card), "AMPLITUDE")) return
    name = parameter_text(deck%card(i_card), "AMPLITUDE", "")
    allocate (names(size(model%amplitude)))
    do i = 1, size(names)
      names(i) = model%amplitude(i)%name
    end do
    call use_name(context, is_amplitude, name)
    do found = 1, size(names)
      if (same_name(names(found), name)) return
    end do
    found = 0
    call fault(context, deck, at_parameter(i_card, "AMPLITUDE"), "amplitude "//quoted(name) &
               //" is not defined: expected the NAME of an *AMPLITUDE", name_hint(name, names))
  end subroutine find_amplitude

  !> The nodes that a field names: a node set or one node. At least one must hold material; a node
  !! of *BOUNDARY may also lie off the body in a list of numbers that touches it.
  subroutine nodes_of_field(node, state, mesh, deck, context, place)
    integer, allocatable, intent(out) :: node(:)    !! (n) nodes, empty after an error
    type(boundary_state_t), intent(in) :: state     !! labels, filled nodes
    type(mesh_t), intent(in) :: mesh                !! with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(place_t), intent(in) :: place              !! the field
    character(:), allocatable :: name
    integer :: found

    associate (line => deck%card(place%card)%data(place%line))
      name = field_text(line, place%field)
      if (field_is_integer(line, place%field)) then
        found = find_label(state%label, field_integer(line, place%field))
        if (found > 0) node = [found]
        if (found == 0) call fault(context, deck, place, "node "//name//" is not defined: " &
          & //"expected a node of the mesh or the name of a node set")
      else
        call require_node_set(context, deck, mesh, place, name, found)
        if (found > 0) node = mesh%node_set(found)%item
      end if
    end associate
    if (.not. allocated(node)) allocate (node(0))
    if (size(node) == 0 .or. touches_body(state, deck%card(place%card), place, node)) return
    call fault(context, deck, place, quoted(name)//" touches no element with material points: " &
               //"expected nodes of the body", code=exit_model)
  end subroutine nodes_of_field

  !> Whether the nodes of a field hold material, or are one of a list of numbers in *BOUNDARY of
  !! which another one does: a background that is prescribed node by node.
  pure logical function touches_body(state, card, place, nodes) result(touches)
    type(boundary_state_t), intent(in) :: state !! labels, filled nodes
    type(deck_card_t), intent(in) :: card       !! card of the field
    type(place_t), intent(in) :: place          !! the field
    integer, intent(in) :: nodes(:)             !! (n) nodes that it names
    integer :: i

    touches = any(state%filled(nodes)) .or. .not. any(state%filled)
    if (touches .or. card%keyword /= "BOUNDARY") return
    if (.not. field_is_integer(card%data(place%line), place%field)) return
    do i = 1, size(card%data)
      touches = is_filled_node(state, card%data(i), place%field)
      if (touches) return
    end do
  end function touches_body

  !> Whether a field is the number of a node that holds material.
  pure logical function is_filled_node(state, line, field) result(filled)
    type(boundary_state_t), intent(in) :: state !! labels, filled nodes
    type(deck_line_t), intent(in) :: line       !! data line
    integer, intent(in) :: field                !! its field
    integer :: node

    filled = .false.
    if (.not. field_is_integer(line, field)) return
    node = find_label(state%label, field_integer(line, field))
    if (node > 0) filled = state%filled(node)
  end function is_filled_node

end module mpm_boundary_builder
