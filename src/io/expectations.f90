!> *EXPECT: values that a deck claims, compared with those of the run.
module mpm_expectations
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_history_columns, only: nodal_values
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t, status_removed
  use mpm_model, only: expectation_t, model_t
  use mpm_patches, only: patches_t
  use mpm_point_fields, only: point_field
  use mpm_run_state, only: run_state_t
  use mpm_text, only: full_text, integer_text, real_text
  implicit none
  private
  public :: verdict_t, collect_expectations, evaluate_expectations, expectation_times
  public :: is_expected, judge, n_failed_expectations, subject_of, verdict_line

  character(*), parameter :: quantity_share = "GHOST SHARE" !! a number of the run
  character(*), parameter :: quantity_balance = "BALANCE"   !! a number of the run
  real(dp), parameter :: time_tolerance = 1.0e-9_dp !! relative

  !> An expectation and what became of it.
  type :: verdict_t
    type(expectation_t) :: expected
    logical  :: reached = .false.      !! .true.: an increment ended at its time
    logical  :: met = .false.          !! .true.: the value is within its tolerance
    real(dp) :: found = 0.0_dp         !! value of the run
  end type verdict_t

contains

  !> All expectations of a model, none reached.
  pure subroutine collect_expectations(verdicts, model)
    type(verdict_t), allocatable, intent(out) :: verdicts(:) !! in the order of the deck
    type(model_t), intent(in) :: model
    integer :: i, j, n

    n = 0
    do i = 1, size(model%step)
      if (allocated(model%step(i)%expectation)) n = n + size(model%step(i)%expectation)
    end do
    allocate (verdicts(n))
    n = 0
    do i = 1, size(model%step)
      if (.not. allocated(model%step(i)%expectation)) cycle
      do j = 1, size(model%step(i)%expectation)
        n = n + 1
        verdicts(n)%expected = model%step(i)%expectation(j)
      end do
    end do
  end subroutine collect_expectations

  !> Whether a deck has an expectation about a quantity.
  pure logical function is_expected(verdicts, quantity) result(expected)
    type(verdict_t), intent(in) :: verdicts(:) !! of the run
    character(*), intent(in) :: quantity       !! deck name, upper case
    integer :: i

    expected = .false.
    do i = 1, size(verdicts)
      expected = expected .or. verdicts(i)%expected%quantity == quantity
    end do
  end function is_expected

  !> Total times at which an increment must end.
  pure function expectation_times(verdicts) result(times)
    type(verdict_t), intent(in) :: verdicts(:) !! of the run
    real(dp) :: times(size(verdicts))          !! in the order of the deck, not sorted

    times = verdicts%expected%time
  end function expectation_times

  !> Compares the expectations whose time is that of an accepted increment.
  pure subroutine evaluate_expectations(verdicts, points, patches, state)
    type(verdict_t), intent(inout) :: verdicts(:) !! those of this time are decided
    type(points_t), intent(in)     :: points      !! converged state
    type(patches_t), intent(in)    :: patches     !! patch of each element
    type(run_state_t), intent(in)  :: state       !! time and nodal values
    integer :: i

    do i = 1, size(verdicts)
      associate (verdict => verdicts(i))
        if (verdict%reached .or. .not. same_time(verdict%expected%time, state%time)) cycle
        call judge(verdict, value_of_run(verdict%expected, points, patches, state))
      end associate
    end do
  end subroutine evaluate_expectations

  !> Decides an expectation.
  pure subroutine judge(verdict, found)
    type(verdict_t), intent(inout) :: verdict !! is decided
    real(dp), intent(in) :: found             !! value of the run

    verdict%reached = .true.
    verdict%found = found
    verdict%met = abs(found - verdict%expected%value) <= tolerance_of(verdict%expected)
  end subroutine judge

  !> Whether a time is that of an increment.
  pure function same_time(expected, now) result(same)
    real(dp), intent(in) :: expected !! total time
    real(dp), intent(in) :: now      !! total time
    logical :: same

    same = abs(expected - now) <= time_tolerance*max(abs(expected), abs(now))
  end function same_time

  !> Largest difference that is accepted.
  pure function tolerance_of(expected) result(tolerance)
    type(expectation_t), intent(in) :: expected
    real(dp) :: tolerance

    tolerance = expected%atol + expected%rtol*abs(expected%value)
  end function tolerance_of

  !> The value that the run gives for an expectation.
  pure function value_of_run(expected, points, patches, state) result(value)
    type(expectation_t), intent(in) :: expected
    type(points_t), intent(in)    :: points  !! converged state
    type(patches_t), intent(in)   :: patches !! patch of each element
    type(run_state_t), intent(in) :: state   !! nodal values
    real(dp) :: value

    if (expected%quantity == "CHECKERBOARD") then
      value = state%checkerboard
    else if (expected%quantity == quantity_share) then
      value = state%ghost_share
    else if (expected%quantity == quantity_balance) then
      value = state%balance
    else if (is_nodal(expected)) then
      value = statistic_of(nodal_values(state, expected%quantity, max(1, expected%component), &
                                        expected%item), expected%statistic)
    else
      value = statistic_of(values_of_points(expected, points, patches), expected%statistic)
    end if
  end function value_of_run

  !> Whether the items of an expectation are nodes: U without a set is that of the points.
  pure function is_nodal(expected) result(nodal)
    type(expectation_t), intent(in) :: expected
    logical :: nodal

    select case (expected%quantity)
    case ("RF", "CF")
      nodal = .true.
    case ("U")
      nodal = expected%of_nodes .and. allocated(expected%item)
    case default
      nodal = .false.
    end select
  end function is_nodal

  !> Values of the points that are now in the elements of a set, of all points without a set.
  pure function values_of_points(expected, points, patches) result(values)
    type(expectation_t), intent(in) :: expected
    type(points_t), intent(in)  :: points  !! converged state
    type(patches_t), intent(in) :: patches !! patch of each element
    real(dp), allocatable :: values(:)
    logical  :: wanted(0:size(patches%of_element))
    real(dp), allocatable :: field(:, :)
    integer, allocatable  :: items(:)
    integer :: p

    wanted = .true.
    if (allocated(expected%item)) then
      wanted = .false.
      wanted(expected%item) = .true.
    end if
    items = pack([(p, p=1, points%n)], points%status /= status_removed .and. wanted(points%element))
    field = point_field(points, patches, expected%quantity, items)
    allocate (values(size(items)))
    values(:) = field(max(1, expected%component), :)
  end function values_of_points

  !> Sum, mean, smallest, largest value or standard deviation (over n, not n - 1); each item
  !! counts once. Without items only the sum exists; the others give a huge value, and so does
  !! every statistic when a value is not finite: it would be hidden by MIN and MAX.
  pure function statistic_of(values, statistic) result(value)
    real(dp), intent(in) :: values(:)     !! one per item
    character(*), intent(in) :: statistic !! SUM, MEAN, MIN, MAX or STD
    real(dp) :: value
    integer :: n

    n = size(values)
    value = merge(0.0_dp, huge(value), statistic == "SUM" .and. n == 0)
    if (n == 0 .or. .not. all(ieee_is_finite(values))) return
    select case (statistic)
    case ("MIN")
      value = minval(values)
    case ("MAX")
      value = maxval(values)
    case ("STD")
      value = sqrt(sum((values - sum(values)/n)**2)/n)
    case ("MEAN")
      value = sum(values)/n
    case default
      value = sum(values)
    end select
  end function statistic_of

  !> Expectations that were not met or whose time was never reached.
  pure function n_failed_expectations(verdicts) result(n)
    type(verdict_t), intent(in) :: verdicts(:) !! at the end of the run
    integer :: n

    n = count(.not. verdicts%met)
  end function n_failed_expectations

  !> One line about an expectation, with what was expected and what was found.
  pure function verdict_line(verdict) result(line)
    type(verdict_t), intent(in) :: verdict
    character(:), allocatable :: line

    line = "EXPECT "
    if (allocated(verdict%expected%origin)) line = line//verdict%expected%origin//" "
    line = line//subject_of(verdict%expected)//" at "//real_text(verdict%expected%time)//": "
    if (verdict%expected%analytic) then
      line = line//"analytic "
    else
      line = line//"frozen "
    end if
    line = line//full_text(verdict%expected%value)//" +- " &
           //real_text(tolerance_of(verdict%expected))
    if (.not. verdict%reached) then
      line = line//", time not reached: FAILED"
    else if (verdict%met) then
      line = line//", found "//full_text(verdict%found)//": met"
    else
      line = line//", found "//full_text(verdict%found)//": FAILED"
    end if
  end function verdict_line

  !> What is compared, such as MEAN RF3[FOOTING].
  pure function subject_of(expected) result(text)
    type(expectation_t), intent(in) :: expected
    character(:), allocatable :: text

    text = expected%quantity
    if (any(text == [character(12) :: "CHECKERBOARD", quantity_share, quantity_balance])) return
    text = expected%statistic//" "//text
    if (expected%component > 0) text = text//integer_text(expected%component)
    if (allocated(expected%set)) then
      if (len(expected%set) > 0) text = text//"["//expected%set//"]"
    end if
  end function subject_of

end module mpm_expectations
