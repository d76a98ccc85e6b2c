!> Whether there is memory for a run, before it begins.
module mpm_run_memory
  use mpm_error, only: error_t, exit_solver, make_error
  use mpm_kinds, only: dp, ip
  use mpm_material_points, only: bytes_of_points
  use mpm_memory, only: has_room, megabytes
  use mpm_model, only: model_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: check_memory

contains

  !> Room for the arrays over points and elements that a run adds to its model: two more copies of
  !! points and mesh, the trial state, kinematics and sums of the elements. The tangent is not among
  !! them: it says so itself when it does not fit.
  subroutine check_memory(model, error)
    type(model_t), intent(in) :: model               !! complete
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    integer, parameter :: full_tensors = 2*9 + 4, sums = 6 + 36 + 1
    integer(ip) :: n_bytes
    integer :: gradients

    associate (n_dim => model%mesh%n_dim, n_el => model%mesh%n_el)
      gradients = n_dim*(n_dim + 1)
      n_bytes = 3_ip*bytes_of_points(model%points%n, n_dim) &
                + int(n_el, ip)*8*(2*(gradients + n_dim + 2) + full_tensors + gradients + sums)
      if (has_room(n_bytes)) return
      call make_error(error, exit_solver, "error: not enough memory for a run with "// &
                      integer_text(model%points%n)//" material points and "//integer_text(n_el)// &
                      " elements, about "//real_text(megabytes(real(n_bytes, dp)))// &
                      " MB more are needed: expected a coarser mesh or fewer points per element")
    end associate
  end subroutine check_memory

end module mpm_run_memory
