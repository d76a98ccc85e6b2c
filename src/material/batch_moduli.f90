!> Moduli of a batch of points from what is known of them in principal axes.
module mpm_batch_moduli
  use mpm_eigen_batch, only: batch_size, log_ratio_of_batch
  use mpm_kinds, only: dp
  use mpm_tensor, only: voigt_column, voigt_row
  implicit none
  private
  public :: make_dyads, principal_batch_t, spatial_moduli, sum_of_dyads, voigt_pair

  !> Place of the component (v, w) of symmetric moduli in their upper triangle, column by column.
  integer, parameter :: voigt_pair(6, 6) = reshape([ &
    1, 2, 4, 7, 11, 16, 2, 3, 5, 8, 12, 17, 4, 5, 6, 9, 13, 18, &
    7, 8, 9, 10, 14, 19, 11, 12, 13, 14, 15, 20, 16, 17, 18, 19, 20, 21], [6, 6])

  !> What is known in principal axes.
  type :: principal_batch_t
    real(dp) :: cg_m1(batch_size, 3)     !! eigenvalues of the trial b_e - 1 [-]
    real(dp) :: strain(batch_size, 3)    !! logarithmic strains; in trial, out elastic [-]
    real(dp) :: kirchhoff(batch_size, 3) !! stresses [force/length^2]
    real(dp) :: softening(batch_size)    !! 3 G flow over the trial sqrt(3 J2), 0 elastic [-]
    real(dp) :: along(batch_size)        !! factor of dev (x) dev in the moduli [force/length^2]
    real(dp) :: deviator(batch_size, 3)  !! of the trial strain [-]
    real(dp) :: dyad(batch_size, 6, 3)   !! n_i (x) n_i
  end type principal_batch_t

