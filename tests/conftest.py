"""One thread for linear algebra: the matrices are small, and waiting threads burn CPU time that tests run in.

HYPOTHESIS_PROFILE=long searches with thousands of examples, new ones at each run.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import HealthCheck, settings

settings.register_profile("long", max_examples=4000, deadline=None, suppress_health_check=list(HealthCheck))
if "HYPOTHESIS_PROFILE" in os.environ:
    settings.load_profile(os.environ["HYPOTHESIS_PROFILE"])
