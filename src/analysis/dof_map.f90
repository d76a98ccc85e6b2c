!> Equation numbers of active nodes and prescribed displacements.
module mpm_dof_map
  use mpm_amplitude, only: amplitude_t, step_fraction, time_increment_t
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_nodal_frames, only: in_global_axes, in_local_axes, nodal_frames_t
  implicit none
  private
  public :: constraint_t, dof_map_t
  public :: add_solution, gather_free, number_dofs, prescribed_total, start_where_nodes_stand
  public :: turn_prescribed

  !> A prescribed displacement of a step: one direction, the nodes of one set. The
  !! direction is one of the axes of each node.
  type :: constraint_t
    integer, allocatable :: node(:) !! nodes
    integer  :: direction = 0       !! 1..n_dim, along the axes of the node
    real(dp) :: value = 0.0_dp      !! total displacement at the end of the step [length]
    real(dp) :: start = 0.0_dp      !! total displacement at the start of the step [length]
    logical  :: was_free = .false.  !! .true.: the step before left the nodes free; from holds
    real(dp), allocatable :: from(:) !! (n)  in place of start, node by node [length]
    integer  :: amplitude = 0       !! index of the amplitude, 0 = linear ramp over the step
    integer  :: card = 0            !! index of the card in the deck
    integer  :: line = 0            !! data line of that card
  end type constraint_t

  !> Numbering of the unknowns of an increment.
  type :: dof_map_t
    integer :: n = 0                          !! unknowns
    integer, allocatable  :: id(:, :)         !! (n_dim, n_node)  equation of a direction of the
                                              !! axes of the node, 0 = fixed or inactive
    logical, allocatable  :: fixed(:, :)      !! (n_dim, n_node)  .true. = prescribed direction
    real(dp), allocatable :: prescribed(:, :) !! (n_dim, n_node)  in the increment, along the
                                              !! global axes [length]
    type(nodal_frames_t)  :: frames           !! axes of the nodes
    logical, allocatable  :: active(:)        !! (n_node)         belongs to an active element
  end type dof_map_t

