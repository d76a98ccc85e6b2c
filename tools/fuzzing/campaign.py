"""Input after input: what was tried, how fast, and what was found."""

import hashlib
import re
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from fuzzing.deck_mutation import DeckMutator
from fuzzing.driver import Answer, Driver
from fuzzing.hostile import hostile_decks, make_special_files
from fuzzing.mesh_mutation import MeshMutator
from fuzzing.restart_mutation import RestartMutator
from fuzzing.schema import Schema
from fuzzing.seeds import ROOT, shipped, tested

BATCH = 100  # inputs between two looks at the driver
KEPT = 3  # inputs kept of each finding


@dataclass
class Figures:
    """What was tried of one kind of input."""

    kind: str
    tried: int = 0
    findings: Counter = field(default_factory=Counter)
    hangs: int = 0
    codes: Counter = field(default_factory=Counter)
    slowest: float = 0.0  # CPU time [s]
    slowest_name: str = ""
    memory: float = 0.0  # [MiB]
    seconds: float = 0.0  # wall time
    busy: float = 0.0  # CPU time of the driver [s]

    def count(self, name: str, answer: Answer) -> None:
        """Takes an answer in."""
        self.tried += 1
        self.codes[answer.code] += 1
        self.memory = max(self.memory, answer.memory)
        self.busy += answer.seconds
        if answer.seconds > self.slowest:
            self.slowest, self.slowest_name = answer.seconds, name
        if answer.trouble:
            self.findings[answer.trouble] += 1
            self.hangs += answer.trouble == "hang"

    def add(self, other: "Figures") -> None:
        """Takes in the figures of a process that ran beside."""
        self.tried += other.tried
        self.findings += other.findings
        self.hangs += other.hangs
        self.codes += other.codes
        self.busy += other.busy
        self.memory = max(self.memory, other.memory)
        self.seconds = max(self.seconds, other.seconds)
        if other.slowest > self.slowest:
            self.slowest, self.slowest_name = other.slowest, other.slowest_name

    def text(self) -> str:
        """The figures in a few lines."""
        codes = ", ".join(f"{code}: {n}" for code, n in sorted(self.codes.items(), key=str))
        lines = [
            f"{self.kind}: {self.tried} tried in {self.seconds:.0f} s, "
            f"{self.tried / max(self.seconds, 1e-9):.0f} per second, "
            f"{self.tried / max(self.busy, 1e-9):.0f} per second of CPU time; "
            f"{sum(self.findings.values())} findings of {len(self.findings)} kinds, "
            f"{self.hangs} hangs",
            f"  exit codes {codes}; largest memory of the process {self.memory:.0f} MiB; "
            f"slowest {self.slowest_name}, {self.slowest:.2f} s of CPU time",
        ]
        lines += [f"  {n} x {what}" for what, n in self.findings.most_common()]
        return "\n".join(lines)


