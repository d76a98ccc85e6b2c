!> Builds the mesh from the one source that the deck names: *MESH, *GENERATE or *NODE, *ELEMENT.
module mpm_mesh_builder
  use mpm_build_context, only: at_card, at_field, at_parameter, build_context_t, fault, fault_of, &
    & place_t
  use mpm_deck_card, only: deck_card_t, deck_t, field_integer, field_real, field_count, &
    & field_text, parameter_choice, parameter_integer, parameter_path, parameter_text
  use mpm_deck_mesh_builder, only: build_deck_mesh
  use mpm_error, only: error_t, exit_file, exit_model
  use mpm_gmsh_reader, only: read_gmsh
  use mpm_input_file, only: check_input
  use mpm_kinds, only: dp
  use mpm_labelled_mesh, only: label_parents, labelled_mesh_t
  use mpm_mesh, only: mesh_t
  use mpm_mesh_generator, only: box_settings_t, generate_box, graded_planes
  use mpm_parent_split, only: split_parents
  use mpm_text, only: integer_text, parse_integer, real_text, to_upper
  implicit none
  private
  public :: build_parents, build_linear_mesh

  character(1), parameter :: axis(3) = ["X", "Y", "Z"]
  integer, parameter :: max_cells = 10000             !! cells in a line of *GENERATE
  real(dp), parameter :: max_box_cells = 20000000.0_dp !! cells of a box

