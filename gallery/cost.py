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
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from math import dist, hypot
from pathlib import Path
from statistics import median

import gripper as gr
from gripper import scenefile
from gripper.study.cost import repeated, single_pose
from gripper.study.published import PublishedResult, solve_as_published

SCENE = Path(__file__).with_name("rotating_finger.toml")
N = 90
FORCES = {  # on the object, in N, finger frame: shooting at tolerance 1e-12, as in tests/reference/beam.json
    "shear": {0.0508: (0.5714555472, -3.512588619), -0.0254: (8.73613172, -13.18698009)},
    "bending": {0.0508: (0.6151679239, -3.692652411), -0.0254: (9.459432209, -13.85118976)},
}


@dataclass(frozen=True)
class Cost:
    """One row: CPU times in ms, how many times as long the paper's scheme takes, relative error of the force.

    Where there are several poses, the error is the larger of those at the two reference poses.
    """

    theory: str
    what: str
    cpu_ms_median: float
    cpu_ms_min: float
    paper_over_this: float
    force_error: float


def error(theory: str, x_e: float, answer: gr.PoseResult | PublishedResult) -> float:
    """Relative error of the force against the reference."""
    reference = FORCES[theory][x_e]
    force = answer.force_on_object if isinstance(answer, PublishedResult) else answer.force_on_object_finger_frame
    return dist(force, reference) / hypot(*reference) if force else float("nan")


def pair(
    theory: str, what: str, errors: tuple[float, float], ours: Sequence[float], paper: Sequence[float]
) -> Iterator[Cost]:
    """Give the rows of gripper and of the paper's scheme, from the seconds of their repeats."""
    for name, off, seconds in (("gripper", errors[0], ours), ("paper's scheme", errors[1], paper)):
        ratio = median(paper) / median(seconds)
        yield Cost(theory, f"{what}, {name}", 1e3 * median(seconds), 1e3 * min(seconds), ratio, off)


def costs(scene: gr.Scene, theory: str, repeats: int = 7) -> Iterator[Cost]:
    """Measure single poses, and then the scene's whole motion, which must pass the two reference poses."""
    scene = replace(scene, theory=theory)
    published = partial(solve_as_published, scene, N=N, shear="none" if theory == "bending" else "element")
    for x_e in FORCES[theory]:
        ours = repeated(partial(gr.solve, single_pose(scene, x_e)), repeats)
        paper = repeated(partial(published, x_e), repeats)
        errors = error(theory, x_e, ours.answers[0].poses[0]), error(theory, x_e, paper.answers[0])
        yield from pair(theory, f"cold pose x_e = {x_e}", errors, ours.seconds, paper.seconds)

    values = scene.motion.values
    traced = repeated(partial(gr.trace, scene), repeats)
    followed = repeated(lambda: [published(value) for value in values], repeats)
    touching = [i for i, pose in enumerate(traced.answers[0].poses) if pose.status == "contact"]
    places = {x_e: min(touching, key=lambda i: abs(values[i] - x_e)) for x_e in FORCES[theory]}
    poses = traced.answers[0].poses, followed.answers[0]
    ours_off, paper_off = (max(error(theory, x_e, each[i]) for x_e, i in places.items()) for each in poses)
    ours_warm = [median(result.poses[i].seconds for i in touching) for result in traced.answers]
    paper_warm = [median(run[i].seconds for i in touching) for run in followed.answers]
    yield from pair(theory, "median pose in contact", (ours_off, paper_off), ours_warm, paper_warm)
    yield from pair(theory, f"all {len(values)} poses", (ours_off, paper_off), traced.seconds, followed.seconds)


def main(folder: str | Path | None = None, repeats: int = 7) -> list[Cost]:
    """Measure with and without shear; print the table and, where a folder is given, write ``cost.csv`` into it."""
    scene = scenefile.read(SCENE)
    rows = []
    print(f"{'theory':8} {'what':42} {'CPU ms: median':>14} {'min':>8} {'paper/this':>11} {'force error':>12}")
    for theory in FORCES:
        for row in costs(scene, theory, repeats):
            print(
                f"{row.theory:8} {row.what:42} {row.cpu_ms_median:14.1f} {row.cpu_ms_min:8.1f} "
                f"{row.paper_over_this:11.1f} {row.force_error:12.1e}",
                flush=True,
            )
            rows.append(row)
    if folder is not None:
        with (Path(folder) / "cost.csv").open("w", newline="") as file:
            table = csv.DictWriter(file, list(asdict(rows[0])))
            table.writeheader()
            table.writerows(asdict(row) for row in rows)
    return rows


if __name__ == "__main__":
    main()
