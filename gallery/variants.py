"""How fast a sweep is: variants of Example I, 30 poses each, on all processors.

    python -m gallery.variants [how many]

Half of the thicknesses are larger than the gap above the pin: these fingers stay in contact when closed.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import sys
import time
from dataclasses import replace

import numpy as np

import gripper as gr
from gallery.micro_assembly import scene

PLACES = gr.Motion.between("x_o", 0.086, 0.050, 30)
ANGLES = 10


def main(variants: int = 1000) -> gr.Sweep:
    """Sweep thickness (2.5 to 3.9 mm) and lead angle (15 to 25 degrees), and say how long it took."""
    angles = np.radians(np.linspace(15, 25, min(ANGLES, variants)))
    over = {
        "finger.thickness": np.linspace(2.5e-3, 3.9e-3, max(variants // len(angles), 1)),
        "finger.jaw.lead_angle": angles,
    }
    began, before = time.perf_counter(), os.times()
    table = gr.sweep(replace(scene, motion=PLACES), over)
    wall, after = time.perf_counter() - began, os.times()
    used = [after[i] - before[i] for i in range(4)]  # user and system: own, and of the processes
    n = table.plan.size
    print(f"{n} variants of {len(PLACES.values)} poses, {len(table.failed)} without an answer")
    print(f"{wall:.1f} s on {os.cpu_count()} processors: {n / wall:.1f} variants a second")
    print(f"CPU time of a variant: {1e3 * sum(used[2:]) / n:.0f} ms, and {1e3 * sum(used[:2]) / n:.1f} ms to lead them")
    return table


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
