"""Turn unit_patch.json into numbers that Fortran reads: one case after another.

The cases come from an independent implementation of the method (docs/theory.md). Of its three
methods, the finite-element volume update (`fbar_volF`) is not the program's and is left out.
Usage: unit_patch_to_text.py unit_patch.json unit_patch.txt
"""

import json
import sys

METHODS = {"smpm": 1, "fbar_volFbar": 2}


def voigt(tensor):
    """Components 11, 22, 33, 12, 23, 13 of a 3x3 tensor."""
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    return [tensor[i][j] for i, j in pairs]


def rows(array):
    """Lines of text for a list of numbers or of rows."""
    for row in array:
        values = row if isinstance(row, list) else [row]
        yield " ".join(repr(value) for value in values)


def write_case(case, out):
    """Write one case: sizes, then each array item by item."""
    print(
        case["nd"],
        METHODS[case["method"]],
        len(case["nodes"]),
        len(case["linear_elements"]),
        len(case["point_x"]),
        file=out,
    )
    print(case["E"], case["nu"], case["sigma_y"] or -1.0, file=out)
    arrays = (
        case["nodes"],
        [[node + 1 for node in element] for element in case["linear_elements"]],
        [element + 1 for element in case["point_element"]],
        case["point_volume"],
        [voigt(tensor) for tensor in case["point_be_n"]],
        case["point_J_n"],
        case["du"],
        [voigt(tensor) for tensor in case["tau"]],
        [voigt(tensor) for tensor in case["be_new"]],
        case["volume_new"],
        [int(flag) for flag in case["plastic"]],
        case["fint"],
        case["tangent"],
    )
    for array in arrays:
        for line in rows(array):
            print(line, file=out)


def main():
    """Write all cases of the program's methods."""
    with open(sys.argv[1], encoding="utf-8") as source:
        cases = [case for case in json.load(source) if case["method"] in METHODS]
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        print(len(cases), file=out)
        for case in cases:
            write_case(case, out)


if __name__ == "__main__":
    main()
