!> Smallest and largest eigenvalue of the tangent: how well the increment is posed.
module mpm_eigenvalues
  use mpm_csc_matrix, only: csc_matrix_t, multiply
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: linear_solver_t, solve, solver_ok
  implicit none
  private
  public :: eigenvalues_t, find_eigenvalues

  integer, parameter  :: max_iterations = 1000   !! of each iteration
  real(dp), parameter :: tolerance = 1.0e-9_dp   !! relative change that ends it early
  real(dp), parameter :: largest_change = 1.0e-6_dp !! that is allowed in the end

  !> Eigenvalues of smallest and of largest magnitude, with their sign.
  type :: eigenvalues_t
    logical  :: asked = .false.     !! .true.: they were looked for
    logical  :: found = .false.     !! .false.: not asked for, or an iteration did not settle
    real(dp) :: smallest = 0.0_dp   !! [force/length]
    real(dp) :: largest = 0.0_dp    !! [force/length]
  end type eigenvalues_t

  !> An iteration for the eigenvalue of largest magnitude. Two vectors at a time: symmetry often
  !! makes the extreme eigenvalues almost equal.
  type :: iteration_t
    real(dp), allocatable :: x(:, :)   !! (n, 2)  orthonormal
    real(dp), allocatable :: y(:, :)   !! (n, 2)  matrix times x
    real(dp) :: eigenvalue = 0.0_dp    !! so far
    integer  :: n_steps = 0            !! taken
    logical  :: settled = .false.      !! the eigenvalue is real and stands
    logical  :: ended = .false.        !! no further step
  end type iteration_t

contains

  !> Inverse iteration with the factors, power iteration with the matrix. An unsymmetric matrix
  !! whose extreme eigenvalues are complex has no answer.
  subroutine find_eigenvalues(eigenvalues, solver, matrix)
    type(eigenvalues_t), intent(out) :: eigenvalues
    type(linear_solver_t), intent(inout) :: solver !! with the factors of the matrix
    type(csc_matrix_t), intent(in) :: matrix
    type(iteration_t) :: of_inverse, of_matrix

    eigenvalues%asked = .true.
    if (matrix%n == 0) return
    call iterate_inverse(of_inverse, solver, matrix)
    call iterate_matrix(of_matrix, matrix)
    eigenvalues%found = of_inverse%settled .and. of_matrix%settled &
                        .and. abs(of_inverse%eigenvalue) > 0.0_dp
    if (.not. eigenvalues%found) return
    eigenvalues%smallest = 1.0_dp/of_inverse%eigenvalue
    eigenvalues%largest = of_matrix%eigenvalue
  end subroutine find_eigenvalues

  !> Eigenvalue of largest magnitude of a matrix.
  pure subroutine iterate_matrix(iteration, matrix)
    type(iteration_t), intent(out) :: iteration !! ended
    type(csc_matrix_t), intent(in) :: matrix
    integer :: k

    call start(iteration, matrix%n)
    do while (.not. iteration%ended)
      do k = 1, 2
        call multiply(matrix, iteration%x(:, k), iteration%y(:, k))
      end do
      call step(iteration)
    end do
  end subroutine iterate_matrix

  !> Eigenvalue of largest magnitude of the inverse of a matrix; not settled if a solution fails.
  subroutine iterate_inverse(iteration, solver, matrix)
    type(iteration_t), intent(out) :: iteration    !! ended
    type(linear_solver_t), intent(inout) :: solver !! with the factors of the matrix
    type(csc_matrix_t), intent(in) :: matrix
    integer :: k, outcome

    call start(iteration, matrix%n)
    do while (.not. iteration%ended)
      do k = 1, 2
        call solve(solver, matrix, iteration%x(:, k), iteration%y(:, k), outcome)
        if (outcome == solver_ok) cycle
        iteration%settled = .false.
        return
      end do
      call step(iteration)
    end do
  end subroutine iterate_inverse

  !> Two vectors without symmetry.
  pure subroutine start(iteration, n)
    type(iteration_t), intent(inout) :: iteration !! before its first step
    integer, intent(in) :: n                      !! order of the matrix
    integer :: i

    iteration%x = reshape([(1.0_dp + 0.5_dp*sin(real(i, dp)**2), i=1, 2*n)], [n, 2])
    call make_orthonormal(iteration%x)
    allocate (iteration%y(n, 2))
  end subroutine start

  !> The eigenvalue from x and y, and the next x.
  pure subroutine step(iteration)
    type(iteration_t), intent(inout) :: iteration !! y is set
    real(dp) :: before, change
    logical  :: is_real

    before = iteration%eigenvalue
    call largest_of_two(iteration%eigenvalue, is_real, matmul(transpose(iteration%x), iteration%y))
    change = abs(iteration%eigenvalue - before)
    iteration%n_steps = iteration%n_steps + 1
    iteration%settled = is_real .and. change <= largest_change*abs(iteration%eigenvalue)
    iteration%ended = change <= tolerance*abs(iteration%eigenvalue) &
                      .or. iteration%n_steps == max_iterations
    iteration%x = iteration%y
    call make_orthonormal(iteration%x)
  end subroutine step

  !> Two vectors of unit length, normal to each other; zero where there is only one.
  pure subroutine make_orthonormal(x)
    real(dp), intent(inout) :: x(:, :) !! (n, 2)
    real(dp) :: length

    x(:, 1) = x(:, 1)/max(norm2(x(:, 1)), tiny(length))
    length = norm2(x(:, 2))
    x(:, 2) = x(:, 2) - dot_product(x(:, 1), x(:, 2))*x(:, 1)
    if (norm2(x(:, 2)) > epsilon(length)*length) then
      x(:, 2) = x(:, 2)/norm2(x(:, 2))
    else
      x(:, 2) = 0.0_dp
    end if
  end subroutine make_orthonormal

  !> Eigenvalue of larger magnitude of a 2x2 matrix; the real part of a complex pair.
  pure subroutine largest_of_two(eigenvalue, is_real, a)
    real(dp), intent(out) :: eigenvalue
    logical, intent(out)  :: is_real
    real(dp), intent(in)  :: a(2, 2)
    real(dp) :: middle, square

    middle = 0.5_dp*(a(1, 1) + a(2, 2))
    square = (0.5_dp*(a(1, 1) - a(2, 2)))**2 + a(1, 2)*a(2, 1)
    is_real = square >= -(1.0e-6_dp*middle)**2
    eigenvalue = middle + sign(sqrt(max(square, 0.0_dp)), middle)
  end subroutine largest_of_two

end module mpm_eigenvalues
