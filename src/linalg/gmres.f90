!> GMRES with restarts, preconditioned from the right by the factors of a similar matrix.
!! Source: theory.md (15f).
module mpm_gmres
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_csc_matrix, only: csc_matrix_t, equal_columns, multiply_by_groups
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: linear_solver_t, solve, solver_ok
  implicit none
  private
  public :: gmres_t, open_gmres, solve_by_gmres
  public :: gmres_converged, gmres_failed, gmres_limit, gmres_stagnated

  integer, parameter :: gmres_converged = 0 !! the residual is at its goal
  integer, parameter :: gmres_limit = 1     !! no more iterations are allowed
  integer, parameter :: gmres_stagnated = 2 !! between two restarts the residual fell too little
  integer, parameter :: gmres_failed = 3    !! a number is not finite, or the matrix is singular

  real(dp), parameter :: least_pivot = 1.0e-14_dp !! of the triangle over its column [-]
  real(dp), parameter :: least_fall = 0.5_dp !! of the residual between two restarts [-]

  !> Work space, and what the last solution took.
  type :: gmres_t
    integer :: n = 0                         !! equations
    integer :: n_largest = 0                 !! directions between two restarts
    integer, allocatable  :: first(:)        !! (n_group+1)  see equal_columns
    real(dp), allocatable :: basis(:, :)     !! (n, n_largest+1)  orthonormal directions
    real(dp), allocatable :: direction(:, :) !! (n, n_largest)  the same, preconditioned
    real(dp), allocatable :: triangle(:, :)  !! (n_largest+1, n_largest)  least squares, reduced
    real(dp), allocatable :: turn(:, :)      !! (2, n_largest)  cosine and sine of each rotation
    real(dp), allocatable :: target(:)       !! (n_largest+1)  right-hand side of least squares
    integer  :: n_iterations = 0             !! products with the preconditioner
    real(dp) :: residual = 0.0_dp            !! norm at the end [as the right-hand side]
  end type gmres_t

