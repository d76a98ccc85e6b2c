!> What a run will need, as `--estimate` tells it.
module mpm_run_estimate
  use mpm_factor_estimate, only: factor_estimate_t
  use mpm_kinds, only: dp, ip
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: memory_need_t, run_estimate_t
  public :: estimate_text, expected_peak, memory_text, peak_bound, short_text, size_text

  character(*), parameter :: line_end = new_line("a")
  real(dp), parameter :: stored_share = 0.4_dp !! of the fields once compressed: 0.2 to 0.8

  !> Memory of a run by what it is for [bytes].
  type :: memory_need_t
    real(dp) :: program = 0.0_dp !! code and libraries
    real(dp) :: points = 0.0_dp  !! material points and their states
    real(dp) :: mesh = 0.0_dp    !! mesh and what belongs to its elements
    real(dp) :: pattern = 0.0_dp !! tangent and the way into it
    real(dp) :: saving = 0.0_dp  !! while results or a restart file are written
    type(factor_estimate_t) :: factors
  end type memory_need_t

  !> All that is told.
  type :: run_estimate_t
    character(:), allocatable :: job         !! name of the job
    character(:), allocatable :: formulation !! name
    integer :: n_elements = 0
    integer :: n_active = 0                  !! elements that hold material points
    integer :: n_points = 0
    integer :: n_patches = 0
    integer :: n_unknowns = 0
    integer(ip) :: n_nonzeros = 0_ip         !! of the tangent
    type(memory_need_t) :: memory
    real(dp) :: point_seconds = 0.0_dp       !! CPU of points, forces, tangent in an iteration [s]
    real(dp) :: factor_seconds = 0.0_dp      !! CPU of a factorisation, 0 = unknown [s]
    logical  :: keeps_factors = .false.      !! not every iteration makes new factors
    integer  :: n_increments = 0             !! if none is cut, 0 = the deck leaves it to the run
    integer  :: n_outputs = 0                !! increments with fields, 0 = left to the run
    real(dp) :: output_bytes = 0.0_dp        !! fields of one output before compression [bytes]
    real(dp) :: once_bytes = 0.0_dp          !! what is written once, before compression [bytes]
  end type run_estimate_t

