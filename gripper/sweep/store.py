"""The folder of a sweep: what is swept, and a table that grows row by row and survives being cut off."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TextIO

from gripper.scene import Scene
from gripper.sweep.about import about, difference
from gripper.sweep.plan import Plan
from gripper.sweep.rows import Row, header, read, written

TABLE, PLAN = "sweep.csv", "sweep.json"


class Store:
    """The table on disk.

    Parameters
    ----------
    folder
        Made where it is not there.
    scene, plan
        What is swept.

    Raises
    ------
    ValueError
        The folder holds another sweep.
    OSError
        It cannot be written.
    """

    def __init__(self, folder: Path, scene: Scene, plan: Plan) -> None:
        self.folder, self.plan = folder, plan
        folder.mkdir(parents=True, exist_ok=True)
        self._claim(about(scene, plan))
        parameter = scene.motion.parameter if scene.motion else None
        self.rows = {row.variant: row for row in self._kept(parameter)}
        self._replace(TABLE, self._table(self.rows.values()))
        self._file: TextIO = (folder / TABLE).open("a", encoding="utf-8", newline="")

    def add(self, row: Row) -> None:
        """Append a row, at once."""
        if row.variant not in self.rows:
            self.rows[row.variant] = row
            self._file.write(written(row))
            self._file.flush()

    def close(self) -> None:
        """Put the rows in the plan's order."""
        self._file.close()
        self._replace(TABLE, self._table(self.rows[i] for i in sorted(self.rows)))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _claim(self, swept: Mapping[str, Any]) -> None:
        """Write what is swept, having seen that the folder's sweep, if there is one, is of the same rows."""
        path = self.folder / PLAN
        if path.exists():
            other = difference(path.read_text(encoding="utf-8"), swept)
            if other:
                rule = "folder must be new, or hold this very sweep, to go on with it"
                raise ValueError(f"{rule}; got {self.folder}, where {other}")
        self._replace(PLAN, json.dumps(swept, indent=1, ensure_ascii=False) + "\n")

    def _kept(self, parameter: str | None) -> Iterable[Row]:
        path = self.folder / TABLE
        if not path.exists():
            return []
        with path.open(encoding="utf-8", errors="replace", newline="") as file:
            rows = list(read(file, self.plan.keys, parameter))
        variants = dict(enumerate(self.plan.variants()))
        return [row for row in rows if variants.get(row.variant) == row.values]

    def _table(self, rows: Iterable[Row]) -> str:
        return header(self.plan.keys) + "".join(written(row) for row in rows)

    def _replace(self, name: str, text: str) -> None:
        draft = self.folder / f".{name}.{os.getpid()}"
        try:
            draft.write_text(text, encoding="utf-8", newline="")
            draft.replace(self.folder / name)
        finally:
            draft.unlink(missing_ok=True)