contains

  !> Makes room for systems with a pattern.
  pure subroutine open_gmres(gmres, matrix, n_largest)
    type(gmres_t), intent(out) :: gmres  !! with work space
    type(csc_matrix_t), intent(in) :: matrix !! pattern
    integer, intent(in) :: n_largest     !! directions between two restarts, at least 1
    integer :: n

    n = matrix%n
    gmres%n = n
    gmres%first = equal_columns(matrix)
    gmres%n_largest = n_largest
    ! Without values: memory that no direction needs is not touched.
    allocate (gmres%basis(n, n_largest + 1), gmres%direction(n, n_largest))
    allocate (gmres%triangle(n_largest + 1, n_largest), source=0.0_dp)
    allocate (gmres%turn(2, n_largest), source=0.0_dp)
    allocate (gmres%target(n_largest + 1), source=0.0_dp)
  end subroutine open_gmres

  !> Solves A x = rhs until the norm of the residual is at its goal. Without success x is the best
  !! so far, or has no meaning when the outcome is gmres_failed.
  subroutine solve_by_gmres(gmres, x, solver, matrix, rhs, goal, outcome)
    type(gmres_t), intent(inout) :: gmres          !! open; n_iterations is in their limit, out
                                                   !! their number
    real(dp), intent(out) :: x(:)                  !! (n)  solution
    type(linear_solver_t), intent(inout) :: solver !! factors of a matrix like A
    type(csc_matrix_t), intent(in) :: matrix       !! A
    real(dp), intent(in) :: rhs(:)                 !! (n)
    real(dp), intent(in) :: goal                   !! norm of the residual [as rhs]
    integer, intent(out) :: outcome                !! gmres_*
    integer  :: limit
    real(dp) :: before

    limit = gmres%n_iterations
    gmres%n_iterations = 0
    x = 0.0_dp
    outcome = gmres_failed
    if (.not. all(ieee_is_finite(rhs))) return
    gmres%basis(:, 1) = rhs
    gmres%residual = norm2(rhs)
    do
      before = gmres%residual
      call run_cycle(gmres, x, solver, matrix, goal, limit, outcome)
      if (outcome /= gmres_limit .or. gmres%n_iterations >= limit) return
      ! The residual itself: that of the least squares may have drifted.
      call multiply_by_groups(matrix, gmres%first, x, gmres%basis(:, 1))
      gmres%basis(:, 1) = rhs - gmres%basis(:, 1)
      gmres%residual = norm2(gmres%basis(:, 1))
      if (gmres%residual > least_fall*before) then
        outcome = gmres_stagnated
        return
      end if
    end do
  end subroutine solve_by_gmres

  !> Directions until the goal, the limit or the next restart. The first column of the basis holds
  !! the residual.
  subroutine run_cycle(gmres, x, solver, matrix, goal, limit, outcome)
    type(gmres_t), intent(inout) :: gmres          !! residual in its basis
    real(dp), intent(inout) :: x(:)                !! (n)  solution so far, improved
    type(linear_solver_t), intent(inout) :: solver !! factors of a matrix like A
    type(csc_matrix_t), intent(in) :: matrix       !! A
    real(dp), intent(in) :: goal                   !! norm of the residual
    integer, intent(in)  :: limit                  !! iterations in all
    integer, intent(out) :: outcome                !! gmres_limit also means: time to restart
    integer :: k
    logical :: is_good

    outcome = gmres_failed
    if (.not. ieee_is_finite(gmres%residual)) return
    outcome = gmres_converged
    if (gmres%residual <= goal) return
    outcome = gmres_failed
    gmres%basis(:, 1) = gmres%basis(:, 1)/gmres%residual
    gmres%target = 0.0_dp
    gmres%target(1) = gmres%residual
    do k = 1, gmres%n_largest
      call take_direction(gmres, is_good, solver, matrix, k)
      if (.not. is_good) return
      if (gmres%residual <= goal .or. gmres%n_iterations >= limit) exit
    end do
    call add_directions(gmres, x, min(k, gmres%n_largest))
    outcome = merge(gmres_converged, gmres_limit, gmres%residual <= goal)
  end subroutine run_cycle

  !> A new direction and the residual with it.
  subroutine take_direction(gmres, is_good, solver, matrix, k)
    type(gmres_t), intent(inout) :: gmres          !! column k of the basis is the last one
    logical, intent(out) :: is_good                !! .false.: not finite, or A is singular
    type(linear_solver_t), intent(inout) :: solver !! factors of a matrix like A
    type(csc_matrix_t), intent(in) :: matrix       !! A
    integer, intent(in) :: k                       !! number of the iteration in the cycle
    integer :: solved

    call solve(solver, matrix, gmres%basis(:, k), gmres%direction(:, k), solved)
    is_good = solved == solver_ok
    if (.not. is_good) return
    call multiply_by_groups(matrix, gmres%first, gmres%direction(:, k), gmres%basis(:, k + 1))
    gmres%n_iterations = gmres%n_iterations + 1
    call make_orthonormal(gmres, k)
    call turn_column(gmres, k)
    gmres%residual = abs(gmres%target(k + 1))
    is_good = gmres%triangle(k, k) > least_pivot*norm2(gmres%triangle(:k, k)) &
              .and. ieee_is_finite(gmres%residual)
  end subroutine take_direction

  !> Makes a new direction orthogonal to those before, by modified Gram-Schmidt, and of unit length.
  !! A direction that depends on them ends the cycle with the solution.
  pure subroutine make_orthonormal(gmres, k)
    type(gmres_t), intent(inout) :: gmres !! column k+1 of the basis and column k of the triangle
    integer, intent(in) :: k              !! number of the iteration in the cycle
    real(dp) :: length
    integer :: i

    do i = 1, k
      gmres%triangle(i, k) = dot_product(gmres%basis(:, i), gmres%basis(:, k + 1))
      gmres%basis(:, k + 1) = gmres%basis(:, k + 1) - gmres%triangle(i, k)*gmres%basis(:, i)
    end do
    length = norm2(gmres%basis(:, k + 1))
    gmres%triangle(k + 1, k) = length
    if (length > epsilon(length)*maxval(abs(gmres%triangle(:k, k)))) then
      gmres%basis(:, k + 1) = gmres%basis(:, k + 1)/length
    else
      gmres%triangle(k + 1, k) = 0.0_dp
    end if
  end subroutine make_orthonormal

  !> Turns the new column of the least squares into one of a triangle.
  pure subroutine turn_column(gmres, k)
    type(gmres_t), intent(inout) :: gmres !! column k of the triangle, rotation k, target
    integer, intent(in) :: k              !! number of the iteration in the cycle
    real(dp) :: length
    integer :: i

    associate (column => gmres%triangle(:, k), turn => gmres%turn)
      do i = 1, k - 1
        column(i:i + 1) = turned(column(i:i + 1), turn(:, i))
      end do
      length = norm2(column(k:k + 1))
      turn(:, k) = [1.0_dp, 0.0_dp]
      if (length > 0.0_dp) turn(:, k) = column(k:k + 1)/length
      column(k:k + 1) = [length, 0.0_dp]
    end associate
    gmres%target(k:k + 1) = turned([gmres%target(k), 0.0_dp], gmres%turn(:, k))
  end subroutine turn_column

  !> A pair of components after a rotation.
  pure function turned(pair, turn) result(image)
    real(dp), intent(in) :: pair(2) !! components
    real(dp), intent(in) :: turn(2) !! cosine and sine
    real(dp) :: image(2)

    image = [turn(1)*pair(1) + turn(2)*pair(2), turn(1)*pair(2) - turn(2)*pair(1)]
  end function turned

  !> Adds the best combination of the directions of a cycle.
  pure subroutine add_directions(gmres, x, n)
    type(gmres_t), intent(inout) :: gmres !! target is used up
    real(dp), intent(inout) :: x(:)       !! (n)  solution
    integer, intent(in) :: n              !! directions
    integer :: k

    do k = n, 1, -1
      gmres%target(k) = gmres%target(k)/gmres%triangle(k, k)
      gmres%target(:k - 1) = gmres%target(:k - 1) - gmres%target(k)*gmres%triangle(:k - 1, k)
    end do
    do k = 1, n
      x = x + gmres%target(k)*gmres%direction(:, k)
    end do
  end subroutine add_directions

end module mpm_gmres
