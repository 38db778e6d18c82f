/* fmu.h: the functions of an FMI 2.0 co-simulation, for a model that has defined
 *
 * COUNT, FIRST_FIXED, FIRST_OUTPUT   how many real variables there are: inputs and tunable
 *                                    parameters first, then fixed parameters, then outputs
 * GUID, START                        what modelDescription.xml has
 * Model                              a struct with value[COUNT], status and time, which may be copied
 * model_start(model)                 begins from the fixed parameters
 * model_step(model, size)            moves on by a time [s]
 * model_outputs(model)               brings the outputs up to date
 *
 * The three return a message for people where they fail, or NULL. Types and names are those of the
 * standard, Functional Mock-up Interface 2.0 (fmi-standard.org).
 */
#include <stddef.h>
#include <string.h>

typedef void *fmi2Component;
typedef void *fmi2FMUstate;
typedef void *fmi2ComponentEnvironment;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated
} fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined _WIN32
#define FMU_EXPORT __declspec(dllexport)
#else
#define FMU_EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    Model model;
    int is_started;   /* fixed parameters hold from then on */
    int is_changed;   /* outputs have to be computed again */
    char guid[sizeof GUID];
    char name[64];    /* what stands before it is the state */
    const fmi2CallbackFunctions *callbacks;
    fmi2Boolean is_debugged;
} Instance;

static const double start_values[FIRST_OUTPUT] = START;

static fmi2Status said(Instance *instance, fmi2Status status, const char *message)
{
    const fmi2CallbackFunctions *c = instance->callbacks;

    if (c->logger != NULL && (instance->is_debugged || status == fmi2Error))
        c->logger(c->componentEnvironment, instance->name, status, "error", "%s", message);
    return status;
}

static fmi2Status failed(Instance *instance, const char *message)
{
    return said(instance, fmi2Error, message);
}

static fmi2Status outcome(Instance *instance, const char *message)
{
    return message == NULL ? fmi2OK : failed(instance, message);
}

static void set_to_start(Instance *instance)
{
    memset(&instance->model, 0, sizeof instance->model);
    memcpy(instance->model.value, start_values, sizeof start_values);
    instance->is_started = 0;
    instance->is_changed = 1;
}

static const char *up_to_date(Instance *instance)
{
    const char *message = NULL;

    if (!instance->is_changed)
        return NULL;
    if (!instance->is_started)
        message = model_start(&instance->model);
    if (message == NULL)
        message = model_outputs(&instance->model);
    instance->is_changed = message != NULL;
    return message;
}

FMU_EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

FMU_EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

FMU_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
    const fmi2String categories[])
{
    (void)count;
    (void)categories;
    ((Instance *)c)->is_debugged = on;
    return fmi2OK;
}

FMU_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
    fmi2String place, const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean on)
{
    (void)place;
    (void)visible;
    if (callbacks == NULL || callbacks->allocateMemory == NULL || callbacks->freeMemory == NULL)
        return NULL;
    if (type != fmi2CoSimulation || guid == NULL || strcmp(guid, GUID) != 0)
        return NULL;
    Instance *instance = callbacks->allocateMemory(1, sizeof *instance);
    if (instance == NULL)
        return NULL;
    memset(instance, 0, sizeof *instance);
    memcpy(instance->guid, GUID, sizeof GUID);
    strncpy(instance->name, name == NULL ? "" : name, sizeof instance->name - 1);
    instance->callbacks = callbacks;
    instance->is_debugged = on;
    set_to_start(instance);
    return instance;
}

FMU_EXPORT void fmi2FreeInstance(fmi2Component c)
{
    Instance *instance = c;

    if (instance != NULL)
        instance->callbacks->freeMemory(instance);
}

FMU_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance,
    fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    ((Instance *)c)->model.time = start;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *instance = c;
    const char *message = up_to_date(instance);

    instance->is_started = message == NULL;
    return outcome(instance, message);
}

FMU_EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    set_to_start(c);
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference which[], size_t count,
    fmi2Real value[])
{
    Instance *instance = c;
    const char *message = NULL;

    for (size_t i = 0; i < count; i++) {
        if (which[i] >= COUNT)
            return failed(instance, "there is no such variable");
        if (which[i] >= FIRST_OUTPUT && message == NULL)
            message = up_to_date(instance);
        value[i] = instance->model.value[which[i]];
    }
    return outcome(instance, message);
}

