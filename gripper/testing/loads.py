"""What every load promises: stations on the finger, finite actions there, and a potential that these derive from."""

from __future__ import annotations

from functools import cache

import numpy as np

from gripper.arrays import Array
from gripper.fingers import Finger, Material, S
from gripper.loads import Load, PotentialLoad
from gripper.registry import load as plugin
from gripper.statics.compiled_loads import CompiledLoad, compiled
from gripper.testing.contract import (
    Property,
    fits,
    has_the_manners_of_data,
    require,
    run,
    survives_a_scene_file,
    symbols_of,
)

LENGTH = 0.1
"""Of the finger that a load is checked on, in m; a station beyond it makes that as long as it must be."""
STEP = 1e-6
AGREES = 1e-6
_POSES = 4


def check_load(instance: Load) -> None:
    """Check that a load keeps all that `gripper.loads.Load` promises.

    Parameters
    ----------
    instance
        Of the plugin's class; check several.

    Raises
    ------
    gripper.testing.ContractError
        A property fails: one sentence with the instance, the rule and what was got.
    """
    run(instance, LOAD_PROPERTIES)


@cache
def _finger(length: float) -> Finger:
    material = Material(youngs_modulus=2e9, poisson_ratio=0.35)
    made: Finger = plugin("gripper.fingers", "uniform")(length=length, thickness=0.004, width=0.01, material=material)
    return made


def _known(load: Load) -> tuple[CompiledLoad, str | None]:
    """The load compiled on a finger that is long enough, and the motion's parameter in it."""
    stations = load.stations(_finger(LENGTH))
    finger = _finger(max(LENGTH, *stations) if stations else LENGTH)
    symbols = symbols_of(load) - {S.name}
    require(len(symbols) <= 1, "hold at most one symbol, the motion's parameter", sorted(symbols))
    parameter = next(iter(symbols), None)
    return compiled(load, finger, parameter), parameter


def has_stations_on_its_finger(load: Load) -> None:
    """Arc lengths above 0, or None for the whole axis; the same every time."""
    finger = _finger(LENGTH)
    stations = load.stations(finger)
    require(stations is None or len(stations) > 0, "act at one station at least, or along the axis (None)", stations)
    right = stations is None or all(np.isfinite(s) and s > 0 for s in stations)
    require(right, "act at stations above 0, in m", stations)
    require(load.stations(finger) == stations, "name the same stations every time", load.stations(finger))
    require(load.frame in ("finger", "world"), "write its actions in the axes of finger or world", load.frame)


def has_finite_actions(load: Load) -> None:
    """One action a station, of the sections and the motion's parameter alone, finite with its derivatives."""
    known, _ = _known(load)
    for places in _poses(known):
        actions, slopes, rates, _ = known.values(*places)
        finite = all(np.isfinite(values).all() for values in (actions, slopes, rates))
        require(finite, "have finite actions with finite derivatives on a bent finger", actions.tolist())


def has_actions_that_its_potential_gives(load: Load) -> None:
    """They are minus the potential's gradient, where it has one."""
    if not isinstance(load, PotentialLoad):
        return
    known, _ = _known(load)
    for s, x, y, angle, q in _poses(known):
        actions = known.values(s, x, y, angle, q)[0]
        for i in range(3):
            for j in range(s.size):
                change = np.zeros(s.size)
                change[j] = STEP
                energies = [
                    np.sum(known.values(s, x + way[0], y + way[1], angle + way[2], q)[3])
                    for way in (np.eye(3)[i][:, None] * change, -np.eye(3)[i][:, None] * change)
                ]
                slope = float(energies[0] - energies[1]) / (2 * STEP)
                off = abs(slope + actions[j, i])
                rule = "act by minus the gradient of its potential"
                require(off <= AGREES * (1 + np.abs(actions).max()), rule, f"{actions[j, i]}, not {-slope}")


def _poses(known: CompiledLoad) -> list[tuple[Array, Array, Array, Array, float]]:
    """Sections of fingers bent more and more, and a value of the motion's parameter: s, x, y, angle, q."""
    marks = np.linspace(0.1, 1.0, 7) if known.stations is None else known.stations
    s = marks * known.length
    out = []
    for n in range(_POSES):
        angle = 0.1 + 0.5 * n * marks
        x, y = s * np.cos(angle / 2), s * np.sin(angle / 2)
        out.append((s, x, y, angle, 0.3 + n))
    return out


LOAD_PROPERTIES: tuple[Property[Load], ...] = (
    fits("gripper.loads"),
    has_the_manners_of_data,
    has_stations_on_its_finger,
    has_finite_actions,
    has_actions_that_its_potential_gives,
    survives_a_scene_file("gripper.loads"),
)
"""What `check_load` checks, in its order."""
