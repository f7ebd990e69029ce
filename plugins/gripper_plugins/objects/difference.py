"""An object with others cut out of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gripper.objects import Combined


@dataclass(frozen=True, kw_only=True)
class Difference(Combined):
    """The first object without the others, a notched block: g is the largest of its own and of theirs turned over.

    Parameters
    ----------
    parts
        The object, then what is cut out of it, as they are or placed by numbers.
    """

    largest: ClassVar[bool] = True

    @property
    def signs(self) -> tuple[float, ...]:
        """All parts but the first are cut out."""
        return (1.0, *(-1.0 for _ in self.parts[1:]))
