"""Two ways to find slip, stick and sense: this project's, and SLSQP's own by Tresca problems (Example II, bending).

From slip one way through stick to slip the other way, at several distances of the poses. A Tresca problem knows the net
slip of a step only; this project locates where slip stops and starts, whatever the steps. CPU time on one thread.
"""

from __future__ import annotations

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import csv
import sys
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import NamedTuple

import gripper as gr
from gripper import scenefile
from gripper.contact.kinematics import Kinematics
from gripper.study.tresca import Tresca

SCENE = Path(__file__).with_name("rotating_finger.toml")
FROM, STEP, STEPS = 0.0254, 0.0127, 3  # m: x_e = 25.4 to 63.5 mm; it sticks between 47 and 50 mm


class Row(NamedTuple):
    """One spacing of the poses; the force is Tresca's against this project's, at worst."""

    spacing_mm: float
    tresca_ms: float
    rounds: float
    force_difference: float
    gripper_ms: float


def compared(scene: gr.Scene, parts: int) -> tuple[Row, gr.Result]:
    """Measure both on the same poses."""
    values = [FROM + i * STEP / parts for i in range(STEPS * parts + 1)]
    ours = gr.trace(replace(scene, motion=gr.Motion(scene.motion.parameter, (scene.motion.values[0], *values))))
    first, *poses = ours.poses[1:]
    path, setting = Kinematics(scene, first.kept.setting.sections.length), first.kept.setting
    tresca, began = Tresca(setting, first.kept.equilibrium), time.process_time()
    found = [tresca.pose(setting.obstacle(path.frame(value))) for value in values[1:]]
    seconds = (time.process_time() - began) / len(found)
    forces = [complex(*pose.force_on_object_finger_frame) for pose in poses]
    off = max(abs(held.force - force) / abs(force) for held, force in zip(found, forces, strict=True))
    rounds = sum(held.rounds for held in found) / len(found)
    return Row(1e3 * STEP / parts, 1e3 * seconds, rounds, off, 1e3 * median(p.seconds for p in poses)), ours


def main(folder: str | Path | None = None, parts: tuple[int, ...] = (2, 4, 16)) -> list[Row]:
    """Print the table; given a folder, write ``friction_models.csv`` into it."""
    scene = replace(scenefile.read(SCENE), theory="bending", friction=gr.Friction(coefficient=0.2))
    compared(scene, 1)  # compiles what is compiled once
    rows = [compared(scene, count)[0] for count in parts]
    print("| poses apart, mm | Tresca, ms a pose | rounds | force against this project's | this project, ms a pose |")
    print("|---|---|---|---|---|")
    for row in rows:
        print("| {:.2f} | {:.0f} | {:.1f} | {:.1e} | {:.1f} |".format(*row))
    if folder is not None:
        with (Path(folder) / "friction_models.csv").open("w", newline="") as file:
            csv.writer(file).writerows([Row._fields, *rows])
    return rows


if __name__ == "__main__":
    main(*sys.argv[1:2])
