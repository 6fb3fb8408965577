/* The motors' law and the manoeuvre on MuJoCo's side, in C: called from Python they would cost more than MuJoCo does.
 *
 * The torque is what host-sim's steppers and dry friction give: T sin(p (phi - alpha)) - f tanh(omega / turn at homing speed) + d phi',
 * less d omega, which the model has as joint damping so that MuJoCo's integrators may treat it implicitly.
 * Degrees of freedom 0 .. axes-1 are the cranks.
 */
#include <math.h>
#include <time.h>
#include <mujoco/mujoco.h>

#define MOST 6

struct machine {
    double cycles_per_turn, damping_nms, friction_speed_rad_s, speed_rad_s, ramp_s, tick_s;
    double torque_nm[MOST], friction_nm[MOST], offset_rad[MOST];
    int axes, ticks, ticks_per_sample;
};

static const struct machine *machine;
static double tick_began_s, field_rad, field_rad_s;

static void torques(const mjModel *model, mjData *data) {
    (void)model;
    const struct machine *m = machine;
    const double field = field_rad + field_rad_s * (data->time - tick_began_s);
    for (int i = 0; i < m->axes; i++) {
        const double ahead = m->cycles_per_turn * (field + m->offset_rad[i] - data->qpos[i]);
        data->qfrc_applied[i] = m->torque_nm[i] * sin(ahead) + m->damping_nms * field_rad_s
                                - m->friction_nm[i] * tanh(data->qvel[i] / m->friction_speed_rad_s);
    }
}

/* Runs that go off its command are reported by what play() gives. */
static void quiet(const char *warning) { (void)warning; }

static double turned(const struct machine *m, double t_s) {
    const double u = t_s < m->ramp_s ? t_s / m->ramp_s : 1.0;
    const double after_s = t_s > m->ramp_s ? t_s - m->ramp_s : 0.0;
    return m->speed_rad_s * (m->ramp_s * u * u * u * (1.0 - 0.5 * u) + after_s);
}

/* Plays the manoeuvre from the state in `data`; writes all coordinates at every sample. Gives the CPU time in s, or a
 * negative number if MuJoCo warned of a state that is not one. */
double play(const struct machine *m, const mjModel *model, mjData *data, int steps_per_tick, double *samples) {
    struct timespec begun, ended;
    machine = m;
    mjcb_control = torques;
    mju_user_warning = quiet;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begun);
    for (int tick = 0; tick < m->ticks; tick++) {
        tick_began_s = data->time;
        field_rad = turned(m, tick * m->tick_s);
        field_rad_s = (turned(m, (tick + 1) * m->tick_s) - field_rad) / m->tick_s;
        for (int step = 0; step < steps_per_tick; step++) mj_step(model, data);
        if ((tick + 1) % m->ticks_per_sample == 0)
            for (int i = 0; i < model->nq; i++) *samples++ = data->qpos[i];
    }
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &ended);
    mjcb_control = 0;
    if (data->warning[mjWARN_BADQPOS].number || data->warning[mjWARN_BADQVEL].number
        || data->warning[mjWARN_BADQACC].number)
        return -1.0;
    return (ended.tv_sec - begun.tv_sec) + 1e-9 * (ended.tv_nsec - begun.tv_nsec);
}
