"""What exact derivatives cost beside the pose, or the motion, that they belong to.

CPU time on one thread, medians of the repeats after a warm-up, in one run. Every derivative is of a result of its own:
nothing that an earlier one has reckoned is at hand.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import gripper as gr
from gripper import scenefile
from gripper.study.cost import repeated, single_pose

HERE = Path(__file__).parent
EXAMPLES = {  # scene file, a place, a number
    "I": ("micro_assembly.toml", 0.06781, "finger.thickness"),
    "II": ("rotating_finger.toml", -0.0254, "finger.tip_thickness"),
}
MU, POSES = 0.3, 30


def shares(solved: Callable[[], gr.Result], key: str, repeats: int) -> tuple[float, float, float]:
    """CPU time of a result in ms; that of its derivatives by one number and by all, by it."""
    alone = repeated(solved, repeats).median
    fresh = iter([solved() for _ in range(2 * (repeats + 1))])
    one = repeated(lambda: next(fresh).sensitivity(key), repeats).median
    every = repeated(lambda: next(fresh).sensitivities(), repeats).median
    return 1e3 * alone, one / alone, every / alone


def main(repeats: int = 15) -> list[tuple[str, float, float, float]]:
    """Print the table: a cold pose, and a motion of 30 poses with its summary; without friction and with it."""
    rows = []
    print(f"{'example':38}{'ms':>8}{'one number':>12}{'all numbers':>13}")
    for name, (file, place, key) in EXAMPLES.items():
        scene = scenefile.read(HERE / file)
        ends = scene.motion.values[0], scene.motion.values[-1]
        motion = replace(scene, motion=gr.Motion.between(scene.motion.parameter, *ends, POSES))
        slipping = replace(motion, friction=gr.Friction(coefficient=MU))
        pose = single_pose(scene, place)
        for what, solved in (
            ("a cold pose", lambda pose=pose: gr.solve(pose)),
            (f"{POSES} poses", lambda motion=motion: gr.trace(motion)),
            (f"{POSES} poses, mu = {MU}", lambda slipping=slipping: gr.trace(slipping)),
        ):
            rows.append((f"{name}: {what}", *shares(solved, key, repeats)))
            print("{:38}{:8.1f}{:12.2f}{:13.2f}".format(*rows[-1]), flush=True)
    return rows


if __name__ == "__main__":
    main()
