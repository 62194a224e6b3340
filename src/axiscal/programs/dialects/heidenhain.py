"""HEIDENHAIN Klartext of iTNC 530, TNC 640 and their kin: M91 in each block means the machine datum.

Klartext is absolute, and the unit is said when a program begins and ends. Cycle 9 dwells in seconds where it is
defined. Cycle 4 measures in 3-D along a vector, result from Q1 on, drawn back by MB afterwards.
"""

from axiscal.programs.dialect import Dialect, Log

_LOG = "/ TNC:\\AXISCAL\\{code}.TXT"


def _measured(feed: str) -> tuple[str, ...]:
    return (
        "TCH PROBE 4.0 MEASURING IN 3-D",
        "TCH PROBE 4.1 Q1",
        "TCH PROBE 4.2 {along}",
        f"TCH PROBE 4.3 DIST{{reach:+.3f}} F{feed} MB{{backwards:.3f}} REFERENCE SYSTEM: 1",
        "FN 9: IF +Q4 EQU -1 GOTO LBL 99",
    )


HEIDENHAIN = Dialect(
    title="HEIDENHAIN",
    suffix="H",
    longest_name=16,
    notes=(
        "Never tried on a control: run it in the test run first, then block by block at reduced feed.",
        "Call the tool (or tool 0) by hand before: the program has no TOOL CALL. M91 leaves out datum and tool length.",
        "Before it starts, M128 or FUNCTION TCPM, a tilted plane, M116 and M126 must be off: turning axes move in "
        "deg/min and do not take the short way.",
    ),
    opening=("BEGIN PGM {name} MM", "M5", "M9"),
    closing=("M30", "END PGM {name} MM"),
    numbered=True,
    signed=True,
    move="L {to} R0 F{feed} M91",
    dwell=("CYCL DEF 9.0 DWELL TIME", "CYCL DEF 9.1 DWELL {s:.3f}"),
    stop=("STOP",),
    pause=("STOP",),
    comment="; {text}",
    tip_on=("FUNCTION TCPM F CONT AXIS POS PATHCTRL AXIS",),
    tip_off=("FUNCTION RESET TCPM",),  # it must not be in force with M91
    tip_move="L {to} R0 F{feed}",
    from_zero=True,
    tip_needs=(
        "IN TOUCH - TOOL POINT ON THE WORKPIECE BY TCPM",
        "NEEDS THE PRESET AT THE MACHINE DATUM AND THE TOOL CALLED",
    ),
    tip_notes=(
        "FUNCTION TCPM is an option; F CONT makes the feed that of the axes that are programmed, AXIS POS PATHCTRL "
        "AXIS lets rotary axes turn evenly. An older control has M128 instead.",
        "The active preset must be the machine datum with no rotation, and the tool must have been called with its "
        "length, so that coordinates count from the machine's zero with the table at zero.",
    ),
    log=Log(
        on=("FN 16: F-PRINT TNC:\\AXISCAL\\AXHEAD_{code}.A " + _LOG,),
        off=(
            "FN 0: Q5 = +{readings}",
            "FN 16: F-PRINT TNC:\\AXISCAL\\AXEND.A " + _LOG,
            "FN 9: IF +0 EQU +0 GOTO LBL 98",
            "LBL 99",
            "; THE PROBE MET NOTHING",
            "STOP",
            "M30",
            "LBL 98",
        ),
        touch=(
            *_measured("{fast}"),
            *_measured("{slow}"),
            "FN 0: Q5 = +{reading}",
            "FN 0: Q6 = +{touch}",
            "FN 16: F-PRINT TNC:\\AXISCAL\\AXTOUCH.A " + _LOG,
            "{away}",
        ),
        files={
            "AXHEAD_{code}.A": '"{head}";\nM_APPEND;\n',
            "AXTOUCH.A": '"R %6.0LF T %3.0LF X %12.5LF Y %12.5LF Z %12.5LF",Q5,Q6,Q1,Q2,Q3;\nM_APPEND;\n',
            "AXEND.A": '"END %6.0LF",Q5;\nM_APPEND;\n',
        },
        notes=(
            "The probing blocks were never tried on a control. TCH PROBE 4 (measuring in 3-D) measures in the "
            "machine's own system (REF) without the probe's length and radius, into Q1 to Q3; Q4 is -1 where nothing "
            "was met. Q1 to Q6 are used.",
            "FN 16 writes the log on at its end. The masks, the files .A beside the program, must lie in "
            "TNC:\\AXISCAL; the log is written there.",
        ),
    ),
)
"""By HEIDENHAIN's manuals; names of programs have 16 characters."""
