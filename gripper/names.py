"""What to say about a name that nobody knows."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

LONGEST = 60
"""Characters of a user's text that a message repeats."""


def known_names(name: str, known: Iterable[str]) -> str:
    """List the known names, with the nearest one where one is near: ``a, b, c (did you mean 'b'?)``."""
    known = list(known)
    near = difflib.get_close_matches(name[:LONGEST], known, n=1)
    return (", ".join(known) or "none") + (f" (did you mean {near[0]!r}?)" if near else "")


def shortened(text: str) -> str:
    """Cut a text to the length that a message can hold."""
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