contains

  !> n_i (x) n_i in Voigt components.
  pure subroutine make_dyads(dyad, vector)
    real(dp), intent(out) :: dyad(batch_size, 6, 3)
    real(dp), intent(in)  :: vector(batch_size, 3, 3) !! eigenvector i of point l in (l, :, i)
    integer :: i, l, v

    do i = 1, 3
      do v = 1, 6
        do l = 1, batch_size
          dyad(l, v, i) = vector(l, voigt_row(v), i)*vector(l, voigt_column(v), i)
        end do
      end do
    end do
  end subroutine make_dyads

  !> Symmetric tensors with given eigenvalues: sum of value_i n_i (x) n_i.
  pure subroutine sum_of_dyads(voigt, value, dyad)
    real(dp), intent(out) :: voigt(batch_size, 6)
    real(dp), intent(in)  :: value(batch_size, 3)
    real(dp), intent(in)  :: dyad(batch_size, 6, 3)
    integer :: l, v

    do v = 1, 6
      do l = 1, batch_size
        voigt(l, v) = value(l, 1)*dyad(l, v, 1) + value(l, 2)*dyad(l, v, 2) &
                      + value(l, 3)*dyad(l, v, 3)
      end do
    end do
  end subroutine sum_of_dyads

  !> Moduli c of the Lie derivative of the Kirchhoff stress: sum over i, j of
  !! (d tau_i / d eps_j - 2 tau_i delta_ij) m_i (x) m_j and the shear moduli of the three planes.
  !! Source: theory.md (12); `mpm_hencky` is the reference.
  pure subroutine spatial_moduli(c, principal, vector, bulk, shear)
    real(dp), intent(out) :: c(batch_size, 21)           !! upper triangle, see voigt_pair
                                                         !! [force/length^2]
    type(principal_batch_t), intent(in) :: principal     !! complete
    real(dp), intent(in) :: vector(batch_size, 3, 3)     !! principal directions
    real(dp), intent(in) :: bulk(batch_size), shear(batch_size) !! K and G [force/length^2]
    real(dp) :: normal(batch_size, 6, 3), plane(batch_size, 6, 3), sheared(batch_size, 6, 3)
    integer  :: l, v, w

    call normal_part(normal, principal, bulk, shear)
    call shear_part(plane, sheared, principal, vector, shear)
    associate (m => principal%dyad)
      do w = 1, 6
        do v = 1, w
          do l = 1, batch_size
            c(l, voigt_pair(v, w)) = &
              (m(l, v, 1)*normal(l, w, 1) + m(l, v, 2)*normal(l, w, 2) + m(l, v, 3)*normal(l, w, 3)) &
              + (plane(l, v, 1)*sheared(l, w, 1) + plane(l, v, 2)*sheared(l, w, 2) &
                 + plane(l, v, 3)*sheared(l, w, 3))
          end do
        end do
      end do
    end associate
  end subroutine spatial_moduli

  !> sum over i of (d tau_i / d eps_j - 2 tau_i delta_ij) m_i.
  pure subroutine normal_part(normal, principal, bulk, shear)
    real(dp), intent(out) :: normal(batch_size, 6, 3)    !! (l, :, j)
    type(principal_batch_t), intent(in) :: principal     !! complete
    real(dp), intent(in) :: bulk(batch_size), shear(batch_size) !! K and G [force/length^2]
    real(dp) :: a(batch_size, 3, 3), common
    integer  :: i, j, l, v

    do j = 1, 3
      do i = 1, 3
        !$omp simd private(common)
        do l = 1, batch_size
          common = bulk(l) - 2.0_dp/3.0_dp*shear(l)*(1.0_dp - principal%softening(l))
          a(l, i, j) = common - principal%along(l)*principal%deviator(l, i)*principal%deviator(l, j)
        end do
      end do
      do l = 1, batch_size
        a(l, j, j) = a(l, j, j) + 2.0_dp*shear(l)*(1.0_dp - principal%softening(l)) &
                     - 2.0_dp*principal%kirchhoff(l, j)
      end do
    end do
    do j = 1, 3
      do v = 1, 6
        do l = 1, batch_size
          normal(l, v, j) = a(l, 1, j)*principal%dyad(l, v, 1) + a(l, 2, j)*principal%dyad(l, v, 2) &
                            + a(l, 3, j)*principal%dyad(l, v, 3)
        end do
      end do
    end do
  end subroutine normal_part

  !> Symmetric parts of n_i (x) n_j, and with the factor of their shear moduli.
  pure subroutine shear_part(plane, sheared, principal, vector, shear)
    real(dp), intent(out) :: plane(batch_size, 6, 3)     !! planes 12, 23, 13
    real(dp), intent(out) :: sheared(batch_size, 6, 3)   !! 4 times the modulus times plane
    type(principal_batch_t), intent(in) :: principal     !! complete
    real(dp), intent(in) :: vector(batch_size, 3, 3)     !! principal directions
    real(dp), intent(in) :: shear(batch_size)            !! G [force/length^2]
    integer, parameter :: first(3) = [1, 2, 1], second(3) = [2, 3, 3]
    real(dp) :: modulus(batch_size), x(batch_size)
    integer  :: i, j, k, l, v

    do k = 1, 3
      i = first(k)
      j = second(k)
      do l = 1, batch_size
        x(l) = (principal%cg_m1(l, i) - principal%cg_m1(l, j))/(1.0_dp + principal%cg_m1(l, j))
      end do
      call log_ratio_of_batch(modulus, x)
      do l = 1, batch_size
        modulus(l) = 4.0_dp*(shear(l)*(1.0_dp - principal%softening(l))*modulus(l) &
                             - principal%kirchhoff(l, j))
      end do
      do v = 1, 6
        do l = 1, batch_size
          plane(l, v, k) = 0.5_dp*(vector(l, voigt_row(v), i)*vector(l, voigt_column(v), j) &
                                   + vector(l, voigt_column(v), i)*vector(l, voigt_row(v), j))
          sheared(l, v, k) = modulus(l)*plane(l, v, k)
        end do
      end do
    end do
  end subroutine shear_part

end module mpm_batch_moduli
