"""LinuxCNC 2.8 or later, set up in mm or in inches (RS-274/NGC): G21 holds for machine coordinates too.

G53 goes with G1 and holds for its block only; G4 P is in seconds. The length of the tool comes before M428, for with
that in force a new one would move the axes by tens of millimetres. A feed is that of X Y Z, and of the rotary axes
where these stay.
"""

from axiscal.language.spoken import later
from axiscal.programs.dialect import Dialect, Log


def _at_zero(label: str, last: int) -> tuple[str, ...]:
    """Return what ends a program where an offset is in force.  last : number of a parameter of G54"""
    offsets = "+".join(f"ABS[#{number}]" for number in (5210, *range(5221, last + 1)))
    return ("G54", f"{label} IF [{offsets} GT 0.00005]", "(MSG, G54 OR G92 IS NOT ZERO)", "M2", f"{label} ENDIF")


def _missed(label: str) -> tuple[str, ...]:
    """Return what ends a program where nothing was met."""
    said = ("(LOG,MISS R#1 T#2)", "(LOGCLOSE)", "(MSG, THE PROBE MET NOTHING)", "M2")
    return (f"{label} IF [#5070 EQ 0]", *said, f"{label} ENDIF")


_TOUCH = (
    "O<axiscal_touch> SUB",
    "G38.3 X#3 Y#4 Z#5 F#12",
    *_missed("O102"),
    "G91 G1 X#6 Y#7 Z#8",
    "G90 G38.3 X#3 Y#4 Z#5 F#13",
    *_missed("O103"),
    "(LOG,R#1 T#2 X#5061 Y#5062 Z#5063)",
    "G53 G1 X#9 Y#10 Z#11 F#14",
    "O<axiscal_touch> ENDSUB",
)
"""#1 reading, #2 touch, #3 where it ends if nothing is met, #6 step back, #9 beside the sphere, #12 feeds."""

LINUXCNC = Dialect(
    title="LinuxCNC",
    suffix="ngc",
    notes=(
        "Tried on LinuxCNC's own interpreter (rs274), not on a machine.",
        "Coordinates are in mm (G21) and deg, whatever LINEAR_UNITS says: tried with mm and with inch.",
        "Rotary axes must not be WRAPPED_ROTARY, and a five-axis kinematics must be in its joint (identity) mode.",
    ),
    opening=("G21 G90 G94 G17 G40 G49 G80", "M5 M9", "G61"),
    closing=("M2",),
    move="G53 G1 {to} F{feed}",
    dwell=("G4 P{s:.3f}",),
    tip_on=(*_at_zero("O100", 5226), "G43.1 Z{tool}", "M428"),
    tip_off=("M429", "G49"),
    tip_move="G1 {to} F{feed}",
    tip_decimals=6,
    tip_tables=("CA", "CB"),
    tip_tables_said=later("xyzac- and xyzbc-trt-kins are for w-C'-A'- and w-C'-B'-; choose another control"),
    tip_needs=("IN TOUCH - TOOL POINT ON THE WORKPIECE BY M428", "NEEDS G54 AND G92 AT ZERO"),
    tip_notes=(
        "M428 must switch to the kinematics of the swivelling table and M429 back to identity, as in LinuxCNC's own "
        "configurations of trt-kins (sparm=identityfirst); rotation points and offsets are those of the machine.",
        "The tool's length is put in force by G43.1; the pin tool-offset must follow motion.tooloffset.z.",
    ),
    log=Log(
        on=(*_at_zero("O101", 5230), *_TOUCH, "(LOGAPPEND,axiscal_{code}.txt)", "(LOG,{head})"),
        off=("(LOG,END {readings})", "(LOGCLOSE)"),
        touch=("O<axiscal_touch> CALL {all}",),
        notes=(
            "Tried on a running LinuxCNC without motors. The log is a file of the name in the first lines of the "
            "program, in the folder from which LinuxCNC was started; it is written on at its end.",
            "G54, G92 and the rotation of G54 must be zero: the program looks. The probe is on motion.probe-input.",
        ),
    ),
)
"""By LinuxCNC's manual; six decimals of a tool point are a nanometre."""
