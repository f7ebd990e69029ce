"""Error against run time on Example II: this project, the paper's scheme, and CasADi/IPOPT where it is installed.

One pose of the hardest kind (x_e = -25.4 mm, shear); the errors are those against the beam's differential equations,
shot from the clamp. `gripper study SCENE.toml` does the same for any scene.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

from pathlib import Path

from gripper import scenefile
from gripper.study.diagram import diagram
from gripper.study.precision import study
from gripper.study.work import WorkPrecision

SCENE, X_E = Path(__file__).with_name("rotating_finger.toml"), -0.0254


def main(folder: str | Path = "out/error_against_time", *, quick: bool = False) -> WorkPrecision:
    """Measure; write the diagram and its numbers into the folder. Quick: few and coarse points."""
    found = study(scenefile.read(SCENE), X_E, quick=quick)
    Path(folder).mkdir(parents=True, exist_ok=True)
    Path(folder, "error_against_time.csv").write_text(found.csv())
    diagram(found).savefig(Path(folder, "error_against_time.png"))
    return found


if __name__ == "__main__":
    print(main(), "Figure: out/error_against_time", sep="\n\n")
