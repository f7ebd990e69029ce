"""Names for arrays: what they hold is in the name, their shapes are in the docstrings."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

# NumPy's stubs widen float64 and complex128 to abstract kinds in plain arithmetic: the element type is a name only
Array: TypeAlias = np.ndarray[Any, np.dtype[Any]]
"""Real numbers."""
Complex: TypeAlias = np.ndarray[Any, np.dtype[Any]]
"""Points and vectors of the plane, x + iy."""
Index: TypeAlias = np.ndarray[Any, np.dtype[Any]]
"""Whole numbers that count pieces, segments, rows."""
Mask: TypeAlias = np.ndarray[Any, np.dtype[Any]]
"""Booleans."""
