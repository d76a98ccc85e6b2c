!> Where a run failed and why, in words and in the numbers of the input.
module mpm_failure_text
  use mpm_failure_evidence, only: failure_evidence_t
  use mpm_increments, only: schedule_t
  use mpm_kinds, only: dp
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_model, only: model_t
  use mpm_newton_report, only: newton_report_t, outcome_converged, outcome_inverted, &
    outcome_iterations, outcome_material, outcome_memory, outcome_not_finite, outcome_singular, &
    outcome_stretched
  use mpm_place_text, only: place_text
  use mpm_support_check, only: find_free_modes, find_hinge, suggest_support
  use mpm_system, only: body_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: causes_text, count_cause, element_label, free_modes_text, place_of_failure

  character(*), parameter :: line_end = new_line("a")
  character(*), parameter :: bullet = "  likely cause: "

contains

  !> The worst node, element and point with their places; empty if there are none.
  pure function place_of_failure(evidence, mesh, points) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    type(mesh_t), intent(in)   :: mesh    !! as the attempt found it
    type(points_t), intent(in) :: points  !! converged
    character(:), allocatable :: text

    text = ""
    if (evidence%node > 0) text = text//", node "//integer_text(mesh%node_label(evidence%node))// &
      " at ("//place_text(mesh%x(:, evidence%node))//")"
    if (evidence%element > 0) text = text//", element "// &
      integer_text(element_label(mesh, evidence%element))//" at ("// &
      place_text(centre_of(mesh, evidence%element))//")"
    if (evidence%point > 0) text = text//", material point "// &
      integer_text(points%id(evidence%point))//" at ("//place_text(points%x(:, evidence%point))//")"
    if (len(text) > 0) text = text(3:)
  end function place_of_failure

  !> Number of an element in the input.
  pure integer function element_label(mesh, element) result(label)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: element !! linear element

    label = mesh%parent_label(mesh%parent(element))
  end function element_label

  !> Centroid of an element.
  pure function centre_of(mesh, element) result(x)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: element
    real(dp) :: x(mesh%n_dim) !! (n_dim)  [length]

    x = sum(mesh%x(:, mesh%node(:, element)), dim=2)/real(mesh%n_dim + 1, dp)
  end function centre_of

  !> Causes that the evidence speaks for, a line each; a line that says so if there is none.
  pure function causes_text(evidence, modes, report, body, model, schedule) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    character(*), intent(in)          :: modes    !! of free_modes_text
    type(newton_report_t), intent(in) :: report   !! of the last attempt
    type(body_t), intent(in)          :: body     !! as the attempt found it
    type(model_t), intent(in)         :: model    !! controls of the step
    type(schedule_t), intent(in)      :: schedule !! with the size of the attempt
    character(:), allocatable :: text

    text = ""
    if (len(modes) > 0) text = text//line_end//bullet//modes
    if (evidence%outcome == outcome_converged .or. evidence%outcome == outcome_memory) return
    if (evidence%empty_element > 0) text = text//line_end//bullet//empty_text(evidence, body)
    if (evidence%limit_load) text = text//line_end//bullet//"load control has met a limit "// &
      "load: expected loads below it, or a prescribed displacement in place of the load"
    if (is_too_large(evidence)) text = text//line_end//bullet//size_text(evidence, schedule)
    text = text//newton_text(evidence, report, model, schedule)
    if (len(text) == 0) text = line_end//bullet//"none of those looked for (free modes, "// &
      "nearly empty elements, size of the increment, rate of convergence)"
  end function causes_text

  !> Causes that Newton's method shows.
  pure function newton_text(evidence, report, model, schedule) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    type(newton_report_t), intent(in) :: report   !! of the last attempt
    type(model_t), intent(in)         :: model    !! controls of the step
    type(schedule_t), intent(in)      :: schedule !! number of the step
    character(:), allocatable :: text

    text = ""
    if (evidence%ratio > 0.0_dp) text = text//line_end//bullet//"the tangent is not quadratic: "// &
      "the last residuals fell only to "//real_text(evidence%ratio)//" of the one before"// &
      ", as they do where points change between elastic and plastic"
    if (evidence%outcome == outcome_iterations) text = text//line_end//bullet// &
      iterations_text(evidence, report, model%step(schedule%step)%newton%max_iterations, &
                      model%step(schedule%step)%newton%tolerance)
    if (evidence%outcome == outcome_not_finite) text = text//line_end//bullet// &
      "numbers beyond the range of the machine: expected moderate stiffnesses and loads"
  end function newton_text

  !> Whether the way in which the attempt failed speaks for an increment that is too large.
  pure logical function is_too_large(evidence) result(too_large)
    type(failure_evidence_t), intent(in) :: evidence

    select case (evidence%outcome)
    case (outcome_singular, outcome_not_finite)
      too_large = .false.
    case (outcome_inverted, outcome_material, outcome_stretched)
      too_large = .true.
    case default
      too_large = evidence%overshot
    end select
  end function is_too_large

  !> An element that hardly holds material.
  pure function empty_text(evidence, body) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    type(body_t), intent(in) :: body !! as the attempt found it
    character(:), allocatable :: text

    text = "element "//integer_text(element_label(body%mesh, evidence%empty_element))// &
           " is nearly empty, its points fill "//real_text(100.0_dp*evidence%fill)//" % of it"
    if (body%ghost_gamma <= 0.0_dp) text = text//": expected *GHOST PENALTY"
  end function empty_text

  !> An increment that is too large, and how it can become smaller.
  pure function size_text(evidence, schedule) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    type(schedule_t), intent(in) :: schedule !! size of the attempt
    character(:), allocatable :: text

    text = "the increment is too large: "
    select case (evidence%outcome)
    case (outcome_inverted)
      text = text//"an element turned inside out"
    case (outcome_stretched)
      text = text//"an element was stretched beyond MAX STRETCH of *CONTROLS"
    case (outcome_material)
      text = text//"a point was strained beyond what its material can follow"
    case default
      text = text//"the first correction made the residual larger than the forces"
    end select
    text = text//" at size "//real_text(schedule%size)//", and the smallest size allowed is "// &
           real_text(schedule%settings%minimum)//": expected a smaller one in *STATIC"
  end function size_text

  !> Iterations that did not suffice.
  pure function iterations_text(evidence, report, max_iterations, tolerance) result(text)
    type(failure_evidence_t), intent(in) :: evidence
    type(newton_report_t), intent(in) :: report !! of the attempt
    integer, intent(in)  :: max_iterations      !! of *CONTROLS
    real(dp), intent(in) :: tolerance           !! of *CONTROLS [-]
    character(:), allocatable :: text

    text = "MAX ITERATIONS="//integer_text(max_iterations)//" of *CONTROLS are too few: "// &
           "the residual was "//real_text(report%residual(report%n_iterations))//", allowed is "// &
           real_text(tolerance)
    if (evidence%falling) text = text//", and it was still falling"
  end function iterations_text

  !> Free modes of the material as it is now: of a body, or of a part that hangs by a node. Empty if
  !! all is held. The ghost penalty holds parts that hang by a node.
  pure function free_modes_text(body, model, step) result(text)
    type(body_t), intent(in)  :: body  !! converged
    type(model_t), intent(in) :: model !! constraints and axes
    integer, intent(in)       :: step  !! number of the step
    character(:), allocatable :: text
    character(:), allocatable :: advice, modes
    integer :: element, node

    text = ""
    associate (mesh => body%mesh, points => body%points, constraint => model%step(step)%constraint)
      call find_free_modes(modes, element, mesh, points, constraint, model%frames)
      if (element > 0) then
        text = "the body of element "//integer_text(element_label(mesh, element))// &
               " is free to move ("//modes//"): expected *BOUNDARY conditions that hold it "// &
               "where it is now"
        advice = suggest_support(element, mesh, points, constraint, model%frames)
        if (len(advice) > 0) text = text//", such as "//advice
        return
      end if
      if (body%ghost_gamma > 0.0_dp) return
      call find_hinge(modes, element, node, mesh, points, constraint, model%frames)
      if (element > 0) text = "the part of element "//integer_text(element_label(mesh, element))// &
        " hangs by node "//integer_text(mesh%node_label(node))//" only ("//modes// &
        "): expected *GHOST PENALTY, or *BOUNDARY conditions that hold it"
    end associate
  end function free_modes_text

  !> Increments that the rest of a step takes at the present size.
  pure function count_cause(schedule) result(text)
    type(schedule_t), intent(in) :: schedule !! after an accepted increment
    character(:), allocatable :: text
    real(dp) :: rest

    rest = schedule%settings%period - schedule%step_time
    text = line_end//bullet//"the increments are small for the step: the last one had size "// &
           real_text(schedule%size)//", and "//real_text(rest)//" of step time is left"
  end function count_cause

end module mpm_failure_text
