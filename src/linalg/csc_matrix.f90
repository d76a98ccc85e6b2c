!> Sparse matrices in compressed columns, laid out as UMFPACK reads them.
module mpm_csc_matrix
  use mpm_kinds, only: dp, ip
  implicit none
  private
  public :: csc_matrix_t, add_block, allocate_entries, equal_columns, find_entry, multiply
  public :: multiply_by_groups, to_dense, zero_values

  !> A square matrix in compressed columns. Bounds and contents of the index arrays start at
  !! zero, so that they go to UMFPACK without a copy; rows ascend within a column.
  type :: csc_matrix_t
    integer     :: n = 0                 !! rows and columns
    integer(ip) :: nnz = 0               !! stored entries
    integer(ip), allocatable :: col_ptr(:) !! (0:n)      position of the first entry of a column
    integer(ip), allocatable :: row(:)     !! (0:nnz-1)  row of an entry, from 0
    real(dp), allocatable    :: val(:)     !! (0:nnz-1)  value of an entry
  end type csc_matrix_t

contains

  !> Makes room for the entries that col_ptr counts, with values zero. Too little memory leaves val
  !! unallocated.
  pure subroutine allocate_entries(matrix)
    type(csc_matrix_t), intent(inout) :: matrix !! n and col_ptr are set
    character(80) :: reason
    integer :: status

    matrix%nnz = matrix%col_ptr(matrix%n)
    allocate (matrix%row(0:matrix%nnz - 1_ip), stat=status, errmsg=reason)
    if (status /= 0) return
    allocate (matrix%val(0:matrix%nnz - 1_ip), source=0.0_dp, stat=status, errmsg=reason)
    if (status /= 0) return
  end subroutine allocate_entries

  !> Sets every stored entry to zero and keeps the pattern.
  pure subroutine zero_values(matrix)
    type(csc_matrix_t), intent(inout) :: matrix !! pattern stays

    matrix%val = 0.0_dp
  end subroutine zero_values

  !> Position of an entry in `val`, by binary search in its column.
  pure function find_entry(matrix, row, column) result(position)
    type(csc_matrix_t), intent(in) :: matrix !! rows ascending within a column
    integer, intent(in) :: row               !! equation number of the row, from 1
    integer, intent(in) :: column            !! equation number of the column, from 1
    integer(ip) :: position                  !! from 0; -1 outside the pattern
    integer(ip) :: low, high, middle

    position = -1_ip
    low = matrix%col_ptr(column - 1)
    high = matrix%col_ptr(column) - 1_ip
    do while (low <= high)
      middle = low + (high - low)/2_ip
      if (matrix%row(middle) < row - 1) then
        low = middle + 1_ip
      else if (matrix%row(middle) > row - 1) then
        high = middle - 1_ip
      else
        position = middle
        return
      end if
    end do
  end function find_entry

  !> Adds a dense block at the given equations. Entries outside the pattern are left out: the
  !! pattern must hold the block. Assembly writes through its position map; this is the reference.
  pure subroutine add_block(matrix, equations, block)
    type(csc_matrix_t), intent(inout) :: matrix !! receives the block
    integer, intent(in)  :: equations(:)        !! (m)     equation numbers, 0 = leave out
    real(dp), intent(in) :: block(:, :)         !! (m, m)  values
    integer :: i, j
    integer(ip) :: position

    do j = 1, size(equations)
      if (equations(j) == 0) cycle
      do i = 1, size(equations)
        if (equations(i) == 0) cycle
        position = find_entry(matrix, equations(i), equations(j))
        if (position >= 0_ip) matrix%val(position) = matrix%val(position) + block(i, j)
      end do
    end do
  end subroutine add_block

  !> Product y = A x.
  pure subroutine multiply(matrix, x, y)
    type(csc_matrix_t), intent(in) :: matrix !! A
    real(dp), intent(in)  :: x(:)            !! (n)
    real(dp), intent(out) :: y(:)            !! (n)
    integer :: j
    integer(ip) :: k

    y = 0.0_dp
    do j = 1, matrix%n
      do k = matrix%col_ptr(j - 1), matrix%col_ptr(j) - 1_ip
        y(matrix%row(k) + 1) = y(matrix%row(k) + 1) + matrix%val(k)*x(j)
      end do
    end do
  end subroutine multiply

  !> First columns of groups of up to three neighbours with the same rows, and n+1 behind them: the
  !! unknowns of a node.
  pure function equal_columns(matrix) result(first)
    type(csc_matrix_t), intent(in) :: matrix !! pattern
    integer, allocatable :: first(:)         !! (n_group+1)
    integer, allocatable :: group(:)
    integer :: j, k, n

    allocate (group(matrix%n + 1))
    n = 0
    j = 1
    do while (j <= matrix%n)
      n = n + 1
      group(n) = j
      do k = j + 1, min(j + 2, matrix%n)
        if (.not. has_rows_of(matrix, k, j)) exit
      end do
      j = k
    end do
    group(n + 1) = matrix%n + 1
    first = group(:n + 1)
  end function equal_columns

  !> Whether two columns have the same rows.
  pure logical function has_rows_of(matrix, j, other) result(equal)
    type(csc_matrix_t), intent(in) :: matrix !! pattern
    integer, intent(in) :: j, other          !! columns

    associate (p => matrix%col_ptr)
      equal = p(j) - p(j - 1) == p(other) - p(other - 1)
      if (equal) equal = all(matrix%row(p(j - 1):p(j) - 1_ip) &
                             == matrix%row(p(other - 1):p(other) - 1_ip))
    end associate
  end function has_rows_of

  !> Product y = A x that reads the rows of equal columns once. Sums are in another order than in
  !! `multiply`.
  pure subroutine multiply_by_groups(matrix, first, x, y)
    type(csc_matrix_t), intent(in) :: matrix !! A
    integer, intent(in)   :: first(:)        !! (n_group+1)  of equal_columns
    real(dp), intent(in)  :: x(:)            !! (n)
    real(dp), intent(out) :: y(:)            !! (n)
    integer :: g, j
    integer(ip) :: i, k, n

    y = 0.0_dp
    do g = 1, size(first) - 1
      j = first(g)
      n = matrix%col_ptr(j) - matrix%col_ptr(j - 1)
      select case (first(g + 1) - j)
      case (3)
        do k = matrix%col_ptr(j - 1), matrix%col_ptr(j) - 1_ip
          i = matrix%row(k) + 1_ip
          y(i) = y(i) + (matrix%val(k)*x(j) + matrix%val(k + n)*x(j + 1) &
                         + matrix%val(k + 2_ip*n)*x(j + 2))
        end do
      case (2)
        do k = matrix%col_ptr(j - 1), matrix%col_ptr(j) - 1_ip
          i = matrix%row(k) + 1_ip
          y(i) = y(i) + (matrix%val(k)*x(j) + matrix%val(k + n)*x(j + 1))
        end do
      case default
        do k = matrix%col_ptr(j - 1), matrix%col_ptr(j) - 1_ip
          i = matrix%row(k) + 1_ip
          y(i) = y(i) + matrix%val(k)*x(j)
        end do
      end select
    end do
  end subroutine multiply_by_groups

  !> Dense copy, for tests and small problems.
  pure function to_dense(matrix) result(dense)
    type(csc_matrix_t), intent(in) :: matrix    !! sparse matrix
    real(dp) :: dense(matrix%n, matrix%n)       !! the same matrix, zeros outside the pattern
    integer :: j
    integer(ip) :: k

    dense = 0.0_dp
    do j = 1, matrix%n
      do k = matrix%col_ptr(j - 1), matrix%col_ptr(j) - 1_ip
        dense(matrix%row(k) + 1, j) = matrix%val(k)
      end do
    end do
  end function to_dense

end module mpm_csc_matrix
