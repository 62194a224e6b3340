"""`linuxcnc-live[:HOST]`: the LinuxCNC of its owner, attached to while it runs, touches spheres with its own probe."""

from __future__ import annotations

from axiscal.ports.linuxcnc.live.attached import LiveSource
from axiscal.ports.linuxcnc.live.connection import Connection, command
from axiscal.ports.linuxcnc.live.in_force import InForce
from axiscal_core.machine import Machine

__all__ = ["InForce", "LiveSource", "attached_to", "running"]


def attached_to(host: str, machine: Machine, in_force: InForce) -> LiveSource:
    """Return the LinuxCNC that runs on a computer, on this one without a name; raises SourceError."""
    return LiveSource(Connection(command(host)), machine, in_force)


def running(host: str, machine: Machine, active: bool) -> LiveSource:
    """Return the same, for readings of a campaign; raises SourceError.  active : whether a compensation is in force"""
    return attached_to(host, machine, InForce(active))
