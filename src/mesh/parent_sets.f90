!> Sets of parents and of surface carriers, expanded to linear elements and faces.
module mpm_parent_sets
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_face_table, only: build_face_table, corners_of_face, face_table_t, find_face
  use mpm_index_sort, only: sort_columns, unique_sorted
  use mpm_mesh, only: face_set_t, find_node_set, index_set_t, mesh_t, surface_nodes
  use mpm_parent_mesh, only: parent_edge, parent_mesh_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: expand_sets

contains

  !> Fills node sets, element sets and surfaces of the linear mesh. A carrier set becomes a surface
  !! and a node set of its name, an element set also a node set, unless one of that name exists.
  pure subroutine expand_sets(parent, mesh, error)
    type(parent_mesh_t), intent(in) :: parent        !! mesh as read or generated
    type(mesh_t), intent(inout)     :: mesh          !! linear mesh, in elements, out sets
    type(error_t), allocatable, intent(out) :: error !! a carrier that is no face

    integer, allocatable :: element(:), face(:)
    integer :: i, n_surface

    allocate (mesh%node_set(0), mesh%element_set(0))
    if (allocated(parent%node_set)) mesh%node_set = parent%node_set
    call expand_element_sets(parent, mesh)
    call locate_carriers(parent, element, face, error)
    if (allocated(error)) return
    n_surface = 0
    if (allocated(parent%surface)) n_surface = size(parent%surface)
    i = 0
    if (allocated(parent%carrier_set)) i = size(parent%carrier_set)
    allocate (mesh%surface(n_surface + i))
    do i = 1, n_surface
      associate (from => parent%surface(i))
        call expand_faces(parent, mesh, from%element, from%face, mesh%surface(i))
        mesh%surface(i)%name = from%name
      end associate
    end do
    do i = 1, size(mesh%surface) - n_surface
      associate (from => parent%carrier_set(i), to => mesh%surface(n_surface + i))
        call expand_faces(parent, mesh, element(from%item), face(from%item), to)
        to%name = from%name
        call add_node_set(mesh, from%name, surface_nodes(mesh, to))
      end associate
    end do
  end subroutine expand_sets

  !> Element sets of parents become sets of linear elements, and node sets.
  pure subroutine expand_element_sets(parent, mesh)
    type(parent_mesh_t), intent(in) :: parent !! mesh as read or generated
    type(mesh_t), intent(inout)     :: mesh   !! linear mesh, out element sets and their node sets

    integer :: c, i, j

    if (.not. allocated(parent%element_set)) return
    deallocate (mesh%element_set)
    allocate (mesh%element_set(size(parent%element_set)))
    do i = 1, size(parent%element_set)
      associate (from => parent%element_set(i), to => mesh%element_set(i))
        to%name = from%name
        to%item = [((c, c=mesh%parent_child_1(from%item(j)), &
          mesh%parent_child_1(from%item(j) + 1) - 1), j=1, size(from%item))]
        call add_node_set(mesh, from%name, unique_sorted( &
          reshape(parent%node(:, from%item), [size(parent%node, 1)*size(from%item)]), mesh%n_node))
      end associate
    end do
  end subroutine expand_element_sets

  !> Adds a node set unless there is one of that name.
  pure subroutine add_node_set(mesh, name, item)
    type(mesh_t), intent(inout) :: mesh    !! mesh, out one set more
    character(*), intent(in)    :: name    !! name
    integer, intent(in)         :: item(:) !! (n)  nodes, ascending, each once

    type(index_set_t), allocatable :: longer(:)
    integer :: n

    if (find_node_set(mesh, name) > 0) return
    n = size(mesh%node_set)
    allocate (longer(n + 1))
    longer(:n) = mesh%node_set
    longer(n + 1)%name = name
    longer(n + 1)%item = item
    call move_alloc(longer, mesh%node_set)
  end subroutine add_node_set

  !> The parent face of each carrier; of two parents that share it the first.
  pure subroutine locate_carriers(parent, element, face, error)
    type(parent_mesh_t), intent(in)   :: parent      !! mesh as read or generated
    integer, allocatable, intent(out) :: element(:)  !! (n_carrier)  parents
    integer, allocatable, intent(out) :: face(:)     !! (n_carrier)  local nodes opposite
    type(error_t), allocatable, intent(out) :: error !! a carrier that is no face

    type(face_table_t) :: table
    integer :: i, n

    n = 0
    if (allocated(parent%carrier)) n = size(parent%carrier, 2)
    allocate (element(n), face(n))
    if (n == 0) return
    call build_face_table(table, parent%node(:parent%n_dim + 1, :), parent%n_node)
    do i = 1, n
      call find_face(table, parent%carrier(:, i), element(i), face(i))
      if (element(i) > 0) cycle
      call make_error(error, exit_model, carrier_text(parent, i)//": expected a face of an element")
      return
    end do
  end subroutine locate_carriers

  !> A carrier as messages call it: its corner nodes, and the set that it belongs to.
  pure function carrier_text(parent, carrier) result(text)
    type(parent_mesh_t), intent(in) :: parent  !! mesh
    integer, intent(in)             :: carrier !! index of the carrier
    character(:), allocatable       :: text    !! such as "surface carrier of nodes 1 4 of set TOP"

    integer :: i

    text = "surface carrier of nodes"
    do i = 1, parent%n_dim
      associate (node => parent%carrier(i, carrier))
        if (node >= 1 .and. node <= parent%n_node) then
          text = text//" "//integer_text(parent%node_label(node))
        else
          text = text//" (undefined)"
        end if
      end associate
    end do
    if (.not. allocated(parent%carrier_set)) return
    do i = 1, size(parent%carrier_set)
      if (all(parent%carrier_set(i)%item /= carrier)) cycle
      text = text//" of set "//parent%carrier_set(i)%name
      return
    end do
  end function carrier_text

  !> Parent faces become linear faces, each once, ascending.
  pure subroutine expand_faces(parent, mesh, element, face, faces)
    type(parent_mesh_t), intent(in)  :: parent     !! mesh as read or generated
    type(mesh_t), intent(in)         :: mesh       !! linear mesh
    integer, intent(in)              :: element(:) !! (n)  parents
    integer, intent(in)              :: face(:)    !! (n)  local nodes opposite
    type(face_set_t), intent(out)    :: faces      !! linear faces, without name

    integer, allocatable :: pair(:, :), order(:)
    logical, allocatable :: new(:)
    integer :: i, n_part

    n_part = 1
    if (parent%order == 2) n_part = 2**(parent%n_dim - 1)
    allocate (pair(2, n_part*size(element)))
    do i = 1, size(element)
      pair(:, n_part*(i - 1) + 1:n_part*i) = face_parts(parent, mesh, element(i), face(i), n_part)
    end do
    call sort_columns(pair, mesh%n_el + mesh%n_dim, order)
    pair = pair(:, order)
    allocate (new(size(order)), source=.true.)
    do i = 2, size(order)
      new(i) = any(pair(:, i) /= pair(:, i - 1))
    end do
    faces%element = pack(pair(1, :), new)
    faces%face = pack(pair(2, :), new)
  end subroutine expand_faces

  !> Linear faces of one parent face: child b at corner b has a part of every face of its parent
  !! that meets that corner, under the same local number; the middle triangle is searched.
  pure function face_parts(parent, mesh, p, face, n_part) result(pair)
    type(parent_mesh_t), intent(in) :: parent !! mesh as read or generated
    type(mesh_t), intent(in)        :: mesh   !! linear mesh
    integer, intent(in)             :: p      !! parent
    integer, intent(in)             :: face   !! local node opposite
    integer, intent(in)             :: n_part !! linear faces: 1, 2 or 4
    integer :: pair(2, n_part)                !! (2, n_part)  element, local face

    integer :: b, child, corner(parent%n_dim), i, mid(3)

    associate (first => mesh%parent_child_1(p))
      if (n_part == 1) then
        pair(:, 1) = [first, face]
        return
      end if
      corner = corners_of_face([(b, b=1, parent%n_dim + 1)], face)
      do i = 1, parent%n_dim
        pair(:, i) = [first - 1 + corner(i), face]
      end do
      if (parent%n_dim == 2) return
      mid = pack(parent%node(5:10, p), [(all(parent_edge(:, i) /= face), i=1, 6)])
      do child = first + 4, first + 7
        do b = 1, 4
          if (same_nodes(corners_of_face(mesh%node(:, child), b), mid)) pair(:, 4) = [child, b]
        end do
      end do
    end associate
  end function face_parts

  !> Whether two lists of different nodes hold the same ones.
  pure logical function same_nodes(a, b) result(same)
    integer, intent(in) :: a(:) !! (m)  nodes
    integer, intent(in) :: b(:) !! (m)  nodes

    integer :: i

    same = all([(any(a == b(i)), i=1, size(b))])
  end function same_nodes

end module mpm_parent_sets
