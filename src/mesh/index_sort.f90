!> Sorting of small integer tuples (faces, edges) and of index lists in linear time.
module mpm_index_sort
  implicit none
  private
  public :: find_column, sort_columns, sorted_small, unique_sorted

contains

  !> Order that sorts the columns of a table lexicographically: one stable counting sort per row,
  !! last row first. Equal columns keep their order.
  pure subroutine sort_columns(key, n_value, order)
    integer, intent(in)               :: key(:, :) !! (m, n)  columns to sort, values 1..n_value
    integer, intent(in)               :: n_value   !!         largest value
    integer, allocatable, intent(out) :: order(:)  !! (n)     sorted column j is key(:, order(j))

    integer, allocatable :: previous(:), first(:)
    integer :: i, j, v

    allocate (order(size(key, 2)), source=[(j, j=1, size(key, 2))])
    allocate (first(n_value + 1))
    do i = size(key, 1), 1, -1
      first = 0
      do j = 1, size(key, 2)
        first(key(i, j) + 1) = first(key(i, j) + 1) + 1
      end do
      first(1) = 1
      do v = 2, n_value + 1
        first(v) = first(v) + first(v - 1)
      end do
      previous = order
      do j = 1, size(order)
        v = key(i, previous(j))
        order(first(v)) = previous(j)
        first(v) = first(v) + 1
      end do
    end do
  end subroutine sort_columns

  !> First position in the sorted order whose column equals the one sought, 0 if there is none.
  pure integer function find_column(key, order, sought) result(found)
    integer, intent(in) :: key(:, :) !! (m, n)  columns
    integer, intent(in) :: order(:)  !! (n)     from sort_columns
    integer, intent(in) :: sought(:) !! (m)     column to find

    integer :: low, high, middle

    low = 1
    high = size(order) + 1
    do while (low < high)
      middle = low + (high - low)/2
      if (comes_before(key(:, order(middle)), sought)) then
        low = middle + 1
      else
        high = middle
      end if
    end do
    found = 0
    if (low > size(order)) return
    if (all(key(:, order(low)) == sought)) found = low
  end function find_column

  !> Lexicographic order of two columns.
  pure logical function comes_before(a, b) result(before)
    integer, intent(in) :: a(:) !! (m)  first column
    integer, intent(in) :: b(:) !! (m)  second column

    integer :: i

    before = .false.
    do i = 1, size(a)
      if (a(i) == b(i)) cycle
      before = a(i) < b(i)
      return
    end do
  end function comes_before

  !> A few integers in ascending order.
  pure function sorted_small(value) result(sorted)
    integer, intent(in) :: value(:) !! (m)  values
    integer :: sorted(size(value))  !! (m)  ascending

    integer :: i, j, v

    sorted = value
    do i = 2, size(sorted)
      v = sorted(i)
      do j = i - 1, 1, -1
        if (sorted(j) <= v) exit
        sorted(j + 1) = sorted(j)
      end do
      sorted(j + 1) = v
    end do
  end function sorted_small

  !> The different values of a list of indices, ascending.
  pure function unique_sorted(item, n_value) result(unique)
    integer, intent(in)  :: item(:)  !! (n)  indices 1..n_value
    integer, intent(in)  :: n_value  !!      largest index
    integer, allocatable :: unique(:) !! (<=n)  ascending, each once

    logical, allocatable :: marked(:)
    integer :: i

    allocate (marked(n_value), source=.false.)
    do i = 1, size(item)
      marked(item(i)) = .true.
    end do
    unique = pack([(i, i=1, n_value)], marked)
  end function unique_sorted

end module mpm_index_sort
