!> Builds the axes of nodes from *TRANSFORM.
module mpm_frame_builder
  use mpm_build_context, only: at_field, at_parameter, build_context_t, fault, &
    & require_node_set
  use mpm_deck_card, only: deck_card_t, deck_t, field_count, field_real, parameter_choice, &
    & parameter_text
  use mpm_error, only: exit_model
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_nodal_frames, only: axes_at, frame_cylindrical, frame_is_defined, frame_rectangular, &
    & frame_spherical, nodal_frames_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: build_frames

  real(dp), parameter :: aligned = 1.0e-9_dp !! offset of an axis over its length that counts as 0

  !> What a *TRANSFORM says.
  type :: frame_rule_t
    integer  :: kind = frame_rectangular  !! frame_*
    real(dp) :: point(3, 2) = 0.0_dp      !! (3, 2)  points a and b [length]
  end type frame_rule_t

contains

  !> Builds the axes of all nodes; without *TRANSFORM nothing is allocated.
  subroutine build_frames(frames, mesh, deck, context)
    type(nodal_frames_t), intent(out) :: frames     !! axes of the nodes
    type(mesh_t), intent(in) :: mesh                !! initial mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! marks the use of sets, takes errors
    integer, allocatable :: card_of(:)
    integer :: i

    allocate (card_of(mesh%n_node), source=0)
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword == "TRANSFORM") then
        call add_frames(frames, card_of, mesh, deck, context, i)
      end if
    end do
  end subroutine build_frames

  !> One *TRANSFORM card.
  subroutine add_frames(frames, card_of, mesh, deck, context, i_card)
    type(nodal_frames_t), intent(inout) :: frames   !! more nodes get axes
    integer, intent(inout) :: card_of(:)            !! (n_node)  card that gave axes, 0 = none
    type(mesh_t), intent(in) :: mesh                !! initial mesh with sets
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! marks the use of sets, takes errors
    integer, intent(in) :: i_card                   !! *TRANSFORM
    type(frame_rule_t) :: rule
    integer :: found, n_before

    n_before = context%diag%n_errors
    rule%kind = kind_of(deck%card(i_card))
    call require_node_set(context, deck, mesh, at_parameter(i_card, "NSET"), &
                          parameter_text(deck%card(i_card), "NSET", ""), found)
    call read_points(rule, mesh%n_dim, deck, context, i_card)
    if (context%diag%n_errors > n_before) return
    if (.not. frame_is_defined(rule%kind, rule%point(:, 1), rule%point(:, 2))) then
      call fault(context, deck, at_field(i_card, 1, 0), degenerate_text(rule%kind))
      return
    end if
    associate (node => mesh%node_set(found)%item)
      call check_single(card_of, node, mesh, deck, context, i_card)
      if (context%diag%n_errors > n_before) return
      card_of(node) = i_card
      call append_axes(frames, rule, node, mesh, deck, context, i_card)
    end associate
  end subroutine add_frames

  !> The kind of a *TRANSFORM.
  pure integer function kind_of(card) result(kind)
    type(deck_card_t), intent(in) :: card !! *TRANSFORM

    select case (parameter_choice(card, "TYPE", "R"))
    case ("C")
      kind = frame_cylindrical
    case ("S")
      kind = frame_spherical
    case default
      kind = frame_rectangular
    end select
  end function kind_of

  !> The points a and b; in a plane mesh their z is 0, and a cylinder has its axis along z.
  subroutine read_points(rule, n_dim, deck, context, i_card)
    type(frame_rule_t), intent(inout) :: rule       !! with its kind; points are set
    integer, intent(in) :: n_dim                    !! 2 or 3
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *TRANSFORM
    integer :: i, n
    character(:), allocatable :: expected

    associate (line => deck%card(i_card)%data(1), point => rule%point)
      n = field_count(line)
      expected = numbers_expected(n, rule%kind, n_dim)
      if (n_dim == 2 .and. rule%kind == frame_spherical) then
        call fault(context, deck, at_parameter(i_card, "TYPE"), &
                   "spherical axes in a plane mesh: expected TYPE=R or TYPE=C")
      else if (len(expected) > 0) then
        call fault(context, deck, at_field(i_card, 1, 0), integer_text(n)//" numbers in a " &
                   //trim(merge("plane", "3-D  ", n_dim == 2))//" mesh: expected "//expected)
      else if (n == 6) then
        point = reshape([(field_real(line, i), i=1, 6)], [3, 2])
        if (n_dim == 2) call flatten(rule, deck, context, i_card)
      else
        point(1:2, 1) = [field_real(line, 1), field_real(line, 2)]
        point(:, 2) = [point(1:2, 1), 1.0_dp + norm2(point(:, 1))]
        if (n == 4) point(:, 2) = [field_real(line, 3), field_real(line, 4), 0.0_dp]
      end if
    end associate
  end subroutine read_points

  !> Which numbers a data line must hold, empty if their count is right.
  pure function numbers_expected(n, kind, n_dim) result(text)
    integer, intent(in) :: n          !! numbers that it holds
    integer, intent(in) :: kind       !! frame_*
    integer, intent(in) :: n_dim      !! 2 or 3
    character(:), allocatable :: text

    text = "xa, ya, za, xb, yb, zb"
    if (n_dim == 2 .and. kind == frame_rectangular) text = "xa, ya, xb, yb"
    if (n_dim == 2 .and. kind == frame_cylindrical) text = "xa, ya of the axis"
    if (n == 6) text = ""
    if (n_dim == 2 .and. n == merge(4, 2, kind == frame_rectangular)) text = ""
  end function numbers_expected

  !> Six numbers in a plane mesh: rectangular axes lie in the plane, an axis is normal to it.
  subroutine flatten(rule, deck, context, i_card)
    type(frame_rule_t), intent(inout) :: rule       !! points are moved into the plane
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: i_card                   !! *TRANSFORM
    real(dp) :: rise
    integer :: i

    associate (a => rule%point(:, 1), b => rule%point(:, 2))
      if (rule%kind == frame_cylindrical) then
        rise = b(3) - a(3)
        if (norm2(b(1:2) - a(1:2)) > aligned*abs(rise)) call fault(context, deck, &
          & at_field(i_card, 1, 4), "the axis is not normal to the plane of the mesh: expected " &
          & //"xb, yb equal to xa, ya, and zb another than za")
        a(3) = 0.0_dp
        b = a
        if (abs(rise) > 0.0_dp) b(3) = sign(1.0_dp + norm2(a), rise)
        return
      end if
    end associate
    do i = 1, 2
      if (abs(rule%point(3, i)) > 0.0_dp) call fault(context, deck, at_field(i_card, 1, 3*i), &
        & "z = "//real_text(rule%point(3, i))//" in a plane mesh: expected 0")
    end do
  end subroutine flatten

  !> What is wrong with two points that define no frame.
  pure function degenerate_text(kind) result(text)
    integer, intent(in) :: kind       !! frame_*
    character(:), allocatable :: text

    select case (kind)
    case (frame_rectangular)
      text = "a and b lie on one line through the origin: expected a on axis 1 and b beside it, " &
             //"in the plane of axes 1 and 2"
    case (frame_cylindrical)
      text = "a and b are the same point: expected two points of the axis"
    case default
      text = "a and b are the same point: expected the centre and a point of the polar axis"
    end select
  end function degenerate_text

  !> A node has one frame.
  subroutine check_single(card_of, node, mesh, deck, context, i_card)
    integer, intent(in) :: card_of(:)               !! (n_node)  card that gave axes, 0 = none
    integer, intent(in) :: node(:)                  !! nodes of the card
    type(mesh_t), intent(in) :: mesh                !! labels
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_card                   !! *TRANSFORM
    integer :: i

    do i = 1, size(node)
      if (card_of(node(i)) == 0) cycle
      call fault(context, deck, at_parameter(i_card, "NSET"), "node " &
                 //integer_text(mesh%node_label(node(i)))//" has axes by the *TRANSFORM of line " &
                 //integer_text(deck%card(card_of(node(i)))%head%number) &
                 //" already: expected one *TRANSFORM for a node")
      return
    end do
  end subroutine check_single

  !> Axes of nodes from their places in the initial mesh.
  subroutine append_axes(frames, rule, node, mesh, deck, context, i_card)
    type(nodal_frames_t), intent(inout) :: frames   !! more nodes have axes
    type(frame_rule_t), intent(in) :: rule          !! kind and points
    integer, intent(in) :: node(:)                  !! (n)  nodes
    type(mesh_t), intent(in) :: mesh                !! initial mesh
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes the error
    integer, intent(in) :: i_card                   !! *TRANSFORM
    real(dp), allocatable :: rotation(:, :, :)
    real(dp) :: axes(3, 3), x(3)
    integer :: i, n
    logical :: defined

    if (.not. allocated(frames%of_node)) then
      allocate (frames%of_node(mesh%n_node), source=0)
      allocate (frames%rotation(mesh%n_dim, mesh%n_dim, 0))
    end if
    n = size(frames%rotation, 3)
    allocate (rotation(mesh%n_dim, mesh%n_dim, n + size(node)))
    rotation(:, :, :n) = frames%rotation
    do i = 1, size(node)
      x = 0.0_dp
      x(:mesh%n_dim) = mesh%x(:, node(i))
      call axes_at(axes, defined, rule%kind, rule%point(:, 1), rule%point(:, 2), x)
      if (.not. defined) then
        call fault(context, deck, at_parameter(i_card, "NSET"), "node " &
                   //integer_text(mesh%node_label(node(i)))//" lies on the axis, where radial " &
                   //"and tangential have no direction: expected nodes beside it", code=exit_model)
        return
      end if
      rotation(:, :, n + i) = axes(:mesh%n_dim, :mesh%n_dim)
      frames%of_node(node(i)) = n + i
    end do
    call move_alloc(rotation, frames%rotation)
  end subroutine append_axes

end module mpm_frame_builder
