!> Fields of material points under their deck names.
module mpm_point_fields
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_patches, only: patches_t
  use mpm_tensor, only: det_m1, deviator_norm
  implicit none
  private
  public :: component_suffix, is_integer_field, n_field_components, point_field, point_values

  real(dp), parameter :: identity(3, 3) = &
    reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
  character(2), parameter :: voigt_suffix(6) = ["11", "22", "33", "12", "23", "13"]
  character(2), parameter :: tensor_suffix(9) = &
    ["11", "12", "13", "21", "22", "23", "31", "32", "33"]

contains

  !> Number of components of a field in a file, 0 for an unknown name.
  pure function n_field_components(name) result(n)
    character(*), intent(in) :: name !! deck name, upper case
    integer :: n                     !! 1, 3 (vector), 6 (symmetric tensor) or 9 (tensor)

    select case (name)
    case ("S", "TAU", "LE")
      n = 6
    case ("F")
      n = 9
    case ("U")
      n = 3
    case ("PEEQ", "J", "JBAR", "VOL", "MISES", "PRESSURE", "MAT", "PATCH", "ELEMENT", "ID")
      n = 1
    case default
      n = 0
    end select
  end function n_field_components

  !> Whether a field holds indices.
  pure function is_integer_field(name) result(is_integer)
    character(*), intent(in) :: name !! deck name, upper case
    logical :: is_integer

    select case (name)
    case ("MAT", "PATCH", "ELEMENT", "ID")
      is_integer = .true.
    case default
      is_integer = .false.
    end select
  end function is_integer_field

  !> What follows the name of a field in the name of one of its components.
  pure function component_suffix(name, component) result(suffix)
    character(*), intent(in) :: name  !! deck name, upper case
    integer, intent(in) :: component  !! 1..n_field_components
    character(:), allocatable :: suffix

    select case (n_field_components(name))
    case (6)
      suffix = voigt_suffix(component)
    case (9)
      suffix = tensor_suffix(component)
    case (1)
      suffix = ""
    case default
      suffix = achar(iachar("0") + component)
    end select
  end function component_suffix

  !> Values of a field at one point.
  pure function point_values(points, patches, name, p) result(values)
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! for PATCH
    character(*), intent(in) :: name       !! deck name, upper case
    integer, intent(in) :: p               !! index of the point
    real(dp) :: values(9)                  !! the first n_field_components are set, the rest is 0
    real(dp), allocatable :: field(:, :)

    values = 0.0_dp
    field = point_field(points, patches, name, [p])
    values(:size(field, 1)) = field(:, 1)
  end function point_values

  !> Values of a field at some points. TAU = JBAR S; MISES and PRESSURE are those of S, pressure
  !! positive in compression; F row by row. Without a host ELEMENT and PATCH are 0.
  pure function point_field(points, patches, name, items) result(values)
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! for PATCH
    character(*), intent(in) :: name       !! deck name, upper case
    integer, intent(in) :: items(:)        !! indices of the points
    real(dp), allocatable :: values(:, :)  !! (n_field_components, size(items)), 0 for an unknown name
    integer :: i, n_dim

    n_dim = size(points%u, 1)
    allocate (values(max(1, n_field_components(name)), size(items)), source=0.0_dp)
    select case (name)
    case ("S")
      values(:, :) = points%state%cauchy(:, items)
    case ("TAU")
      do i = 1, size(items)
        values(:, i) = points%state%jacobian_bar(items(i))*points%state%cauchy(:, items(i))
      end do
    case ("LE")
      values(:, :) = points%state%strain_e(:, items)
    case ("F")
      do i = 1, size(items)
        values(:, i) = reshape(transpose(points%def_grad(:, :, items(i))), [9])
      end do
    case ("U")
      values(:n_dim, :) = points%u(:, items)
    case default
      values(1, :) = scalar_field(points, patches, name, items)
    end select
  end function point_field

  !> Values of a scalar field at some points.
  pure function scalar_field(points, patches, name, items) result(values)
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! for PATCH
    character(*), intent(in) :: name       !! deck name, upper case
    integer, intent(in) :: items(:)        !! indices of the points
    real(dp) :: values(size(items))        !! 0 for an unknown name
    integer :: i

    values = 0.0_dp
    select case (name)
    case ("PEEQ")
      values = points%state%hardening(1, items)
    case ("J")
      do i = 1, size(items)
        values(i) = 1.0_dp + det_m1(points%def_grad(:, :, items(i)) - identity)
      end do
    case ("JBAR")
      values = points%state%jacobian_bar(items)
    case ("VOL")
      values = points%volume(items)
    case ("MISES")
      do i = 1, size(items)
        values(i) = sqrt(1.5_dp)*deviator_norm(points%state%cauchy(:, items(i)))
      end do
    case ("PRESSURE")
      do i = 1, size(items)
        values(i) = -sum(points%state%cauchy(1:3, items(i)))/3.0_dp
      end do
    case ("MAT")
      values = real(points%material(items), dp)
    case ("ELEMENT")
      values = real(points%element(items), dp)
    case ("PATCH")
      do i = 1, size(items)
        if (points%element(items(i)) == 0) cycle
        values(i) = real(patches%of_element(points%element(items(i))), dp)
      end do
    case ("ID")
      values = real(points%id(items), dp)
    end select
  end function scalar_field

end module mpm_point_fields
