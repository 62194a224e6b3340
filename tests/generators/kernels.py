"""The kernels of OpenBLAS that this processor can run, and a program under one of them."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from typing import Any

import numpy as np  # noqa: F401 - loads the BLAS
import pytest
from threadpoolctl import ThreadpoolController

_NEEDS = {
    "Prescott": set[str](),
    "Nehalem": set[str](),
    "Haswell": {"avx2", "fma"},
    "SkylakeX": {"avx512f", "avx512dq", "avx512bw", "avx512vl", "avx512cd"},
}
"""Flags of the processor, beyond what every one of today has.

OpenBLAS runs the kernel that it is told to run, and dies where an instruction is missing.
"""
_OF_ARM = ("ARMV8", "CORTEXA57")
"""Every processor of 64 bits runs both."""
_SAID = """
import json
from threadpoolctl import ThreadpoolController
print(json.dumps(found))
print(ThreadpoolController().select(internal_api="openblas").lib_controllers[0].architecture)
"""


def kernels() -> list[str]:
    """Return the kernels to compare: two at least, three where the processor has wide vectors.

    Skips, and says so, where numpy computes with a BLAS that has no kernels to choose from.
    """
    blas = ThreadpoolController().select(internal_api="openblas").lib_controllers
    if not blas:
        pytest.skip("numpy computes without OpenBLAS here: there is one kernel only")
    if platform.machine() in ("arm64", "aarch64"):
        return list(_OF_ARM)
    flags = _flags()
    able = [name for name, needed in _NEEDS.items() if needed <= flags]
    return ["Prescott", *able[-2:]] if len(able) > 2 else able


def _flags() -> set[str]:
    """Return what the processor can do; nothing where the system has no list of it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((set(line.split(":")[1].split()) for line in file if line.startswith("flags")), set())
    except OSError:
        return set()


def under(kernel: str, script: str) -> tuple[str, Any]:
    """Return which kernel a program ran with, as it says, and what it leaves in `found`, by way of JSON."""
    said = subprocess.run(
        [sys.executable, "-c", script + _SAID],
        check=True, capture_output=True, text=True, env=dict(os.environ) | {"OPENBLAS_CORETYPE": kernel},
    ).stdout.splitlines()  # fmt: skip
    return said[-1], json.loads(said[-2])
