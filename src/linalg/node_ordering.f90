!> Order of elimination by nested dissection: METIS on the graph of nodes.
!!
!! Columns with the same rows, the unknowns of a node, are one vertex with their number as weight.
!! The order is the same in every run. Source: theory.md 7.1.
! allow(assumed-size)
module mpm_node_ordering
  use, intrinsic :: iso_c_binding, only: c_int, c_int32_t, c_null_ptr, c_ptr
  use mpm_csc_matrix, only: csc_matrix_t, equal_columns
  use mpm_kinds, only: ip
  implicit none
  private
  public :: order_by_nodes

  integer(c_int), parameter :: metis_ok = 1_c_int !! METIS_OK

  !> The nodes and which of them share an entry.
  type :: graph_t
    integer, allocatable :: column(:)             !! (n+1)         first column of each node, then behind
    integer(c_int32_t), allocatable :: first(:)   !! (0:n)         start of each adjacency list
    integer(c_int32_t), allocatable :: adjacent(:) !! (first(n))   neighbours, from 0
    integer(c_int32_t), allocatable :: weight(:)  !! (n)           unknowns
  end type graph_t

  interface
    !> Nested dissection of a graph. Indices count from zero.
    function metis_node_nd(n_vertex, first, adjacent, weight, options, vertex, place) &
      bind(c, name="METIS_NodeND") result(status)
      import :: c_int, c_int32_t, c_ptr
      implicit none
      integer(c_int32_t), intent(in)  :: n_vertex    !! vertices
      integer(c_int32_t), intent(in)  :: first(*)    !! (n_vertex+1)  start of each adjacency list
      integer(c_int32_t), intent(in)  :: adjacent(*) !! (first(n_vertex))  adjacency lists
      integer(c_int32_t), intent(in)  :: weight(*)   !! (n_vertex)
      type(c_ptr), value              :: options     !! null: defaults
      integer(c_int32_t), intent(out) :: vertex(*)   !! (n_vertex)  vertex at each place
      integer(c_int32_t), intent(out) :: place(*)    !! (n_vertex)  place of each vertex
      integer(c_int) :: status                       !! metis_ok or an error
    end function metis_node_nd
  end interface

contains

  !> Places of the columns in the order of elimination. Source: theory.md 7.1.
  subroutine order_by_nodes(place, matrix, is_ordered)
    integer(c_int), intent(out) :: place(:)  !! (n)  from 1; that of the columns if it fails
    type(csc_matrix_t), intent(in) :: matrix !! pattern, of symmetric structure
    logical, intent(out) :: is_ordered       !! METIS did not fail
    type(graph_t) :: graph
    integer(c_int32_t), allocatable :: node(:), unused(:)
    integer :: i, j, k, n

    place = [(int(j, c_int), j=1, matrix%n)]
    is_ordered = .false.
    if (matrix%nnz > int(huge(1_c_int32_t), ip)) return
    graph = graph_of(matrix)
    n = size(graph%weight)
    is_ordered = size(graph%adjacent) == 0 ! nothing to dissect
    if (is_ordered) return
    allocate (node(n), unused(n))
    is_ordered = metis_node_nd(int(n, c_int32_t), graph%first, graph%adjacent, graph%weight, &
                               c_null_ptr, node, unused) == metis_ok
    if (.not. is_ordered) return
    k = 0
    do i = 1, n
      associate (v => node(i) + 1)
        do j = graph%column(v), graph%column(v + 1) - 1
          k = k + 1
          place(j) = int(k, c_int)
        end do
      end associate
    end do
  end subroutine order_by_nodes

  !> The graph of the nodes.
  pure function graph_of(matrix) result(graph)
    type(csc_matrix_t), intent(in) :: matrix !! pattern
    type(graph_t) :: graph
    integer, allocatable :: node_of(:) ! column -> node, from 0; -1: not the first column of one
    integer :: i, n, other
    integer(ip) :: k

    graph%column = equal_columns(matrix)
    n = size(graph%column) - 1
    graph%weight = int(graph%column(2:) - graph%column(:n), c_int32_t)
    allocate (node_of(0:matrix%n - 1), source=-1)
    node_of(graph%column(:n) - 1) = [(i, i=0, n - 1)]
    allocate (graph%first(0:n), graph%adjacent(matrix%nnz))
    graph%first(0) = 0_c_int32_t
    do i = 1, n
      graph%first(i) = graph%first(i - 1)
      do k = matrix%col_ptr(graph%column(i) - 1), matrix%col_ptr(graph%column(i)) - 1_ip
        other = node_of(matrix%row(k))
        if (other < 0 .or. other == i - 1) cycle
        graph%first(i) = graph%first(i) + 1_c_int32_t
        graph%adjacent(graph%first(i)) = int(other, c_int32_t)
      end do
    end do
    graph%adjacent = graph%adjacent(:graph%first(n))
  end function graph_of

end module mpm_node_ordering
