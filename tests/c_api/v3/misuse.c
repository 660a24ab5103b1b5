/* Instances that cannot be, wrong pointers, logging. */
#include "importer3.h"
#include "robot.h"
#include <stdio.h>
#include <string.h>

static void never(fmi3InstanceEnvironment e, double t, bool a, bool b, bool f, bool m, bool *end, double *when)
{
    (void)e, (void)t, (void)a, (void)b, (void)f, (void)m, (void)end, (void)when;
    CHECK(false, "nothing is required");
}

#define REFUSED(words, ...)                                                                     \
    do {                                                                                        \
        forget();                                                                               \
        CHECK(fmu3.InstantiateCoSimulation(__VA_ARGS__) == NULL, "expected no instance");       \
        CHECK(heard.messages == 1 && heard.status == fmi2Error, "expected one error");          \
        CHECK(strstr(heard.text, words) != NULL, "expected '%s'", words);                       \
    } while (0)

/* The path of the URI of the resources, as FMI 3 has it. */
static void plain_path(char *path, size_t size)
{
    const char *from = resources + strlen("file:");
    from += strspn(from, "/");
#ifndef _WIN32
    from--; /* on Windows it begins with the drive */
#endif
    size_t length = 0;
    for (; *from && length + 2 < size; length++) {
        unsigned int byte;
        if (sscanf(from, "%%%2x", &byte) == 1) {
            path[length] = (char)byte;
            from += 3;
        } else {
            path[length] = *from++;
        }
    }
    path[length] = 0;
}

void test_v3_instantiate(void)
{
    const fmi3ValueReference velocity[] = {LEFT_VELOCITY}, steps[] = {STEPS}, mass[] = {BASE_MASS}, z[] = {BASE_Z};
    char path[4096];
    fmi3Instance c;
    REFUSED("eventModeUsed", "r", guid, resources, 0, 0, 1, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("intermediateUpdate is NULL", "r", guid, resources, 0, 0, 0, 0, velocity, 1, &heard, logger3, NULL);
    REFUSED("NULL", "r", guid, resources, 0, 0, 0, 0, NULL, 1, &heard, logger3, never);
    REFUSED("elements", "r", guid, resources, 0, 0, 0, 0, velocity, SIZE_MAX, &heard, logger3, never);
    REFUSED("solver.steps", "r", guid, resources, 0, 0, 0, 0, steps, 1, &heard, logger3, never);
    REFUSED("link.base_link.mass", "r", guid, resources, 0, 0, 0, 0, mass, 1, &heard, logger3, never);
    REFUSED("base.position", "r", guid, resources, 0, 0, 0, 0, z, 1, &heard, logger3, never);
    REFUSED("instantiationToken", "r", "{wrong}", resources, 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("instantiationToken", "r", NULL, resources, 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("resourcePath is empty", "r", guid, NULL, 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("resourcePath is empty", "r", guid, "", 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("https", "r", guid, "https://x/y", 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    REFUSED("cannot read", "r", guid, "/nowhere/", 0, 0, 0, 0, NULL, 0, &heard, logger3, NULL);
    CHECK(fmu3.InstantiateCoSimulation(NULL, NULL, NULL, 1, 1, 1, 1, NULL, 0, NULL, NULL, NULL) == NULL, "null");
    forget();
    CHECK(fmu3.InstantiateModelExchange("r", guid, resources, 0, 0, &heard, logger3) == NULL, "ME");
    CHECK(heard.messages == 1 && strstr(heard.text, "co-simulation"), "why");
    forget();
    CHECK(fmu3.InstantiateScheduledExecution("r", guid, resources, 0, 0, &heard, logger3, NULL, NULL, NULL) == NULL,
          "SE");
    CHECK(heard.messages == 1 && strstr(heard.text, "co-simulation"), "why");

    /* A path, with or without a separator at its end, instead of a URI. */
    for (int i = 0; i < 2; i++) {
        plain_path(path, sizeof path);
        if (i)
            strcat(path, "/");
        c = fmu3.InstantiateCoSimulation(NULL, guid, path, 1, 1, 0, 0, NULL, 0, NULL, NULL, NULL);
        CHECK(c != NULL, "%s", path);
        CHECK(fmu3.ExitInitializationMode(c) == fmi3Error, "without a logger");
        fmu3.FreeInstance(c);
    }
    /* A callback without anything to do is not called. */
    c = fmu3.InstantiateCoSimulation("r", guid, resources, 0, 0, 0, 0, NULL, 0, &heard, logger3, never);
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(c));
    CHECK(step3(c, 0.0, 0.1) == fmi3OK, "step");
    CHECK_ERROR(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0), "step mode");
    CHECK(fmu3.Reset(c) == fmi3OK, "reset");
    CHECK_ERROR(fmu3.EnterInitializationMode(c, true, -1.0, 0.0, false, 0.0), "tolerance");
    CHECK_ERROR(fmu3.EnterInitializationMode(c, false, 0.0, 1.0, true, 0.5), "stopTime");
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 1.0, true, 1.5));
    fmu3.FreeInstance(c);
}

static fmi3Instance inside;
static fmi3Status reentered;

static void reenter(void)
{
    heard.reenter = NULL;
    reentered = fmu3.Reset(inside);
    fmu3.FreeInstance(inside);
}

void test_v3_logging(void)
{
    const fmi3String events[] = {"logEvents"}, unknown[] = {"logWeather"}, null[] = {NULL};
    unsigned long long strange[64] = {7, 7, 7};
    fmi3Instance c = instantiate3();
    CHECK_ERROR(fmu3.SetDebugLogging(c, true, 1, unknown), "logWeather");
    CHECK_ERROR(fmu3.SetDebugLogging(c, true, 1, null), "NULL");
    CHECK_ERROR(fmu3.SetDebugLogging(c, true, 1, NULL), "NULL");
    CHECK_OK(fmu3.SetDebugLogging(c, true, 1, events));
    /* Errors cannot be switched off. */
    CHECK_ERROR(fmu3.ExitInitializationMode(c), "instantiated");
    CHECK_OK(fmu3.SetDebugLogging(c, false, 0, NULL));
    forget();
    inside = c;
    reentered = fmi3OK;
    heard.reenter = reenter;
    CHECK(fmu3.ExitInitializationMode(c) == fmi3Error, "instantiated");
    CHECK(reentered == fmi3Error, "a call from inside the logger");
    CHECK(fmu3.Reset(c) == fmi3OK, "still there");
    fmu3.FreeInstance(c);

    CHECK(fmu3.Reset(NULL) == fmi3Error && fmu3.Reset(strange) == fmi3Error, "no instances");
    CHECK(fmu3.Reset((char *)strange + 1) == fmi3Error, "not even aligned");
    CHECK(step3(NULL, 0.0, 0.1) == fmi3Error, "no instance");
    fmu3.FreeInstance(NULL);
    fmu3.FreeInstance(strange);
}
