"""The HAL text that puts the component between motion and drives."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.compensation.controllers.linuxcnc_volumetric.vcomp_writing import STATEMENT

FILE, HAL_FILE = "axiscal.vcomp", "axiscal-volumetric.hal"
_HEAD = f"""\
# Made by axiscal: every error of the machine taken away between motion and drives.
# {STATEMENT}
# To be run after motion and your drives are loaded (HALFILE, the last one). Then, for each joint N: net to your drive
# the signal vc-drv-N instead of joint.N.motor-pos-cmd (pid.N.command, stepgen's position-cmd), net its position
# feedback to vc-enc-N instead of joint.N.motor-pos-fb, and take your own net lines of these two pins out.
# axiscal-vcomp.fb has to run before motion-command-handler, axiscal-vcomp.cmd after motion-controller: put your own
# addf lines that read the hardware before, those that write it behind. With another order the following error grows by
# the way of one period.
"""
SWITCHES = """\
# Off at start. Switch it on with the spindle stopped and the tool clear: halcmd setp axiscal-vcomp.enable 1
setp axiscal-vcomp.enable 0
# A fault lets a part go on wrong by the whole error; to stop the feed then:
# net vc-fault axiscal-vcomp.fault => motion.feed-inhibit
# Tool lengths: without these lines the length of the campaign is taken for every tool. With them tool lengths have to
# count from the spindle nose; where they count from elsewhere, setp axiscal-vcomp.tool-gauge to the distance.
# net vc-tool-x motion.tooloffset.x => axiscal-vcomp.tool-x
# net vc-tool-y motion.tooloffset.y => axiscal-vcomp.tool-y
# net vc-tool-z motion.tooloffset.z => axiscal-vcomp.tool-z
"""


def text(joints: Sequence[int]) -> str:
    """Return the HAL text for joints by their numbers."""
    lines = [
        _HEAD + f"loadrt axiscal_vcomp file={FILE} units=[TRAJ]LINEAR_UNITS "
        '"coordinates=[TRAJ]COORDINATES" '  # quoted: people write blanks between the letters
        "joints=[KINS]JOINTS",
        "addf axiscal-vcomp.fb servo-thread 1",
        "addf axiscal-vcomp.cmd servo-thread",
        "net vc-home motion.is-all-homed => axiscal-vcomp.homed",
        "net vc-on motion.motion-enabled => axiscal-vcomp.powered",
    ]
    for joint in sorted(joints):
        lines += joint_lines(joint)
    return "\n".join(lines) + "\n" + SWITCHES


def joint_lines(joint: int) -> list[str]:
    """Return the lines of one joint; the ends at the drive, vc-drv-N and vc-enc-N, are left open."""
    return [
        f"net vc-pos-{joint} joint.{joint}.pos-cmd => axiscal-vcomp.pos-{joint}",
        f"net vc-mot-{joint} joint.{joint}.motor-pos-cmd => axiscal-vcomp.motor-{joint}",
        f"net vc-drv-{joint} axiscal-vcomp.drive-{joint}",
        f"net vc-enc-{joint} axiscal-vcomp.encoder-{joint}",
        f"net vc-fb-{joint} axiscal-vcomp.feedback-{joint} => joint.{joint}.motor-pos-fb",
        f"net vc-bl-{joint} joint.{joint}.backlash-corr => axiscal-vcomp.backlash-{joint}",
    ]
