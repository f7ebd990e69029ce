"""Running a sweep on an executor, its rows kept as they come."""

from __future__ import annotations

import dataclasses
import itertools
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from gripper.parameters import kind
from gripper.results.summary import Summary
from gripper.scene import Scene
from gripper.sweep.plan import Plan
from gripper.sweep.pool import processes
from gripper.sweep.rows import Row
from gripper.sweep.store import Store
from gripper.sweep.variant import solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Progress = Callable[[int, int], None]
_AHEAD = 256  # variants that are handed out at a time, to an executor of any size
_EACH = 4  # the same, to each process of our own: waiting for many costs more than for few
_LIVES = 3  # of a variant whose process ends


@dataclasses.dataclass(frozen=True)
class Sweep:
    """A table of variants.

    Parameters
    ----------
    plan
        What varies.
    rows
        In the plan's order, failed ones with their reasons.
    """

    plan: Plan
    rows: tuple[Row, ...]

    @property
    def failed(self) -> tuple[Row, ...]:
        """The variants without numbers."""
        return tuple(row for row in self.rows if row.summary is None)

    def numbers(self, quantity: str) -> list[float | None]:
        """One of the summary's numbers, row by row."""
        return [getattr(row.summary, quantity) if row.summary else None for row in self.rows]

    def plot(self, quantity: str) -> Figure:
        """Draw one of the summary's numbers over one or two keys.

        Raises
        ------
        ValueError
            The sweep has more keys.
        """
        from gripper.sweep.plot import drawn  # here, so that a sweep does not load matplotlib

        return drawn(self, quantity)


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[float]] | Plan,
    folder: str | os.PathLike[str] | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Follow a scene with every combination of other numbers.

    Parameters
    ----------
    scene
        With a motion, or of one pose.
    over
        Values by key (:func:`gripper.parameters.numbers` lists a scene's), in SI units.
    folder
        Keeps the table, row by row; a sweep that was cut off goes on where it was. None keeps nothing.
    executor
        Any ``concurrent.futures.Executor``, such as a cluster's (dask: ``client.get_executor()``); it is left open.
        By default a process for each processor. Where processes are spawned, a script must guard its own lines by
        ``if __name__ == "__main__"``.
    progress
        Called with how many variants are done, and how many there are.

    Returns
    -------
    Every variant, failed ones with their reasons.

    Raises
    ------
    LookupError
        The scene has no number of a key; lists the known ones.
    ValueError
        Values without meaning, or a folder that holds another sweep.
    BrokenExecutor
        The executor given has broken down; the rows done are kept.
    """
    plan = over if isinstance(over, Plan) else Plan(over)
    plan = plan.shown_for(lambda key: kind(scene, key))
    with ExitStack() as stack:
        store = stack.enter_context(Store(Path(folder), scene, plan)) if folder is not None else None
        rows = dict(store.rows) if store else {}
        for row in _computed(scene, plan, rows, executor):
            rows[row.variant] = row
            if store:
                store.add(row)
            if progress:
                progress(len(rows), plan.size)
    return Sweep(plan, tuple(rows[i] for i in range(plan.size)))


def _computed(scene: Scene, plan: Plan, known: Mapping[int, Row], executor: Executor | None) -> Iterator[Row]:
    """The rows that are not known, as they come."""
    missing = {i: values for i, values in enumerate(plan.variants()) if i not in known}
    if executor is not None:
        yield from _through(executor, scene, plan, missing)
        return
    yield from _on_processes(scene, plan, missing)


def _on_processes(scene: Scene, plan: Plan, missing: dict[int, tuple[float, ...]]) -> Iterator[Row]:
    """Rows through processes of our own: where one ends, those that may have ended it are taken one by one."""
    workers = os.cpu_count() or 1
    lives = dict.fromkeys(missing, _LIVES)
    suspects = 0
    while missing:
        batch = dict(itertools.islice(missing.items(), suspects or None))
        with processes(1 if suspects else workers) as pool:
            try:
                for row in _through(pool, scene, plan, batch, 1 if suspects else _EACH * workers):
                    del missing[row.variant]
                    yield row
                suspects = 0
            except BrokenExecutor as error:
                first = next(iter(missing))
                lives[first] -= suspects > 0
                suspects = 2 * workers + 1  # as many as may have been in the processes' hands
                if not lives[first]:
                    yield Row(first, missing.pop(first), reason=f"its process ended, {_LIVES} times: {error}")


def _through(
    executor: Executor, scene: Scene, plan: Plan, missing: Mapping[int, tuple[float, ...]], ahead: int = _AHEAD
) -> Iterator[Row]:
    """Rows through an executor, some ahead of what is done."""
    waiting = iter(tuple(missing.items()))
    running: dict[Future[Summary | str], tuple[int, tuple[float, ...]]] = {}
    try:
        while True:
            while len(running) < ahead and (item := next(waiting, None)) is not None:
                running[executor.submit(solved, scene, dict(zip(plan.keys, item[1], strict=True)))] = item
            if not running:
                return
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                variant, values = running.pop(future)
                found = future.result()
                yield Row(variant, values, reason=found) if isinstance(found, str) else Row(variant, values, found)
    finally:
        for future in running:
            future.cancel()
