!> What a deck makes of its mesh, in checksums: a restart goes on only with the same model.
module mpm_model_signature
  use mpm_checksum, only: checksum_of_integers, checksum_of_reals, checksum_text
  use mpm_dof_map, only: constraint_t
  use mpm_error, only: error_t, exit_model, make_error
  use mpm_external_force, only: load_t
  use mpm_kinds, only: ip
  use mpm_model, only: model_t
  use mpm_text, only: integer_text
  implicit none
  private
  public :: check_model, model_signature

contains

  !> One line for each part of the model.
  function model_signature(model) result(text)
    type(model_t), intent(in) :: model !! at time zero
    character(:), allocatable :: text  !! lines
    integer :: i

    text = "mesh "//checksum_text(mesh_checksum(model))//new_line("a")// &
           "material points "//checksum_text(points_checksum(model))//new_line("a")// &
           "patches "//checksum_text(checksum_of_integers(0_ip, model%patches%of_element))// &
           new_line("a")
    do i = 1, size(model%step)
      text = text//"conditions of step "//integer_text(i)//" "// &
             checksum_text(conditions_checksum(model%step(i)%constraint, model%step(i)%load))// &
             new_line("a")
    end do
  end function model_signature

  !> Compares a model with the signature of an earlier one, up to a step.
  subroutine check_model(model, signature, last_step, error)
    type(model_t), intent(in) :: model               !! at time zero
    character(*), intent(in)  :: signature           !! of the model then
    integer, intent(in)       :: last_step           !! conditions of steps after it may differ
    type(error_t), allocatable, intent(out) :: error !! exit_model: the first part that differs
    character(:), allocatable :: now
    integer :: first, i, length

    now = model_signature(model)
    first = 1
    do i = 1, 3 + last_step
      length = index(now(first:), new_line("a"))
      if (length == 0) return
      if (index(new_line("a")//signature, new_line("a")//now(first:first + length - 1)) == 0) then
        call make_error(error, exit_model, "error: the "//now(first:first + length - 11)// &
                        " of the model differ from those the restart file was written with: "// &
                        "expected the same mesh files, sets and regions")
        return
      end if
      first = first + length
    end do
  end subroutine check_model

  !> Nodes and elements.
  function mesh_checksum(model) result(checksum)
    type(model_t), intent(in) :: model !! at time zero
    integer(ip) :: checksum            !! 0 .. 2^32 - 1

    associate (mesh => model%mesh)
      checksum = checksum_of_reals(0_ip, reshape(mesh%x, [size(mesh%x)]))
      checksum = checksum_of_integers(checksum, reshape(mesh%node, [size(mesh%node)]))
    end associate
  end function mesh_checksum

  !> Material points with the stress they begin with, and those of loaded surfaces.
  function points_checksum(model) result(checksum)
    type(model_t), intent(in) :: model !! at time zero
    integer(ip) :: checksum            !! 0 .. 2^32 - 1

    associate (points => model%points, surface => model%surface)
      checksum = checksum_of_reals(0_ip, reshape(points%x, [size(points%x)]))
      checksum = checksum_of_reals(checksum, points%volume_0)
      checksum = checksum_of_reals(checksum, points%mass)
      checksum = checksum_of_integers(checksum, points%material)
      checksum = checksum_of_reals(checksum, reshape(points%state%cauchy, &
                                                     [size(points%state%cauchy)]))
      if (surface%n == 0) return
      checksum = checksum_of_reals(checksum, reshape(surface%x, [size(surface%x)]))
      checksum = checksum_of_reals(checksum, surface%area)
    end associate
  end function points_checksum

  !> Prescribed displacements and loads of a step.
  function conditions_checksum(constraint, load) result(checksum)
    type(constraint_t), intent(in) :: constraint(:) !! of the step
    type(load_t), intent(in)       :: load(:)       !! of the step
    integer(ip) :: checksum                         !! 0 .. 2^32 - 1
    integer :: i

    checksum = 0_ip
    do i = 1, size(constraint)
      checksum = checksum_of_integers(checksum, constraint(i)%node)
      checksum = checksum_of_integers(checksum, [constraint(i)%direction, constraint(i)%amplitude])
      checksum = checksum_of_reals(checksum, [constraint(i)%value, constraint(i)%start])
    end do
    do i = 1, size(load)
      if (allocated(load(i)%item)) checksum = checksum_of_integers(checksum, load(i)%item)
      if (allocated(load(i)%face)) checksum = checksum_of_integers(checksum, load(i)%face)
      checksum = checksum_of_integers(checksum, [load(i)%kind, load(i)%surface, load(i)%amplitude])
      checksum = checksum_of_reals(checksum, [load(i)%value, load(i)%start])
    end do
  end function conditions_checksum

end module mpm_model_signature
