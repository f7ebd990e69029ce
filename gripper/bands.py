"""Tolerance bands: within what a summary's numbers lie when the scene's numbers lie within theirs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np

from gripper.parameters import number
from gripper.results.record import Record
from gripper.results.summary import QUANTITIES, Summary
from gripper.scene import Scene
from gripper.sweep.pool import processes
from gripper.sweep.variant import solved
from gripper.tolerances import Tolerances

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gripper.result import Result

_LIKELY = (2.5, 97.5)  # percentiles of samples
_CHUNK = 4


@dataclasses.dataclass(frozen=True, kw_only=True)
class Band(Record):
    """Within what one of the summary's numbers lies, to first order.

    Parameters
    ----------
    quantity, value
        Its name, and what it is without tolerances.
    keys, changes
        The numbers with tolerances, and by how much each alone, at the upper end of its band, changes the value.
    """

    quantity: str
    value: float
    keys: tuple[str, ...]
    changes: tuple[float, ...]

    @property
    def worst(self) -> float:
        """Half width of the band when all numbers are at the worst ends of theirs."""
        return sum(abs(change) for change in self.changes)

    @property
    def likely(self) -> float:
        """The root of the sum of squares: half width when the numbers are independent."""
        return math.hypot(*self.changes)

    def plot(self) -> Figure:
        """Draw a tornado: what each number changes, the largest on top."""
        from gripper.tornado import drawn  # here, so that `import gripper` does not load matplotlib

        return drawn(self)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sampled(Record):
    """Where one of the summary's numbers came to lie when the scene's numbers were drawn from their bands.

    Parameters
    ----------
    quantity
        Its name.
    samples
        How many variants have it.
    least, largest
        Of all of them.
    low, high
        Between which 95 % of them lie.
    """

    quantity: str
    samples: int
    least: float
    low: float
    high: float
    largest: float


def linear_bands(result: Result) -> tuple[Band, ...]:
    """Bands of all the summary's numbers that have derivatives, from exact sensitivities.

    Parameters
    ----------
    result
        From :func:`gripper.solve` or :func:`gripper.trace` in this process, of a scene with tolerances.

    Raises
    ------
    ValueError
        A scene without tolerances, or one that cannot be differentiated.
    """
    bands = _bands(result.scene)
    keys = tuple(bands)
    rates = result.sensitivities(keys)
    summary, found = result.summary(), []
    for quantity in QUANTITIES:
        value, slopes = getattr(summary, quantity), [rates[key].summary.get(quantity) for key in keys]
        if value is None or any(slope is None for slope in slopes):
            continue
        changes = tuple(float(slope or 0.0) * bands[key] for slope, key in zip(slopes, keys, strict=True))
        if any(changes):
            found.append(Band(quantity=quantity, value=value, keys=keys, changes=changes))
    return tuple(found)


def samples(scene: Scene, count: int, seed: int = 0) -> list[dict[str, float]]:
    """Draw numbers evenly from their bands: Sobol's points, scrambled.

    Parameters
    ----------
    scene
        With tolerances.
    count
        How many, a power of 2 (else their balance is lost).
    seed
        Of the scrambling.

    Raises
    ------
    ValueError
        No power of 2, or a scene without tolerances.
    """
    from scipy.stats import qmc

    if count < 2 or count & (count - 1):
        raise ValueError(f"count must be a power of 2, at least 2; got {count}")
    bands = _bands(scene)
    middle, half = np.array([number(scene, key) for key in bands]), np.array(list(bands.values()))
    points = qmc.Sobol(len(bands), rng=seed).random(count)
    return [dict(zip(bands, row, strict=True)) for row in (middle + half * (2 * points - 1)).tolist()]


def sampled_bands(
    scene: Scene, count: int = 256, *, seed: int = 0, executor: Executor | None = None
) -> tuple[tuple[Sampled, ...], tuple[str, ...]]:
    """Follow a scene with numbers drawn from their bands.

    Parameters
    ----------
    scene, count, seed
        As :func:`samples` takes them.
    executor
        As :func:`gripper.sweep` takes it.

    Returns
    -------
    Where each number came to lie; and the reasons of the variants without an answer.
    """
    drawn = samples(scene, count, seed)
    if executor is None:
        with processes() as pool:
            found = list(pool.map(solved, [scene] * count, drawn, chunksize=_CHUNK))
    else:
        found = list(executor.map(solved, [scene] * count, drawn))
    known = [summary for summary in found if isinstance(summary, Summary)]
    return _spreads(known), tuple(reason for reason in found if isinstance(reason, str))


def _spreads(known: Sequence[Summary]) -> tuple[Sampled, ...]:
    spreads = []
    for quantity in QUANTITIES:
        values = [value for summary in known if (value := getattr(summary, quantity)) is not None]
        if values and min(values) < max(values):
            low, high = np.percentile(values, _LIKELY).tolist()
            ends = {"least": min(values), "largest": max(values)}
            spreads.append(Sampled(quantity=quantity, samples=len(values), low=low, high=high, **ends))
    return tuple(spreads)


def _bands(scene: Scene) -> dict[str, float]:
    if scene.tolerances is None or not scene.tolerances.bands:
        raise ValueError(
            f"tolerances must be given, as {Tolerances.__name__}, or [tolerance] in a scene file; got none"
        )
    return dict(scene.tolerances.bands)
