!> The assembled tangent against central differences of the internal force.
!!
!! The tangent is a sum over patches and pairs of the ghost penalty. Torn apart, so that each of
!! these blocks has nodes of its own, they do not feel each other: one evaluation differentiates a
!! column of all of them at once.
module mpm_tangent_check
  use mpm_assembly, only: assemble_tangent
  use mpm_csc_matrix, only: add_block, csc_matrix_t, zero_values
  use mpm_dof_map, only: add_solution
  use mpm_ghost_penalty, only: add_ghost_tangent
  use mpm_kinds, only: dp
  use mpm_material, only: law_von_mises
  use mpm_nodal_frames, only: in_global_axes, in_local_axes, nodal_frames_t
  use mpm_system, only: body_t, evaluate, evaluation_ok, open_system, system_t
  implicit none
  private
  public :: tangent_report_t, check_tangent, compare_tangents

  !> What the comparison found.
  type :: tangent_report_t
    logical  :: evaluated = .false.   !! .false.: the random state could not be evaluated
    real(dp) :: amplitude = 0.0_dp    !! largest random displacement over element size [-]
    real(dp) :: error = 0.0_dp        !! largest difference over the largest entry [-]
    integer  :: row = 0, column = 0   !! equations of the largest difference
    integer  :: n_columns = 0         !! columns compared
    integer  :: n_skipped = 0         !! columns left out: a point crossed the yield surface
    integer  :: n_plastic = 0         !! points that flow in the state
  end type tangent_report_t

  real(dp), parameter :: step_ratio = 1.0e-5_dp !! difference step over the largest random displacement

