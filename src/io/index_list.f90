!> A list of indices that grows cheaply.
module mpm_index_list
  implicit none
  private
  public :: index_list_t, append_items, list_items

  !> The first n entries count.
  type :: index_list_t
    integer :: n = 0                !! entries
    integer, allocatable :: item(:) !! (>= n) entries; unallocated while empty
  end type index_list_t

contains

  !> Appends indices.
  pure subroutine append_items(list, item)
    type(index_list_t), intent(inout) :: list !! longer afterwards
    integer, intent(in) :: item(:)            !! (m) new entries
    integer, allocatable :: longer(:)

    if (.not. allocated(list%item)) allocate (list%item(size(item) + 8))
    if (list%n + size(item) > size(list%item)) then
      allocate (longer(2*(list%n + size(item))))
      longer(:list%n) = list%item(:list%n)
      call move_alloc(longer, list%item)
    end if
    list%item(list%n + 1:list%n + size(item)) = item
    list%n = list%n + size(item)
  end subroutine append_items

  !> The entries.
  pure function list_items(list) result(item)
    type(index_list_t), intent(in) :: list !! any
    integer :: item(list%n)                !! (n) entries

    if (list%n > 0) item = list%item(:list%n)
  end function list_items

end module mpm_index_list
