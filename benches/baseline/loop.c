/* Times calls of an FMU for co-simulation from C: the same loop for every FMU, compiled for FMI 2.0 or, with FMI3, for FMI 3.0;
 * with EVENTS the importer of 3.0 handles events and takes steps that end early.
 *
 * Each function but the first returns a negative number when a call of the FMU does not succeed. */
#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2.h"
#include "fmi3.h"

#define STEP 1e-3

#ifdef EVENTS
#define EVENT_MODE true
#else
#define EVENT_MODE false
#endif

#ifdef FMI3
#define NAME(two, three) three
#else
#define NAME(two, three) two
#endif
/* The type of a function of this version. */
#define FUNCTION(two, three) NAME(fmi2##two##TYPE, fmi3##three##TYPE)
#define FIND(library, two, three) dlsym(library, NAME("fmi2" #two, "fmi3" #three))

typedef struct {
    void *library;
    void *component;
    FUNCTION(FreeInstance, FreeInstance) *free_instance;
    FUNCTION(GetReal, GetFloat64) *get_real;
    FUNCTION(DoStep, DoStep) *do_step;
    FUNCTION(GetFMUstate, GetFMUState) *get_state;
    FUNCTION(SetFMUstate, SetFMUState) *set_state;
    FUNCTION(FreeFMUstate, FreeFMUState) *free_state;
#ifdef FMI3
    fmi3EnterStepModeTYPE *enter_event_mode, *enter_step_mode;
#endif
    uint64_t steps;      /* done so far */
    fmi2FMUstate mark;   /* where timed steps start, */
    uint64_t mark_steps; /* after so many */
} Fmu;

#ifndef FMI3
static void ignore(void *environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String message,
                   ...)
{
    (void)environment, (void)instance, (void)status, (void)category, (void)message;
}

static const fmi2CallbackFunctions CALLBACKS = {ignore, calloc, free, NULL, NULL};
#endif

/* The statuses of both versions have the same numbers. */
static int failed(int status)
{
    return status != fmi2OK && status != fmi2Warning;
}

static int64_t nanoseconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Real values to be set before initialization. */
typedef struct {
    size_t count;
    const fmi2ValueReference *references;
    const fmi2Real *values;
} Settings;

#ifdef FMI3
static void ignore(void *environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment, (void)status, (void)category, (void)message;
}

static int start(Fmu *fmu, fmi3String token, const Settings *settings)
{
    fmi3InstantiateCoSimulationTYPE *instantiate =
        (fmi3InstantiateCoSimulationTYPE *)dlsym(fmu->library, "fmi3InstantiateCoSimulation");
    fmi3SetFloat64TYPE *set = (fmi3SetFloat64TYPE *)dlsym(fmu->library, "fmi3SetFloat64");
    fmi3EnterInitializationModeTYPE *enter =
        (fmi3EnterInitializationModeTYPE *)dlsym(fmu->library, "fmi3EnterInitializationMode");
    fmi3ExitInitializationModeTYPE *leave =
        (fmi3ExitInitializationModeTYPE *)dlsym(fmu->library, "fmi3ExitInitializationMode");
    fmu->enter_event_mode = (fmi3EnterStepModeTYPE *)dlsym(fmu->library, "fmi3EnterEventMode");
    fmu->enter_step_mode = (fmi3EnterStepModeTYPE *)dlsym(fmu->library, "fmi3EnterStepMode");
    if (!instantiate || !enter || !leave || (EVENT_MODE && (!fmu->enter_event_mode || !fmu->enter_step_mode)))
        return -1;
    fmu->component = instantiate("timed", token, NULL, false, false, EVENT_MODE, EVENT_MODE, NULL, 0, NULL, ignore, NULL);
    if (!fmu->component)
        return -1;
    size_t count = settings->count;
    if (count > 0 && (!set || failed(set(fmu->component, settings->references, count, settings->values, count))))
        return -1;
    if (failed(enter(fmu->component, false, 0.0, 0.0, false, 0.0)) || failed(leave(fmu->component)))
        return -1;
    return EVENT_MODE && failed(fmu->enter_step_mode(fmu->component)) ? -1 : 0;
}
#else
static int start(Fmu *fmu, fmi2String guid, const Settings *settings)
{
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)dlsym(fmu->library, "fmi2Instantiate");
    fmi2SetRealTYPE *set_real = (fmi2SetRealTYPE *)dlsym(fmu->library, "fmi2SetReal");
    fmi2SetupExperimentTYPE *setup = (fmi2SetupExperimentTYPE *)dlsym(fmu->library, "fmi2SetupExperiment");
    fmi2EnterInitializationModeTYPE *enter =
        (fmi2EnterInitializationModeTYPE *)dlsym(fmu->library, "fmi2EnterInitializationMode");
    fmi2ExitInitializationModeTYPE *leave =
        (fmi2ExitInitializationModeTYPE *)dlsym(fmu->library, "fmi2ExitInitializationMode");
    if (!instantiate || !setup || !enter || !leave)
        return -1;
    fmu->component = instantiate("timed", fmi2CoSimulation, guid, NULL, &CALLBACKS, 0, 0);
    if (!fmu->component)
        return -1;
    if (settings->count > 0 &&
        (!set_real || failed(set_real(fmu->component, settings->references, settings->count, settings->values))))
        return -1;
    if (failed(setup(fmu->component, 0, 0.0, 0.0, 0, 0.0)) || failed(enter(fmu->component)) ||
        failed(leave(fmu->component)))
        return -1;
    return 0;
}
#endif

