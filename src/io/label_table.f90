!> Finds items by the numbers that the user gave them; memory does not depend on the numbers.
module mpm_label_table
  use mpm_kinds, only: ip
  implicit none
  private
  public :: label_table_t, build_label_table, find_label

  !> Sorted labels.
  type :: label_table_t
    integer, allocatable :: label(:) !! (n) ascending
    integer, allocatable :: item(:)  !! (n) item of each label
    logical :: dense = .false.       !! labels without gaps
  end type label_table_t

contains

  !> Sorts labels and finds one that occurs twice.
  pure subroutine build_label_table(table, label, duplicate)
    type(label_table_t), intent(out) :: table !! for find_label
    integer, intent(in)  :: label(:)          !! (n) label of each item
    integer, intent(out) :: duplicate         !! item whose label occurs before, 0 if none
    integer :: i

    duplicate = 0
    table%item = [(i, i=1, size(label))]
    if (any(label(2:) <= label(:size(label) - 1))) call sort_by_key(table%item, label)
    table%label = label(table%item)
    do i = 2, size(label)
      if (table%label(i) == table%label(i - 1)) then
        duplicate = table%item(i)
        return
      end if
    end do
    if (size(label) == 0) return
    table%dense = int(table%label(size(label)), ip) - int(table%label(1), ip) == &
                  int(size(label), ip) - 1_ip
  end subroutine build_label_table

  !> Merge sort of a list by the keys of its items; stable.
  pure subroutine sort_by_key(list, key)
    integer, intent(inout) :: list(:) !! (n) indices into key
    integer, intent(in)    :: key(:)  !! (m)
    integer, allocatable :: merged(:)
    integer :: width, first

    allocate (merged(size(list)))
    width = 1
    do while (width < size(list))
      do first = 1, size(list), 2*width
        call merge_runs(merged, list, key, first, width)
      end do
      list = merged
      width = 2*width
    end do
  end subroutine sort_by_key

  !> Merges two sorted runs.
  pure subroutine merge_runs(merged, list, key, first, width)
    integer, intent(inout) :: merged(:) !! (n) first .. first + 2 width - 1 are set
    integer, intent(in)    :: list(:)   !! (n) runs
    integer, intent(in)    :: key(:)    !! (m) keys of the items
    integer, intent(in)    :: first     !! start of the left run
    integer, intent(in)    :: width     !! length of a run
    integer :: i, j, k, middle, last
    logical :: left

    middle = min(first + width, size(list) + 1)
    last = min(first + 2*width, size(list) + 1)
    i = first
    j = middle
    do k = first, last - 1
      left = i < middle
      if (left .and. j < last) left = key(list(i)) <= key(list(j))
      if (left) then
        merged(k) = list(i)
        i = i + 1
      else
        merged(k) = list(j)
        j = j + 1
      end if
    end do
  end subroutine merge_runs

  !> The item that has a label, 0 if there is none.
  pure integer function find_label(table, label) result(item)
    type(label_table_t), intent(in) :: table !! sorted labels
    integer, intent(in) :: label             !! number in the input
    integer :: low, high, middle

    item = 0
    if (size(table%label) == 0) return
    low = 1
    high = size(table%label)
    if (label < table%label(1) .or. label > table%label(high)) return
    if (table%dense) then
      item = table%item(label - table%label(1) + 1)
      return
    end if
    do while (low < high)
      middle = low + (high - low)/2
      if (table%label(middle) < label) then
        low = middle + 1
      else
        high = middle
      end if
    end do
    if (table%label(low) == label) item = table%item(low)
  end function find_label

end module mpm_label_table
