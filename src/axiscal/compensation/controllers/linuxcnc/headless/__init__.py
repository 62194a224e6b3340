"""Debian's LinuxCNC without screen or motors, for one job after another: configuration text in, positions out."""

from axiscal.compensation.controllers.linuxcnc.headless.configuration import Joint
from axiscal.compensation.controllers.linuxcnc.headless.session import Run, Session, Step, available, run

__all__ = ["Joint", "Run", "Session", "Step", "available", "run"]
