/* The whole correction of a machine as a function of its joints: the file, the chain, the curves, the ways of change.
 *
 * Part of axiscal. It has never been run on real drives or on a realtime kernel, and it is no safety function.
 * Units: those of the configuration, mm or inch, deg for the position of a rotary axis, rad for errors that turn.
 * SPDX-License-Identifier: MIT
 */
#ifndef AXISCAL_VCOMP_CORE_H
#define AXISCAL_VCOMP_CORE_H

#ifndef VC_AXES /* a controller of little memory says how many its table has */
#define VC_AXES 6
#define VC_KNOTS 96
#endif
#define VC_JOINTS 9
#define VC_CURVES 12
#define VC_LEAST_DET 0.2
#define VC_FADE_MM 5.0
#define VC_FADE_DEG 5.0
#define VC_PER_DEG 0.017453292519943295

enum { VC_FINE = 0, VC_OVER = 1, VC_NOT_FINITE = 2, VC_OTHER_TABLES = 3, VC_NO_SPACE = 4 };

typedef struct {
    char name;
    int along, rotary, side, sense, joint[2];
    double origin[3], place[6], tilt[3];
    int knots, cyclic, reverses;
    double seconds;
    double knot[VC_KNOTS], curve[VC_KNOTS][VC_CURVES][4];
    int last; /* the interval in which the last position lay */
} vc_axis;

typedef struct {
    char campaign[20], unit[8];
    double limit, limit_deg, tool[3], fade;
    unsigned hash;
    int axes, joints;
    vc_axis axis[VC_AXES];
} vc_machine;

static double vc_abs(double x) { return x < 0 ? -x : x; }
static int vc_finite(double x) { return x - x == 0; }

/* ---- the file: every line is expected, nothing is skipped but lines of comment ---- */

typedef struct {
    const char *at, *line, *end;
    char word[32];
    const char *why;
    int number;
} vc_text;

static int vc_refuse(vc_text *t, const char *why) {
    if (!t->why) t->why = why;
    return 0;
}

static int vc_next(vc_text *t) { /* the next line that is no comment; at is behind its beginning */
    const char *p;
    do {
        if (t->line == t->end) return vc_refuse(t, "the file ends too early");
        t->at = t->line;
        for (p = t->line; p < t->end && *p != '\n'; p++)
            if (*p < 32 || *p > 126) return vc_refuse(t, "a character that is not plain text (line ends must be LF)");
        if (p == t->end) return vc_refuse(t, "the last line has no end");
        t->line = p + 1;
        t->number++;
    } while (*t->at == '#');
    return 1;
}

static int vc_word(vc_text *t) { /* the next word of the line, words are one blank apart */
    int n = 0;
    if (t->why || *t->at == '\n') return vc_refuse(t, "a line has too few words");
    while (*t->at != '\n' && *t->at != ' ') {
        if (n == 31) return vc_refuse(t, "a word is too long");
        t->word[n++] = *t->at++;
    }
    if (!n) return vc_refuse(t, "words are more than a blank apart");
    t->word[n] = 0;
    if (*t->at == ' ') {
        t->at++;
        if (*t->at == '\n') return vc_refuse(t, "a blank ends a line");
    }
    return 1;
}

static int vc_is(const char *a, const char *b) {
    while (*a && *a == *b) a++, b++;
    return *a == *b;
}

static int vc_key(vc_text *t, const char *key) {
    return vc_word(t) && (vc_is(t->word, key) || vc_refuse(t, "a line is not the one that is expected"));
}

