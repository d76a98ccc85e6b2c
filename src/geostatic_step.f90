!> The end of a *GEOSTATIC step: how far it has moved the body.
module mpm_geostatic_step
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_model, only: step_t
  use mpm_point_update, only: find_largest_move
  use mpm_run_log, only: log_message, run_log_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: report_move

contains

  !> Writes the largest displacement of a point in the step into the log, and refuses one above the
  !! UTOL of the deck. Steps of other kinds are left alone. Source: theory.md 16.
  subroutine report_move(log, step, points, u_start, error)
    type(run_log_t), intent(in) :: log               !! open
    type(step_t), intent(in)    :: step              !! at its end
    type(points_t), intent(in)  :: points            !! converged
    real(dp), intent(in)        :: u_start(:, :)     !! (n_dim, n)  displacements at the start
    type(error_t), allocatable, intent(out) :: error !! moved too far, or exit_file
    real(dp) :: distance
    integer  :: point

    if (.not. step%geostatic) return
    call find_largest_move(point, distance, points, u_start)
    call log_message(log, "step "//step%name//": largest displacement of a material point "// &
                     real_text(distance)//", point "//integer_text(point), error)
    if (allocated(error)) return
    if (step%largest_move <= 0.0_dp .or. distance <= step%largest_move) return
    call make_error(error, exit_model, "error: material point "//integer_text(point)// &
                    " moved by "//real_text(distance)//" in the *GEOSTATIC step '"//step%name// &
                    "': expected at most UTOL="//real_text(step%largest_move)// &
                    ", which needs an initial stress in equilibrium with the loads")
  end subroutine report_move

end module mpm_geostatic_step
