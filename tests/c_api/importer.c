#include "importer.h"
#include "robot.h"
#include "system.h"
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

Fmu fmu;
Log heard;
int failures;
const char *guid;
const char *resources;

void load(const char *path)
{
    fmu.library = library_open(path);
    if (!fmu.library) {
        printf("%s: %s\n", path, library_problem());
        exit(2);
    }
#define FIND(result, name, arguments)                                  \
    *(void **)&fmu.name = library_find(fmu.library, "fmi2" #name);     \
    if (!fmu.name) {                                                   \
        printf("fmi2" #name " is not exported\n");                     \
        exit(2);                                                       \
    }
    FMI2_FUNCTIONS(FIND)
#undef FIND
}

void forget(void)
{
    memset(&heard, 0, offsetof(Log, reenter));
}

/* Formats the message as importers do: with printf and no way to know whether arguments follow. */
static void logger(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    va_list arguments;
    if (environment != &heard) {
        printf("the environment pointer came back as %p\n", environment);
        failures++;
        return;
    }
    heard.messages++;
    heard.status = status;
    snprintf(heard.instance, sizeof heard.instance, "%s", instance);
    snprintf(heard.category, sizeof heard.category, "%s", category);
    va_start(arguments, message);
    vsnprintf(heard.text, sizeof heard.text, message, arguments);
    va_end(arguments);
    if (heard.reenter)
        heard.reenter();
}

/* The memory callbacks are null, as some importers pass them. */
const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, &heard};

fmi2Component instantiate(void)
{
    return instantiate_as(fmi2CoSimulation);
}

fmi2Component instantiate_as(fmi2Type type)
{
    fmi2Component c = fmu.Instantiate("robot", type, guid, resources, &callbacks, fmi2False, fmi2False);
    if (!c) {
        printf("fmi2Instantiate failed: %s\n", heard.text);
        exit(2);
    }
    return c;
}

fmi2Component running(void)
{
    fmi2Component c = instantiate();
    CHECK_OK(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    return c;
}

static const fmi2ValueReference reals[] = {REAL_REFERENCES};
enum { REALS = sizeof reals / sizeof *reals };

static void state(fmi2Component c, double values[REALS])
{
    CHECK(fmu.GetReal(c, reals, REALS, values) == fmi2OK, "all variables");
}

void print_state(FILE *file, fmi2Component c)
{
    double values[REALS];
    state(c, values);
    for (int i = 0; i < REALS; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        fprintf(file, "%016llx\n", (unsigned long long)bits);
    }
}

unsigned long long hash_state(fmi2Component c)
{
    double values[REALS];
    const unsigned char *bytes = (const unsigned char *)values;
    unsigned long long hash = 14695981039346656037u;
    state(c, values);
    for (size_t i = 0; i < sizeof values; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

void drive(fmi2Component c, double from, double h, int n)
{
    static const fmi2ValueReference commands[] = {LEFT_VELOCITY, RIGHT_VELOCITY};
    for (int i = 0; i < n; i++) {
        double t = from + i * h;
        double values[2] = {4.0 + t, 4.0 - 2.0 * t};
        CHECK(fmu.SetReal(c, commands, 2, values) == fmi2OK, "commands");
        CHECK(fmu.DoStep(c, t, h, fmi2True) == fmi2OK, "step at %g s", t);
    }
}
