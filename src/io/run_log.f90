!> JOB.log: everything about a run that a reader may ask for later.
module mpm_run_log
  use mpm_error, only: error_t
  use mpm_expectations, only: n_failed_expectations, verdict_line, verdict_t
  use mpm_kinds, only: dp
  use mpm_log_model, only: freedom_ratio_text, model_text, set_text
  use mpm_model, only: model_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_text
  use mpm_run_state, only: run_info_t, run_state_t
  use mpm_text, only: integer_text, real_text
  use mpm_text_file, only: append_to_text_file, close_text_file, open_text_file, text_file_t, &
                           write_line
  implicit none
  private
  public :: run_log_t, attempt_text, close_log, locking_text, log_attempt, log_message
  public :: log_summary, open_log, resume_log

  character(*), parameter :: line_end = new_line("a")

  !> The open log and what it adds up.
  type :: run_log_t
    type(text_file_t) :: file
    real(dp) :: seconds(5) = 0.0_dp !! CPU: kinematics, stress, assembly, factorisation, solve [s]
    real(dp) :: output_seconds = 0.0_dp !! CPU of writing, but for the end of the log [s]
    integer  :: n_attempts = 0      !! increments tried
    integer  :: n_iterations = 0    !! corrections of Newton's method
  end type run_log_t

