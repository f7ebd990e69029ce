"""The command line's beginning: ``gripper``, and ``python -m gripper``."""

from __future__ import annotations

import signal
import sys


def main() -> None:
    """Run the command line; a batch system's SIGTERM is a Ctrl-C, so that what was computed is kept.

    What takes time to import is imported here, where a Ctrl-C leaves no traceback. Once a command has ended there is
    nothing to interrupt.
    """
    try:
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        from gripper.cli import app

        app()
    except KeyboardInterrupt:  # before a command has begun: each has its own message
        sys.stderr.write("interrupted\n")
        raise SystemExit(130) from None
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


if __name__ == "__main__":
    main()
