"""The polynomial through samples: it is highest where calculus says, and what lies between samples is not forgotten."""

from __future__ import annotations

import numpy as np
import pytest

from gripper.motion.through import Through


@pytest.mark.parametrize("top", [0.1, 0.37, 0.9])
def test_a_polynomial_is_highest_where_its_slope_vanishes(top: float) -> None:
    def value(t: float) -> float:
        return 2.0 - (t - top) ** 2 - (t - top) ** 4

    through = Through((t, value(t)) for t in (-1.0, -0.4, 0.0, 1.0, 1.7, 2.2))
    assert through.highest() == pytest.approx((top, 2.0), abs=1e-9)


def test_added_samples_bring_it_to_the_top_of_any_smooth_number() -> None:
    through = Through((t, np.cos(3 * t - 1)) for t in (-1.0, 0.0, 1.0, 2.0))
    while not through.knows(place := through.highest()[0]):
        through.add(place, float(np.cos(3 * place - 1)))
    place, height = through.highest()
    assert place == pytest.approx(1 / 3, abs=2e-5)
    assert height == pytest.approx(1.0, abs=1e-9)


def test_where_samples_fall_it_is_highest_at_its_end() -> None:
    assert Through((t, np.exp(-t)) for t in (-2.0, -1.0, 0.0, 1.0, 2.0)).highest() == (0.0, 1.0)
