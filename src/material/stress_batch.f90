!> Stress update of a batch of points, the fast twin of `update_stress`: the same formulas without a
!! branch on material or state inside the loops over points.
module mpm_stress_batch
  use mpm_batch_moduli, only: make_dyads, principal_batch_t, spatial_moduli, sum_of_dyads, &
    voigt_pair
  use mpm_eigen_batch, only: batch_size, eigen_of_batch, expm1_of_batch, log1p_of_batch
  use mpm_kinds, only: dp
  use mpm_material, only: bulk_modulus, law_von_mises, material_t, shear_modulus, yield_stress_at
  use mpm_tensor, only: voigt_column, voigt_index, voigt_row
  use mpm_von_mises, only: plastic_flow, yield_tolerance
  implicit none
  private
  public :: accept_batch, batch_size, put_point, set_material, stress_batch_t, update_batch
  public :: voigt_pair

  real(dp), parameter :: no_limit = 0.25_dp*huge(1.0_dp) !! strength of an elastic material
  real(dp), parameter :: largest = 1.0e25_dp             !! beyond it nothing is a state [-]

  !> Points side by side; Voigt order 11, 22, 33, 12, 23, 13, tensor components. All entries must be
  !! numbers, also those of points that are not there.
  type :: stress_batch_t
    real(dp) :: disp_grad_bar(batch_size, 3, 3) = 0.0_dp !! dFbar - I [-]
    real(dp) :: cg_e_m1(batch_size, 6) = 0.0_dp      !! b_e - 1; in converged, out trial or new [-]
    real(dp) :: plastic_strain(batch_size) = 0.0_dp  !! accumulated; in converged, out new [-]
    real(dp) :: bulk(batch_size) = 1.0_dp            !! K [force/length^2]
    real(dp) :: shear(batch_size) = 1.0_dp           !! G [force/length^2]
    real(dp) :: strength(batch_size) = no_limit      !! sqrt(3 J2) at yield, at the strain so far
    real(dp) :: slope(batch_size) = 0.0_dp           !! of the hardening there [force/length^2]
    real(dp) :: segment_end(batch_size) = no_limit   !! strain up to which the slope holds [-]
    real(dp) :: kirchhoff(batch_size, 6) = 0.0_dp    !! out: stress [force/length^2]
    real(dp) :: moduli(batch_size, 21) = 0.0_dp      !! out: c of theory.md (12), its upper triangle
                                                     !! by columns, see voigt_pair [force/length^2]
    logical  :: flows(batch_size) = .false.          !! out: plastic flow in this update
    logical  :: failed(batch_size) = .false.         !! out: trial b_e not positive definite or no
                                                     !! number; the other results mean nothing
    integer  :: material(batch_size) = 0             !! index of the material, one number for one
                                                     !! material in all uses of a batch
  end type stress_batch_t