contains

  !> Largest memory that is expected: at a factorisation, or when something is written beside
  !! the factors.
  pure real(dp) function expected_peak(need) result(n_bytes)
    type(memory_need_t), intent(in) :: need

    n_bytes = standing(need) + max(need%factors%peak, need%factors%kept + need%saving)
  end function expected_peak

  !> The same at most, whatever pivots the factorisation chooses.
  pure real(dp) function peak_bound(need) result(n_bytes)
    type(memory_need_t), intent(in) :: need

    n_bytes = standing(need) + max(need%factors%peak_bound, need%factors%kept + need%saving)
  end function peak_bound

  !> Memory that is taken all the time.
  pure real(dp) function standing(need) result(n_bytes)
    type(memory_need_t), intent(in) :: need

    n_bytes = need%program + need%points + need%mesh + need%pattern
  end function standing

  !> The table.
  pure function estimate_text(estimate) result(text)
    type(run_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text

    text = estimate%job//" ("//estimate%formulation//"): estimate, nothing was solved"// &
           sizes_text(estimate)//factors_text(estimate%memory%factors)// &
           memory_text(estimate%memory)//seconds_text(estimate)//results_text(estimate)
  end function estimate_text

  !> What there is to solve.
  pure function sizes_text(estimate) result(text)
    type(run_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text

    text = row("elements", integer_text(estimate%n_elements)//", "// &
               integer_text(estimate%n_active)//" of them with material points")// &
           row("material points", integer_text(estimate%n_points))// &
           row("patches", integer_text(estimate%n_patches))// &
           row("unknowns", integer_text(estimate%n_unknowns))// &
           row("nonzeros of the tangent", count_text(real(estimate%n_nonzeros, dp)))
  end function sizes_text

  !> What a factorisation takes.
  pure function factors_text(factors) result(text)
    type(factor_estimate_t), intent(in) :: factors
    character(:), allocatable :: text

    text = ""
    if (factors%entries > 0.0_dp) then
      text = row("nonzeros of the factors", count_text(factors%entries)// &
                 bound_text(factors, count_text(factors%entries_bound)))// &
             row("flops of a factorisation", short_text(factors%flops)// &
                 bound_text(factors, short_text(factors%flops_bound)))
    end if
    text = text//row("memory of a factorisation", size_text(factors%peak)// &
                     bound_text(factors, size_text(factors%peak_bound)))
  end function factors_text

  !> A bound behind what is expected, where one is known.
  pure function bound_text(factors, bound) result(text)
    type(factor_estimate_t), intent(in) :: factors
    character(*), intent(in) :: bound
    character(:), allocatable :: text

    text = ""
    if (factors%has_bounds) text = ", at most "//bound
  end function bound_text

  !> Memory of the run and its parts.
  pure function memory_text(need) result(text)
    type(memory_need_t), intent(in) :: need
    character(:), allocatable :: text

    text = row("memory of the run", size_text(expected_peak(need))// &
               bound_text(need%factors, size_text(peak_bound(need))))// &
           row("  program", size_text(need%program))// &
           row("  points", size_text(need%points))// &
           row("  mesh", size_text(need%mesh))// &
           row("  tangent", size_text(need%pattern))// &
           row("  factorisation", size_text(need%factors%peak))// &
           row("  or factors and writing", size_text(need%factors%kept + need%saving))
  end function memory_text

  !> Time of a Newton iteration that factorises.
  pure function seconds_text(estimate) result(text)
    type(run_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text

    if (estimate%factor_seconds <= 0.0_dp) then
      text = row("CPU seconds of an iteration", "points about "// &
                 short_text(estimate%point_seconds)//", factorisation unknown")
      return
    end if
    text = "about "//short_text(estimate%point_seconds + estimate%factor_seconds)//": points "// &
           short_text(estimate%point_seconds)//", factorisation "// &
           short_text(estimate%factor_seconds)
    if (estimate%keeps_factors) text = text//", not in each"
    text = row("CPU seconds of an iteration", text)
  end function seconds_text

  !> What is written.
  pure function results_text(estimate) result(text)
    type(run_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text
    real(dp) :: n_bytes

    if (estimate%n_increments == 0) then
      text = row("increments", "as many as the run needs")// &
             row("results on disk", "about "//size_text(stored_share*estimate%output_bytes)// &
                 " for each output of fields, at most "//size_text(estimate%output_bytes))
    else
      n_bytes = estimate%once_bytes + real(estimate%n_outputs, dp)*estimate%output_bytes
      text = row("increments", integer_text(estimate%n_increments)//" if none is cut")// &
             row("outputs of fields", integer_text(estimate%n_outputs))// &
             row("results on disk", "about "//size_text(stored_share*n_bytes)//", at most "// &
                 size_text(n_bytes)// &
                 ", twice that while the run writes")
    end if
  end function results_text

  !> A line of the table.
  pure function row(name, value) result(text)
    character(*), intent(in) :: name, value
    character(:), allocatable :: text
    character(30) :: column

    column = "  "//name
    text = line_end//column//value
  end function row

  !> A count: whole below a million.
  pure function count_text(n) result(text)
    real(dp), intent(in) :: n
    character(:), allocatable :: text

    if (n < 1.0e6_dp) then
      text = integer_text(nint(n))
    else
      text = short_text(n)
    end if
  end function count_text

  !> A number to three digits.
  pure function short_text(value) result(text)
    real(dp), intent(in) :: value !! positive or zero
    character(:), allocatable :: text
    real(dp) :: scale

    text = "0"
    if (value <= 0.0_dp) return
    scale = 10.0_dp**(2 - floor(log10(value)))
    text = real_text(anint(value*scale)/scale)
  end function short_text

  !> An amount of memory in MB or GB.
  pure function size_text(n_bytes) result(text)
    real(dp), intent(in) :: n_bytes !! [bytes]
    character(:), allocatable :: text

    if (n_bytes < 1.0e9_dp) then
      text = short_text(n_bytes/1.0e6_dp)//" MB"
    else
      text = short_text(n_bytes/1.0e9_dp)//" GB"
    end if
  end function size_text

end module mpm_run_estimate
