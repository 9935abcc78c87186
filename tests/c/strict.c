/* A client to which anything but fmi2OK is a failure, as it is to many importers: it runs every ordinary sequence of calls on the
 * library of an FMU, for co-simulation and model exchange, and reads everything wherever FMI 2.0 or the custom of importers has it. Where the
 * C library can, floating-point exceptions end it, as they do in hosts that trap them.
 *
 *     cc -I HEADERS strict.c -ldl -lm -o strict
 *     strict LIBRARY GUID <table
 *
 * The table has a line of words each: "interface CoSimulation|ModelExchange", "states N", "indicators N", "derivatives"
 * if there are directional ones, and for each variable
 *
 *     variable REFERENCE real|integer|boolean|string ROLE START
 *
 * with the role parameter, input, output, derivative, state (which is an output, too) or rest. Each call that returns another
 * status is named once for each sequence; the last line counts the calls. Ends with 1 if there was any.
 */

#include "strict.h"

/* --- values ------------------------------------------------------------------------------------------------------- */

static void get(fmi2ValueReference reference, char kind, fmi2Real *value)
{
    fmi2Integer whole;
    fmi2String text;
    if (kind == 'r')
        CALL(fmi2GetReal, &reference, 1, value);
    else if (kind == 'i')
        CALL(fmi2GetInteger, &reference, 1, &whole);
    else if (kind == 'b')
        CALL(fmi2GetBoolean, &reference, 1, &whole);
    else
        CALL(fmi2GetString, &reference, 1, &text);
}

/* Each variable; keeps what is Real. */
static void get_everything(fmi2Real *values)
{
    fmi2Real unused[MOST];
    size_t index;
    for (index = 0; index < variable_count; index++) {
        fmi2Real *value = (values == NULL ? unused : values) + index;
        *value = 0.0;
        get(variables[index].reference, variables[index].kind, value);
    }
}

/* Every variable of a role: to its start value, a Real input to one that swings about it. */
static void set_all(char role, double time)
{
    size_t index;
    for (index = 0; index < variable_count; index++) {
        const fmi2ValueReference *reference = &variables[index].reference;
        fmi2String text = variables[index].start;
        fmi2Integer whole = atoi(text);
        fmi2Real real = strtod(text, NULL);
        if (variables[index].role != role)
            continue;
        if (role == 'i')
            real += (real == 0.0 ? 0.01 : 0.1 * real) * sin(5.0 * time);
        if (variables[index].kind == 'r')
            CALL(fmi2SetReal, reference, 1, &real);
        else if (variables[index].kind == 'i')
            CALL(fmi2SetInteger, reference, 1, &whole);
        else if (variables[index].kind == 'b')
            CALL(fmi2SetBoolean, reference, 1, &whole);
        else {
            /* The word for an empty text. */
            if (strcmp(text, "-") == 0)
                text = "";
            CALL(fmi2SetString, reference, 1, &text);
        }
    }
}

/* All derivatives of outputs and of the derivatives of states, by the roles of knowns. */
static void get_derivatives(const char *known_roles)
{
    const fmi2Real seed = 1.0;
    fmi2Real value;
    size_t unknown, known;
    for (unknown = 0; has_derivatives && unknown < variable_count; unknown++)
        for (known = 0; known < variable_count; known++)
            if (variables[unknown].kind == 'r' && strchr("odx", variables[unknown].role) != NULL &&
                variables[known].kind == 'r' && strchr(known_roles, variables[known].role) != NULL)
                CALL(fmi2GetDirectionalDerivative, &variables[unknown].reference, 1, &variables[known].reference, 1, &seed,
                     &value);
}

/* --- states ------------------------------------------------------------------------------------------------------- */

static fmi2FMUstate save(void)
{
    fmi2FMUstate state = NULL;
    CALL(fmi2GetFMUstate, &state);
    return state;
}

