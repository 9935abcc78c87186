/* A bouncing ball as a plain FMU in C, for FMI 2.0 and 3.0: what a call costs at least.
 *
 * It does what BouncingBall of the Modelica Association's Reference-FMUs does in a call: the state is checked against
 * the function, communication point, step size and stop time against what is expected, and the solver goes in fixed
 * Euler steps of 1 ms, each of which asks the model for states, derivatives and an event indicator, and looks for a
 * change of sign. An FMU state is a copy of the instance. */

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2.h"
#include "fmi3.h"

#define EXPORT __attribute__((visibility("default")))
#define SOLVER_STEP 1e-3
#define SLOWEST 0.1     /* rebound, m/s, below which the ball stays down */
#define HYSTERESIS 1e-10 /* of the height, m */
#define TOLERANCE 1e-5  /* of times */

static const char GUID[] = "bouncing ball";

enum { STATES = 2, INDICATORS = 1 };

enum { INSTANTIATED = 1, INITIALIZATION = 2, STEP_COMPLETE = 4, STEP_FAILED = 8, TERMINATED = 16 };

enum { AT_REST = INSTANTIATED | INITIALIZATION | STEP_COMPLETE | STEP_FAILED | TERMINATED };

typedef struct {
    double height, velocity, gravity, restitution;
} Model;

typedef struct {
    char *name;
    fmi2CallbackFunctions callbacks;
    int log_events, log_errors;
    int state;
    double start, stop, time, next_point;
    uint64_t solver_steps;
    Model model;
    int values_changed, terminate, has_next_event;
    double next_event;
    double states[STATES], derivatives[STATES];
    double indicators[INDICATORS], indicators_before[INDICATORS];
} Ball;

static void report(const Ball *ball, fmi2Status status, const char *category, const char *format, ...)
{
    char message[256];
    va_list arguments;
    if (!(status == fmi2OK ? ball->log_events : ball->log_errors) || !ball->callbacks.logger)
        return;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    ball->callbacks.logger(ball->callbacks.environment, ball->name, status, category, "%s", message);
}

static void ignore(void *environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String message,
                   ...)
{
    (void)environment, (void)instance, (void)status, (void)category, (void)message;
}

/* Ends a call that cannot succeed. */
static fmi2Status refuse(Ball *ball, const char *function, const char *argument, double value)
{
    ball->state = TERMINATED;
    report(ball, fmi2Error, "logStatusError", "%s: %s = %.16g is not accepted", function, argument, value);
    return fmi2Error;
}

static int is_allowed(const Ball *ball, int states, const char *function)
{
    if (!ball)
        return 0;
    if (ball->state & states)
        return 1;
    report(ball, fmi2Error, "logStatusError", "%s: not allowed in this state", function);
    return 0;
}

static int is_close(double a, double b)
{
    return fabs(a - b) <= TOLERANCE * fmax(1.0, fmax(fabs(a), fabs(b)));
}

/* ---- the model ---- */

static void get_states(const Ball *ball, double states[])
{
    states[0] = ball->model.height;
    states[1] = ball->model.velocity;
}

static void set_states(Ball *ball, const double states[])
{
    ball->model.height = states[0];
    ball->model.velocity = states[1];
}

static void get_derivatives(const Ball *ball, double derivatives[])
{
    derivatives[0] = ball->model.velocity;
    derivatives[1] = ball->model.gravity;
}

/* The height, kept below zero for a ball that has just turned. */
static void get_indicators(const Ball *ball, double indicators[])
{
    const Model *model = &ball->model;
    int has_turned = model->height > -HYSTERESIS && model->height <= 0.0 && model->velocity > 0.0;
    indicators[0] = has_turned ? -HYSTERESIS : model->height;
}

static void handle_event(Ball *ball)
{
    Model *model = &ball->model;
    ball->values_changed = model->height <= 0.0 && model->velocity < 0.0;
    ball->has_next_event = 0;
    if (!ball->values_changed)
        return;
    model->height = DBL_MIN;
    model->velocity *= -model->restitution;
    if (model->velocity < SLOWEST)
        model->velocity = model->gravity = 0.0;
    report(ball, fmi2OK, "logEvents", "the ball bounces at %.16g s", ball->time);
}

/* ---- the solver ---- */

/* One Euler step; whether an event comes with it. */
static int solver_step(Ball *ball)
{
    int event = 0;
    get_states(ball, ball->states);
    get_derivatives(ball, ball->derivatives);
    for (int i = 0; i < STATES; i++)
        ball->states[i] += SOLVER_STEP * ball->derivatives[i];
    set_states(ball, ball->states);
    ball->time = ball->start + (double)++ball->solver_steps * SOLVER_STEP;
    get_indicators(ball, ball->indicators);
    for (int i = 0; i < INDICATORS; i++)
        event |= (ball->indicators_before[i] > 0.0) != (ball->indicators[i] > 0.0);
    memcpy(ball->indicators_before, ball->indicators, sizeof ball->indicators);
    return event || (ball->has_next_event && ball->time >= ball->next_event);
}

static inline fmi2Status do_step(Ball *ball, const char *function, double time, double size, int *event)
{
    double end = time + size;
    if (!is_allowed(ball, STEP_COMPLETE, function))
        return fmi2Error;
    if (!is_close(time, ball->next_point))
        return refuse(ball, function, "currentCommunicationPoint", time);
    if (!(size > 0.0))
        return refuse(ball, function, "communicationStepSize", size);
    if (end > ball->stop && !is_close(end, ball->stop))
        return refuse(ball, function, "communicationStepSize", size);
    for (;;) {
        double next = ball->time + SOLVER_STEP;
        if (next > end && !is_close(next, end))
            break;
        if (solver_step(ball)) {
            handle_event(ball);
            *event = 1;
        }
        if (ball->terminate) {
            ball->state = STEP_FAILED;
            return fmi2Discard;
        }
    }
    ball->next_point = end;
    return fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean no_set_state)
{
    int event = 0;
    (void)no_set_state;
    return do_step(component, "fmi2DoStep", time, size, &event);
}

