#!/usr/bin/env python3
"""The coarser and the finer mesh of the footing, by make_mesh.py of input/footing.

python make_meshes.py       needs gmsh, see input/footing/README.md
"""

import sys
from pathlib import Path

import gmsh

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "footing"))

from make_mesh import make_mesh  # noqa: E402

FACTORS = {"coarse.msh": 2.0, "fine.msh": 0.5}  # on the edge lengths of the given mesh

for name, factor in FACTORS.items():
    print(name, make_mesh(gmsh, HERE / name, factor), "ten-node tetrahedra")
