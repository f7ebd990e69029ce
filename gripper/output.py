"""What a command leaves in its folder; of a run: result.json, curve.csv and snapshots.png."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gripper.result import Result

FILES = ("result.json", "curve.csv", "snapshots.png")
"""Of a run."""


class NotWrittenError(OSError):
    """Files cannot be written; those before the first of them are."""

    def __init__(self, error: OSError, written: Iterable[Path], missing: Iterable[Path]) -> None:
        there, not_there = (", ".join(path.name for path in paths) for paths in (written, missing))
        outcome = f"{there} written, {not_there} not" if there else f"{not_there} not written"
        super().__init__(error.errno, f"{error.strerror or error} ({outcome})")


@contextlib.contextmanager
def prepared(folder: Path, names: Iterable[str] = FILES) -> Iterator[None]:
    """Make the folder and see that files of these names can be written there, before anything is solved.

    What it made is removed again when the run inside does not come to its end.

    Raises
    ------
    OSError
        They cannot.
    """
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        for name in names:
            if (folder / name).is_dir():
                raise IsADirectoryError(f"a folder in the place of {name}")
        yield
    except BaseException:  # an interruption too
        for path in made:
            with contextlib.suppress(OSError):  # not made, or no longer empty
                path.rmdir()
        raise


def write(folder: Path, result: Result) -> tuple[Path, ...]:
    """Write the files of a run, numbers first; as :func:`write_files`."""
    parts = (lambda: as_json(result.to_dict()), lambda: result.curve_csv().encode(), lambda: _picture(result))
    return write_files(folder, dict(zip(FILES, parts, strict=True)))


def as_json(table: Mapping[str, Any]) -> bytes:
    """Plain data as the text of a JSON file; never NaN."""
    return (json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def write_files(folder: Path, contents: Mapping[str, bytes | Callable[[], bytes]]) -> tuple[Path, ...]:
    """Write files by their names, over those of an earlier run; each whole or not at all.

    All are complete under other names before the first takes its place. Where one cannot be written, or making its
    bytes fails or is interrupted, those before it are kept, and no later file of an earlier run stays beside them;
    where not even the first can be, the earlier run's files stay as they were.

    Parameters
    ----------
    folder
        Where.
    contents
        By name, the most needed first: bytes, or what makes them.

    Returns
    -------
    Their paths.

    Raises
    ------
    NotWrittenError
        Some cannot be written.
    """
    drafts = {folder / name: folder / f".{name}.{os.getpid()}" for name in contents}
    complete: list[Path] = []
    try:
        for (path, draft), content in zip(drafts.items(), contents.values(), strict=True):
            data = content if isinstance(content, bytes) else content()
            try:
                _write(draft, data)
            except OSError as error:
                raise NotWrittenError(error, complete, [path for path in drafts if path not in complete]) from error
            complete.append(path)
    finally:
        _place(drafts, complete)
    return tuple(drafts)


def _write(draft: Path, data: bytes) -> None:
    """Write bytes, and see them on the disk: some file systems say only then that there is no room."""
    with draft.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _place(drafts: Mapping[Path, Path], complete: Collection[Path]) -> None:
    """Give the complete drafts their names, over what an earlier run left; the others go."""
    try:
        for path in drafts.keys() if complete else ():
            if path in complete:
                drafts[path].replace(path)
            else:
                path.unlink(missing_ok=True)
    finally:
        for draft in drafts.values():
            draft.unlink(missing_ok=True)


def _picture(result: Result) -> bytes:
    """Draw the snapshots, as PNG; where no pose has an answer, a picture that says so."""
    from gripper.plot import Picture

    if any(pose.shape is not None for pose in result.poses):
        figure = result.plot()
    else:
        figure = Picture(figsize=(4, 1))
        figure.text(0.5, 0.5, "no pose has an answer", ha="center", va="center")
    data = io.BytesIO()
    figure.savefig(data, format="png")
    return data.getvalue()