static int vc_number(vc_text *t, double *value) { /* digits, a point, an exponent: no locale, no hexadecimal, no nan */
    const char *p;
    double mantissa = 0, sign = 1;
    int exponent = 0, shift = 0, digits = 0, negative = 0;
    if (!vc_word(t)) return 0;
    p = t->word;
    if (*p == '-') sign = -1, p++;
    for (; *p >= '0' && *p <= '9'; p++, digits++) mantissa = mantissa * 10 + (*p - '0');
    if (*p == '.')
        for (p++; *p >= '0' && *p <= '9'; p++, digits++, shift--) mantissa = mantissa * 10 + (*p - '0');
    if (!digits) return vc_refuse(t, "a word is not a finite number");
    if (*p == 'e') {
        p++;
        if (*p == '-' || *p == '+') negative = *p++ == '-';
        if (*p < '0' || *p > '9') return vc_refuse(t, "a word is not a finite number");
        for (; *p >= '0' && *p <= '9' && exponent < 1000; p++) exponent = exponent * 10 + (*p - '0');
    }
    if (*p) return vc_refuse(t, "a word is not a finite number");
    shift += negative ? -exponent : exponent;
    /* within a few units of the last place of a double: the file has twelve digits */
    if (shift < -280 || shift > 280) return vc_refuse(t, "a number is too large or too small");
    {
        double power = 1, base = 10;
        int n = shift < 0 ? -shift : shift;
        for (; n; n >>= 1, base *= base)
            if (n & 1) power *= base;
        mantissa = shift < 0 ? mantissa / power : mantissa * power;
    }
    *value = sign * mantissa;
    return vc_finite(*value) || vc_refuse(t, "a word is not a finite number");
}

static int vc_whole(vc_text *t, int *value, int low, int high) {
    double x;
    if (!vc_number(t, &x)) return 0;
    *value = (int)x;
    return (x == *value && *value >= low && *value <= high) || vc_refuse(t, "a whole number is out of range");
}

static int vc_numbers(vc_text *t, double *values, int n) {
    int i;
    for (i = 0; i < n; i++)
        if (!vc_number(t, values + i)) return 0;
    return *t->at == '\n' || vc_refuse(t, "a line has too many words");
}

static int vc_line_end(vc_text *t) { return *t->at == '\n' || vc_refuse(t, "a line has too many words"); }

static unsigned vc_fnv(const char *from, const char *to) {
    unsigned hash = 2166136261u;
    for (; from < to; from++) hash = (hash ^ (unsigned char)*from) * 16777619u;
    return hash;
}

static int vc_axis_line(vc_text *t, vc_axis *a) {
    if (!vc_next(t) || !vc_key(t, "axis") || !vc_word(t)) return 0;
    a->name = t->word[0];
    if (t->word[1] || a->name < 'A' || a->name > 'Z') return vc_refuse(t, "an axis is not one capital letter");
    if (!vc_word(t)) return 0;
    a->along = t->word[0] - 'x';
    if (t->word[1] || a->along < 0 || a->along > 2) return vc_refuse(t, "an axis goes along or about x, y or z");
    return vc_key(t, "rotary") && vc_whole(t, &a->rotary, 0, 1) && vc_key(t, "side") && vc_whole(t, &a->side, -1, 1) &&
           (a->side || vc_refuse(t, "side is 1 or -1")) && vc_key(t, "sense") && vc_whole(t, &a->sense, -1, 1) &&
           (a->sense || vc_refuse(t, "sense is 1 or -1")) && vc_key(t, "joints") &&
           vc_whole(t, a->joint, 0, VC_JOINTS - 1) && vc_whole(t, a->joint + 1, -1, VC_JOINTS - 1) && vc_line_end(t);
}

static int vc_knots(vc_text *t, vc_axis *a) {
    int i, c, curves;
    if (!vc_next(t) || !vc_key(t, "knots") || !vc_whole(t, &a->knots, 2, VC_KNOTS) || !vc_key(t, "cyclic") ||
        !vc_whole(t, &a->cyclic, 0, 1) || !vc_key(t, "reversal") || !vc_whole(t, &a->reverses, 0, 1) ||
        !vc_number(t, &a->seconds) || !vc_line_end(t))
        return 0;
    if (a->seconds < 0.001 || a->seconds > 10) return vc_refuse(t, "a reversal takes 1 ms to 10 s");
    curves = a->reverses ? VC_CURVES : VC_CURVES / 2;
    for (i = 0; i < a->knots; i++) {
        if (!vc_next(t) || !vc_key(t, "knot") || !vc_numbers(t, a->knot + i, 1)) return 0;
        if (i && !(a->knot[i] > a->knot[i - 1])) return vc_refuse(t, "knots do not increase");
        for (c = 0; c < curves && i < a->knots - 1; c++)
            if (!vc_next(t) || !vc_numbers(t, a->curve[i][c], 4)) return 0;
    }
    if (a->cyclic && (!a->rotary || vc_abs(a->knot[a->knots - 1] - a->knot[0] - 360) > 1e-6))
        return vc_refuse(t, "a cyclic axis turns by 360 deg");
    return 1;
}

