"""FANUC milling controls (G-code of the M series) with custom macro B: moves are G1 in G54, for G53 is always a rapid.

The program proves that G54 is the machine's zero. Variable #4008 is the tool length offset in force (B-63944EN, system
variables). Variable #5021… is the machine position of each axis, #5041… its position in the work coordinates in force.
They agree for every axis if G54 is the machine's zero. A stop may change offsets, and jogging with manual absolute off
shifts them. So the proof follows every M0, which also ends reading ahead. G49 alone may move an axis, so it must be in
force. In cutting mode (G64) a block begins while the one before still brakes: an overrun would be cut short. G4 P is a
whole number of milliseconds.
"""

from axiscal.programs.dialect import Dialect, Log

# A G31 that ends within 3 um of its end has met nothing; a touch is a millimetre and more before it.
_MISSED = "IF[ABS[#5061-[{x}]]+ABS[#5062-[{y}]]+ABS[#5063-[{z}]]LT0.003]GOTO9001"
_ALARM = "N9000 #3000=1(NOT IN MACHINE COORDINATES)"

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
        "No rotation, scaling, mirror image, tilted plane or tool centre point control may be in force.",
        "Coordinates have three decimals (IS-B): a reading is where the list says, which may be 0.0005 off the plan.",
        "G61 (exact stop) is in force while the program runs and G64 (cutting mode) after it.",
        "Programs are O1001, O1002 and so on, one for each set-up: rename them where these numbers are taken.",
    ),
    opening=(
        "%",
        "O1{number:03}",
        "IF[#4008NE49]GOTO9000",
        "G21 G90 G94 G17 G40 G49 G80",
        "M5",
        "M9",
        "G54",
        "G61",
    ),
    closing=("G64", "M30", _ALARM, "%"),
    move="G1 {to} F{feed}",
    dwell=("G4 P{ms}",),
    proof="IF[ABS[#{first}-#{second}]GT0.0005]GOTO9000",
    # 500 mm/min, for blocks that are not to move at all: they come with the place where the machine stands.
    tip_on=("G1 G43.4 {to} H1 F500",),
    tip_off=("G1 G49 {to} F500",),
    tip_move="G1 {to} F{feed}",
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
            _MISSED,
            "G91 G1 {back} F{fast}",
            "G90 G31 {into} F{slow}",
            _MISSED,
            "DPRNT[R{reading}*T{touch}*X#5061[54]*Y#5062[54]*Z#5063[54]]",
            "{away}",
        ),
        proof="IF[ABS[#{first}-#{second}]GT0.0005]GOTO9003",  # the alarm closes the log first
        closing=("G64", "M30", "N9003 PCLOS", _ALARM, "%"),
        notes=(
            "The probing blocks were never tried on a control. G31 takes the skip input; #5061 to #5063 are where it "
            "came, to a thousandth of a millimetre under IS-B, which adds 0.3 um of scatter.",
            "X, Y, Z must be the control's first three axes. DPRNT sends the log to the device of parameter 0020, a "
            "computer on the serial line or a memory card: start receiving before the program.",
        ),
    ),
)
"""By FANUC's manuals; three decimals are those of increment system IS-B."""
