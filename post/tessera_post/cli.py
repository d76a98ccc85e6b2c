"""The command line: one sub-command per picture or conversion."""

import argparse
import importlib
import io
import os
import sys
from pathlib import Path
from typing import Protocol, cast

from tessera_post import __version__
from tessera_post.errors import PostError

COMMANDS = {
    "curve": "draw history columns against time or against each other",
    "picture": "draw points, elements or mesh coloured by a field",
    "scatter": "draw a field of all points against time or increment",
    "deformed": "draw the body at several increments, side by side",
    "animate": "make an MP4 or GIF over the outputs",
    "report": "make one self-contained HTML page of a run",
    "compare": "tell the differences between two runs",
    "export": "convert to VTK XML or CSV, or give the deck back",
    "paper": "run the examples and draw the figures of the documentation",
}
USAGE_ERROR = 2


class Command(Protocol):
    """What the module of a command offers."""

    EXAMPLE: str

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declares the options."""

    def run(self, options: argparse.Namespace) -> int:
        """Does the work; the exit code."""


def command_of(name: str) -> Command:
    """The module of a command, imported when it is needed."""
    return cast(Command, importlib.import_module(f"tessera_post.{name}"))


def list_of_commands() -> str:
    """The commands for --help."""
    lines = [f"  {name:<10} {text}" for name, text in COMMANDS.items()]
    return "commands:\n" + "\n".join(lines)


def make_parser() -> argparse.ArgumentParser:
    """The parser of everything before the options of a command."""
    parser = argparse.ArgumentParser(
        prog="tessera-post",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Pictures, reports and conversions of Tessera's results.",
        epilog=f"{list_of_commands()}\n\ntessera-post COMMAND --help tells the options of one.",
        usage="tessera-post [-h] [--version] COMMAND ...",
    )
    parser.add_argument("--version", action="version", version=f"tessera-post {__version__}")
    parser.add_argument("command", metavar="COMMAND", choices=COMMANDS, help=argparse.SUPPRESS)
    parser.add_argument("rest", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    return parser


def run_command(name: str, arguments: list[str]) -> int:
    """Parses the options of a command and runs it."""
    command = command_of(name)
    parser = argparse.ArgumentParser(
        prog=f"tessera-post {name}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=COMMANDS[name][0].upper() + COMMANDS[name][1:] + ".",
        epilog=f"example:\n{command.EXAMPLE}",
        allow_abbrev=False,
    )
    command.add_arguments(parser)
    return command.run(parser.parse_args(arguments))


def main(arguments: list[str] | None = None) -> int:
    """The program; exit code 0, 1 for runs that differ (compare), 2 for an error."""
    for stream in (sys.stdout, sys.stderr):  # a terminal may not know a superscript
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    options = make_parser().parse_args(arguments)
    try:
        return run_command(options.command, options.rest)
    except PostError as problem:
        return fail(str(problem))
    except BrokenPipeError:  # the reader of our output has gone: `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as problem:
        path = f"'{problem.filename}': " if problem.filename else ""
        return fail(f"{path}{problem.strerror or problem}")
    except KeyboardInterrupt:
        return fail("interrupted", code=130)


def fail(message: str, code: int = USAGE_ERROR) -> int:
    """One line on stderr."""
    print(f"tessera-post: error: {message}", file=sys.stderr)
    return code


def tell(notes: list[str]) -> None:
    """Notes on stderr: what is shown is less than was asked for."""
    for note in notes:
        print(f"tessera-post: note: {note}", file=sys.stderr)


def wrote(path: Path) -> None:
    """Says what was written, on stdout."""
    print(f"wrote {path}")
