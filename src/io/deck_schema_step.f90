!> Keywords of steps, output and proof.
module mpm_deck_schema_step
  use mpm_deck_schema_rule, only: add_field, add_keyword, add_layout, add_parameter, in_both, &
    in_step, layout_t, once_in_scope, once_never, schema_t, value_choice, value_flag, &
    value_integer, value_item, value_name, value_new_name, value_real, value_reals, value_rule_t
  implicit none
  private
  public :: add_step_keywords

  integer, parameter :: many = huge(1) !! any number of lines

contains

  !> Adds the keywords of steps, output and proof.
  pure subroutine add_step_keywords(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_step(schema)
    call add_controls(schema)
    call add_boundary(schema)
    call add_nodal_load(schema)
    call add_body_load(schema)
    call add_surface_load(schema)
    call add_output(schema)
    call add_history(schema)
    call add_restart(schema)
    call add_expectation(schema)
    call add_keyword(schema, "END STEP", "step", in_step, once_never, "Ends a step.")
  end subroutine add_step_keywords

  !> *STEP, *STATIC and *GEOSTATIC.
  pure subroutine add_step(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "STEP", "step", in_both, once_never, &
                     "Begins a step; conditions of earlier steps stay in force.")
    call add_parameter(schema, value_rule_t("NAME", value_new_name, required=.false., &
                                            meaning="name of the step"))
    call add_parameter(schema, value_rule_t("INC", value_integer, required=.false., range="> 0", &
                                            default="100", meaning="most increments of the step"))
    call add_keyword(schema, "STATIC", "step", in_step, once_in_scope, &
                     "Quasi-static equilibrium; every step needs it or *GEOSTATIC.")
    call add_parameter(schema, value_rule_t("DIRECT", value_flag, required=.false., &
                                            meaning="equal increments, cut only when one fails"))
    call add_schedule(schema, 1)
    call add_keyword(schema, "GEOSTATIC", "step", in_step, once_in_scope, &
                     "Equilibrium of an initial stress, in place of *STATIC: loads are in "// &
                     "force from the beginning of the step.")
    call add_parameter(schema, value_rule_t("UTOL", value_real, required=.false., range="> 0", &
                                            meaning="largest displacement of a point accepted"))
    call add_schedule(schema, 0)
  end subroutine add_step

  !> The data line of *STATIC and *GEOSTATIC.
  pure subroutine add_schedule(schema, n_least)
    type(schema_t), intent(inout) :: schema  !! its last keyword gets a data line
    integer, intent(in)           :: n_least !! 1: it must be there; 0: it may

    call add_layout(schema, n_least, 1, layout_t())
    call add_field(schema, value_rule_t("initial", value_real, range="> 0", &
                                        meaning="first increment of time"))
    call add_field(schema, value_rule_t("period", value_real, range="> 0", &
                                        meaning="length of the step"))
    call add_field(schema, value_rule_t("minimum", value_real, required=.false., range="> 0", &
                                        meaning="smallest increment"))
    call add_field(schema, value_rule_t("maximum", value_real, required=.false., range="> 0", &
                                        meaning="largest increment"))
  end subroutine add_schedule

  !> *CONTROLS.
  pure subroutine add_controls(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "CONTROLS", "step", in_step, once_in_scope, &
                     "Controls of Newton's method.")
    call add_parameter(schema, value_rule_t("TOLERANCE", value_real, required=.false., &
                                            range="> 0, < 1", default="1e-9", &
                                            meaning="residual over external force and reactions"))
    call add_parameter(schema, value_rule_t("MAX ITERATIONS", value_integer, required=.false., &
                                            range="> 0", default="20", &
                                            meaning="corrections in one increment"))
    call add_parameter(schema, value_rule_t("MAX BACKTRACKS", value_integer, required=.false., &
                                            range=">= 0", default="8", &
                                            meaning="halvings of one correction"))
    call add_parameter(schema, value_rule_t("MAX STRETCH", value_real, required=.false., &
                                            range="> 0", default="2.0", &
                                            meaning="logarithmic stretch in one increment"))
    call add_parameter(schema, value_rule_t("PREDICTION", value_choice, required=.false., &
                                            choices="ON|OFF", default="ON", &
                                            meaning="start from the last increment"))
    call add_parameter(schema, value_rule_t("LINEAR SOLVER", value_choice, required=.false., &
                                            choices="DIRECT|RECYCLED|MUMPS", &
                                            meaning="without: by the number of unknowns"))
    call add_parameter(schema, value_rule_t("EIGENVALUES", value_flag, required=.false., &
                                            meaning="eigenvalues of the tangent in the log"))
    call add_parameter(schema, value_rule_t("RESET", value_flag, required=.false., &
                                            meaning="the others go back to their defaults first"))
  end subroutine add_controls

  !> *BOUNDARY.
  pure subroutine add_boundary(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "BOUNDARY", "step", in_both, once_never, &
                     "Prescribed displacements: fixed in the model part, totals reached at the "// &
                     "end of the step inside a step.")
    call add_load_parameters(schema)
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("set", value_item, meaning="node set or node"))
    call add_field(schema, value_rule_t("first", value_integer, range=">= 1, <= 3", &
                                        meaning="first direction"))
    call add_field(schema, value_rule_t("last", value_integer, required=.false., &
                                        range=">= 1, <= 3", meaning="last one, default first"))
    call add_field(schema, value_rule_t("value", value_real, required=.false., default="0", &
                                        meaning="displacement"))
  end subroutine add_boundary

  !> The parameters that conditions share.
  pure subroutine add_load_parameters(schema)
    type(schema_t), intent(inout) :: schema !! its last keyword gets the parameters

    call add_parameter(schema, value_rule_t("AMPLITUDE", value_name, required=.false., &
                                            meaning="factor over time; without: a ramp"))
    call add_parameter(schema, value_rule_t("OP", value_choice, required=.false., &
                                            choices="MOD|NEW", default="MOD", &
                                            meaning="add to earlier conditions, or replace all"))
  end subroutine add_load_parameters

  !> *CLOAD.
  pure subroutine add_nodal_load(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "CLOAD", "step", in_step, once_never, "Forces on nodes.")
    call add_load_parameters(schema)
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("set", value_item, meaning="node set or node"))
    call add_field(schema, value_rule_t("direction", value_integer, range=">= 1, <= 3", &
                                        meaning="direction of the force"))
    call add_field(schema, value_rule_t("value", value_real, meaning="force on each node"))
  end subroutine add_nodal_load

  !> *DLOAD.
  pure subroutine add_body_load(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "DLOAD", "step", in_step, once_never, "Weight of the material.")
    call add_load_parameters(schema)
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("set", value_name, meaning="element set"))
    call add_field(schema, value_rule_t("type", value_choice, choices="GRAV", &
                                        meaning="acceleration on the mass"))
    call add_field(schema, value_rule_t("magnitude", value_real, meaning="acceleration"))
    call add_direction(schema)
  end subroutine add_body_load

  !> The fields of a direction.
  pure subroutine add_direction(schema)
    type(schema_t), intent(inout) :: schema !! its last layout gets the fields

    call add_field(schema, value_rule_t("x", value_real, meaning="direction"))
    call add_field(schema, value_rule_t("y", value_real, meaning="direction"))
    call add_field(schema, value_rule_t("z", value_real, required=.false., &
                                        meaning="direction, in 3-D"))
  end subroutine add_direction

  !> *DSLOAD.
  pure subroutine add_surface_load(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "DSLOAD", "step", in_step, once_never, &
                     "Dead tractions on a surface.")
    call add_load_parameters(schema)
    call add_parameter(schema, value_rule_t("CARRIER", value_choice, required=.false., &
                                            choices="MESH|POINTS", default="MESH", &
                                            meaning="faces of the mesh, or points of the body"))
    call add_layout(schema, 1, many, layout_t(field_number=2, field_value="TRVEC"))
    call add_field(schema, value_rule_t("surface", value_name, meaning="surface"))
    call add_field(schema, value_rule_t("type", value_choice, choices="P|TRVEC", &
                                        meaning="traction vector"))
    call add_field(schema, value_rule_t("magnitude", value_real, meaning="force per initial area"))
    call add_direction(schema)
    call add_layout(schema, 1, many, layout_t(field_number=2, field_value="P"))
    call add_field(schema, value_rule_t("surface", value_name, meaning="surface"))
    call add_field(schema, value_rule_t("type", value_choice, choices="P|TRVEC", &
                                        meaning="pressure"))
    call add_field(schema, value_rule_t("value", value_real, meaning="positive towards the body"))
  end subroutine add_surface_load

  !> *OUTPUT.
  pure subroutine add_output(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "OUTPUT", "output", in_step, once_in_scope, &
                     "Fields of material points in the results; without lines all of them.")
    call add_parameter(schema, value_rule_t("FIELD", value_flag, meaning="fields"))
    call add_parameter(schema, value_rule_t("FREQUENCY", value_integer, required=.false., &
                                            group=1, range=">= 0", default="1", &
                                            meaning="every so many increments; 0 = the last"))
    call add_parameter(schema, value_rule_t("TIME INTERVAL", value_real, required=.false., &
                                            group=1, range="> 0", &
                                            meaning="at multiples of this step time"))
    call add_parameter(schema, value_rule_t("PRECISION", value_choice, required=.false., &
                                            choices="SINGLE|DOUBLE", default="DOUBLE", &
                                            meaning="of the values; one in all steps"))
    call add_layout(schema, 0, many, layout_t(repeats=.true.))
    call add_field(schema, value_rule_t("field", value_choice, meaning="name of a field", &
      choices="S|TAU|LE|PEEQ|F|J|JBAR|U|VOL|MAT|PATCH|ELEMENT|ID"))
  end subroutine add_output

  !> *HISTORY.
  pure subroutine add_history(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "HISTORY", "output", in_step, once_never, &
                     "Quantities over time in the history file.")
    call add_parameter(schema, value_rule_t("NSET", value_name, group=1, meaning="node set"))
    call add_parameter(schema, value_rule_t("SURFACE", value_name, group=1, &
                                            meaning="nodes of a surface"))
    call add_parameter(schema, value_rule_t("POINT", value_reals, group=1, &
                                            meaning="material point nearest to x,y[,z]"))
    call add_layout(schema, 1, many, layout_t("POINT", repeats=.true.))
    call add_field(schema, value_rule_t("quantity", value_choice, meaning="of a material point", &
                                        choices="S|TAU|LE|PEEQ|F|J|JBAR|U|VOL"))
    call add_layout(schema, 1, many, layout_t(repeats=.true.))
    call add_field(schema, value_rule_t("quantity", value_choice, choices="RF|U", &
                                        meaning="sum of reactions, mean displacement"))
  end subroutine add_history

  !> *RESTART.
  pure subroutine add_restart(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "RESTART", "output", in_step, once_in_scope, &
                     "When a restart file is written; without: every 10 minutes.")
    call add_parameter(schema, value_rule_t("WRITE", value_flag, meaning="restart files"))
    call add_parameter(schema, value_rule_t("FREQUENCY", value_integer, required=.false., &
                                            range=">= 0", default="1", &
                                            meaning="every so many increments; 0 = the last"))
  end subroutine add_restart

  !> *EXPECT.
  pure subroutine add_expectation(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "EXPECT", "proof", in_step, once_never, &
                     "A value that the run must reach; a miss ends it with exit code 7.")
    call add_parameter(schema, value_rule_t("QUANTITY", value_choice, &
      choices="RF|U|S|TAU|LE|PEEQ|F|J|JBAR|VOL|CHECKERBOARD|GHOST SHARE|BALANCE", &
                                            meaning="quantity"))
    call add_parameter(schema, value_rule_t("SET", value_name, required=.false., &
                                            meaning="node or element set; without: all points"))
    call add_parameter(schema, value_rule_t("COMPONENT", value_integer, required=.false., &
                                            range=">= 1, <= 9", meaning="component"))
    call add_parameter(schema, value_rule_t("TIME", value_real, required=.false., range=">= 0", &
                                            meaning="total time; without: end of the step"))
    call add_parameter(schema, value_rule_t("STATISTIC", value_choice, required=.false., &
                                            choices="SUM|MEAN|MIN|MAX|STD", &
                                            meaning="over the set; without: SUM of RF, else MEAN"))
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("source", value_choice, choices="ANALYTIC|FROZEN", &
                                        meaning="exact value, or value of an earlier run"))
    call add_field(schema, value_rule_t("value", value_real, meaning="expected value"))
    call add_field(schema, value_rule_t("rtol", value_real, range=">= 0", &
                                        meaning="relative tolerance"))
    call add_field(schema, value_rule_t("atol", value_real, required=.false., range=">= 0", &
                                        default="0", meaning="absolute tolerance"))
  end subroutine add_expectation

end module mpm_deck_schema_step
