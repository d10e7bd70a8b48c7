"""`python -m punchform` is the command `punchform`."""

import sys


def start() -> int:
    """The command, whose imports can be interrupted too; returns the exit code."""
    try:
        from punchform.cli import main
    except KeyboardInterrupt:
        return 130
    return main()


if __name__ == "__main__":
    sys.exit(start())
