/* axiscal in grblHAL: every error of a machine taken away between motion and steps, by the table of one campaign.
 *
 * Part of axiscal. It has never been run on real drives, and it is no safety function.
 * SPDX-License-Identifier: MIT
 *
 * It stands beside my_plugin.c of a driver whose core is from 2026 or later, built with KINEMATICS_API.
 */
#include <math.h>
#include <string.h>
#include "grbl/hal.h"
#include "grbl/machine_limits.h"
#include "grbl/planner.h"
#include "grbl/kinematics/interface.h"
#include "axiscal_table.h"
#include "axiscal_vcomp_core.h"

#define SEGMENT 2.0    /* mm or deg at the most: between its ends the correction goes straight, curves bend in tens of mm */
#define ROUNDS 4       /* back from the drives: each leaves 1e-3 of the last */
#define DEAD 0.0005    /* mm or deg that turn no side */

static vc_machine machine;
static double way[VC_AXES];    /* the side from which each axis came, 0 where it has not moved since homing */
static const char *refused;    /* why nothing is corrected, 0 where it is */
static bool stopped;
static coord_data_t apart;     /* of drives beside the place, when that was asked for last */
static travel_limits_ptr check_travel_limits;
static on_jog_cancel_ptr on_jog_cancel;
static on_report_options_ptr on_report_options;

static double held(double x, double limit) { return x > limit ? limit : x < -limit ? -limit : x; }

/* Where the drives go for a place of the machine. */
static coord_data_t *to_drives(coord_data_t *drives, coord_data_t *place)
{
    double at[VC_AXES], added[VC_AXES];
    int k, outside;
    memmove(drives, place, sizeof(coord_data_t));
    for (k = 0; k < machine.axes; k++) at[k] = place->values[machine.axis[k].joint[0]];
    if (refused || vc_correction(&machine, at, way, machine.tool, added, &outside)) return drives;
    for (k = 0; k < machine.axes; k++)
        drives->values[machine.axis[k].joint[0]] +=
            (float)held(added[k], machine.axis[k].rotary ? machine.limit_deg : machine.limit);
    return drives;
}

/* The place of the machine where its drives stand. */
static coord_data_t *to_place(coord_data_t *place, coord_data_t *drives)
{
    coord_data_t there, stand = *drives;
    int i, round;
    *place = stand;
    for (round = 0; round < ROUNDS; round++) {
        to_drives(&there, place);
        for (i = 0; i < N_AXIS; i++) place->values[i] += stand.values[i] - there.values[i];
    }
    return place;
}

static coord_data_t *steps_to_place(coord_data_t *place, mpos_t *steps)
{
    coord_data_t drives;
    int i;
    for (i = 0; i < N_AXIS; i++) drives.values[i] = (float)steps->values[i] / settings.axis[i].steps_per_mm;
    to_place(place, &drives);
    for (i = 0; i < N_AXIS; i++) apart.values[i] = drives.values[i] - place->values[i];
    return place;
}

/* Where the drives go in homing, which asks for its place before it moves: what is added stays. An axis that is not in
 * the cycle gets no step, yet each would be counted. */
static coord_data_t *homing_drives(coord_data_t *drives, coord_data_t *place)
{
    int i;
    for (i = 0; i < N_AXIS; i++) drives->values[i] = place->values[i] + apart.values[i];
    return drives;
}

/* Soft limits hold for drives as they do for places: the firmware's own test lets no drive pass. */
static bool within_travel(float *target, axes_signals_t axes, bool is_cartesian, work_envelope_t *envelope)
{
    (void)is_cartesian;
    return check_travel_limits(target, axes, true, envelope);
}

