!> The locking meter: unknowns per volumetric constraint, and how much of the stress is a pressure
!! that jumps up and down from element to element. Source: theory.md (22).
module mpm_locking_meter
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_patches, only: patches_t
  use mpm_simplex, only: simplex_gradients, simplex_shape
  implicit none
  private
  public :: measure_checkerboard, n_active_patches

  real(dp), parameter :: flat = 1.0e-3_dp !! least volume of neighbours over power of longest edge

  !> Means over the points of an element, weighted with their volumes.
  type :: element_means_t
    real(dp), allocatable :: volume(:)    !! (n_el)         of the points [length^n_dim]
    real(dp), allocatable :: centre(:, :) !! (n_dim, n_el)  of their volume [length]
    real(dp), allocatable :: cauchy(:, :) !! (6, n_el)      stress, Voigt [force/length^2]
    real(dp), allocatable :: pressure(:)  !! (n_el)         - tr cauchy/3 [force/length^2]
  end type element_means_t

contains

  !> Patches that hold an active element: the volumetric constraints of an increment.
  pure integer function n_active_patches(patches, element) result(n)
    type(patches_t), intent(in) :: patches !! those of the formulation; standard: single elements
    integer, intent(in) :: element(:)      !! (m)  active elements
    logical :: active(patches%n)

    active = .false.
    active(patches%of_element(element)) = .true.
    n = count(active)
  end function n_active_patches

  !> Index of the pressure that alternates between elements, zero for a linear pressure. Counts the
  !! elements whose faces all have active neighbours with centres that are not in one plane.
  !! Source: theory.md (22a), (22b).
  pure subroutine measure_checkerboard(index, n_counted, mesh, points)
    real(dp), intent(out) :: index      !! root of squared jumps over squared stress, 0 without [-]
    integer, intent(out)  :: n_counted  !! elements in the sums
    type(mesh_t), intent(in) :: mesh    !! where it is now, with neighbours
    type(points_t), intent(in) :: points !! converged state, hosts in that mesh
    type(element_means_t) :: means
    real(dp) :: expected, jumps, stresses
    logical  :: found
    integer  :: e

    call average_points(means, mesh, points)
    jumps = 0.0_dp
    stresses = 0.0_dp
    n_counted = 0
    do e = 1, mesh%n_el
      call expect_pressure(expected, found, means, mesh%neighbour(:, e), e)
      if (.not. found) cycle
      n_counted = n_counted + 1
      jumps = jumps + means%volume(e)*(means%pressure(e) - expected)**2
      stresses = stresses + means%volume(e)*squared_norm(means%cauchy(:, e))
    end do
    index = 0.0_dp
    if (stresses > 0.0_dp) index = sqrt(jumps/stresses)
  end subroutine measure_checkerboard

  !> Volumes, centres, stresses and pressures of all elements; zero in those without points.
  pure subroutine average_points(means, mesh, points)
    type(element_means_t), intent(out) :: means !! of all elements
    type(mesh_t), intent(in) :: mesh            !! for its sizes
    type(points_t), intent(in) :: points        !! converged state
    integer :: e, p

    allocate (means%volume(mesh%n_el), means%pressure(mesh%n_el), source=0.0_dp)
    allocate (means%centre(mesh%n_dim, mesh%n_el), means%cauchy(6, mesh%n_el), source=0.0_dp)
    do p = 1, points%n
      e = points%element(p)
      if (e == 0) cycle
      associate (v => points%volume(p))
        means%volume(e) = means%volume(e) + v
        means%centre(:, e) = means%centre(:, e) + v*points%x(:, p)
        means%cauchy(:, e) = means%cauchy(:, e) + v*points%state%cauchy(:, p)
      end associate
    end do
    do e = 1, mesh%n_el
      if (means%volume(e) <= 0.0_dp) cycle
      means%centre(:, e) = means%centre(:, e)/means%volume(e)
      means%cauchy(:, e) = means%cauchy(:, e)/means%volume(e)
      means%pressure(e) = -sum(means%cauchy(1:3, e))/3.0_dp
    end do
  end subroutine average_points

  !> The linear function through the pressures at the centres of the neighbours, at the centre of
  !! the element. Source: theory.md (22a).
  pure subroutine expect_pressure(expected, found, means, neighbour, element)
    real(dp), intent(out) :: expected          !! [force/length^2]
    logical, intent(out)  :: found             !! .false.: a neighbour is missing, or all in a plane
    type(element_means_t), intent(in) :: means !! of all elements
    integer, intent(in) :: neighbour(:)        !! (n_dim+1)  behind the faces, 0 outside
    integer, intent(in) :: element             !! the element
    real(dp) :: vertex(size(neighbour) - 1, size(neighbour))
    real(dp) :: gradient(size(neighbour) - 1, size(neighbour)), volume

    expected = 0.0_dp
    found = means%volume(element) > 0.0_dp .and. all(neighbour > 0)
    if (found) found = all(means%volume(neighbour) > 0.0_dp)
    if (.not. found) return
    vertex = means%centre(:, neighbour)
    call simplex_gradients(vertex, gradient, volume)
    found = abs(volume) > flat*longest_edge(vertex)**size(vertex, 1)
    if (.not. found) return
    expected = dot_product(simplex_shape(vertex(:, 1), gradient, means%centre(:, element)), &
                           means%pressure(neighbour))
  end subroutine expect_pressure

  !> Longest edge of a simplex.
  pure real(dp) function longest_edge(vertex) result(length)
    real(dp), intent(in) :: vertex(:, :) !! (n_dim, n_dim+1)  corners [length]
    integer :: a, b

    length = 0.0_dp
    do a = 2, size(vertex, 2)
      do b = 1, a - 1
        length = max(length, norm2(vertex(:, a) - vertex(:, b)))
      end do
    end do
  end function longest_edge

  !> Square of the Frobenius norm of a symmetric tensor.
  pure real(dp) function squared_norm(voigt) result(norm)
    real(dp), intent(in) :: voigt(6) !! 11, 22, 33, 12, 23, 13

    norm = sum(voigt(1:3)**2) + 2.0_dp*sum(voigt(4:6)**2)
  end function squared_norm

end module mpm_locking_meter
