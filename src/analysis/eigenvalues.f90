!> Smallest and largest eigenvalue of the tangent: how well the increment is posed.
module mpm_eigenvalues
  use mpm_csc_matrix, only: csc_matrix_t, multiply
  use mpm_kinds, only: dp
  use mpm_linear_solver, only: linear_solver_t, solve, solver_ok
  implicit none
  private
  public :: eigenvalues_t, find_eigenvalues

  integer, parameter  :: max_iterations = 1000   !! of each iteration
  real(dp), parameter :: tolerance = 1.0e-10_dp  !! relative change that ends it

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
  subroutine iterate(eigenvalue, settled, matrix, solver)
    real(dp), intent(out) :: eigenvalue
    logical, intent(out)  :: settled
    type(csc_matrix_t), intent(in) :: matrix
    type(linear_solver_t), intent(inout), optional :: solver !! with the factors
    real(dp), allocatable :: x(:), y(:)
    real(dp) :: before
    integer  :: i, iteration, outcome

    allocate (y(matrix%n))
    x = [(1.0_dp + 0.5_dp*sin(real(i, dp)**2), i=1, matrix%n)]
    x = x/norm2(x)
    eigenvalue = 0.0_dp
    settled = .false.
    do iteration = 1, max_iterations
      before = eigenvalue
      if (present(solver)) then
        call solve(solver, matrix, x, y, outcome)
        if (outcome /= solver_ok) return
      else
        call multiply(matrix, x, y)
      end if
      eigenvalue = dot_product(x, y)
      settled = abs(eigenvalue - before) <= tolerance*abs(eigenvalue)
      if (settled .or. .not. norm2(y) > 0.0_dp) return
      x = y/norm2(y)
    end do
  end subroutine iterate

end module mpm_eigenvalues
