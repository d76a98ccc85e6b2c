!> Partition of the graph of face neighbours by recursive bisection with METIS.
module mpm_graph_partition
  use, intrinsic :: iso_c_binding, only: c_float, c_int, c_int32_t, c_null_ptr
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_metis_binding, only: metis_n_options, metis_ok, metis_option_seed, &
    metis_part_graph_recursive, metis_set_default_options
  use mpm_text, only: integer_text
  implicit none
  private
  public :: partition_graph

  integer(c_int32_t), parameter :: seed = 20 !! the same mesh always gives the same parts

contains

  !> Parts of about a given number of elements, not necessarily connected. METIS halves the mesh
  !! again and again: asked for thousands of parts of a few elements at once it returns empty ones.
  subroutine partition_graph(mesh, part_size, part, error)
    type(mesh_t), intent(in) :: mesh                 !! mesh with neighbours
    integer, intent(in)      :: part_size            !! elements wanted per part, at least 1
    integer, allocatable, intent(out) :: part(:)     !! (n_el)  part of each element, from 1
    type(error_t), allocatable, intent(out) :: error !! failure of METIS

    integer, allocatable :: order(:), place(:)
    integer :: e, n_part

    allocate (part(mesh%n_el), place(mesh%n_el), source=0)
    order = [(e, e=1, mesh%n_el)]
    n_part = 0
    call divide(order, 1, mesh%n_el)

  contains

    !> Divides order(first:last) until a stretch of it is one part.
    recursive subroutine divide(order, first, last)
      integer, intent(inout) :: order(:) !! (n_el)  elements, those of a part together
      integer, intent(in)    :: first    !! first of the stretch
      integer, intent(in)    :: last     !! last of the stretch

      logical, allocatable :: on_left(:)
      integer :: n, middle

      n = nint(real(last - first + 1, dp)/real(part_size, dp))
      if (n < 2) then
        n_part = n_part + 1
        part(order(first:last)) = n_part
        return
      end if
      call bisect(mesh, order(first:last), real(n/2, dp)/real(n, dp), place, on_left, error)
      if (allocated(error)) return
      middle = first + count(on_left) - 1
      if (middle < first .or. middle == last) then
        middle = (first + last)/2
      else
        associate (stretch => order(first:last))
          stretch = [pack(stretch, on_left), pack(stretch, .not. on_left)]
        end associate
      end if
      call divide(order, first, middle)
      if (allocated(error)) return
      call divide(order, middle + 1, last)
    end subroutine divide

  end subroutine partition_graph

  !> Cuts a group of elements in two along few faces.
  subroutine bisect(mesh, element, share, place, on_left, error)
    type(mesh_t), intent(in) :: mesh                   !! mesh with neighbours
    integer, intent(in)      :: element(:)             !! (n)     the group
    real(dp), intent(in)     :: share                  !!         of the left side in the group [-]
    integer, intent(inout)   :: place(:)               !! (n_el)  scratch, zero in and out
    logical, allocatable, intent(out) :: on_left(:)    !! (n)     whether an element is on the left
    type(error_t), allocatable, intent(out) :: error   !!         failure of METIS

    integer(c_int32_t), allocatable :: adjacent(:), first(:), side(:)
    integer(c_int32_t) :: cut, options(metis_n_options)
    integer(c_int) :: status
    integer :: i

    place(element) = [(i, i=1, size(element))]
    call list_neighbours(mesh, element, place, first, adjacent)
    place(element) = 0
    allocate (side(size(element)))
    status = metis_set_default_options(options)
    options(metis_option_seed) = seed
    status = metis_part_graph_recursive(int(size(element), c_int32_t), 1_c_int32_t, first, &
      adjacent, c_null_ptr, c_null_ptr, c_null_ptr, 2_c_int32_t, &
      real([share, 1.0_dp - share], c_float), c_null_ptr, options, cut, side)
    if (status /= metis_ok) then
      call make_error(error, exit_model, "METIS failed with status "//integer_text(int(status))// &
        " on the patches: expected a partition of the mesh")
      return
    end if
    on_left = side == 0_c_int32_t
  end subroutine bisect

  !> Adjacency lists of a group of elements, counted from zero as METIS does.
  pure subroutine list_neighbours(mesh, element, place, first, adjacent)
    type(mesh_t), intent(in) :: mesh       !! mesh with neighbours
    integer, intent(in)      :: element(:) !! (n)     the group
    integer, intent(in)      :: place(:)   !! (n_el)  place in the group, 0 outside it
    integer(c_int32_t), allocatable, intent(out) :: first(:)    !! (n+1)  start of each list
    integer(c_int32_t), allocatable, intent(out) :: adjacent(:) !! places of the neighbours

    integer :: a, i, n, neighbour

    allocate (first(size(element) + 1), adjacent((mesh%n_dim + 1)*size(element)))
    first(1) = 0_c_int32_t
    n = 0
    do i = 1, size(element)
      do a = 1, mesh%n_dim + 1
        neighbour = mesh%neighbour(a, element(i))
        if (neighbour == 0) cycle
        if (place(neighbour) == 0) cycle
        n = n + 1
        adjacent(n) = int(place(neighbour) - 1, c_int32_t)
      end do
      first(i + 1) = int(n, c_int32_t)
    end do
  end subroutine list_neighbours

end module mpm_graph_partition