static int vc_read_axis(vc_text *t, vc_axis *a) {
    int i;
    if (!vc_axis_line(t, a)) return 0;
    if (!vc_next(t) || !vc_key(t, "origin") || !vc_numbers(t, a->origin, 3)) return 0;
    if (!vc_next(t) || !vc_key(t, "location") || !vc_numbers(t, a->place, 6)) return 0;
    if (!vc_next(t) || !vc_key(t, "travel-tilt") || !vc_numbers(t, a->tilt, 3)) return 0;
    for (i = 0; i < 3 && a->rotary; i++)
        if (a->tilt[i]) return vc_refuse(t, "a rotary axis has no tilt of its travel");
    return vc_knots(t, a);
}

static int vc_count_joints(vc_text *t, vc_machine *m) {
    int seen[VC_JOINTS] = {0}, k, j;
    m->joints = 0; /* up to the last of them: what moves nothing of the chain passes through as it is */
    for (k = 0; k < m->axes; k++)
        for (j = 0; j < 2; j++)
            if (m->axis[k].joint[j] >= 0) {
                if (seen[m->axis[k].joint[j]]++) return vc_refuse(t, "a joint number is given twice");
                if (m->axis[k].joint[j] >= m->joints) m->joints = m->axis[k].joint[j] + 1;
            }
    return 1;
}

/* Read a file; returns 0, or the sentence that says why it is refused. */
static const char *vc_read(vc_machine *m, const char *from, int size, int *line) {
    vc_text t = {from, from, from + size, "", 0, 0};
    char hash[9];
    int k, linear = 0, i;
    if (!(vc_next(&t) && vc_key(&t, "axiscal-vcomp") && vc_whole(&t, &k, 1, 1) && vc_line_end(&t))) goto out;
    if (!(vc_next(&t) && vc_key(&t, "campaign") && vc_word(&t) && vc_line_end(&t))) goto out;
    for (i = 0; i < 19 && t.word[i]; i++) m->campaign[i] = t.word[i];
    m->campaign[i] = 0;
    if (!(vc_next(&t) && vc_key(&t, "units") && vc_word(&t) && vc_line_end(&t))) goto out;
    if (!vc_is(t.word, "mm") && !vc_is(t.word, "inch")) { vc_refuse(&t, "units are mm or inch"); goto out; }
    for (i = 0; i < 7 && t.word[i]; i++) m->unit[i] = t.word[i];
    m->unit[i] = 0;
    m->fade = vc_is(m->unit, "mm") ? VC_FADE_MM : VC_FADE_MM / 25.4;
    if (!(vc_next(&t) && vc_key(&t, "limits") && vc_number(&t, &m->limit) && vc_numbers(&t, &m->limit_deg, 1))) goto out;
    if (m->limit <= 0 || m->limit_deg <= 0) { vc_refuse(&t, "limits are above zero"); goto out; }
    if (!(vc_next(&t) && vc_key(&t, "tool") && vc_numbers(&t, m->tool, 3))) goto out;
    if (!(vc_next(&t) && vc_key(&t, "axes") && vc_whole(&t, &m->axes, 2, VC_AXES) && vc_line_end(&t))) goto out;
    for (k = 0; k < m->axes; k++) {
        if (!vc_read_axis(&t, &m->axis[k])) goto out;
        linear += !m->axis[k].rotary;
    }
    if (linear != 2 && linear != 3) { vc_refuse(&t, "two or three axes have to be linear"); goto out; }
    if (!vc_count_joints(&t, m)) goto out;
    m->hash = vc_fnv(from, t.line);
    if (!(vc_next(&t) && vc_key(&t, "end") && vc_word(&t) && vc_line_end(&t))) goto out;
    for (i = 0; i < 8; i++) hash[i] = "0123456789abcdef"[(m->hash >> (28 - 4 * i)) & 15];
    hash[8] = 0;
    if (!vc_is(t.word, hash)) vc_refuse(&t, "the checksum is wrong: the file was changed");
    if (t.line != t.end) vc_refuse(&t, "something stands behind the end");
out:
    *line = t.number;
    return t.why;
}