/* ---- FMU states ---- */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    Ball *ball = component;
    if (!is_allowed(ball, AT_REST, "fmi2GetFMUstate"))
        return fmi2Error;
    void *copy = realloc(*state, sizeof *ball);
    if (!copy)
        return refuse(ball, "fmi2GetFMUstate", "size of the state", sizeof *ball);
    *state = memcpy(copy, ball, sizeof *ball);
    return fmi2OK;
}

/* What belongs to the importer stays. */
EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    Ball *ball = component;
    const Ball *saved = state;
    if (!is_allowed(ball, AT_REST, "fmi2SetFMUstate"))
        return fmi2Error;
    if (!saved)
        return refuse(ball, "fmi2SetFMUstate", "FMUstate", 0.0);
    Ball restored = *saved;
    restored.name = ball->name;
    restored.callbacks = ball->callbacks;
    restored.log_events = ball->log_events;
    restored.log_errors = ball->log_errors;
    *ball = restored;
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    if (!is_allowed(component, AT_REST, "fmi2FreeFMUstate"))
        return fmi2Error;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* ---- life ---- */

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Ball *ball;
    (void)resources, (void)visible;
    if (type != fmi2CoSimulation || !name || !guid || strcmp(guid, GUID) != 0 || !callbacks)
        return NULL;
    ball = calloc(1, sizeof *ball);
    if (!ball)
        return NULL;
    ball->name = malloc(strlen(name) + 1);
    if (!ball->name) {
        free(ball);
        return NULL;
    }
    strcpy(ball->name, name);
    ball->callbacks = *callbacks;
    ball->log_events = logging;
    ball->log_errors = 1;
    ball->state = INSTANTIATED;
    ball->stop = INFINITY;
    ball->model = (Model){.height = 1.0, .gravity = -9.81, .restitution = 0.7};
    return ball;
}

EXPORT void fmi2FreeInstance(fmi2Component component)
{
    Ball *ball = component;
    if (ball)
        free(ball->name);
    free(ball);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    Ball *ball = component;
    (void)tolerance_defined, (void)tolerance;
    if (!is_allowed(ball, INSTANTIATED, "fmi2SetupExperiment"))
        return fmi2Error;
    ball->start = ball->time = ball->next_point = start;
    ball->stop = stop_defined ? stop : INFINITY;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    Ball *ball = component;
    if (!is_allowed(ball, INSTANTIATED, "fmi2EnterInitializationMode"))
        return fmi2Error;
    ball->state = INITIALIZATION;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    Ball *ball = component;
    if (!is_allowed(ball, INITIALIZATION, "fmi2ExitInitializationMode"))
        return fmi2Error;
    ball->state = STEP_COMPLETE;
    get_indicators(ball, ball->indicators_before);
    return fmi2OK;
}

/* Height and velocity. */
EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                              fmi2Real values[])
{
    Ball *ball = component;
    if (!is_allowed(ball, AT_REST, "fmi2GetReal"))
        return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (references[i] > 1)
            return refuse(ball, "fmi2GetReal", "value reference", references[i]);
        values[i] = references[i] == 0 ? ball->model.height : ball->model.velocity;
    }
    return fmi2OK;
}

/* ---- FMI 3.0: the same functions under other names; no step ends early. The statuses have the same numbers. ---- */

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 size, fmi3Boolean no_set_state,
                             fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                             fmi3Float64 *last_time)
{
    Ball *ball = instance;
    int event = 0;
    (void)no_set_state;
    if (!event_needed || !terminate || !early_return || !last_time)
        return (fmi3Status)refuse(ball, "fmi3DoStep", "a pointer", 0.0);
    fmi2Status status = do_step(ball, "fmi3DoStep", time, size, &event);
    *event_needed = *early_return = false;
    *terminate = ball->terminate != 0;
    *last_time = ball->time;
    return (fmi3Status)status;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    return (fmi3Status)fmi2GetFMUstate(instance, state);
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    return (fmi3Status)fmi2SetFMUstate(instance, state);
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    return (fmi3Status)fmi2FreeFMUstate(instance, state);
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode_used,
                                                fmi3Boolean early_return_allowed, const fmi3ValueReference required[],
                                                size_t required_count, void *environment, fmi3LogMessageCallback log,
                                                fmi3IntermediateUpdateCallback update)
{
    const fmi2CallbackFunctions callbacks = {ignore, NULL, NULL, NULL, environment};
    (void)event_mode_used, (void)early_return_allowed, (void)required, (void)required_count, (void)log, (void)update;
    return fmi2Instantiate(name, fmi2CoSimulation, token, resources, &callbacks, visible, logging);
}

EXPORT void fmi3FreeInstance(fmi3Instance instance)
{
    fmi2FreeInstance(instance);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                              fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                              fmi3Float64 stop)
{
    fmi2Status status = fmi2SetupExperiment(instance, tolerance_defined, tolerance, start, stop_defined, stop);
    return (fmi3Status)(status == fmi2OK ? fmi2EnterInitializationMode(instance) : status);
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    return (fmi3Status)fmi2ExitInitializationMode(instance);
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                 fmi3Float64 values[], size_t value_count)
{
    (void)value_count;
    return (fmi3Status)fmi2GetReal(instance, references, count, values);
}
