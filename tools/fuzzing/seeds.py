"""Decks to start from: those of input/, made small, and the small ones of the tests."""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(rb'^\*INCLUDE,\s*INPUT\s*=\s*"?([^"\n]+?)"?\s*$', re.IGNORECASE)
MESH = re.compile(rb'^(\*MESH,\s*FILE\s*=\s*)"?([^",\n]+?)"?(\s*(?:,.*)?)$', re.IGNORECASE)
CELLS = re.compile(rb"^(\s*[XYZ]\s*,[^,]+,[^,]+,\s*)(\d+)(.*)$", re.IGNORECASE)


@dataclass
class Seed:
    """A deck in one piece."""

    name: str
    lines: list[bytes]
    meshes: dict[str, Path] = field(default_factory=dict)  # flat name and file
    share: float = 1.0  # how often it is chosen, beside its cost

    def cost(self) -> float:
        """About the CPU time of the driver [s]: from what the deck says, not from a clock, so that
        the same decks are chosen everywhere."""
        cells = dict.fromkeys(b"XYZ", 0)
        for line in self.lines:
            match = CELLS.match(line)
            if match:
                cells[line.strip().upper()[0]] += int(match[2])
        product = 1.0
        for n in cells.values():
            product *= max(n, 1)
        size = sum(map(len, self.lines)) + 10 * sum(p.stat().st_size for p in self.meshes.values())
        return 5e-4 + 4e-7 * size + 2e-4 * product


def one_piece(path: Path, meshes: dict[str, Path]) -> list[bytes]:
    """The lines of a deck with its includes in their places; meshes get flat names."""
    lines = []
    for line in path.read_bytes().split(b"\n"):
        include, mesh = INCLUDE.match(line), MESH.match(line)
        if include:
            lines += one_piece(path.parent / include[1].decode(), meshes)
        elif mesh:
            file = (path.parent / mesh[2].decode()).resolve()
            name = "_".join(file.relative_to(ROOT).parts[1:])
            meshes[name] = file
            lines.append(mesh[1] + b'"' + name.encode() + b'"' + mesh[3])
        else:
            lines.append(line)
    return lines


def small(lines: list[bytes], most: int) -> list[bytes]:
    """The same with few cells in every line of *GENERATE."""
    return [
        CELLS.sub(lambda m: m[1] + str(min(int(m[2]), most)).encode() + m[3], line)
        for line in lines
    ]


def shipped() -> list[Seed]:
    """The decks of input/, once as they are and once small when that makes a difference."""
    seeds = []
    for path in sorted((ROOT / "input").rglob("*.inp")):
        meshes: dict[str, Path] = {}
        lines = one_piece(path, meshes)
        name = str(path.relative_to(ROOT))
        seeds.append(Seed(name, lines, meshes))
        if small(lines, 2) != lines:
            seeds.append(Seed(name + " with 2 cells", small(lines, 2), meshes))
    return seeds


def tested() -> list[Seed]:
    """The decks of tests/bad_input_cases.py: already wrong, each in its way."""
    sys.path.insert(0, str(ROOT / "tests"))
    import bad_input_cases as table

    bases = {"PLANE": table.PLANE, "SOLID": table.SOLID, "NODES": table.NODES}
    seeds = [Seed(name, text.encode().split(b"\n")) for name, text in bases.items()]
    for case in table.CASES:
        if not case.files and len(case.deck()) < 4000:
            text = case.deck().encode("utf-8", "surrogateescape")
            seeds.append(Seed(case.name, text.split(b"\n"), share=0.1))
    return seeds
