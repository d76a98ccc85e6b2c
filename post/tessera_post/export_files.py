"""Files that appear all at once when they are complete, or not at all."""

from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from tessera_post.errors import PostError


class Batch:
    """Writes to temporary names beside the files; renames them at the end of the `with` block.

    An error in the block leaves earlier files as they were, and nothing of the new ones.
    """

    def __init__(self) -> None:
        self._temporary: dict[Path, Path] = {}
        self._folders: list[Path] = []

    def make_folder(self, folder: Path) -> None:
        """A folder for the files; removed again when there will be none."""
        missing = [path for path in (folder, *folder.parents) if not path.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        self._folders += missing

    def open_name(self, path: Path) -> Path:
        """Where to write what will be the file `path`."""
        if not path.parent.is_dir():
            raise PostError(f"cannot write '{path}': there is no folder '{path.parent}'")
        temporary = path.with_name(f".{path.name}.part")
        self._temporary[path] = temporary
        return temporary

    def __enter__(self) -> "Batch":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            for path, temporary in self._temporary.items():
                temporary.replace(path)
            return
        for temporary in self._temporary.values():
            temporary.unlink(missing_ok=True)
        for folder in self._folders:
            folder.rmdir()
        if isinstance(problem, OSError):
            asked = [*self._folders, *self._temporary]
            path = asked[-1] if asked else problem.filename
            raise PostError(f"cannot write '{path}': {problem.strerror}") from problem


def refuse_existing(paths: Iterable[Path], force: bool) -> None:
    """Raises PostError when a file is there already, unless it may be overwritten."""
    for path in paths:
        if path.is_dir():
            raise PostError(f"'{path}' is a folder: expected the name of a file")
        if path.exists() and not force:
            raise PostError(f"'{path}' exists already: it is only overwritten with --force")
