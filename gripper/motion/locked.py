"""What is said where friction holds the finger."""

from __future__ import annotations


class LockedError(Exception):
    """The motion cannot go on: friction holds the finger for any force.

    Parameters
    ----------
    limit
        The coefficient of friction from which on it does.
    mu
        The coefficient that it has.
    """

    def __init__(self, limit: float, mu: float) -> None:
        self.limit, self.mu = limit, mu
        holds = "holds the finger for any force" if limit <= mu else "all but holds the finger"
        super().__init__(f"friction {holds}: its coefficient is {mu:.4g}, the limiting one {limit:.4g}")
