!> Keywords of the method, materials and tables.
module mpm_deck_schema_model
  use mpm_deck_schema_rule, only: add_field, add_keyword, add_layout, add_parameter, in_both, &
    in_model, layout_t, once_in_deck, once_in_scope, once_never, schema_t, value_choice, &
    value_flag, value_integer, value_name, value_new_name, value_real, value_reals, value_rule_t
  implicit none
  private
  public :: add_model_keywords

  integer, parameter :: many = huge(1) !! any number of lines

contains

  !> Adds the keywords of the method, materials and tables.
  pure subroutine add_model_keywords(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_formulation(schema)
    call add_material_points(schema)
    call add_motion_and_loss(schema)
    call add_keyword(schema, "LOCKING METER", "method", in_model, once_in_deck, &
                     "Writes into the log after every increment how far the mesh is from locking.")
    call add_ghost_penalty(schema)
    call add_material(schema)
    call add_plastic(schema)
    call add_amplitude(schema)
    call add_transform(schema)
    call add_initial_conditions(schema)
  end subroutine add_model_keywords

  !> *FORMULATION and *PATCH.
  pure subroutine add_formulation(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "FORMULATION", "method", in_model, once_in_deck, &
                     "The formulation of the material point method.")
    call add_parameter(schema, value_rule_t("TYPE", value_choice, choices="STANDARD|FBAR PATCH", &
                                            meaning="plain, or volume change averaged on patches"))
    call add_keyword(schema, "PATCH", "method", in_model, once_in_deck, &
                     "Where the patches of elements come from.")
    call add_parameter(schema, value_rule_t("SOURCE", value_choice, &
                                            choices="QUADRATIC|METIS|NONE", &
                                            meaning="quadratic elements, graph partition, or none"))
    call add_parameter(schema, value_rule_t("SIZE", value_integer, required=.false., &
                                            range="> 0", default="8", only_with="SOURCE=METIS", &
                                            meaning="elements of a patch"))
  end subroutine add_formulation

  !> *MATERIAL POINTS.
  pure subroutine add_material_points(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "MATERIAL POINTS", "method", in_model, once_never, &
                     "Fills the elements of a set with material points.")
    call add_parameter(schema, value_rule_t("ELSET", value_name, meaning="elements to fill"))
    call add_parameter(schema, value_rule_t("MATERIAL", value_name, &
                                            meaning="material of the points"))
    call add_parameter(schema, value_rule_t("PER ELEMENT", value_integer, range="> 0", &
                                            meaning="points of a linear element"))
  end subroutine add_material_points

  !> *MOVING MESH and *LOST POINTS.
  pure subroutine add_motion_and_loss(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "MOVING MESH", "method", in_model, once_in_deck, &
                     "Lays the mesh out anew after every increment: it follows a driver plane "// &
                     "or the body.")
    call add_parameter(schema, value_rule_t("TYPE", value_choice, required=.false., &
                                            choices="DRIVER|LAGRANGIAN", default="DRIVER", &
                                            meaning="follows a plane, or goes with the body"))
    call add_parameter(schema, value_rule_t("DRIVER", value_name, only_with="TYPE=DRIVER", &
                                            meaning="node set of the plane that moves"))
    call add_parameter(schema, value_rule_t("DIRECTION", value_reals, only_with="TYPE=DRIVER", &
                                            meaning="normal, x,y[,z]"))
    call add_parameter(schema, value_rule_t("FIXED", value_name, only_with="TYPE=DRIVER", &
                                            meaning="node set of the plane that stays"))
    call add_keyword(schema, "LOST POINTS", "method", in_model, once_in_deck, &
                     "What happens to a material point outside the mesh.")
    call add_parameter(schema, value_rule_t("ACTION", value_choice, &
                                            choices="ERROR|FREEZE|REMOVE", &
                                            meaning="end the run, keep it inactive, drop it"))
    call add_parameter(schema, value_rule_t("TOLERANCE", value_real, required=.false., &
                                            range=">= 0", default="0.1", &
                                            meaning="distance over element size that is no loss"))
  end subroutine add_motion_and_loss

  !> *GHOST PENALTY.
  pure subroutine add_ghost_penalty(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "GHOST PENALTY", "method", in_model, once_in_deck, &
                     "Holds the displacement gradients of elements at the edge of the body "// &
                     "together.")
    call add_parameter(schema, value_rule_t("GAMMA", value_real, required=.false., range="> 0", &
                                            default="5e-4", &
                                            meaning="factor; without, it may be raised"))
  end subroutine add_ghost_penalty

  !> *MATERIAL, *DENSITY and *ELASTIC.
  pure subroutine add_material(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "MATERIAL", "material", in_model, once_never, &
                     "Begins a material; its properties follow.")
    call add_parameter(schema, value_rule_t("NAME", value_new_name, meaning="name of the material"))
    call add_keyword(schema, "DENSITY", "material", in_model, once_in_scope, &
                     "Mass density.", parent="MATERIAL")
    call add_layout(schema, 1, 1, layout_t())
    call add_field(schema, value_rule_t("density", value_real, range=">= 0", &
                                        meaning="mass per volume"))
    call add_keyword(schema, "ELASTIC", "material", in_model, once_in_scope, &
                     "Isotropic elasticity in logarithmic strain and Kirchhoff stress.", &
                     parent="MATERIAL")
    call add_layout(schema, 1, 1, layout_t())
    call add_field(schema, value_rule_t("E", value_real, range="> 0", meaning="Young's modulus"))
    call add_field(schema, value_rule_t("nu", value_real, range="> -1, < 0.5", &
                                        meaning="Poisson's ratio"))
  end subroutine add_material

  !> *PLASTIC.
  pure subroutine add_plastic(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "PLASTIC", "material", in_model, once_in_scope, &
                     "Plasticity; one line is perfect, several are linear between and constant "// &
                     "beyond the last.", parent="MATERIAL")
    call add_parameter(schema, value_rule_t("LAW", value_choice, choices="VON MISES", &
                                            meaning="yield condition"))
    call add_parameter(schema, value_rule_t("STRENGTH", value_choice, &
                                            choices="UNIAXIAL|SHEAR|RADIUS", &
                                            meaning="sqrt(3 J2), sqrt(J2) or sqrt(2 J2) at yield"))
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("stress", value_real, range="> 0", &
                                        meaning="strength in that measure"))
    call add_field(schema, value_rule_t("plastic strain", value_real, required=.false., &
                                        range=">= 0", default="0", &
                                        meaning="work-conjugate accumulated plastic strain"))
  end subroutine add_plastic

  !> *AMPLITUDE.
  pure subroutine add_amplitude(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "AMPLITUDE", "tables", in_both, once_never, &
                     "A factor over step time, linear between its pairs and constant outside.")
    call add_parameter(schema, value_rule_t("NAME", value_new_name, &
                                            meaning="name of the amplitude"))
    call add_layout(schema, 1, many, layout_t(repeats=.true.))
    call add_field(schema, value_rule_t("time", value_real, range=">= 0", meaning="step time"))
    call add_field(schema, value_rule_t("factor", value_real, meaning="factor at that time"))
  end subroutine add_amplitude

  !> *TRANSFORM.
  pure subroutine add_transform(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "TRANSFORM", "tables", in_model, once_never, &
                     "Gives nodes axes of their own; *BOUNDARY and *CLOAD on them mean these.")
    call add_parameter(schema, value_rule_t("NSET", value_name, meaning="nodes"))
    call add_parameter(schema, value_rule_t("TYPE", value_choice, required=.false., &
                                            choices="R|C|S", default="R", &
                                            meaning="rectangular, cylindrical or spherical"))
    call add_layout(schema, 1, 1, layout_t())
    call add_field(schema, value_rule_t("xa", value_real, meaning="point a"))
    call add_field(schema, value_rule_t("ya", value_real, meaning="point a"))
    call add_field(schema, value_rule_t("za", value_real, required=.false., &
                                        meaning="point a; in a plane mesh it may be left out"))
    call add_field(schema, value_rule_t("xb", value_real, required=.false., meaning="point b"))
    call add_field(schema, value_rule_t("yb", value_real, required=.false., meaning="point b"))
    call add_field(schema, value_rule_t("zb", value_real, required=.false., &
                                        meaning="point b; in a plane mesh it may be left out"))
  end subroutine add_transform

  !> *INITIAL CONDITIONS.
  pure subroutine add_initial_conditions(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword
    character(3), parameter :: component(6) = ["s11", "s22", "s33", "s12", "s23", "s13"]
    integer :: i

    call add_keyword(schema, "INITIAL CONDITIONS", "tables", in_model, once_never, &
                     "Cauchy stress with which the points of a set start.")
    call add_parameter(schema, value_rule_t("TYPE", value_choice, choices="STRESS", &
                                            meaning="what is given"))
    call add_parameter(schema, value_rule_t("GEOSTATIC", value_flag, required=.false., &
                                            meaning="linear in the height"))
    call add_layout(schema, 1, many, layout_t("GEOSTATIC"))
    call add_field(schema, value_rule_t("set", value_name, meaning="element set"))
    call add_field(schema, value_rule_t("s_1", value_real, &
                                        meaning="vertical stress at the first height"))
    call add_field(schema, value_rule_t("height_1", value_real, meaning="z, in plane strain y"))
    call add_field(schema, value_rule_t("s_2", value_real, &
                                        meaning="vertical stress at the second height"))
    call add_field(schema, value_rule_t("height_2", value_real, meaning="another one"))
    call add_field(schema, value_rule_t("K0", value_real, range=">= 0", &
                                        meaning="horizontal over vertical stress"))
    call add_field(schema, value_rule_t("K0_2", value_real, required=.false., range=">= 0", &
      meaning="the same in y, in plane strain out of the plane; default K0"))
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("set", value_name, meaning="element set"))
    do i = 1, 6
      call add_field(schema, value_rule_t(component(i), value_real, required=i < 4, &
                                          default=merge("0", " ", i > 3), meaning="component"))
    end do
  end subroutine add_initial_conditions

end module mpm_deck_schema_model
