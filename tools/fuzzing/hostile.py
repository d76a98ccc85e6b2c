"""Files that are no files, files without end, and a handful of very large ones."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path

from fuzzing.mesh_model import box, sections_22, sections_41
from fuzzing.mesh_mutation import DECK

STEP = "*STEP\n*STATIC\n1, 1\n*END STEP\n"
SPECIAL_FILES = ("fifo", "folder", "socket", "link.inc", "/dev/zero", "/dev/full", "/dev/null",
                 "/dev/tty", "/proc/self/mem", "/proc/self/maps", "/dev/stdin", "none")  # fmt: skip


def make_special_files(folder: Path) -> None:
    """What the decks of this package name."""
    if not (folder / "fifo").exists():
        os.mkfifo(folder / "fifo")
        (folder / "folder").mkdir()
        (folder / "link.inc").symlink_to("link.inc")
        with socket.socket(socket.AF_UNIX) as listener:
            here = Path.cwd()
            os.chdir(folder)
            listener.bind("socket")
            os.chdir(here)
    (folder / "empty.inc").write_bytes(b"")
    (folder / "nul.inc").write_bytes(b"\0" * 4096)
    (folder / "loop.inc").write_text('*INCLUDE, INPUT="loop.inc"\n')
    for i in range(13):
        (folder / f"deep{i}.inc").write_text(f'*INCLUDE, INPUT="deep{i + 1}.inc"\n')
    (folder / "deep13.inc").write_text("*HEADING\ndeep\n")


def hostile_decks(folder: Path) -> Iterator[tuple[str, Path]]:
    """Name and file of decks, each written just before it is handed out and removed afterwards."""
    for special in SPECIAL_FILES:
        yield f"deck is {special}", folder / special
    for name, text in texts():
        path = folder / "hostile.inp"
        path.write_bytes(text)
        yield name, path
        path.unlink()
    yield from hostile_meshes(folder)


def texts() -> Iterator[tuple[str, bytes]]:
    """Decks without a mesh file."""
    for special in SPECIAL_FILES:
        yield f"include {special}", f'*INCLUDE, INPUT="{special}"\n{STEP}'.encode()
        yield f"mesh {special}", (DECK.format(mesh=special, formulation="STANDARD", dim=2)).encode()
    yield "deep includes", f'*INCLUDE, INPUT="deep0.inc"\n{STEP}'.encode()
    yield "cyclic include", f'*INCLUDE, INPUT="loop.inc"\n{STEP}'.encode()
    yield "many includes", b'*INCLUDE, INPUT="empty.inc"\n' * 20000
    yield "line of 100 MB", b"*HEADING\n" + b"x" * 100_000_000 + b"\n" + STEP.encode()
    yield "keyword of 100 MB", b"*" + b"A" * 100_000_000
    yield "100 MB of line ends", b"\n" * 100_000_000
    yield "100 MB of carriage returns", b"\r" * 100_000_000
    yield "100 MB of NUL", b"\0" * 100_000_000
    yield "100 MB of stars", b"*" * 100_000_000
    yield "100 MB without UTF-8", b"\xff\n" * 50_000_000
    yield "100 MB of commas", b",\n" * 1_000_000
    yield "long name", b"*MATERIAL, NAME=" + b"N" * 10000 + b"\n*ELASTIC\n1,0\n" + STEP.encode()
    yield "100,000 keywords", b"*STATIC\n" * 100_000
    yield "100,000 wrong keywords", b"".join(b"*STATI%d\n" % i for i in range(100_000))
    yield "100,000 lines of data", b"*NODE\n" + b"1, 2, x\n" * 100_000 + STEP.encode()
    yield "100,000 nodes", b"*NODE\n" + b"1, 2, 3\n" * 100_000 + b"*ELEMENT, TYPE=CPE3\n1,1,2,3\n"
    yield "100,000 sets", b"".join(b"*NSET, NSET=N%d\n1\n" % i for i in range(100_000))
    yield "100,000 parameters", b"*STEP" + b",\nNAME=A" * 100_000 + b"\n"
    yield "line that goes on 100,000 times", b"*NSET, NSET=A\n" + b"1,\n" * 100_000 + STEP.encode()
    yield "flags without end", b"*STEP" + b",\nINC" * 20_000 + b"\n"
    yield "values without end", b"*MOVING MESH, DIRECTION=1" + b",\n1" * 50_000 + b"\n"
    yield "quote without end", b'*MESH, FILE="' + b"x\n" * 10_000
    for cells in ("1000000000", "10000", "2147483647", "2147483648", "99999999999999999999"):
        yield f"box of {cells} cells each way", generated(cells).encode()
    yield (
        "list without end",
        (
            "*GENERATE, TYPE=BOX, DIMENSION=2\nX,0,1,1\nY,0,1,1\n*NSET, NSET=A, GENERATE\n"
            "1, 2147483647, 1\n*ELSET, ELSET=B, GENERATE\n1, 2000000000, 1\n" + STEP
        ).encode(),
    )


def generated(cells: str) -> str:
    """A box."""
    lines = "".join(f"{axis}, 0, 1, {cells}\n" for axis in "XYZ")
    return f"*GENERATE, TYPE=BOX, DIMENSION=3\n{lines}" + DECK.format(
        mesh="", formulation="STANDARD", dim=3
    ).split("\n", 1)[1].replace("BODY", "ALL").replace("LEFT", "X0")


def hostile_meshes(folder: Path) -> Iterator[tuple[str, Path]]:
    """Decks with meshes that are too much."""
    deck, mesh = folder / "hostile.inp", folder / "hostile.msh"
    deck.write_text(DECK.format(mesh="hostile.msh", formulation="STANDARD", dim=2))
    for name, data in meshes():
        mesh.write_bytes(data)
        yield name, deck
        mesh.unlink()
    deck.unlink()


def meshes() -> Iterator[tuple[str, bytes]]:
    """Meshes."""
    head = b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    yield "mesh line of 100 MB", head + b"$Nodes\n" + b"1 " * 50_000_000
    yield "mesh word of 100 MB", head + b"$Nodes\n" + b"1" * 100_000_000
    yield "mesh of 100 MB of line ends", head + b"\n" * 100_000_000
    yield "mesh of NUL", b"\0" * 100_000_000
    yield "mesh that begins with 100 MB", b"x" * 100_000_000
    yield "mesh of a section without end", head + b"$Comments\n" + b"x\n" * 10_000_000
    names = "".join(f'2 {i} "N{i}"\n' for i in range(1, 20_001))
    yield "mesh with 20,000 names", head + f"$PhysicalNames\n20000\n{names}".encode()
    for order, write in ((1, sections_22), (2, sections_41)):
        model = box(2, order, 1)
        for block in model.blocks:
            block.groups = list(range(1, 3001))
        sections = write(model)
        text = "\n".join(line for section in sections for line in section)
        yield f"mesh with 3,000 groups, order {order}", text.encode()
    filler = b"$Comments\n" + b"x" * 90_000_000 + b"\n$EndComments\n"
    for count in (b"80000000", b"40000000"):
        yield f"mesh of {count.decode()} nodes", head + b"$Nodes\n1 %s 1 1\n" % count + filler
        yield f"mesh of {count.decode()} names", head + b"$PhysicalNames\n%s\n" % count + filler
        yield (
            f"mesh of {count.decode()} entities",
            (head + b"$Entities\n%s %s 0 0\n" % (count, count) + filler),
        )
