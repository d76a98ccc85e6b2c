"""Decks changed so that they are nearly right, or not at all."""

import re
from bisect import bisect
from itertools import accumulate
from random import Random

from fuzzing import words
from fuzzing.schema import Schema
from fuzzing.seeds import Seed

NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?(?![\w.])")
WORD = re.compile(rb"[A-Za-z][A-Za-z0-9_. -]*[A-Za-z0-9]|[A-Za-z]")
SPECIAL = (
    "/dev/zero", "/dev/null", "/dev/full", "/dev/tty", "/proc/self/mem", "/proc/self/cmdline", "/",
    ".", "..", "", "fifo", "folder", "loop.inc", "deep0.inc", "none.inc", "empty.inc", "nul.inc",
    "link.inc", "a" * 300, "x/" * 500, "fifo/x", "\t", '"', "socket",
)  # fmt: skip

Lines = list[bytes]


class DeckMutator:
    """Makes decks from seeds; the same random numbers give the same deck."""

    def __init__(self, seeds: list[Seed], schema: Schema) -> None:
        self.seeds = seeds
        self.schema = schema
        self.weights = list(accumulate(seed.share / seed.cost() ** 2 for seed in seeds))
        self.on_lines = (
            delete_line, repeat_line, swap_lines, move_card, delete_card, repeat_card,
            self.borrow_card, self.make_card, self.splice, self.rename_keyword, self.add_parameter,
            drop_part, repeat_part, swap_parts, self.include, continue_line, repeat_much,
            self.make_card, self.borrow_card,
        )  # fmt: skip
        self.in_line = (
            change_number, change_number, nudge_number, nudge_number, nudge_number, change_word,
            self.choose_word, borrow_word, borrow_word, insert_piece, lengthen, cut_line,
            comment_out,
        )  # fmt: skip
        self.on_bytes = (
            flip_byte, insert_bytes, truncate, line_ends, mark, delete_bytes, repeat_bytes,
        )  # fmt: skip

    def pick(self, random: Random) -> Seed:
        """A seed, cheap ones more often."""
        return self.seeds[bisect(self.weights, random.random() * self.weights[-1])]

    def make(self, random: Random) -> bytes:
        """A deck."""
        lines = list(self.pick(random).lines)
        n = random.choice((1, 1, 1, 1, 2, 2, 3, 5))
        for _ in range(n):
            if random.random() < 0.65 and lines:
                i = random.randrange(len(lines))
                change = random.choice(self.in_line)
                lines[i] = change(random, lines[i], random.choice(lines))
            else:
                random.choice(self.on_lines)(random, lines)
        text = b"\n".join(lines)
        while random.random() < 0.08:
            text = random.choice(self.on_bytes)(random, text)
        return text

    def borrow_card(self, random: Random, lines: Lines) -> None:
        """A card of another deck."""
        other = self.pick(random).lines
        if len(other) < 400:
            first, last = some_card(random, other)
            at = random.randint(0, len(lines))
            lines[at:at] = other[first:last]

    def make_card(self, random: Random, lines: Lines) -> None:
        """A card by the book."""
        heads = [i for i, line in enumerate(lines) if line.startswith(b"*")] or [0]
        at = random.choice(heads) if random.random() < 0.8 else random.randint(0, len(lines))
        lines[at:at] = self.schema.card(random)

    def splice(self, random: Random, lines: Lines) -> None:
        """The start of one deck and the end of another."""
        other = self.pick(random).lines
        lines[random.randint(0, len(lines)) :] = other[random.randint(0, len(other)) :][:400]

    def rename_keyword(self, random: Random, lines: Lines) -> None:
        """Another keyword for the same parameters and data."""
        i = some_head(random, lines)
        if i is not None:
            rest = lines[i].split(b",")[1:]
            lines[i] = b",".join([random.choice(self.schema.names).encode(), *rest])

    def add_parameter(self, random: Random, lines: Lines) -> None:
        """One parameter more."""
        i = some_head(random, lines)
        if i is not None:
            name = random.choice(self.schema.parameters)
            value = random.choice((words.number, words.word))(random)
            text = random.choice((f", {name}={value}", f", {name}", f", {name}=", f",{name}=,"))
            lines[i] += text.encode("utf-8", "surrogatepass")

    def choose_word(self, random: Random, line: bytes, _other: bytes) -> bytes:
        """A choice of any parameter in place of a word."""
        return replace(random, WORD, line, random.choice(self.schema.choices).encode())

    def include(self, random: Random, lines: Lines) -> None:
        """A file that is none."""
        keyword = random.choice(("*INCLUDE, INPUT", "*MESH, FILE"))
        path = random.choice(SPECIAL)
        quote = random.choice(('"', ""))
        at = random.randint(0, len(lines))
        lines.insert(at, f"{keyword}={quote}{path}{quote}".encode())


