!> Which elements the ghost penalty holds together: neighbours at the edge of the body, and parts of
!! the body that hang together by nodes only.
module mpm_ghost_pairs
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  implicit none
  private
  public :: ghost_pairs_t, find_ghost_pairs

  !> Pairs of active elements. The first n_face pairs share a face.
  type :: ghost_pairs_t
    integer :: n = 0
    integer :: n_face = 0
    integer, allocatable :: element(:, :) !! (2, n)
  end type ghost_pairs_t

contains

  !> Pairs that share a face, then pairs that join parts. Source: theory.md section 13.
  pure subroutine find_ghost_pairs(pairs, mesh, active, filled)
    type(ghost_pairs_t), intent(out) :: pairs
    type(mesh_t), intent(in) :: mesh      !! with neighbours
    logical, intent(in)      :: active(:) !! (n_el)  hosts a point
    real(dp), intent(in)     :: filled(:) !! (n_el)  volume of the points over that of the element
    integer, allocatable :: face(:, :), joint(:, :)
    integer :: n_joint

    allocate (face(2, size(mesh%neighbour)/2), joint(2, size(mesh%node)))
    call find_faces(face, pairs%n_face, mesh, active)
    call find_joints(joint, n_joint, mesh, parts_of(mesh, active), filled)
    pairs%n = pairs%n_face + n_joint
    pairs%element = reshape([face(:, :pairs%n_face), joint(:, :n_joint)], [2, pairs%n])
  end subroutine find_ghost_pairs

  !> Pairs of active elements that share a face, of which at least one has a node of an inactive
  !! element. The boundary of the mesh is no inactive element.
  pure subroutine find_faces(element, n, mesh, active)
    integer, intent(out)     :: element(:, :) !! (2, at least n)
    integer, intent(out)     :: n             !! pairs
    type(mesh_t), intent(in) :: mesh          !! with neighbours
    logical, intent(in)      :: active(:)     !! (n_el)
    logical, allocatable :: edge(:)
    integer :: a, e, neighbour

    edge = at_edge(mesh, active)
    n = 0
    do e = 1, mesh%n_el
      if (.not. active(e)) cycle
      do a = 1, mesh%n_dim + 1
        neighbour = mesh%neighbour(a, e)
        if (neighbour <= e) cycle
        if (.not. (active(neighbour) .and. any(edge([e, neighbour])))) cycle
        n = n + 1
        element(:, n) = [e, neighbour]
      end do
    end do
  end subroutine find_faces

  !> Elements with a node that an inactive element has, too.
  pure function at_edge(mesh, active) result(edge)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in)      :: active(:) !! (n_el)
    logical :: edge(size(active))
    logical, allocatable :: shared(:)
    integer :: e

    allocate (shared(mesh%n_node), source=.false.)
    do e = 1, mesh%n_el
      if (.not. active(e)) shared(mesh%node(:, e)) = .true.
    end do
    do e = 1, mesh%n_el
      edge(e) = any(shared(mesh%node(:, e)))
    end do
  end function at_edge

  !> Numbers the parts of the body: active elements that a chain of shared faces connects.
  pure function parts_of(mesh, active) result(part)
    type(mesh_t), intent(in) :: mesh      !! with neighbours
    logical, intent(in)      :: active(:) !! (n_el)
    integer :: part(size(active))         !! (n_el)  from 1; 0 if inactive
    integer, allocatable :: stack(:)
    integer :: first, n_part

    allocate (stack(size(active)))
    part = 0
    n_part = 0
    do first = 1, mesh%n_el
      if (.not. active(first) .or. part(first) > 0) cycle
      n_part = n_part + 1
      call fill_part(part, stack, mesh, active, first, n_part)
    end do
  end function parts_of

  !> Gives a number to an element and to all that a chain of shared faces connects with it.
  pure subroutine fill_part(part, stack, mesh, active, first, number)
    integer, intent(inout)   :: part(:)   !! (n_el)  0 where no number was given yet
    integer, intent(inout)   :: stack(:)  !! (n_el)  work space
    type(mesh_t), intent(in) :: mesh      !! with neighbours
    logical, intent(in)      :: active(:) !! (n_el)
    integer, intent(in)      :: first     !! the element
    integer, intent(in)      :: number
    integer :: a, n_stack, neighbour, reach(mesh%n_dim + 1)

    part(first) = number
    n_stack = 1
    stack(1) = first
    do while (n_stack > 0)
      reach = mesh%neighbour(:, stack(n_stack))
      n_stack = n_stack - 1
      do a = 1, size(reach)
        neighbour = reach(a)
        if (neighbour == 0) cycle
        if (.not. active(neighbour) .or. part(neighbour) > 0) cycle
        part(neighbour) = number
        n_stack = n_stack + 1
        stack(n_stack) = neighbour
      end do
    end do
  end subroutine fill_part

  !> At every node where parts meet: the fullest element there, with each one of another part.
  pure subroutine find_joints(element, n, mesh, part, filled)
    integer, intent(out)     :: element(:, :) !! (2, at least n)
    integer, intent(out)     :: n             !! pairs
    type(mesh_t), intent(in) :: mesh
    integer, intent(in)      :: part(:)       !! (n_el)  0 if inactive
    real(dp), intent(in)     :: filled(:)     !! (n_el)
    integer, allocatable :: fullest(:)
    integer :: a, e, first, s

    n = 0
    if (maxval(part) < 2) return
    fullest = fullest_at_node(mesh, part, filled)
    do e = 1, mesh%n_el
      if (part(e) == 0) cycle
      first = n + 1
      do a = 1, mesh%n_dim + 1
        s = fullest(mesh%node(a, e))
        if (part(s) == part(e)) cycle
        if (any(element(2, first:n) == s)) cycle
        n = n + 1
        element(:, n) = [e, s]
      end do
    end do
  end subroutine find_joints

  !> The active element with the most material around each node, 0 if there is none.
  pure function fullest_at_node(mesh, part, filled) result(fullest)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in)      :: part(:)   !! (n_el)  0 if inactive
    real(dp), intent(in)     :: filled(:) !! (n_el)
    integer :: fullest(mesh%n_node)
    integer :: a, e

    fullest = 0
    do e = 1, mesh%n_el
      if (part(e) == 0) cycle
      do a = 1, mesh%n_dim + 1
        associate (best => fullest(mesh%node(a, e)))
          if (best == 0) then
            best = e
          else if (filled(e) > filled(best)) then
            best = e
          end if
        end associate
      end do
    end do
  end function fullest_at_node

end module mpm_ghost_pairs
