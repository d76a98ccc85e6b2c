!> What a caller does between two iterations of Newton's method, which may take long.
!!
!! A type and not a plain procedure, because the procedure needs data of the caller that the
!! analysis must not know.
module mpm_iteration_watch
  implicit none
  private
  public :: iteration_watch_t

  !> Is told of every iteration after which the residual is too large.
  type, abstract :: iteration_watch_t
  contains
    procedure(note_iteration), deferred :: note_iteration
  end type iteration_watch_t

  abstract interface
    !> An iteration is done that is not the end of the increment.
    subroutine note_iteration(watch)
      import :: iteration_watch_t
      implicit none
      class(iteration_watch_t), intent(inout) :: watch
    end subroutine note_iteration
  end interface

end module mpm_iteration_watch
