!> The mesh of the user with the numbers that the deck may use for its nodes and elements.
module mpm_labelled_mesh
  use mpm_label_table, only: build_label_table, label_table_t
  use mpm_mesh, only: face_set_t, index_set_t
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_text, only: same_name
  implicit none
  private
  public :: labelled_mesh_t, label_parents, find_set, add_set, add_surface, marked_items
  public :: body_element, carrier_element, edge_element

  integer, parameter :: body_element = 1    !! holds material: triangle in 2-D, tetrahedron in 3-D
  integer, parameter :: carrier_element = 2 !! face of the body: edge in 2-D, triangle in 3-D
  integer, parameter :: edge_element = 3    !! edge in 3-D: stands for its nodes only

  !> Mesh with numbers.
  type :: labelled_mesh_t
    type(parent_mesh_t) :: parent
    type(label_table_t) :: node_table     !! nodes by number
    type(label_table_t) :: element_table  !! elements of all kinds by number
    integer, allocatable :: kind(:)       !! (n_item) body_element, carrier_element or edge_element
    integer, allocatable :: item(:)       !! (n_item) index among the elements of its kind
    integer, allocatable :: new_node(:)   !! (n)  node of the mesh, 0 if the body does not use it
    integer, allocatable :: carrier_node(:, :) !! (6, n_carrier)  all nodes, 0 beyond the last
    integer, allocatable :: edge_node(:, :)    !! (6, n_edge)     all nodes, 0 beyond the last
  end type labelled_mesh_t

contains

  !> Numbers of a mesh that did not come from *NODE and *ELEMENT.
  pure subroutine label_parents(mesh)
    type(labelled_mesh_t), intent(inout) :: mesh !! parent in, tables out
    integer :: duplicate, i

    call build_label_table(mesh%node_table, mesh%parent%node_label, duplicate)
    call build_label_table(mesh%element_table, mesh%parent%element_label, duplicate)
    allocate (mesh%kind(mesh%parent%n_el), source=body_element)
    mesh%item = [(i, i=1, mesh%parent%n_el)]
    mesh%new_node = [(i, i=1, mesh%parent%n_node)]
    allocate (mesh%carrier_node(6, 0), mesh%edge_node(6, 0))
    if (allocated(mesh%parent%carrier)) then
      deallocate (mesh%carrier_node)
      allocate (mesh%carrier_node(6, size(mesh%parent%carrier, 2)), source=0)
      mesh%carrier_node(:mesh%parent%n_dim, :) = mesh%parent%carrier
    else
      allocate (mesh%parent%carrier(mesh%parent%n_dim, 0))
    end if
    if (.not. allocated(mesh%parent%node_set)) allocate (mesh%parent%node_set(0))
    if (.not. allocated(mesh%parent%element_set)) allocate (mesh%parent%element_set(0))
    if (.not. allocated(mesh%parent%carrier_set)) allocate (mesh%parent%carrier_set(0))
    if (.not. allocated(mesh%parent%surface)) allocate (mesh%parent%surface(0))
  end subroutine label_parents

  !> Position of a set in a list, 0 if there is none of that name.
  pure integer function find_set(set, name) result(found)
    type(index_set_t), intent(in) :: set(:) !! (n)
    character(*), intent(in) :: name        !! any case

    do found = size(set), 1, -1
      if (same_name(set(found)%name, name)) return
    end do
  end function find_set

  !> Appends a set, or joins the items with those of the set that has this name already.
  pure subroutine add_set(set, name, item)
    type(index_set_t), allocatable, intent(inout) :: set(:) !! one set more, or a longer one
    character(*), intent(in) :: name                        !! its name
    integer, intent(in) :: item(:)                          !! (n) in any order, may repeat
    type(index_set_t), allocatable :: longer(:)
    integer :: i, found

    found = find_set(set, name)
    if (found > 0) then
      set(found)%item = marked_items([set(found)%item, item])
      return
    end if
    allocate (longer(size(set) + 1))
    do i = 1, size(set)
      call move_alloc(set(i)%name, longer(i)%name)
      call move_alloc(set(i)%item, longer(i)%item)
    end do
    longer(size(longer))%name = name
    longer(size(longer))%item = marked_items(item)
    call move_alloc(longer, set)
  end subroutine add_set

  !> Appends a surface.
  pure subroutine add_surface(surface, name, element, face)
    type(face_set_t), allocatable, intent(inout) :: surface(:) !! one surface more
    character(*), intent(in) :: name                           !! its name
    integer, intent(in) :: element(:)                          !! (n) elements
    integer, intent(in) :: face(:)                             !! (n) local faces
    type(face_set_t), allocatable :: longer(:)
    integer :: n

    n = size(surface)
    allocate (longer(n + 1))
    longer(:n) = surface
    longer(n + 1)%name = name
    longer(n + 1)%element = element
    longer(n + 1)%face = face
    call move_alloc(longer, surface)
  end subroutine add_surface

  !> The different positive numbers of a list, ascending.
  pure function marked_items(list) result(item)
    integer, intent(in) :: list(:)  !! (m) in any order, may repeat
    integer, allocatable :: item(:) !! (n) ascending, unique
    logical, allocatable :: marked(:)
    integer :: i

    allocate (marked(maxval([0, list])), source=.false.)
    do i = 1, size(list)
      if (list(i) > 0) marked(list(i)) = .true.
    end do
    item = pack([(i, i=1, size(marked))], marked)
  end function marked_items

end module mpm_labelled_mesh
