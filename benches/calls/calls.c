/* calls LIBRARY RESOURCES GUID SET,… GET,…: nanoseconds of FMI calls, as `name best median` lines.

   Each figure is the time of a batch over its length; best and median over the batches. */
#define _GNU_SOURCE
#include "../../tests/c_api/fmi2.h"
#include "batch.h"
#include <dlfcn.h>
#include <string.h>

static struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI2_FUNCTIONS(MEMBER)
#undef MEMBER
} fmu;

enum { MOST = 256 };

/* Batches of about 2 ms: a call that takes longer is a batch of its own. */
#define MEASURE(name, ...)                                            \
    do {                                                              \
        double first = now(CLOCK_MONOTONIC);                          \
        int count = 1;                                                \
        for (int i = 0; i < 1; i++) {                                 \
            __VA_ARGS__;                                              \
        }                                                             \
        first = now(CLOCK_MONOTONIC) - first;                         \
        if (first < 2e6)                                              \
            count = first < 2e3 ? 1000 : (int)(2e6 / first);          \
        for (int b = 0; b < BATCHES; b++) {                           \
            double begin = now(CLOCK_MONOTONIC);                      \
            for (int i = 0; i < count; i++) {                         \
                __VA_ARGS__;                                          \
            }                                                         \
            batch[b] = (now(CLOCK_MONOTONIC) - begin) / count;        \
        }                                                             \
        tell(name);                                                   \
    } while (0)

static void ok(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        printf("%s failed\n", what);
        exit(1);
    }
}

static size_t list(char *text, fmi2ValueReference *references)
{
    size_t n = 0;
    for (char *part = strtok(text, ","); part && n < MOST; part = strtok(NULL, ","))
        references[n++] = (fmi2ValueReference)strtoul(part, NULL, 10);
    return n;
}

int main(int argc, char **argv)
{
    static fmi2ValueReference inputs[MOST], outputs[MOST];
    static double set[MOST], got[MOST];
    fmi2CallbackFunctions silent = {NULL, NULL, NULL, NULL, NULL};
    fmi2FMUstate state = NULL;
    fmi2Component c;
    void *library;
    size_t n_in, n_out;
    double time = 0.0;
    if (argc != 6)
        return 2;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        printf("%s\n", dlerror());
        return 1;
    }
#define FIND(result, name, arguments) *(void **)&fmu.name = dlsym(library, "fmi2" #name);
    FMI2_FUNCTIONS(FIND)
#undef FIND
    n_in = list(argv[4], inputs);
    n_out = list(argv[5], outputs);
#define MAKE() fmu.Instantiate("bench", fmi2CoSimulation, argv[3], argv[2], &silent, 0, 0)
    MEASURE("instantiate", {
        c = MAKE();
        if (!c)
            return 1;
        fmu.FreeInstance(c);
    });
    c = MAKE();
    ok(fmu.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
    ok(fmu.EnterInitializationMode(c), "fmi2EnterInitializationMode");
    ok(fmu.ExitInitializationMode(c), "fmi2ExitInitializationMode");
    ok(fmu.GetReal(c, inputs, n_in, set), "fmi2GetReal");
    ok(fmu.DoStep(c, 0.0, 1.0, 1), "fmi2DoStep");
    time = 1.0;
    MEASURE("set", fmu.SetReal(c, inputs, n_in, set));
    MEASURE("get", fmu.GetReal(c, outputs, n_out, got));
    /* A step that ends in the present, within the tolerance of time: everything of a step but the physics. */
    MEASURE("step without physics", fmu.DoStep(c, time - 1e-10, 1e-11, 1));
    MEASURE("set, get and step without physics", {
        fmu.SetReal(c, inputs, n_in, set);
        fmu.DoStep(c, time - 1e-10, 1e-11, 1);
        fmu.GetReal(c, outputs, n_out, got);
    });
    /* Drives: wheels at changing speeds, all outputs read after each step. */
    MEASURE("step of 1/240 s with physics", {
        double h = 1.0 / 240.0;
        set[0] = 5.0 + (i % 7);
        fmu.SetReal(c, inputs, n_in, set);
        if (fmu.DoStep(c, time, h, 1) != fmi2OK)
            return 1;
        time += h;
        fmu.GetReal(c, outputs, n_out, got);
    });
    ok(fmu.GetFMUstate(c, &state), "fmi2GetFMUstate");
    MEASURE("save and restore", {
        fmu.GetFMUstate(c, &state);
        fmu.SetFMUstate(c, state);
    });
    ok(fmu.FreeFMUstate(c, &state), "fmi2FreeFMUstate");
    fmu.FreeInstance(c);
    return 0;
}
