/* The plugin in a host without drives, which moves as grblHAL's mc_line() does, so that tests can call it. */
#include <stdlib.h>
#include "axiscal_grblhal.c"

static coord_data_t stand; /* where the drives are planned to be */
static char said[200];

static void listen(const char *text) { strncat(said, text, sizeof said - strlen(said) - 1); }

static void nothing(bool newopt) { (void)newopt; }

coord_data_t *limits_homing_pulloff(coord_data_t *distance)
{
    static coord_data_t off;
    if (distance) off = *distance;
    return &off;
}

/* As the core's own: of drives it can say nothing, so it says no. */
static bool inside(float *target, axes_signals_t axes, bool is_cartesian, work_envelope_t *envelope)
{
    int i;
    bool good = is_cartesian;
    for (i = 0; i < N_AXIS; i++)
        if (axes.mask & bit(i) && (target[i] < envelope->min.values[i] || target[i] > envelope->max.values[i])) good = false;
    return good;
}

/* steps : of each axis in a mm or deg; returns what $I says */
const char *start(const double *steps)
{
    int i;
    for (i = 0; i < N_AXIS; i++) settings.axis[i].steps_per_mm = (float)steps[i];
    grbl.check_travel_limits = inside;
    memset(&stand, 0, sizeof stand);
    said[0] = 0;
    hal.stream.write = listen;
    grbl.on_report_options = nothing;
    my_plugin_init();
    grbl.on_report_options(false);
    return said;
}

/* Go on a line; returns in how many parts, each written to parts, (most, N_AXIS).  rates : of each part
   checked : where soft limits looked; cancel : after so many parts the jog is cancelled */
int go(const double *to, int rapid, int inverse, int cancel_after, int most, double *parts, double *rates, double *checked)
{
    plan_line_data_t line = {.feed_rate = 100.0f, .condition = {.rapid_motion = rapid, .inverse_time = inverse}};
    coord_data_t target, *drives;
    float feed_rate = line.feed_rate;
    int i, count = 0;
    for (i = 0; i < N_AXIS; i++) target.values[i] = (float)to[i];
    drives = kinematics.segment_line(&target, &stand, &line, true);
    for (i = 0; i < N_AXIS; i++) checked[i] = drives->values[i];
    while (count < most && kinematics.segment_line(drives, NULL, &line, false)) {
        for (i = 0; i < N_AXIS; i++) parts[count * N_AXIS + i] = drives->values[i];
        rates[count++] = line.feed_rate;
        stand = *drives;
        line.feed_rate = feed_rate;
        if (count == cancel_after) grbl.on_jog_cancel(0);
    }
    return count;
}

/* The position that is shown where the drives stand, to the nearest step. */
void shown(double *place)
{
    mpos_t steps;
    coord_data_t found;
    int i;
    for (i = 0; i < N_AXIS; i++) steps.values[i] = (int32_t)lround(stand.values[i] * settings.axis[i].steps_per_mm);
    kinematics.transform_steps_to_cartesian(&found, &steps);
    for (i = 0; i < N_AXIS; i++) place[i] = found.values[i];
}

/* Home axes; the others get no step, but the planner counts where they are sent.  travel, off : of each axis, negative
   and positive; down : whether axes home at their lower end; returns how many steps the others were sent */
int home(int mask, double travel, double off, int down, int origin)
{
    axes_signals_t cycle = {.mask = (uint8_t)mask};
    mpos_t steps;
    coord_data_t target, drives, pulloff;
    int i, sent = 0;
    for (i = 0; i < N_AXIS; i++) {
        settings.axis[i].max_travel = (float)travel;
        pulloff.values[i] = (float)off;
        sys.position[i] = steps.values[i] = (int32_t)lround(stand.values[i] * settings.axis[i].steps_per_mm);
    }
    settings.homing.dir_mask.mask = down ? cycle.mask : 0;
    settings.homing.flags.force_set_origin = origin;
    limits_homing_pulloff(&pulloff);
    kinematics.transform_steps_to_cartesian(&target, &steps);
    for (i = 0; i < N_AXIS; i++)
        if (cycle.mask & bit(i)) {
            kinematics.limits_set_target_pos((uint_fast8_t)i);
            target.values[i] = (float)travel * 1.5f;
        }
    kinematics.transform_from_cartesian(&drives, &target);
    for (i = 0; i < N_AXIS; i++)
        if (!(cycle.mask & bit(i)))
            sent += abs((int)lroundf(drives.values[i] * settings.axis[i].steps_per_mm) - sys.position[i]);
    kinematics.limits_set_machine_positions(cycle);
    for (i = 0; i < N_AXIS; i++) stand.values[i] = (float)sys.position[i] / settings.axis[i].steps_per_mm;
    return sent;
}

/* Whether soft limits let a place of the drives pass, all ends as given. */
int passes(const double *drives, double low, double high)
{
    float target[N_AXIS];
    work_envelope_t ends;
    axes_signals_t all = {.mask = (uint8_t)((1u << N_AXIS) - 1)};
    int i;
    for (i = 0; i < N_AXIS; i++) {
        target[i] = (float)drives[i];
        ends.min.values[i] = (float)low;
        ends.max.values[i] = (float)high;
    }
    return grbl.check_travel_limits(target, all, false, &ends);
}