contains

  !> Compares at a random displacement of the unknowns that brings many points to yield.
  !! Source: theory.md (13), (14), (18).
  subroutine check_tangent(report, system, body)
    type(tangent_report_t), intent(out) :: report
    type(system_t), intent(inout) :: system !! dofs and pattern are set; u is overwritten
    type(body_t), intent(in)      :: body
    type(csc_matrix_t) :: difference
    logical, allocatable :: skipped(:)
    real(dp) :: largest
    integer :: outcome

    report%amplitude = random_amplitude(body)
    largest = report%amplitude*smallest_size(body, system%element)
    system%u = 0.0_dp
    call add_solution(system%dofs, largest*noise(system%dofs%n), system%u)
    call evaluate(system, body, outcome)
    report%evaluated = outcome == evaluation_ok
    if (.not. report%evaluated) return
    report%n_plastic = system%sums%n_plastic
    call assemble_tangent(system%tangent, system%map, body%mesh, body%patches, system%kinematics, system%sums)
    call add_ghost_tangent(system%tangent, system%map, system%ghost)
    difference = system%tangent
    call difference_tangent(difference, skipped, system, body, step_ratio*largest)
    call compare_tangents(report, system%tangent, difference, skipped)
  end subroutine check_tangent

  !> Six times the smallest yield strain, or 1e-3 without plasticity.
  pure function random_amplitude(body) result(amplitude)
    type(body_t), intent(in) :: body
    real(dp) :: amplitude !! [-]
    integer :: m

    amplitude = huge(1.0_dp)
    do m = 1, size(body%material)
      if (body%material(m)%law /= law_von_mises) cycle
      amplitude = min(amplitude, 6.0_dp*body%material(m)%yield_stress(1)/body%material(m)%young)
    end do
    if (amplitude > 1.0_dp) amplitude = 1.0e-3_dp
    amplitude = min(max(amplitude, 1.0e-7_dp), 0.05_dp)
  end function random_amplitude

  !> Size of the smallest active element.
  pure function smallest_size(body, element) result(h)
    type(body_t), intent(in) :: body
    integer, intent(in) :: element(:) !! active elements
    real(dp) :: h                     !! [length]

    h = minval(body%mesh%volume(element))**(1.0_dp/real(body%mesh%n_dim, dp))
  end function smallest_size

  !> Numbers in -1..1 that are the same in every run: Weyl's sequence of the golden ratio.
  pure function noise(n) result(value)
    integer, intent(in) :: n
    real(dp) :: value(n)
    real(dp), parameter :: golden = 0.6180339887498949_dp
    integer :: i

    do i = 1, n
      value(i) = 2.0_dp*modulo(real(i, dp)*golden + real(i, dp)**2*0.7548776662466927_dp, 1.0_dp) - 1.0_dp
    end do
  end function noise

  !> Central differences of all blocks into a matrix, entry by entry through its own search.
  subroutine difference_tangent(difference, skipped, system, body, delta)
    type(csc_matrix_t), intent(inout) :: difference !! pattern of the tangent
    logical, allocatable, intent(out) :: skipped(:) !! (n)  columns that cannot be compared
    type(system_t), intent(in) :: system
    type(body_t), intent(in)   :: body
    real(dp), intent(in)       :: delta             !! [length]
    type(body_t)   :: torn
    type(system_t) :: torn_system
    real(dp), allocatable :: block(:, :), column(:, :)
    integer, allocatable :: equation(:)
    logical, allocatable :: crossed(:, :)
    integer :: number, first, last, n_columns, k

    call tear(torn, torn_system, system, body)
    n_columns = body%mesh%n_dim*maxval(system%map%node_first(2:) &
                                       - system%map%node_first(:system%map%n_block))
    allocate (column(size(torn_system%u), n_columns))
    allocate (crossed(system%map%n_block, n_columns))
    do k = 1, n_columns
      call difference_column(column(:, k), crossed(:, k), k, delta, torn, torn_system, system)
    end do
    call zero_values(difference)
    allocate (skipped(difference%n), source=.false.)
    do number = 1, system%map%n_block
      first = system%map%node_first(number)
      last = system%map%node_first(number + 1) - 1
      if (last < first) cycle
      equation = reshape(system%dofs%id(:, system%map%node(first:last)), [body%mesh%n_dim*(last - first + 1)])
      block = column((first - 1)*body%mesh%n_dim + 1:last*body%mesh%n_dim, :size(equation))
      call add_block(difference, equation, block)
      do k = 1, size(equation)
        if (crossed(number, k) .and. equation(k) > 0) skipped(equation(k)) = .true.
      end do
    end do
  end subroutine difference_tangent

  !> A copy of the body in which every patch and every pair of the penalty has its own nodes.
  subroutine tear(torn, torn_system, system, body)
    type(body_t), intent(out)   :: torn
    type(system_t), intent(out) :: torn_system !! at the displacement of system
    type(system_t), intent(in)  :: system
    type(body_t), intent(in)    :: body
    integer :: a, e

    torn = body
    torn%mesh%n_node = size(system%map%node)
    torn%mesh%x = body%mesh%x(:, system%map%node)
    do e = 1, body%mesh%n_el
      torn%mesh%node(:, e) = max(1, system%map%node_first(body%patches%of_element(e)) - 1 &
                                 + system%map%element_local(:, e))
    end do
    call open_system(torn_system, torn)
    torn_system%ghost = system%ghost
    associate (first => system%map%node_first(system%map%n_patch + 1))
      torn_system%ghost%node%item = [(a, a=first, size(system%map%node))]
    end associate
    torn_system%active = system%active
    torn_system%element = system%element
    torn_system%u = system%u(:, system%map%node)
    torn_system%dofs%frames = system%dofs%frames
    if (allocated(system%dofs%frames%of_node)) then
      torn_system%dofs%frames%of_node = system%dofs%frames%of_node(system%map%node)
    end if
  end subroutine tear

  !> Derivative of the forces of every block with respect to its local displacement k,
  !! both along the axes of the nodes.
  subroutine difference_column(column, crossed, k, delta, torn, torn_system, system)
    real(dp), intent(out) :: column(:)  !! (n_dim times torn nodes)
    logical, intent(out)  :: crossed(:) !! (n_block)  a point began or ceased to flow
    integer, intent(in)   :: k          !! local displacement of all blocks
    real(dp), intent(in)  :: delta      !! [length]
    type(body_t), intent(in)      :: torn
    type(system_t), intent(inout) :: torn_system
    type(system_t), intent(in)    :: system
    real(dp), allocatable :: u(:, :), f_plus(:, :), slope(:, :)
    integer, allocatable :: plastic(:), e_patch(:)
    integer :: a, i, outcome

    u = torn_system%u
    e_patch = torn%patches%of_element(system%element)
    call shift(torn_system%u, torn_system%dofs%frames, system%map%node_first, k, delta)
    call evaluate(torn_system, torn, outcome)
    f_plus = torn_system%f_int
    plastic = torn_system%sums%plastic_in
    torn_system%u = u
    call shift(torn_system%u, torn_system%dofs%frames, system%map%node_first, k, -delta)
    call evaluate(torn_system, torn, outcome)
    slope = (f_plus - torn_system%f_int)/(2.0_dp*delta)
    do a = 1, size(slope, 2)
      slope(:, a) = in_local_axes(torn_system%dofs%frames, a, slope(:, a))
    end do
    column = reshape(slope, [size(column)])
    crossed = .false.
    do i = 1, size(e_patch)
      associate (e => system%element(i))
        if (plastic(e) /= system%sums%plastic_in(e) .or. torn_system%sums%plastic_in(e) &
            /= system%sums%plastic_in(e)) crossed(e_patch(i)) = .true.
      end associate
    end do
    torn_system%u = u
  end subroutine difference_column

  !> Moves local displacement k of every block that has one.
  pure subroutine shift(u, frames, node_first, k, delta)
    real(dp), intent(inout) :: u(:, :)       !! (n_dim, torn nodes)
    type(nodal_frames_t), intent(in) :: frames !! axes of the torn nodes
    integer, intent(in)     :: node_first(:) !! (n_block+1)
    integer, intent(in)     :: k             !! local displacement
    real(dp), intent(in)    :: delta         !! [length]
    real(dp) :: local(size(u, 1))
    integer :: number, a

    a = (k - 1)/size(u, 1)
    local = 0.0_dp
    local(k - a*size(u, 1)) = delta
    do number = 1, size(node_first) - 1
      associate (node => node_first(number) + a)
        if (node >= node_first(number + 1)) cycle
        u(:, node) = u(:, node) + in_global_axes(frames, node, local)
      end associate
    end do
  end subroutine shift

  !> Largest difference over the largest entry of the tangent, in the columns that count.
  pure subroutine compare_tangents(report, tangent, difference, skipped)
    type(tangent_report_t), intent(inout) :: report
    type(csc_matrix_t), intent(in) :: tangent, difference
    logical, intent(in) :: skipped(:) !! (n)
    real(dp) :: largest, here
    integer :: j, k

    report%n_skipped = count(skipped)
    report%n_columns = tangent%n - report%n_skipped
    if (tangent%n == 0) return
    largest = maxval(abs(tangent%val))
    report%error = -1.0_dp
    do j = 1, int(tangent%n)
      if (skipped(j)) cycle
      do k = int(tangent%col_ptr(j - 1)), int(tangent%col_ptr(j)) - 1
        here = abs(tangent%val(k) - difference%val(k))/largest
        if (here <= report%error) cycle
        report%error = here
        report%row = int(tangent%row(k)) + 1
        report%column = j
      end do
    end do
  end subroutine compare_tangents

end module mpm_tangent_check
