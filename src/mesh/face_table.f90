!> All faces of a simplex mesh in sorted order: who shares a face with whom.
module mpm_face_table
  use mpm_index_sort, only: find_column, sort_columns, sorted_small
  implicit none
  private
  public :: face_table_t, build_face_table, corners_of_face, find_face, match_faces

  !> Face i belongs to element (i-1)/(n_dim+1) + 1 and lies opposite its local node
  !! mod(i-1, n_dim+1) + 1.
  type :: face_table_t
    integer, allocatable :: key(:, :) !! (n_dim, n_face)  corner nodes, ascending
    integer, allocatable :: order(:)  !! (n_face)         faces in order of their nodes
  end type face_table_t

contains

  !> Lists and sorts all faces.
  pure subroutine build_face_table(table, node, n_node)
    type(face_table_t), intent(out) :: table !! faces of all elements
    integer, intent(in) :: node(:, :)        !! (n_dim+1, n_el)  corner nodes of the elements
    integer, intent(in) :: n_node            !!                  number of nodes

    integer :: a, e, n_corner

    n_corner = size(node, 1)
    allocate (table%key(n_corner - 1, n_corner*size(node, 2)))
    do e = 1, size(node, 2)
      do a = 1, n_corner
        table%key(:, n_corner*(e - 1) + a) = sorted_small(corners_of_face(node(:, e), a))
      end do
    end do
    call sort_columns(table%key, n_node, table%order)
  end subroutine build_face_table

  !> Nodes of a face in the order of the element.
  pure function corners_of_face(node, face) result(corner)
    integer, intent(in) :: node(:)     !! (n_dim+1)  corner nodes of an element
    integer, intent(in) :: face        !!            local node opposite
    integer :: corner(size(node) - 1)  !! (n_dim)    the others

    corner(:face - 1) = node(:face - 1)
    corner(face:) = node(face + 1:)
  end function corners_of_face

  !> The element that a face with these corners belongs to (the lower one of two).
  pure subroutine find_face(table, corner, element, face)
    type(face_table_t), intent(in) :: table !! faces of all elements
    integer, intent(in)  :: corner(:)       !! (n_dim)  nodes in any order
    integer, intent(out) :: element         !!          element, 0 if no face has these corners
    integer, intent(out) :: face            !!          local node opposite

    integer :: i

    element = 0
    face = 0
    i = find_column(table%key, table%order, sorted_small(corner))
    if (i == 0) return
    i = table%order(i) - 1
    element = i/(size(table%key, 1) + 1) + 1
    face = mod(i, size(table%key, 1) + 1) + 1
  end subroutine find_face

  !> Neighbours across faces. A face of more than two elements is reported, its first two matched.
  pure subroutine match_faces(table, neighbour, crowded)
    type(face_table_t), intent(in) :: table  !! faces of all elements
    integer, intent(out) :: neighbour(:, :)  !! (n_dim+1, n_el)  element behind a face, 0 outside
    integer, intent(out) :: crowded          !! third element of a shared face, 0 if there is none

    integer :: element_1, element_2, face_1, face_2, i, n_corner

    n_corner = size(neighbour, 1)
    neighbour = 0
    crowded = 0
    do i = 2, size(table%order)
      if (any(table%key(:, table%order(i)) /= table%key(:, table%order(i - 1)))) cycle
      element_1 = (table%order(i - 1) - 1)/n_corner + 1
      face_1 = mod(table%order(i - 1) - 1, n_corner) + 1
      element_2 = (table%order(i) - 1)/n_corner + 1
      face_2 = mod(table%order(i) - 1, n_corner) + 1
      if (neighbour(face_1, element_1) /= 0) then
        if (crowded == 0) crowded = element_2
        cycle
      end if
      neighbour(face_1, element_1) = element_2
      neighbour(face_2, element_2) = element_1
    end do
  end subroutine match_faces

end module mpm_face_table