def replace(random: Random, pattern: re.Pattern, line: bytes, new: bytes) -> bytes:
    """Puts something in the place of one match."""
    found = list(pattern.finditer(line))
    if not found:
        return line
    match = random.choice(found)
    return line[: match.start()] + new + line[match.end() :]


def some_head(random: Random, lines: Lines) -> int | None:
    """A keyword line."""
    heads = [i for i, line in enumerate(lines) if line.startswith(b"*") and line[1:2] != b"*"]
    return random.choice(heads) if heads else None


def some_card(random: Random, lines: Lines) -> tuple[int, int]:
    """First line of a card and the line behind it."""
    first = some_head(random, lines)
    if first is None:
        return 0, 0
    last = first + 1
    while last < len(lines) and not lines[last].startswith(b"*"):
        last += 1
    return first, last


def delete_line(random: Random, lines: Lines) -> None:
    """One line less."""
    if lines:
        del lines[random.randrange(len(lines))]


def repeat_line(random: Random, lines: Lines) -> None:
    """One line twice."""
    if lines:
        lines.insert(random.randint(0, len(lines)), random.choice(lines))


def repeat_much(random: Random, lines: Lines) -> None:
    """One line many times."""
    if lines and random.random() < 0.1:
        at = random.randrange(len(lines))
        lines[at:at] = [lines[at]] * random.choice((10, 100, 1000))


def swap_lines(random: Random, lines: Lines) -> None:
    """Two lines change places."""
    if lines:
        i, j = random.randrange(len(lines)), random.randrange(len(lines))
        lines[i], lines[j] = lines[j], lines[i]


def move_card(random: Random, lines: Lines) -> None:
    """A card somewhere else."""
    first, last = some_card(random, lines)
    card = lines[first:last]
    del lines[first:last]
    at = random.randint(0, len(lines))
    lines[at:at] = card


def delete_card(random: Random, lines: Lines) -> None:
    """A card less."""
    first, last = some_card(random, lines)
    del lines[first:last]


def repeat_card(random: Random, lines: Lines) -> None:
    """A card twice."""
    first, last = some_card(random, lines)
    at = random.choice((first, last, len(lines)))
    lines[at:at] = lines[first:last]


def parts(random: Random, lines: Lines) -> tuple[int, Lines]:
    """A line and what its commas separate."""
    i = random.randrange(len(lines)) if lines else 0
    return i, lines[i].split(b",") if lines else []


def drop_part(random: Random, lines: Lines) -> None:
    """One part of a line less."""
    i, part = parts(random, lines)
    if part:
        del part[random.randrange(len(part))]
        lines[i] = b",".join(part)


def repeat_part(random: Random, lines: Lines) -> None:
    """One part of a line more often."""
    i, part = parts(random, lines)
    if part:
        at = random.randrange(len(part))
        part[at:at] = [part[at]] * random.choice((1, 1, 1, 2, 20, 300))
        lines[i] = b",".join(part)


def swap_parts(random: Random, lines: Lines) -> None:
    """The parts of a line in another order."""
    i, part = parts(random, lines)
    if part:
        random.shuffle(part)
        lines[i] = b",".join(part)


