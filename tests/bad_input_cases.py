"""Broken decks and meshes with the exact messages that they must give.

A case is a deck that works, or nothing, with some texts replaced, and what stderr must hold.
"""

# ruff: noqa: E501
from dataclasses import dataclass, field


@dataclass
class Case:
    """One deck and what it must say."""

    name: str
    base: str
    edits: list  # (old, new): the first place; of a line feed all places
    code: int
    stderr: str
    files: dict = field(default_factory=dict)  # name and text; a name that ends with / is a folder
    arguments: tuple = ()

    def deck(self):
        return edited(self.base, *self.edits)


def edited(source, *edits):
    """Replaces texts, each of which must be there; an empty one stands for an empty source."""
    for old, new in edits:
        assert old in source, old
        source = source.replace(old, new, -1 if old == "\n" else 1)
    return source


def first_lines(source, count):
    return "".join(source.splitlines(keepends=True)[:count])


def text(block):
    """A text that begins in its second line."""
    return block[1:]


# A square in plane strain, pressed together.
PLANE = """\
*HEADING
square
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 1, 2
Y, 0, 1, 2
*FORMULATION, TYPE=STANDARD
*PATCH, SOURCE=NONE
*MATERIAL, NAME=CLAY
*DENSITY
2.0
*ELASTIC
100, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
1.0, 0.0
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1
*STEP, NAME=PUSH, INC=20
*STATIC, DIRECT
1, 1
*BOUNDARY
X0, 1, 1
Y0, 2, 2
Y1, 2, 2, -0.001
*HISTORY, NSET=Y1
RF, U
*OUTPUT, FIELD, FREQUENCY=1
S, PEEQ
*EXPECT, QUANTITY=U, SET=Y1, COMPONENT=2
analytic, -0.001, 1e-9
*END STEP
"""

# A cube.
SOLID = """\
*GENERATE, TYPE=BOX, DIMENSION=3
X, 0, 1, 1
Y, 0, 1, 1
Z, 0, 1, 1
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
X0, 1, 1
Y0, 2, 2
Z0, 3, 3
*END STEP
"""

# Two triangles, a boundary element and a node apart.
NODES = """\
*NODE, NSET=NODES
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
5, 3, 3
*ELEMENT, TYPE=CPE3, ELSET=BODY
1, 1, 2, 3
2, 1, 3, 4
*ELEMENT, TYPE=T3D2, ELSET=TOP
3, 3, 4
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=1
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
1, 1, 2
2, 2, 2
4, 1, 1
*END STEP
"""

# A deck whose mesh is in a file.
MESH_FILE = """\
*MESH, FILE="square.msh"
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=1
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
LEFT, 1, 2
*END STEP
"""

MSH_22 = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "LEFT"
2 2 "BODY"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 1 1 4 1
2 2 2 2 1 1 2 3
3 2 2 2 1 1 3 4
$EndElements
"""

MSH_41 = """\
$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "LEFT"
2 2 "BODY"
$EndPhysicalNames
$Entities
0 1 1 0
1 0 0 0 0 1 0 1 1 0
1 0 0 0 1 1 0 1 2 0
$EndEntities
$Nodes
1 4 1 4
2 1 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
2 3 1 3
1 1 1 1
1 4 1
2 1 2 2
2 1 2 3
3 1 3 4
$EndElements
"""

CASES = [
    Case(
        "elastic_with_one_value",
        PLANE,
        [("100, 0.3", "100")],
        2,
        text("""
job.inp:12:4: error: too few values in a line of *ELASTIC: expected E, nu
   12 | 100
      |    ^
"""),
    ),
    Case(
        "elastic_with_three_values",
        PLANE,
        [("100, 0.3", "100, 0.3, 7")],
        2,
        text("""
job.inp:12:11: error: too many values in a line of *ELASTIC: expected E, nu
   12 | 100, 0.3, 7
      |           ^
"""),
    ),
    Case(
        "elastic_without_data",
        PLANE,
        [("100, 0.3\n", "")],
        2,
        text("""
job.inp:11:1: error: missing data line of *ELASTIC: expected E, nu
   11 | *ELASTIC
      | ^~~~~~~~
"""),
    ),
    Case(
        "elastic_with_two_lines",
        PLANE,
        [("100, 0.3", "100, 0.3\n100, 0.3")],
        2,
        text("""
job.inp:13:1: error: too many data lines of *ELASTIC: expected 1
   13 | 100, 0.3
      | ^~~~~~~~