static int initialize(Fmu *fmu, const char *guid, const Settings *settings)
{
    fmu->free_instance = (FUNCTION(FreeInstance, FreeInstance) *)FIND(fmu->library, FreeInstance, FreeInstance);
    fmu->get_real = (FUNCTION(GetReal, GetFloat64) *)FIND(fmu->library, GetReal, GetFloat64);
    fmu->do_step = (FUNCTION(DoStep, DoStep) *)FIND(fmu->library, DoStep, DoStep);
    fmu->get_state = (FUNCTION(GetFMUstate, GetFMUState) *)FIND(fmu->library, GetFMUstate, GetFMUState);
    fmu->set_state = (FUNCTION(SetFMUstate, SetFMUState) *)FIND(fmu->library, SetFMUstate, SetFMUState);
    fmu->free_state = (FUNCTION(FreeFMUstate, FreeFMUState) *)FIND(fmu->library, FreeFMUstate, FreeFMUState);
    if (!fmu->free_instance || !fmu->get_real || !fmu->do_step || !fmu->get_state || !fmu->set_state ||
        !fmu->free_state)
        return -1;
    return start(fmu, guid, settings);
}

/* A step from this time, in parts if it ends early; none of those that are timed has an event. */
static int step(Fmu *fmu, double time)
{
#ifdef FMI3
    fmi3Boolean event = false, terminate = false, early = true;
    fmi3Float64 now = time, end = time + STEP;
    while (early) {
        if (failed(fmu->do_step(fmu->component, now, end - now, false, &event, &terminate, &early, &now)) || terminate)
            return -1;
        if (event && (failed(fmu->enter_event_mode(fmu->component)) || failed(fmu->enter_step_mode(fmu->component))))
            return -1;
    }
    return 0;
#else
    return failed(fmu->do_step(fmu->component, time, STEP, 0)) ? -1 : 0;
#endif
}

/* An initialised instance of the FMU in `library`; NULL if there is none. */
Fmu *open_fmu(const char *library, const char *guid, const Settings *settings)
{
    Fmu *fmu = calloc(1, sizeof *fmu);
    if (!fmu)
        return NULL;
    fmu->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (fmu->library && initialize(fmu, guid, settings) == 0)
        return fmu;
    free(fmu);
    return NULL;
}

void close_fmu(Fmu *fmu)
{
    fmu->free_instance(fmu->component);
    dlclose(fmu->library);
    free(fmu);
}

int get_real(Fmu *fmu, fmi2ValueReference reference, fmi2Real *value)
{
#ifdef FMI3
    return failed(fmu->get_real(fmu->component, &reference, 1, value, 1)) ? -1 : 0;
#else
    return failed(fmu->get_real(fmu->component, &reference, 1, value)) ? -1 : 0;
#endif
}

int do_steps(Fmu *fmu, uint64_t steps)
{
    uint64_t end = fmu->steps + steps;
    for (; fmu->steps < end; fmu->steps++)
        if (step(fmu, (double)fmu->steps * STEP) < 0)
            return -1;
    return 0;
}

/* Timed steps start here from now on. */
int mark(Fmu *fmu)
{
    fmu->mark_steps = fmu->steps;
    return failed(fmu->get_state(fmu->component, &fmu->mark)) ? -1 : 0;
}

/* Time, ns, of `steps` steps from the mark, `repetitions` times. */
int64_t time_steps(Fmu *fmu, uint64_t repetitions, uint64_t steps)
{
    int64_t spent = 0;
    for (uint64_t k = 0; k < repetitions; k++) {
        if (failed(fmu->set_state(fmu->component, fmu->mark)))
            return -1;
        fmu->steps = fmu->mark_steps;
        int64_t begin = nanoseconds();
        if (do_steps(fmu, steps) < 0)
            return -1;
        spent += nanoseconds() - begin;
    }
    return spent;
}

/* Time, ns, of saving the state, going back to it and freeing it, `repetitions` times. */
int64_t time_states(Fmu *fmu, uint64_t repetitions)
{
    int64_t begin = nanoseconds();
    for (uint64_t k = 0; k < repetitions; k++) {
        fmi2FMUstate state = NULL;
        if (failed(fmu->get_state(fmu->component, &state)) || failed(fmu->set_state(fmu->component, state)) ||
            failed(fmu->free_state(fmu->component, &state)))
            return -1;
    }
    return nanoseconds() - begin;
}

/* Time, ns, of the same with a step in between, which is taken back. */
int64_t time_rollbacks(Fmu *fmu, uint64_t repetitions)
{
    double time = (double)fmu->steps * STEP;
    int64_t begin = nanoseconds();
    for (uint64_t k = 0; k < repetitions; k++) {
        fmi2FMUstate state = NULL;
        if (failed(fmu->get_state(fmu->component, &state)) || step(fmu, time) < 0 ||
            failed(fmu->set_state(fmu->component, state)) || failed(fmu->free_state(fmu->component, &state)))
            return -1;
    }
    return nanoseconds() - begin;
}
