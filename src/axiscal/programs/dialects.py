"""What each control says: its dialect of programs as data, by its manuals.

FANUC milling controls (G-code of the M series) with custom macro B: moves are G1 in G54, for G53 is always a rapid.

The program proves that G54 is the machine's zero. Variable #4008 is the tool length offset in force (B-63944EN, system
variables). Variable #5021… is the machine position of each axis, #5041… its position in the work coordinates in force.
They agree for every axis if G54 is the machine's zero. A stop may change offsets, and jogging with manual absolute off
shifts them. So the proof follows every M0, which also ends reading ahead. G49 alone may move an axis, so it must be in
force. In cutting mode (G64) a block begins while the one before still brakes: an overrun would be cut short. G4 P is a
whole number of milliseconds. G15, G50, G50.1 and G69 end polar coordinates, scaling, mirror image, and rotation or a
tilted plane (B-63944EN, preparatory functions); each is an option.

HEIDENHAIN Klartext of iTNC 530, TNC 640 and their kin: M91 in each block means the machine datum.

Klartext is absolute, and the unit is said when a program begins and ends. Cycle 9 dwells in seconds where it is
defined. Cycle 4 measures in 3-D along a vector, result from Q1 on, drawn back by MB afterwards. Cycles 8, 10 and 11
without an axis, with 0 and with 1 end mirror image, rotation and scaling (user's manual, cycle programming).

ISG kernel (TwinCAT CNC): with no kinematics, offset or tool, coordinates are the machine's; #TIME waits. G20 ends
mirror images, G52 diameters of a lathe (programming manual; TF5200, turning functions).

How such a control writes what it measured was not to be found out: it has no log.

LinuxCNC 2.8 or later, set up in mm or in inches (RS-274/NGC): G21 and G8 (radii) hold for machine coordinates too.

G53 goes with G1 and holds for its block only; G4 P is in seconds. The length of the tool comes before M428, for with
that in force a new one would move the axes by tens of millimetres. A feed is that of X Y Z, and of the rotary axes
where these stay.

SINUMERIK 840D/828D in its own language, not in ISO mode: SUPA takes every frame out of its block.

G4 F is in seconds. TRANS alone deletes all of the programmable frame: shift, rotation, scale and mirror image, which
would act on a step that is not in machine coordinates. DIAMOF counts radii (programming manual, fundamentals).
"""

from axiscal.language.spoken import later
from axiscal.programs.dialect import LETTERS, Dialect, Log

# A G31 that ends within 3 um of its end has met nothing; a touch is a millimetre and more before it.
_FANUC_MISSED = "IF[ABS[#5061-[{x}]]+ABS[#5062-[{y}]]+ABS[#5063-[{z}]]LT0.003]GOTO9001"
_FANUC_ALARM = "N9000 #3000=1(NOT IN MACHINE COORDINATES)"

