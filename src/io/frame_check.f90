!> Whether the axes of *TRANSFORM are used.
module mpm_frame_check
  use mpm_build_context, only: at_parameter, build_context_t, fault
  use mpm_deck_card, only: deck_t, parameter_text
  use mpm_diagnostics, only: warning_at_keyword
  use mpm_external_force, only: load_nodal
  use mpm_mesh, only: find_node_set
  use mpm_model, only: model_t
  implicit none
  private
  public :: check_frames_used

contains

  !> Axes that no condition refers to do nothing: an error, a warning when lax.
  subroutine check_frames_used(model, deck, context)
    type(model_t), intent(in) :: model              !! complete
    type(deck_t), intent(in) :: deck                !! the deck
    type(build_context_t), intent(inout) :: context !! takes errors
    character(*), parameter :: what = "no *BOUNDARY and no *CLOAD refers to the axes of these nodes"
    logical :: used(model%mesh%n_node)
    integer :: i, found

    used = conditioned_nodes(model)
    do i = 1, size(deck%card)
      if (deck%card(i)%keyword /= "TRANSFORM") cycle
      found = find_node_set(model%mesh, parameter_text(deck%card(i), "NSET", ""))
      if (any(used(model%mesh%node_set(found)%item))) cycle
      if (context%lax) then
        call warning_at_keyword(context%diag, deck, i, what)
      else
        call fault(context, deck, at_parameter(i, "NSET"), what//": expected one, or --lax on the " &
                   //"command line")
      end if
    end do
  end subroutine check_frames_used

  !> Nodes with a prescribed displacement or a nodal force in some step.
  pure function conditioned_nodes(model) result(used)
    type(model_t), intent(in) :: model    !! complete
    logical :: used(model%mesh%n_node)    !! (n_node)
    integer :: i, j

    used = .false.
    do i = 1, size(model%step)
      do j = 1, size(model%step(i)%constraint)
        used(model%step(i)%constraint(j)%node) = .true.
      end do
      do j = 1, size(model%step(i)%load)
        if (model%step(i)%load(j)%kind == load_nodal) used(model%step(i)%load(j)%item) = .true.
      end do
    end do
  end function conditioned_nodes

end module mpm_frame_check
