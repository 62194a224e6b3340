/* The component's core as a library, so that tests can call it. */
#include <math.h>
#include <string.h>
#include "axiscal_vcomp_core.h"

static vc_machine machine;

const char *load(const char *text, int size, int *line) {
    memset(&machine, 0, sizeof machine);
    return vc_read(&machine, text, size, line);
}


/* joints, ways, out : (count, axes) row by row; round 1 alone where once is set */
void correct(int count, const double *joints, const double *ways, const double *tool, int once, double *out, int *fault,
             int *outside) {
    int i, k, n = machine.axes;
    for (i = 0; i < count; i++) {
        outside[i] = 0;
        if (once) {
            double t[VC_AXES], w[VC_AXES];
            for (k = 0; k < n; k++) {
                t[k] = machine.axis[k].sense * joints[i * n + k];
                w[k] = machine.axis[k].sense * ways[i * n + k];
            }
            fault[i] = vc_once(&machine, t, w, tool, out + i * n, outside + i);
            for (k = 0; k < n; k++) out[i * n + k] *= machine.axis[k].sense;
        } else
            fault[i] = vc_correction(&machine, joints + i * n, ways + i * n, tool, out + i * n, outside + i);
    }
}

/* the side of an axis along positions, with drives and without */
void sides(int count, const double *at, const double *powered, double band, double seconds, double period, double *out) {
    vc_side side;
    int i;
    memset(&side, 0, sizeof side);
    for (i = 0; i < count; i++)
        out[i] = powered[i] ? vc_side_of(&side, at[i], band, seconds, period) : vc_side_kept(&side, at[i], period);
}

/* a gain that is sent to targets, each from its own step on */
void gains(int count, const double *targets, double length, double period, double *out) {
    vc_quintic q;
    double rate, bend;
    int i;
    memset(&q, 0, sizeof q);
    for (i = 0; i < count; i++) {
        if (targets[i] != q.target) vc_quintic_to(&q, targets[i], length);
        q.clock += period;
        out[i] = vc_quintic_at(&q, &rate, &bend);
    }
}
