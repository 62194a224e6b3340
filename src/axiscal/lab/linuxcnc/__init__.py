"""Debian's LinuxCNC without screen or motors, for one job after another: configuration text in, positions out."""

from axiscal.lab.linuxcnc.configuration import Joint, Settings
from axiscal.lab.linuxcnc.session import Ending, Run, Session, available, can_load, run

__all__ = ["Ending", "Joint", "Run", "Session", "Settings", "available", "can_load", "run"]
