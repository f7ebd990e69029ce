"""How far the numbers of a scene may be off: plain data."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

from gripper.fields import Positive, check_fields


@dataclasses.dataclass(frozen=True)
class Tolerances:
    """Half widths of the bands in which numbers of a scene lie.

    Parameters
    ----------
    bands
        By key, in SI units: ``{"finger.length": 1e-4}`` is a length within 0.1 mm of its own; the keys are those of
        :func:`gripper.parameters.numbers`.
    """

    bands: tuple[tuple[str, Positive], ...]

    def __init__(self, bands: Mapping[str, float] | tuple[tuple[str, float], ...]) -> None:
        object.__setattr__(self, "bands", tuple(bands.items()) if isinstance(bands, Mapping) else tuple(bands))
        check_fields(self)