contains

  !> Numbers the free displacements of active nodes, node by node, and sets the prescribed ones
  !! of the increment. Where constraints meet, the last one holds. All nodes have global axes;
  !! turn_prescribed gives some of them their own.
  pure subroutine number_dofs(dofs, mesh, active_element, constraints, increment, amplitudes)
    type(dof_map_t), intent(out) :: dofs               !! numbering
    type(mesh_t), intent(in) :: mesh                   !! connectivity
    logical, intent(in) :: active_element(:)           !! (n_el)  hosts a point
    type(constraint_t), intent(in) :: constraints(:)   !! in force in the step
    type(time_increment_t), intent(in) :: increment    !! place of the increment in the step
    type(amplitude_t), intent(in) :: amplitudes(:)     !! all amplitudes of the model
    integer :: i, a, e

    allocate (dofs%id(mesh%n_dim, mesh%n_node), source=0)
    allocate (dofs%active(mesh%n_node), source=.false.)
    do e = 1, mesh%n_el
      if (active_element(e)) dofs%active(mesh%node(:, e)) = .true.
    end do
    allocate (dofs%fixed(mesh%n_dim, mesh%n_node), source=.false.)
    allocate (dofs%prescribed(mesh%n_dim, mesh%n_node), source=0.0_dp)
    do i = 1, size(constraints)
      dofs%fixed(constraints(i)%direction, constraints(i)%node) = .true.
      dofs%prescribed(constraints(i)%direction, constraints(i)%node) = &
        prescribed_increment(constraints(i), increment, amplitudes)
    end do
    dofs%n = 0
    do a = 1, mesh%n_node
      if (.not. dofs%active(a)) cycle
      do i = 1, mesh%n_dim
        if (dofs%fixed(i, a)) cycle
        dofs%n = dofs%n + 1
        dofs%id(i, a) = dofs%n
      end do
    end do
  end subroutine number_dofs

  !> Gives nodes axes of their own: their equations, and what is prescribed, were meant along these.
  pure subroutine turn_prescribed(dofs, frames)
    type(dof_map_t), intent(inout)   :: dofs   !! as numbered
    type(nodal_frames_t), intent(in) :: frames !! axes of the nodes
    integer :: a

    dofs%frames = frames
    do a = 1, size(dofs%prescribed, 2)
      dofs%prescribed(:, a) = in_global_axes(frames, a, dofs%prescribed(:, a))
    end do
  end subroutine turn_prescribed

  !> Lets constraints of nodes that were free begin where these nodes stand.
  pure subroutine start_where_nodes_stand(constraints, frames, nodal)
    type(constraint_t), intent(inout) :: constraints(:) !! of a step that begins
    type(nodal_frames_t), intent(in) :: frames          !! axes of the nodes
    real(dp), intent(in) :: nodal(:, :)                 !! (n_dim, n_node)  total displacements
                                                        !! along the global axes [length]
    real(dp) :: local(size(nodal, 1))
    integer :: i, j

    do i = 1, size(constraints)
      if (.not. constraints(i)%was_free) cycle
      associate (node => constraints(i)%node)
        if (.not. allocated(constraints(i)%from)) allocate (constraints(i)%from(size(node)))
        do j = 1, size(node)
          local = in_local_axes(frames, node(j), nodal(:, node(j)))
          constraints(i)%from(j) = local(constraints(i)%direction)
        end do
      end associate
    end do
  end subroutine start_where_nodes_stand

  !> Total displacements of the nodes of a constraint at the start of the step.
  pure function totals_at_start(constraint) result(start)
    type(constraint_t), intent(in) :: constraint !! prescribed displacement
    real(dp) :: start(size(constraint%node))     !! (n) [length]

    start = constraint%start
    if (allocated(constraint%from)) start = constraint%from
  end function totals_at_start

  !> Total prescribed displacements at a step time: from the start to the value in a linear ramp,
  !! or value times amplitude.
  pure function prescribed_total(constraint, time, period, amplitudes) result(total)
    type(constraint_t), intent(in) :: constraint   !! prescribed displacement
    real(dp), intent(in) :: time                   !! step time
    real(dp), intent(in) :: period                 !! length of the step
    type(amplitude_t), intent(in) :: amplitudes(:) !! all amplitudes of the model
    real(dp) :: total(size(constraint%node))       !! (n) [length]
    real(dp) :: base(size(constraint%node))

    base = 0.0_dp
    if (constraint%amplitude == 0) base = totals_at_start(constraint)
    total = base + (constraint%value - base) &
            *step_fraction(constraint%amplitude, time, period, amplitudes)
  end function prescribed_total

  !> Prescribed displacements of an increment. The first one of a step departs from where the
  !! nodes stand, so that an amplitude which does not begin there takes effect.
  pure function prescribed_increment(constraint, increment, amplitudes) result(change)
    type(constraint_t), intent(in) :: constraint     !! prescribed displacement
    type(time_increment_t), intent(in) :: increment  !! place of the increment in the step
    type(amplitude_t), intent(in) :: amplitudes(:)   !! all amplitudes of the model
    real(dp) :: change(size(constraint%node))        !! (n) [length]
    real(dp) :: before(size(constraint%node))

    before = totals_at_start(constraint)
    if (increment%start > 0.0_dp) then
      before = prescribed_total(constraint, increment%start, increment%period, amplitudes)
    end if
    change = prescribed_total(constraint, increment%start + increment%size, increment%period, &
                              amplitudes) - before
  end function prescribed_increment

  !> Adds a vector of unknowns to a nodal array; prescribed and inactive directions stay.
  !! Source: theory.md (19).
  pure subroutine add_solution(dofs, x, nodal)
    type(dof_map_t), intent(in) :: dofs        !! numbering
    real(dp), intent(in)    :: x(:)            !! (n)
    real(dp), intent(inout) :: nodal(:, :)     !! (n_dim, n_node)  along the global axes
    real(dp) :: local(size(nodal, 1))
    integer :: i, a

    do a = 1, size(dofs%id, 2)
      if (all(dofs%id(:, a) == 0)) cycle
      local = 0.0_dp
      do i = 1, size(dofs%id, 1)
        if (dofs%id(i, a) > 0) local(i) = x(dofs%id(i, a))
      end do
      nodal(:, a) = nodal(:, a) + in_global_axes(dofs%frames, a, local)
    end do
  end subroutine add_solution

  !> Picks the entries of the unknowns out of a nodal array. Source: theory.md (19).
  pure subroutine gather_free(dofs, nodal, vector)
    type(dof_map_t), intent(in) :: dofs        !! numbering
    real(dp), intent(in)  :: nodal(:, :)       !! (n_dim, n_node)  along the global axes
    real(dp), intent(out) :: vector(:)         !! (n)
    real(dp) :: local(size(nodal, 1))
    integer :: i, a

    do a = 1, size(dofs%id, 2)
      if (all(dofs%id(:, a) == 0)) cycle
      local = in_local_axes(dofs%frames, a, nodal(:, a))
      do i = 1, size(dofs%id, 1)
        if (dofs%id(i, a) > 0) vector(dofs%id(i, a)) = local(i)
      end do
    end do
  end subroutine gather_free

end module mpm_dof_map
