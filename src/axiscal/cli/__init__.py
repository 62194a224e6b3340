"""The command line: each command a few lines over the library."""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command of `sys.argv` and return the exit status: 0 done, 1 could not be done, 2 wrong usage."""
    if sys.argv[1:] == ["--version"]:  # answered before anything is loaded
        from axiscal import __version__

        sys.stdout.write(f"axiscal {__version__}\n")
        return 0
    from axiscal.cli.app import run

    return run(sys.argv[1:])
