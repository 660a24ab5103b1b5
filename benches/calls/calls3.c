/* calls3 LIBRARY RESOURCES TOKEN SET,… GET,… N: nanoseconds of FMI 3 calls, as `name best median` lines.

   N is the number of values that the variables to get have together. As calls.c otherwise. */
#define _GNU_SOURCE
#include "../../tests/c_api/v3/fmi3.h"
#include "batch.h"
#include <dlfcn.h>
#include <string.h>

static struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI3_FUNCTIONS(MEMBER)
#undef MEMBER
} fmu;

enum { MOST = 256 };

#define MEASURE(name, ...)                                            \
    do {                                                              \
        for (int b = 0; b < BATCHES; b++) {                           \
            double begin = now(CLOCK_MONOTONIC);                      \
            for (int i = 0; i < 1000; i++) {                          \
                __VA_ARGS__;                                          \
            }                                                         \
            batch[b] = (now(CLOCK_MONOTONIC) - begin) / 1000;         \
        }                                                             \
        tell(name);                                                   \
    } while (0)

static void ok(fmi3Status status, const char *what)
{
    if (status != fmi3OK) {
        printf("%s failed\n", what);
        exit(1);
    }
}

static size_t list(char *text, fmi3ValueReference *references)
{
    size_t n = 0;
    for (char *part = strtok(text, ","); part && n < MOST; part = strtok(NULL, ","))
        references[n++] = (fmi3ValueReference)strtoul(part, NULL, 10);
    return n;
}

int main(int argc, char **argv)
{
    static fmi3ValueReference inputs[MOST], outputs[MOST];
    static double set[MOST], got[MOST];
    bool event, end, early;
    double reached;
    fmi3Instance c;
    void *library;
    size_t n_in, n_out, n;
    if (argc != 7)
        return 2;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        printf("%s\n", dlerror());
        return 1;
    }
#define FIND(result, name, arguments) *(void **)&fmu.name = dlsym(library, "fmi3" #name);
    FMI3_FUNCTIONS(FIND)
#undef FIND
    n_in = list(argv[4], inputs);
    n_out = list(argv[5], outputs);
    n = strtoul(argv[6], NULL, 10);
    if (n > MOST)
        return 2;
    c = fmu.InstantiateCoSimulation("bench", argv[3], argv[2], 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
    if (!c)
        return 1;
    ok(fmu.EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0), "fmi3EnterInitializationMode");
    ok(fmu.ExitInitializationMode(c), "fmi3ExitInitializationMode");
    ok(fmu.GetFloat64(c, inputs, n_in, set, n_in), "fmi3GetFloat64");
    ok(fmu.DoStep(c, 0.0, 1.0, 1, &event, &end, &early, &reached), "fmi3DoStep");
    ok(fmu.GetFloat64(c, outputs, n_out, got, n), "fmi3GetFloat64");
    MEASURE("set", fmu.SetFloat64(c, inputs, n_in, set, n_in));
    MEASURE("get", fmu.GetFloat64(c, outputs, n_out, got, n));
    /* A step that ends in the present, within the tolerance of time: everything of a step but the physics. */
    MEASURE("step without physics", fmu.DoStep(c, reached - 1e-10, 1e-11, 1, &event, &end, &early, &reached));
    MEASURE("set, get and step without physics", {
        fmu.SetFloat64(c, inputs, n_in, set, n_in);
        fmu.DoStep(c, reached - 1e-10, 1e-11, 1, &event, &end, &early, &reached);
        fmu.GetFloat64(c, outputs, n_out, got, n);
    });
    fmu.FreeInstance(c);
    return 0;
}
