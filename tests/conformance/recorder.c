/* Stands in for the library of an FMU and counts what each call returns, whatever importer makes it.
 *
 * The library proper lies beside it under the same name with ".inner" behind. When an instance is freed and when the process ends, a
 * line for each function and status, "FUNCTION STATUS COUNT", goes to a file in the folder that the environment variable
 * VIDEG_CALLS names: the name of the library with ".calls" in place of ".so".
 */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { MOST = 64, STATUSES = 6 };

static const char *names[MOST];
static unsigned long counts[MOST][STATUSES];

/* Where this library lies. */
static const char *own_path(void)
{
    Dl_info own;
    if (dladdr(names, &own) == 0)
        abort();
    return own.dli_fname;
}

/* A function of the library proper; NULL if it lacks it. */
static void *inner(const char *name)
{
    static void *library;
    if (library == NULL) {
        char path[4096];
        snprintf(path, sizeof path, "%s.inner", own_path());
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    }
    return library == NULL ? NULL : dlsym(library, name);
}

static fmi2Status count(int place, const char *name, fmi2Status status)
{
    names[place] = name;
    __sync_fetch_and_add(&counts[place][(int)status < STATUSES ? status : fmi2Fatal], 1);
    return status;
}

__attribute__((destructor)) static void write_counts(void)
{
    static const char *const STATUS[] = {"fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending"};
    const char *folder = getenv("VIDEG_CALLS"), *name = strrchr(own_path(), '/');
    char path[4096];
    FILE *file = NULL;
    int place, status;
    if (folder != NULL && name != NULL) {
        snprintf(path, sizeof path, "%s%.*s.calls", folder, (int)strcspn(name, "."), name);
        file = fopen(path, "a");
    }
    for (place = 0; file != NULL && place < MOST; place++)
        for (status = 0; status < STATUSES; status++)
            if (counts[place][status] != 0) {
                fprintf(file, "%s %s %lu\n", names[place], STATUS[status], counts[place][status]);
                counts[place][status] = 0;
            }
    if (file != NULL)
        fclose(file);
}

/* --- functions without a status ----------------------------------------------------------------------------------- */

const char *fmi2GetTypesPlatform(void)
{
    return ((fmi2GetTypesPlatformTYPE *)inner("fmi2GetTypesPlatform"))();
}

const char *fmi2GetVersion(void)
{
    return ((fmi2GetVersionTYPE *)inner("fmi2GetVersion"))();
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)inner("fmi2Instantiate");
    fmi2Component made = instantiate(name, type, guid, resources, functions, visible, logging);
    count(__COUNTER__, "fmi2Instantiate", made == NULL ? fmi2Error : fmi2OK);
    return made;
}

void fmi2FreeInstance(fmi2Component c)
{
    ((fmi2FreeInstanceTYPE *)inner("fmi2FreeInstance"))(c);
    write_counts();
}

/* --- functions with one ------------------------------------------------------------------------------------------- */

#define FORWARD(name, parameters, arguments)                                             \
    fmi2Status name parameters                                                           \
    {                                                                                    \
        static name##TYPE *function;                                                     \
        if (function == NULL)                                                            \
            function = (name##TYPE *)inner(#name);                                       \
        return count(__COUNTER__, #name, function == NULL ? fmi2Error : function arguments); \
    }
#define C fmi2Component c
#define GET(name, type) \
    FORWARD(name, (C, const fmi2ValueReference vr[], size_t n, type value[]), (c, vr, n, value))

FORWARD(fmi2SetDebugLogging, (C, fmi2Boolean on, size_t n, const fmi2String categories[]), (c, on, n, categories))
FORWARD(fmi2SetupExperiment, (C, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop, fmi2Real stop),
        (c, has_tolerance, tolerance, start, has_stop, stop))
FORWARD(fmi2EnterInitializationMode, (C), (c))
FORWARD(fmi2ExitInitializationMode, (C), (c))
FORWARD(fmi2Terminate, (C), (c))
FORWARD(fmi2Reset, (C), (c))
GET(fmi2GetReal, fmi2Real)
GET(fmi2GetInteger, fmi2Integer)
GET(fmi2GetBoolean, fmi2Boolean)
GET(fmi2GetString, fmi2String)
GET(fmi2SetReal, const fmi2Real)
GET(fmi2SetInteger, const fmi2Integer)
GET(fmi2SetBoolean, const fmi2Boolean)
GET(fmi2SetString, const fmi2String)
FORWARD(fmi2GetFMUstate, (C, fmi2FMUstate *state), (c, state))
FORWARD(fmi2SetFMUstate, (C, fmi2FMUstate state), (c, state))
FORWARD(fmi2FreeFMUstate, (C, fmi2FMUstate *state), (c, state))
FORWARD(fmi2SerializedFMUstateSize, (C, fmi2FMUstate state, size_t *size), (c, state, size))
FORWARD(fmi2SerializeFMUstate, (C, fmi2FMUstate state, fmi2Byte bytes[], size_t size), (c, state, bytes, size))
FORWARD(fmi2DeSerializeFMUstate, (C, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state), (c, bytes, size, state))
FORWARD(fmi2GetDirectionalDerivative,
        (C, const fmi2ValueReference unknown[], size_t n, const fmi2ValueReference known[], size_t m, const fmi2Real seed[],
         fmi2Real value[]),
        (c, unknown, n, known, m, seed, value))
FORWARD(fmi2EnterEventMode, (C), (c))
FORWARD(fmi2NewDiscreteStates, (C, fmi2EventInfo *info), (c, info))
FORWARD(fmi2EnterContinuousTimeMode, (C), (c))
FORWARD(fmi2CompletedIntegratorStep, (C, fmi2Boolean no_set, fmi2Boolean *enter, fmi2Boolean *terminate),
        (c, no_set, enter, terminate))
FORWARD(fmi2SetTime, (C, fmi2Real time), (c, time))
FORWARD(fmi2SetContinuousStates, (C, const fmi2Real x[], size_t n), (c, x, n))
FORWARD(fmi2GetDerivatives, (C, fmi2Real x[], size_t n), (c, x, n))
FORWARD(fmi2GetEventIndicators, (C, fmi2Real x[], size_t n), (c, x, n))
FORWARD(fmi2GetContinuousStates, (C, fmi2Real x[], size_t n), (c, x, n))
FORWARD(fmi2GetNominalsOfContinuousStates, (C, fmi2Real x[], size_t n), (c, x, n))
FORWARD(fmi2SetRealInputDerivatives, (C, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real value[]),
        (c, vr, n, order, value))
FORWARD(fmi2GetRealOutputDerivatives, (C, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real value[]),
        (c, vr, n, order, value))
FORWARD(fmi2DoStep, (C, fmi2Real time, fmi2Real step, fmi2Boolean no_set), (c, time, step, no_set))
FORWARD(fmi2CancelStep, (C), (c))
FORWARD(fmi2GetStatus, (C, const fmi2StatusKind kind, fmi2Status *value), (c, kind, value))
FORWARD(fmi2GetRealStatus, (C, const fmi2StatusKind kind, fmi2Real *value), (c, kind, value))
FORWARD(fmi2GetIntegerStatus, (C, const fmi2StatusKind kind, fmi2Integer *value), (c, kind, value))
FORWARD(fmi2GetBooleanStatus, (C, const fmi2StatusKind kind, fmi2Boolean *value), (c, kind, value))
FORWARD(fmi2GetStringStatus, (C, const fmi2StatusKind kind, fmi2String *value), (c, kind, value))