"""),
    ),
    Case(
        "text_for_modulus",
        PLANE,
        [("100, 0.3", "stiff, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is 'stiff': expected a real > 0
   12 | stiff, 0.3
      | ^~~~~
"""),
    ),
    Case(
        "letter_o_in_number",
        PLANE,
        [("100, 0.3", "1O0, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is '1O0': expected a real > 0
   12 | 1O0, 0.3
      | ^~~
"""),
    ),
    Case(
        "nan",
        PLANE,
        [("100, 0.3", "NaN, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is 'NaN': expected a real > 0
   12 | NaN, 0.3
      | ^~~
"""),
    ),
    Case(
        "infinity",
        PLANE,
        [("100, 0.3", "Inf, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is 'Inf': expected a real > 0
   12 | Inf, 0.3
      | ^~~
"""),
    ),
    Case(
        "repeat_count",
        PLANE,
        [("100, 0.3", "2*3., 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is '2*3.': expected a real > 0
   12 | 2*3., 0.3
      | ^~~~
"""),
    ),
    Case(
        "slash",
        PLANE,
        [("100, 0.3", "/, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is '/': expected a real > 0
   12 | /, 0.3
      | ^
"""),
    ),
    Case(
        "fraction",
        PLANE,
        [("100, 0.3", "100, 1/3")],
        2,
        text("""
job.inp:12:6: error: nu of *ELASTIC is '1/3': expected a real > -1, < 0.5
   12 | 100, 1/3
      |      ^~~
"""),
    ),
    Case(
        "empty_field",
        PLANE,
        [("100, 0.3", ", 0.3")],
        2,
        text("""
job.inp:12:1: error: empty field in a line of *ELASTIC: expected E, a real > 0
   12 | , 0.3
      | ^
"""),
    ),
    Case(
        "overflow",
        PLANE,
        [("100, 0.3", "1e999, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is '1e999': expected a real > 0
   12 | 1e999, 0.3
      | ^~~~~
"""),
    ),
    Case(
        "comma_for_decimal_point",
        PLANE,
        [("100, 0.3", "100,0, 0,3")],
        2,
        text("""
job.inp:12:8: error: too many values in a line of *ELASTIC: expected E, nu
   12 | 100,0, 0,3
      |        ^
"""),
    ),
    Case(
        "poisson_half",
        PLANE,
        [("100, 0.3", "100, 0.5")],
        2,
        text("""
job.inp:12:6: error: nu of *ELASTIC is '0.5': expected a real > -1, < 0.5
   12 | 100, 0.5
      |      ^~~
"""),
    ),
    Case(
        "negative_modulus",
        PLANE,
        [("100, 0.3", "-100, 0.3")],
        2,
        text("""
job.inp:12:1: error: E of *ELASTIC is '-100': expected a real > 0
   12 | -100, 0.3
      | ^~~~
"""),
    ),
    Case(
        "real_for_integer",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 2.5")],
        2,
        text("""
job.inp:4:10: error: cells of *GENERATE is '2.5': expected an integer > 0
    4 | X, 0, 1, 2.5
      |          ^~~
"""),
    ),
    Case(
        "huge_integer",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 99999999999")],
        2,
        text("""
job.inp:4:10: error: cells of *GENERATE is '99999999999': expected an integer > 0
    4 | X, 0, 1, 99999999999
      |          ^~~~~~~~~~~
"""),
    ),
    Case(
        "zero_cells",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 0")],
        2,
        text("""
job.inp:4:10: error: cells of *GENERATE is '0': expected an integer > 0
    4 | X, 0, 1, 0
      |          ^
"""),
    ),
    Case(
        "too_many_cells",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 20000")],
        2,
        text("""
job.inp:4:10: error: 20000 cells in a line: expected at most 10000
    4 | X, 0, 1, 20000
      |          ^~~~~
"""),
    ),
    Case(
        "box_too_large",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 10000"), ("Y, 0, 1, 2", "Y, 0, 1, 10000")],
        2,
        text("""
job.inp:3:1: error: a box of 1e8 cells: expected at most 2e7
    3 | *GENERATE, TYPE=BOX, DIMENSION=2
      | ^~~~~~~~~
"""),
    ),
    Case(
        "box_backwards",
        PLANE,
        [("X, 0, 1, 2", "X, 1, 0, 2")],
        2,
        text("""
job.inp:4:7: error: the line ends at 0, where it starts or before: expected more than 1
    4 | X, 1, 0, 2
      |       ^
"""),
    ),
    Case(
        "box_with_gap",
        PLANE,
        [("X, 0, 1, 2", "X, 0, 1, 2\nX, 1.5, 2, 1")],
        2,
        text("""
job.inp:5:4: error: the line starts at 1.5: expected 1, the end of the line before
    5 | X, 1.5, 2, 1
      |    ^~~
"""),
    ),
    Case(
        "plane_box_with_z",
        PLANE,
        [("Y, 0, 1, 2", "Y, 0, 1, 2\nZ, 0, 1, 2")],
        2,
        text("""
job.inp:6:1: error: a line for z in a plane mesh: expected X or Y, or DIMENSION=3
    6 | Z, 0, 1, 2
      | ^
"""),
    ),
    Case(
        "box_without_y",
        PLANE,
        [("Y, 0, 1, 2", "X, 1, 2, 2")],
        2,
        text("""
job.inp:3:1: error: no cells in direction Y: expected a line 'Y, start, end, cells'
    3 | *GENERATE, TYPE=BOX, DIMENSION=2
      | ^~~~~~~~~
"""),
    ),
    Case(
        "unknown_axis",
        PLANE,
        [("Y, 0, 1, 2", "W, 0, 1, 2")],
        2,
        text("""
job.inp:5:1: error: direction of *GENERATE is 'W': expected X, Y or Z
    5 | W, 0, 1, 2
      | ^
"""),
    ),
    Case(
        "cell_in_plane_box",
        PLANE,
        [("DIMENSION=2", "DIMENSION=2, CELL=5")],
        2,
        text("""
job.inp:3:40: error: CELL of *GENERATE: expected only with DIMENSION=3
    3 | *GENERATE, TYPE=BOX, DIMENSION=2, CELL=5
      |                                        ^
"""),
    ),
    Case(
        "strength_zero",
        PLANE,
        [("1.0, 0.0", "0.0, 0.0")],
        2,
        text("""
job.inp:14:1: error: stress of *PLASTIC is '0.0': expected a real > 0
   14 | 0.0, 0.0
      | ^~~
"""),
    ),
    Case(
        "hardening_not_ascending",
        PLANE,
        [("1.0, 0.0", "1.0, 0.0\n1.2, 0.1\n1.3, 0.1")],
        2,
        text("""
job.inp:16:6: error: plastic strain 0.1 after 0.1: expected ascending plastic strains
   16 | 1.3, 0.1
      |      ^~~
"""),
    ),
    Case(
        "hardening_starts_late",
        PLANE,
        [("1.0, 0.0", "1.0, 0.1")],
        2,
        text("""
job.inp:14:6: error: the table starts with plastic strain 0.1: expected 0
   14 | 1.0, 0.1
      |      ^~~
"""),
    ),
    Case(
        "hardening_without_strain",
        PLANE,
        [("1.0, 0.0", "1.0, 0.0\n1.2")],
        2,
        text("""
job.inp:15:4: error: a table of hardening needs a plastic strain in every line: expected 'yield stress, plastic strain'
   15 | 1.2
      |    ^
"""),
    ),
    Case(
        "first_increment_longer_than_step",
        PLANE,
        [("DIRECT\n1, 1", "DIRECT\n2, 1")],
        2,
        text("""
job.inp:18:1: error: the first increment 2 is longer than the step: expected at most 1
   18 | 2, 1
      | ^
"""),
    ),
    Case(
        "smallest_increment_larger_than_first",
        PLANE,
        [("*STATIC, DIRECT\n1, 1", "*STATIC\n0.1, 1, 0.5")],
        2,
        text("""
job.inp:18:9: error: the smallest increment 0.5 is larger than the first: expected at most 0.1
   18 | 0.1, 1, 0.5
      |         ^~~
"""),
    ),
    Case(
        "largest_increment_with_direct",
        PLANE,
        [("DIRECT\n1, 1", "DIRECT\n0.5, 1, 0.1, 0.5")],
        2,
        text("""
job.inp:18:14: error: a largest increment with DIRECT, where all are equal: expected no fourth value
   18 | 0.5, 1, 0.1, 0.5
      |              ^~~
"""),
    ),
    Case(
        "more_increments_than_inc",
        PLANE,
        [("DIRECT\n1, 1", "DIRECT\n0.01, 1")],
        2,
        text("""
job.inp:18:1: error: the step needs 100 increments, INC allows 20: expected a larger INC on *STEP
   18 | 0.01, 1
      | ^~~~
"""),
    ),
    Case(
        "unknown_points_per_element",
        PLANE,
        [("PER ELEMENT=1", "PER ELEMENT=2")],
        2,
        text("""
job.inp:15:57: error: 2 points per element: expected 1, 3, 4, 6, 12, 16 or another square such as 9 or 25
   15 | *MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=2
      |                                                         ^
"""),
    ),
    Case(
        "no_step",
        PLANE,
        [("*STEP, NAME=PUSH, INC=20\n", "")],
        2,
        text("""
job.inp:16:1: error: *STATIC outside a step: expected between *STEP and *END STEP
   16 | *STATIC, DIRECT
      | ^~~~~~~
job.inp:22:1: error: *HISTORY outside a step: expected between *STEP and *END STEP
   22 | *HISTORY, NSET=Y1
      | ^~~~~~~~
job.inp:24:1: error: *OUTPUT outside a step: expected between *STEP and *END STEP
   24 | *OUTPUT, FIELD, FREQUENCY=1
      | ^~~~~~~
job.inp:26:1: error: *EXPECT outside a step: expected between *STEP and *END STEP
   26 | *EXPECT, QUANTITY=U, SET=Y1, COMPONENT=2
      | ^~~~~~~
job.inp:28:1: error: *END STEP without a step: expected *STEP before it
   28 | *END STEP
      | ^~~~~~~~~
"""),
    ),
    Case(
        "model_without_step",
        "",
        [("", "*HEADING\nno step\n")],
        2,
        text("""
job.inp:2:1: error: nothing to solve: expected *STEP
"""),
    ),
    Case(
        "no_end_step",
        PLANE,
        [("*END STEP\n", "")],
        2,
        text("""
job.inp:16:1: error: *STEP without its end: expected *END STEP
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "end_step_twice",
        PLANE,
        [("*END STEP\n", "*END STEP\n*END STEP\n")],
        2,
        text("""
job.inp:30:1: error: *END STEP without a step: expected *STEP before it
   30 | *END STEP
      | ^~~~~~~~~
"""),
    ),
    Case(
        "step_in_step",
        PLANE,
        [("*BOUNDARY\n", "*STEP\n*STATIC\n1, 1\n*BOUNDARY\n")],
        2,
        text("""
job.inp:19:1: error: *STEP inside a step: expected *END STEP before it
   19 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "no_static",
        PLANE,
        [("*STATIC, DIRECT\n1, 1\n", "")],
        2,
        text("""
job.inp:16:1: error: step without procedure: expected *STATIC or *GEOSTATIC in it
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "two_static",
        PLANE,
        [("*STATIC, DIRECT\n1, 1\n", "*STATIC, DIRECT\n1, 1\n*STATIC\n1, 1\n")],
        2,
        text("""
job.inp:19:1: error: duplicate *STATIC, first in line 17: expected one in a step
   19 | *STATIC
      | ^~~~~~~
"""),
    ),
    Case(
        "model_keyword_in_step",
        PLANE,
        [("*BOUNDARY\n", "*UNITS, LENGTH=m\n*BOUNDARY\n")],
        2,
        text("""
job.inp:19:1: error: *UNITS of the model: expected before the first *STEP
   19 | *UNITS, LENGTH=m
      | ^~~~~~
"""),
    ),
    Case(
        "step_keyword_in_model",
        PLANE,
        [("*MATERIAL, NAME", "*CLOAD\nY1, 2, -1\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:8:1: error: *CLOAD outside a step: expected between *STEP and *END STEP
    8 | *CLOAD
      | ^~~~~~
"""),
    ),
    Case(
        "elastic_without_material",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n*DENSITY\n2.0\n", "")],
        2,
        text("""
job.inp:8:1: error: *ELASTIC without *MATERIAL: expected *MATERIAL before it
    8 | *ELASTIC
      | ^~~~~~~~
job.inp:10:1: error: *PLASTIC without *MATERIAL: expected *MATERIAL before it
   10 | *PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
      | ^~~~~~~~
"""),
    ),
    Case(
        "elastic_twice",
        PLANE,
        [("100, 0.3\n", "100, 0.3\n*ELASTIC\n100, 0.3\n")],
        2,
        text("""
job.inp:13:1: error: duplicate *ELASTIC, first in line 11: expected one in a *MATERIAL
   13 | *ELASTIC
      | ^~~~~~~~
"""),
    ),
    Case(
        "material_without_elastic",
        PLANE,
        [("*ELASTIC\n100, 0.3\n", "")],
        2,
        text("""
job.inp:8:1: error: material 'CLAY' has no *ELASTIC: expected it below *MATERIAL
    8 | *MATERIAL, NAME=CLAY
      | ^~~~~~~~~
"""),
    ),
    Case(
        "data_before_keyword",
        PLANE,
        [("*HEADING\nsquare\n", "1, 2, 3\n")],
        2,
        text("""
job.inp:1:1: error: data before the first keyword: expected a line such as *HEADING
    1 | 1, 2, 3
      | ^~~~~~~
"""),
    ),
    Case(
        "no_mesh",
        PLANE,
        [("*GENERATE, TYPE=BOX, DIMENSION=2\nX, 0, 1, 2\nY, 0, 1, 2\n", "")],
        2,
        text("""
job.inp:1:1: error: the deck has no mesh: expected *MESH, *GENERATE, or *NODE and *ELEMENT
    1 | *HEADING
      | ^~~~~~~~
"""),
    ),
    Case(
        "two_meshes",
        NODES,
        [
            (
                "*FORMULATION, TYPE",
                "*GENERATE, TYPE=BOX, DIMENSION=2\nX, 0, 1, 1\nY, 0, 1, 1\n*FORMULATION, TYPE",
            )
        ],
        2,
        text("""
job.inp:12:1: error: a second mesh, the first is *ELEMENT: expected one of *MESH, *GENERATE, *NODE with *ELEMENT
   12 | *GENERATE, TYPE=BOX, DIMENSION=2
      | ^~~~~~~~~
"""),
    ),
    Case(
        "no_formulation",
        PLANE,
        [("*FORMULATION, TYPE=STANDARD\n", "")],
        2,
        text("""
job.inp:1:1: error: the deck has no *FORMULATION: expected TYPE=FBAR PATCH or TYPE=STANDARD in the model part
    1 | *HEADING
      | ^~~~~~~~
"""),
    ),
    Case(
        "no_material",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n*DENSITY\n2.0\n*ELASTIC\n100, 0.3\n*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL\n1.0, 0.0\n",
                "",
            )
        ],
        2,
        text("""
job.inp:1:1: error: the deck has no *MATERIAL: expected at least one in the model part
    1 | *HEADING
      | ^~~~~~~~
job.inp:8:39: error: material 'CLAY' is not defined: expected the NAME of a *MATERIAL
    8 | *MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1
      |                                       ^~~~
"""),
    ),
    Case(
        "no_points",
        PLANE,
        [("*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1\n", "")],
        2,
        text("""
job.inp:1:1: error: the deck has no material points: expected *MATERIAL POINTS in the model part
    1 | *HEADING
      | ^~~~~~~~
"""),
    ),
    Case(
        "two_headings",
        PLANE,
        [("*HEADING\nsquare\n", "*HEADING\nsquare\n*HEADING\ncircle\n")],
        2,
        text("""
job.inp:3:1: error: duplicate *HEADING, first in line 1: expected one in a deck
    3 | *HEADING
      | ^~~~~~~~
"""),
    ),
    Case(
        "duplicate_parameter",
        PLANE,
        [("NAME=PUSH, INC=20", "NAME=PUSH, NAME=PULL")],
        2,
        text("""
job.inp:16:19: error: duplicate parameter NAME of *STEP: expected it once
   16 | *STEP, NAME=PUSH, NAME=PULL
      |                   ^~~~
"""),
    ),
    Case(
        "flag_with_value",
        PLANE,
        [("*STATIC, DIRECT", "*STATIC, DIRECT=YES")],
        2,
        text("""
job.inp:17:17: error: DIRECT of *STATIC is a flag: expected no value
   17 | *STATIC, DIRECT=YES
      |                 ^~~
"""),
    ),
    Case(
        "parameter_without_value",
        PLANE,
        [("NAME=CLAY", "NAME")],
        2,
        text("""
job.inp:8:12: error: NAME of *MATERIAL has no value: expected a name of at most 80 characters
    8 | *MATERIAL, NAME
      |            ^~~~
"""),
    ),
    Case(
        "empty_parameter",
        PLANE,
        [("*STATIC, DIRECT", "*STATIC, , DIRECT")],
        2,
        text("""
job.inp:17:9: error: empty parameter of *STATIC: expected DIRECT
   17 | *STATIC, , DIRECT
      |         ^
"""),
    ),
    Case(
        "precision_that_changes",
        PLANE,
        [
            ("FREQUENCY=1", "PRECISION=SINGLE"),
            (
                "*END STEP\n",
                "*END STEP\n*STEP\n*STATIC\n1, 1\n*OUTPUT, FIELD, PRECISION=DOUBLE\n*END STEP\n",
            ),
        ],
        2,
        text("""
job.inp:33:27: error: a run has one precision: expected PRECISION=SINGLE as in step 'PUSH'
   33 | *OUTPUT, FIELD, PRECISION=DOUBLE
      |                           ^~~~~~
"""),
    ),
    Case(
        "excluding_parameters",
        PLANE,
        [("FREQUENCY=1", "FREQUENCY=1, TIME INTERVAL=0.1")],
        2,
        text("""
job.inp:25:44: error: TIME INTERVAL of *OUTPUT: expected not together with FREQUENCY
   25 | *OUTPUT, FIELD, FREQUENCY=1, TIME INTERVAL=0.1
      |                                            ^~~
"""),
    ),
    Case(
        "parameter_only_with_other",
        PLANE,
        [("SOURCE=NONE", "SOURCE=NONE, SIZE=8")],
        2,
        text("""
job.inp:7:27: error: SIZE of *PATCH: expected only with SOURCE=METIS
    7 | *PATCH, SOURCE=NONE, SIZE=8
      |                           ^
"""),
    ),
    Case(
        "missing_quote",
        PLANE,
        [("ELSET=ALL", 'ELSET="ALL')],
        2,
        text("""
job.inp:15:1: error: missing parameter MATERIAL of *MATERIAL POINTS: expected MATERIAL with a name of at most 80 characters
   15 | *MATERIAL POINTS, ELSET="ALL, MATERIAL=CLAY, PER ELEMENT=1
      | ^~~~~~~~~~~~~~~~
job.inp:15:1: error: missing parameter PER ELEMENT of *MATERIAL POINTS: expected PER ELEMENT with an integer > 0
   15 | *MATERIAL POINTS, ELSET="ALL, MATERIAL=CLAY, PER ELEMENT=1
      | ^~~~~~~~~~~~~~~~
job.inp:15:25: error: missing closing quote: expected '"'
   15 | *MATERIAL POINTS, ELSET="ALL, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^
job.inp:15:25: error: ELSET of *MATERIAL POINTS is '"ALL, MATERIAL=CLAY, PER ELEMENT=1': expected a name of at most 80 characters
   15 | *MATERIAL POINTS, ELSET="ALL, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~
"""),
    ),
    Case(
        "unknown_keyword_far_from_all",
        PLANE,
        [("*BOUNDARY\n", "*FLUX CAPACITOR\n*BOUNDARY\n")],
        2,
        text("""
job.inp:19:1: error: unknown keyword '*FLUX CAPACITOR': expected a keyword of tessera --schema
   19 | *FLUX CAPACITOR
      | ^~~~~~~~~~~~~~~
"""),
    ),
    Case(
        "name_too_long",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY",
                "*MATERIAL, NAME=CCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCC",
            )
        ],
        2,
        text("""
job.inp:8:17: error: NAME of *MATERIAL is 'CCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCC...': expected a name of at most 80 characters
    8 | *MATERIAL, NAME=CCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCCC...
      |                 ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~
"""),
    ),
    Case(
        "quadratic_patches_of_linear_mesh",
        PLANE,
        [("SOURCE=NONE", "SOURCE=QUADRATIC")],
        2,
        text("""
job.inp:7:16: error: the mesh is linear, it has no quadratic elements: expected METIS or NONE
    7 | *PATCH, SOURCE=QUADRATIC
      |                ^~~~~~~~~ use SOURCE=METIS, SIZE=4
"""),
    ),
    Case(
        "undefined_node_set",
        PLANE,
        [("X0, 1, 1", "XO, 1, 1")],
        2,
        text("""
job.inp:20:1: error: node set 'XO' is not defined: expected the name of a node set
   20 | XO, 1, 1
      | ^~ did you mean 'X0'?
"""),
    ),
    Case(
        "undefined_element_set",
        PLANE,
        [("ELSET=ALL", "ELSET=SOIL")],
        2,
        text("""
job.inp:15:25: error: element set 'SOIL' is not defined: expected the name of an element set
   15 | *MATERIAL POINTS, ELSET=SOIL, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~~
"""),
    ),
    Case(
        "undefined_material",
        PLANE,
        [("MATERIAL=CLAY", "MATERIAL=CLAI")],
        2,
        text("""
job.inp:15:39: error: material 'CLAI' is not defined: expected the NAME of a *MATERIAL
   15 | *MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAI, PER ELEMENT=1
      |                                       ^~~~ did you mean 'CLAY'?
"""),
    ),
    Case(
        "undefined_amplitude",
        PLANE,
        [("*BOUNDARY\n", "*BOUNDARY, AMPLITUDE=RAMP\n")],
        2,
        text("""
job.inp:19:22: error: amplitude 'RAMP' is not defined: expected the NAME of an *AMPLITUDE
   19 | *BOUNDARY, AMPLITUDE=RAMP
      |                      ^~~~
"""),
    ),
    Case(
        "undefined_surface",
        PLANE,
        [("*OUTPUT", "*DSLOAD\nROOF, P, 1.0\n*OUTPUT")],
        2,
        text("""
job.inp:26:1: error: surface 'ROOF' is not defined: expected the name of a surface
   26 | ROOF, P, 1.0
      | ^~~~
"""),
    ),
    Case(
        "surface_for_node_set",
        PLANE,
        [
            ("*FORMULATION, TYPE", "*SURFACE, NAME=SIDE\nX0\n*FORMULATION, TYPE"),
            ("X0, 1, 1", "SIDE, 1, 1"),
        ],
        2,
        text("""
job.inp:22:1: error: 'SIDE' is the wrong kind of set, a surface: expected a node set
   22 | SIDE, 1, 1
      | ^~~~
"""),
    ),
    Case(
        "node_set_for_element_set",
        NODES,
        [("ELSET=BODY, MATERIAL", "ELSET=NODES, MATERIAL")],
        2,
        text("""
job.inp:16:25: error: 'NODES' is the wrong kind of set, a node set: expected an element set
   16 | *MATERIAL POINTS, ELSET=NODES, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~~~
"""),
    ),
    Case(
        "carriers_for_elements",
        NODES,
        [("ELSET=BODY, MATERIAL", "ELSET=TOP, MATERIAL")],
        2,
        text("""
job.inp:16:25: error: 'TOP' is the wrong kind of set, a node set: expected an element set
   16 | *MATERIAL POINTS, ELSET=TOP, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~
"""),
    ),
    Case(
        "undefined_node",
        PLANE,
        [("X0, 1, 1", "99, 1, 1")],
        2,
        text("""
job.inp:20:1: error: node 99 is not defined: expected a node of the mesh or the name of a node set
   20 | 99, 1, 1
      | ^~
"""),
    ),
    Case(
        "undefined_node_in_set",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=CORNER\n1, 77\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:4: error: node 77 is not defined: expected a node of the mesh
    7 | 1, 77
      |    ^~
"""),
    ),
    Case(
        "undefined_element_in_set",
        PLANE,
        [("*FORMULATION, TYPE", "*ELSET, ELSET=PART\n1, 77\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:4: error: element 77 is not defined: expected an element of the mesh
    7 | 1, 77
      |    ^~
"""),
    ),
    Case(
        "undefined_set_in_set",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=CORNER\nX0, X2\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:5: error: node set 'X2' is not defined: expected the number of a node or the name of a node set
    7 | X0, X2
      |     ^~ did you mean 'X0'?
"""),
    ),
    Case(
        "range_backwards",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=CORNER, GENERATE\n5, 1\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:4: error: the range ends at 1 before it starts: expected at least 5
    7 | 5, 1
      |    ^
"""),
    ),
    Case(
        "range_beyond_mesh",
        PLANE,
        [("*FORMULATION, TYPE", "*ELSET, ELSET=PART, GENERATE\n1, 100\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:1: error: element 9 is not defined: expected an element of the mesh
    7 | 1, 100
      | ^~~~~~
"""),
    ),
    Case(
        "empty_node_set",
        NODES,
        [
            ("*ELEMENT, TYPE=CPE3", "*NODE, NSET=FAR\n6, 9, 9\n*ELEMENT, TYPE=CPE3"),
            ("1, 1, 2\n2,", "FAR, 1, 2\n1, 1, 2\n2,"),
        ],
        2,
        text("""
job.inp:23:1: error: node set 'FAR' is empty: expected nodes
   23 | FAR, 1, 2
      | ^~~
"""),
    ),
    Case(
        "duplicate_set",
        PLANE,
        [
            (
                "*FORMULATION, TYPE",
                "*NSET, NSET=CORNER\n1\n*NSET, NSET=Corner\n2\n*FORMULATION, TYPE",
            )
        ],
        2,
        text("""
job.inp:8:13: error: node set 'Corner' is defined already: expected a new name
    8 | *NSET, NSET=Corner
      |             ^~~~~~
"""),
    ),
    Case(
        "set_named_like_one_of_mesh",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=X0\n1\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:6:13: error: the mesh has a set 'X0' already: expected a new name
    6 | *NSET, NSET=X0
      |             ^~
"""),
    ),
    Case(
        "duplicate_material",
        PLANE,
        [("*MATERIAL POINTS", "*MATERIAL, NAME=clay\n*ELASTIC\n1, 0\n*MATERIAL POINTS")],
        2,
        text("""
job.inp:15:17: error: *MATERIAL 'clay' is defined already in line 8: expected a new name
   15 | *MATERIAL, NAME=clay
      |                 ^~~~
"""),
    ),
    Case(
        "duplicate_amplitude",
        PLANE,
        [
            (
                "*STEP, NAME",
                "*AMPLITUDE, NAME=RAMP\n0, 0, 1, 1\n*AMPLITUDE, NAME=RAMP\n0, 0, 1, 1\n*STEP, NAME",
            )
        ],
        2,
        text("""
job.inp:18:18: error: *AMPLITUDE 'RAMP' is defined already in line 16: expected a new name
   18 | *AMPLITUDE, NAME=RAMP
      |                  ^~~~
"""),
    ),
    Case(
        "unused_set",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=CORNER\n1\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:6:1: error: nothing uses node set 'CORNER': expected a use, or --lax on the command line
    6 | *NSET, NSET=CORNER
      | ^~~~~
"""),
    ),
    Case(
        "unused_material",
        PLANE,
        [("*MATERIAL POINTS", "*MATERIAL, NAME=SAND\n*ELASTIC\n1, 0\n*MATERIAL POINTS")],
        2,
        text("""
job.inp:15:1: error: nothing uses material 'SAND': expected a use, or --lax on the command line
   15 | *MATERIAL, NAME=SAND
      | ^~~~~~~~~
"""),
    ),
    Case(
        "unused_amplitude",
        PLANE,
        [("*STEP, NAME", "*AMPLITUDE, NAME=RAMP\n0, 0, 1, 1\n*STEP, NAME")],
        2,
        text("""
job.inp:16:1: error: nothing uses amplitude 'RAMP': expected a use, or --lax on the command line
   16 | *AMPLITUDE, NAME=RAMP
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "unused_surface",
        PLANE,
        [("*FORMULATION, TYPE", "*SURFACE, NAME=SIDE\nX0\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:6:1: error: nothing uses surface 'SIDE': expected a use, or --lax on the command line
    6 | *SURFACE, NAME=SIDE
      | ^~~~~~~~
"""),
    ),
    Case(
        "unused_with_lax",
        PLANE,
        [("*FORMULATION, TYPE", "*NSET, NSET=CORNER\n1\n*FORMULATION, TYPE")],
        0,
        text("""
job.inp:6:1: warning: nothing uses node set 'CORNER'
    6 | *NSET, NSET=CORNER
      | ^~~~~
"""),
        arguments=("--lax", "-q"),
    ),
    Case(
        "error_beside_a_warning",
        PLANE,
        [
            ("*BOUNDARY\nX0, 1, 1\n", "*BOUNDARY\n"),
            ("*STEP, NAME", "*BOUNDARY\nX0, 1, 1\n*STEP, NAME"),
            (
                "*END STEP\n",
                "*END STEP\n*STEP\n*STATIC\n1, 1\n*BOUNDARY, OP=NEW\nY0, 1, 3\n*END STEP\n",
            ),
        ],
        2,
        text("""
job.inp:34:15: warning: OP=NEW releases supports of the model part, in all 2, the first is direction 1 of node 4 in line 17: expected them in this step again, unless they are to be free
   34 | *BOUNDARY, OP=NEW
      |               ^~~
job.inp:35:8: error: direction 3 in a plane mesh: expected 1 or 2
   35 | Y0, 1, 3
      |        ^
"""),
    ),
    Case(
        "amplitude_not_ascending",
        PLANE,
        [
            ("*STEP, NAME", "*AMPLITUDE, NAME=RAMP\n0, 0, 1, 1, 1, 2\n*STEP, NAME"),
            ("*BOUNDARY\n", "*BOUNDARY, AMPLITUDE=RAMP\n"),
        ],
        2,
        text("""
job.inp:17:13: error: time 1 after 1: expected ascending times
   17 | 0, 0, 1, 1, 1, 2
      |             ^
"""),
    ),
    Case(
        "amplitude_with_odd_values",
        PLANE,
        [
            ("*STEP, NAME", "*AMPLITUDE, NAME=RAMP\n0, 0, 1\n*STEP, NAME"),
            ("*BOUNDARY\n", "*BOUNDARY, AMPLITUDE=RAMP\n"),
        ],
        2,
        text("""
job.inp:17:8: error: too few values in a line of *AMPLITUDE: expected time, factor, ...
   17 | 0, 0, 1
      |        ^
"""),
    ),
    Case(
        "surface_without_face",
        PLANE,
        [("*FORMULATION, TYPE", "*SURFACE, NAME=SIDE\n1\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:2: error: a surface of elements needs their face: expected S1 to S3
    7 | 1
      |  ^
"""),
    ),
    Case(
        "surface_with_fourth_face",
        PLANE,
        [("*FORMULATION, TYPE", "*SURFACE, NAME=SIDE\n1, S4\n*FORMULATION, TYPE")],
        2,
        text("""
job.inp:7:4: error: triangles have no face S4: expected S1, S2 or S3
    7 | 1, S4
      |    ^~
"""),
    ),
    Case(
        "third_direction_in_plane",
        PLANE,
        [("Y0, 2, 2", "Y0, 3, 3")],
        2,
        text("""
job.inp:21:5: error: direction 3 in a plane mesh: expected 1 or 2
   21 | Y0, 3, 3
      |     ^
"""),
    ),
    Case(
        "fourth_direction",
        PLANE,
        [("Y0, 2, 2", "Y0, 4, 4")],
        2,
        text("""
job.inp:21:5: error: first of *BOUNDARY is '4': expected an integer >= 1, <= 3
   21 | Y0, 4, 4
      |     ^
"""),
    ),
    Case(
        "directions_backwards",
        PLANE,
        [("Y0, 2, 2", "Y0, 2, 1")],
        2,
        text("""
job.inp:21:8: error: the last direction is 1: expected at least the first, 2
   21 | Y0, 2, 1
      |        ^
"""),
    ),
    Case(
        "two_displacements_of_one_node",
        PLANE,
        [("Y0, 2, 2", "Y0, 2, 2\nX0, 2, 2, 0.1")],
        2,
        text("""
job.inp:22:1: error: node 1 direction 2 is 0.1 here and 0 in line 21: expected one displacement
   22 | X0, 2, 2, 0.1
      | ^~
job.inp:23:1: error: node 7 direction 2 is -0.001 here and 0.1 in line 22: expected one displacement
   23 | Y1, 2, 2, -0.001
      | ^~
"""),
    ),
    Case(
        "displacement_in_model_part",
        PLANE,
        [("*STEP, NAME", "*BOUNDARY\nX0, 1, 1, 0.5\n*STEP, NAME")],
        2,
        text("""
job.inp:17:11: error: a displacement in the model part, where *BOUNDARY fixes: expected it inside a step
   17 | X0, 1, 1, 0.5
      |           ^~~
"""),
    ),
    Case(
        "force_in_third_direction",
        PLANE,
        [("*HISTORY", "*CLOAD\nY1, 3, 1.0\n*HISTORY")],
        2,
        text("""
job.inp:24:5: error: direction 3 in a plane mesh: expected 1 or 2
   24 | Y1, 3, 1.0
      |     ^
"""),
    ),
    Case(
        "same_load_twice",
        PLANE,
        [("*HISTORY", "*CLOAD\nX1, 1, 1.0\nX1, 1, 2.0\n*HISTORY")],
        2,
        text("""
job.inp:25:1: error: this load is given in line 24 of the same step already: expected it once
   25 | X1, 1, 2.0
      | ^~
"""),
    ),
    Case(
        "weight_without_density",
        PLANE,
        [("*DENSITY\n2.0\n", ""), ("*HISTORY", "*DLOAD\nALL, GRAV, 9.81, 0, -1\n*HISTORY")],
        2,
        text("""
job.inp:22:1: error: weight of material 'CLAY' without density: expected *DENSITY below its *MATERIAL
   22 | ALL, GRAV, 9.81, 0, -1
      | ^~~
"""),
    ),
    Case(
        "weight_without_direction",
        PLANE,
        [("*HISTORY", "*DLOAD\nALL, GRAV, 9.81, 0, 0\n*HISTORY")],
        2,
        text("""
job.inp:24:18: error: a direction of length zero: expected a vector
   24 | ALL, GRAV, 9.81, 0, 0
      |                  ^
"""),
    ),
    Case(
        "traction_out_of_plane",
        PLANE,
        [("*HISTORY", "*DSLOAD\nX1, TRVEC, 1, 0, 0, 1\n*HISTORY")],
        2,
        text("""
job.inp:24:21: error: a direction with z = 1 in a plane mesh: expected x, y
   24 | X1, TRVEC, 1, 0, 0, 1
      |                     ^
"""),
    ),
    Case(
        "pressure_with_direction",
        PLANE,
        [("*HISTORY", "*DSLOAD\nX1, P, 1, 0, 1\n*HISTORY")],
        2,
        text("""
job.inp:24:11: error: too many values in a line of *DSLOAD: expected surface, type, value
   24 | X1, P, 1, 0, 1
      |           ^
"""),
    ),
    Case(
        "plane_direction_in_solid",
        SOLID,
        [("*END STEP", "*DSLOAD\nX1, TRVEC, 1, 1, 0\n*END STEP")],
        2,
        text("""
job.inp:18:19: error: a direction of two numbers in a 3-D mesh: expected x, y, z
   18 | X1, TRVEC, 1, 1, 0
      |                   ^
"""),
    ),
    Case(
        "load_on_empty_elements",
        PLANE,
        [
            ("*FORMULATION, TYPE", "*ELSET, ELSET=PART\n1\n*FORMULATION, TYPE"),
            ("ELSET=ALL", "ELSET=PART"),
            ("Y1, 2, 2, -0.001\n", "Y1, 2, 2, -0.001\n*CLOAD\n9, 1, 1.0\n"),
            ("NSET=Y1", "NSET=Y0"),
            ("SET=Y1", "SET=Y0"),
        ],
        3,
        text("""
job.inp:24:1: error: 'Y1' touches no element with material points: expected nodes of the body
   24 | Y1, 2, 2, -0.001
      | ^~
job.inp:26:1: error: '9' touches no element with material points: expected nodes of the body
   26 | 9, 1, 1.0
      | ^
"""),
    ),
    Case(
        "traction_on_empty_elements",
        PLANE,
        [
            ("*FORMULATION, TYPE", "*ELSET, ELSET=PART\n1\n*FORMULATION, TYPE"),
            ("ELSET=ALL", "ELSET=PART"),
            ("Y1, 2, 2, -0.001\n", "*DSLOAD\nX1, P, 1.0\n"),
            ("NSET=Y1", "NSET=Y0"),
            ("SET=Y1", "SET=Y0"),
        ],
        3,
        text("""
job.inp:25:1: error: no material points at a face of element 4 in surface 'X1': expected faces of the body
   25 | X1, P, 1.0
      | ^~
"""),
    ),
    Case(
        "carrier_unknown",
        PLANE,
        [("*HISTORY", "*DSLOAD, CARRIER=BODY\nX1, P, 1\n*HISTORY")],
        2,
        text("""
job.inp:23:18: error: CARRIER of *DSLOAD is 'BODY': expected MESH or POINTS
   23 | *DSLOAD, CARRIER=BODY
      |                  ^~~~
"""),
    ),
    Case(
        "two_carriers_at_a_time",
        PLANE,
        [("*HISTORY", "*DSLOAD\nX1, P, 1\n*DSLOAD, CARRIER=POINTS\nX1, P, 2\n*HISTORY")],
        2,
        text("""
job.inp:26:1: error: this surface is loaded through the other CARRIER in line 24: expected the same one, or OP=NEW
   26 | X1, P, 2
      | ^~
"""),
    ),
    Case(
        "two_carriers_of_two_loads",
        PLANE,
        [("*HISTORY", "*DSLOAD\nX1, P, 1\n*DSLOAD, CARRIER=POINTS\nX1, TRVEC, 2, 1, 0\n*HISTORY")],
        2,
        text("""
job.inp:26:1: error: this surface is loaded through the other CARRIER in line 24: expected the same one, or OP=NEW
   26 | X1, TRVEC, 2, 1, 0
      | ^~
"""),
    ),
    Case(
        "two_procedures",
        PLANE,
        [("1, 1\n*BOUNDARY", "1, 1\n*GEOSTATIC\n*BOUNDARY")],
        2,
        text("""
job.inp:19:1: error: *GEOSTATIC in a step that has *STATIC in line 17: expected one of them
   19 | *GEOSTATIC
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "initial_stress_twice",
        PLANE,
        [("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nALL, 0, 0, 0\nALL, 0, -1, 0\n*STEP")],
        2,
        text("""
job.inp:18:1: error: element 1 has an initial stress by line 17 already: expected sets that do not overlap
   18 | ALL, 0, -1, 0
      | ^~~
"""),
    ),
    Case(
        "initial_stress_out_of_plane",
        PLANE,
        [("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nALL, 0, 0, 0, 0, 0, 0.1\n*STEP")],
        2,
        text("""
job.inp:17:21: error: shear stress out of the plane in plane strain: expected s11, s22, s33, s12 and nothing but 0 after them
   17 | ALL, 0, 0, 0, 0, 0, 0.1
      |                     ^~~
"""),
    ),
    Case(
        "initial_stress_between_equal_heights",
        PLANE,
        [("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS, GEOSTATIC\nALL, 0, 2, -1, 2, 0.5\n*STEP")],
        2,
        text("""
job.inp:17:16: error: both heights are 2: expected two different ones
   17 | ALL, 0, 2, -1, 2, 0.5
      |                ^
"""),
    ),
    Case(
        "initial_stress_of_empty_elements",
        NODES,
        [
            ("*FORMULATION", "*ELSET, ELSET=LOW\n1\n*ELSET, ELSET=HIGH\n2\n*FORMULATION"),
            ("ELSET=BODY, MATERIAL", "ELSET=LOW, MATERIAL"),
            ("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nHIGH, 0, 0, 0\n*STEP"),
        ],
        2,
        text("""
job.inp:22:1: error: no material points in the elements of 'HIGH': expected elements of the body
   22 | HIGH, 0, 0, 0
      | ^~~~
"""),
    ),
    Case(
        "initial_stress_beyond_yield",
        PLANE,
        [("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nALL, -1, -3, -1\n*STEP")],
        2,
        text("""
job.inp:17:1: error: the initial stress of material point 1 in element 1 is outside the yield surface, sqrt(3 J2) = 2: expected at most 1
   17 | ALL, -1, -3, -1
      | ^~~
"""),
    ),
    Case(
        "initial_stress_beyond_stiffness",
        PLANE,
        [
            ("*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL\n1.0, 0.0\n", ""),
            ("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nALL, -1e30, -1, -1\n*STEP"),
        ],
        2,
        text("""
job.inp:15:1: error: the initial stress of material point 1 in element 1 needs an elastic strain above 1: expected a stress well below the moduli of *ELASTIC
   15 | ALL, -1e30, -1, -1
      | ^~~
"""),
    ),
    Case(
        "geostatic_step_that_moves",
        PLANE,
        [
            ("*STATIC, DIRECT\n1, 1\n", "*GEOSTATIC, UTOL=1e-6\n"),
            ("Y1, 2, 2, -0.001\n", "*DLOAD\nALL, GRAV, 0.01, 0, -1\n"),
            ("*EXPECT, QUANTITY=U, SET=Y1, COMPONENT=2\nanalytic, -0.001, 1e-9\n", ""),
        ],
        3,
        text("""
error: material point 6 moved by 8.79335e-5 in the *GEOSTATIC step 'PUSH': expected at most UTOL=1e-6, which needs an initial stress in equilibrium with the loads
  last attempt: job_fail.vtkhdf
"""),
        arguments=("-q",),
    ),
    Case(
        "moving_mesh_with_zero_direction",
        PLANE,
        [("*MATERIAL, NAME", "*MOVING MESH, DRIVER=Y1, DIRECTION=0,0, FIXED=Y0\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:8:36: error: wrong direction: expected 2 numbers, not all zero
    8 | *MOVING MESH, DRIVER=Y1, DIRECTION=0,0, FIXED=Y0
      |                                    ^~~
"""),
    ),
    Case(
        "moving_mesh_with_one_number",
        PLANE,
        [("*MATERIAL, NAME", "*MOVING MESH, DRIVER=Y1, DIRECTION=1, FIXED=Y0\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:8:36: error: wrong direction: expected 2 numbers, not all zero
    8 | *MOVING MESH, DRIVER=Y1, DIRECTION=1, FIXED=Y0
      |                                    ^
"""),
    ),
    Case(
        "moving_mesh_with_skew_plane",
        PLANE,
        [("*MATERIAL, NAME", "*MOVING MESH, DRIVER=X1, DIRECTION=0,1, FIXED=Y0\n*MATERIAL, NAME")],
        3,
        text("""
job.inp:8:1: error: moving mesh: driver node 6 is off the plane of driver node 3: expected nodes of one plane normal to the direction
    8 | *MOVING MESH, DRIVER=X1, DIRECTION=0,1, FIXED=Y0
      | ^~~~~~~~~~~~
"""),
    ),
    Case(
        "moving_mesh_with_half_prescribed_driver",
        PLANE,
        [
            (
                "*MATERIAL, NAME",
                "*MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0\n*MATERIAL, NAME",
            ),
            ("X0, 1, 1\n", "X0, 1, 1\n3, 1, 1, 0.001\n"),
        ],
        3,
        text("""
job.inp:8:22: error: node 6 of the driver has no displacement in direction 1, or another one than the rest, in step PUSH: expected one *BOUNDARY value for the set, or none
    8 | *MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0
      |                      ^~
"""),
    ),
    Case(
        "carried_mesh_with_driver",
        PLANE,
        [("*MATERIAL, NAME", "*MOVING MESH, TYPE=LAGRANGIAN, DRIVER=Y1\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:8:39: error: DRIVER of *MOVING MESH: expected only with TYPE=DRIVER
    8 | *MOVING MESH, TYPE=LAGRANGIAN, DRIVER=Y1
      |                                       ^~
"""),
    ),
    Case(
        "carried_mesh_with_direction_and_plane",
        PLANE,
        [
            (
                "*MATERIAL, NAME",
                "*MOVING MESH, TYPE=LAGRANGIAN, DIRECTION=0,1, FIXED=Y0\n*MATERIAL, NAME",
            )
        ],
        2,
        text("""
job.inp:8:42: error: DIRECTION of *MOVING MESH: expected only with TYPE=DRIVER
    8 | *MOVING MESH, TYPE=LAGRANGIAN, DIRECTION=0,1, FIXED=Y0
      |                                          ^~~
job.inp:8:53: error: FIXED of *MOVING MESH: expected only with TYPE=DRIVER
    8 | *MOVING MESH, TYPE=LAGRANGIAN, DIRECTION=0,1, FIXED=Y0
      |                                                     ^~
"""),
    ),
    Case(
        "driver_by_default_without_its_plane",
        PLANE,
        [("*MATERIAL, NAME", "*MOVING MESH, DRIVER=Y1\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:8:1: error: missing parameter DIRECTION of *MOVING MESH: expected DIRECTION with reals separated by commas
    8 | *MOVING MESH, DRIVER=Y1
      | ^~~~~~~~~~~~
job.inp:8:1: error: missing parameter FIXED of *MOVING MESH: expected FIXED with a name of at most 80 characters
    8 | *MOVING MESH, DRIVER=Y1
      | ^~~~~~~~~~~~
"""),
    ),
    Case(
        "history_of_point_outside",
        PLANE,
        [("NSET=Y1\nRF, U", "POINT=5,5\nS")],
        2,
        text("""
job.inp:23:17: error: the nearest material point is 6.01156 away: expected a point in the body
   23 | *HISTORY, POINT=5,5
      |                 ^~~
"""),
    ),
    Case(
        "history_of_point_with_three_numbers",
        PLANE,
        [("NSET=Y1\nRF, U", "POINT=0.5,0.5,0\nS")],
        2,
        text("""
job.inp:23:17: error: a point of 3 numbers: expected 2
   23 | *HISTORY, POINT=0.5,0.5,0
      |                 ^~~~~~~~~
"""),
    ),
    Case(
        "reaction_of_point",
        PLANE,
        [("NSET=Y1\nRF, U", "POINT=0.5,0.5\nRF")],
        2,
        text("""
job.inp:24:1: error: quantity of *HISTORY is 'RF': expected S, TAU, LE, PEEQ, F, J, JBAR, U or VOL
   24 | RF
      | ^~
"""),
    ),
    Case(
        "quantity_twice",
        PLANE,
        [("RF, U", "RF, RF")],
        2,
        text("""
job.inp:24:5: error: 'RF' is in the list already: expected every name once
   24 | RF, RF
      |     ^~
"""),
    ),
    Case(
        "unknown_field",
        PLANE,
        [("S, PEEQ", "S, PEQ")],
        2,
        text("""
job.inp:26:4: error: field of *OUTPUT is 'PEQ': expected S, TAU, LE, PEEQ, F, J, JBAR, U, VOL, MAT, PATCH, ELEMENT or ID
   26 | S, PEQ
      |    ^~~ did you mean 'PEEQ'?
"""),
    ),
    Case(
        "expect_without_component",
        PLANE,
        [(", COMPONENT=2", "")],
        2,
        text("""
job.inp:27:1: error: U without COMPONENT: expected COMPONENT=1 to 2
   27 | *EXPECT, QUANTITY=U, SET=Y1
      | ^~~~~~~
"""),
    ),
    Case(
        "expect_component_of_scalar",
        PLANE,
        [("QUANTITY=U, SET=Y1", "QUANTITY=PEEQ, SET=ALL")],
        2,
        text("""
job.inp:27:44: error: PEEQ is a number without components: expected no COMPONENT
   27 | *EXPECT, QUANTITY=PEEQ, SET=ALL, COMPONENT=2
      |                                            ^
"""),
    ),
    Case(
        "ghost_share_without_penalty",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=GHOST SHARE")],
        2,
        text("""
job.inp:27:19: error: GHOST SHARE without *GHOST PENALTY: expected *GHOST PENALTY in the model part
   27 | *EXPECT, QUANTITY=GHOST SHARE
      |                   ^~~~~~~~~~~
"""),
    ),
    Case(
        "ghost_share_of_a_set",
        PLANE,
        [
            ("*MATERIAL, NAME", "*GHOST PENALTY\n*MATERIAL, NAME"),
            ("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=GHOST SHARE, SET=ALL, STATISTIC=MAX"),
        ],
        2,
        text("""
job.inp:28:36: error: GHOST SHARE is one number of the run: expected no SET
   28 | *EXPECT, QUANTITY=GHOST SHARE, SET=ALL, STATISTIC=MAX
      |                                    ^~~
job.inp:28:51: error: GHOST SHARE is one number of the run: expected no STATISTIC
   28 | *EXPECT, QUANTITY=GHOST SHARE, SET=ALL, STATISTIC=MAX
      |                                                   ^~~
"""),
    ),
    Case(
        "balance_of_a_set",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=BALANCE, SET=ALL, STATISTIC=MAX")],
        2,
        text("""
job.inp:27:32: error: BALANCE is one number of the run: expected no SET
   27 | *EXPECT, QUANTITY=BALANCE, SET=ALL, STATISTIC=MAX
      |                                ^~~
job.inp:27:47: error: BALANCE is one number of the run: expected no STATISTIC
   27 | *EXPECT, QUANTITY=BALANCE, SET=ALL, STATISTIC=MAX
      |                                               ^~~
"""),
    ),
    Case(
        "balance_of_a_component",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=BALANCE, COMPONENT=2")],
        2,
        text("""
job.inp:27:38: error: BALANCE is a number without components: expected no COMPONENT
   27 | *EXPECT, QUANTITY=BALANCE, COMPONENT=2
      |                                      ^
"""),
    ),
    Case(
        "ghost_penalty_twice",
        PLANE,
        [("*MATERIAL, NAME", "*GHOST PENALTY\n*GHOST PENALTY, GAMMA=1\n*MATERIAL, NAME")],
        2,
        text("""
job.inp:9:1: error: duplicate *GHOST PENALTY, first in line 8: expected one in a deck
    9 | *GHOST PENALTY, GAMMA=1
      | ^~~~~~~~~~~~~~
"""),
    ),
    Case(
        "expect_component_beyond",
        PLANE,
        [("COMPONENT=2", "COMPONENT=3")],
        2,
        text("""
job.inp:27:40: error: component 3 of U: expected 1 to 2
   27 | *EXPECT, QUANTITY=U, SET=Y1, COMPONENT=3
      |                                        ^
"""),
    ),
    Case(
        "expect_checkerboard_of_set",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=CHECKERBOARD, SET=ALL")],
        2,
        text("""
job.inp:27:37: error: CHECKERBOARD is one number of the run: expected no SET
   27 | *EXPECT, QUANTITY=CHECKERBOARD, SET=ALL
      |                                     ^~~
"""),
    ),
    Case(
        "expect_statistic_of_checkerboard",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=CHECKERBOARD, STATISTIC=MAX")],
        2,
        text("""
job.inp:27:43: error: CHECKERBOARD is one number of the run: expected no STATISTIC
   27 | *EXPECT, QUANTITY=CHECKERBOARD, STATISTIC=MAX
      |                                           ^~~
"""),
    ),
    Case(
        "expect_component_of_checkerboard",
        PLANE,
        [("QUANTITY=U, SET=Y1, COMPONENT=2", "QUANTITY=CHECKERBOARD, COMPONENT=1")],
        2,
        text("""
job.inp:27:43: error: CHECKERBOARD is a number without components: expected no COMPONENT
   27 | *EXPECT, QUANTITY=CHECKERBOARD, COMPONENT=1
      |                                           ^
"""),
    ),
    Case(
        "expect_time_after_step",
        PLANE,
        [("COMPONENT=2", "COMPONENT=2, TIME=2")],
        2,
        text("""
job.inp:27:48: error: total time 2 is outside the step: expected more than 0 and at most 1
   27 | *EXPECT, QUANTITY=U, SET=Y1, COMPONENT=2, TIME=2
      |                                                ^
"""),
    ),
    Case(
        "expect_reaction_without_set",
        PLANE,
        [("QUANTITY=U, SET=Y1", "QUANTITY=RF")],
        2,
        text("""
job.inp:27:1: error: RF without SET: expected the name of a node set
   27 | *EXPECT, QUANTITY=RF, COMPONENT=2
      | ^~~~~~~
"""),
    ),
    Case(
        "expect_guess",
        PLANE,
        [("analytic,", "guessed,")],
        2,
        text("""
job.inp:28:1: error: source of *EXPECT is 'guessed': expected ANALYTIC or FROZEN
   28 | guessed, -0.001, 1e-9
      | ^~~~~~~
"""),
    ),
    Case(
        "negative_element",
        NODES,
        [("1, 1, 2, 3", "1, 1, 3, 2")],
        3,
        text("""
job.inp:8:1: error: element 1: negative volume -0.5: expected corner nodes in positive order, counter-clockwise
    8 | 1, 1, 3, 2
      | ^
"""),
    ),
    Case(
        "degenerate_element",
        NODES,
        [("3, 1, 1\n", "3, 2, 0\n"), ("*ELEMENT, TYPE=T3D2, ELSET=TOP\n3, 3, 4\n", "")],
        3,
        text("""
job.inp:8:1: error: element 1: zero volume: expected corner nodes in positive order, counter-clockwise
    8 | 1, 1, 2, 3
      | ^
"""),
    ),
    Case(
        "element_with_node_twice",
        NODES,
        [("1, 1, 2, 3", "1, 1, 2, 2")],
        3,
        text("""
job.inp:8:10: error: node 2 appears twice in element 1: expected different nodes
    8 | 1, 1, 2, 2
      |          ^
"""),
    ),
    Case(
        "element_of_undefined_node",
        NODES,
        [("1, 1, 2, 3", "1, 1, 2, 8")],
        2,
        text("""
job.inp:8:10: error: node 8 is not defined: expected a node of *NODE
    8 | 1, 1, 2, 8
      |          ^
"""),
    ),
    Case(
        "element_of_loose_node_count",
        NODES,
        [("1, 1, 2, 3", "1, 1, 2")],
        2,
        text("""
job.inp:8:8: error: too few values in a line of *ELEMENT: expected number, node (x3)
    8 | 1, 1, 2
      |        ^
"""),
    ),
    Case(
        "element_with_number_twice",
        NODES,
        [("2, 1, 3, 4", "1, 1, 3, 4")],
        2,
        text("""
job.inp:9:1: error: element 1 is defined twice: expected every number once
    9 | 1, 1, 3, 4
      | ^
"""),
    ),
    Case(
        "node_with_number_twice",
        NODES,
        [("4, 0, 1\n5, 3, 3", "4, 0, 1\n4, 3, 3")],
        2,
        text("""
job.inp:6:1: error: node 4 is defined twice: expected every number once
    6 | 4, 3, 3
      | ^
"""),
    ),
    Case(
        "node_out_of_plane",
        NODES,
        [("3, 1, 1\n", "3, 1, 1, 0.5\n")],
        2,
        text("""
job.inp:4:10: error: z = 0.5 in a plane mesh: expected z = 0 or no z
    4 | 3, 1, 1, 0.5
      |          ^~~
"""),
    ),
    Case(
        "element_types_mixed",
        NODES,
        [("TYPE=T3D2", "TYPE=T3D3"), ("3, 3, 4\n*F", "3, 3, 4, 5\n*F")],
        2,
        text("""
job.inp:10:16: error: T3D3 does not fit into this mesh of linear elements in 2-D: expected CPE3, or T3D2 for boundaries
   10 | *ELEMENT, TYPE=T3D3, ELSET=TOP
      |                ^~~~
"""),
    ),
    Case(
        "unknown_element_type",
        NODES,
        [("TYPE=CPE3", "TYPE=CPE4")],
        2,
        text("""
job.inp:7:16: error: TYPE of *ELEMENT is 'CPE4': expected CPE3, CPE6, C3D4, C3D10, T3D2, T3D3, CPS3, CPS6, S3 or STRI65
    7 | *ELEMENT, TYPE=CPE4, ELSET=BODY
      |                ^~~~ did you mean 'CPE3'?
job.inp:8:11: error: too few values in a line of *ELEMENT: expected number, node (x10)
    8 | 1, 1, 2, 3
      |           ^
job.inp:9:11: error: too few values in a line of *ELEMENT: expected number, node (x10)
    9 | 2, 1, 3, 4
      |           ^
"""),
    ),
    Case(
        "only_carriers",
        NODES,
        [("TYPE=CPE3", "TYPE=CPS3")],
        2,
        text("""
job.inp:7:16: error: the deck has no elements for material, CPS3 only carries surfaces: expected CPE3, CPE6, C3D4 or C3D10
    7 | *ELEMENT, TYPE=CPS3, ELSET=BODY
      |                ^~~~ plane strain is CPE3
"""),
    ),
    Case(
        "carrier_beside_body",
        NODES,
        [("3, 3, 4\n*F", "3, 4, 5\n*F")],
        3,
        text("""
job.inp:11:1: error: boundary element 3 is no face of the body: expected the nodes of a face
   11 | 3, 4, 5
      | ^
"""),
    ),
    Case(
        "nodes_without_elements",
        NODES,
        [
            (
                "*ELEMENT, TYPE=CPE3, ELSET=BODY\n1, 1, 2, 3\n2, 1, 3, 4\n*ELEMENT, TYPE=T3D2, ELSET=TOP\n3, 3, 4\n",
                "",
            )
        ],
        2,
        text("""
job.inp:1:1: error: nodes without elements: expected *ELEMENT
    1 | *NODE, NSET=NODES
      | ^~~~~
"""),
    ),
    Case(
        "elements_without_nodes",
        NODES,
        [("*NODE, NSET=NODES\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 3, 3\n", "")],
        2,
        text("""
job.inp:1:1: error: elements without nodes: expected *NODE
    1 | *ELEMENT, TYPE=CPE3, ELSET=BODY
      | ^~~~~~~~
"""),
    ),
    Case(
        "overlapping_regions",
        PLANE,
        [
            (
                "*STEP, NAME",
                "*ELSET, ELSET=PART\n3\n*MATERIAL POINTS, ELSET=PART, MATERIAL=CLAY, PER ELEMENT=1\n*STEP, NAME",
            )
        ],
        3,
        text("""
job.inp:18:25: error: element 3 already holds material points: expected regions that do not overlap
   18 | *MATERIAL POINTS, ELSET=PART, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~~
"""),
    ),
    Case(
        "free_in_x",
        PLANE,
        [("X0, 1, 1\n", "")],
        3,
        text("""
job.inp:16:1: error: the body of element 1 is free to move in this step (translation in x): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "free_in_y",
        PLANE,
        [("Y0, 2, 2\n", ""), ("Y1, 2, 2, -0.001", "X1, 1, 1, 0.001")],
        3,
        text("""
job.inp:16:1: error: the body of element 1 is free to move in this step (translation in y): expected *BOUNDARY conditions that hold it, such as Y0, 2, 2
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "free_to_turn_in_plane",
        PLANE,
        [("X0, 1, 1\nY0, 2, 2\nY1, 2, 2, -0.001\n", "1, 1, 2\n")],
        3,
        text("""
job.inp:16:1: error: the body of element 1 is free to move in this step (rotation about z): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "free_altogether",
        PLANE,
        [("*BOUNDARY\nX0, 1, 1\nY0, 2, 2\nY1, 2, 2, -0.001\n", "")],
        3,
        text("""
job.inp:16:1: error: the body of element 1 is free to move in this step (translation in x, translation in y, rotation about z): expected *BOUNDARY conditions that hold it, such as X0, 1, 1 and Y0, 2, 2
   16 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_in_x",
        SOLID,
        [("X0, 1, 1\n", "")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (translation in x): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_in_y",
        SOLID,
        [("Y0, 2, 2\n", "")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (translation in y): expected *BOUNDARY conditions that hold it, such as Y0, 2, 2
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_in_z",
        SOLID,
        [("Z0, 3, 3\n", "")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (translation in z): expected *BOUNDARY conditions that hold it, such as Z0, 3, 3
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_to_turn_about_x",
        SOLID,
        [("X0, 1, 1\nY0, 2, 2\nZ0, 3, 3", "1, 1, 3\n2, 2, 3")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (rotation about x): expected *BOUNDARY conditions that hold it, such as Y0, 2, 2
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_to_turn_about_z",
        SOLID,
        [("X0, 1, 1\nY0, 2, 2\nZ0, 3, 3", "1, 1, 3\n5, 1, 2")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (rotation about z): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "solid_free_to_turn_about_y",
        SOLID,
        [("X0, 1, 1\nY0, 2, 2\nZ0, 3, 3", "1, 1, 3\n3, 1, 1\n3, 3, 3")],
        3,
        text("""
job.inp:10:1: error: the body of element 1 is free to move in this step (rotation about y): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   10 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "second_body_free",
        NODES,
        [
            ("2, 1, 3, 4\n", "2, 1, 3, 4\n7, 5, 6, 7\n"),
            ("5, 3, 3\n", "5, 3, 3\n6, 4, 3\n7, 4, 4\n"),
        ],
        3,
        text("""
job.inp:20:1: error: the body of element 7 is free to move in this step (translation in x, translation in y, rotation about z): expected *BOUNDARY conditions that hold it, such as NODES, 1, 1 and NODES, 2, 2
   20 | *STEP
      | ^~~~~
"""),
    ),
    Case(
        "nul_byte",
        PLANE,
        [("100, 0.3", "100, 0.3\x00")],
        2,
        text("""
job.inp:11:1: error: missing data line of *ELASTIC: expected E, nu
   11 | *ELASTIC
      | ^~~~~~~~
job.inp:12:9: error: NUL byte: expected a text file
   12 | 100, 0.3?
      |         ^
"""),
    ),
    Case(
        "control_character",
        PLANE,
        [("100, 0.3", "100, \x010.3")],
        2,
        text("""
job.inp:11:1: error: missing data line of *ELASTIC: expected E, nu
   11 | *ELASTIC
      | ^~~~~~~~
job.inp:12:6: error: control character: expected text
   12 | 100, ?0.3
      |      ^
"""),
    ),
    Case(
        "not_utf8",
        PLANE,
        [("square", "sch\udcf6n")],
        2,
        text("""
job.inp:2:4: error: byte that is not UTF-8: expected text in UTF-8
    2 | sch?n
      |    ^
"""),
    ),
    Case(
        "line_too_long",
        PLANE,
        [("100, 0.3", "100, 0.3 ** " + 2100 * "x")],
        2,
        text("""
job.inp:11:1: error: missing data line of *ELASTIC: expected E, nu
   11 | *ELASTIC
      | ^~~~~~~~
job.inp:12:1: error: line of 2112 characters: expected at most 2048
   12 | 100, 0.3 ** xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...
      | ^
"""),
    ),
    Case(
        "tabs_before_error",
        PLANE,
        [("100, 0.3", "\t100,\tstiff")],
        2,
        text("""
job.inp:12:7: error: nu of *ELASTIC is 'stiff': expected a real > -1, < 0.5
   12 | 	100,	stiff
      | 	    	^~~~~
"""),
    ),
    Case(
        "error_in_continued_line",
        PLANE,
        [
            (
                "*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1",
                "*MATERIAL POINTS, ELSET=ALL,\n  MATERIAL=CLAY, PER ELEMEN=1",
            )
        ],
        2,
        text("""
job.inp:16:18: error: unknown parameter 'PER ELEMEN' of *MATERIAL POINTS
   16 |   MATERIAL=CLAY, PER ELEMEN=1
      |                  ^~~~~~~~~~ did you mean 'PER ELEMENT'?
"""),
    ),
    Case(
        "crlf_counts_lines_and_columns",
        PLANE,
        [("100, 0.3", "100, stiff"), ("\n", "\r\n")],
        2,
        text("""
job.inp:12:6: error: nu of *ELASTIC is 'stiff': expected a real > -1, < 0.5
   12 | 100, stiff
      |      ^~~~~
"""),
    ),
    Case(
        "byte_order_mark_counts_not",
        PLANE,
        [("*HEADING", "\ufeff*HEADIN")],
        2,
        text("""
job.inp:1:1: error: unknown keyword '*HEADIN'
    1 | *HEADIN
      | ^~~~~~~ did you mean '*HEADING'?
"""),
    ),
    Case(
        "two_errors_in_order",
        PLANE,
        [("100, 0.3", "100, stiff"), ("PER ELEMENT=1", "PER ELEMENT=some")],
        2,
        text("""
job.inp:12:6: error: nu of *ELASTIC is 'stiff': expected a real > -1, < 0.5
   12 | 100, stiff
      |      ^~~~~
job.inp:15:57: error: PER ELEMENT of *MATERIAL POINTS is 'some': expected an integer > 0
   15 | *MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=some
      |                                                         ^~~~
"""),
    ),
    Case(
        "empty_file",
        "",
        [],
        2,
        text("""
job.inp:1:1: error: the deck is empty: expected keywords such as *STEP
"""),
    ),
    Case(
        "only_comments",
        "",
        [("", "** nothing\n\n** at all\n")],
        2,
        text("""
job.inp:1:1: error: the deck is empty: expected keywords such as *STEP
"""),
    ),
    Case(
        "include_of_missing_file",
        PLANE,
        [("*STEP, NAME", '*INCLUDE, INPUT="none.inp"\n*STEP, NAME')],
        2,
        text("""
job.inp:16:17: error: cannot read 'none.inp': No such file or directory
   16 | *INCLUDE, INPUT="none.inp"
      |                 ^~~~~~~~~~
"""),
    ),
    Case(
        "include_of_folder",
        PLANE,
        [("*STEP, NAME", '*INCLUDE, INPUT="sub"\n*STEP, NAME')],
        2,
        text("""
job.inp:16:17: error: cannot read 'sub': Is a directory
   16 | *INCLUDE, INPUT="sub"
      |                 ^~~~~
"""),
        files={"sub/": ""},
    ),
    Case(
        "include_of_itself",
        PLANE,
        [("*STEP, NAME", '*INCLUDE, INPUT="job.inp"\n*STEP, NAME')],
        2,
        text("""
job.inp:16:17: error: 'job.inp' includes itself: expected another file
   16 | *INCLUDE, INPUT="job.inp"
      |                 ^~~~~~~~~
"""),
    ),
    Case(
        "include_cycle",
        PLANE,
        [("*STEP, NAME", '*INCLUDE, INPUT="a.inp"\n*STEP, NAME')],
        2,
        text("""
b.inp:2:17: error: 'a.inp' includes itself: expected another file
    2 | *INCLUDE, INPUT=a.inp
      |                 ^~~~~
"""),
        files={"a.inp": '*INCLUDE, INPUT="b.inp"\n', "b.inp": "** b\n*INCLUDE, INPUT=a.inp\n"},
    ),
    Case(
        "include_too_deep",
        PLANE,
        [("*STEP, NAME", '*INCLUDE, INPUT="d1.inp"\n*STEP, NAME')],
        2,
        text("""
d9.inp:1:1: error: more than 10 files include each other: expected fewer
    1 | *INCLUDE, INPUT=d10.inp
      | ^~~~~~~~
"""),
        files={f"d{i}.inp": f"*INCLUDE, INPUT=d{i + 1}.inp\n" for i in range(1, 12)},
    ),
    Case(
        "error_in_included_file",
        PLANE,
        [("*ELASTIC\n100, 0.3\n", "*INCLUDE, INPUT=sub/elastic.inp\n")],
        2,
        text("""
sub/elastic.inp:3:6: error: nu of *ELASTIC is 'stiff': expected a real > -1, < 0.5
    3 | 100, stiff
      |      ^~~~~
"""),
        files={"sub/": "", "sub/elastic.inp": "** clay\n*ELASTIC\n100, stiff\n"},
    ),
    Case(
        "gmsh_cut_in_format",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:1:1: error: the file ends inside $MeshFormat: expected the format, such as '4.1 0 8'
    1 | $MeshFormat
      | ^~~~~~~~~~~
"""),
        files={"square.msh": first_lines(MSH_22, 1)},
    ),
    Case(
        "gmsh_cut_in_version",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:2:1: error: the file ends inside $MeshFormat: expected $EndMeshFormat
    2 | 2.2 0 8
      | ^~~
"""),
        files={"square.msh": first_lines(MSH_22, 2)},
    ),
    Case(
        "gmsh_cut_in_names",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:6:1: error: the file ends inside $PhysicalNames: expected physical name 2 of 2
    6 | 1 1 "LEFT"
      | ^
"""),
        files={"square.msh": first_lines(MSH_22, 6)},
    ),
    Case(
        "gmsh_cut_in_nodes",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:12:1: error: the file ends inside $Nodes: expected node 3 of 4
   12 | 2 1 0 0
      | ^
"""),
        files={"square.msh": first_lines(MSH_22, 12)},
    ),
    Case(
        "gmsh_cut_in_elements",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:18:1: error: the file ends inside $Elements: expected the number of element 2 of 3
   18 | 1 1 2 1 1 4 1
      | ^
"""),
        files={"square.msh": first_lines(MSH_22, 18)},
    ),
    Case(
        "gmsh_cut_in_end",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:20:1: error: the file ends inside $Elements: expected $EndElements
   20 | 3 2 2 2 1 1 3 4
      | ^
"""),
        files={"square.msh": first_lines(MSH_22, 20)},
    ),
    Case(
        "gmsh_4_cut_in_entities",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:10:1: error: the file ends inside $Entities: expected an entity of dimension 1
   10 | 0 1 1 0
      | ^
"""),
        files={"square.msh": first_lines(MSH_41, 10)},
    ),
    Case(
        "gmsh_4_cut_in_node_block",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:15:1: error: the file ends inside $Nodes: expected a block of nodes
   15 | 1 4 1 4
      | ^
"""),
        files={"square.msh": first_lines(MSH_41, 15)},
    ),
    Case(
        "gmsh_4_cut_in_coordinates",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:21:1: error: the file ends inside $Nodes: expected coordinates of node 2
   21 | 0 0 0
      | ^
"""),
        files={"square.msh": first_lines(MSH_41, 21)},
    ),
    Case(
        "gmsh_4_cut_in_element_block",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:26:1: error: the file ends inside $Elements: expected the numbers of blocks and elements
   26 | $Elements
      | ^~~~~~~~~
"""),
        files={"square.msh": first_lines(MSH_41, 26)},
    ),
    Case(
        "gmsh_4_cut_in_elements",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:27:1: error: the file ends inside $Elements: expected a block of elements
   27 | 2 3 1 3
      | ^
"""),
        files={"square.msh": first_lines(MSH_41, 27)},
    ),
    Case(
        "gmsh_binary",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:2:5: error: the mesh is binary: expected ASCII, 0 here (in gmsh: without -bin, Mesh.Binary = 0)
    2 | 2.2 1 8
      |     ^
"""),
        files={"square.msh": edited(MSH_22, ("2.2 0 8", "2.2 1 8"))},
    ),
    Case(
        "gmsh_4_binary",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:2:5: error: the mesh is binary: expected ASCII, 0 here (in gmsh: without -bin, Mesh.Binary = 0)
    2 | 4.1 1 8
      |     ^
"""),
        files={"square.msh": edited(MSH_41, ("4.1 0 8", "4.1 1 8"))},
    ),
    Case(
        "gmsh_version_1",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:2:1: error: format 1 is not supported: expected 2.2 or 4.1 (in gmsh: -format msh41)
    2 | 1 0 8
      | ^
"""),
        files={"square.msh": edited(MSH_22, ("2.2 0 8", "1 0 8"))},
    ),
    Case(
        "gmsh_hexahedra",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:19:3: error: hexahedron (gmsh type 5) cannot be used: expected lines, triangles, tetrahedra or points (gmsh types 1, 2, 4, 8, 9, 11, 15)
   19 | 2 5 2 2 1 1 2 3 4 1 2 3 4
      |   ^
"""),
        files={"square.msh": edited(MSH_22, ("2 2 2 2 1 1 2 3", "2 5 2 2 1 1 2 3 4 1 2 3 4"))},
    ),
    Case(
        "gmsh_quadrangles",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:19:3: error: quadrangle (gmsh type 3) cannot be used: expected lines, triangles, tetrahedra or points (gmsh types 1, 2, 4, 8, 9, 11, 15)
   19 | 2 3 2 2 1 1 2 3 4
      |   ^
"""),
        files={"square.msh": edited(MSH_22, ("2 2 2 2 1 1 2 3", "2 3 2 2 1 1 2 3 4"))},
    ),
    Case(
        "gmsh_text_for_coordinate",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:13:5: error: 'one' is not a number: expected y of a node
   13 | 3 1 one 0
      |     ^~~
"""),
        files={"square.msh": edited(MSH_22, ("3 1 1 0", "3 1 one 0"))},
    ),
    Case(
        "gmsh_nan",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:13:5: error: 'nan' is not a number: expected y of a node
   13 | 3 1 nan 0
      |     ^~~
"""),
        files={"square.msh": edited(MSH_22, ("3 1 1 0", "3 1 nan 0"))},
    ),
    Case(
        "gmsh_undefined_node",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:19:15: error: node 9 does not exist: expected a node of $Nodes
   19 | 2 2 2 2 1 1 2 9
      |               ^
"""),
        files={"square.msh": edited(MSH_22, ("2 2 2 2 1 1 2 3", "2 2 2 2 1 1 2 9"))},
    ),
    Case(
        "gmsh_node_twice",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:14:1: error: node 3 is defined twice: expected every number once
   14 | 3 0 1 0
      | ^
"""),
        files={"square.msh": edited(MSH_22, ("4 0 1 0\n", "3 0 1 0\n"))},
    ),
    Case(
        "gmsh_negative_element",
        MESH_FILE,
        [],
        3,
        text("""
job.inp:1:13: error: element 2: negative volume -0.5: expected corner nodes in positive order, counter-clockwise
    1 | *MESH, FILE="square.msh"
      |             ^~~~~~~~~~~~
"""),
        files={"square.msh": edited(MSH_22, ("2 2 2 2 1 1 2 3", "2 2 2 2 1 1 3 2"))},
    ),
    Case(
        "gmsh_without_body",
        MESH_FILE,
        [],
        2,
        text("""
job.inp:6:25: error: element set 'BODY' is not defined: expected the name of an element set
    6 | *MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=1
      |                         ^~~~
"""),
        files={"square.msh": edited(MSH_22, ('2 2 "BODY"', '2 2 "SOIL"'))},
    ),
    Case(
        "gmsh_too_few_nodes",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:15:1: error: '$EndNodes' is not an integer: expected the number of node 5 of 5
   15 | $EndNodes
      | ^~~~~~~~~
"""),
        files={"square.msh": edited(MSH_22, ("$Nodes\n4", "$Nodes\n5"))},
    ),
    Case(
        "gmsh_not_a_mesh",
        MESH_FILE,
        [],
        3,
        text("""
square.msh:1:1: error: expected the start of a section such as $MeshFormat or $Nodes
    1 | *NODE
      | ^~~~~
"""),
        files={"square.msh": "*NODE\n1, 0, 0\n"},
    ),
    Case(
        "gmsh_empty",
        MESH_FILE,
        [],
        3,
        text("""
square.msh: error: the file is empty: expected a gmsh mesh
"""),
        files={"square.msh": ""},
    ),
    Case(
        "mesh_file_missing",
        MESH_FILE,
        [],
        8,
        text("""
job.inp:1:13: error: cannot read this mesh: Cannot open file 'square.msh': No such file or directory: expected a gmsh file, 2.2 or 4.1 ASCII
    1 | *MESH, FILE="square.msh"
      |             ^~~~~~~~~~~~
"""),
    ),
    Case(
        "mesh_file_is_folder",
        MESH_FILE,
        [],
        8,
        text("""
job.inp:1:13: error: cannot read this mesh: Is a directory: expected a gmsh file, 2.2 or 4.1 ASCII
    1 | *MESH, FILE="square.msh"
      |             ^~~~~~~~~~~~
"""),
        files={"square.msh/": ""},
    ),
    Case(
        "stl_format",
        MESH_FILE,
        [('FILE="square.msh"', 'FILE="square.msh", FORMAT=STL')],
        2,
        text("""
job.inp:1:34: error: FORMAT of *MESH is 'STL': expected GMSH
    1 | *MESH, FILE="square.msh", FORMAT=STL
      |                                  ^~~
"""),
        files={"square.msh": MSH_22},
    ),
    Case(
        "transform_of_unknown_set",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Y2\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n")],
        2,
        text("""
job.inp:8:18: error: node set 'Y2' is not defined: expected the name of a node set
    8 | *TRANSFORM, NSET=Y2
      |                  ^~ did you mean 'Y0'?
"""),
    ),
    Case(
        "transform_of_unknown_type",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1, TYPE=Q\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:8:27: error: TYPE of *TRANSFORM is 'Q': expected R, C or S
    8 | *TRANSFORM, NSET=Y1, TYPE=Q
      |                           ^
"""),
    ),
    Case(
        "transform_without_points",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Y1\n*MATERIAL, NAME=CLAY\n")],
        2,
        text("""
job.inp:8:1: error: missing data line of *TRANSFORM: expected xa, ya[, za[, xb[, yb[, zb]]]]
    8 | *TRANSFORM, NSET=Y1
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "transform_with_two_lines",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1\n0, 1, -1, 0\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:10:1: error: too many data lines of *TRANSFORM: expected 1
   10 | 0, 1, -1, 0
      | ^~~~~~~~~~~
"""),
    ),
    Case(
        "transform_with_too_few_numbers",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Y1\n0, 1, -1\n*MATERIAL, NAME=CLAY\n")],
        2,
        text("""
job.inp:9:1: error: 3 numbers in a plane mesh: expected xa, ya, xb, yb
    9 | 0, 1, -1
      | ^~~~~~~~
"""),
    ),
    Case(
        "transform_in_space_with_four_numbers",
        SOLID,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Z1\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n")],
        2,
        text("""
job.inp:7:1: error: 4 numbers in a 3-D mesh: expected xa, ya, za, xb, yb, zb
    7 | 0, 1, -1, 0
      | ^~~~~~~~~~~
"""),
    ),
    Case(
        "plane_cylinder_with_four_numbers",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1, TYPE=C\n0, 0, 1, 0\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:9:1: error: 4 numbers in a plane mesh: expected xa, ya of the axis
    9 | 0, 0, 1, 0
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "plane_transform_out_of_plane",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1\n0, 1, 0, -1, 0, 2\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:9:17: error: z = 2 in a plane mesh: expected 0
    9 | 0, 1, 0, -1, 0, 2
      |                 ^
"""),
    ),
    Case(
        "plane_cylinder_with_inclined_axis",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1, TYPE=C\n0, 0, 0, 1, 0, 1\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:9:10: error: the axis is not normal to the plane of the mesh: expected xb, yb equal to xa, ya, and zb another than za
    9 | 0, 0, 0, 1, 0, 1
      |          ^
"""),
    ),
    Case(
        "plane_transform_on_sphere",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1, TYPE=S\n0, 0, 0, 0, 0, 1\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:8:27: error: spherical axes in a plane mesh: expected TYPE=R or TYPE=C
    8 | *TRANSFORM, NSET=Y1, TYPE=S
      |                           ^
"""),
    ),
    Case(
        "transform_with_points_on_one_line",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Y1\n1, 1, 2, 2\n*MATERIAL, NAME=CLAY\n")],
        2,
        text("""
job.inp:9:1: error: a and b lie on one line through the origin: expected a on axis 1 and b beside it, in the plane of axes 1 and 2
    9 | 1, 1, 2, 2
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "cylinder_without_axis",
        SOLID,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Z1, TYPE=C\n0, 0, 2, 0, 0, 2\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:7:1: error: a and b are the same point: expected two points of the axis
    7 | 0, 0, 2, 0, 0, 2
      | ^~~~~~~~~~~~~~~~
"""),
    ),
    Case(
        "sphere_without_pole",
        SOLID,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Z1, TYPE=S\n3, 3, 3, 3, 3, 3\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:7:1: error: a and b are the same point: expected the centre and a point of the polar axis
    7 | 3, 3, 3, 3, 3, 3
      | ^~~~~~~~~~~~~~~~
"""),
    ),
    Case(
        "node_on_axis_of_cylinder",
        PLANE,
        [("*MATERIAL, NAME=CLAY\n", "*TRANSFORM, NSET=Y1, TYPE=C\n1, 1\n*MATERIAL, NAME=CLAY\n")],
        3,
        text("""
job.inp:8:18: error: node 9 lies on the axis, where radial and tangential have no direction: expected nodes beside it
    8 | *TRANSFORM, NSET=Y1, TYPE=C
      |                  ^~
"""),
    ),
    Case(
        "node_at_centre_of_sphere",
        SOLID,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Z1, TYPE=S\n1, 0, 1, 1, 0.5, 3\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        3,
        text("""
job.inp:6:18: error: node 6 lies on the axis, where radial and tangential have no direction: expected nodes beside it
    6 | *TRANSFORM, NSET=Z1, TYPE=S
      |                  ^~
"""),
    ),
    Case(
        "node_in_two_transforms",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*TRANSFORM, NSET=Y1\n0, 1, -1, 0\n*TRANSFORM, NSET=X0\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        2,
        text("""
job.inp:10:18: error: node 7 has axes by the *TRANSFORM of line 8 already: expected one *TRANSFORM for a node
   10 | *TRANSFORM, NSET=X0
      |                  ^~
"""),
    ),
    Case(
        "transform_in_a_step",
        PLANE,
        [("*BOUNDARY\n", "*TRANSFORM, NSET=Y1\n0, 1, -1, 0\n*BOUNDARY\n")],
        2,
        text("""
job.inp:19:1: error: *TRANSFORM of the model: expected before the first *STEP
   19 | *TRANSFORM, NSET=Y1
      | ^~~~~~~~~~
"""),
    ),
    Case(
        "driver_with_other_axes",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*NSET, NSET=ONE\n8\n*TRANSFORM, NSET=ONE\n0, 1, -1, 0\n*MOVING MESH, DRIVER=Y1, DIRECTION=0,1, FIXED=Y0\n*MATERIAL, NAME=CLAY\n",
            )
        ],
        3,
        text("""
job.inp:12:22: error: node 8 of the driver has other axes than the rest: expected one *TRANSFORM for the set, or none
   12 | *MOVING MESH, DRIVER=Y1, DIRECTION=0,1, FIXED=Y0
      |                      ^~
"""),
    ),
    Case(
        "roller_turned_away",
        PLANE,
        [
            (
                "*MATERIAL, NAME=CLAY\n",
                "*NSET, NSET=MIDDLE\n4\n*TRANSFORM, NSET=MIDDLE\n0, 1, -1, 0\n*MATERIAL, NAME=CLAY\n",
            ),
            ("X0, 1, 1", "MIDDLE, 1, 1"),
        ],
        3,
        text("""
job.inp:20:1: error: the body of element 1 is free to move in this step (translation in x): expected *BOUNDARY conditions that hold it, such as X0, 1, 1
   20 | *STEP, NAME=PUSH, INC=20
      | ^~~~~
"""),
    ),
    Case(
        "no_convergence",
        PLANE,
        [
            ("INC=20\n", "INC=20\n"),
            ("DIRECT\n1, 1", "DIRECT\n1, 1, 1"),
            ("*BOUNDARY\n", "*CONTROLS, MAX ITERATIONS=1\n*BOUNDARY\n"),
            ("-0.001\n*HIS", "-0.3\n*HIS"),
        ],
        4,
        text("""
error: no convergence at the smallest increment 1: too many iterations (step 'PUSH', increment 1, attempt 1, step time 0)
  worst place: node 6 at (1, 0.5), element 4 at (0.833333, 0.333333), material point 4 at (0.833333, 0.333333)
  likely cause: MAX ITERATIONS=1 of *CONTROLS are too few: the residual was 0.382973, allowed is 1e-9
  last attempt: job_fail.vtkhdf
"""),
        arguments=("-q",),
    ),
    Case(
        "linear_solver_that_is_none",
        PLANE,
        [("*BOUNDARY\n", "*CONTROLS, LINEAR SOLVER=CHOLESKY\n*BOUNDARY\n")],
        2,
        text("""
job.inp:19:26: error: LINEAR SOLVER of *CONTROLS is 'CHOLESKY': expected DIRECT, RECYCLED or MUMPS
   19 | *CONTROLS, LINEAR SOLVER=CHOLESKY
      |                          ^~~~~~~~
"""),
    ),
    Case(
        "point_lost",
        PLANE,
        [
            ("X0, 1, 1\nY0, 2, 2\nY1, 2, 2, -0.001", "X0, 1, 1, 5.0\nY0, 2, 2\nY1, 2, 2"),
            ("*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL\n1.0, 0.0\n", ""),
        ],
        6,
        text("""
error: 8 material points left the mesh, the first is point 1 at (5.33333, 0.166667): expected a mesh that reaches further, or *LOST POINTS, ACTION=FREEZE or REMOVE (step 'PUSH', increment 1, step time 1)
  worst place: node 5 at (0.5, 0.5), element 1 at (0.333333, 0.166667), material point 1 at (5.33333, 0.166667)
  last attempt: job_fail.vtkhdf
"""),
        arguments=("-q",),
    ),
    Case(
        "expect_failed",
        PLANE,
        [("-0.001, 1e-9", "-0.002, 1e-9")],
        7,
        "EXPECT job.inp:28 MEAN U2[Y1] at 1: analytic -0.002 +- 2e-12, found -0.001: FAILED\n",
        arguments=("-q",),
    ),
]
