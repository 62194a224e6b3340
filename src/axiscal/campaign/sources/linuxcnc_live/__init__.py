"""`linuxcnc-live[:HOST]`: the LinuxCNC of its owner, attached to while it runs, touches spheres with its own probe."""

from __future__ import annotations

from axiscal.campaign.sources.linuxcnc_live.attached import LiveSource

__all__ = ["LiveSource"]