/* Saves, serialises, restores from the bytes and from the state; what is read stays the same. */
static void save_and_restore(void)
{
    fmi2Real before[MOST], after[MOST];
    fmi2FMUstate state, copy = NULL;
    size_t size = 0;
    fmi2Byte *bytes;
    get_everything(before);
    state = save();
    CALL(fmi2GetFMUstate, &state);
    CALL(fmi2SerializedFMUstateSize, state, &size);
    bytes = malloc(size + 1);
    CALL(fmi2SerializeFMUstate, state, bytes, size);
    CALL(fmi2DeSerializeFMUstate, bytes, size, &copy);
    free(bytes);
    CALL(fmi2SetFMUstate, copy);
    CALL(fmi2SetFMUstate, state);
    CALL(fmi2FreeFMUstate, &copy);
    CALL(fmi2FreeFMUstate, &state);
    CALL(fmi2FreeFMUstate, &state);
    get_everything(after);
    if (memcmp(before, after, variable_count * sizeof before[0]) != 0)
        complain("fmi2SetFMUstate", "gives other values");
}

/* --- the way to the first step ------------------------------------------------------------------------------------ */

/* Without an experiment, an input or a Get. */
static void initialize(void)
{
    CALL(fmi2EnterInitializationMode);
    CALL(fmi2ExitInitializationMode);
}

/* With all that importers do before and in initialization mode. */
static void initialize_thoroughly(double stop)
{
    const fmi2String categories[] = {"logAll", "logEvents", "logOfAnotherTool"};
    CALL(fmi2SetDebugLogging, fmi2True, 3, categories);
    CALL(fmi2SetDebugLogging, fmi2True, 2, categories + 1);
    CALL(fmi2SetDebugLogging, fmi2False, 0, NULL);
    get_everything(NULL);
    set_all('p', 0.0);
    set_all('i', 0.0);
    get_everything(NULL);
    save_and_restore();
    CALL(fmi2SetupExperiment, fmi2True, 1e-6, 0.0, fmi2True, stop);
    CALL(fmi2EnterInitializationMode);
    get_everything(NULL);
    set_all('p', 0.0);
    set_all('i', 0.0);
    get_everything(NULL);
    get_derivatives("pi");
    save_and_restore();
    CALL(fmi2ExitInitializationMode);
    get_everything(NULL);
}

static void finish(void)
{
    get_everything(NULL);
    CALL(fmi2Terminate);
    get_everything(NULL);
    save_and_restore();
    CALL(fmi2Reset);
    get_everything(NULL);
}

/* --- co-simulation ------------------------------------------------------------------------------------------------ */

static void status_of_step(void)
{
    fmi2Status status;
    fmi2Real time;
    fmi2Boolean terminated;
    CALL(fmi2GetStatus, fmi2DoStepStatus, &status);
    check(status);
    CALL(fmi2GetRealStatus, fmi2LastSuccessfulTime, &time);
    CALL(fmi2GetBooleanStatus, fmi2Terminated, &terminated);
}

static void plain_steps(void)
{
    int step;
    initialize();
    for (step = 0; step < 200; step++)
        CALL(fmi2DoStep, step * 0.01, 0.01, fmi2True);
    get_everything(NULL);
    CALL(fmi2Terminate);
    CALL(fmi2Reset);
}

static void thorough_steps(void)
{
    int step;
    initialize_thoroughly(5.0);
    for (step = 0; step < 500; step++) {
        set_all('i', step * 0.01);
        get_everything(NULL);
        CALL(fmi2DoStep, step * 0.01, 0.01, fmi2False);
        status_of_step();
        get_everything(NULL);
        if (step % 50 == 0)
            get_derivatives("ix");
        if (step % 50 == 25)
            save_and_restore();
    }
    finish();
}

/* Each step is tried, taken back and done. */
static void repeated_steps(void)
{
    int step;
    initialize_thoroughly(2.0);
    for (step = 0; step < 200; step++) {
        fmi2FMUstate state = save();
        CALL(fmi2DoStep, step * 0.01, 0.01, fmi2False);
        CALL(fmi2SetFMUstate, state);
        CALL(fmi2DoStep, step * 0.01, 0.005, fmi2False);
        CALL(fmi2DoStep, step * 0.01 + 0.005, 0.005, fmi2False);
        CALL(fmi2FreeFMUstate, &state);
    }
    finish();
}

