"""ISG kernel (TwinCAT CNC): with no kinematics, offset or tool, coordinates are the machine's; #TIME waits.

How such a control writes what it measured was not to be found out: it has no log.
"""

from axiscal.programs.dialect import Dialect

ISG = Dialect(
    title="ISG",
    suffix="nc",
    notes=(
        "Never tried on a control: run it in the simulation first, then block by block at reduced feed.",
        "G53 takes out zero offsets, D0 the tool and #TRAFO OFF the kinematics: then coordinates are those of the "
        "axes. No #CS, #ACS, #PSET, mirroring or scaling may be in force.",
        "The feed of a block in which only rotary axes move is taken to be in deg/min.",
    ),
    # Without the name a program would be nameless in the control's messages.
    opening=("%AXISCAL{number}", "#TRAFO OFF", "G71 G90 G94 G17 G40 G53 G60 D0", "M5 M9"),
    closing=("M30",),
    move="G1 {to} F{feed}",
    dwell=("#TIME {s:.3f}",),
    tip_on=("G53", "D1", "#TRAFO ON"),
    tip_off=("#TRAFO OFF", "D0"),
    tip_move="G1 {to} F{feed}",
    tip_decimals=6,
    from_zero=True,
    tip_needs=("IN TOUCH - TOOL POINT ON THE WORKPIECE BY TRAFO ON", "NEEDS NO ZERO OFFSET AND THE TOOL IN D1"),
    tip_notes=(
        "#TRAFO ON switches to the kinematics that the channel has by default, an option: it must be that of the "
        "machine, incomplete (RTCP), with places on the workpiece as the table stands when it begins, which "
        "is at zero.",
        "D1 must hold the length of the tool as the machine description has it; G53 takes out the zero offsets.",
    ),
)
"""By ISG's documentation of the kernel; six decimals of a tool point are a nanometre."""
