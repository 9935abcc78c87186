/* Times calls of an FMU for co-simulation from C: the same loop for every FMU.
 *
 * Each function but the first returns a negative number when a call of the FMU does not succeed. */
#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2.h"

#define STEP 1e-3

typedef struct {
    void *library;
    fmi2Component component;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2GetRealTYPE *get_real;
    fmi2DoStepTYPE *do_step;
    fmi2GetFMUstateTYPE *get_state;
    fmi2SetFMUstateTYPE *set_state;
    fmi2FreeFMUstateTYPE *free_state;
    uint64_t steps;      /* done so far */
    fmi2FMUstate mark;   /* where timed steps start, */
    uint64_t mark_steps; /* after so many */
} Fmu;

static void ignore(void *environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String message,
                   ...)
{
    (void)environment, (void)instance, (void)status, (void)category, (void)message;
}

static const fmi2CallbackFunctions CALLBACKS = {ignore, calloc, free, NULL, NULL};

static int failed(fmi2Status status)
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

static int initialize(Fmu *fmu, fmi2String guid, const Settings *settings)
{
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)dlsym(fmu->library, "fmi2Instantiate");
    fmi2SetRealTYPE *set_real = (fmi2SetRealTYPE *)dlsym(fmu->library, "fmi2SetReal");
    fmi2SetupExperimentTYPE *setup = (fmi2SetupExperimentTYPE *)dlsym(fmu->library, "fmi2SetupExperiment");
    fmi2EnterInitializationModeTYPE *enter =
        (fmi2EnterInitializationModeTYPE *)dlsym(fmu->library, "fmi2EnterInitializationMode");
    fmi2ExitInitializationModeTYPE *leave =
        (fmi2ExitInitializationModeTYPE *)dlsym(fmu->library, "fmi2ExitInitializationMode");
    fmu->free_instance = (fmi2FreeInstanceTYPE *)dlsym(fmu->library, "fmi2FreeInstance");
    fmu->get_real = (fmi2GetRealTYPE *)dlsym(fmu->library, "fmi2GetReal");
    fmu->do_step = (fmi2DoStepTYPE *)dlsym(fmu->library, "fmi2DoStep");
    fmu->get_state = (fmi2GetFMUstateTYPE *)dlsym(fmu->library, "fmi2GetFMUstate");
    fmu->set_state = (fmi2SetFMUstateTYPE *)dlsym(fmu->library, "fmi2SetFMUstate");
    fmu->free_state = (fmi2FreeFMUstateTYPE *)dlsym(fmu->library, "fmi2FreeFMUstate");
    if (!instantiate || !setup || !enter || !leave || !fmu->free_instance || !fmu->get_real || !fmu->do_step ||
        !fmu->get_state || !fmu->set_state || !fmu->free_state)
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
    return failed(fmu->get_real(fmu->component, &reference, 1, value)) ? -1 : 0;
}

int do_steps(Fmu *fmu, uint64_t steps)
{
    uint64_t end = fmu->steps + steps;
    for (; fmu->steps < end; fmu->steps++)
        if (failed(fmu->do_step(fmu->component, (double)fmu->steps * STEP, STEP, 0)))
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
        if (failed(fmu->get_state(fmu->component, &state)) ||
            failed(fmu->do_step(fmu->component, time, STEP, 0)) ||
            failed(fmu->set_state(fmu->component, state)) || failed(fmu->free_state(fmu->component, &state)))
            return -1;
    }
    return nanoseconds() - begin;
}
