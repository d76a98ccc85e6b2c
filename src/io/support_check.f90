!> Whether the constraints of a step hold every body: no rigid-body mode may be left free.
module mpm_support_check
  use mpm_dof_map, only: constraint_t
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_nodal_frames, only: in_global_axes, nodal_frames_t
  use mpm_tensor, only: cross_product
  use mpm_text, only: integer_text
  implicit none
  private
  public :: find_free_modes, find_hinge, suggest_support

  real(dp), parameter :: rank_tolerance = 1.0e-11_dp !! pivot over the largest one

contains

  !> Finds the first body that the constraints do not hold: elements with points that hang together
  !! by nodes. Its free modes are named in words.
  pure subroutine find_free_modes(modes, element, mesh, points, constraint, frames)
    character(:), allocatable, intent(out) :: modes  !! "translation in y", empty if all is held
    integer, intent(out) :: element                  !! an element of that body, 0 if all is held
    type(mesh_t), intent(in) :: mesh                 !! initial mesh
    type(points_t), intent(in) :: points             !! initial points
    type(constraint_t), intent(in) :: constraint(:)  !! in force in the step
    type(nodal_frames_t), intent(in) :: frames       !! axes of the nodes
    integer, allocatable :: body(:)
    logical, allocatable :: fixed(:, :), seen(:)
    integer :: e

    modes = ""
    element = 0
    allocate (seen(mesh%n_node), source=.false.)
    fixed = held_directions(mesh, constraint)
    call label_bodies(body, mesh, points)
    do e = 1, mesh%n_el
      if (points%first(e + 1) == points%first(e)) cycle
      if (seen(body(mesh%node(1, e)))) cycle
      seen(body(mesh%node(1, e))) = .true.
      modes = free_modes(mesh, fixed, frames, body == body(mesh%node(1, e)))
      if (len(modes) == 0) cycle
      element = e
      return
    end do
  end subroutine find_free_modes

  !> Directions of nodes that some constraint prescribes.
  pure function held_directions(mesh, constraint) result(fixed)
    type(mesh_t), intent(in) :: mesh               !! for its sizes
    type(constraint_t), intent(in) :: constraint(:)  !! in force in the step
    logical :: fixed(mesh%n_dim, mesh%n_node)
    integer :: i

    fixed = .false.
    do i = 1, size(constraint)
      fixed(constraint(i)%direction, constraint(i)%node) = .true.
    end do
  end function held_directions

  !> Data lines of *BOUNDARY that would hold a body which is free, with node sets of the mesh:
  !! "X0, 1, 1 and Y0, 2, 2". Each line takes away as many free modes as a line can; of equal ones
  !! it is one of a plane that it fixes along its normal. Empty if the sets cannot hold the body.
  pure function suggest_support(element, mesh, points, constraint, frames) result(advice)
    integer, intent(in) :: element                   !! of the body
    type(mesh_t), intent(in) :: mesh                 !! where it is
    type(points_t), intent(in) :: points             !! in this mesh
    type(constraint_t), intent(in) :: constraint(:)  !! in force in the step
    type(nodal_frames_t), intent(in) :: frames       !! axes of the nodes
    character(:), allocatable :: advice
    integer, allocatable :: body(:)
    logical :: fixed(mesh%n_dim, mesh%n_node), member(mesh%n_node)
    integer :: direction, set

    call label_bodies(body, mesh, points)
    member = body == body(mesh%node(1, element))
    fixed = held_directions(mesh, constraint)
    advice = ""
    do while (len(free_modes(mesh, fixed, frames, member)) > 0)
      call best_support(set, direction, mesh, fixed, frames, member)
      if (set == 0) then
        advice = ""
        return
      end if
      fixed(direction, mesh%node_set(set)%item) = .true.
      if (len(advice) > 0) advice = advice//" and "
      advice = advice//mesh%node_set(set)%name//", "//integer_text(direction)//", "// &
               integer_text(direction)
    end do
  end function suggest_support

  !> The node set and the direction that take most free modes from a body.
  pure subroutine best_support(set, direction, mesh, fixed, frames, member)
    integer, intent(out) :: set        !! 0: none takes any
    integer, intent(out) :: direction  !! 1..n_dim
    type(mesh_t), intent(in) :: mesh   !! with node sets
    logical, intent(in) :: fixed(:, :) !! (n_dim, n_node) prescribed
    type(nodal_frames_t), intent(in) :: frames !! axes of the nodes
    logical, intent(in) :: member(:)   !! (n_node) belongs to the body
    logical :: trial(size(fixed, 1), size(fixed, 2))
    integer :: best, d, i, n_before, worth

    set = 0
    direction = 0
    best = 1
    if (.not. allocated(mesh%node_set)) return
    n_before = rank_of(held_modes(mesh, fixed, frames, member))
    do i = 1, size(mesh%node_set)
      associate (node => mesh%node_set(i)%item)
        do d = 1, mesh%n_dim
          trial = fixed
          trial(d, node) = .true.
          worth = 2*(rank_of(held_modes(mesh, trial, frames, member)) - n_before)
          if (worth == 0) cycle
          if (is_flat(mesh%x(d, node))) worth = worth + 1
          if (worth <= best) cycle
          best = worth
          set = i
          direction = d
        end do
      end associate
    end do
  end subroutine best_support

  !> Whether coordinates are all the same.
  pure logical function is_flat(x) result(flat)
    real(dp), intent(in) :: x(:) !! of nodes [length]

    flat = maxval(x) - minval(x) <= 1.0e-9_dp*maxval(abs(x))
  end function is_flat

  !> Finds a part of a body that hangs by nodes which do not hold it: parts are elements with points
  !! that hang together by faces. The rest of the body is taken to stand still.
  pure subroutine find_hinge(modes, element, node, mesh, points, constraint, frames)
    character(:), allocatable, intent(out) :: modes  !! "rotation about z", empty without a hinge
    integer, intent(out) :: element                  !! an element of that part, 0 without a hinge
    integer, intent(out) :: node                     !! a node by which it hangs, 0 without a hinge
    type(mesh_t), intent(in) :: mesh                 !! where it is, with neighbours
    type(points_t), intent(in) :: points             !! in this mesh
    type(constraint_t), intent(in) :: constraint(:)  !! in force in the step
    type(nodal_frames_t), intent(in) :: frames       !! axes of the nodes
    integer, allocatable :: part(:)
    logical, allocatable :: fixed(:, :), shared(:), member(:)
    integer :: i

    modes = ""
    element = 0
    node = 0
    call label_parts(part, mesh, points)
    shared = are_shared(mesh, part)
    fixed = held_directions(mesh, constraint) .or. spread(shared, 1, mesh%n_dim)
    do i = 1, maxval([0, part])
      member = are_of_part(mesh, part, i)
      if (.not. any(member .and. shared)) cycle
      modes = free_modes(mesh, fixed, frames, member)
      if (len(modes) == 0) cycle
      element = findloc(part, i, dim=1)
      node = findloc(member .and. shared, .true., dim=1)
      return
    end do
  end subroutine find_hinge

  !> Nodes of elements of more than one part.
  pure function are_shared(mesh, part) result(shared)
    type(mesh_t), intent(in) :: mesh !! connectivity
    integer, intent(in) :: part(:)   !! (n_el) 0 without points
    logical :: shared(mesh%n_node)
    integer :: part_of_node(mesh%n_node)
    integer :: e

    shared = .false.
    part_of_node = 0
    do e = 1, mesh%n_el
      if (part(e) == 0) cycle
      associate (node => mesh%node(:, e))
        shared(node) = shared(node) .or. &
                       (part_of_node(node) > 0 .and. part_of_node(node) /= part(e))
        part_of_node(node) = part(e)
      end associate
    end do
  end function are_shared

  !> Nodes of the elements of a part.
  pure function are_of_part(mesh, part, i) result(member)
    type(mesh_t), intent(in) :: mesh !! connectivity
    integer, intent(in) :: part(:)   !! (n_el) 0 without points
    integer, intent(in) :: i         !! the part
    logical :: member(mesh%n_node)
    integer :: e

    member = .false.
    do e = 1, mesh%n_el
      if (part(e) == i) member(mesh%node(:, e)) = .true.
    end do
  end function are_of_part

  !> Numbers the parts of elements with points that hang together by faces.
  pure subroutine label_parts(part, mesh, points)
    integer, allocatable, intent(out) :: part(:) !! (n_el) 0 without points
    type(mesh_t), intent(in) :: mesh             !! with neighbours
    type(points_t), intent(in) :: points         !! in this mesh
    integer :: queue(mesh%n_el)
    integer :: e, i, k, n, next, n_parts

    allocate (part(mesh%n_el), source=0)
    n_parts = 0
    do e = 1, mesh%n_el
      if (part(e) > 0 .or. points%first(e + 1) == points%first(e)) cycle
      n_parts = n_parts + 1
      part(e) = n_parts
      queue(1) = e
      n = 1
      i = 0
      do while (i < n)
        i = i + 1
        do k = 1, mesh%n_dim + 1
          next = mesh%neighbour(k, queue(i))
          if (next == 0) cycle
          if (part(next) > 0 .or. points%first(next + 1) == points%first(next)) cycle
          part(next) = n_parts
          n = n + 1
          queue(n) = next
        end do
      end do
    end do
  end subroutine label_parts

  !> The body of each node, called by its lowest node; 0 for nodes without material.
  pure subroutine label_bodies(body, mesh, points)
    integer, allocatable, intent(out) :: body(:) !! (n_node)
    type(mesh_t), intent(in) :: mesh             !! initial mesh
    type(points_t), intent(in) :: points         !! initial points
    integer :: a, e, i

    allocate (body(mesh%n_node), source=0)
    do e = 1, mesh%n_el
      if (points%first(e + 1) == points%first(e)) cycle
      do i = 1, mesh%n_dim + 1
        a = mesh%node(i, e)
        if (body(a) == 0) body(a) = a
      end do
      do i = 2, mesh%n_dim + 1
        call join(body, mesh%node(1, e), mesh%node(i, e))
      end do
    end do
    do a = 1, mesh%n_node
      if (body(a) > 0) body(a) = root(body, a)
    end do
  end subroutine label_bodies

  !> Joins the bodies of two nodes; the lower root wins.
  pure subroutine join(body, a, b)
    integer, intent(inout) :: body(:) !! (n_node) parents of a forest
    integer, intent(in) :: a, b       !! nodes
    integer :: root_a, root_b, next, i

    root_a = root(body, a)
    root_b = root(body, b)
    body(max(root_a, root_b)) = min(root_a, root_b)
    i = b
    do while (body(i) /= i)
      next = body(i)
      body(i) = min(root_a, root_b)
      i = next
    end do
  end subroutine join

  !> Root of a node in the forest.
  pure integer function root(body, a) result(top)
    integer, intent(in) :: body(:) !! (n_node) parents
    integer, intent(in) :: a       !! node

    top = a
    do while (body(top) /= top)
      top = body(top)
    end do
  end function root

  !> Names of the rigid-body modes of a body that no constraint resists.
  pure function free_modes(mesh, fixed, frames, member) result(modes)
    type(mesh_t), intent(in) :: mesh   !! initial mesh
    logical, intent(in) :: fixed(:, :) !! (n_dim, n_node) prescribed
    type(nodal_frames_t), intent(in) :: frames !! axes of the nodes
    logical, intent(in) :: member(:)   !! (n_node) belongs to the body
    character(:), allocatable :: modes !! separated by commas, empty if none is free
    character(16), parameter :: name(6) = ["translation in x", "translation in y", &
      "translation in z", "rotation about x", "rotation about y", "rotation about z"]
    real(dp) :: gram(6, 6)
    integer :: i, n_rank

    modes = ""
    gram = held_modes(mesh, fixed, frames, member)
    if (mesh%n_dim == 2) then
      do i = 3, 5
        gram(i, i) = 1.0_dp
      end do
    end if
    n_rank = rank_of(gram)
    do i = 6, 1, -1
      if (n_rank == 6) exit
      gram(i, i) = gram(i, i) + 1.0_dp
      if (rank_of(gram) > n_rank) then
        n_rank = n_rank + 1
        if (len(modes) > 0) modes = ", "//modes
        modes = name(i)//modes
      else
        gram(i, i) = gram(i, i) - 1.0_dp
      end if
    end do
  end function free_modes

  !> Sum over the prescribed degrees of freedom of r r^T, with r the displacement of that degree of
  !! freedom in the six rigid modes (rotations about the middle of the body, scaled by its size).
  pure function held_modes(mesh, fixed, frames, member) result(gram)
    type(mesh_t), intent(in) :: mesh   !! initial mesh
    logical, intent(in) :: fixed(:, :) !! (n_dim, n_node) prescribed
    type(nodal_frames_t), intent(in) :: frames !! axes of the nodes
    logical, intent(in) :: member(:)   !! (n_node) belongs to the body
    real(dp) :: gram(6, 6)             !! (6, 6) translations, then rotations; largest entry 1
    real(dp) :: low(3), high(3), x(3), r(6), extent
    real(dp) :: direction(3), axis(mesh%n_dim)
    integer :: a, i

    low = 0.0_dp
    high = 0.0_dp
    do i = 1, mesh%n_dim
      low(i) = minval(mesh%x(i, :), mask=member)
      high(i) = maxval(mesh%x(i, :), mask=member)
    end do
    extent = maxval(high - low)
    gram = 0.0_dp
    do a = 1, mesh%n_node
      if (.not. member(a)) cycle
      x = 0.0_dp
      x(:mesh%n_dim) = mesh%x(:, a)
      x = (x - 0.5_dp*(low + high))/extent
      do i = 1, mesh%n_dim
        if (.not. fixed(i, a)) cycle
        axis = 0.0_dp
        axis(i) = 1.0_dp
        direction = 0.0_dp
        direction(:mesh%n_dim) = in_global_axes(frames, a, axis)
        r(1:3) = direction
        r(4:6) = cross_product(x, direction)
        gram = gram + spread(r, 2, 6)*spread(r, 1, 6)
      end do
    end do
    if (maxval(abs(gram)) > 0.0_dp) gram = gram/maxval(abs(gram))
  end function held_modes

  !> Rank of a positive semidefinite matrix by elimination with the largest diagonal as pivot.
  pure integer function rank_of(matrix) result(n_rank)
    real(dp), intent(in) :: matrix(6, 6) !! (6, 6)
    real(dp) :: a(6, 6), largest
    integer :: k

    a = matrix
    largest = maxval([(a(k, k), k=1, 6)])
    n_rank = 0
    do
      k = maxloc([(a(k, k), k=1, 6)], dim=1)
      if (a(k, k) <= rank_tolerance*largest .or. n_rank == 6) exit
      n_rank = n_rank + 1
      a = a - spread(a(:, k), 2, 6)*spread(a(k, :), 1, 6)/a(k, k)
      a(:, k) = 0.0_dp
      a(k, :) = 0.0_dp
    end do
  end function rank_of

end module mpm_support_check
