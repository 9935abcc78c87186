/* What the benchmark of calls needs of FMI 2.0, sections 2.1 and 4.2: types, statuses and signatures. */
#ifndef VIDEG_BENCH_FMI2_H
#define VIDEG_BENCH_FMI2_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2FMUstate;
typedef const char *fmi2String;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Boolean;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;

typedef struct {
    void (*logger)(void *environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String message,
                   ...);
    void *(*allocate_memory)(size_t count, size_t size);
    void (*free_memory)(void *memory);
    void (*step_finished)(void *environment, fmi2Status status);
    void *environment;
} fmi2CallbackFunctions;

typedef fmi2Component fmi2InstantiateTYPE(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging);
typedef void fmi2FreeInstanceTYPE(fmi2Component component);
typedef fmi2Status fmi2SetupExperimentTYPE(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop);
typedef fmi2Status fmi2EnterInitializationModeTYPE(fmi2Component component);
typedef fmi2Status fmi2ExitInitializationModeTYPE(fmi2Component component);
typedef fmi2Status fmi2GetRealTYPE(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   fmi2Real values[]);
typedef fmi2Status fmi2SetRealTYPE(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   const fmi2Real values[]);
typedef fmi2Status fmi2DoStepTYPE(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean no_set_state);
typedef fmi2Status fmi2GetFMUstateTYPE(fmi2Component component, fmi2FMUstate *state);
typedef fmi2Status fmi2SetFMUstateTYPE(fmi2Component component, fmi2FMUstate state);
typedef fmi2Status fmi2FreeFMUstateTYPE(fmi2Component component, fmi2FMUstate *state);

#endif
