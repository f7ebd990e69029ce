"""Compliant grippers: the bent shape and the contact forces of a flexible finger on a rigid outline.

    import gripper as gr

    result = gr.solve(gr.Scene(finger=..., object=...))   # one pose
    result = gr.trace(gr.Scene(..., motion=...))          # a motion
    problem = gr.assemble(scene)                          # the NCO problem, ready for scipy.optimize.minimize

After C.-C. Lan and K.-M. Lee, "An Analytical Method for Design of Compliant Grippers with Macro/Micro Manipulation
and Assembly Applications". SI units and radians throughout.
"""

import ast
import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

_PUBLIC = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
_HOMES = {name.name: node.module for node in _PUBLIC if isinstance(node, ast.ImportFrom) for name in node.names}
__all__ = sorted(_HOMES)


class _Package(ModuleType):
    """This package: a public name is imported, from where __init__.pyi says, when it is first asked for."""

    def __getattr__(self, name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}", name=name, obj=self)
        value = getattr(importlib.import_module(str(_HOMES[name])), name)
        self.__dict__[name] = value
        return value

    def __setattr__(self, name: str, value: object) -> None:
        # gripper.solve is the function: the import of the module of that name must not put itself in its place
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *__all__})


sys.modules[__name__].__class__ = _Package
