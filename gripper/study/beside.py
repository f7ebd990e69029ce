"""The force along a motion by several models, with finite elements beside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from matplotlib.figure import Figure

from gripper.plot import compare
from gripper.result import Result
from gripper.scene import Scene
from gripper.trace import trace
from gripper.verify import Verification, verify


class Beside(NamedTuple):
    """A figure and its numbers: results by the name of their model, and the finite elements."""

    figure: Figure
    results: dict[str, Result]
    elements: Verification


def beside_elements(scenes: Mapping[str, Scene], places: Iterable[float], mesh: tuple[int, int] = (108, 4)) -> Beside:
    """Solve several models, the first of them with finite elements too, and draw the forces over each other.

    Forces of the finger on the object, in the finger's frame. The ground is grey where the first model sticks.

    Parameters
    ----------
    scenes
        Motions of one parameter, by the name of their model.
    places
        Values of the parameter for the elements, as :func:`gripper.verify.verify` takes them.
    mesh
        Number of elements along and across.

    Raises
    ------
    ValueError
        No scene, one without motion, or what the elements cannot solve.
    """
    if not scenes:
        raise ValueError("scenes must hold at least one scene; got none")
    results = {name: trace(scene) for name, scene in scenes.items()}
    elements = verify(next(iter(scenes.values())), list(places), elements=mesh, laws=False)
    found = [(p.parameter, p.elements.force) for p in elements.poses if p.parameter is not None and p.elements.force]
    figure = compare(results, "force_on_object_finger_frame", points={"finite elements": found})
    return Beside(figure, results, elements)
