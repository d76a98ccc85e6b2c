!> Order of elimination by nested dissection: METIS on the graph of nodes.
!!
!! Columns with the same rows, the unknowns of a node, are one vertex with their number as weight.
!! The order is the same in every run. Source: theory.md 7.1.
! allow(assumed-size)
module mpm_node_ordering
  use, intrinsic :: iso_c_binding, only: c_int, c_int32_t, c_null_ptr, c_ptr
  use mpm_csc_matrix, only: csc_matrix_t, equal_columns
  use mpm_interruption, only: note_termination
  use mpm_kinds, only: ip
  implicit none
  private
  public :: order_by_nodes

  integer(c_int), parameter :: metis_ok = 1_c_int     !! METIS_OK
  integer(c_int), parameter :: metis_ended = -4_c_int !! METIS_ERROR: it has caught a SIGTERM

  !> The nodes and which of them share an entry.
  type :: graph_t
    integer, allocatable :: column(:)              !! (n+1)  first one of each node, and n+1
    integer(c_int32_t), allocatable :: first(:)    !! (0:n)  start of each adjacency list
    integer(c_int32_t), allocatable :: adjacent(:) !! (first(n))  neighbours, from 0
    integer(c_int32_t), allocatable :: weight(:)   !! (n)  unknowns
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
    logical, intent(out) :: is_ordered       !! .false.: out of memory
    type(graph_t) :: graph
    integer(c_int32_t), allocatable :: node(:)
    integer :: i, j, k

    place = [(int(j, c_int), j=1, matrix%n)]
    call build_graph(graph, matrix, is_ordered)
    if (.not. is_ordered) return
    if (size(graph%adjacent) == 0) return ! nothing to dissect
    call dissect(node, graph, is_ordered)
    if (.not. is_ordered) return
    k = 0
    do i = 1, size(node)
      associate (v => node(i) + 1)
        do j = graph%column(v), graph%column(v + 1) - 1
          k = k + 1
          place(j) = int(k, c_int)
        end do
      end associate
    end do
  end subroutine order_by_nodes

  !> Lets METIS order a graph. It catches SIGTERM while it works: that is noted, and it is called
  !! again.
  subroutine dissect(node, graph, is_ordered)
    integer(c_int32_t), allocatable, intent(out) :: node(:) !! (n)  node at each place, from 0
    type(graph_t), intent(in) :: graph
    logical, intent(out) :: is_ordered !! .false.: out of memory
    integer(c_int32_t), allocatable :: unused(:)
    integer(c_int) :: status
    character(80) :: reason
    integer :: n, problem

    n = size(graph%weight)
    is_ordered = .false.
    allocate (node(n), unused(n), stat=problem, errmsg=reason)
    if (problem /= 0) return
    do
      status = metis_node_nd(int(n, c_int32_t), graph%first, graph%adjacent, graph%weight, &
                             c_null_ptr, node, unused)
      if (status /= metis_ended) exit
      call note_termination()
    end do
    is_ordered = status == metis_ok
  end subroutine dissect

  !> The graph of the nodes.
  subroutine build_graph(graph, matrix, is_built)
    type(graph_t), intent(out) :: graph
    type(csc_matrix_t), intent(in) :: matrix !! pattern
    logical, intent(out) :: is_built         !! .false.: out of memory, or of what METIS can count
    integer, allocatable :: node_of(:) ! column -> node, from 0; -1: not the first column of one
    integer(ip), allocatable :: first(:)
    character(80) :: reason
    integer :: i, n, problem
    integer(ip) :: k, m

    is_built = .false.
    graph%column = equal_columns(matrix)
    n = size(graph%column) - 1
    allocate (node_of(0:matrix%n - 1), first(0:n), graph%weight(n), stat=problem, errmsg=reason)
    if (problem /= 0) return
    graph%weight(:) = int(graph%column(2:) - graph%column(:n), c_int32_t)
    node_of(:) = -1
    node_of(graph%column(:n) - 1) = [(i, i=0, n - 1)]
    first(0) = 0_ip
    do i = 1, n
      associate (rows => matrix%row(matrix%col_ptr(graph%column(i) - 1): &
                                    matrix%col_ptr(graph%column(i)) - 1_ip))
        first(i) = first(i - 1) + count(node_of(rows) >= 0 .and. node_of(rows) /= i - 1, kind=ip)
      end associate
    end do
    if (first(n) > int(huge(1_c_int32_t), ip)) return
    allocate (graph%first(0:n), graph%adjacent(first(n)), stat=problem, errmsg=reason)
    if (problem /= 0) return
    graph%first(:) = int(first, c_int32_t)
    m = 0_ip
    do i = 1, n
      do k = matrix%col_ptr(graph%column(i) - 1), matrix%col_ptr(graph%column(i)) - 1_ip
        if (node_of(matrix%row(k)) < 0 .or. node_of(matrix%row(k)) == i - 1) cycle
        m = m + 1_ip
        graph%adjacent(m) = int(node_of(matrix%row(k)), c_int32_t)
      end do
    end do
    is_built = .true.
  end subroutine build_graph

end module mpm_node_ordering
