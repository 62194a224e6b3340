"""What tests on a running LinuxCNC need: marks for whole files of them."""

import pytest

from tests.linuxcnc.lab import available, can_load

LINUXCNC = [
    pytest.mark.linuxcnc,
    pytest.mark.skipif(not available(), reason="Debian package linuxcnc-uspace is not installed"),
]
LONG = [*LINUXCNC, pytest.mark.long]
WITH_SPHERES = [
    *LONG,
    pytest.mark.skipif(not can_load("axiscal_balls"), reason="needs Debian's linuxcnc-uspace-dev and gcc"),
]
WITH_COMPONENT = [
    *LINUXCNC,
    pytest.mark.skipif(not can_load("axiscal_vcomp"), reason="needs Debian's linuxcnc-uspace-dev and gcc"),
]