/* ---- curves ---- */

static int vc_interval(vc_axis *a, double t) {
    int low = 0, high = a->knots - 2, middle, i = a->last;
    if (t >= a->knot[i] && t < a->knot[i + 1]) return i;
    while (low < high) {
        middle = (low + high + 1) / 2;
        if (t >= a->knot[middle]) low = middle;
        else high = middle - 1;
    }
    return a->last = low;
}

static double vc_turned(const vc_axis *a, double t) { /* into the turn that the knots span */
    double from = a->knot[0], span = a->knot[a->knots - 1] - from, turns = (t - from) / span;
    long whole = (long)turns;
    if (turns < whole) whole--;
    t -= whole * span;
    return t < from ? from : t;
}

/* The errors of an axis at its position: (x y z, about x y z); returns whether it lies beyond the knots.
   Beyond them a curve goes on with a slope that fades to nothing: no step of position or of speed. */
static int vc_errors(vc_axis *a, double t, double way, double fade, double *e) {
    double low = a->knot[0], high = a->knot[a->knots - 1], beyond = 0, x, v, slope, (*c)[4];
    int i, n, outside;
    if (a->cyclic) t = vc_turned(a, t);
    else if (t < low) beyond = t - low, t = low;
    else if (t > high) beyond = t - high, t = high;
    outside = beyond != 0;
    if (outside) {
        x = vc_abs(beyond) < fade ? vc_abs(beyond) : fade;
        x -= x * x / (2 * fade);
        beyond = beyond < 0 ? -x : x;
    }
    n = vc_interval(a, t);
    x = t - a->knot[n];
    for (i = 0; i < (a->reverses ? VC_CURVES : VC_CURVES / 2); i++) {
        c = &a->curve[n][i];
        v = (*c)[0] + x * ((*c)[1] + x * ((*c)[2] + x * (*c)[3]));
        if (outside) {
            slope = (*c)[1] + x * (2 * (*c)[2] + 3 * x * (*c)[3]);
            v += slope * beyond;
        }
        if (i < 6) e[i] = v + a->place[i];
        else e[i - 6] += 0.5 * way * v;
    }
    return outside;
}

/* ---- the chain ---- */

static void vc_add_cross(const double *a, const double *b, double s, double *to) {
    to[0] += s * (a[1] * b[2] - a[2] * b[1]);
    to[1] += s * (a[2] * b[0] - a[0] * b[2]);
    to[2] += s * (a[0] * b[1] - a[1] * b[0]);
}

static void vc_turn(double *v, int along, double c, double s) {
    int i = along == 2 ? 0 : along + 1, j = along == 0 ? 2 : along - 1;
    double x = v[i], y = v[j];
    v[i] = c * x - s * y;
    v[j] = s * x + c * y;
}

