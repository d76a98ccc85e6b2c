"""What a command says when it cannot do its work."""


class PostError(Exception):
    """An error of the user: one line that says what is wrong and what was expected."""


def one_of(names: list[str] | tuple[str, ...], most: int = 40) -> str:
    """The names that there are, for the end of a message."""
    shown = list(names[:most])
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(shown) + rest if shown else "none"
