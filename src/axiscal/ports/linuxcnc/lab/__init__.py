"""Debian's LinuxCNC without screen or motors, for one job after another: configuration text in, pins out."""

from axiscal.ports.linuxcnc.lab.configuration import Joint, Settings
from axiscal.ports.linuxcnc.lab.session import Session, available, can_load

__all__ = ["Joint", "Session", "Settings", "available", "can_load"]
