#!/usr/bin/env python3
"""Mesh of the quarter model of a square footing, from coarse to fine.

The block 0 <= x, y, z <= 5 m with the footing 0 <= x, y <= 0.5 m on its top z = 5 m becomes
ten-node tetrahedra with straight edges, small under the footing and growing with the distance
from it. The boundary of the footing is meshed exactly. Written as gmsh 4.1 ASCII with the
physical groups x0 x1 y0 y1 base top footing (surfaces) and soil (volume).

Needs the Python module of gmsh: pip install gmsh
"""

import argparse
import sys
from math import hypot
from pathlib import Path

SIDE = 5.0  # edge of the block [m]
HALF_WIDTH = 0.5  # edge of the quarter footing [m]

# Edge lengths of the coarse mesh: NEAR at the footing, growing with the distance d from it
# as NEAR + GROWTH * d, at most FAR [m, -, m]. Finer meshes: the same field, scaled down.
NEAR, GROWTH, FAR = 0.25, 0.45, 2.5

# Name: factor on the edge lengths, ten-node tetrahedra that gmsh 4.15 makes of it.
SIZES = {
    "coarse": (1.0, 529),
    "medium": (0.625, 1296),
    "fine": (0.46, 2507),
    "finer": (0.286, 7831),
    "finest": (0.221, 16171),
}


def edge_length(x, y, z, factor):
    """Edge length wanted at a place [m]."""
    beside = hypot(max(x - HALF_WIDTH, 0.0), max(y - HALF_WIDTH, 0.0))
    return factor * min(NEAR + GROWTH * hypot(beside, SIDE - z), FAR)


def add_geometry(geo):
    """The block and its named surfaces; answers {name: surface tags}."""
    corners = [
        (0, 0, 0), (SIDE, 0, 0), (SIDE, SIDE, 0), (0, SIDE, 0),
        (0, 0, SIDE), (SIDE, 0, SIDE), (SIDE, SIDE, SIDE), (0, SIDE, SIDE),
        (HALF_WIDTH, 0, SIDE), (HALF_WIDTH, HALF_WIDTH, SIDE), (0, HALF_WIDTH, SIDE),
    ]  # fmt: skip
    point = [geo.addPoint(*corner) for corner in corners]
    lines = {}

    def line(a, b):
        """Line between two corners, made once, negative when run through backwards."""
        if (b, a) in lines:
            return -lines[b, a]
        if (a, b) not in lines:
            lines[a, b] = geo.addLine(point[a], point[b])
        return lines[a, b]

    def face(*loop):
        edges = [line(a, b) for a, b in zip(loop, loop[1:] + loop[:1])]
        return geo.addPlaneSurface([geo.addCurveLoop(edges)])

    surfaces = {
        "base": face(0, 3, 2, 1),
        "y0": face(0, 1, 5, 8, 4),
        "x0": face(0, 4, 10, 7, 3),
        "x1": face(1, 2, 6, 5),
        "y1": face(2, 3, 7, 6),
        "footing": face(4, 8, 9, 10),
        "top": face(8, 5, 6, 7, 10, 9),
    }
    geo.addVolume([geo.addSurfaceLoop(list(surfaces.values()))])
    return surfaces


def make_mesh(gmsh, path, factor):
    """Write one mesh; answers the number of ten-node tetrahedra."""
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.option.setNumber("Mesh.Binary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add("footing")
        surfaces = add_geometry(gmsh.model.geo)
        gmsh.model.geo.synchronize()
        for name, tag in surfaces.items():
            gmsh.model.addPhysicalGroup(2, [tag], name=name)
        gmsh.model.addPhysicalGroup(3, [1], name="soil")
        gmsh.model.mesh.setSizeCallback(
            lambda dim, tag, x, y, z, size: edge_length(x, y, z, factor)
        )
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.optimize("Netgen")
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
        tetrahedra, _ = gmsh.model.mesh.getElementsByType(11)
        return len(tetrahedra)
    finally:
        gmsh.finalize()


def main():
    """Command line."""
    parser = argparse.ArgumentParser(
        description="Write a mesh of the quarter model of the square footing (gmsh 4.1 ASCII).",
        epilog="sizes (ten-node tetrahedra): "
        + ", ".join(f"{name} {count}" for name, (_, count) in SIZES.items()),
    )
    parser.add_argument("--size", choices=SIZES, default="coarse", help="default: coarse")
    parser.add_argument(
        "--factor", type=float, help="factor on the edge lengths of the coarse mesh, over --size"
    )
    parser.add_argument(
        "-o", "--output", type=Path, help="file to write (default: footing_SIZE.msh)"
    )
    arguments = parser.parse_args()
    factor = SIZES[arguments.size][0] if arguments.factor is None else arguments.factor
    if not 0.0 < factor <= 1.0:
        parser.error("--factor: expected a number above 0, at most 1")
    path = arguments.output or Path(f"footing_{arguments.size}.msh")

    try:
        import gmsh
    except (ImportError, OSError) as error:
        print(f"make_mesh.py: gmsh's Python module does not load: {error}", file=sys.stderr)
        print("expected: pip install gmsh, and the libraries of README.md", file=sys.stderr)
        return 1
    count = make_mesh(gmsh, path, factor)
    print(f"{path}: {count} ten-node tetrahedra, {8 * count} linear ones after the split")
    return 0


if __name__ == "__main__":
    sys.exit(main())
