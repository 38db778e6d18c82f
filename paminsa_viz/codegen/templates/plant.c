/* plant.c: the robot moved by its actuators, as an FMI 2.0 co-simulation.
 *
 * Torques are held over a step. The step is divided into equal parts of at most step_max, each of
 * which is one step of the classical method of Runge and Kutta (order 4).
 */
#include <stddef.h>
#include <string.h>

#include "paminsa.h"
#include "design.h"
#include "model.h"

typedef struct {
    double value[COUNT];
    double time;     /* [s] */
    double state[8]; /* pose [m, m, rad, m], and its rates */
    PaminsaDesign design;
    int status; /* a PaminsaStatus */
} Model;

static const char *const messages[] = {
    "", "a number is not finite", "a leg is stretched", "a leg is folded",
    "a leg has left its guide", "a leg is on its axis or passes it", "the pose is singular",
    "no assembly"
};

static const char *model_start(Model *model)
{
    memcpy(model->state, model->value + X_START, sizeof model->state);
    model->design = PAMINSA_DESIGN;
    return NULL;
}

/* Give the rates of a state under the torques; they are NaN where there are none. */
static PaminsaStatus rates_of(const Model *model, const double state[8], double rates[8])
{
    memcpy(rates, state + 4, 4 * sizeof rates[0]);
    return paminsa_forward_dynamics(
        &model->design, state, state + 4, model->value + TAU_1, rates + 4).status;
}

static void take_payload(Model *model)
{
    paminsa_set_payload(
        &model->design, model->value[PAYLOAD_MASS], model->value[PAYLOAD_INERTIA]);
}

/* Say whether a leg turns so far from one state to another that it has passed its axis between.
 *
 * Joint 5 comes out on the other side of the axis there, and the leg would jump by half a turn.
 */
static PaminsaStatus passed_axis(const Model *model, const double from[8], const double to[8])
{
    static const double most = 1.0; /* [rad] */
    double before[4], after[4];

    PaminsaStatus status = paminsa_inverse_kinematics(&model->design, from, before).status;
    if (status == PAMINSA_STATUS_OK)
        status = paminsa_inverse_kinematics(&model->design, to, after).status;
    for (int i = 0; i < 3 && status == PAMINSA_STATUS_OK; i++)
        if (!(fabs(paminsa_wrap_angle(after[i] - before[i])) < most))
            status = PAMINSA_STATUS_AXIS;
    return status;
}

/* Move a state on by a step of Runge and Kutta. */
static PaminsaStatus advance(const Model *model, double h, double state[8])
{
    static const double shares[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0, 2.0, 2.0, 1.0};
    double rates[8] = {0.0}, sum[8] = {0.0}, at[8];

    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 8; i++)
            at[i] = state[i] + shares[stage] * h * rates[i];
        PaminsaStatus status = passed_axis(model, state, at);
        if (status == PAMINSA_STATUS_OK)
            status = rates_of(model, at, rates);
        if (status != PAMINSA_STATUS_OK)
            return status;
        for (int i = 0; i < 8; i++)
            sum[i] += weights[stage] * rates[i];
    }
    for (int i = 0; i < 8; i++)
        at[i] = state[i] + h / 6.0 * sum[i];
    const PaminsaStatus status = passed_axis(model, state, at);
    if (status == PAMINSA_STATUS_OK)
        memcpy(state, at, sizeof at);
    return status;
}

static const char *model_step(Model *model, double size)
{
    double state[8];

    if (!(model->value[STEP_MAX] > 0.0) || !(size / model->value[STEP_MAX] < 1e9))
        return "step_max has to be a time above zero";
    take_payload(model);
    memcpy(state, model->state, sizeof state);
    const long count = (long)ceil(size / model->value[STEP_MAX] - 1e-9);
    for (long i = 0; i < count; i++) {
        model->status = advance(model, size / (double)count, state);
        if (model->status != PAMINSA_STATUS_OK)
            return messages[model->status];
    }
    memcpy(model->state, state, sizeof state);
    return NULL;
}

static const char *model_outputs(Model *model)
{
    double *value = model->value, none[4];
    static const double still[4] = {0.0, 0.0, 0.0, 0.0};

    if (!(value[PAYLOAD_MASS] >= 0.0) || !(value[PAYLOAD_INERTIA] >= 0.0))
        return "mass and inertia of a payload may not be negative";
    take_payload(model);
    model->status =
        paminsa_inverse_kinematics(&model->design, model->state, value + THETA_1).status;
    if (model->status != PAMINSA_STATUS_OK)
        return messages[model->status];
    memcpy(value + X, model->state, sizeof model->state);
    paminsa_actuator_motion(
        &model->design, model->state, model->state + 4, still, value + THETA_1_RATE, none);
    return NULL;
}

#include "fmu.h"
