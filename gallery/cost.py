"""What the poses of Example II cost, beside the paper's own scheme on the same poses; and Example I in and out again.

CPU time on one thread, median and least of the repeats after a warm-up; with gripper, checks, certificate and error
estimate included. The paper's scheme (raw node angles, contact at M = N = 90 nodes, SLSQP, every pose from an arc that
clears the object) has exact gradients and its shear cured: without them it takes 10 times as long, or fails.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import csv
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median

import gripper as gr
from gripper import scenefile
from gripper.study.cost import repeated
from gripper.study.motion_cost import HEAD, Cost, costs

SCENE, PLACES = Path(__file__).with_name("rotating_finger.toml"), (0.0508, -0.0254)  # x_e, in m
HOOK, MU = Path(__file__).with_name("micro_assembly.toml"), 0.3


def main(folder: str | Path | None = None, scene: gr.Scene | None = None, repeats: int = 7) -> list[Cost]:
    """Measure Example II with and without shear; print the table; given a folder, write ``cost.csv`` into it."""
    scene, rows = scene or scenefile.read(SCENE), []
    print(HEAD)
    for theory in ("shear", "bending"):
        for row in costs(replace(scene, theory=theory), PLACES, repeats):
            rows.append(row)
            print(row, flush=True)
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        with Path(folder, "cost.csv").open("w", newline="") as file:
            csv.writer(file).writerows([Cost._fields, *rows])
    return rows


def there_and_back(repeats: int = 7) -> list[float]:
    """CPU seconds of Example I's insertion and extraction with friction: 74 poses."""
    scene = scenefile.read(HOOK)
    there = [0.086 - 0.026 * i / 37 for i in range(38)]
    motion = gr.Motion("x_o", (*there[:-1], *there[:0:-1]))
    scene = replace(scene, motion=motion, friction=gr.Friction(coefficient=MU))
    return list(repeated(partial(gr.trace, scene), repeats).seconds)


if __name__ == "__main__":
    main(*sys.argv[1:2])
    seconds = there_and_back()
    print(f"Example I there and back, mu = {MU}, 74 poses: {median(seconds):.2f} s, at least {min(seconds):.2f} s")
