"""What lies in any of several objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gripper.objects import Combined


@dataclass(frozen=True, kw_only=True)
class Union(Combined):
    """Several objects as one: g is the least of theirs.

    Parameters
    ----------
    parts
        Objects, as they are or placed by numbers.
    """

    largest: ClassVar[bool] = False
