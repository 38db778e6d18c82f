/* inverse.c: the torques that a motion of the platform asks for, as an FMI 2.0 co-simulation.
 *
 * It has no states: outputs follow the inputs at once. Out of reach or at a singularity the outputs
 * are NaN and the status says why.
 */
#include <stddef.h>

#include "paminsa.h"
#include "design.h"
#include "model.h"

typedef struct {
    double value[COUNT];
    double time; /* [s] */
    int status;  /* a PaminsaStatus */
} Model;

static const char *model_start(Model *model)
{
    (void)model;
    return NULL;
}

static const char *model_step(Model *model, double size)
{
    (void)model;
    (void)size;
    return NULL;
}

static const char *model_outputs(Model *model)
{
    double *value = model->value;
    PaminsaDesign design = PAMINSA_DESIGN;

    if (!(value[PAYLOAD_MASS] >= 0.0) || !(value[PAYLOAD_INERTIA] >= 0.0))
        return "mass and inertia of a payload may not be negative";
    paminsa_set_payload(&design, value[PAYLOAD_MASS], value[PAYLOAD_INERTIA]);
    paminsa_inverse_kinematics(&design, value + X, value + THETA_1);
    model->status = paminsa_inverse_dynamics(
        &design, value + X, value + X_RATE, value + X_ACCELERATION, value + TAU_1).status;
    return NULL;
}

#include "fmu.h"
