/* derivatives LIBRARY RESOURCES GUID [COUNT]: nanoseconds of processor time that an importer of
   Model Exchange needs to set time and states and to get the derivatives, as `name best median`.

   The states are those of the start, a twentieth of a millimetre deeper in the ground; each
   evaluation is at another of 16 places, up to 1e-4 of the nominal values away, so that friction
   and motors remember something. COUNT evaluations are one batch. */
#define _GNU_SOURCE
#include "../../tests/c_api/fmi2.h"
#include "batch.h"
#include <dlfcn.h>
#include <math.h>

static struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI2_FUNCTIONS(MEMBER)
#undef MEMBER
} fmu;

enum { MOST = 500, HEIGHT = 2, PLACES = 16 };

static void ok(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        printf("%s failed\n", what);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    static double start[MOST], nominal[MOST], states[PLACES][MOST], rates[MOST];
    fmi2CallbackFunctions silent = {NULL, NULL, NULL, NULL, NULL};
    fmi2EventInfo event;
    fmi2Component c;
    void *library;
    size_t n = MOST;
    int count;
    if (argc < 4 || argc > 5)
        return 2;
    count = argc == 5 ? atoi(argv[4]) : 1000;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        printf("%s\n", dlerror());
        return 1;
    }
#define FIND(result, name, arguments) *(void **)&fmu.name = dlsym(library, "fmi2" #name);
    FMI2_FUNCTIONS(FIND)
#undef FIND
    c = fmu.Instantiate("bench", fmi2ModelExchange, argv[3], argv[2], &silent, 0, 0);
    if (!c)
        return 1;
    ok(fmu.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
    ok(fmu.EnterInitializationMode(c), "fmi2EnterInitializationMode");
    ok(fmu.ExitInitializationMode(c), "fmi2ExitInitializationMode");
    ok(fmu.NewDiscreteStates(c, &event), "fmi2NewDiscreteStates");
    ok(fmu.EnterContinuousTimeMode(c), "fmi2EnterContinuousTimeMode");
    while (n > 0 && fmu.GetContinuousStates(c, start, n) != fmi2OK)
        n--;
    ok(fmu.GetNominalsOfContinuousStates(c, nominal, n), "fmi2GetNominalsOfContinuousStates");
    if (n > HEIGHT)
        start[HEIGHT] -= 5e-5;
    for (size_t place = 0; place < PLACES; place++)
        for (size_t k = 0; k < n; k++)
            states[place][k] = start[k] + 1e-4 * nominal[k] * sin((double)(place + k));
    for (int b = 0; b < BATCHES; b++) {
        double begin = now(CLOCK_PROCESS_CPUTIME_ID);
        for (int i = 0; i < count; i++) {
            fmu.SetTime(c, 1e-6 * i);
            fmu.SetContinuousStates(c, states[i % PLACES], n);
            if (fmu.GetDerivatives(c, rates, n) != fmi2OK)
                return 1;
        }
        batch[b] = (now(CLOCK_PROCESS_CPUTIME_ID) - begin) / count;
    }
    char name[64];
    snprintf(name, sizeof name, "derivatives of %zu states", n);
    tell(name);
    fmu.FreeInstance(c);
    return 0;
}
