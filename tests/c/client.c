/* Drives one instance of an FMU for co-simulation through the C functions, declared by the standard's own headers, as
 * the lines on standard input say. Linked with the library of the FMU:
 *
 *     cc -I HEADERS client.c LIBRARY -o client
 *     client GUID <commands
 *
 * A command is one line of words; numbers are in any form that C reads. After what it answers comes the line "status"
 * with the status of its last call. What the FMU logs comes as lines "log" with status, category and text.
 *
 *     real|integer|boolean REFERENCE VALUE     set a variable
 *     initialize START                         set up the experiment, enter and exit initialization mode
 *     step TIME SIZE                           do a step
 *     reals|integers|booleans REFERENCE...     answers "values" and the values, Reals to the last bit
 *     save FILE                                write the serialised state into a file
 *     load FILE                                go to the state in a file
 */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

static const char *const STATUSES[] = {"fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending"};

static void give_up(const char *what, const char *about)
{
    fprintf(stderr, "client: %s: %s\n", what, about);
    exit(2);
}

static void log_line(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                     fmi2String message, ...)
{
    va_list arguments;
    (void)environment;
    (void)instance;
    printf("log %s %s ", STATUSES[status], category);
    va_start(arguments, message);
    vprintf(message, arguments);
    va_end(arguments);
    putchar('\n');
}

/* The next word of the line. */
static const char *word(void)
{
    const char *found = strtok(NULL, " \n");
    if (found == NULL)
        give_up("incomplete command", "a word is missing");
    return found;
}

static fmi2ValueReference reference(const char *text)
{
    return (fmi2ValueReference)strtoul(text, NULL, 10);
}

static fmi2Status set_real(fmi2Component instance)
{
    fmi2ValueReference variable = reference(word());
    fmi2Real value = strtod(word(), NULL);
    return fmi2SetReal(instance, &variable, 1, &value);
}

static fmi2Status set_integer(fmi2Component instance)
{
    fmi2ValueReference variable = reference(word());
    fmi2Integer value = atoi(word());
    return fmi2SetInteger(instance, &variable, 1, &value);
}

static fmi2Status set_boolean(fmi2Component instance)
{
    fmi2ValueReference variable = reference(word());
    fmi2Boolean value = atoi(word());
    return fmi2SetBoolean(instance, &variable, 1, &value);
}

static fmi2Status initialize(fmi2Component instance)
{
    fmi2Status status = fmi2SetupExperiment(instance, fmi2False, 0.0, strtod(word(), NULL), fmi2False, 0.0);
    if (status == fmi2OK)
        status = fmi2EnterInitializationMode(instance);
    if (status == fmi2OK)
        status = fmi2ExitInitializationMode(instance);
    return status;
}

static fmi2Status step(fmi2Component instance)
{
    fmi2Real time = strtod(word(), NULL);
    fmi2Real size = strtod(word(), NULL);
    return fmi2DoStep(instance, time, size, fmi2True);
}

static fmi2Status get_reals(fmi2Component instance)
{
    const char *next;
    fmi2Status status = fmi2OK;
    printf("values");
    while (status == fmi2OK && (next = strtok(NULL, " \n")) != NULL) {
        fmi2ValueReference variable = reference(next);
        fmi2Real value = 0.0;
        status = fmi2GetReal(instance, &variable, 1, &value);
        printf(" %a", value);
    }
    putchar('\n');
    return status;
}

static fmi2Status get_whole(fmi2Component instance, fmi2GetIntegerTYPE *get)
{
    const char *next;
    fmi2Status status = fmi2OK;
    printf("values");
    while (status == fmi2OK && (next = strtok(NULL, " \n")) != NULL) {
        fmi2ValueReference variable = reference(next);
        fmi2Integer value = 0;
        status = get(instance, &variable, 1, &value);
        printf(" %d", value);
    }
    putchar('\n');
    return status;
}

static fmi2Status get_integers(fmi2Component instance)
{
    return get_whole(instance, fmi2GetInteger);
}

/* In FMI 2.0 a Boolean is an int, as an Integer is. */
static fmi2Status get_booleans(fmi2Component instance)
{
    return get_whole(instance, fmi2GetBoolean);
}

static fmi2Status save(fmi2Component instance)
{
    const char *path = word();
    fmi2FMUstate state = NULL;
    size_t size = 0;
    fmi2Status status = fmi2GetFMUstate(instance, &state);
    if (status == fmi2OK)
        status = fmi2SerializedFMUstateSize(instance, state, &size);
    if (status == fmi2OK) {
        fmi2Byte *bytes = malloc(size);
        FILE *file = fopen(path, "wb");
        if (bytes == NULL || file == NULL)
            give_up("cannot write", path);
        status = fmi2SerializeFMUstate(instance, state, bytes, size);
        if (fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
            give_up("cannot write", path);
        free(bytes);
    }
    return status == fmi2OK ? fmi2FreeFMUstate(instance, &state) : status;
}

static fmi2Status load(fmi2Component instance)
{
    enum { LARGEST = 1 << 20 };
    const char *path = word();
    fmi2FMUstate state = NULL;
    fmi2Byte *bytes = malloc(LARGEST);
    FILE *file = fopen(path, "rb");
    size_t size;
    fmi2Status status;
    if (bytes == NULL || file == NULL)
        give_up("cannot read", path);
    size = fread(bytes, 1, LARGEST, file);
    fclose(file);
    status = fmi2DeSerializeFMUstate(instance, bytes, size, &state);
    free(bytes);
    if (status == fmi2OK)
        status = fmi2SetFMUstate(instance, state);
    return status == fmi2OK ? fmi2FreeFMUstate(instance, &state) : status;
}

static const struct {
    const char *name;
    fmi2Status (*run)(fmi2Component);
} COMMANDS[] = {
    {"real", set_real},       {"integer", set_integer},   {"boolean", set_boolean},
    {"initialize", initialize}, {"step", step},           {"save", save},
    {"load", load},           {"reals", get_reals},       {"integers", get_integers},
    {"booleans", get_booleans},
};

static fmi2Status run(fmi2Component instance, const char *name)
{
    size_t index;
    for (index = 0; index < sizeof COMMANDS / sizeof COMMANDS[0]; index++)
        if (strcmp(COMMANDS[index].name, name) == 0)
            return COMMANDS[index].run(instance);
    give_up("no such command", name);
    return fmi2Fatal;
}

int main(int count, char **arguments)
{
    static const fmi2CallbackFunctions callbacks = {log_line, calloc, free, NULL, NULL};
    static char line[4096];
    fmi2Component instance;
    if (count != 2)
        give_up("usage", "client GUID <commands");
    instance = fmi2Instantiate("client", fmi2CoSimulation, arguments[1], NULL, &callbacks, fmi2False, fmi2True);
    if (instance == NULL)
        give_up("fmi2Instantiate gave NULL for the GUID", arguments[1]);
    while (fgets(line, sizeof line, stdin) != NULL) {
        const char *name = strtok(line, " \n");
        if (name != NULL)
            printf("status %s\n", STATUSES[run(instance, name)]);
    }
    fmi2FreeInstance(instance);
    return 0;
}