contains

  !> Constants of a material at one place of a batch; moduli only when it is another than before.
  pure subroutine set_material(batch, place, index, material)
    type(stress_batch_t), intent(inout) :: batch !! plastic_strain is set there
    integer, intent(in) :: place                 !! 1..batch_size
    integer, intent(in) :: index                 !! of the material
    type(material_t), intent(in) :: material

    if (batch%material(place) /= index) then ! mostly the point before was of the same
      batch%material(place) = index
      batch%bulk(place) = bulk_modulus(material)
      batch%shear(place) = shear_modulus(material)
    end if
    if (material%law == law_von_mises) then
      call yield_stress_at(material, batch%plastic_strain(place), batch%strength(place), &
                           batch%slope(place), batch%segment_end(place))
    else
      batch%strength(place) = no_limit
      batch%slope(place) = 0.0_dp
      batch%segment_end(place) = no_limit
    end if
  end subroutine set_material

  !> Stresses at a trial motion, and spatial moduli if they are asked for.
  !! Source: theory.md (6)-(8), (12); `update_stress` is the reference.
  pure subroutine update_batch(batch, materials, with_moduli)
    type(stress_batch_t), intent(inout) :: batch !! cg_e_m1 out: the trial one
    type(material_t), intent(in) :: materials(:) !! of the points
    logical, intent(in) :: with_moduli           !! .false.: moduli keep what they were
    type(principal_batch_t) :: principal
    real(dp) :: vector(batch_size, 3, 3)

    call return_points(batch, principal, vector, materials)
    if (with_moduli) call spatial_moduli(batch%moduli, principal, vector, batch%bulk, batch%shear)
  end subroutine update_batch

  !> The states that a motion ends in, to the last bit those whose stresses `update_batch` gives.
  pure subroutine accept_batch(strain, batch, materials)
    real(dp), intent(out) :: strain(batch_size, 6) !! elastic logarithmic strain [-]
    type(stress_batch_t), intent(inout) :: batch   !! cg_e_m1 out: the new one
    type(material_t), intent(in) :: materials(:)   !! of the points
    type(principal_batch_t) :: principal
    real(dp) :: vector(batch_size, 3, 3)

    call return_points(batch, principal, vector, materials)
    call sum_of_dyads(strain, principal%strain, principal%dyad)
    if (any(batch%flows)) call relax_stretches(batch, principal)
  end subroutine accept_batch

  !> Trial state by push-forward, return mapping in principal axes, stresses.
  pure subroutine return_points(batch, principal, vector, materials)
    type(stress_batch_t), intent(inout)  :: batch     !! cg_e_m1 out: the trial one
    type(principal_batch_t), intent(out) :: principal !! complete
    real(dp), intent(out) :: vector(batch_size, 3, 3) !! principal directions
    type(material_t), intent(in) :: materials(:)

    call push_forward(batch%cg_e_m1, batch%disp_grad_bar)
    call eigen_of_batch(principal%cg_m1, vector, batch%cg_e_m1)
    call check_stretches(batch, principal%cg_m1)
    call take_logarithms(principal%strain, principal%cg_m1)
    call return_radially(batch, principal, materials)
    call make_dyads(principal%dyad, vector)
    call sum_of_dyads(batch%kirchhoff, principal%kirchhoff, principal%dyad)
  end subroutine return_points

  !> Puts a point into a batch; one whose motion cannot be that of a body has failed already.
  pure subroutine put_point(batch, place, disp_grad_bar, cg_e_m1, plastic_strain)
    type(stress_batch_t), intent(inout) :: batch
    integer, intent(in)  :: place               !! 1..batch_size
    real(dp), intent(in) :: disp_grad_bar(3, 3) !! dFbar - I [-]
    real(dp), intent(in) :: cg_e_m1(6)          !! converged b_e - 1 [-]
    real(dp), intent(in) :: plastic_strain      !! converged, accumulated [-]

    batch%plastic_strain(place) = plastic_strain
    batch%failed(place) = .not. (all(abs(disp_grad_bar) < largest) .and. &
                                 all(abs(cg_e_m1) < largest))
    if (batch%failed(place)) then
      batch%disp_grad_bar(place, :, :) = 0.0_dp
      batch%cg_e_m1(place, :) = 0.0_dp
    else
      batch%disp_grad_bar(place, :, :) = disp_grad_bar
      batch%cg_e_m1(place, :) = cg_e_m1
    end if
  end subroutine put_point

  !> Trial b_e - 1 = (I + H)(I + C)(I + H)^T - I without forming 1 + small numbers.
  !! Source: theory.md (6).
  pure subroutine push_forward(c, h)
    real(dp), intent(inout) :: c(batch_size, 6) !! in converged, out trial b_e - 1 [-]
    real(dp), intent(in) :: h(batch_size, 3, 3) !! dFbar - I [-]
    real(dp) :: half(batch_size, 3, 3)
    integer :: i, j, l, v

    do j = 1, 3
      do i = 1, 3
        do l = 1, batch_size
          half(l, i, j) = c(l, voigt_index(i, j)) + (h(l, i, 1)*c(l, voigt_index(1, j)) &
                          + h(l, i, 2)*c(l, voigt_index(2, j)) + h(l, i, 3)*c(l, voigt_index(3, j)))
        end do
      end do
    end do
    do v = 1, 6
      i = voigt_row(v)
      j = voigt_column(v)
      do l = 1, batch_size
        c(l, v) = (h(l, i, j) + h(l, j, i)) &
                  + (half(l, i, j) + (h(l, i, 1)*h(l, j, 1) + half(l, i, 1)*h(l, j, 1)) &
                     + (h(l, i, 2)*h(l, j, 2) + half(l, i, 2)*h(l, j, 2)) &
                     + (h(l, i, 3)*h(l, j, 3) + half(l, i, 3)*h(l, j, 3)))
      end do
    end do
  end subroutine push_forward

  !> Finds the points whose trial b_e is not positive definite, and lets them go on without strain.
  pure subroutine check_stretches(batch, cg_m1)
    type(stress_batch_t), intent(inout) :: batch     !! failed is set
    real(dp), intent(inout) :: cg_m1(batch_size, 3)  !! eigenvalues of b_e - 1 [-]
    integer :: l

    if (all(cg_m1 > -1.0_dp)) return
    do l = 1, batch_size
      if (all(cg_m1(l, :) > -1.0_dp)) cycle
      batch%failed(l) = .true.
      cg_m1(l, :) = 0.0_dp
    end do
  end subroutine check_stretches

  !> Principal logarithmic strains 1/2 ln(1 + (b - 1)). Source: theory.md (6).
  pure subroutine take_logarithms(strain, cg_m1)
    real(dp), intent(out) :: strain(batch_size, 3) !! [-]
    real(dp), intent(in)  :: cg_m1(batch_size, 3)  !! eigenvalues of b_e - 1, above -1 [-]
    integer :: i

    do i = 1, 3
      call log1p_of_batch(strain(:, i), cg_m1(:, i))
      strain(:, i) = 0.5_dp*strain(:, i)
    end do
  end subroutine take_logarithms

  !> Radial return of the points beyond their strength; the others keep their strain.
  !! Source: theory.md (8); `mpm_von_mises` is the reference.
  pure subroutine return_radially(batch, principal, materials)
    type(stress_batch_t), intent(inout) :: batch        !! plastic_strain and flows are set
    type(principal_batch_t), intent(inout) :: principal !! all but dyad are set
    type(material_t), intent(in) :: materials(:)
    real(dp) :: equivalent(batch_size), flow(batch_size), square, a, b, c
    integer  :: l

    !$omp simd private(a, b, c, square)
    do l = 1, batch_size
      a = principal%strain(l, 1) - principal%strain(l, 2)
      b = principal%strain(l, 2) - principal%strain(l, 3)
      c = principal%strain(l, 3) - principal%strain(l, 1)
      principal%deviator(l, 1) = (a - c)/3.0_dp
      principal%deviator(l, 2) = (b - a)/3.0_dp
      principal%deviator(l, 3) = (c - b)/3.0_dp
      square = principal%deviator(l, 1)**2 + principal%deviator(l, 2)**2 &
               + principal%deviator(l, 3)**2
      equivalent(l) = batch%shear(l)*sqrt(6.0_dp*square)
    end do
    batch%flows = equivalent > batch%strength*(1.0_dp + yield_tolerance)
    principal%softening = 0.0_dp
    principal%along = 0.0_dp
    if (any(batch%flows)) then
      call find_flow(flow, batch, equivalent, materials)
      call soften(batch, principal, flow, equivalent)
    end if
    call hencky_stress(principal, batch)
  end subroutine return_radially

  !> Increments of plastic strain: closed form within the segment of the hardening table, by the
  !! reference where it ends in a later one.
  pure subroutine find_flow(flow, batch, equivalent, materials)
    real(dp), intent(out) :: flow(batch_size)           !! 0 where nothing flows [-]
    type(stress_batch_t), intent(inout) :: batch        !! out plastic_strain, slope where it ends
    real(dp), intent(in) :: equivalent(batch_size)      !! trial sqrt(3 J2) [force/length^2]
    type(material_t), intent(in) :: materials(:)
    integer :: l

    do l = 1, batch_size
      flow(l) = merge((equivalent(l) - batch%strength(l)) &
                      /(3.0_dp*batch%shear(l) + batch%slope(l)), 0.0_dp, batch%flows(l))
    end do
    if (any(batch%plastic_strain + flow > batch%segment_end)) then
      do l = 1, batch_size
        if (batch%plastic_strain(l) + flow(l) <= batch%segment_end(l)) cycle
        call plastic_flow(flow(l), batch%slope(l), materials(batch%material(l)), equivalent(l), &
                          batch%plastic_strain(l))
      end do
    end if
    batch%plastic_strain = batch%plastic_strain + flow
  end subroutine find_flow

  !> Strains and factors of the consistent moduli after the return.
  pure subroutine soften(batch, principal, flow, equivalent)
    type(stress_batch_t), intent(in) :: batch           !! flows, shear, slope
    type(principal_batch_t), intent(inout) :: principal !! strain, softening and along are set
    real(dp), intent(in) :: flow(batch_size)            !! [-]
    real(dp), intent(in) :: equivalent(batch_size)      !! trial sqrt(3 J2) [force/length^2]
    real(dp) :: shear_3, safe, ratio
    integer  :: i, l

    !$omp simd private(shear_3, safe, ratio)
    do l = 1, batch_size
      shear_3 = 3.0_dp*batch%shear(l)
      safe = merge(equivalent(l), 1.0_dp, batch%flows(l))
      ratio = shear_3*flow(l)/safe
      principal%softening(l) = ratio
      ! dev.dev = (equivalent/G)**2/6
      principal%along(l) = merge(2.0_dp*batch%shear(l) &
                                 *(shear_3/(shear_3 + batch%slope(l)) - ratio) &
                                 *6.0_dp*batch%shear(l)**2/(safe*safe), 0.0_dp, batch%flows(l))
    end do
    do i = 1, 3
      do l = 1, batch_size
        principal%strain(l, i) = principal%strain(l, i) &
                                 - principal%softening(l)*principal%deviator(l, i)
      end do
    end do
  end subroutine soften

  !> Principal Kirchhoff stresses of elastic strains. Source: theory.md (7).
  pure subroutine hencky_stress(principal, batch)
    type(principal_batch_t), intent(inout) :: principal !! strain; kirchhoff is set
    type(stress_batch_t), intent(in) :: batch           !! bulk and shear
    real(dp) :: mean_part
    integer  :: l

    !$omp simd private(mean_part)
    do l = 1, batch_size
      mean_part = (batch%bulk(l) - 2.0_dp/3.0_dp*batch%shear(l)) &
                  *(principal%strain(l, 1) + principal%strain(l, 2) + principal%strain(l, 3))
      principal%kirchhoff(l, 1) = mean_part + 2.0_dp*batch%shear(l)*principal%strain(l, 1)
      principal%kirchhoff(l, 2) = mean_part + 2.0_dp*batch%shear(l)*principal%strain(l, 2)
      principal%kirchhoff(l, 3) = mean_part + 2.0_dp*batch%shear(l)*principal%strain(l, 3)
    end do
  end subroutine hencky_stress

  !> b_e - 1 after the return, for the points that flow; the others keep the trial.
  pure subroutine relax_stretches(batch, principal)
    type(stress_batch_t), intent(inout) :: batch     !! cg_e_m1: in trial, out new
    type(principal_batch_t), intent(in) :: principal !! strain after the return, dyad
    real(dp) :: stretch(batch_size, 3), relaxed(batch_size, 6)
    integer  :: i, l

    do i = 1, 3
      call expm1_of_batch(stretch(:, i), 2.0_dp*principal%strain(:, i))
    end do
    call sum_of_dyads(relaxed, stretch, principal%dyad)
    do i = 1, 6
      do l = 1, batch_size
        batch%cg_e_m1(l, i) = merge(relaxed(l, i), batch%cg_e_m1(l, i), batch%flows(l))
      end do
    end do
  end subroutine relax_stretches

end module mpm_stress_batch
