#include "importer3.h"
#include "robot.h"
#include "../system.h"
#include <stdlib.h>
#include <string.h>

Fmu3 fmu3;

void load3(void)
{
#define FIND(result, name, arguments)                                  \
    *(void **)&fmu3.name = library_find(fmu.library, "fmi3" #name);    \
    if (!fmu3.name) {                                                  \
        printf("fmi3" #name " is not exported\n");                     \
        exit(2);                                                       \
    }
    FMI3_FUNCTIONS(FIND)
#undef FIND
}

void logger3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    if (environment != &heard) {
        printf("the environment pointer came back as %p\n", environment);
        failures++;
        return;
    }
    heard.messages++;
    heard.status = (fmi2Status)status;
    snprintf(heard.category, sizeof heard.category, "%s", category);
    snprintf(heard.text, sizeof heard.text, "%s", message);
    if (heard.reenter)
        heard.reenter();
}

fmi3Instance instantiate3(void)
{
    fmi3Instance c = fmu3.InstantiateCoSimulation("robot", guid, resources, false, false, false, false, NULL, 0,
                                                  &heard, logger3, NULL);
    if (!c) {
        printf("fmi3InstantiateCoSimulation failed: %s\n", heard.text);
        exit(2);
    }
    return c;
}

fmi3Instance running3(void)
{
    fmi3Instance c = instantiate3();
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(c));
    return c;
}

static const fmi3ValueReference references[] = {FLOAT64_REFERENCES};

unsigned long long hash_state3(fmi3Instance c)
{
    double values[FLOAT64_COUNT];
    const unsigned char *bytes = (const unsigned char *)values;
    unsigned long long hash = 14695981039346656037u;
    CHECK(fmu3.GetFloat64(c, references, sizeof references / sizeof *references, values, FLOAT64_COUNT) == fmi3OK,
          "all variables");
    for (size_t i = 0; i < sizeof values; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

fmi3Status step3(fmi3Instance c, double t, double h)
{
    bool event = true, end = true, early = true;
    double reached = -1.0;
    fmi3Status status = fmu3.DoStep(c, t, h, true, &event, &end, &early, &reached);
    if (status == fmi3OK) {
        CHECK(!event && !end && !early, "%d %d %d", event, end, early);
        CHECK(reached == t + h, "%.17g instead of %.17g", reached, t + h);
    }
    return status;
}

void drive3(fmi3Instance c, double from, double h, int n)
{
    static const fmi3ValueReference commands[] = {LEFT_VELOCITY, RIGHT_VELOCITY};
    for (int i = 0; i < n; i++) {
        double t = from + i * h;
        double values[2] = {4.0 + t, 4.0 - 2.0 * t};
        CHECK(fmu3.SetFloat64(c, commands, 2, values, 2) == fmi3OK, "commands");
        CHECK(step3(c, t, h) == fmi3OK, "step at %g s", t);
    }
}
