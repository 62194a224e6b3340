component axiscal_vcomp "Every error of a machine taken away between motion and drives, by the file of one campaign";
description """Made by axiscal, the same for every machine; a campaign brings a text file, read when this is loaded.
It moves the drives behind LinuxCNC's back by what the file says, and takes the same off their feedback.
IT HAS NEVER BEEN RUN ON REAL DRIVES OR ON A REALTIME KERNEL, AND IT IS NO SAFETY FUNCTION.
Loaded with file=NAME units=[TRAJ]LINEAR_UNITS coordinates=[TRAJ]COORDINATES joints=[KINS]JOINTS, belts=1 beside
corexykins; what does not fit together is refused, and LinuxCNC does not start.  uspace only.""";
pin in float pos-#[9] "joint.N.pos-cmd";
pin in float motor-#[9] "joint.N.motor-pos-cmd";
pin out float drive-#[9] "to the drive";
pin in float encoder-#[9] "from the drive";
pin out float feedback-#[9] "to joint.N.motor-pos-fb";
pin in float backlash-#[9] "joint.N.backlash-corr: not zero, COMP_FILE or BACKLASH work as well, fault 3";
pin out float correction-#[9] "what is added now";
pin in bit homed "motion.is-all-homed";
pin in bit powered = 1 "motion.motion-enabled: while it is false positions follow the drives, and no side turns";
pin in bit enable = 0 "switch it on";
pin in bit reset "a rising edge clears a fault and largest";
pin in float tool-x "motion.tooloffset.x";
pin in float tool-y "motion.tooloffset.y";
pin in float tool-z "motion.tooloffset.z; all three and tool-gauge zero: the tool of the campaign";
pin in float tool-gauge "length from the spindle nose to where tool lengths count from";
pin in float ramp-time = 1.0 "s, from nothing to all, at least 0.1";
pin in float deadband = 0.0005 "mm (in an inch configuration too) and deg by which an axis comes back before its side turns";
pin in float scale = 1.0 "share of the correction, 0 to 1";
pin out bit active "all of it is applied";
pin out float gain "share that is applied now";
pin out bit outside "an axis is beyond its calibrated range";
pin out float largest "largest correction of a linear axis that was wanted, also while off";
pin out bit fault "nothing is applied until reset";
pin out signed fault-code "1 over the limit, 2 not finite, 3 COMP_FILE or BACKLASH, 4 the linear axes do not span space";
pin out unsigned checksum "of the file";
function fb "before motion-command-handler: the correction off the feedback";
function cmd "after motion-controller: the correction to the command";
option singleton yes;
option extra_setup yes;
include <stdio.h>;
include <rtapi_math.h>;
include "axiscal_vcomp_core.h";
license "MIT";
author "the axiscal authors";
;;

#define MOST_BYTES 2000000
#define LONGEST 10.0    /* s of a ramp, whatever ramp-time says */
#define FAULT_TIME 1.0  /* s in which the correction goes at a fault, at the most */
#define LOST_TIME 0.1   /* s in which the correction goes when a joint is not homed any more */
#define TOOL_SPEED 100.0 /* mm/s at which the tool vector follows a new length */

static char *file = 0, *units = 0, *coordinates = 0;
static int joints = 0, belts = 0;
RTAPI_MP_STRING(file, "the file of the campaign");
RTAPI_MP_STRING(units, "[TRAJ]LINEAR_UNITS");
RTAPI_MP_STRING(coordinates, "the axis of each joint, as [TRAJ]COORDINATES has them; _ for one of no axis");
RTAPI_MP_INT(joints, "[KINS]JOINTS");
RTAPI_MP_INT(belts, "1: joints 0 and 1 are X + Y and X - Y, as corexykins has them");

static vc_machine machine;
static vc_side side[VC_AXES];
static vc_quintic ramp;
static double wanted[VC_AXES], applied[VC_JOINTS], tip[3];
static int lost = 1, held = 0, reset_before = 0, started = 0;
static char text[MOST_BYTES];