/* A line in parts.  First its end, at which soft limits look, then one part after the other, and NULL. */
static coord_data_t *segment_line(coord_data_t *target, coord_data_t *position, plan_line_data_t *line, bool init)
{
    static coord_data_t end, step, drives;
    static uint_fast16_t count, left;
    coord_data_t part;
    double longest = 0;
    int i, k;
    if (init) {
        stopped = false;
        end = *target;
        to_place(&part, position);
        for (i = 0; i < N_AXIS; i++) {
            step.values[i] = end.values[i] - part.values[i];
            if (fabs(step.values[i]) > longest) longest = fabs(step.values[i]);
        }
        for (k = 0; k < machine.axes; k++) {
            float moved = step.values[machine.axis[k].joint[0]];
            if (fabs(moved) > DEAD) way[k] = moved > 0 ? 1 : -1;
        }
        left = count = line->condition.rapid_motion || longest <= SEGMENT ? 1 : (uint_fast16_t)ceil(longest / SEGMENT);
        for (i = 0; i < N_AXIS; i++) step.values[i] /= (float)count;
        return to_drives(&drives, &end);
    }
    if (stopped || !left) return NULL;
    left--;
    for (i = 0; i < N_AXIS; i++) part.values[i] = end.values[i] - (float)left * step.values[i];
    if (line->condition.inverse_time) line->feed_rate *= (float)count;
    return to_drives(&drives, &part);
}

static uint_fast8_t axis_mask(uint_fast8_t i) { return bit(i); }

static void home_position(uint_fast8_t i) { sys.position[i] = 0; }

/* As the firmware does without kinematics; with them it has no function for it. */
static void homed(axes_signals_t cycle)
{
    coord_data_t *off = limits_homing_pulloff(NULL);
    int i, k;
    for (i = 0; i < N_AXIS; i++) {
        bool low = settings.homing.dir_mask.mask & bit(i);
        float end = low ? settings.axis[i].max_travel + off->values[i] : -off->values[i];
        if (!(cycle.mask & bit(i))) continue;
        sys.home_position[i] = settings.homing.flags.force_set_origin ? 0.0f : end;
        sys.position[i] = lroundf(sys.home_position[i] * settings.axis[i].steps_per_mm);
    }
    for (k = 0; k < machine.axes; k++)
        if (cycle.mask & bit(machine.axis[k].joint[0])) way[k] = 0;
}

static bool any_cycle(axes_signals_t cycle) { (void)cycle; return true; }

static float own_rate(axes_signals_t axes, float rate, homing_mode_t mode) { (void)axes; (void)mode; return rate; }

static void cancel(sys_state_t state)
{
    stopped = true;
    if (on_jog_cancel) on_jog_cancel(state);
}

static void report(bool newopt)
{
    on_report_options(newopt);
    if (newopt) return;
    hal.stream.write("[KINEMATICS:axiscal ");
    hal.stream.write(refused ? "OFF: " : machine.campaign);
    hal.stream.write(refused ? refused : "");
    hal.stream.write("]" ASCII_EOL);
}

void my_plugin_init(void)
{
    int line, k;
    refused = vc_read(&machine, AXISCAL_TABLE, sizeof(AXISCAL_TABLE) - 1, &line);
    for (k = 0; k < machine.axes && !refused; k++)
        if (machine.axis[k].joint[0] < 0 || machine.axis[k].joint[0] >= N_AXIS) refused = "an axis is not built in";
    if (refused) machine.axes = 0;
    kinematics.transform_from_cartesian = homing_drives;
    kinematics.transform_steps_to_cartesian = steps_to_place;
    kinematics.segment_line = segment_line;
    kinematics.limits_get_axis_mask = axis_mask;
    kinematics.limits_set_target_pos = home_position;
    kinematics.limits_set_machine_positions = homed;
    kinematics.homing_cycle_validate = any_cycle;
    kinematics.homing_cycle_get_feedrate = own_rate;
    check_travel_limits = grbl.check_travel_limits;
    grbl.check_travel_limits = within_travel;
    on_jog_cancel = grbl.on_jog_cancel;
    grbl.on_jog_cancel = cancel;
    on_report_options = grbl.on_report_options;
    grbl.on_report_options = report;
}
