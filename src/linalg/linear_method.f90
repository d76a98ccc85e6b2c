!> Ways to solve the linear system of a correction (LINEAR SOLVER of *CONTROLS).
module mpm_linear_method
  use mpm_linear_solver, only: has_mumps, library_mumps, library_single, library_umfpack
  implicit none
  private
  public :: chosen_method, least_recycled, library_of, method_name, method_of_name
  public :: method_automatic, method_direct, method_mumps, method_recycled

  integer, parameter :: method_automatic = 0 !! by the number of unknowns
  integer, parameter :: method_direct = 1    !! UMFPACK, new factors for every correction
  integer, parameter :: method_recycled = 2  !! factors that are kept, and GMRES
  integer, parameter :: method_mumps = 3     !! MUMPS, new factors for every correction

  integer, parameter :: enough = 2000 !! unknowns in 3-D from which recycling pays
  integer, parameter :: many = 20000  !! unknowns in 3-D from which it pays to change the increments

contains

  !> The method that serves a number of unknowns.
  pure integer function chosen_method(asked, n, least) result(method)
    integer, intent(in) :: asked !! method_*
    integer, intent(in) :: n     !! unknowns
    integer, intent(in) :: least !! unknowns from which recycling is the choice

    method = asked
    if (asked == method_automatic) method = merge(method_recycled, method_direct, n >= least)
  end function chosen_method

  !> Unknowns from which recycling is the choice. In plane strain factors cost little, and hard
  !! increments take more corrections with it. Where the size of the increments follows the number of
  !! corrections, other corrections mean other increments: there it must pay much. Source: theory.md
  !! 7.1.
  pure integer function least_recycled(n_dim, equal_increments) result(n)
    integer, intent(in) :: n_dim            !! 2 or 3
    logical, intent(in) :: equal_increments !! as the deck gives them

    if (n_dim == 2) then
      n = huge(n)
    else
      n = merge(enough, many, equal_increments)
    end if
  end function least_recycled

  !> The library that makes the factors of a method.
  pure integer function library_of(method, exactly) result(library)
    integer, intent(in) :: method  !! method_*, not automatic
    logical, intent(in) :: exactly !! factors of single precision do not serve

    library = library_umfpack
    if (method == method_mumps) library = library_mumps
    if (method == method_recycled .and. has_mumps() .and. .not. exactly) library = library_single
  end function library_of

  !> Name of a method in the deck.
  pure function method_name(method) result(name)
    integer, intent(in) :: method !! method_*
    character(:), allocatable :: name

    select case (method)
    case (method_direct); name = "DIRECT"
    case (method_recycled); name = "RECYCLED"
    case (method_mumps); name = "MUMPS"
    case default; name = ""
    end select
  end function method_name

  !> Method that a deck names; automatic without a name.
  pure integer function method_of_name(name) result(method)
    character(*), intent(in) :: name !! upper case

    select case (name)
    case ("DIRECT"); method = method_direct
    case ("RECYCLED"); method = method_recycled
    case ("MUMPS"); method = method_mumps
    case default; method = method_automatic
    end select
  end function method_of_name

end module mpm_linear_method