contains

  !> Opens the log and writes the program, the deck, the warnings about it and the model.
  subroutine open_log(log, path, model, info, error)
    type(run_log_t), intent(out) :: log              !! open
    character(*), intent(in) :: path                 !! file
    type(model_t), intent(in) :: model               !! at time zero
    type(run_info_t), intent(in) :: info             !! deck and program
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call open_text_file(log%file, path, error)
    if (allocated(error)) return
    call write_line(log%file, "Tessera "//info%version//", revision "//info%git//line_end &
                    //"compiler: "//info%compiler//line_end//"libraries: "//info%libraries &
                    //line_end//"started: "//info%started//", threads " &
                    //integer_text(info%n_threads)//line_end//line_end//"deck "//info%deck_name &
                    //line_end//info%deck_text//line_end//"end of deck"//line_end, error)
    if (allocated(error)) return
    if (len(info%warnings) > 0) &
      call log_message(log, "warnings"//line_end//info%warnings//line_end, error)
    if (allocated(error)) return
    call write_line(log%file, model_text(model)//freedom_ratio_text(model)//set_text(model%mesh), &
                    error)
  end subroutine open_log

  !> Opens the log of an interrupted run and writes behind it what goes on.
  subroutine resume_log(log, path, message, error)
    type(run_log_t), intent(out) :: log              !! open
    character(*), intent(in) :: path                 !! file
    character(*), intent(in) :: message              !! without line end
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call append_to_text_file(log%file, path, error)
    ! The last line may have been cut.
    if (.not. allocated(error)) call write_line(log%file, line_end//message, error)
  end subroutine resume_log

  !> Writes a text as it is.
  subroutine log_message(log, message, error)
    type(run_log_t), intent(in) :: log               !! open
    character(*), intent(in) :: message              !! without line end
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call write_line(log%file, message, error)
  end subroutine log_message

  !> Writes the iterations of an attempt at an increment and its outcome.
  subroutine log_attempt(log, state, report, error)
    type(run_log_t), intent(inout) :: log            !! adds up iterations and seconds
    type(run_state_t), intent(in)  :: state          !! step, increment, attempt
    type(newton_report_t), intent(in) :: report      !! of the attempt
    type(error_t), allocatable, intent(out) :: error !! exit_file

    log%n_attempts = log%n_attempts + 1
    log%n_iterations = log%n_iterations + report%n_iterations + report%n_given_up &
                       + report%n_inexact
    if (allocated(report%seconds)) log%seconds = log%seconds + sum(report%seconds, 2)
    call write_line(log%file, attempt_text(state, report), error)
  end subroutine log_attempt

  !> Every iteration of an attempt at an increment, and its outcome.
  pure function attempt_text(state, report) result(text)
    type(run_state_t), intent(in)  :: state          !! step, increment, attempt
    type(newton_report_t), intent(in) :: report      !! of the attempt
    character(:), allocatable :: text
    integer :: i

    text = "step "//integer_text(state%step)//" increment "//integer_text(state%increment) &
           //" attempt "//integer_text(state%attempt)//", time "//real_text(state%time)//", size " &
           //real_text(state%size)
    if (allocated(report%residual)) then
      do i = 0, ubound(report%residual, 1)
        text = text//line_end//iteration_text(report, i)
      end do
    end if
    text = text//line_end//"  "//outcome_text(report%outcome)//" after " &
           //integer_text(report%n_iterations)//" iterations"
    if (report%outcome /= outcome_converged) text = text//worst_text(report)
    text = text//start_text(report)//eigenvalues_text(report)
    if (state%n_ghost_pairs >= 0) text = text//line_end//ghost_text(state, report)
  end function attempt_text

  !> Where an attempt started, unless at rest.
  pure function start_text(report) result(text)
    type(newton_report_t), intent(in) :: report !! of the attempt
    character(:), allocatable :: text

    text = ""
    if (report%predicted) text = line_end//"  started from the last increment"
    if (report%n_given_up > 0) text = line_end//"  start from the last increment given up after " &
      & //integer_text(report%n_given_up)//" iterations"
    if (report%n_inexact > 0) text = text//line_end//"  corrections by GMRES given up after "// &
      & integer_text(report%n_inexact)//" iterations, repeated with ten digits"
    if (report%left_single) text = text//line_end//"  factors that are kept are of double "// &
      & "precision from now on: single precision does not serve"
  end function start_text

  !> Pairs of the ghost penalty, and what it carries in an increment that converged.
  pure function ghost_text(state, report) result(text)
    type(run_state_t), intent(in)  :: state     !! pairs and share
    type(newton_report_t), intent(in) :: report !! of the attempt
    character(:), allocatable :: text

    text = "  ghost penalty: "//integer_text(state%n_ghost_pairs)//" pairs"
    if (state%ghost_raise > 1.0_dp) text = text//", raised "//real_text(state%ghost_raise)//"-fold"
    if (report%outcome /= outcome_converged) return
    text = text//", share of the load "//real_text(state%ghost_share_now)
  end function ghost_text

  !> Extreme eigenvalues of the tangent, when they were asked for.
  pure function eigenvalues_text(report) result(text)
    type(newton_report_t), intent(in) :: report !! of the attempt
    character(:), allocatable :: text

    text = ""
    if (.not. report%eigenvalues%asked) return
    text = line_end//"  eigenvalues of the tangent: "
    if (report%eigenvalues%found) then
      text = text//"smallest "//real_text(report%eigenvalues%smallest)//", largest " &
             //real_text(report%eigenvalues%largest)
    else
      text = text//"not found"
    end if
  end function eigenvalues_text

  !> One iteration of Newton's method.
  pure function iteration_text(report, i) result(text)
    type(newton_report_t), intent(in) :: report !! of the attempt
    integer, intent(in) :: i                    !! 0: before the first correction
    character(:), allocatable :: text
    character(40) :: buffer

    write (buffer, "(a,i4,a,es12.5)") "  iteration ", i, " residual ", report%residual(i)
    text = trim(buffer)
    if (allocated(report%flowing)) then
      if (i <= ubound(report%flowing, 1)) then
        text = text//" plastic points "//integer_text(report%flowing(i))
      end if
    end if
    if (i == 0 .or. .not. allocated(report%backtracks)) return
    if (i > size(report%backtracks)) return
    if (report%backtracks(i) > 0) then
      text = text//" backtracks "//integer_text(report%backtracks(i))
    end if
    text = text//linear_text(report, i)
  end function iteration_text

  !> How the system of a correction was solved, where factors are kept.
  pure function linear_text(report, i) result(text)
    type(newton_report_t), intent(in) :: report !! of the attempt
    integer, intent(in) :: i                    !! iteration
    character(:), allocatable :: text

    text = ""
    if (.not. allocated(report%gmres)) return
    if (i > size(report%gmres) .or. all(report%gmres == 0)) return
    if (report%gmres(i) > 0) text = " gmres "//integer_text(report%gmres(i))
    if (report%is_new(i)) text = text//" new factors"
  end function linear_text

  !> Where an attempt failed.
  pure function worst_text(report) result(text)
    type(newton_report_t), intent(in) :: report !! of the attempt
    character(:), allocatable :: text

    text = ""
    if (report%worst_node > 0) text = text//", worst node "//integer_text(report%worst_node)
    if (report%worst_element > 0) text = text//", element "//integer_text(report%worst_element)
    if (report%worst_point > 0) text = text//", point "//integer_text(report%worst_point)
  end function worst_text

  !> What the locking meter shows after an accepted increment.
  pure function locking_text(state) result(text)
    type(run_state_t), intent(in) :: state !! after the increment, metered
    character(:), allocatable :: text

    text = "  locking meter: " &
           //real_text(state%n_unknowns/real(max(1, state%n_constraints), dp)) &
           //" unknowns per constraint, checkerboard " &
           //real_text(state%checkerboard)//" ("//integer_text(state%n_checked)//" elements)"
  end function locking_text

  !> Writes resultants of the node sets, verdicts and the time spent.
  subroutine log_summary(log, model, state, verdicts, exit_code, error)
    type(run_log_t), intent(in) :: log               !! open
    type(model_t), intent(in) :: model               !! node sets
    type(run_state_t), intent(in) :: state           !! at the end of the run
    type(verdict_t), intent(in) :: verdicts(:)       !! of all expectations
    integer, intent(in) :: exit_code                 !! of the program
    type(error_t), allocatable, intent(out) :: error !! exit_file
    character(:), allocatable :: text
    real(dp) :: total_cpu
    integer :: i

    text = line_end//"summary"//line_end//resultant_text(model, state)
    do i = 1, size(verdicts)
      text = text//verdict_line(verdicts(i))//line_end
    end do
    call cpu_time(total_cpu)
    text = text//"expectations: "//integer_text(size(verdicts))//", failed " &
           //integer_text(n_failed_expectations(verdicts))//line_end//"increments: " &
           //integer_text(state%increment_total)//" accepted of "//integer_text(log%n_attempts) &
           //" attempts, "//integer_text(log%n_iterations)//" iterations"//line_end &
           //"cut-backs: "//integer_text(state%n_cuts)//line_end &
           //"lost points: "//integer_text(state%n_lost)//", extrapolated " &
           //integer_text(state%n_extrapolated)//line_end//largest_share_text(state) &
           //"balance of forces: at most "//real_text(state%balance) &
           //" of them is missing in an increment"//line_end &
           //seconds_text(log, state, total_cpu) &
           //"wall time: "//real_text(state%wall_seconds)//" s"//line_end &
           //"exit code: "//integer_text(exit_code)
    call write_line(log%file, text, error)
  end subroutine log_summary

  !> What the ghost penalty carried at most.
  pure function largest_share_text(state) result(text)
    type(run_state_t), intent(in) :: state !! at the end of the run
    character(:), allocatable :: text

    text = ""
    if (state%n_ghost_pairs < 0) return
    text = "ghost penalty: largest share of the load "//real_text(state%ghost_share)//line_end
  end function largest_share_text

  !> CPU seconds by kind of work.
  pure function seconds_text(log, state, total) result(text)
    type(run_log_t), intent(in) :: log     !! seconds of Newton's method and of writing
    type(run_state_t), intent(in) :: state !! seconds of locating points
    real(dp), intent(in) :: total          !! of the program [s]
    character(:), allocatable :: text

    text = "CPU seconds: kinematics "//real_text(log%seconds(1)) &
           //", stress "//real_text(log%seconds(2))//", assembly "//real_text(log%seconds(3)) &
           //", factorisation "//real_text(log%seconds(4))//", solve "//real_text(log%seconds(5)) &
           //", location "//real_text(state%location_seconds)//", output " &
           //real_text(log%output_seconds)//", everything "//real_text(total)//line_end
  end function seconds_text

  !> Sums of the reactions over the node sets that have any.
  pure function resultant_text(model, state) result(text)
    type(model_t), intent(in) :: model     !! node sets
    type(run_state_t), intent(in) :: state !! reactions
    character(:), allocatable :: text
    integer :: i, j

    text = ""
    do i = 1, size(model%mesh%node_set)
      associate (set => model%mesh%node_set(i))
        if (all(abs(state%reaction(:, set%item)) <= 0.0_dp)) cycle
        text = text//"reaction of "//set%name//":"
        do j = 1, size(state%reaction, 1)
          text = text//" "//real_text(sum(state%reaction(j, set%item)))
        end do
        text = text//line_end
      end associate
    end do
  end function resultant_text

  !> Closes the log.
  subroutine close_log(log, error)
    type(run_log_t), intent(inout) :: log            !! closed
    type(error_t), allocatable, intent(out) :: error !! exit_file

    call close_text_file(log%file, error)
  end subroutine close_log

end module mpm_run_log