static int refuse(int line, const char *why) {
    if (line) rtapi_print_msg(RTAPI_MSG_ERR, "axiscal_vcomp: %s, line %d: %s\n", file, line, why);
    else rtapi_print_msg(RTAPI_MSG_ERR, "axiscal_vcomp: %s\n", why);
    return -EINVAL;
}

static const char *unit_of(const char *given) {
    if (vc_is(given, "mm") || vc_is(given, "metric")) return "mm";
    if (vc_is(given, "inch") || vc_is(given, "in") || vc_is(given, "imperial")) return "inch";
    return "";
}

static char letter_of(int joint) { /* the axis that COORDINATES gives to a joint */
    const char *p;
    for (p = coordinates; *p; p++) {
        char c = *p;
        if (c == ' ' || c == '\t') continue;
        if (c >= 'a' && c <= 'z') c -= 'a' - 'A';
        if (!joint--) return c;
    }
    return 0;
}

static int fits(void) {
    static char why[200];
    int k, j;
    if (!vc_is(machine.unit, unit_of(units))) {
        rtapi_snprintf(why, sizeof why, "the file is in %s, LINEAR_UNITS is %.20s", machine.unit, units);
        return refuse(0, why);
    }
    if (machine.joints > joints) {
        rtapi_snprintf(why, sizeof why, "the file has joint %d, JOINTS is %d", machine.joints - 1, joints);
        return refuse(0, why);
    }
    for (k = 0; k < machine.axes; k++)
        for (j = 0; j < 2; j++) {
            int joint = machine.axis[k].joint[j];
            if (joint < 0 || letter_of(joint) == machine.axis[k].name) continue;
            rtapi_snprintf(why, sizeof why, "the file has joint %d for %c, COORDINATES is %.40s", joint,
                           machine.axis[k].name, coordinates);
            return refuse(0, why);
        }
    return 0;
}

EXTRA_SETUP() { /* before the pins exist: nothing may be written to them here */
    const char *why;
    int size, line = 0;
    FILE *from;
    (void)__comp_inst; (void)prefix; (void)extra_arg;
    if (!file || !*file) return refuse(0, "file= is missing");
    if (!units || !*units) return refuse(0, "units=[TRAJ]LINEAR_UNITS is missing");
    if (!coordinates || !*coordinates) return refuse(0, "coordinates=[TRAJ]COORDINATES is missing");
    if (joints <= 0) return refuse(0, "joints=[KINS]JOINTS is missing");
    if (!(from = fopen(file, "rb"))) return refuse(1, "the file cannot be opened");
    size = (int)fread(text, 1, MOST_BYTES, from);
    fclose(from);
    if (size == MOST_BYTES) return refuse(1, "the file is too long");
    if ((why = vc_read(&machine, text, size, &line))) return refuse(line, why);
    return fits();
}

FUNCTION(fb) {
    int j;
    for (j = 0; j < VC_JOINTS; j++) feedback(j) = encoder(j) - applied[j];
}

static double length_unit(void) { return machine.unit[0] == 'm' ? 1 : 1 / 25.4; }

static int follow_tool(double x, double y, double z, double gauge, int at_once, double dt) {
    double to[3], away[3], far, step = TOOL_SPEED * length_unit() * dt;
    int i, none = x == 0 && y == 0 && z == 0 && gauge == 0;
    to[0] = -x; to[1] = -y; to[2] = -z - gauge;
    for (i = 0; i < 3; i++) {
        if (none) to[i] = machine.tool[i];
        if (!vc_finite(to[i])) return VC_NOT_FINITE;
        away[i] = to[i] - tip[i];
    }
    far = sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
    for (i = 0; i < 3; i++) tip[i] = at_once || far <= step ? to[i] : tip[i] + away[i] * (step / far);
    return VC_FINE;
}

