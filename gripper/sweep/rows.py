"""Rows of a sweep's table: written one by one, each with a check sum, so that a torn one is known."""

from __future__ import annotations

import csv
import dataclasses
import io
import zlib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from gripper.results.summary import Summary

NUMBERS = tuple(field.name for field in dataclasses.fields(Summary) if field.name != "parameter")
_COUNTS = ("poses", "failed", "locked")


@dataclasses.dataclass(frozen=True)
class Row:
    """One variant.

    Parameters
    ----------
    variant
        Its number, from 0.
    values
        Of the plan's keys, in SI units.
    summary
        Its numbers; None where it failed.
    reason
        Why it failed.
    """

    variant: int
    values: tuple[float, ...]
    summary: Summary | None = None
    reason: str | None = None


def header(keys: Sequence[str]) -> str:
    """Write the table's first line."""
    return _line(["variant", *keys, "reason", *NUMBERS, "check"])


def written(row: Row) -> str:
    """Write a row; its last cell is the check sum of the others."""
    numbers = [getattr(row.summary, name) if row.summary else None for name in NUMBERS]
    cells = [row.variant, *row.values, row.reason, *numbers]
    return _line([*cells, _checksum(_line(cells))])


def read(lines: Iterable[str], keys: Sequence[str], parameter: str | None) -> Iterator[Row]:
    """Read the rows that are whole; what is torn or damaged is left out, to be reckoned again."""
    for line in lines:
        cells = next(csv.reader([line]), []) if line.endswith("\n") else []
        if len(cells) == len(keys) + len(NUMBERS) + 3 and _checksum(_line(cells[:-1])) == cells[-1]:
            yield _row(cells[:-1], len(keys), parameter)


def _row(cells: list[str], keys: int, parameter: str | None) -> Row:
    values = tuple(float(cell) for cell in cells[1 : keys + 1])
    reason, numbers = cells[keys + 1], cells[keys + 2 :]
    if reason:
        return Row(int(cells[0]), values, reason=reason)
    given: dict[str, Any] = {
        name: None if cell == "" else int(cell) if name in _COUNTS else float(cell)
        for name, cell in zip(NUMBERS, numbers, strict=True)
    }
    return Row(int(cells[0]), values, Summary(parameter=parameter, **given))


def _line(cells: Sequence[Any]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(["" if cell is None else _flat(cell) for cell in cells])
    return text.getvalue()


def _flat(cell: Any) -> str:
    return " ".join(cell.split()) if isinstance(cell, str) else repr(cell)


def _checksum(line: str) -> str:
    return f"{zlib.crc32(line.encode()):08x}"