static double vc_det(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* What every axis is to be sent further at t, along or about its positive direction by ISO 841.  t, way, out : [axes]
   Walks the chain from the tool to the workpiece; returns a fault or 0, and bits of axes beyond their knots. */
static int vc_once(vc_machine *m, const double *t, const double *way, const double *tool, double *out, int *outside) {
    double p[3], d[3] = {0, 0, 0}, u[3][3], e[6], c, s, det, right[3];
    int k, i, n, n_linear = 0, which[3];
    for (i = 0; i < 3; i++) p[i] = tool[i];
    for (k = m->axes - 1; k >= 0; k--) {
        vc_axis *a = &m->axis[k];
        int one = a->side > 0;
        if (vc_errors(a, t[k], way[k], a->rotary ? VC_FADE_DEG : m->fade, e)) *outside |= 1 << k;
        if (!a->rotary) {
            double *v = u[n_linear], travel[3] = {0, 0, 0};
            if (n_linear == 3) return VC_NO_SPACE;
            which[n_linear++] = k;
            v[0] = v[1] = v[2] = 0;
            v[a->along] = 1;
            travel[a->along] = t[k];
            if (!one) p[a->along] += t[k];
            for (i = 0; i < 3; i++) d[i] += a->side * e[i];
            vc_add_cross(e + 3, p, a->side, d);
            vc_add_cross(a->tilt, travel, 1, d);
            if (one) p[a->along] += t[k];
            continue;
        }
        c = cos(t[k] * VC_PER_DEG);
        s = sin(t[k] * VC_PER_DEG);
        out[k] = -a->side * e[3 + a->along] / VC_PER_DEG;
        e[3 + a->along] = 0;
        for (i = 0; i < 3; i++) p[i] -= a->origin[i];
        for (n = 0; n < 2; n++) {
            if (n == one) { /* the error stands before the turn on the workpiece side, behind it on the tool side */
                for (i = 0; i < 3; i++) d[i] += a->side * e[i];
                vc_add_cross(e + 3, p, a->side, d);
            } else {
                vc_turn(p, a->along, c, s);
                vc_turn(d, a->along, c, s);
                for (i = 0; i < n_linear; i++) vc_turn(u[i], a->along, c, s);
            }
        }
        for (i = 0; i < 3; i++) p[i] += a->origin[i];
    }
    if (n_linear < 2) return VC_NO_SPACE;
    if (n_linear == 2) { /* what leads out of their plane no axis can take away */
        u[2][0] = u[2][1] = u[2][2] = 0;
        vc_add_cross(u[0], u[1], 1, u[2]);
    }
    det = vc_det(u[0], u[1], u[2]);
    if (!(vc_abs(det) >= VC_LEAST_DET)) return vc_finite(det) ? VC_NO_SPACE : VC_NOT_FINITE;
    for (i = 0; i < 3; i++) right[i] = -d[i];
    out[which[0]] = vc_det(right, u[1], u[2]) / det;
    out[which[1]] = vc_det(u[0], right, u[2]) / det;
    if (n_linear == 3) out[which[2]] = vc_det(u[0], u[1], right) / det;
    for (k = 0; k < m->axes; k++)
        if (!vc_finite(out[k])) return VC_NOT_FINITE;
    return VC_FINE;
}

/* The correction of every axis: what the errors ask for where the axes will be sent to.
   joint : positions of the axes as the control counts them; out the same way.  Two rounds, always. */
static int vc_correction(vc_machine *m, const double *joint, const double *way, const double *tool, double *out,
                         int *outside) {
    double t[VC_AXES], w[VC_AXES], first[VC_AXES];
    int k, fault, beyond = 0;
    *outside = 0;
    for (k = 0; k < m->axes; k++) {
        if (!vc_finite(joint[k])) return VC_NOT_FINITE;
        t[k] = m->axis[k].sense * joint[k];
        w[k] = m->axis[k].sense * way[k];
    }
    if ((fault = vc_once(m, t, w, tool, first, outside))) return fault;
    for (k = 0; k < m->axes; k++) t[k] += first[k];
    if ((fault = vc_once(m, t, w, tool, out, &beyond))) return fault;
    for (k = 0; k < m->axes; k++) out[k] *= m->axis[k].sense;
    return VC_FINE;
}

/* ---- ways of change: nothing the component sends ever steps ---- */

typedef struct {
    double from, rate, accel, first, second, clock, target; /* two parabolas, in time */
} vc_parabolas;

static double vc_parabolas_at(const vc_parabolas *w, double *rate) {
    double t = w->clock, mid, v;
    if (t >= w->first + w->second) {
        *rate = 0;
        return w->target;
    }
    if (t <= w->first) {
        *rate = w->rate + w->accel * t;
        return w->from + t * (w->rate + 0.5 * w->accel * t);
    }
    mid = w->from + w->first * (w->rate + 0.5 * w->accel * w->first);
    v = w->rate + w->accel * w->first;
    t -= w->first;
    *rate = v - w->accel * t;
    return mid + t * (v - 0.5 * w->accel * t);
}

/* From where it is to a new target in the shortest time that an acceleration allows, from any speed. */
static void vc_parabolas_to(vc_parabolas *w, double target, double accel) {
    double rate, from = vc_parabolas_at(w, &rate), s, peak;
    double way = target - from - rate * vc_abs(rate) / (2 * accel);
    s = way < 0 ? -1 : 1;
    peak = sqrt(0.5 * rate * rate + s * accel * (target - from));
    w->from = from;
    w->rate = rate;
    w->accel = s * accel;
    w->first = (peak - s * rate) / accel;
    if (w->first < 0) w->first = 0;
    w->second = peak / accel;
    w->target = target;
    w->clock = 0;
}

typedef struct {
    double c[6], length, clock, target; /* a quintic in time, from any value, rate and curvature to rest */
} vc_quintic;

static double vc_quintic_at(const vc_quintic *q, double *rate, double *bend) {
    double x = q->clock;
    *rate = *bend = 0;
    if (q->length <= 0 || x >= q->length) return q->target;
    *rate = q->c[1] + x * (2 * q->c[2] + x * (3 * q->c[3] + x * (4 * q->c[4] + x * 5 * q->c[5])));
    *bend = 2 * q->c[2] + x * (6 * q->c[3] + x * (12 * q->c[4] + x * 20 * q->c[5]));
    return q->c[0] + x * (q->c[1] + x * (q->c[2] + x * (q->c[3] + x * (q->c[4] + x * q->c[5]))));
}

static void vc_quintic_to(vc_quintic *q, double target, double length) {
    double rate, bend, from = vc_quintic_at(q, &rate, &bend), T = length;
    double h = target - from - T * (rate + 0.5 * bend * T); /* what the start lacks at the end: value, */
    double v = -T * (rate + bend * T), k = -0.5 * T * T * bend; /* rate and curvature, in units of T */
    q->c[0] = from;
    q->c[1] = rate;
    q->c[2] = 0.5 * bend;
    q->c[3] = (10 * h - 4 * v + k) / (T * T * T);
    q->c[4] = (-15 * h + 7 * v - 2 * k) / (T * T * T * T);
    q->c[5] = (6 * h - 3 * v + k) / (T * T * T * T * T);
    q->length = T;
    q->clock = 0;
    q->target = target;
}

typedef struct {
    double furthest; /* where the axis was furthest on its way */
    int known, heading;
    vc_parabolas share; /* sigma: from which side it came, on the way from one to the other */
} vc_side;

/* Follow the position of an axis as commanded; the side turns when it has come back by the dead band. */
static double vc_side_of(vc_side *s, double at, double band, double seconds, double period) {
    double rate, way;
    if (!s->known) {
        s->known = 1;
        s->heading = 0;
        s->furthest = at;
    }
    way = at - s->furthest;
    if (s->heading ? way * s->heading > 0 : 0) s->furthest = at;
    else if (vc_abs(way) > band) {
        s->heading = way > 0 ? 1 : -1;
        s->furthest = at;
        vc_parabolas_to(&s->share, s->heading, 8 / (seconds * seconds));
    }
    s->share.clock += period;
    return vc_parabolas_at(&s->share, &rate);
}

/* Without drives a commanded position is that of the feedback, which trembles: the side stays, and is looked for from here. */
static double vc_side_kept(vc_side *s, double at, double period) {
    double rate;
    if (!s->known) return 0;
    s->furthest = at;
    s->share.clock += period;
    return vc_parabolas_at(&s->share, &rate);
}

#endif
