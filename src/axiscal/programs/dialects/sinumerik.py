"""SINUMERIK 840D/828D in its own language, not in ISO mode: SUPA takes every offset out of its block.

G4 F is in seconds.
"""

from axiscal.programs.dialect import LETTERS, Dialect, Log

_FULL = "IF AXERR<>0 GOTOF AXFULL"
_MISSED = ("STOPRE", "IF $AC_MEA[1]==0 GOTOF AXMISS")

SINUMERIK = Dialect(
    title="SINUMERIK",
    suffix="MPF",
    notes=(
        "Never tried on a control: run it dry first (program test, DRY), then at reduced feed.",
        "Written for the Siemens language (G291 off). SUPA leaves out every frame, also the handwheel's; D0 takes out "
        "the tool, TRAFOOF the five-axis transformation.",
        "FGROUP names all axes, so that the feed of a turning axis is in deg/min; FGREF is taken to be as delivered.",
    ),
    opening=("TRAFOOF", "G710 G90 G94 G17 G40 G60 D0", "M5 M9", "FGROUP({axes})"),
    closing=("M30",),
    move="G1 SUPA {to} F{feed}",
    dwell=("G4 F{s:.3f}",),  # it does not touch the feed of moves
    comment="; {text}",
    axes=f"[{LETTERS}]|[XYZUVW][1-9]",  # A2= to C7= are directions of the tool there
    tip_on=("G500", "D1", "TRAORI", "ORIMKS ORIAXES"),
    tip_off=("TRAFOOF", "D0"),
    tip_move="G1 {to} F{feed}",
    tip_decimals=6,
    tip_needs=("IN TOUCH - TOOL POINT ON THE WORKPIECE BY TRAORI", "NEEDS BASE FRAME AT ZERO AND THE TOOL IN D1"),
    tip_notes=(
        "TRAORI is the five-axis transformation of the machine, an option; ORIAXES lets rotary axes turn evenly, "
        "which needs $MC_ORI_IPO_WITH_G_CODE = TRUE.",
        "G500 takes out the settable frames: the base frame must be zero, so that coordinates count from the "
        "machine's zero with the table at zero. D1 of the tool in the spindle holds its length.",
    ),
    log=Log(
        declared=("DEF INT AXERR",),
        on=('WRITE(AXERR,"_N_AX{code}_MPF","{head}")', _FULL),
        off=(
            'WRITE(AXERR,"_N_AX{code}_MPF","END {readings}")',
            _FULL,
            "GOTOF AXEND",
            'AXMISS: MSG("THE PROBE MET NOTHING")',
            "M0",
            "M30",
            'AXFULL: MSG("THE LOG CANNOT BE WRITTEN")',
            "M0",
            "M30",
            "AXEND: MSG()",
        ),
        touch=(
            "MEAS=1 G1 SUPA {into} F{fast}",
            *_MISSED,
            "G91 G1 {back} F{fast}",
            "G90 MEAS=1 G1 SUPA {into} F{slow}",
            *_MISSED,
            'WRITE(AXERR,"_N_AX{code}_MPF","R{reading} T{touch}"<<" X"<<$AA_MM[X]<<" Y"<<$AA_MM[Y]<<" Z"<<$AA_MM[Z])',
            _FULL,
            "{away}",
        ),
        notes=(
            "The probing blocks were never tried on a control. MEAS = 1 takes the first measuring input; $AA_MM is in "
            "the machine's coordinates, without the tool.",
            "WRITE writes the log on at its end: _N_AX and its eight digits in the folder of part programs. It must "
            "have room (MD 11420 LEN_PROTOCOL_FILE, in kB); the program ends with a message where it has none.",
        ),
    ),
)
"""By SIEMENS' manuals; six decimals of a tool point are a nanometre."""
