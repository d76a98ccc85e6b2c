!> Small sparse matrices for the tests of this layer.
module sparse_samples
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: from_dense, grid_matrix, random_matrix, dense_solution

contains

  !> Sparse copy of a dense matrix: the nonzero entries.
  subroutine from_dense(matrix, dense)
    type(csc_matrix_t), intent(out) :: matrix !! the same matrix
    real(dp), intent(in) :: dense(:, :)       !! (n, n)
    logical :: stored(size(dense, 1), size(dense, 2))
    integer :: i, j, n

    stored = abs(dense) > 0.0_dp
    n = size(dense, 1)
    matrix%n = n
    matrix%nnz = int(count(stored), ip)
    allocate (matrix%col_ptr(0:n), source=0_ip)
    do j = 1, n
      matrix%col_ptr(j) = matrix%col_ptr(j - 1) + int(count(stored(:, j)), ip)
    end do
    allocate (matrix%row(0:matrix%nnz - 1_ip), matrix%val(0:matrix%nnz - 1_ip))
    matrix%row = pack(spread([(int(i - 1, ip), i=1, n)], 2, n), stored)
    matrix%val = pack(dense, stored)
  end subroutine from_dense

  !> Difference operator on an m x m grid with an upwind part: unsymmetric values on a symmetric
  !! pattern.
  function grid_matrix(m) result(dense)
    integer, intent(in) :: m       !! nodes in a row
    real(dp) :: dense(m*m, m*m)    !! regular
    integer :: i, j, k

    dense = 0.0_dp
    do j = 1, m
      do i = 1, m
        k = i + (j - 1)*m
        dense(k, k) = 4.0_dp + 0.01_dp*real(k, dp)
        if (i > 1) dense(k, k - 1) = -1.5_dp
        if (i < m) dense(k, k + 1) = -0.5_dp
        if (j > 1) dense(k, k - m) = -1.2_dp
        if (j < m) dense(k, k + m) = -0.8_dp
      end do
    end do
  end function grid_matrix

  !> Unsymmetric matrix with a dominant diagonal and entries by chance.
  function random_matrix(n, seed) result(dense)
    integer, intent(in) :: n    !! order
    integer, intent(in) :: seed !! another one, another matrix
    real(dp) :: dense(n, n)     !! regular, no entry is zero
    integer :: i, j

    do j = 1, n
      do i = 1, n
        dense(i, j) = 0.1_dp*sin(real(1000*seed + 37*i + 11*j*j, dp)**2)
      end do
      dense(j, j) = 1.0_dp + 0.05_dp*real(j, dp)
    end do
  end function random_matrix

  !> Solution of a dense system by Gauss elimination with row pivoting.
  function dense_solution(dense, rhs) result(x)
    real(dp), intent(in) :: dense(:, :) !! (n, n)
    real(dp), intent(in) :: rhs(:)      !! (n)
    real(dp) :: x(size(rhs))            !! solution
    real(dp) :: a(size(rhs), size(rhs) + 1), row(size(rhs) + 1)
    integer :: k, n, pivot

    n = size(rhs)
    a(:, :n) = dense
    a(:, n + 1) = rhs
    do k = 1, n
      pivot = k - 1 + maxloc(abs(a(k:, k)), dim=1)
      row = a(k, :)
      a(k, :) = a(pivot, :)
      a(pivot, :) = row
      a(k + 1:, k:) = a(k + 1:, k:) &
                      - spread(a(k + 1:, k)/a(k, k), 2, n + 2 - k)*spread(a(k, k:), 1, n - k)
    end do
    do k = n, 1, -1
      x(k) = (a(k, n + 1) - dot_product(a(k, k + 1:n), x(k + 1:n)))/a(k, k)
    end do
  end function dense_solution

end module sparse_samples
