"""Two ways to find slip, stick and sense: this project's, and SLSQP's own by Tresca problems (Example II, bending).

From slip one way through stick to slip the other way, at several distances of the poses. A Tresca problem knows the net
slip of a step only; this project locates where slip stops and starts, whatever the steps. CPU time on one thread.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import csv
import sys
from dataclasses import replace
from pathlib import Path

import gripper as gr
from gripper import scenefile
from gripper.study.tresca_cost import HEAD, Compared, compared

EXAMPLE = scenefile.read(Path(__file__).with_name("rotating_finger.toml"))
FROM, TO = 0.0254, 0.0635  # x_e in m; it sticks between 47 and 50 mm


def main(folder: str | Path | None = None, steps: tuple[int, ...] = (6, 12, 48)) -> list[Compared]:
    """Print the table; given a folder, write ``friction_models.csv`` into it."""
    scene = replace(EXAMPLE, theory="bending", friction=gr.Friction(coefficient=0.2))
    compared(scene, (FROM, TO))  # compiles what is compiled once
    rows = [compared(scene, gr.Motion.between("x_e", FROM, TO, count + 1).values) for count in steps]
    print(HEAD, *rows, sep="\n")
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        with Path(folder, "friction_models.csv").open("w", newline="") as file:
            csv.writer(file).writerows([Compared._fields, *rows])
    return rows


if __name__ == "__main__":
    main(*sys.argv[1:2])
