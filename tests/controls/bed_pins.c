// Pins of a printer that is not there, in place of Klipper's src/linux/gpio.c: motors are counted by their steps, and
// the bed is a function of where they stand. Pins 4k, 4k + 1 step motor k and turn it; 4k + 3 is its endstop, at 0; pin
// 13 is a probe beside the tool. STEPS_PER_MM has a number for each axis, BED the coefficients of a bed, in mm; PROBE
// says where the probe is, and by how much Y leans towards -x. When pin 14 is set the file BALLS is read: the radius of
// ball and stylus together, and the middle of each ball.
#include <stdio.h>
#include <stdlib.h>
#include "command.h"
#include "gpio.h"
#include "internal.h"
#include "sched.h"

#define PINS 16
DECL_ENUMERATION_RANGE("pin", "gpio0", 0, PINS);

struct gpio_line { int number, state; };
static struct gpio_line lines[PINS];
static double at[3] = {12, 9, 6}, per_mm[3], bed[5], probe[3], radius, balls[16][3];
static int count;

static void prepare(void) {
    if (per_mm[0]) return;
    sscanf(getenv("STEPS_PER_MM"), "%lf,%lf,%lf", per_mm, per_mm + 1, per_mm + 2);
    sscanf(getenv("BED"), "%lf,%lf,%lf,%lf,%lf", bed, bed + 1, bed + 2, bed + 3, bed + 4);
    sscanf(getenv("PROBE"), "%lf,%lf,%lf", probe, probe + 1, probe + 2);
}

static void put_down(void) {
    FILE *file = fopen(getenv("BALLS"), "r");
    if (!file || fscanf(file, "%lf", &radius) != 1) shutdown("no balls");
    for (count = 0; count < 16; count++) {
        double *b = balls[count];
        if (fscanf(file, "%lf %lf %lf", b, b + 1, b + 2) != 3) break;
    }
    fclose(file);
}

static int met(void) {
    double x = at[0] + probe[0] - probe[2] * at[1], y = at[1] + probe[1], z = at[2], a = x / 100, b = y / 100;
    for (int k = 0; k < count; k++) {
        double *c = balls[k], dx = x - c[0], dy = y - c[1], up = z - c[2], left = radius * radius - dx * dx - dy * dy;
        if (left > 0 && (up <= 0 || up * up <= left)) return 1;
    }
    return z <= bed[0] + bed[1] * a + bed[2] * b + bed[3] * a * b + bed[4] * a * a;
}

static struct gpio_line *line_of(uint32_t pin) {
    if (pin >= PINS) shutdown("no such pin");
    prepare();
    lines[pin].number = pin;
    return lines + pin;
}

struct gpio_out gpio_out_setup(uint32_t pin, uint8_t val) {
    struct gpio_out g = {line_of(pin)};
    g.line->state = !!val;
    return g;
}
void gpio_out_reset(struct gpio_out g, uint8_t val) { g.line->state = !!val; }
void gpio_out_write(struct gpio_out g, uint8_t val) {
    int n = g.line->number, rises = val && !g.line->state;
    g.line->state = !!val;
    if (rises && n == 14) put_down();
    if (rises && n < 12 && n % 4 == 0) at[n / 4] += (lines[n + 1].state ? 1 : -1) / per_mm[n / 4];
}
void gpio_out_toggle_noirq(struct gpio_out g) { gpio_out_write(g, !g.line->state); }
void gpio_out_toggle(struct gpio_out g) { gpio_out_write(g, !g.line->state); }

struct gpio_in gpio_in_setup(uint32_t pin, int8_t pull_up) {
    struct gpio_in g = {line_of(pin)};
    return g;
}
void gpio_in_reset(struct gpio_in g, int8_t pull_up) {}
uint8_t gpio_in_read(struct gpio_in g) {
    int n = g.line->number;
    return n == 13 ? met() : n < 12 && n % 4 == 3 && at[n / 4] <= 0;
}
