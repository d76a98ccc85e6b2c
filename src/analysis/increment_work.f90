!> Work of an increment, for measures that must not vanish when the load does.
module mpm_increment_work
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_tensor, only: tensor_from_voigt
  implicit none
  private
  public :: reference_work

  real(dp), parameter :: of_stress = 0.05_dp !! part of the work of the stress that counts [-]

contains

  !> Work of an increment that the penalty is compared with: of the forces at its end, but at
  !! least half of that of the forces at its start and a part of that of the stress, counted
  !! without sign. It does not vanish when the load returns to zero or a driven plane rests.
  !! Source: theory.md (18d), (18e).
  pure function reference_work(at_start, at_end, points, disp_grad_bar) result(work)
    real(dp), intent(in) :: at_start               !! of loads and reactions there [force length]
    real(dp), intent(in) :: at_end                 !! of loads and reactions there [force length]
    type(points_t), intent(in) :: points           !! converged, at the start of the increment
    real(dp), intent(in) :: disp_grad_bar(:, :, :) !! (3, 3, n_el)  dFbar - I of the increment [-]
    real(dp) :: work                               !! >= 0 [force length]
    real(dp) :: within
    integer  :: p

    within = 0.0_dp
    do p = 1, points%n
      if (points%element(p) == 0) cycle
      within = within + points%volume(p)*abs(sum(tensor_from_voigt(points%state%cauchy(:, p)) &
                                                 *disp_grad_bar(:, :, points%element(p))))
    end do
    work = max(abs(at_end), 0.5_dp*abs(at_start), of_stress*within)
  end function reference_work

end module mpm_increment_work
