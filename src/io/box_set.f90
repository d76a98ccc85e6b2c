!> Nodes and elements inside a box: *NSET, BOX and *ELSET, BOX.
module mpm_box_set
  use mpm_build_context, only: at_field, build_context_t, fault
  use mpm_deck_card, only: deck_line_t, deck_t, field_count, field_real
  use mpm_index_list, only: append_items, index_list_t
  use mpm_kinds, only: dp
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: add_elements_in_box, add_nodes_in_box

  real(dp), parameter :: slack = 1.0e-9_dp !! distance outside that counts, over mesh size

contains

  !> Adds the nodes in the closed box of a line.
  subroutine add_nodes_in_box(list, parent, deck, context, at)
    type(index_list_t), intent(inout) :: list       !! more nodes
    type(parent_mesh_t), intent(in) :: parent       !! mesh of the user
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line

    call add_points_in_box(list, parent%x, parent, deck, context, at)
  end subroutine add_nodes_in_box

  !> Adds the elements whose centroid lies in the closed box of a line.
  subroutine add_elements_in_box(list, parent, deck, context, at)
    type(index_list_t), intent(inout) :: list       !! more elements
    type(parent_mesh_t), intent(in) :: parent       !! mesh of the user
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    real(dp) :: centroid(parent%n_dim, parent%n_el)
    integer :: e

    do e = 1, parent%n_el
      centroid(:, e) = sum(parent%x(:, parent%node(:parent%n_dim + 1, e)), dim=2) &
                       /real(parent%n_dim + 1, dp)
    end do
    call add_points_in_box(list, centroid, parent, deck, context, at)
  end subroutine add_elements_in_box

  !> Adds the numbers of the points in the box of a line. A box without any is an error.
  subroutine add_points_in_box(list, x, parent, deck, context, at)
    type(index_list_t), intent(inout) :: list       !! more points
    real(dp), intent(in) :: x(:, :)                 !! (n_dim, n)  points [length]
    type(parent_mesh_t), intent(in) :: parent       !! mesh of the user
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    real(dp) :: box(2, parent%n_dim), tolerance
    integer :: i, n_before

    n_before = context%diag%n_errors
    call read_box(box, deck, context, at)
    if (context%diag%n_errors > n_before) return
    tolerance = slack*maxval(maxval(parent%x, dim=2) - minval(parent%x, dim=2))
    n_before = list%n
    do i = 1, size(x, 2)
      if (all(x(:, i) >= box(1, :) - tolerance .and. x(:, i) <= box(2, :) + tolerance)) then
        call append_items(list, [i])
      end if
    end do
    if (list%n == n_before) call fault(context, deck, at_field(at(1), at(2), 0), "nothing lies " &
      & //"in this box: expected one that holds nodes, or centroids of elements")
  end subroutine add_points_in_box

  !> Limits of the box of a line: from and to of x, y and, in 3-D, z.
  subroutine read_box(box, deck, context, at)
    real(dp), intent(out) :: box(:, :)              !! (2, n_dim)  lower and upper limits [length]
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    integer, intent(in) :: at(2)                    !! (2) card and data line
    integer :: i, n

    n = 2*size(box, 2)
    box = 0.0_dp
    associate (line => deck%card(at(1))%data(at(2)))
      if (field_count(line) /= n) then
        call fault(context, deck, at_field(at(1), at(2), 0), integer_text(field_count(line)) &
          & //" limits of a box in a mesh of "//integer_text(size(box, 2))//" dimensions: " &
          & //"expected "//integer_text(n)//", from and to of every axis")
        return
      end if
      do i = 1, size(box, 2)
        box(:, i) = limits(line, i)
        if (box(2, i) < box(1, i)) call fault(context, deck, at_field(at(1), at(2), 2*i), &
          & "the box ends at "//real_text(box(2, i))//" before it starts: expected at least " &
          & //real_text(box(1, i)))
      end do
    end associate
  end subroutine read_box

  !> From and to of an axis.
  pure function limits(line, axis) result(range)
    type(deck_line_t), intent(in) :: line !! data line
    integer, intent(in) :: axis           !! 1..n_dim
    real(dp) :: range(2)                  !! [length]

    range = [field_real(line, 2*axis - 1), field_real(line, 2*axis)]
  end function limits

end module mpm_box_set
