!> Keywords of text and mesh, and those for sets.
module mpm_deck_schema_mesh
  use mpm_deck_schema_rule, only: add_field, add_keyword, add_layout, add_parameter, &
    add_text_lines, in_both, in_model, layout_t, once_in_deck, once_never, schema_t, &
    value_choice, value_flag, value_integer, value_item, value_name, value_new_name, value_real, &
    value_rule_t, value_text
  implicit none
  private
  public :: add_mesh_keywords

  integer, parameter :: many = huge(1) !! any number of lines

contains

  !> Adds the keywords of text, mesh and sets.
  pure subroutine add_mesh_keywords(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_text_keywords(schema)
    call add_mesh_file(schema)
    call add_generator(schema)
    call add_nodes(schema)
    call add_elements(schema)
    call add_sets(schema)
    call add_surface(schema)
  end subroutine add_mesh_keywords

  !> *HEADING, *UNITS, *INCLUDE.
  pure subroutine add_text_keywords(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "HEADING", "text", in_model, once_in_deck, &
                     "Title of the analysis: any lines of text.")
    call add_text_lines(schema)
    call add_keyword(schema, "UNITS", "text", in_model, once_in_deck, &
                     "Labels of units: echoed, stored and shown on plots; nothing is converted.")
    call add_parameter(schema, value_rule_t("LENGTH", value_text, required=.false., &
                                            meaning="label of lengths"))
    call add_parameter(schema, value_rule_t("FORCE", value_text, required=.false., &
                                            meaning="label of forces"))
    call add_keyword(schema, "INCLUDE", "text", in_both, once_never, &
                     "Reads another file in place of this line.")
    call add_parameter(schema, value_rule_t("INPUT", value_text, &
                                            meaning="file, relative to the including file"))
  end subroutine add_text_keywords

  !> *MESH.
  pure subroutine add_mesh_file(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "MESH", "mesh", in_model, once_in_deck, &
                     "Reads the mesh from a file; its physical groups become sets.")
    call add_parameter(schema, value_rule_t("FILE", value_text, &
                                            meaning="mesh file, relative to the deck"))
    call add_parameter(schema, value_rule_t("FORMAT", value_choice, required=.false., &
                                            choices="GMSH", default="GMSH", &
                                            meaning="gmsh 2.2 or 4.1, ASCII"))
  end subroutine add_mesh_file

  !> *GENERATE.
  pure subroutine add_generator(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "GENERATE", "mesh", in_model, once_in_deck, &
                     "Makes a graded box of simplices with node sets X0, X1, Y0, Y1, Z0, Z1; "// &
                     "lines of one direction follow each other.")
    call add_parameter(schema, value_rule_t("TYPE", value_choice, choices="BOX", &
                                            meaning="shape"))
    call add_parameter(schema, value_rule_t("DIMENSION", value_choice, choices="2|3", &
                                            meaning="plane strain or solid"))
    call add_parameter(schema, value_rule_t("ORDER", value_choice, required=.false., &
                                            choices="LINEAR|QUADRATIC", default="LINEAR", &
                                            meaning="nodes on corners, or on edges too"))
    call add_parameter(schema, value_rule_t("CELL", value_choice, required=.false., &
                                            choices="5|6", default="6", only_with="DIMENSION=3", &
                                            meaning="tetrahedra of a box cell"))
    call add_parameter(schema, value_rule_t("ORIENTATION", value_choice, required=.false., &
                                            choices="1|2", default="1", &
                                            meaning="which of the two splits of a cell"))
    call add_parameter(schema, value_rule_t("ELSET", value_name, required=.false., &
                                            default="ALL", meaning="set of all elements"))
    call add_layout(schema, 2, many, layout_t())
    call add_field(schema, value_rule_t("direction", value_choice, choices="X|Y|Z", &
                                        meaning="axis that the line cuts"))
    call add_field(schema, value_rule_t("start", value_real, meaning="first coordinate"))
    call add_field(schema, value_rule_t("end", value_real, meaning="last coordinate"))
    call add_field(schema, value_rule_t("cells", value_integer, range="> 0", &
                                        meaning="number of cells"))
    call add_field(schema, value_rule_t("ratio", value_real, required=.false., range="> 0", &
                                        default="1", meaning="last cell over first"))
  end subroutine add_generator

  !> *NODE.
  pure subroutine add_nodes(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "NODE", "mesh", in_model, once_never, "Nodes.")
    call add_parameter(schema, value_rule_t("NSET", value_name, required=.false., &
                                            meaning="node set that they join"))
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("number", value_integer, range="> 0", &
                                        meaning="number of the node"))
    call add_field(schema, value_rule_t("x", value_real, meaning="coordinate"))
    call add_field(schema, value_rule_t("y", value_real, meaning="coordinate"))
    call add_field(schema, value_rule_t("z", value_real, required=.false., &
                                        meaning="coordinate, in 3-D"))
  end subroutine add_nodes

  !> *ELEMENT.
  pure subroutine add_elements(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword
    character(*), parameter :: kinds = &
      "CPE3|CPE6|C3D4|C3D10|T3D2|T3D3|CPS3|CPS6|S3|STRI65"

    call add_keyword(schema, "ELEMENT", "mesh", in_model, once_never, &
                     "Elements; edges and faces of lower dimension carry surfaces.")
    call add_parameter(schema, value_rule_t("TYPE", value_choice, choices=kinds, &
                                            meaning="triangle, tetrahedron or surface carrier"))
    call add_parameter(schema, value_rule_t("ELSET", value_name, required=.false., &
                                            meaning="element set that they join"))
    call add_element_layout(schema, "TYPE=T3D2", 2)
    call add_element_layout(schema, "TYPE=CPE3|CPS3|S3|T3D3", 3)
    call add_element_layout(schema, "TYPE=C3D4", 4)
    call add_element_layout(schema, "TYPE=CPE6|CPS6|STRI65", 6)
    call add_element_layout(schema, "TYPE=C3D10", 10)
  end subroutine add_elements

  !> Data lines of one kind of elements.
  pure subroutine add_element_layout(schema, condition, n_nodes)
    type(schema_t), intent(inout) :: schema !! its last keyword gets a layout
    character(*), intent(in) :: condition   !! types with this number of nodes
    integer, intent(in)      :: n_nodes     !! nodes of an element

    call add_layout(schema, 1, many, layout_t(condition))
    call add_field(schema, value_rule_t("number", value_integer, range="> 0", &
                                        meaning="number of the element"))
    call add_field(schema, value_rule_t("node", value_integer, count=n_nodes, range="> 0", &
                                        meaning="its nodes: corners first, then edges"))
  end subroutine add_element_layout

  !> *NSET and *ELSET.
  pure subroutine add_sets(schema)
    type(schema_t), intent(inout) :: schema !! gets the keywords

    call add_keyword(schema, "NSET", "mesh", in_model, once_never, "A set of nodes.")
    call add_parameter(schema, value_rule_t("NSET", value_name, meaning="name of the set"))
    call add_parameter(schema, value_rule_t("GENERATE", value_flag, required=.false., group=1, &
                                            meaning="lines hold first, last, step"))
    call add_parameter(schema, value_rule_t("ELSET", value_name, required=.false., group=1, &
                                            meaning="takes the nodes of this element set"))
    call add_parameter(schema, value_rule_t("BOX", value_flag, required=.false., group=1, &
                                            meaning="takes the nodes in boxes"))
    call add_layout(schema, 1, many, layout_t("ELSET"))
    call add_range_layout(schema)
    call add_box_layout(schema)
    call add_layout(schema, 1, many, layout_t(repeats=.true.))
    call add_field(schema, value_rule_t("node", value_item, meaning="node, or name of a node set"))

    call add_keyword(schema, "ELSET", "mesh", in_model, once_never, "A set of elements.")
    call add_parameter(schema, value_rule_t("ELSET", value_name, meaning="name of the set"))
    call add_parameter(schema, value_rule_t("GENERATE", value_flag, required=.false., group=1, &
                                            meaning="lines hold first, last, step"))
    call add_parameter(schema, value_rule_t("BOX", value_flag, required=.false., group=1, &
                                            meaning="takes the elements with centroid in boxes"))
    call add_range_layout(schema)
    call add_box_layout(schema)
    call add_layout(schema, 1, many, layout_t(repeats=.true.))
    call add_field(schema, value_rule_t("element", value_item, &
                                        meaning="element, or name of an element set"))
  end subroutine add_sets

  !> Data lines of a set with GENERATE.
  pure subroutine add_range_layout(schema)
    type(schema_t), intent(inout) :: schema !! its last keyword gets a layout

    call add_layout(schema, 1, many, layout_t("GENERATE"))
    call add_field(schema, value_rule_t("first", value_integer, range="> 0", &
                                        meaning="first number"))
    call add_field(schema, value_rule_t("last", value_integer, range="> 0", &
                                        meaning="last number"))
    call add_field(schema, value_rule_t("step", value_integer, required=.false., range="> 0", &
                                        default="1", meaning="from one number to the next"))
  end subroutine add_range_layout

  !> Data lines of a set with BOX.
  pure subroutine add_box_layout(schema)
    type(schema_t), intent(inout) :: schema !! its last keyword gets a layout
    integer :: i

    call add_layout(schema, 1, many, layout_t("BOX"))
    do i = 1, 3
      call add_field(schema, value_rule_t("from "//achar(iachar("w") + i), value_real, &
                                          required=i < 3, meaning="lower limit"))
      call add_field(schema, value_rule_t("to "//achar(iachar("w") + i), value_real, &
                                          required=i < 3, meaning="upper limit"))
    end do
  end subroutine add_box_layout

  !> *SURFACE.
  pure subroutine add_surface(schema)
    type(schema_t), intent(inout) :: schema !! gets the keyword

    call add_keyword(schema, "SURFACE", "mesh", in_model, once_never, &
                     "Element faces under a name, for *DSLOAD and *HISTORY.")
    call add_parameter(schema, value_rule_t("NAME", value_new_name, meaning="name of the surface"))
    call add_parameter(schema, value_rule_t("TYPE", value_choice, required=.false., &
                                            choices="ELEMENT", default="ELEMENT", &
                                            meaning="made of element faces"))
    call add_layout(schema, 1, many, layout_t())
    call add_field(schema, value_rule_t("element", value_item, &
                                        meaning="element or element set; or a set of carriers"))
    call add_field(schema, value_rule_t("face", value_choice, required=.false., &
                                        choices="S1|S2|S3|S4", &
                                        meaning="face of the elements; none for carriers"))
  end subroutine add_surface

end module mpm_deck_schema_mesh