def continue_line(random: Random, lines: Lines) -> None:
    """A line that goes on in the next."""
    if lines:
        i = random.randrange(len(lines))
        if random.random() < 0.9:
            lines[i] += b","
        else:
            lines[i:i] = [lines[i] + b","] * random.choice((2, 50, 500))


def change_number(random: Random, line: bytes, _other: bytes) -> bytes:
    """An extreme number."""
    return replace(random, NUMBER, line, words.number(random).encode())


def nudge_number(random: Random, line: bytes, _other: bytes) -> bytes:
    """A number nearby."""
    found = list(NUMBER.finditer(line))
    if not found:
        return line
    match = random.choice(found)
    return (
        line[: match.start()] + words.near(random, match[0].decode()).encode() + line[match.end() :]
    )


def change_word(random: Random, line: bytes, _other: bytes) -> bytes:
    """Another word."""
    return replace(random, WORD, line, words.word(random).encode("utf-8", "surrogatepass"))


def borrow_word(random: Random, line: bytes, other: bytes) -> bytes:
    """A word or a number of another line of the deck."""
    pattern = random.choice((NUMBER, WORD))
    found = pattern.findall(other)
    return replace(random, pattern, line, random.choice(found)) if found else line


def insert_piece(random: Random, line: bytes, _other: bytes) -> bytes:
    """A piece of grammar where none belongs."""
    at = random.randint(0, len(line))
    piece = random.choice(words.PIECES).encode("utf-8", "surrogatepass")
    return line[:at] + piece + line[at:]


def lengthen(random: Random, line: bytes, _other: bytes) -> bytes:
    """A line near the limit of its length, or far beyond it."""
    n = random.choice((2047, 2048, 2049, 5000, 20000)) - len(line)
    at = random.choice((0, len(line)))
    return line[:at] + random.choice((b" ", b"x", b",", b"1", b"\xc3\xa9")) * max(n, 0) + line[at:]


def cut_line(random: Random, line: bytes, _other: bytes) -> bytes:
    """The start of a line, or its end."""
    at = random.randint(0, len(line))
    return random.choice((line[:at], line[at:]))


def comment_out(random: Random, line: bytes, _other: bytes) -> bytes:
    """A comment, or nearly one."""
    at = random.choice((0, random.randint(0, len(line))))
    return line[:at] + random.choice((b"**", b" ** ", b"*", b"#", b"!")) + line[at:]


def flip_byte(random: Random, text: bytes) -> bytes:
    """Single bits."""
    data = bytearray(text)
    for _ in range(random.choice((1, 1, 2, 8))):
        if data:
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    return bytes(data)


def insert_bytes(random: Random, text: bytes) -> bytes:
    """Bytes that are no text."""
    at = random.randint(0, len(text))
    return text[:at] + random.choice(words.BYTES) * random.choice((1, 1, 1, 3)) + text[at:]


def delete_bytes(random: Random, text: bytes) -> bytes:
    """A hole."""
    at = random.randint(0, len(text))
    return text[:at] + text[at + random.choice((1, 2, 10, 100)) :]


def repeat_bytes(random: Random, text: bytes) -> bytes:
    """A part twice."""
    at = random.randint(0, len(text))
    return text[:at] + text[max(0, at - random.choice((1, 3, 30, 300))) :]


def truncate(random: Random, text: bytes) -> bytes:
    """A file that was not written to its end."""
    return text[: random.randint(0, len(text))]


def line_ends(random: Random, text: bytes) -> bytes:
    """The line ends of other systems, or all of them at once."""
    ends = random.choice(
        ((b"\r\n",), (b"\r",), (b"\n", b"\r\n"), (b"\n", b"\r", b"\n\r", b"\r\r\n"))
    )
    return b"".join(line + random.choice(ends) for line in text.split(b"\n"))


def mark(random: Random, text: bytes) -> bytes:
    """A byte-order mark, or another encoding."""
    kind = random.randrange(5)
    if kind < 3:
        return (b"\xef\xbb\xbf", b"\xff\xfe", b"\xef\xbb\xbf\xef\xbb\xbf")[kind] + text
    return text.decode("utf-8", "replace").encode(("utf-16", "utf-32")[kind - 3])
