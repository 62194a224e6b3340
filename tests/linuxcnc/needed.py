"""What tests on a running LinuxCNC need: marks for whole files of them."""

import pytest

from tests.linuxcnc.lab import available, can_compile

LINUXCNC = [
    pytest.mark.linuxcnc,
    pytest.mark.skipif(not available(), reason="needs Debian's linuxcnc-uspace, and namespaces"),
]
LONG = [*LINUXCNC, pytest.mark.long]
_COMPILED = pytest.mark.skipif(not can_compile(), reason="needs Debian's linuxcnc-uspace-dev and gcc")
WITH_COMPONENT = [*LINUXCNC, _COMPILED]
WITH_SPHERES = [*LONG, _COMPILED]
