"""Processes for a sweep: deaf to Ctrl-C, and gone when the one that leads them is."""

from __future__ import annotations

import os
import signal
import threading
import time
from concurrent.futures import ProcessPoolExecutor

_LOOKS = 1.0  # s: how often a process looks whether it is still wanted


def processes(workers: int | None = None) -> ProcessPoolExecutor:
    """Make as many processes as wanted; by default one for each processor."""
    return ProcessPoolExecutor(workers, initializer=_begin, initargs=(os.getpid(),))


def _begin(leader: int) -> None:
    """Begin a process: Ctrl-C is for the one that leads it, and it does not outlive that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with, args=(leader,), daemon=True).start()


def _end_with(leader: int) -> None:
    while os.getppid() == leader:
        time.sleep(_LOOKS)
    os._exit(1)
