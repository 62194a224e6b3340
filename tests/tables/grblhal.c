/* The plugin in a host without drives, which moves as grblHAL's mc_line() does, so that tests can call it. */
#include "axiscal_grblhal.c"

static coord_data_t stand; /* where the drives are planned to be */
static char said[200];

static void listen(const char *text) { strncat(said, text, sizeof said - strlen(said) - 1); }

static void nothing(bool newopt) { (void)newopt; }

void limits_set_machine_positions(axes_signals_t cycle, bool add_pulloff)
{
    int i;
    for (i = 0; i < N_AXIS; i++)
        if (add_pulloff && cycle.mask & bit(i)) sys.position[i] = 0;
}

/* steps : of each axis in a mm or deg; returns what $I says */
const char *start(const double *steps)
{
    int i;
    for (i = 0; i < N_AXIS; i++) settings.axis[i].steps_per_mm = (float)steps[i];
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

void home(int mask)
{
    axes_signals_t cycle = {.mask = (uint8_t)mask};
    kinematics.limits_set_machine_positions(cycle);
}
