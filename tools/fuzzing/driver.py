"""The program that reads the inputs, what it answers, and how it may die."""

import contextlib
import os
import re
import select
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

LIMIT_SECONDS = 5.0  # CPU time of one input
LIMIT_MEMORY = 1024  # [MiB]
LIMIT_MESSAGE = 200_000  # characters
CODES = frozenset((*range(9), 130, 143))  # exit codes in docs/input.md
PATIENCE = 60.0  # wall time of an input that is tried alone [s]

TROUBLE = re.compile(
    r"AddressSanitizer|runtime error|Fortran runtime error|^At line \d+|Backtrace|Error allocating"
    r"|Allocation would exceed|SIGSEGV|SIGFPE|SIGABRT|hard rss limit|corrupt|double free"
    r"|METIS|GKlib",
    re.MULTILINE,
)
FRAME = re.compile(r"#\d+ \S+ in (__\w+_MOD_\w+|\w+) (\S*\.f90:\d+)")
PLACE = re.compile(r"(\S+\.f90:\d+)(?::\d+)?: runtime error: (.*)")
TRACE = re.compile(r"^#\d+.*\n\s+at (\S*/src/\S+\.f90:\d+)", re.MULTILINE)
AT_LINE = re.compile(r"At line (\d+) of file (\S+)\n(.*)")

ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "ASAN_OPTIONS": f"detect_leaks=0:hard_rss_limit_mb={LIMIT_MEMORY}:"
    f"max_allocation_size_mb={LIMIT_MEMORY}:allocator_may_return_null=1:quarantine_size_mb=4:malloc_context_size=1:"
    "detect_stack_use_after_return=0",
    "UBSAN_OPTIONS": "print_stacktrace=1",
}


@dataclass
class Answer:
    """What became of an input."""

    code: int | None  # exit code; None: it ended the driver
    n_message: int = 0
    unclean: bool = False
    seconds: float = 0.0
    memory: float = 0.0  # largest so far in this process [MiB]
    trouble: str = ""  # what is wrong, empty = nothing
    stderr: str = ""

    def judge(self) -> None:
        """Notes what must not be."""
        if self.trouble or self.code is None:
            return
        if self.code not in CODES:
            self.trouble = f"exit code {self.code}"
        elif self.n_message > LIMIT_MESSAGE:
            self.trouble = "a message longer than " + str(LIMIT_MESSAGE)
        elif self.unclean:
            self.trouble = "control characters in the message"
        elif self.seconds > LIMIT_SECONDS:
            self.trouble = f"more than {LIMIT_SECONDS:.0f} s"
        elif TROUBLE.search(self.stderr):
            self.trouble = signature(self.stderr, "text on stderr")


def signature(stderr: str, otherwise: str) -> str:
    """A short name of a crash: the place in our source, else the first trouble."""
    place = AT_LINE.search(stderr)
    if place:
        return f"{Path(place[2]).name}:{place[1]} {place[3]}"[:150]
    place = PLACE.search(stderr)
    if place:
        return f"{Path(place[1]).name} {place[2]}"[:150]
    place = TRACE.search(stderr)
    if place:
        return f"{otherwise} {Path(place[1]).name}"
    kind = re.search(r"AddressSanitizer:? (?:failed to )?([\w-]+)", stderr)
    for frame in FRAME.finditer(stderr):
        return f"{kind[1] if kind else otherwise} {Path(frame[2]).name} {frame[1]}"
    line = TROUBLE.search(stderr)
    return f"{otherwise} {stderr[line.start() :].splitlines()[0][:100]}" if line else otherwise


class Driver:
    """A process of tools/fuzz_driver.f90; started anew when it died."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program = program
        self.folder = folder
        self.stderr_path = folder / "stderr"
        self.process: subprocess.Popen | None = None
        self.buffer = b""
        self.n_answers = 0

    def start(self) -> None:
        """Starts the process."""
        self.stderr_path.write_bytes(b"")
        with self.stderr_path.open("ab") as stderr:
            self.process = subprocess.Popen(
                [self.program],
                cwd=self.folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=stderr,
                bufsize=0,
                start_new_session=True,  # no terminal: /dev/tty cannot be opened
                env={**os.environ, **ENVIRONMENT},
            )
        self.buffer = b""
        self.n_answers = 0

    def stop(self) -> None:
        """Ends the process."""
        if self.process:
            self.process.kill()
            self.process.wait()
            self.process.stdin.close()
            self.process.stdout.close()
            self.process = None

    def send(self, requests: list[str]) -> None:
        """Asks, without waiting for answers."""
        if not self.process or self.n_answers > 20000:
            self.stop()
            self.start()
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write("".join(line + "\n" for line in requests).encode())

    def line(self, patience: float) -> bytes | None:
        """The next answer of the driver; None at its end. TimeoutError when it takes too long."""
        until = time.monotonic() + patience
        while True:
            line, found, rest = self.buffer.partition(b"\n")
            if found:
                self.buffer = rest
                if line.startswith(b"= "):  # the rest is what the program tells its user
                    self.n_answers += 1
                    return line[2:]
                continue
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.process.stdout], [], [], left)[0]:
                raise TimeoutError
            data = os.read(self.process.stdout.fileno(), 65536)
            if not data:
                return None
            self.buffer += data

    def stderr(self) -> str:
        """What the process wrote to stderr so far, the end of it."""
        return self.stderr_path.read_bytes()[-20000:].decode(errors="replace")

    def answers(self, requests: list[str]) -> list[Answer]:
        """The answers to what was sent; a dead driver is started again for what is left."""
        found: list[Answer] = []
        while len(found) < len(requests):
            try:
                line = self.line(2 * LIMIT_SECONDS)
            except TimeoutError:
                self.stop()
                found.append(self.alone(requests[len(found)]))
                self.send(requests[len(found) :])
                continue
            if line is None:
                found.append(self.dead())
                self.send(requests[len(found) :])
            else:
                found.append(self.parsed(line))
        if self.stderr_path.stat().st_size > 0:
            text = self.stderr()
            if TROUBLE.search(text):
                found[-1].stderr = text
            os.truncate(self.stderr_path, 0)
        for answer in found:
            answer.judge()
        return found

    def parsed(self, line: bytes) -> Answer:
        """An answer of the driver."""
        code, length, unclean, microseconds, memory = map(int, line.split())
        return Answer(code, length, unclean == 1, microseconds * 1e-6, memory / 1024)

    def dead(self) -> Answer:
        """The answer of a driver that ended."""
        status = self.process.wait()
        stderr = self.stderr()
        self.stop()
        how = f"exit code {status}"
        if status < 0:
            how = signal.Signals(-status).name
        return Answer(None, trouble=signature(stderr, how), stderr=stderr)

    def alone(self, request: str) -> Answer:
        """The answer to what took too long, with patience: the machine may have been busy."""
        self.send([request])
        try:
            line = self.line(PATIENCE)
        except TimeoutError:
            self.process.send_signal(signal.SIGABRT)
            time.sleep(1.0)
            stderr = self.stderr()
            self.stop()
            return Answer(None, seconds=PATIENCE, trouble="hang", stderr=stderr)
        return self.dead() if line is None else self.parsed(line)
