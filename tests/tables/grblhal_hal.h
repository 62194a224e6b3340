/* As much of grblHAL's interface of 2026 as a plugin with kinematics uses, by its own names, for a host without drives. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define bit(n) (1u << (n))
#define ASCII_EOL "\r\n"

typedef union {
    float values[N_AXIS];
} coord_data_t;
typedef union {
    int32_t values[N_AXIS];
} mpos_t;
typedef union {
    uint8_t mask;
} axes_signals_t;
typedef int homing_mode_t;
typedef unsigned sys_state_t;
typedef struct {
    float feed_rate;
    struct {
        bool rapid_motion, inverse_time;
    } condition;
} plan_line_data_t;
typedef struct {
    coord_data_t min, max;
} work_envelope_t;
typedef bool (*travel_limits_ptr)(float *target, axes_signals_t axes, bool is_cartesian, work_envelope_t *envelope);
typedef void (*on_jog_cancel_ptr)(sys_state_t state);
typedef void (*on_report_options_ptr)(bool newopt);

struct {
    struct {
        float steps_per_mm, max_travel;
    } axis[N_AXIS];
    struct {
        struct {
            bool force_set_origin;
        } flags;
        axes_signals_t dir_mask;
    } homing;
} settings;
struct {
    int32_t position[N_AXIS];
    float home_position[N_AXIS];
    axes_signals_t soft_limits;
    work_envelope_t work_envelope;
} sys;
struct {
    travel_limits_ptr check_travel_limits;
    on_jog_cancel_ptr on_jog_cancel;
    on_report_options_ptr on_report_options;
} grbl;
struct {
    struct {
        void (*write)(const char *text);
    } stream;
} hal;
struct {
    coord_data_t *(*transform_steps_to_cartesian)(coord_data_t *position, mpos_t *steps);
    coord_data_t *(*transform_from_cartesian)(coord_data_t *target, coord_data_t *position);
    coord_data_t *(*segment_line)(coord_data_t *target, coord_data_t *position, plan_line_data_t *line, bool init);
    uint_fast8_t (*limits_get_axis_mask)(uint_fast8_t idx);
    void (*limits_set_target_pos)(uint_fast8_t idx);
    void (*limits_set_machine_positions)(axes_signals_t cycle);
    bool (*homing_cycle_validate)(axes_signals_t cycle);
    float (*homing_cycle_get_feedrate)(axes_signals_t axes, float rate, homing_mode_t mode);
} kinematics;

coord_data_t *limits_homing_pulloff(coord_data_t *distance);
