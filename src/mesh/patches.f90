!> Patches of elements over which F-bar averages the volume change.
module mpm_patches
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_graph_partition, only: partition_graph
  use mpm_kinds, only: dp
  use mpm_mesh, only: mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: patches_t
  public :: disconnected_patch, patch_size_range, patches_from_graph, patches_from_parents
  public :: patches_of_single_elements

  !> Each element belongs to exactly one patch; compressed lists.
  type :: patches_t
    integer :: n = 0                      !! patches
    integer, allocatable :: of_element(:) !! (n_el)  patch of an element
    integer, allocatable :: first(:)      !! (n+1)   start of each patch in element
    integer, allocatable :: element(:)    !! (n_el)
  end type patches_t

contains

  !> A patch is the linear elements of one quadratic parent.
  pure subroutine patches_from_parents(patches, mesh)
    type(patches_t), intent(out) :: patches !! patches
    type(mesh_t), intent(in)     :: mesh    !! mesh with parents

    patches%of_element = mesh%parent
    patches%n = size(mesh%parent_label)
    call list_elements(patches)
  end subroutine patches_from_parents

  !> Every element is a patch of its own.
  pure subroutine patches_of_single_elements(patches, n_el)
    type(patches_t), intent(out) :: patches !! patches
    integer, intent(in)          :: n_el    !! elements

    integer :: e

    patches%of_element = [(e, e=1, n_el)]
    patches%n = n_el
    call list_elements(patches)
  end subroutine patches_of_single_elements

  !> Groups the elements of any mesh into connected patches of about a given size.
  !! METIS may leave pieces apart: every piece becomes a patch, and one smaller than half the size
  !! joins its smallest neighbour.
  subroutine patches_from_graph(patches, mesh, patch_size, error)
    type(patches_t), intent(out) :: patches          !! patches
    type(mesh_t), intent(in)     :: mesh             !! mesh with neighbours
    integer, intent(in)          :: patch_size       !! wanted elements per patch, at least 1
    type(error_t), allocatable, intent(out) :: error !! failure of METIS or a wrong size

    integer, allocatable :: part(:), component(:)
    integer :: n_component

    if (patch_size < 1) then
      call make_error(error, exit_model, "patch size "//integer_text(patch_size)// &
        ": expected at least 1")
      return
    end if
    if (patch_size == 1) then
      call patches_of_single_elements(patches, mesh%n_el)
      return
    end if
    call partition_graph(mesh, patch_size, part, error)
    if (allocated(error)) return
    call label_components(mesh, part, component, n_component)
    call join_small(mesh, component, n_component, patch_size)
    call label_components(mesh, component, patches%of_element, patches%n)
    call list_elements(patches)
  end subroutine patches_from_graph

  !> First patch whose elements do not hang together through faces, 0 if there is none.
  pure integer function disconnected_patch(patches, mesh) result(patch)
    type(patches_t), intent(in) :: patches !! patches
    type(mesh_t), intent(in)    :: mesh    !! mesh with neighbours

    integer, allocatable :: component(:)
    integer :: n_component, p

    patch = 0
    call label_components(mesh, patches%of_element, component, n_component)
    do p = 1, patches%n
      associate (element => patches%element(patches%first(p):patches%first(p + 1) - 1))
        if (all(component(element) == component(element(1)))) cycle
      end associate
      patch = p
      return
    end do
  end function disconnected_patch

  !> Elements per patch, for the report.
  pure subroutine patch_size_range(patches, smallest, mean, largest)
    type(patches_t), intent(in) :: patches  !! patches
    integer, intent(out)        :: smallest !! fewest elements of a patch
    real(dp), intent(out)       :: mean     !! elements per patch
    integer, intent(out)        :: largest  !! most elements of a patch

    smallest = minval(patches%first(2:) - patches%first(:patches%n))
    largest = maxval(patches%first(2:) - patches%first(:patches%n))
    mean = real(size(patches%element), dp)/real(patches%n, dp)
  end subroutine patch_size_range

  !> Compressed lists from the patch of each element.
  pure subroutine list_elements(patches)
    type(patches_t), intent(inout) :: patches !! in n and of_element, out first and element

    integer, allocatable :: next(:)
    integer :: e, p

    allocate (patches%first(patches%n + 1), source=0)
    allocate (patches%element(size(patches%of_element)))
    do e = 1, size(patches%of_element)
      p = patches%of_element(e) + 1
      patches%first(p) = patches%first(p) + 1
    end do
    patches%first(1) = 1
    do p = 2, patches%n + 1
      patches%first(p) = patches%first(p) + patches%first(p - 1)
    end do
    next = patches%first
    do e = 1, size(patches%of_element)
      p = patches%of_element(e)
      patches%element(next(p)) = e
      next(p) = next(p) + 1
    end do
  end subroutine list_elements

  !> Numbers the connected pieces of equal label, in the order of their first elements.
  pure subroutine label_components(mesh, label, component, n_component)
    type(mesh_t), intent(in) :: mesh                  !! mesh with neighbours
    integer, intent(in)      :: label(:)              !! (n_el)  label of each element
    integer, allocatable, intent(out) :: component(:) !! (n_el)  connected piece of each element
    integer, intent(out)     :: n_component           !! pieces

    integer, allocatable :: queue(:)
    integer :: a, e, head, neighbour, start, tail

    allocate (component(mesh%n_el), source=0)
    allocate (queue(mesh%n_el))
    n_component = 0
    tail = 0
    do start = 1, mesh%n_el
      if (component(start) > 0) cycle
      n_component = n_component + 1
      component(start) = n_component
      head = tail + 1
      tail = head
      queue(head) = start
      do while (head <= tail)
        e = queue(head)
        head = head + 1
        do a = 1, mesh%n_dim + 1
          neighbour = mesh%neighbour(a, e)
          if (neighbour == 0) cycle
          if (component(neighbour) > 0 .or. label(neighbour) /= label(e)) cycle
          component(neighbour) = n_component
          tail = tail + 1
          queue(tail) = neighbour
        end do
      end do
    end do
  end subroutine label_components

  !> Joins every piece smaller than half a patch to its smallest neighbour.
  !! The elements of a piece are a chain, so that joining two is one link.
  pure subroutine join_small(mesh, piece, n_piece, patch_size)
    type(mesh_t), intent(in) :: mesh       !! mesh with neighbours
    integer, intent(inout)   :: piece(:)   !! (n_el)  piece of each element
    integer, intent(in)      :: n_piece    !!         pieces
    integer, intent(in)      :: patch_size !!         wanted elements per patch

    integer, allocatable :: head(:), tail(:), next(:), n(:)
    integer :: e, p, target

    allocate (head(n_piece), tail(n_piece), n(n_piece), next(mesh%n_el), source=0)
    do e = 1, mesh%n_el
      p = piece(e)
      if (n(p) == 0) head(p) = e
      if (n(p) > 0) next(tail(p)) = e
      tail(p) = e
      n(p) = n(p) + 1
    end do
    do p = 1, n_piece
      if (2*n(p) >= patch_size) cycle
      target = smallest_neighbour(mesh, piece, n, next, head(p))
      if (target == 0) cycle
      e = head(p)
      do while (e > 0)
        piece(e) = target
        e = next(e)
      end do
      next(tail(target)) = head(p)
      tail(target) = tail(p)
      n(target) = n(target) + n(p)
    end do
  end subroutine join_small

  !> The piece of fewest elements that touches a piece, of equal ones the first; 0 if none touches.
  pure integer function smallest_neighbour(mesh, piece, n, next, head) result(target)
    type(mesh_t), intent(in) :: mesh     !! mesh with neighbours
    integer, intent(in)      :: piece(:) !! (n_el)     piece of each element
    integer, intent(in)      :: n(:)     !! (n_piece)  elements of a piece
    integer, intent(in)      :: next(:)  !! (n_el)     next element of the same piece, 0 at the end
    integer, intent(in)      :: head     !!            first element of the piece

    integer :: a, candidate, e

    target = 0
    e = head
    do while (e > 0)
      do a = 1, mesh%n_dim + 1
        if (mesh%neighbour(a, e) == 0) cycle
        candidate = piece(mesh%neighbour(a, e))
        if (candidate == piece(e) .or. candidate == target) cycle
        if (target == 0) then
          target = candidate
        else if (n(candidate) < n(target) .or. &
            (n(candidate) == n(target) .and. candidate < target)) then
          target = candidate
        end if
      end do
      e = next(e)
    end do
  end function smallest_neighbour

end module mpm_patches
