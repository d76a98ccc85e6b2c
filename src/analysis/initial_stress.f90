!> Stress with which material points start.
module mpm_initial_stress
  use mpm_initial_state, only: initial_state_t, state_of_stress
  use mpm_kinds, only: dp
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  implicit none
  private
  public :: initial_stress_t, yield_breach_t, geostatic_stress, set_initial_stress, stress_at

  !> Cauchy stress of the points that start in some elements: linear in the height, which is the
  !! last coordinate.
  type :: initial_stress_t
    integer, allocatable :: element(:) !! (m)  elements of the initial mesh
    real(dp) :: cauchy(6) = 0.0_dp     !! at the reference height, Voigt [force/length^2]
    real(dp) :: slope(6) = 0.0_dp      !! change with the height, Voigt [force/length^3]
    real(dp) :: height = 0.0_dp        !! reference height [length]
  end type initial_stress_t

  !> The first point whose initial stress is outside the yield surface, or too large to strain by.
  type :: yield_breach_t
    integer  :: point = 0        !! 0 if there is none
    logical  :: too_large = .false. !! .true.: the elastic strain would be beyond any use
    real(dp) :: found = 0.0_dp   !! sqrt(3 J2) of its stress [force/length^2]
    real(dp) :: allowed = 0.0_dp !! sqrt(3 J2) at first yield [force/length^2]
  end type yield_breach_t

contains

  !> A vertical stress that is linear between two heights and beyond, and horizontal ones in
  !! proportion. Source: theory.md (21b). In plane strain the second horizontal one is out of plane.
  pure function geostatic_stress(n_dim, vertical, height, lateral) result(initial)
    integer, intent(in)  :: n_dim       !! 2 or 3
    real(dp), intent(in) :: vertical(2) !! stress at the two heights [force/length^2]
    real(dp), intent(in) :: height(2)   !! two different heights [length]
    real(dp), intent(in) :: lateral(2)  !! horizontal over vertical stress: in x, in y or z [-]
    type(initial_stress_t) :: initial   !! without elements
    real(dp) :: part(6)

    part = 0.0_dp
    part(1) = lateral(1)
    part(5 - n_dim) = lateral(2)
    part(n_dim) = 1.0_dp
    initial%height = height(1)
    initial%cauchy = vertical(1)*part
    initial%slope = (vertical(2) - vertical(1))/(height(2) - height(1))*part
  end function geostatic_stress

  !> Initial stress at a height.
  pure function stress_at(initial, height) result(cauchy)
    type(initial_stress_t), intent(in) :: initial
    real(dp), intent(in) :: height !! [length]
    real(dp) :: cauchy(6)          !! Voigt [force/length^2]

    cauchy = initial%cauchy + initial%slope*(height - initial%height)
  end function stress_at

  !> State of the points that start in the elements of an initial stress. Precondition: no point has
  !! moved.
  pure subroutine set_initial_stress(points, n_set, breach, initial, n_el, materials)
    type(points_t), intent(inout)       :: points       !! their converged state is set
    integer, intent(out)                :: n_set        !! points that start in the elements
    type(yield_breach_t), intent(out)   :: breach       !! point with too much stress
    type(initial_stress_t), intent(in)  :: initial
    integer, intent(in)                 :: n_el         !! elements of the mesh
    type(material_t), intent(in)        :: materials(:)
    type(initial_state_t) :: state
    logical :: stressed(0:n_el)
    integer :: p

    stressed = .false.
    stressed(initial%element) = .true.
    n_set = 0
    do p = 1, points%n
      if (.not. stressed(points%element(p))) cycle
      n_set = n_set + 1
      points%state%cauchy(:, p) = stress_at(initial, points%x(size(points%x, 1), p))
      call state_of_stress(state, materials(points%material(p)), points%state%cauchy(:, p))
      points%state%strain_e(:, p) = state%strain_e
      points%state%left_cauchy_green_e_m1(:, p) = state%left_cauchy_green_e_m1
      if (breach%point > 0 .or. .not. (state%outside .or. state%too_large)) cycle
      breach = yield_breach_t(p, state%too_large, state%found, state%allowed)
    end do
  end subroutine set_initial_stress

end module mpm_initial_stress