/* A clock in single precision. */
static void coarse_clock(void)
{
    int step;
    initialize();
    for (step = 0; step < 10000; step++)
        CALL(fmi2DoStep, (float)step * 0.01f, 0.01f, fmi2True);
    finish();
}

/* --- model exchange ----------------------------------------------------------------------------------------------- */

static void get_continuous(fmi2Real *states, fmi2Real *rates, fmi2Real *indicators)
{
    fmi2Real nominals[MOST];
    CALL(fmi2GetContinuousStates, states, state_count);
    CALL(fmi2GetDerivatives, rates, state_count);
    CALL(fmi2GetEventIndicators, indicators, indicator_count);
    CALL(fmi2GetNominalsOfContinuousStates, nominals, state_count);
}

/* Iterates the event, looks at all there is, and goes on; gives the time of the next time event. */
static double handle_event(double time)
{
    fmi2EventInfo info = {fmi2True, fmi2False, fmi2False, fmi2False, fmi2False, 0.0};
    set_all('i', time);
    while (info.newDiscreteStatesNeeded && !info.terminateSimulation)
        CALL(fmi2NewDiscreteStates, &info);
    get_everything(NULL);
    get_derivatives("ix");
    save_and_restore();
    CALL(fmi2EnterContinuousTimeMode);
    return info.nextEventTimeDefined ? info.nextEventTime : HUGE_VAL;
}

static void euler(void)
{
    const double step = 1e-3;
    fmi2Real states[MOST], rates[MOST], before[MOST], after[MOST];
    fmi2Boolean enter, terminate;
    double next, time = 0.0;
    size_t index;
    initialize_thoroughly(5.0);
    next = handle_event(time);
    while (time < 5.0) {
        int due = 0;
        get_continuous(states, rates, before);
        for (index = 0; index < state_count; index++)
            states[index] += step * rates[index];
        time += step;
        CALL(fmi2SetTime, time);
        CALL(fmi2SetContinuousStates, states, state_count);
        set_all('i', time);
        get_continuous(states, rates, after);
        CALL(fmi2CompletedIntegratorStep, fmi2True, &enter, &terminate);
        for (index = 0; index < indicator_count; index++)
            due |= (before[index] > 0.0) != (after[index] > 0.0);
        if ((int)(time / step) % 100 == 0) {
            get_everything(NULL);
            get_derivatives("ix");
            save_and_restore();
        }
        if (due || enter || time >= next) {
            CALL(fmi2EnterEventMode);
            CALL(fmi2SetTime, time);
            next = handle_event(time);
        }
    }
    get_continuous(states, rates, after);
    finish();
}

/* --- all of it ---------------------------------------------------------------------------------------------------- */

static void run(const char *name, fmi2String guid, fmi2Type type, void (*steps)(void))
{
    static const fmi2CallbackFunctions callbacks = {keep_reason, calloc, free, NULL, NULL};
    sequence = name;
    instance = ((fmi2InstantiateTYPE *)function("fmi2Instantiate"))("strict", type, guid, NULL, &callbacks, fmi2False,
                                                                    fmi2True);
    if (instance == NULL)
        give_up("fmi2Instantiate gave NULL", guid);
    steps();
    if (steps != plain_steps)
        steps(); /* once more after the reset */
    ((fmi2FreeInstanceTYPE *)function("fmi2FreeInstance"))(instance);
}

int main(int count, char **arguments)
{
    if (count != 3)
        give_up("usage", "strict LIBRARY GUID <table");
    setvbuf(stdout, NULL, _IOLBF, 0);
    library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL)
        give_up("cannot load", dlerror());
    read_table();
    trap();
    if (interfaces[0]) {
        run("plain steps", arguments[2], fmi2CoSimulation, plain_steps);
        run("steps", arguments[2], fmi2CoSimulation, thorough_steps);
        run("repeated steps", arguments[2], fmi2CoSimulation, repeated_steps);
        run("clock in single precision", arguments[2], fmi2CoSimulation, coarse_clock);
    }
    if (interfaces[1])
        run("model exchange", arguments[2], fmi2ModelExchange, euler);
    printf("%lu calls, %zu of them other than fmi2OK\n", call_count, complaint_count);
    return complaint_count != 0;
}
