/* An FMU for co-simulation that does what the macros below say, for tests. */
#define _GNU_SOURCE
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#ifndef LOADING
#define LOADING
#endif
#ifndef INSTANTIATE
#define INSTANTIATE
#endif
#ifndef SETUP
#define SETUP
#endif
#ifndef BEGIN
#define BEGIN
#endif
#ifndef STEP
#define STEP
#endif
/* Value of the Real variable v from the inputs u. */
#ifndef VALUE
#define VALUE(v) ((v) ? 0.0 : self->y)
#endif
#ifndef SIZE
#define SIZE sizeof(struct instance)
#endif
#ifndef UNLOADING
#define UNLOADING
#endif
#ifndef FREE
#define FREE
#endif

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
struct callbacks {
    logger_t logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
};
struct instance {
    const struct callbacks *callbacks;
    double y;
    double u[8]; /* Reals that were set, by value reference */
    double kept; /* of the macros */
};
typedef struct instance *C;
typedef const unsigned *VR;

#define LOG(status, ...) \
    self->callbacks->logger(self->callbacks->environment, "toy", status, "logStatusError", __VA_ARGS__)

__attribute__((constructor)) static void loading(void) { LOADING }
__attribute__((destructor)) static void unloading(void) { UNLOADING }

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

C fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const struct callbacks *callbacks,
                  int visible, int debug) {
    C self = calloc(1, sizeof *self);
    (void)name, (void)type, (void)guid, (void)resources, (void)visible, (void)debug;
    self->callbacks = callbacks;
    INSTANTIATE
    return self;
}

void fmi2FreeInstance(C self) {
    FREE
    free(self);
}

int fmi2SetDebugLogging(C self, int on, size_t n, const char *const *names) {
    (void)self, (void)on, (void)n, (void)names;
    return 0;
}

int fmi2SetupExperiment(C self, int has, double tolerance, double start, int stops, double stop) {
    (void)self, (void)has, (void)tolerance, (void)start, (void)stops, (void)stop;
    SETUP
    return 0;
}

int fmi2DoStep(C self, double time, double step, int forget) {
    (void)forget;
    STEP
    self->y = time + step;
    return 0;
}

int fmi2GetReal(C self, VR vr, size_t n, double *values) {
    for (size_t i = 0; i < n; ++i)
        values[i] = VALUE(vr[i]);
    return 0;
}

int fmi2SetReal(C self, VR vr, size_t n, const double *values) {
    for (size_t i = 0; i < n; ++i)
        self->u[vr[i] % 8] = values[i];
    return 0;
}

int fmi2GetString(C self, VR vr, size_t n, const char **values) {
    (void)self, (void)vr;
    for (size_t i = 0; i < n; ++i)
        values[i] = "text";
    return 0;
}

int fmi2GetFMUstate(C self, C *state) {
    if (!*state)
        *state = malloc(sizeof *self);
    **state = *self;
    return 0;
}

int fmi2SetFMUstate(C self, C state) {
    *self = *state;
    return 0;
}

int fmi2FreeFMUstate(C self, C *state) {
    (void)self;
    free(*state);
    *state = NULL;
    return 0;
}

int fmi2SerializedFMUstateSize(C self, C state, size_t *size) {
    (void)self, (void)state;
    *size = SIZE;
    return 0;
}

int fmi2SerializeFMUstate(C self, C state, char *to, size_t size) {
    (void)self;
    memcpy(to, state, size);
    return 0;
}

int fmi2DeSerializeFMUstate(C self, const char *from, size_t size, C *state) {
    (void)self;
    *state = malloc(size);
    memcpy(*state, from, size);
    return 0;
}

int fmi2ExitInitializationMode(C self) {
    BEGIN
    return 0;
}

#define PLAIN(name) \
    int name(C self) { \
        (void)self; \
        return 0; \
    }
PLAIN(fmi2EnterInitializationMode)
PLAIN(fmi2Terminate)
PLAIN(fmi2Reset)
PLAIN(fmi2CancelStep)

#define ACCESS(name, type) \
    int name(C self, VR vr, size_t n, type *values) { \
        (void)self, (void)vr, (void)n, (void)values; \
        return 0; \
    }
ACCESS(fmi2GetInteger, int)
ACCESS(fmi2GetBoolean, int)
ACCESS(fmi2SetInteger, const int)
ACCESS(fmi2SetBoolean, const int)
ACCESS(fmi2SetString, const char *const)

#define STATUS(name, type) \
    int name(C self, int kind, type *value) { \
        (void)self, (void)kind, (void)value; \
        return 2; \
    }
STATUS(fmi2GetStatus, int)
STATUS(fmi2GetRealStatus, double)
STATUS(fmi2GetIntegerStatus, int)
STATUS(fmi2GetBooleanStatus, int)
STATUS(fmi2GetStringStatus, const char *)

int fmi2GetDirectionalDerivative(C self, VR a, size_t n, VR b, size_t m, const double *seed, double *result) {
    (void)self, (void)a, (void)n, (void)b, (void)m, (void)seed, (void)result;
    return 3;
}
int fmi2SetRealInputDerivatives(C self, VR vr, size_t n, const int *orders, const double *values) {
    (void)self, (void)vr, (void)n, (void)orders, (void)values;
    return 3;
}
int fmi2GetRealOutputDerivatives(C self, VR vr, size_t n, const int *orders, double *values) {
    (void)self, (void)vr, (void)n, (void)orders, (void)values;
    return 3;
}
