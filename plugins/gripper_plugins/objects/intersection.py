"""What lies in all of several objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gripper.objects import Combined


@dataclass(frozen=True, kw_only=True)
class Intersection(Combined):
    """What several objects have in common: g is the largest of theirs.

    Parameters
    ----------
    parts
        Objects, as they are or placed by numbers.
    """

    largest: ClassVar[bool] = True
