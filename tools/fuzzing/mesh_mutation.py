"""Meshes changed so that they are nearly right, or not at all."""

import copy
from pathlib import Path
from random import Random

from fuzzing import deck_mutation, words
from fuzzing.mesh_model import ON_MODEL, Model, box, sections_22, sections_41

HEADERS = (
    "$MeshFormat", "$EndMeshFormat", "$Nodes", "$EndNodes", "$Elements", "$EndElements",
    "$PhysicalNames", "$EndPhysicalNames", "$Entities", "$EndEntities", "$Periodic", "$Comments",
    "$EndComments", "$PartitionedEntities", "$NodeData", "$", "$End", "$$", "Nodes", "$nodes",
)  # fmt: skip
FORMATS = (
    "2.2 0 8", "4.1 0 8", "4.1 1 8", "2.2 1 8", "4.0 0 8", "2 0 8", "1 0 8", "4.1 0 4", "4.1",
    "2.2 0", "4.1 0 8 9", "nan 0 8", "1e308 0 8", "-1 0 8", "2.2 -1 8", "2.24 0 8",
    "2147483648 0 8",
)  # fmt: skip

DECK = """\
*MESH, FILE="{mesh}"
*FORMULATION, TYPE={formulation}
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=1
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
LEFT, 1, {dim}
*END STEP
"""


class MeshMutator:
    """Makes meshes from small boxes and from the files of input/."""

    def __init__(self, files: list[Path]) -> None:
        self.models = [box(dim, order, n) for dim in (2, 3) for order in (1, 2) for n in (1, 2)]
        self.files = [path.read_bytes() for path in files]
        self.on_lines = (
            deck_mutation.delete_line, deck_mutation.repeat_line, deck_mutation.swap_lines,
            deck_mutation.repeat_much, change_header, change_format, change_token, change_token,
            change_token, change_count, change_count, drop_token, add_token,
        )  # fmt: skip
        self.on_bytes = (
            deck_mutation.flip_byte, deck_mutation.insert_bytes, deck_mutation.truncate,
            deck_mutation.line_ends, deck_mutation.mark, deck_mutation.delete_bytes,
            deck_mutation.repeat_bytes,
        )  # fmt: skip

    def make(self, random: Random) -> tuple[bytes, bytes]:
        """A mesh, and a deck with {mesh} for its file."""
        dim = 2
        if random.random() < 0.0005 and self.files:
            lines = random.choice(self.files).decode().split("\n")
        else:
            model = copy.deepcopy(random.choice(self.models))
            dim = model.dim
            lines = self.written(random, model)
        data = [line.encode("utf-8", "surrogatepass") for line in lines]
        while random.random() < 0.45:
            random.choice(self.on_lines)(random, data)
        text = b"\n".join(data) + b"\n"
        while random.random() < 0.1:
            text = random.choice(self.on_bytes)(random, text)
        formulation = random.choice(("STANDARD", "FBAR PATCH"))
        return text, DECK.replace("{formulation}", formulation).replace("{dim}", str(dim)).encode()

    def written(self, random: Random, model: Model) -> list[str]:
        """A changed model as lines."""
        while random.random() < 0.6:
            random.choice(ON_MODEL)(random, model)
        sections = random.choice((sections_22, sections_41))(model)
        while random.random() < 0.15:
            change_sections(random, sections)
        return [line for section in sections for line in section]


def change_sections(random: Random, sections: list[list[str]]) -> None:
    """Sections missing, twice, in another order, or of the other format."""
    kind = random.randrange(5)
    i = random.randrange(len(sections)) if sections else 0
    if kind == 0 and sections:
        del sections[i]
    elif kind == 1 and sections:
        sections.insert(random.randint(0, len(sections)), list(sections[i]))
    elif kind == 2:
        random.shuffle(sections)
    elif kind == 3:
        sections.append(["$Comments", "$Nodes", "1", '"$EndNodes', "$EndComments"])
    elif sections:
        sections[i] = sections[i][:1] + sections[i][-1:]


def change_header(random: Random, lines: list[bytes]) -> None:
    """Another header."""
    heads = [i for i, line in enumerate(lines) if line.startswith(b"$")]
    if heads:
        lines[random.choice(heads)] = random.choice(HEADERS).encode()


def change_format(random: Random, lines: list[bytes]) -> None:
    """Another format."""
    if len(lines) > 1 and random.random() < 0.3:
        lines[1] = random.choice(FORMATS).encode()


def change_count(random: Random, lines: list[bytes]) -> None:
    """A number behind the header of a section."""
    heads = [i for i, line in enumerate(lines[:-1]) if line.startswith(b"$") and b"End" not in line]
    if heads:
        i = random.choice(heads) + random.choice((1, 1, 2))
        lines[min(i, len(lines) - 1)] = with_token(random, lines[min(i, len(lines) - 1)])


def change_token(random: Random, lines: list[bytes]) -> None:
    """A number of any line."""
    if lines:
        i = random.randrange(len(lines))
        lines[i] = with_token(random, lines[i])


def with_token(random: Random, line: bytes) -> bytes:
    """A line with one number changed."""
    tokens = line.split()
    if not tokens:
        return line
    i = random.randrange(len(tokens))
    if random.random() < 0.5:
        tokens[i] = words.near(random, tokens[i].decode("utf-8", "replace")).encode()
    else:
        tokens[i] = words.number(random).encode()
    return b" ".join(tokens)


def drop_token(random: Random, lines: list[bytes]) -> None:
    """A line with a number less."""
    i = random.randrange(len(lines)) if lines else 0
    if lines and lines[i].split():
        tokens = lines[i].split()
        del tokens[random.randrange(len(tokens))]
        lines[i] = b" ".join(tokens)


def add_token(random: Random, lines: list[bytes]) -> None:
    """A line with a number more."""
    if lines:
        i = random.randrange(len(lines))
        lines[i] += b" " + words.number(random).encode()