FANUC = Dialect(
    title="FANUC",
    suffix="NC",
    decimals=3,
    notes=(
        "Never tried on a control: run it with machine lock and dry run first, then at reduced feed.",
        "G53 would be a rapid here, so moves are G1 in G54. Set G54 and the external offset to zero for every axis "
        "first; custom macro B must be there. The program compares machine and work position after each of "
        "its stops, and ends with alarm 3001 if they differ or if a tool length offset is in force.",
        "The comparison takes the control's first axes, as many as the machine description has: they must be these.",
        "Its head ends polar coordinates (G15), scaling (G50), mirror image (G50.1), rotation and tilted planes (G69): "
        "take out a line whose option the control does not have. No tool centre point control may be in force.",
        "Coordinates have three decimals (IS-B): a reading is where the list says, which may be 0.0005 off the plan.",
        "G61 (exact stop) is in force while the program runs and G64 (cutting mode) after it.",
        "Programs are O1001, O1002 and so on, one for each set-up: rename them where these numbers are taken.",
    ),
    opening=(
        "%",
        "O1{number:03}",
        "IF[#4008NE49]GOTO9000",
        "G21 G90 G94 G17 G40 G49 G80",
        "G15",
        "G50",
        "G50.1 {zeros}",
        "G69",
        "M5",
        "M9",
        "G54",
        "G61",
    ),
    closing=("G64", "M30", _FANUC_ALARM, "%"),
    move="G1 {to} F{feed}",
    dwell=("G4 P{ms}",),
    proof="IF[ABS[#{first}-#{second}]GT0.0005]GOTO9000",
    # 500 mm/min, for blocks that are not to move at all: they come with the place where the machine stands.
    tip_on=("G1 G43.4 {to} H1 F500",),
    tip_off=("G1 G49 {to} F500",),
    tip_decimals=3,
    from_zero=True,
    tip_needs=("IN TOUCH - TOOL POINT ON THE TABLE BY G43.4", "NEEDS G54 AT THE MACHINE ZERO AND THE TOOL IN H1"),
    tip_notes=(
        "G43.4 is an option. The coordinates must be those of the table (parameter 19696 bit 5, WKP = 0) as it stands "
        "when G43.4 comes, which is at zero; bit 6, RFC = 1, makes the feed hold where only rotary axes turn.",
        "H1 must hold the length of the tool as the machine description has it. G43.4 and G49 come with the place "
        "where the machine stands already, so that neither moves an axis.",
    ),
    log=Log(  # a star in DPRNT is a blank
        on=("POPEN", "DPRNT[AXISCAL*LOG*1*PLAN*{code}*MM]"),
        off=(
            "DPRNT[END*{readings}]",
            "PCLOS",
            "GOTO9002",
            "N9001 PCLOS",
            "#3000=2(THE PROBE MET NOTHING)",
            "N9002",
        ),
        touch=(
            "G31 {into} F{fast}",
            _FANUC_MISSED,
            "G91 G1 {back} F{fast}",
            "G90 G31 {into} F{slow}",
            _FANUC_MISSED,
            "DPRNT[R{reading}*T{touch}*X#5061[54]*Y#5062[54]*Z#5063[54]]",
            "{away}",
        ),
        proof="IF[ABS[#{first}-#{second}]GT0.0005]GOTO9003",  # the alarm closes the log first
        closing=("G64", "M30", "N9003 PCLOS", _FANUC_ALARM, "%"),
        notes=(
            "The probing blocks were never tried on a control. G31 takes the skip input; #5061 to #5063 are where it "
            "came, to a thousandth of a millimetre under IS-B, which adds 0.3 um of scatter.",
            "X, Y, Z must be the control's first three axes. DPRNT sends the log to the device of parameter 0020, a "
            "computer on the serial line or a memory card: start receiving before the program.",
        ),
    ),
)
"""By FANUC's manuals; three decimals are those of increment system IS-B."""


_HEIDENHAIN_LOG = "/ TNC:\\AXISCAL\\{code}.TXT"


