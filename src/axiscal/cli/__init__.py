"""The command line: each command a few lines over the library."""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command of `sys.argv` and return the exit status: 0 done, 1 could not be done, 2 wrong usage."""
    if sys.argv[1:] == ["--version"]:  # answered before anything is loaded
        from axiscal import __version__

        sys.stdout.write(f"axiscal {__version__}\n")
        return 0
    import gc  # of Python itself, and nothing is to be loaded before Ctrl-C is answered

    status = 1
    gc.disable()  # while the program is loaded nothing is garbage, and looking for it is a tenth of the start
    try:  # a signal may come while the program is still being loaded
        from axiscal.cli.app import run
        from axiscal.cli.stages import shown_stages

        with shown_stages():
            status = run(sys.argv[1:])
    except ModuleNotFoundError as missing:
        if (missing.name or "").startswith("axiscal"):
            raise
        what = f"The library is installed without the program, which needs {missing.name}"
        sys.stderr.write(f"axiscal: {what}. Install it: pip install 'axiscal[app]'\n")
    except KeyboardInterrupt:
        sys.stderr.write("axiscal: Stopped by Ctrl-C before anything was done.\n")
    finally:  # what is to be said has been said: a signal that comes now changes nothing
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)
        gc.enable()
    if status == 1:  # Python would end the process by the signal once more if Ctrl-C met the code of a text
        import os

        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    return status
