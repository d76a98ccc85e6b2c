!> Fields of material points under their deck names.
module mpm_point_fields
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_patches, only: patches_t
  use mpm_tensor, only: det_m1, deviator_norm
  implicit none
  private
  public :: component_suffix, gather_field, gather_indices, gather_vectors, is_integer_field
  public :: n_field_components, point_field, point_values

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

  !> Values of a field at some points, see gather_field.
  pure function point_field(points, patches, name, items) result(values)
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! for PATCH
    character(*), intent(in) :: name       !! deck name, upper case
    integer, intent(in) :: items(:)        !! indices of the points
    real(dp), allocatable :: values(:, :)  !! (n_field_components, size(items)), 0 for an unknown name
    integer, allocatable :: numbers(:)

    if (is_integer_field(name)) then
      allocate (values(1, size(items)))
      call gather_indices(numbers, points, patches, name, items)
      values(1, :) = real(numbers, dp)
    else
      call gather_field(values, points, name, items)
    end if
  end function point_field

  !> Values of a field of reals at some points. TAU = JBAR S; MISES and PRESSURE are those of S,
  !! pressure positive in compression; F row by row.
  pure subroutine gather_field(values, points, name, items)
    real(dp), allocatable, intent(inout) :: values(:, :) !! (n_field_components, size(items)), 0 for
                                                         !! an unknown name; its memory is used again
    type(points_t), intent(in) :: points !! converged state
    character(*), intent(in) :: name     !! deck name, upper case
    integer, intent(in) :: items(:)      !! indices of the points
    integer :: i, p

    if (name == "U") then
      call gather_vectors(values, points%u, items)
      return
    end if
    call make_room(values, max(1, n_field_components(name)), size(items))
    select case (name)
    case ("S")
      call gather_rows(values, points%state%cauchy, items)
    case ("TAU")
      do i = 1, size(items)
        p = items(i)
        values(:, i) = points%state%jacobian_bar(p)*points%state%cauchy(:, p)
      end do
    case ("LE")
      call gather_rows(values, points%state%strain_e, items)
    case ("F")
      do i = 1, size(items)
        values(:, i) = reshape(transpose(points%def_grad(:, :, items(i))), [9])
      end do
    case default
      call gather_scalars(values(1, :), points, name, items)
    end select
  end subroutine gather_field

  !> Values of a scalar field of reals at some points.
  pure subroutine gather_scalars(values, points, name, items)
    real(dp), intent(out) :: values(:)   !! (size(items)), 0 for an unknown name
    type(points_t), intent(in) :: points !! converged state
    character(*), intent(in) :: name     !! deck name, upper case
    integer, intent(in) :: items(:)      !! indices of the points
    integer :: i

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
    case default
      values = 0.0_dp
    end select
  end subroutine gather_scalars

  !> Values of a field of indices at some points. Without a host ELEMENT and PATCH are 0.
  pure subroutine gather_indices(values, points, patches, name, items)
    integer, allocatable, intent(inout) :: values(:) !! (size(items)), 0 for an unknown name
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! for PATCH
    character(*), intent(in) :: name       !! deck name, upper case
    integer, intent(in) :: items(:)        !! indices of the points
    integer :: i

    if (allocated(values)) then
      if (size(values) /= size(items)) deallocate (values)
    end if
    if (.not. allocated(values)) allocate (values(size(items)))
    select case (name)
    case ("MAT")
      values(:) = points%material(items)
    case ("ELEMENT")
      values(:) = points%element(items)
    case ("PATCH")
      do i = 1, size(items)
        values(i) = 0
        if (points%element(items(i)) > 0) values(i) = patches%of_element(points%element(items(i)))
      end do
    case ("ID")
      values(:) = points%id(items)
    case default
      values(:) = 0
    end select
  end subroutine gather_indices

  !> Vectors of some points with three components, the third 0 in the plane.
  pure subroutine gather_vectors(values, vector, items)
    real(dp), allocatable, intent(inout) :: values(:, :) !! (3, size(items))
    real(dp), intent(in), contiguous :: vector(:, :)     !! (2 or 3, n)
    integer, intent(in) :: items(:)                      !! indices of the points
    integer :: i

    call make_room(values, 3, size(items))
    if (size(vector, 1) == 3) then
      call gather_rows(values, vector, items)
    else
      do i = 1, size(items)
        values(:, i) = [vector(1:2, items(i)), 0.0_dp]
      end do
    end if
  end subroutine gather_vectors

  !> Rows of some points.
  pure subroutine gather_rows(values, row, items)
    real(dp), intent(out), contiguous :: values(:, :) !! (n_columns, size(items))
    real(dp), intent(in), contiguous  :: row(:, :)    !! (n_columns, n)
    integer, intent(in) :: items(:)                   !! indices of the points
    integer :: i

    select case (size(values, 1)) ! lengths that the compiler knows
    case (6)
      do i = 1, size(items)
        values(1:6, i) = row(1:6, items(i))
      end do
    case (3)
      do i = 1, size(items)
        values(1:3, i) = row(1:3, items(i))
      end do
    case default
      do i = 1, size(items)
        values(:, i) = row(:, items(i))
      end do
    end select
  end subroutine gather_rows

  !> Gives an array its shape. One that has it already keeps its memory.
  pure subroutine make_room(values, n_columns, n_rows)
    real(dp), allocatable, intent(inout) :: values(:, :) !! (n_columns, n_rows), without values
    integer, intent(in) :: n_columns, n_rows

    if (allocated(values)) then
      if (size(values, 1) /= n_columns .or. size(values, 2) /= n_rows) deallocate (values)
    end if
    if (.not. allocated(values)) allocate (values(n_columns, n_rows))
  end subroutine make_room

end module mpm_point_fields
