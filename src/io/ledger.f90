!> The ledger of material points: nothing may get lost unseen.
module mpm_ledger
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t, status_extrapolated, status_frozen, status_removed
  implicit none
  private
  public :: ledger_t, point_ledger

  !> Sums over all points that were not removed.
  type :: ledger_t
    integer  :: n_points = 0       !! points
    real(dp) :: mass = 0.0_dp      !! [mass]
    real(dp) :: volume = 0.0_dp    !! [length^n_dim]
    real(dp) :: centre(3) = 0.0_dp !! centre of mass, of volume if there is no mass [length]
    integer  :: n_lost = 0         !! frozen and removed points
    integer  :: n_extrapolated = 0 !! points just outside the mesh
  end type ledger_t

contains

  !> Counts and sums.
  pure function point_ledger(points) result(ledger)
    type(points_t), intent(in) :: points !! converged state
    type(ledger_t) :: ledger
    real(dp) :: moment_of_mass(3), moment_of_volume(3)
    integer :: n_dim, p

    n_dim = size(points%x, 1)
    moment_of_mass = 0.0_dp
    moment_of_volume = 0.0_dp
    do p = 1, points%n
      if (points%status(p) == status_removed) cycle
      ledger%n_points = ledger%n_points + 1
      ledger%mass = ledger%mass + points%mass(p)
      ledger%volume = ledger%volume + points%volume(p)
      moment_of_mass(:n_dim) = moment_of_mass(:n_dim) + points%mass(p)*points%x(:, p)
      moment_of_volume(:n_dim) = moment_of_volume(:n_dim) + points%volume(p)*points%x(:, p)
    end do
    ledger%n_lost = count(points%status == status_frozen .or. points%status == status_removed)
    ledger%n_extrapolated = count(points%status == status_extrapolated)
    if (ledger%mass > 0.0_dp) then
      ledger%centre = moment_of_mass/ledger%mass
    else if (ledger%volume > 0.0_dp) then
      ledger%centre = moment_of_volume/ledger%volume
    end if
  end function point_ledger

end module mpm_ledger
