"""Writes the Fortran module `funit`: the assertions of pFUnit that our tests use.

    python3 make_funit.py OUTPUT.f90

Every combination of type and rank is one small specific procedure that makes its arguments flat and
calls `compare` of pf_compare.f90. As in pFUnit, `expected` is a scalar or has the rank of `actual`.
"""

import sys

RELATIONS = {
    "Equal": "op_eq",
    "NotEqual": "op_ne",
    "LessThan": "op_lt",
    "LessThanOrEqual": "op_le",
    "GreaterThan": "op_gt",
    "GreaterThanOrEqual": "op_ge",
}

# name: (declaration of expected, of actual, expression that makes each flat)
REAL = {"real": ("real(real64)", "real(real64)", "[{}]")}
INTEGER = {
    "integer": ("integer", "integer", "[int({}, int64)]"),
    "long": ("integer(int64)", "integer(int64)", "[{}]"),
    "mixed": ("integer", "integer(int64)", "[int({}, int64)]"),
}
LOGICAL = {"logical": ("logical", "logical", "[{}]")}
CHARACTER = {"character": ("character(*)", "character(*)", "[{}]")}

RANKS = [(0, 0), (0, 1), (1, 1), (0, 2), (2, 2), (0, 3), (3, 3)]

HEADER = """\
!> The assertions. Written by make_funit.py.
module funit
  use, intrinsic :: iso_fortran_env, only: int64, real64
  use pf_compare, only: assertion, compare, op_eq, op_ge, op_gt, op_le, op_lt, op_ne, require
  use pf_run, only: anyExceptions, SourceLocation
  implicit none
  private
  public :: anyExceptions, SourceLocation
"""

CONDITIONS = """
  subroutine true_0(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    call require(condition, "AssertTrue", location, message)
  end subroutine true_0

  subroutine true_1(condition, message, location)
    logical, intent(in) :: condition(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    call require(all(condition), "ArrayAssertTrue", location, message)
  end subroutine true_1

  subroutine false_0(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    call require(.not. condition, "AssertFalse", location, message)
  end subroutine false_0

  subroutine false_1(condition, message, location)
    logical, intent(in) :: condition(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    call require(.not. any(condition), "ArrayAssertFalse", location, message)
  end subroutine false_1

  subroutine assertFail(message, location)
    character(*), intent(in) :: message
    type(SourceLocation), intent(in) :: location
    call require(.false., "AssertFail", location, message)
  end subroutine assertFail
"""

# The tolerance is an argument of its own, as in pFUnit, where the third position is the tolerance.
SPECIFIC = """
  subroutine {name}(expected, actual, {extra}message, location)
    {expected}, intent(in) :: expected{dims_expected}
    {actual}, intent(in) :: actual{dims_actual}
{declare_extra}\
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    call compare({flat_expected}, {flat_actual}, &
      assertion({op}, shape(expected), shape(actual), location, message{pass_extra}))
  end subroutine {name}
"""

TOLERANCE = "    real(real64), intent(in), optional :: tolerance\n"


def dimensions(rank):
    return "(" + ", ".join(":" * rank) + ")" if rank else ""


def types_of(relation):
    """Only numbers have an order; pFUnit has no "not equal" for text."""
    if relation == "Equal":
        return {**REAL, **INTEGER, **LOGICAL, **CHARACTER}
    if relation == "NotEqual":
        return {**REAL, **INTEGER, **LOGICAL}
    return {**REAL, **INTEGER}


def specific(relation, type_name, ranks):
    """Name and text of one specific procedure."""
    expected, actual, flat = types_of(relation)[type_name]
    has_tolerance = type_name == "real" and relation in ("Equal", "NotEqual")
    name = f"{relation.lower()}_{type_name}_{ranks[0]}{ranks[1]}"
    text = SPECIFIC.format(
        name=name,
        op=RELATIONS[relation],
        expected=expected,
        actual=actual,
        dims_expected=dimensions(ranks[0]),
        dims_actual=dimensions(ranks[1]),
        flat_expected=flat.format("expected"),
        flat_actual=flat.format("actual"),
        extra="tolerance, " if has_tolerance else "",
        declare_extra=TOLERANCE if has_tolerance else "",
        pass_extra=", tolerance" if has_tolerance else "",
    )
    return name, text


def interface(name, specifics):
    rows = ", &\n      ".join(specifics)
    return (
        f"  public :: assert{name}\n"
        f"  interface assert{name}\n    module procedure &\n      {rows}\n  end interface\n"
    )


def module():
    interfaces = [
        interface("True", ["true_0", "true_1"]),
        interface("False", ["false_0", "false_1"]),
        "  public :: assertFail\n",
    ]
    bodies = [CONDITIONS]
    for relation in RELATIONS:
        pairs = [
            specific(relation, type_name, ranks)
            for type_name in types_of(relation)
            for ranks in RANKS
        ]
        interfaces.append(interface(relation, [name for name, _ in pairs]))
        bodies.extend(text for _, text in pairs)
    parts = [HEADER, *interfaces, "contains", *bodies, "end module funit\n"]
    return "\n".join(parts)


def main():
    with open(sys.argv[1], "w", encoding="ascii") as output:
        output.write(module())


if __name__ == "__main__":
    main()
