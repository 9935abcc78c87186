/* The FMU under test: its table of variables, its C functions, and how each call is checked. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fmi2Functions.h"

enum { MOST = 256 };

static struct {
    fmi2ValueReference reference;
    char kind;
    char role;
    char start[64];
} variables[MOST];
static size_t variable_count, state_count, indicator_count;
static int has_derivatives, interfaces[2];

static void *library;
static fmi2Component instance;
static const char *sequence = "", *running = "";
static char complaints[MOST][128];
static size_t complaint_count;
static unsigned long call_count;
static char reason[256];

static void give_up(const char *what, const char *about)
{
    fprintf(stderr, "strict: %s: %s\n", what, about);
    exit(2);
}

static void complain(const char *call, const char *what)
{
    char line[sizeof complaints[0]];
    size_t index;
    snprintf(line, sizeof line, "%s: %s %s", sequence, call, what);
    for (index = 0; index < complaint_count; index++)
        if (strcmp(complaints[index], line) == 0)
            return;
    if (complaint_count < MOST)
        strcpy(complaints[complaint_count++], line);
    printf("%s (%s)\n", line, reason);
}

static void check(fmi2Status status)
{
    static const char *const NAMES[] = {"fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending"};
    call_count++;
    if (status != fmi2OK)
        complain(running, NAMES[status]);
}

static void *function(const char *name)
{
    void *found = dlsym(library, name);
    if (found == NULL)
        give_up("the library lacks", name);
    running = name;
    reason[0] = '\0';
    return found;
}

/* A call on the instance, by the type that the standard's headers give the function. */
#define CALL(name, ...) check(((name##TYPE *)function(#name))(instance, ##__VA_ARGS__))

static void trapped(int number)
{
    char line[256];
    int length = snprintf(line, sizeof line, "%s: %s raises signal %d (floating-point exception)\n", sequence, running, number);
    if (write(STDOUT_FILENO, line, (size_t)length) != length)
        _exit(2);
    _exit(1);
}

static void trap(void)
{
    signal(SIGFPE, trapped);
#ifdef __GLIBC__
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
#endif
}

/* Keeps the reason of a status other than fmi2OK. */
static void keep_reason(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    va_list arguments;
    (void)environment, (void)name, (void)category;
    va_start(arguments, message);
    if (status != fmi2OK)
        vsnprintf(reason, sizeof reason, message, arguments);
    va_end(arguments);
}

static void read_table(void)
{
    static char line[512];
    while (fgets(line, sizeof line, stdin) != NULL) {
        char kind[16], role[16];
        unsigned reference;
        if (sscanf(line, "variable %u %15s %15s %63s", &reference, kind, role, variables[variable_count].start) == 4) {
            variables[variable_count].reference = reference;
            variables[variable_count].kind = kind[0];
            variables[variable_count].role = strcmp(role, "state") == 0 ? 'x' : role[0];
            if (++variable_count == MOST)
                give_up("too many variables", line);
        } else if (strncmp(line, "derivatives", 11) == 0) {
            has_derivatives = 1;
        } else if (strncmp(line, "interface ", 10) == 0) {
            interfaces[line[10] == 'M'] = 1;
        } else if (sscanf(line, "states %zu", &state_count) != 1 && sscanf(line, "indicators %zu", &indicator_count) != 1) {
            give_up("no such line", line);
        }
    }
}
