"""Extreme scenes and random ones, judged by what shares no code with the solver: solved, refused, or wrong.

Maps over everything that matters once the problem is dimensionless, and 2,000 seeded random scenes; hours of CPU. What
was judged is kept: an interrupted run goes on where it stopped. `gripper study --robustness` does the same.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

import sys
from collections.abc import Iterable
from pathlib import Path

from gripper.study.cases import Case
from gripper.study.robustness import Judged, scenes, study, summary
from gripper.study.verdicts import verdicts


def main(folder: str | Path = "out/robustness", cases: Iterable[Case] | None = None) -> list[Judged]:
    """Judge the scenes (by default all of them); write the record and the figure into the folder."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    found = study(scenes(2000) if cases is None else cases, Path(folder, "robustness.csv"))
    verdicts(found).savefig(Path(folder, "robustness.png"))
    return found


if __name__ == "__main__":  # with a number: so many random scenes, after the maps
    chosen = scenes(int(sys.argv[1])) if len(sys.argv) > 1 else None
    print(summary(main(cases=chosen)), "Figure: out/robustness", sep="\n\n")
