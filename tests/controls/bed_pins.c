// Pins of a printer that is not there, in place of Klipper's src/linux/gpio.c: motors are counted by their steps, and
// the bed is a function of where they stand. Pins 4k, 4k + 1 step motor k and turn it; 4k + 3 is its endstop, at 0; pin
// 13 is a probe under the tool. STEPS_PER_MM has a number for each axis, BED the coefficients of a bed, in mm.
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
static double at[3] = {12, 9, 6}, per_mm[3], bed[5];

static void prepare(void) {
    if (per_mm[0]) return;
    sscanf(getenv("STEPS_PER_MM"), "%lf,%lf,%lf", per_mm, per_mm + 1, per_mm + 2);
    sscanf(getenv("BED"), "%lf,%lf,%lf,%lf,%lf", bed, bed + 1, bed + 2, bed + 3, bed + 4);
}

static double height(void) {
    double x = at[0] / 100, y = at[1] / 100;
    return bed[0] + bed[1] * x + bed[2] * y + bed[3] * x * y + bed[4] * x * x;
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
    return n == 13 ? at[2] <= height() : n < 12 && n % 4 == 3 && at[n / 4] <= 0;
}