contains

  !> Builds the mesh of the user, with the sets that come with it.
  subroutine build_parents(mesh, source, deck, context)
    type(labelled_mesh_t), intent(out) :: mesh      !! complete when no error was added
    integer, intent(out) :: source                  !! card of the mesh, 0 after an error
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: n_before

    n_before = context%diag%n_errors
    call find_source(source, deck, context)
    if (source == 0) return
    select case (deck%card(source)%keyword)
    case ("MESH")
      call read_mesh_file(mesh, deck, context, source)
    case ("GENERATE")
      call generate(mesh, deck, context, source)
    case default
      call build_deck_mesh(mesh, deck, context)
    end select
    if (context%diag%n_errors > n_before) return
    if (deck%card(source)%keyword /= "ELEMENT") call label_parents(mesh)
  end subroutine build_parents

  !> Finds the card of the mesh; there must be exactly one source.
  subroutine find_source(source, deck, context)
    integer, intent(out) :: source                  !! card, 0 after an error
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(:), allocatable :: keyword
    integer :: i, first_node

    source = 0
    first_node = 0
    do i = 1, size(deck%card)
      keyword = deck%card(i)%keyword
      if (keyword == "NODE" .and. first_node == 0) first_node = i
      if (keyword /= "MESH" .and. keyword /= "GENERATE" .and. keyword /= "ELEMENT") cycle
      if (source == 0) then
        source = i
      else if (deck%card(source)%keyword /= keyword) then
        call fault(context, deck, at_card(i), "a second mesh, the first is *" &
          & //deck%card(source)%keyword//": expected one of *MESH, *GENERATE, *NODE with *ELEMENT")
        return
      end if
    end do
    call check_source(source, first_node, deck, context)
  end subroutine find_source

  !> Nodes and elements of the deck belong together, and exclude another mesh.
  subroutine check_source(source, first_node, deck, context)
    integer, intent(inout) :: source                !! card of the mesh, 0 after an error
    integer, intent(in) :: first_node               !! first *NODE, 0 if there is none
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors

    if (source == 0 .and. first_node > 0) then
      call fault(context, deck, at_card(first_node), "nodes without elements: expected *ELEMENT")
    else if (source == 0) then
      call fault(context, deck, at_card(1), "the deck has no mesh: expected *MESH, *GENERATE, or " &
                 //"*NODE and *ELEMENT")
    else if (first_node == 0 .and. deck%card(source)%keyword == "ELEMENT") then
      call fault(context, deck, at_card(source), "elements without nodes: expected *NODE")
      source = 0
    else if (first_node > 0 .and. deck%card(source)%keyword /= "ELEMENT") then
      call fault(context, deck, at_card(first_node), "a second mesh, the first is *" &
        & //deck%card(source)%keyword//": expected one of *MESH, *GENERATE, *NODE with *ELEMENT")
    end if
  end subroutine check_source

  !> *MESH: reads the file.
  subroutine read_mesh_file(mesh, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! parent is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *MESH
    character(:), allocatable :: path, reason
    integer :: n_before

    path = parameter_path(deck, deck%card(i_card), "FILE")
    call check_input(path, reason)
    if (len(reason) > 0) then
      call fault(context, deck, at_parameter(i_card, "FILE"), "cannot read this mesh: " &
        & //reason//": expected a gmsh file, 2.2 or 4.1 ASCII", code=exit_file)
      return
    end if
    n_before = context%diag%n_errors
    call read_gmsh(mesh%parent, path, context%diag)
    if (context%diag%n_errors > n_before) context%code = min(context%code, exit_model)
  end subroutine read_mesh_file

  !> *GENERATE: makes a box.
  subroutine generate(mesh, deck, context, i_card)
    type(labelled_mesh_t), intent(inout) :: mesh    !! parent is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *GENERATE
    type(box_settings_t) :: box
    type(error_t), allocatable :: error
    real(dp) :: cells
    integer :: i, n_before

    n_before = context%diag%n_errors
    associate (card => deck%card(i_card))
      box%n_dim = parameter_integer(card, "DIMENSION", 3)
      if (parameter_choice(card, "ORDER", "LINEAR") == "QUADRATIC") box%order = 2
      box%split = merge(2, parameter_integer(card, "CELL", 6), box%n_dim == 2)
      box%orientation = parameter_integer(card, "ORIENTATION", 1)
      box%elset = parameter_text(card, "ELSET", "ALL")
    end associate
    allocate (box%x(0), box%y(0), box%z(0))
    do i = 1, size(deck%card(i_card)%data)
      select case (to_upper(field_text(deck%card(i_card)%data(i), 1)))
      case ("X")
        call add_planes(box%x, deck, context, i_card, i)
      case ("Y")
        call add_planes(box%y, deck, context, i_card, i)
      case default
        if (box%n_dim == 2) call fault(context, deck, at_field(i_card, i, 1), "a line for z in a " &
          & //"plane mesh: expected X or Y, or DIMENSION=3")
        call add_planes(box%z, deck, context, i_card, i)
      end select
    end do
    if (context%diag%n_errors > n_before) return
    do i = 1, box%n_dim
      if (size(planes_of(box, i)) == 0) call fault(context, deck, at_card(i_card), &
        & "no cells in direction "//axis(i)//": expected a line '"//axis(i) &
        & //", start, end, cells'")
    end do
    if (context%diag%n_errors > n_before) return
    cells = 1.0_dp
    do i = 1, box%n_dim
      cells = cells*real(size(planes_of(box, i)) - 1, dp)
    end do
    if (cells > max_box_cells) then
      call fault(context, deck, at_card(i_card), "a box of "//real_text(cells) &
                 //" cells: expected at most "//real_text(max_box_cells))
      return
    end if
    call generate_box(mesh%parent, box, error)
    call fault_of(context, deck, at_card(i_card), error)
  end subroutine generate

  !> Planes of a box in a direction.
  pure function planes_of(box, direction) result(plane)
    type(box_settings_t), intent(in) :: box !! box
    integer, intent(in) :: direction        !! 1..3
    real(dp), allocatable :: plane(:)       !! (n) coordinates [length]

    select case (direction)
    case (1)
      plane = box%x
    case (2)
      plane = box%y
    case default
      plane = box%z
    end select
  end function planes_of

  !> Planes of one line of *GENERATE; they go on where the line before ended.
  subroutine add_planes(plane, deck, context, i_card, i_line)
    real(dp), allocatable, intent(inout) :: plane(:) !! (n) coordinates so far [length]
    type(deck_t), intent(in) :: deck                 !! the deck
    type(build_context_t), intent(inout) :: context  !! takes errors
    integer, intent(in) :: i_card, i_line            !! card and data line
    real(dp) :: first, last, ratio
    integer :: n

    associate (line => deck%card(i_card)%data(i_line))
      first = field_real(line, 2)
      last = field_real(line, 3)
      n = field_integer(line, 4)
      ratio = 1.0_dp
      if (field_count(line) > 4) ratio = field_real(line, 5)
      if (last <= first) then
        call fault(context, deck, at_field(i_card, i_line, 3), "the line ends at " &
                   //real_text(last)//", where it starts or before: expected more than " &
                   //real_text(first))
        return
      end if
      if (n > max_cells) then
        call fault(context, deck, at_field(i_card, i_line, 4), integer_text(n) &
                   //" cells in a line: expected at most "//integer_text(max_cells))
        return
      end if
      if (size(plane) > 0) then
        if (abs(plane(size(plane)) - first) > 1.0e-12_dp*(last - first)) then
          call fault(context, deck, at_field(i_card, i_line, 2), "the line starts at " &
                     //real_text(first)//": expected "//real_text(plane(size(plane))) &
                     //", the end of the line before")
          return
        end if
        plane = [plane(:size(plane) - 1), graded_planes(plane(size(plane)), last, n, ratio)]
      else
        plane = graded_planes(first, last, n, ratio)
      end if
    end associate
  end subroutine add_planes

  !> Splits the elements of the user into linear ones; faults of the mesh point at its card.
  subroutine build_linear_mesh(linear, mesh, deck, context, source)
    type(mesh_t), intent(out) :: linear             !! complete; without elements after an error
    type(labelled_mesh_t), intent(in) :: mesh       !! mesh of the user with all sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: source                   !! card of the mesh
    type(error_t), allocatable :: error

    call split_parents(mesh%parent, linear, error)
    if (.not. allocated(error)) return
    linear%n_el = 0
    call fault_of(context, deck, place_of_fault(deck, source, error%message), error)
  end subroutine build_linear_mesh

  !> Place of a faulty element: its line if the deck holds it, else the card of the mesh.
  pure function place_of_fault(deck, source, message) result(place)
    type(deck_t), intent(in) :: deck      !! the deck
    integer, intent(in) :: source         !! card of the mesh
    character(*), intent(in) :: message   !! starts with "element" and a number when there is one
    type(place_t) :: place                !! what to point at
    integer :: i, j, label
    logical :: ok

    place = at_card(source)
    if (deck%card(source)%keyword == "MESH") place = at_parameter(source, "FILE")
    if (deck%card(source)%keyword /= "ELEMENT" .or. index(message, "element ") /= 1) return
    call parse_integer(message(9:8 + scan(message(9:)//":", ": ") - 1), label, ok)
    if (.not. ok) return
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "ELEMENT") cycle
      do j = 1, size(deck%card(i)%data)
        if (field_integer(deck%card(i)%data(j), 1) == label) then
          place = at_field(i, j, 1)
          return
        end if
      end do
    end do
  end function place_of_fault

end module mpm_mesh_builder