class Campaign:
    """A run of the fuzzer."""

    def __init__(self, driver: Path, program: Path, seed: str, keep: Path, share=(0, 1)) -> None:
        """`share`: (k, n), every n-th input from number k."""
        self.folder = Path(tempfile.mkdtemp(prefix="tessera-fuzz-", dir=scratch()))
        self.driver = Driver(driver, self.folder)
        self.seed = seed
        self.keep = keep
        self.share = share
        self.program = program
        self.schema = Schema(program)
        make_special_files(self.folder)
        self.seeds = [*shipped(), *tested()]
        for one in self.seeds:
            for name, path in one.meshes.items():
                if not (self.folder / name).exists():
                    shutil.copy(path, self.folder / name)

    def close(self) -> None:
        """Ends the driver, removes the files."""
        self.driver.stop()
        shutil.rmtree(self.folder)

    def random(self, kind: str, number: int) -> Random:
        """The random numbers of one input: they do not depend on the others."""
        return Random(f"{self.seed} {kind} {number}")

    def unchanged(self) -> Figures:
        """Every seed as it is."""

        def write(i: int, slot: Path) -> str:
            slot.write_bytes(b"\n".join(self.seeds[i].lines))
            return f"model\t{slot.name}"

        return self.run("seeds", len(self.seeds), write)

    def decks(self, n: int) -> Figures:
        """Mutations of decks."""
        mutator = DeckMutator(self.seeds, self.schema)

        def write(i: int, slot: Path) -> str:
            slot.write_bytes(mutator.make(self.random("deck", i)))
            return f"model\t{slot.name}"

        return self.run("decks", n, write)

    def meshes(self, n: int) -> Figures:
        """Mutations of meshes."""
        mutator = MeshMutator(sorted((ROOT / "input").rglob("*.msh")))

        def write(i: int, slot: Path) -> str:
            mesh, deck = mutator.make(self.random("mesh", i))
            slot.with_suffix(".msh").write_bytes(mesh)
            slot.write_bytes(deck.replace(b"{mesh}", slot.stem.encode() + b".msh"))
            return f"model\t{slot.name}"

        return self.run("meshes", n, write)

    def restarts(self, n: int) -> Figures:
        """Mutations of a restart file, against the deck that it belongs to."""
        if n == 0:
            return Figures("restarts")
        mutator = RestartMutator(self.program, self.folder)

        def write(i: int, slot: Path) -> str:
            file = slot.with_suffix(".h5")
            file.write_bytes(mutator.make(self.random("restart", i)))
            return f"run\t--check\t-q\t-f\t--restart\t{file.name}\trestart.inp"

        return self.run("restarts", n, write)

    def hostile(self) -> Figures:
        """The handful of extreme inputs, each alone."""
        figures = Figures("extremes")
        start = time.monotonic()
        for i, (name, path) in enumerate(hostile_decks(self.folder)):
            if i % self.share[1] != self.share[0]:
                continue
            request = f"model\t{path.name if path.parent == self.folder else path}"
            self.driver.stop()
            self.driver.send([request])
            answer = self.driver.answers([request])[0]
            figures.count(name, answer)
            if answer.trouble:
                print(f"extreme: {name}: {answer.trouble}", flush=True)
        figures.seconds = time.monotonic() - start
        return figures

    def run(self, kind: str, n: int, write: Callable[[int, Path], str]) -> Figures:
        """Tries this share of the inputs 0 .. n-1; the next are made while the driver reads."""
        figures = Figures(kind)
        start = time.monotonic()
        waiting: list[tuple[int, Path, str]] = []
        numbers = range(self.share[0], n, self.share[1])
        for first in range(0, len(numbers) + BATCH, BATCH):
            batch = []
            for j, i in enumerate(numbers[first : first + BATCH]):
                slot = self.folder / f"{'ab'[first // BATCH % 2]}{j}.inp"
                batch.append((i, slot, write(i, slot)))
            if waiting:
                answers = self.driver.answers([request for _, _, request in waiting])
            if batch:
                self.driver.send([request for _, _, request in batch])
            for (i, slot, _), answer in zip(waiting, answers if waiting else []):
                figures.count(f"{kind}:{i}", answer)
                if answer.trouble:
                    self.save(kind, i, slot, answer, figures)
            waiting = batch
            figures.seconds = time.monotonic() - start
            if first % (100 * BATCH) == 0 and first > 0:
                print(f"  {kind} {first}, {figures.tried / figures.seconds:.0f} per second, "
                      f"{len(figures.findings)} kinds of findings", flush=True)  # fmt: skip
        return figures

    def save(self, kind: str, i: int, slot: Path, answer: Answer, figures: Figures) -> None:
        """Keeps the first inputs of a finding and what the driver said."""
        if figures.findings[answer.trouble] > KEPT:
            return
        name = re.sub(r"\W+", "-", answer.trouble)[:60]
        name += "-" + hashlib.sha256(answer.trouble.encode()).hexdigest()[:6]
        target = self.keep / name
        target.mkdir(parents=True, exist_ok=True)
        if kind == "restarts":
            shutil.copy(slot.with_suffix(".h5"), target / f"{kind}-{i}.h5")
        for path in (slot, slot.with_suffix(".msh")) if kind != "restarts" else ():
            if path.exists() and (path == slot or kind == "meshes"):
                text = path.read_bytes().replace(
                    slot.stem.encode() + b".msh", f"{kind}-{i}.msh".encode()
                )
                (target / f"{kind}-{i}{path.suffix}").write_bytes(text)
        (target / f"{kind}-{i}.txt").write_text(f"{answer.trouble}\n{answer.stderr}")
        print(f"  {kind}:{i} {answer.trouble}", flush=True)


def scratch() -> Path | None:
    """A folder in memory, if there is one."""
    shared = Path("/dev/shm")
    return shared if shared.is_dir() else None
