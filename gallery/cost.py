"""What the poses of Example II cost, beside the paper's own scheme on the same poses, measured in one run.

CPU time on one thread, median and least of the repeats after a warm-up; with gripper, checks, certificate and error
estimate included. The paper's scheme (raw node angles, contact at M = N = 90 nodes, SLSQP, every pose from an arc that
clears the object) has exact gradients and its shear cured: without them it takes 10 times as long, or fails.
"""

from __future__ import annotations

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import csv
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import dist, hypot
from pathlib import Path
from statistics import median
from typing import NamedTuple

import gripper as gr
from gripper import scenefile
from gripper.study.cost import repeated, single_pose
from gripper.study.published import solve_as_published

SCENE = Path(__file__).with_name("rotating_finger.toml")
FORCES = {  # on the object, in N, finger frame: shooting at tolerance 1e-12, as in tests/reference/beam.json
    "shear": {0.0508: (0.5714555472, -3.512588619), -0.0254: (8.73613172, -13.18698009)},
    "bending": {0.0508: (0.6151679239, -3.692652411), -0.0254: (9.459432209, -13.85118976)},
}


class Cost(NamedTuple):
    """One row; the force's relative error is the larger of the two reference poses' where it stands for several."""

    theory: str
    what: str
    cpu_ms_median: float
    cpu_ms_min: float
    paper_over_this: float
    force_error: float


def error(force: tuple[float, float], reference: tuple[float, float]) -> float:
    """Relative error of a force."""
    return dist(force, reference) / hypot(*reference)


def pair(theory: str, what: str, seconds: tuple[Sequence[float], ...], errors: tuple[float, ...]) -> Iterator[Cost]:
    """Give the rows of gripper and of the paper's scheme."""
    for name, cpu, off in zip(("gripper", "the paper's scheme"), seconds, errors, strict=True):
        ratio = median(seconds[1]) / median(cpu)
        yield Cost(theory, f"{what}, {name}", 1e3 * median(cpu), 1e3 * min(cpu), ratio, off)


def costs(scene: gr.Scene, theory: str, repeats: int = 7) -> Iterator[Cost]:
    """Measure the two reference poses alone, and then the scene's whole motion, which passes through them."""
    scene = replace(scene, theory=theory)
    published = partial(solve_as_published, scene, N=90, shear="none" if theory == "bending" else "element")
    for x_e, reference in FORCES[theory].items():
        ours = repeated(partial(gr.solve, single_pose(scene, x_e)), repeats)
        paper = repeated(partial(published, x_e), repeats)
        forces = ours.answers[0].poses[0].force_on_object_finger_frame, paper.answers[0].force_on_object
        errors = tuple(error(force, reference) for force in forces)
        yield from pair(theory, f"cold pose x_e = {x_e}", (ours.seconds, paper.seconds), errors)

    values = scene.motion.values
    ours = repeated(lambda: gr.trace(scene).poses, repeats)
    paper = repeated(lambda: [published(value) for value in values], repeats)
    places = {min(range(len(values)), key=lambda i: abs(values[i] - x_e)): f for x_e, f in FORCES[theory].items()}
    errors = (
        max(error(ours.answers[0][i].force_on_object_finger_frame, f) for i, f in places.items()),
        max(error(paper.answers[0][i].force_on_object, f) for i, f in places.items()),
    )
    touching = [i for i, pose in enumerate(ours.answers[0]) if pose.status == "contact"]
    warm = tuple([median(run[i].seconds for i in touching) for run in each.answers] for each in (ours, paper))
    yield from pair(theory, "median pose in contact", warm, errors)
    yield from pair(theory, f"all {len(values)} poses", (ours.seconds, paper.seconds), errors)


def main(folder: str | Path | None = None, scene: gr.Scene | None = None, repeats: int = 7) -> list[Cost]:
    """Measure Example II with and without shear; print the table; given a folder, write ``cost.csv`` into it."""
    scene, rows = scene or scenefile.read(SCENE), []
    print(f"{'theory':8} {'what':45} {'CPU ms: median':>14} {'min':>8} {'paper/this':>11} {'force error':>12}")
    for theory in FORCES:
        for row in costs(scene, theory, repeats):
            rows.append(row)
            print("{:8} {:45} {:14.1f} {:8.1f} {:11.1f} {:12.1e}".format(*row), flush=True)
    if folder is not None:
        with (Path(folder) / "cost.csv").open("w", newline="") as file:
            csv.writer(file).writerows([Cost._fields, *rows])
    return rows


if __name__ == "__main__":
    main(*sys.argv[1:2])