static void forget(void) {
    int k;
    for (k = 0; k < VC_AXES; k++) {
        static const vc_side nothing;
        side[k] = nothing;
    }
}

FUNCTION(cmd) {
    double dt = period * 1e-9, pose[VC_AXES], way[VC_AXES], out[VC_AXES], now, rate, bend, to, length, band = deadband;
    int k, j, code = VC_FINE, beyond = 0, over = 0;
    if (!started) {
        tip[0] = machine.tool[0]; tip[1] = machine.tool[1]; tip[2] = machine.tool[2];
        started = 1;
        checksum = machine.hash;
    }
    if (!(band >= 0)) band = 0.0005;
    if (reset && !reset_before) { fault = 0; fault_code = VC_FINE; largest = 0; }
    reset_before = reset;
    now = vc_quintic_at(&ramp, &rate, &bend);
    if (!homed) lost = 1;
    if (now == 0 && ramp.target == 0) {
        held = 0;
        if (lost) forget();
        if (homed) lost = 0;
    }
    for (j = 0; j < VC_JOINTS; j++) if (backlash(j) != 0) code = VC_OTHER_TABLES;
    if (!lost) { /* a coordinate that jumps while its joint is homed is not looked at: what is applied only fades */
        for (k = 0; k < machine.axes; k++) {
            vc_axis *a = &machine.axis[k];
            pose[k] = belts && a->joint[0] < 2 ? (pos(0) + (a->joint[0] ? -pos(1) : pos(1))) / 2 : pos(a->joint[0]);
            way[k] = powered ? vc_side_of(&side[k], pose[k], a->rotary ? band : band * length_unit(), a->seconds, dt)
                             : vc_side_kept(&side[k], pose[k], dt);
        }
        j = follow_tool(tool_x, tool_y, tool_z, tool_gauge, now == 0, dt);
        if (!j) j = vc_correction(&machine, pose, way, tip, out, &beyond);
        outside = beyond != 0;
        if (j) { code = j; held = 1; }
        for (k = 0; k < machine.axes && !held; k++) {
            double most = machine.axis[k].rotary ? machine.limit_deg : machine.limit;
            if (!machine.axis[k].rotary && vc_abs(out[k]) > largest) largest = vc_abs(out[k]);
            if (vc_abs(out[k]) > most) { over = 1; out[k] = out[k] < 0 ? -most : most; }
            wanted[k] = out[k];
        }
        if (over && enable && !code) code = VC_OVER;
    }
    if (code && !fault) { fault = 1; fault_code = code; }
    to = scale;
    if (!(to >= 0)) to = 0;
    if (to > 1) to = 1;
    if (lost || held || fault || !enable) to = 0;
    length = ramp_time;
    if (!(length >= LOST_TIME)) length = LOST_TIME;
    if (length > LONGEST) length = LONGEST;
    if ((fault || held) && length > FAULT_TIME) length = FAULT_TIME;
    if (lost) length = LOST_TIME;
    if (to != ramp.target || (lost && now != 0 && ramp.length - ramp.clock > LOST_TIME)) vc_quintic_to(&ramp, to, length);
    ramp.clock += dt;
    now = vc_quintic_at(&ramp, &rate, &bend);
    if (now > 1) now = 1; /* a ramp that was turned round while it was fast swings over */
    if (now < 0) now = 0;
    gain = now;
    active = now == 1 && ramp.target == 1;
    for (j = 0; j < VC_JOINTS; j++) applied[j] = 0;
    for (k = 0; k < machine.axes; k++)
        for (j = 0; j < 2; j++)
            if (machine.axis[k].joint[j] >= 0) applied[machine.axis[k].joint[j]] = now * wanted[k];
    if (belts) { to = applied[0]; applied[0] = to + applied[1]; applied[1] = to - applied[1]; }
    for (j = 0; j < VC_JOINTS; j++) {
        correction(j) = applied[j];
        drive(j) = motor(j) + applied[j];
    }
}
