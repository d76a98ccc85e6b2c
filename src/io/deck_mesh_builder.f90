!> Builds a mesh from *NODE and *ELEMENT.
module mpm_deck_mesh_builder
  use mpm_build_context, only: at_field, at_parameter, build_context_t, fault
  use mpm_deck_card, only: deck_card_t, deck_t, field_count, field_integer, field_real, &
    & has_parameter, parameter_choice, parameter_text
  use mpm_error, only: exit_model
  use mpm_face_table, only: build_face_table, face_table_t, find_face
  use mpm_kinds, only: dp
  use mpm_label_table, only: build_label_table, find_label
  use mpm_labelled_mesh, only: add_set, body_element, carrier_element, edge_element, &
    & labelled_mesh_t
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: build_deck_mesh

  !> Nodes and elements as the deck gives them.
  type :: deck_lines_t
    integer :: n_node = 0, n_el = 0
    integer, allocatable  :: node_label(:), node_card(:), node_line(:) !! (n_node)
    real(dp), allocatable :: x(:, :)                                   !! (3, n_node) [length]
    integer, allocatable  :: el_label(:), el_card(:), el_line(:)       !! (n_el)
    integer, allocatable  :: node(:, :)                                !! (10, n_el) 0 = none
  end type deck_lines_t

contains

  !> Builds the mesh. Nodes that no element of the body uses are left out.
  subroutine build_deck_mesh(mesh, deck, context)
    type(labelled_mesh_t), intent(out) :: mesh      !! complete when no error was added
    type(deck_t), intent(in) :: deck                !! with *NODE and *ELEMENT
    type(build_context_t), intent(inout) :: context !! takes errors
    type(deck_lines_t) :: lines
    integer :: n_before

    n_before = context%diag%n_errors
    call choose_kind(mesh%parent, deck, context)
    if (context%diag%n_errors > n_before) return
    call read_nodes(lines, mesh, deck, context)
    if (context%diag%n_errors > n_before) return
    call read_elements(lines, mesh, deck, context)
    if (context%diag%n_errors > n_before) return
    call classify(mesh, lines, deck)
    call fill_parent(mesh, lines)
    call check_carriers(mesh, lines, deck, context)
    call join_sets(mesh, lines, deck)
  end subroutine build_deck_mesh

  !> Dimension and order of the mesh from the types of the elements.
  subroutine choose_kind(parent, deck, context)
    type(parent_mesh_t), intent(inout) :: parent    !! n_dim and order are set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(:), allocatable :: first_type
    integer :: i, first

    first = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "ELEMENT") cycle
      if (first == 0 .or. solid_dimension(element_type(deck%card(i))) > 0) first = i
      if (solid_dimension(element_type(deck%card(i))) > 0) exit
    end do
    first_type = element_type(deck%card(first))
    parent%n_dim = solid_dimension(first_type)
    parent%order = element_order(first_type)
    if (parent%n_dim == 0) then
      call fault(context, deck, at_parameter(first, "TYPE"), "the deck has no elements for " &
        & //"material, "//first_type//" only carries surfaces: expected CPE3, CPE6, C3D4 or " &
        & //"C3D10", solid_hint(first_type))
      return
    end if
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "ELEMENT") call check_type(parent, deck, context, i)
    end do
  end subroutine choose_kind

  !> The plane-strain type that was probably meant.
  pure function solid_hint(el_type) result(hint)
    character(*), intent(in) :: el_type !! type of the deck
    character(:), allocatable :: hint   !! empty if there is none

    hint = ""
    if (el_type == "CPS3" .or. el_type == "S3") hint = "plane strain is CPE3"
    if (el_type == "CPS6" .or. el_type == "STRI65") hint = "plane strain is CPE6"
  end function solid_hint

  !> All elements of the body are of one type, carriers fit them.
  subroutine check_type(parent, deck, context, i_card)
    type(parent_mesh_t), intent(in) :: parent       !! with n_dim and order
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *ELEMENT card
    character(4), parameter :: plane(2) = ["CPE3", "CPE6"], line(2) = ["T3D2", "T3D3"]
    character(5), parameter :: solid(2) = ["C3D4 ", "C3D10"]
    character(:), allocatable :: expected, el_type

    el_type = element_type(deck%card(i_card))
    if (parent%n_dim == 2) then
      expected = plane(parent%order)//", or "//line(parent%order)//" for boundaries"
      if (el_type == plane(parent%order) .or. el_type == line(parent%order)) return
    else
      expected = trim(solid(parent%order))//", or "//trim(merge("S3, CPS3    ", "STRI65, CPS6", &
        & parent%order == 1))//" for boundaries"
      if (el_type == trim(solid(parent%order))) return
      if (solid_dimension(el_type) == 0 .and. element_order(el_type) == parent%order) return
    end if
    call fault(context, deck, at_parameter(i_card, "TYPE"), el_type//" does not fit into this " &
      & //"mesh of "//trim(merge("linear   ", "quadratic", parent%order == 1))//" elements in " &
      & //integer_text(parent%n_dim)//"-D: expected "//expected)
  end subroutine check_type

  !> Type of the elements of a card.
  pure function element_type(card) result(el_type)
    type(deck_card_t), intent(in) :: card !! *ELEMENT
    character(:), allocatable :: el_type  !! upper case

    el_type = parameter_choice(card, "TYPE", "")
  end function element_type

  !> 2 or 3 for elements that hold material, 0 for carriers.
  pure integer function solid_dimension(el_type) result(n_dim)
    character(*), intent(in) :: el_type !! type of the deck

    n_dim = 0
    if (index(el_type, "CPE") == 1) n_dim = 2
    if (index(el_type, "C3D") == 1) n_dim = 3
  end function solid_dimension

  !> Order of a type.
  pure integer function element_order(el_type) result(order)
    character(*), intent(in) :: el_type !! type of the deck

    select case (el_type)
    case ("CPE6", "C3D10", "T3D3", "CPS6", "STRI65")
      order = 2
    case default
      order = 1
    end select
  end function element_order

  !> Reads all *NODE cards.
  subroutine read_nodes(lines, mesh, deck, context)
    type(deck_lines_t), intent(inout) :: lines      !! nodes are set
    type(labelled_mesh_t), intent(inout) :: mesh    !! node_table is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: i, j, k, duplicate

    call count_lines(deck, "NODE", lines%node_card, lines%node_line)
    lines%n_node = size(lines%node_card)
    allocate (lines%node_label(lines%n_node), lines%x(3, lines%n_node))
    lines%x = 0.0_dp
    do i = 1, lines%n_node
      associate (line => deck%card(lines%node_card(i))%data(lines%node_line(i)))
        lines%node_label(i) = field_integer(line, 1)
        do k = 2, field_count(line)
          lines%x(k - 1, i) = field_real(line, k)
        end do
        j = field_count(line)
      end associate
      if (mesh%parent%n_dim == 3 .and. j < 4) then
        call fault(context, deck, at_field(lines%node_card(i), lines%node_line(i), 4), &
                   "a node without z in a 3-D mesh: expected number, x, y, z")
      else if (mesh%parent%n_dim == 2 .and. abs(lines%x(3, i)) > 0.0_dp) then
        call fault(context, deck, at_field(lines%node_card(i), lines%node_line(i), 4), "z = " &
                   //real_text(lines%x(3, i))//" in a plane mesh: expected z = 0 or no z")
      end if
    end do
    call build_label_table(mesh%node_table, lines%node_label, duplicate)
    if (duplicate > 0) call fault(context, deck, at_field(lines%node_card(duplicate), &
      & lines%node_line(duplicate), 1), "node "//integer_text(lines%node_label(duplicate)) &
      & //" is defined twice: expected every number once")
  end subroutine read_nodes

  !> Card and data line of all data lines of a keyword.
  subroutine count_lines(deck, keyword, card, line)
    type(deck_t), intent(in) :: deck            !! the deck
    character(*), intent(in) :: keyword         !! canonical
    integer, allocatable, intent(out) :: card(:) !! (n)
    integer, allocatable, intent(out) :: line(:) !! (n)
    integer :: i, j, n

    n = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == keyword) n = n + size(deck%card(i)%data)
    end do
    allocate (card(n), line(n))
    n = 0
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= keyword) cycle
      do j = 1, size(deck%card(i)%data)
        n = n + 1
        card(n) = i
        line(n) = j
      end do
    end do
  end subroutine count_lines

  !> Reads all *ELEMENT cards.
  subroutine read_elements(lines, mesh, deck, context)
    type(deck_lines_t), intent(inout) :: lines      !! elements are set
    type(labelled_mesh_t), intent(inout) :: mesh    !! element_table is set
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer :: i, k, duplicate

    call count_lines(deck, "ELEMENT", lines%el_card, lines%el_line)
    lines%n_el = size(lines%el_card)
    allocate (lines%el_label(lines%n_el), lines%node(10, lines%n_el), source=0)
    do i = 1, lines%n_el
      associate (line => deck%card(lines%el_card(i))%data(lines%el_line(i)))
        lines%el_label(i) = field_integer(line, 1)
        do k = 2, field_count(line)
          lines%node(k - 1, i) = find_label(mesh%node_table, field_integer(line, k))
          if (lines%node(k - 1, i) == 0) then
            call fault(context, deck, at_field(lines%el_card(i), lines%el_line(i), k), "node " &
              & //integer_text(field_integer(line, k))//" is not defined: expected a node of *NODE")
          else if (any(lines%node(:k - 2, i) == lines%node(k - 1, i))) then
            call fault(context, deck, at_field(lines%el_card(i), lines%el_line(i), k), "node " &
              & //integer_text(field_integer(line, k))//" appears twice in element " &
              & //integer_text(lines%el_label(i))//": expected different nodes", code=exit_model)
          end if
        end do
      end associate
    end do
    call build_label_table(mesh%element_table, lines%el_label, duplicate)
    if (duplicate > 0) call fault(context, deck, at_field(lines%el_card(duplicate), &
      & lines%el_line(duplicate), 1), "element "//integer_text(lines%el_label(duplicate)) &
      & //" is defined twice: expected every number once")
  end subroutine read_elements

  !> Kind of each element, and its index among those of its kind.
  subroutine classify(mesh, lines, deck)
    type(labelled_mesh_t), intent(inout) :: mesh !! kind and item are set
    type(deck_lines_t), intent(in) :: lines      !! elements
    type(deck_t), intent(in) :: deck             !! the deck
    character(:), allocatable :: el_type
    integer :: i, n(3), kind, last_card

    n = 0
    kind = 0
    last_card = 0
    allocate (mesh%kind(lines%n_el), mesh%item(lines%n_el))
    do i = 1, lines%n_el
      if (lines%el_card(i) /= last_card) then
        last_card = lines%el_card(i)
        el_type = element_type(deck%card(last_card))
        kind = carrier_element
        if (solid_dimension(el_type) > 0) kind = body_element
        if (mesh%parent%n_dim == 3 .and. index(el_type, "T3D") == 1) kind = edge_element
      end if
      n(kind) = n(kind) + 1
      mesh%kind(i) = kind
      mesh%item(i) = n(kind)
    end do
  end subroutine classify

  !> Nodes and elements of the mesh; the nodes are numbered anew.
  subroutine fill_parent(mesh, lines)
    type(labelled_mesh_t), intent(inout) :: mesh !! all of parent but sets
    type(deck_lines_t), intent(in) :: lines      !! nodes and elements
    integer :: i, j, n_en
    logical, allocatable :: used(:)

    associate (parent => mesh%parent)
      n_en = merge(parent%n_dim + 1, (parent%n_dim + 1)*(parent%n_dim + 2)/2, parent%order == 1)
      allocate (used(lines%n_node), source=.false.)
      do i = 1, lines%n_el
        if (mesh%kind(i) == body_element) used(lines%node(:n_en, i)) = .true.
      end do
      parent%n_node = count(used)
      mesh%new_node = unpack([(i, i=1, parent%n_node)], used, 0)
      parent%node_label = pack(lines%node_label, used)
      allocate (parent%x(parent%n_dim, parent%n_node))
      do j = 1, parent%n_dim
        parent%x(j, :) = pack(lines%x(j, :), used)
      end do
      parent%n_el = count(mesh%kind == body_element)
      parent%element_label = pack(lines%el_label, mesh%kind == body_element)
      allocate (parent%node(n_en, parent%n_el))
      allocate (mesh%carrier_node(6, count(mesh%kind == carrier_element)), source=0)
      allocate (mesh%edge_node(6, count(mesh%kind == edge_element)), source=0)
      do i = 1, lines%n_el
        select case (mesh%kind(i))
        case (body_element)
          parent%node(:, mesh%item(i)) = mesh%new_node(lines%node(:n_en, i))
        case (carrier_element)
          mesh%carrier_node(:, mesh%item(i)) = renumbered(lines%node(:6, i), mesh%new_node)
        case default
          mesh%edge_node(:, mesh%item(i)) = renumbered(lines%node(:6, i), mesh%new_node)
        end select
      end do
      parent%carrier = mesh%carrier_node(:parent%n_dim, :)
      allocate (parent%node_set(0), parent%element_set(0), parent%carrier_set(0), &
                parent%surface(0))
    end associate
  end subroutine fill_parent

  !> New numbers of nodes, 0 where there is no node.
  pure function renumbered(node, new_node) result(renumbered_node)
    integer, intent(in) :: node(:)            !! (n) old numbers, 0 = none
    integer, intent(in) :: new_node(:)        !! (m) new number of each old one
    integer :: renumbered_node(size(node))    !! (n) new numbers
    integer :: i

    renumbered_node = 0
    do i = 1, size(node)
      if (node(i) > 0) renumbered_node(i) = new_node(node(i))
    end do
  end function renumbered

  !> Carriers are faces of the body.
  subroutine check_carriers(mesh, lines, deck, context)
    type(labelled_mesh_t), intent(in) :: mesh       !! complete but for sets
    type(deck_lines_t), intent(in) :: lines         !! elements
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    type(face_table_t) :: table
    integer :: i, element, face

    associate (parent => mesh%parent)
      if (size(parent%carrier, 2) == 0) return
      call build_face_table(table, parent%node(:parent%n_dim + 1, :), parent%n_node)
      do i = 1, lines%n_el
        if (mesh%kind(i) /= carrier_element) cycle
        element = 0
        if (all(parent%carrier(:, mesh%item(i)) > 0)) then
          call find_face(table, parent%carrier(:, mesh%item(i)), element, face)
        end if
        if (element > 0) cycle
        call fault(context, deck, at_field(lines%el_card(i), lines%el_line(i), 1), &
                   "boundary element "//integer_text(lines%el_label(i))//" is no face of the " &
                   //"body: expected the nodes of a face", code=exit_model)
      end do
    end associate
  end subroutine check_carriers

  !> Sets named by NSET= of *NODE and ELSET= of *ELEMENT.
  subroutine join_sets(mesh, lines, deck)
    type(labelled_mesh_t), intent(inout) :: mesh    !! sets are added
    type(deck_lines_t), intent(in) :: lines         !! nodes and elements
    type(deck_t), intent(in) :: deck                !! the deck
    character(:), allocatable :: name
    integer, allocatable :: of_card(:)
    integer :: i

    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "NODE" .and. has_parameter(deck%card(i), "NSET")) then
        of_card = pack(mesh%new_node, lines%node_card == i)
        call add_set(mesh%parent%node_set, parameter_text(deck%card(i), "NSET", ""), of_card)
      else if (deck%card(i)%keyword == "ELEMENT" .and. has_parameter(deck%card(i), "ELSET")) then
        name = parameter_text(deck%card(i), "ELSET", "")
        of_card = pack(mesh%item, lines%el_card == i)
        select case (mesh%kind(findloc(lines%el_card, i, dim=1)))
        case (body_element)
          call add_set(mesh%parent%element_set, name, of_card)
        case (carrier_element)
          call add_set(mesh%parent%carrier_set, name, of_card)
          call add_set(mesh%parent%node_set, name, pack(mesh%carrier_node(:, of_card), .true.))
        case default
          call add_set(mesh%parent%node_set, name, pack(mesh%edge_node(:, of_card), .true.))
        end select
      end if
    end do
  end subroutine join_sets

end module mpm_deck_mesh_builder
