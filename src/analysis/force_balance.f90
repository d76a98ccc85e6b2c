!> Balance of forces: what the supports give against what the body is loaded with.
module mpm_force_balance
  use mpm_kinds, only: dp
  implicit none
  private
  public :: force_imbalance, smallest_force

contains

  !> Resultant of all reactions and loads over the sum of their sizes, node by node. It does not
  !! depend on the axes, nor on a part of the forces that is in balance by itself.
  !! Source: theory.md (15e).
  pure function force_imbalance(reaction, applied, smallest) result(imbalance)
    real(dp), intent(in) :: reaction(:, :) !! (n_dim, n_node)  along the global axes [force]
    real(dp), intent(in) :: applied(:, :)  !! (n_dim, n_node)  along the global axes [force]
    real(dp), intent(in) :: smallest       !! sum of sizes below which all is rounding [force]
    real(dp) :: imbalance                  !! [-], 0 where there are no forces
    real(dp) :: resultant(size(reaction, 1)), total
    integer  :: a

    resultant = 0.0_dp
    total = 0.0_dp
    do a = 1, size(reaction, 2)
      resultant = resultant + (reaction(:, a) + applied(:, a))
      total = total + (norm2(reaction(:, a)) + norm2(applied(:, a)))
    end do
    imbalance = norm2(resultant)
    if (imbalance > 0.0_dp) then
      imbalance = imbalance/max(total, smallest, tiny(1.0_dp)/epsilon(1.0_dp), imbalance*1.0e-30_dp)
    end if
  end function force_imbalance

  !> A millionth of stiffness times displacement: a body that moves without stress has no other
  !! forces than rounding errors. Source: theory.md (15).
  pure function smallest_force(tangent, u) result(force)
    real(dp), intent(in) :: tangent(:) !! entries of the tangent [force/length]
    real(dp), intent(in) :: u(:, :)    !! (n_dim, n_node)  displacement of the increment [length]
    real(dp) :: force                  !! [force]

    force = 0.0_dp
    if (size(tangent) > 0) force = 1.0e-6_dp*maxval(abs(tangent))*maxval(abs(u))
  end function smallest_force

end module mpm_force_balance
