"""What a command leaves in its folder; of a run: result.json, curve.csv and snapshots.png."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gripper.result import Result

FILES = ("result.json", "curve.csv", "snapshots.png")
"""Of a run."""


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
    """Write the files of a run; as :func:`write_files`."""
    table = as_json(result.to_dict())
    return write_files(folder, dict(zip(FILES, (table, result.curve_csv().encode(), _picture(result)), strict=True)))


def as_json(table: Mapping[str, Any]) -> bytes:
    """Plain data as the text of a JSON file; never NaN."""
    return (json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def write_files(folder: Path, contents: Mapping[str, bytes]) -> tuple[Path, ...]:
    """Write files by their names, over those of an earlier run.

    All are complete under other names before the first takes its place: a full disk leaves the earlier ones.

    Returns
    -------
    Their paths.

    Raises
    ------
    OSError
        They cannot be written.
    """
    paths = tuple(folder / name for name in contents)
    drafts = [folder / f".{name}.{os.getpid()}" for name in contents]
    try:
        for draft, content in zip(drafts, contents.values(), strict=True):
            draft.write_bytes(content)
        for draft, path in zip(drafts, paths, strict=True):
            draft.replace(path)
    finally:
        for draft in drafts:
            draft.unlink(missing_ok=True)
    return paths


def _picture(result: Result) -> bytes:
    """Draw the snapshots, as PNG; where no pose has an answer, a picture that says so."""
    from matplotlib.figure import Figure

    if len(result.failed) < len(result.poses):
        figure = result.plot()
    else:
        figure = Figure(figsize=(4, 1))
        figure.text(0.5, 0.5, "no pose has an answer", ha="center", va="center")
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=150)
    return data.getvalue()