def _heidenhain_measured(feed: str) -> tuple[str, ...]:
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
        "deg/min and do not take the short way. So must be a scaling of single axes (cycle 26).",
    ),
    opening=(
        "BEGIN PGM {name} MM",
        "CYCL DEF 8.0 MIRROR IMAGE",
        "CYCL DEF 8.1",
        "CYCL DEF 10.0 ROTATION",
        "CYCL DEF 10.1 ROT+0",
        "CYCL DEF 11.0 SCALING",
        "CYCL DEF 11.1 SCL 1",
        "M5",
        "M9",
    ),
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
        on=("FN 16: F-PRINT TNC:\\AXISCAL\\AXHEAD_{code}.A " + _HEIDENHAIN_LOG,),
        off=(
            "FN 0: Q5 = +{readings}",
            "FN 16: F-PRINT TNC:\\AXISCAL\\AXEND.A " + _HEIDENHAIN_LOG,
            "FN 9: IF +0 EQU +0 GOTO LBL 98",
            "LBL 99",
            "; THE PROBE MET NOTHING",
            "STOP",
            "M30",
            "LBL 98",
        ),
        touch=(
            *_heidenhain_measured("{fast}"),
            *_heidenhain_measured("{slow}"),
            "FN 0: Q5 = +{reading}",
            "FN 0: Q6 = +{touch}",
            "FN 16: F-PRINT TNC:\\AXISCAL\\AXTOUCH.A " + _HEIDENHAIN_LOG,
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


ISG = Dialect(
    title="ISG",
    suffix="nc",
    notes=(
        "Never tried on a control: run it in the simulation first, then block by block at reduced feed.",
        "G53 takes out zero offsets, D0 the tool and #TRAFO OFF the kinematics: then coordinates are those of the "
        "axes. No #CS, #ACS, #PSET or scaling may be in force. Without the turning functions take G52 out.",
        "The feed of a block in which only rotary axes move is taken to be in deg/min.",
    ),
    # Without the name a program would be nameless in the control's messages.
    opening=("%AXISCAL{number}", "#TRAFO OFF", "G71 G90 G94 G17 G40 G53 G60 D0", "G20", "G52", "M5 M9"),
    closing=("M30",),
    move="G1 {to} F{feed}",
    dwell=("#TIME {s:.3f}",),
    tip_on=("G53", "D1", "#TRAFO ON"),
    tip_off=("#TRAFO OFF", "D0"),
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


def _linuxcnc_at_zero(label: str, last: int) -> tuple[str, ...]:
    """Return what ends a program where an offset is in force.  last : number of a parameter of G54"""
    offsets = "+".join(f"ABS[#{number}]" for number in (5210, *range(5221, last + 1)))
    return ("G54", f"{label} IF [{offsets} GT 0.00005]", "(MSG, G54 OR G92 IS NOT ZERO)", "M2", f"{label} ENDIF")


def _linuxcnc_missed(label: str) -> tuple[str, ...]:
    """Return what ends a program where nothing was met."""
    said = ("(LOG,MISS R#1 T#2)", "(LOGCLOSE)", "(MSG, THE PROBE MET NOTHING)", "M2")
    return (f"{label} IF [#5070 EQ 0]", *said, f"{label} ENDIF")


_LINUXCNC_TOUCH = (
    "O<axiscal_touch> SUB",
    "G38.3 X#3 Y#4 Z#5 F#12",
    *_linuxcnc_missed("O102"),
    "G91 G1 X#6 Y#7 Z#8",
    "G90 G38.3 X#3 Y#4 Z#5 F#13",
    *_linuxcnc_missed("O103"),
    "(LOG,R#1 T#2 X#5061 Y#5062 Z#5063)",
    "G53 G1 X#9 Y#10 Z#11 F#14",
    "O<axiscal_touch> ENDSUB",
)
"""#1 reading, #2 touch, #3 where it ends if nothing is met, #6 step back, #9 beside the sphere, #12 feeds."""

LINUXCNC = Dialect(
    title="LinuxCNC",
    suffix="ngc",
    screen="(MSG, {text})",
    notes=(
        "Tried on LinuxCNC's own interpreter (rs274), not on a machine.",
        "Coordinates are in mm (G21) and deg, whatever LINEAR_UNITS says: tried with mm and with inch.",
        "Rotary axes must not be WRAPPED_ROTARY, and a five-axis kinematics must be in its joint (identity) mode.",
    ),
    opening=("G8 G21 G90 G94 G17 G40 G49 G80", "M5 M9", "G61"),
    closing=("M2",),
    move="G53 G1 {to} F{feed}",
    dwell=("G4 P{s:.3f}",),
    tip_on=(*_linuxcnc_at_zero("O{label}", 5230), "G43.1 Z{tool}", "M428"),
    tip_off=("M429", "G49"),
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
        on=(*_linuxcnc_at_zero("O101", 5230), *_LINUXCNC_TOUCH, "(LOGAPPEND,axiscal_{code}.txt)", "(LOG,{head})"),
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


_SINUMERIK_FULL = "IF AXERR<>0 GOTOF AXFULL"
_SINUMERIK_MISSED = ("STOPRE", "IF $AC_MEA[1]==0 GOTOF AXMISS")

SINUMERIK = Dialect(
    title="SINUMERIK",
    suffix="MPF",
    notes=(
        "Never tried on a control: run it dry first (program test, DRY), then at reduced feed.",
        "Written for the Siemens language (G291 off). SUPA leaves out every frame, also the handwheel's; D0 takes out "
        "the tool, TRAFOOF the five-axis transformation.",
        "FGROUP names all axes, so that the feed of a turning axis is in deg/min; FGREF is taken to be as delivered.",
    ),
    opening=("TRAFOOF", "G710 G90 G94 G17 G40 G60 D0", "DIAMOF", "TRANS", "M5 M9", "FGROUP({axes})"),
    closing=("M30",),
    move="G1 SUPA {to} F{feed}",
    dwell=("G4 F{s:.3f}",),  # it does not touch the feed of moves
    comment="; {text}",
    screen='MSG("{text}")',
    axes=f"[{LETTERS}]|[XYZUVW][1-9]",  # A2= to C7= are directions of the tool there
    tip_on=("G500", "D1", "TRAORI", "ORIMKS ORIAXES"),
    tip_off=("TRAFOOF", "D0"),
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
        on=('WRITE(AXERR,"_N_AX{code}_MPF","{head}")', _SINUMERIK_FULL),
        off=(
            'WRITE(AXERR,"_N_AX{code}_MPF","END {readings}")',
            _SINUMERIK_FULL,
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
            *_SINUMERIK_MISSED,
            "G91 G1 {back} F{fast}",
            "G90 MEAS=1 G1 SUPA {into} F{slow}",
            *_SINUMERIK_MISSED,
            'WRITE(AXERR,"_N_AX{code}_MPF","R{reading} T{touch}"<<" X"<<$AA_MM[X]<<" Y"<<$AA_MM[Y]<<" Z"<<$AA_MM[Z])',
            _SINUMERIK_FULL,
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
