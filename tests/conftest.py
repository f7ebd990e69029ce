"""One thread for linear algebra: the matrices are small, and waiting threads burn CPU time that tests run in."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
