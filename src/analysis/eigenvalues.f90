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
    logical  :: found = .false.     !! .false.: not asked for, or an iteration did not settle
    real(dp) :: smallest = 0.0_dp   !! [force/length]
    real(dp) :: largest = 0.0_dp    !! [force/length]
  end type eigenvalues_t

contains

  !> Inverse iteration with the factors, power iteration with the matrix. An unsymmetric matrix
  !! whose extreme eigenvalues are complex has no answer.
  subroutine find_eigenvalues(eigenvalues, solver, matrix)
    type(eigenvalues_t), intent(out) :: eigenvalues
    type(linear_solver_t), intent(inout) :: solver !! with the factors of the matrix
    type(csc_matrix_t), intent(in) :: matrix
    real(dp) :: inverse_of_smallest
    logical  :: settled(2)

    if (matrix%n == 0) return
    call iterate(inverse_of_smallest, settled(1), matrix, solver)
    call iterate(eigenvalues%largest, settled(2), matrix)
    eigenvalues%found = all(settled) .and. abs(inverse_of_smallest) > 0.0_dp
    if (eigenvalues%found) then
      eigenvalues%smallest = 1.0_dp/inverse_of_smallest
    else
      eigenvalues%largest = 0.0_dp
    end if
  end subroutine find_eigenvalues

  !> Eigenvalue of largest magnitude of the matrix, or of its inverse when there are factors.
  !! Two vectors at a time: symmetry often makes the extreme eigenvalues almost equal.
  subroutine iterate(eigenvalue, settled, matrix, solver)
    real(dp), intent(out) :: eigenvalue
    logical, intent(out)  :: settled
    type(csc_matrix_t), intent(in) :: matrix
    type(linear_solver_t), intent(inout), optional :: solver !! with the factors
    real(dp), allocatable :: x(:, :), y(:, :)
    real(dp) :: before, change
    logical  :: is_real
    integer  :: i, k, iteration, outcome

    allocate (y(matrix%n, 2))
    x = reshape([(1.0_dp + 0.5_dp*sin(real(i, dp)**2), i=1, 2*matrix%n)], [matrix%n, 2])
    call make_orthonormal(x)
    eigenvalue = 0.0_dp
    settled = .false.
    do iteration = 1, max_iterations
      do k = 1, 2
        outcome = solver_ok
        if (present(solver)) then
          call solve(solver, matrix, x(:, k), y(:, k), outcome)
        else
          call multiply(matrix, x(:, k), y(:, k))
        end if
        if (outcome /= solver_ok) return
      end do
      before = eigenvalue
      call largest_of_two(eigenvalue, is_real, matmul(transpose(x), y))
      change = abs(eigenvalue - before)
      settled = is_real .and. change <= largest_change*abs(eigenvalue)
      if (change <= tolerance*abs(eigenvalue)) return
      x = y
      call make_orthonormal(x)
    end do
  end subroutine iterate

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
