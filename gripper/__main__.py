"""``python -m gripper``: the command line."""

from gripper.cli import main

main()
