"""The best numbers for a scene: steps foretold from exact gradients, peaks in epigraph form.

best = gr.optimize(scene, free={"finger.thickness": (0.002, 0.005)}, minimize="insertion_force",
                   limits={"max_strain": 0.015, "min_retention_ratio": 2.0})
"""

from gripper.optimize.optimum import Optimum, Trial
from gripper.optimize.search import Interrupted, optimize

__all__ = ["Interrupted", "Optimum", "Trial", "optimize"]
