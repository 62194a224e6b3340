"""Which programs a result came from."""

from __future__ import annotations

import platform

from axiscal import __version__


def versions() -> dict[str, str]:
    """Return the versions of axiscal and of what it computes with, by name."""
    import numpy

    return {"axiscal": __version__, "numpy": numpy.__version__, "python": platform.python_version()}