FMU_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference which[], size_t count,
    const fmi2Real value[])
{
    Instance *instance = c;

    for (size_t i = 0; i < count; i++) {
        if (which[i] >= FIRST_OUTPUT)
            return failed(instance, "only inputs and parameters can be set");
        if (which[i] >= FIRST_FIXED && instance->is_started)
            return failed(instance, "this parameter can be set before the start only");
        instance->model.value[which[i]] = value[i];
    }
    instance->is_changed = 1;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference which[],
    size_t count, fmi2Integer value[])
{
    Instance *instance = c;

    (void)up_to_date(instance); /* the status says why */
    for (size_t i = 0; i < count; i++) {
        if (which[i] != 0)
            return failed(instance, "there is no such variable");
        value[i] = instance->model.status;
    }
    return fmi2OK;
}

/* The model has no other types of variables, no derivatives, and no step that waits. */

static fmi2Status nothing(fmi2Component c, size_t count)
{
    return count == 0 ? fmi2OK : failed(c, "the model has no such variable");
}

FMU_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference which[],
    size_t count, const fmi2Integer value[])
{
    (void)which;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference which[],
    size_t count, fmi2Boolean value[])
{
    (void)which;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference which[],
    size_t count, const fmi2Boolean value[])
{
    (void)which;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference which[],
    size_t count, fmi2String value[])
{
    (void)which;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference which[],
    size_t count, const fmi2String value[])
{
    (void)which;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c,
    const fmi2ValueReference unknown[], size_t unknowns, const fmi2ValueReference known[],
    size_t count, const fmi2Real change[], fmi2Real value[])
{
    (void)unknown;
    (void)known;
    (void)count;
    (void)change;
    (void)value;
    return nothing(c, unknowns);
}

FMU_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c,
    const fmi2ValueReference which[], size_t count, const fmi2Integer order[],
    const fmi2Real value[])
{
    (void)which;
    (void)order;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c,
    const fmi2ValueReference which[], size_t count, const fmi2Integer order[], fmi2Real value[])
{
    (void)which;
    (void)order;
    (void)value;
    return nothing(c, count);
}

FMU_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Instance *instance = c;

    if (*state == NULL)
        *state = instance->callbacks->allocateMemory(1, sizeof *instance);
    if (*state == NULL)
        return failed(instance, "there is no memory for the state");
    memcpy(*state, instance, sizeof *instance);
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Instance *instance = c;
    const Instance *saved = state;

    instance->model = saved->model;
    instance->is_started = saved->is_started;
    instance->is_changed = saved->is_changed;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (*state != NULL)
        ((Instance *)c)->callbacks->freeMemory(*state);
    *state = NULL;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c;
    (void)state;
    *size = offsetof(Instance, name);
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
    size_t size)
{
    if (size < offsetof(Instance, name))
        return failed(c, "there is no room for the state");
    memcpy(bytes, state, offsetof(Instance, name));
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
    fmi2FMUstate *state)
{
    if (size != offsetof(Instance, name) ||
        memcmp(bytes + offsetof(Instance, guid), GUID, sizeof GUID) != 0)
        return failed(c, "this is no state of this model");
    const fmi2Status status = fmi2GetFMUstate(c, state);
    if (status == fmi2OK)
        memcpy(*state, bytes, size);
    return status;
}

FMU_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real size,
    fmi2Boolean no_way_back)
{
    Instance *instance = c;

    (void)time;
    (void)no_way_back;
    if (!(size >= 0.0))
        return failed(instance, "a step has to be a time of at least zero");
    const char *message = up_to_date(instance);
    if (message == NULL)
        message = model_step(&instance->model, size);
    if (message != NULL)
        return failed(instance, message);
    instance->model.time += size;
    instance->is_changed = 1;
    return outcome(instance, up_to_date(instance));
}

FMU_EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return failed(c, "no step is under way");
}

/* No step waits, so there is no status to tell but the time and whether the end is reached. */
static fmi2Status not_known(fmi2Component c)
{
    return said(c, fmi2Discard, "no step is under way");
}

FMU_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return not_known(c);
}

FMU_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime)
        return not_known(c);
    *value = ((Instance *)c)->model.time;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind,
    fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return not_known(c);
}

FMU_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind,
    fmi2Boolean *value)
{
    if (kind != fmi2Terminated)
        return not_known(c);
    *value = 0;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return not_known(c);
}
