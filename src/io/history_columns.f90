!> The columns of *HISTORY and their values after an increment.
module mpm_history_columns
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_model, only: history_of_point, history_request_t, model_t
  use mpm_patches, only: patches_t
  use mpm_point_fields, only: component_suffix, n_field_components, point_values
  use mpm_run_state, only: run_state_t
  implicit none
  private
  public :: history_column_t, history_columns, history_values, nodal_values

  !> One component of one quantity of a set of nodes or of one point.
  type :: history_column_t
    character(:), allocatable :: name     !! such as RF3[FOOTING]
    character(8) :: quantity = ""         !! deck name
    integer :: component = 1
    integer, allocatable :: node(:)       !! nodes of the set; empty: a point
    integer :: point = 0                  !! id of the point, 0: a set of nodes
  end type history_column_t

contains

  !> All columns that any step asks for, each once, in the order of the deck.
  pure function history_columns(model) result(columns)
    type(model_t), intent(in) :: model
    type(history_column_t), allocatable :: columns(:)
    integer :: i, j, q

    allocate (columns(0))
    do i = 1, size(model%step)
      if (.not. allocated(model%step(i)%history)) cycle
      do j = 1, size(model%step(i)%history)
        do q = 1, size(model%step(i)%history(j)%quantity)
          call add_columns(columns, model%step(i)%history(j), q, model%mesh%n_dim)
        end do
      end do
    end do
  end function history_columns

  !> Adds the components of one quantity of a request.
  pure subroutine add_columns(columns, request, q, n_dim)
    type(history_column_t), allocatable, intent(inout) :: columns(:) !! longer
    type(history_request_t), intent(in) :: request                   !! one *HISTORY
    integer, intent(in) :: q                                         !! number of the quantity
    integer, intent(in) :: n_dim                                     !! 2 or 3
    type(history_column_t) :: column
    integer :: component, n_components

    column%quantity = request%quantity(q)
    n_components = n_dim
    if (request%kind == history_of_point) then
      column%point = request%point
      if (column%quantity /= "U") n_components = n_field_components(trim(column%quantity))
      allocate (column%node(0))
    else
      column%node = request%node
    end if
    do component = 1, n_components
      column%component = component
      column%name = trim(column%quantity)//suffix_of(column)//"["//csv_word(request%label)//"]"
      call add_new_column(columns, column)
    end do
  end subroutine add_columns

  !> Adds a column unless there is one of that name.
  pure subroutine add_new_column(columns, column)
    type(history_column_t), allocatable, intent(inout) :: columns(:) !! perhaps longer
    type(history_column_t), intent(in) :: column                     !! candidate
    type(history_column_t), allocatable :: longer(:)
    integer :: i, n

    n = size(columns)
    do i = 1, n
      if (columns(i)%name == column%name) return
    end do
    allocate (longer(n + 1))
    longer(:n) = columns
    longer(n + 1) = column
    call move_alloc(longer, columns)
  end subroutine add_new_column

  !> What follows the quantity in the name of a column.
  pure function suffix_of(column) result(suffix)
    type(history_column_t), intent(in) :: column
    character(:), allocatable :: suffix

    if (column%point > 0) then
      suffix = component_suffix(trim(column%quantity), column%component)
    else
      suffix = achar(iachar("0") + column%component)
    end if
  end function suffix_of

  !> A label without commas, which separate the columns of the file.
  pure function csv_word(label) result(word)
    character(*), intent(in) :: label
    character(len(label)) :: word
    integer :: i

    do i = 1, len(label)
      word(i:i) = merge(" ", label(i:i), label(i:i) == ",")
    end do
  end function csv_word

  !> Values of all columns: sums over the set for forces, means for displacements.
  pure function history_values(columns, points, patches, state) result(values)
    type(history_column_t), intent(in) :: columns(:) !! what is asked for
    type(points_t), intent(in)    :: points          !! converged state
    type(patches_t), intent(in)   :: patches         !! patch of each element
    type(run_state_t), intent(in) :: state           !! nodal values
    real(dp) :: values(size(columns))
    real(dp) :: at_point(9)
    integer :: i

    do i = 1, size(columns)
      associate (column => columns(i))
        if (column%point > 0) then
          at_point = point_values(points, patches, trim(column%quantity), &
                                  points%place(column%point))
          values(i) = at_point(column%component)
        else
          values(i) = sum(nodal_values(state, column%quantity, column%component, column%node))
          if (column%quantity == "U") values(i) = values(i)/max(1, size(column%node))
        end if
      end associate
    end do
  end function history_values

  !> One component of a nodal quantity.
  pure function nodal_values(state, quantity, component, node) result(values)
    type(run_state_t), intent(in) :: state !! nodal values
    character(*), intent(in) :: quantity   !! RF, CF or U; another one gives 0
    integer, intent(in) :: component       !! 1..n_dim
    integer, intent(in) :: node(:)         !! nodes
    real(dp), allocatable :: values(:)     !! (size(node))

    allocate (values(size(node)))
    select case (quantity)
    case ("RF")
      values(:) = state%reaction(component, node)
    case ("CF")
      values(:) = state%applied(component, node)
    case ("U")
      values(:) = state%node_u(component, node)
    case default
      values(:) = 0.0_dp
    end select
  end function nodal_values

end module mpm_history_columns
