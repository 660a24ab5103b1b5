/* trace LIBRARY RESOURCES GUID SCRIPT: runs a script of inputs and prints the outputs' bits, on any system.

   The script is a list of numbers: how many inputs, their value references; how many outputs, their value references;
   how many steps; then for each step the bits of its size and of every input; how many continuous states, 0 without
   Model Exchange. One line is printed for the start and for every step: the bits of the time and of every output. Then
   an instance for Model Exchange is placed here and there about its initial state, and a line is printed for each
   place: the bits of the time and of every derivative. */
#include "../c_api/fmi2.h"
#include "../c_api/system.h"
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 1000 };

/* All functions of the library, under their names without "fmi2". */
static struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI2_FUNCTIONS(MEMBER)
#undef MEMBER
} fmu;

static FILE *script;

static void require(int condition, const char *what)
{
    if (!condition) {
        printf("failed: %s\n", what);
        exit(1);
    }
}

static unsigned read_count(void)
{
    unsigned count;
    require(fscanf(script, "%u", &count) == 1, "a count");
    return count;
}

static double read_bits(void)
{
    uint64_t bits;
    double value;
    require(fscanf(script, "%" SCNx64, &bits) == 1, "a number");
    memcpy(&value, &bits, sizeof value);
    return value;
}

static unsigned read_references(fmi2ValueReference *references)
{
    unsigned count = read_count();
    require(count <= MOST, "a legal number of variables");
    for (unsigned i = 0; i < count; i++)
        references[i] = read_count();
    return count;
}

static void print_bits(const double *values, unsigned count, char end)
{
    for (unsigned i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        printf("%016" PRIx64 "%c", bits, i + 1 == count ? end : ' ');
    }
}

static void logger(void *environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String message,
                   ...)
{
    (void)environment, (void)instance, (void)category;
    printf("message, status %d: %s\n", (int)status, message);
}

enum { PLACES = 100 };

/* Between -1 and 1, the same numbers on every system. */
static double wander(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(int32_t)(*seed >> 32) / 2147483648.0;
}

/* Derivatives at states that differ from the initial ones by up to a part of their nominal values. */
static void exchange(char **argv, const fmi2CallbackFunctions *callbacks, unsigned count)
{
    static double start[MOST], nominals[MOST], states[MOST], rates[MOST];
    const double sizes[] = {1e-9, 1e-4, 0.01, 0.1};
    uint64_t seed = 1;
    fmi2Component c = fmu.Instantiate("robot", fmi2ModelExchange, argv[3], argv[2], callbacks, fmi2False, fmi2False);
    require(c != NULL, "fmi2Instantiate for Model Exchange");
    require(count <= MOST, "a legal number of states");
    require(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "fmi2SetupExperiment");
    require(fmu.EnterInitializationMode(c) == fmi2OK, "fmi2EnterInitializationMode");
    require(fmu.ExitInitializationMode(c) == fmi2OK, "fmi2ExitInitializationMode");
    require(fmu.EnterContinuousTimeMode(c) == fmi2OK, "fmi2EnterContinuousTimeMode");
    require(fmu.GetContinuousStates(c, start, count) == fmi2OK, "fmi2GetContinuousStates");
    require(fmu.GetNominalsOfContinuousStates(c, nominals, count) == fmi2OK, "fmi2GetNominalsOfContinuousStates");
    for (int place = 0; place < PLACES; place++) {
        double time = 0.01 * place;
        for (unsigned i = 0; i < count; i++)
            states[i] = start[i] + sizes[place % 4] * nominals[i] * wander(&seed);
        require(fmu.SetTime(c, time) == fmi2OK, "fmi2SetTime");
        require(fmu.SetContinuousStates(c, states, count) == fmi2OK, "fmi2SetContinuousStates");
        require(fmu.GetDerivatives(c, rates, count) == fmi2OK, "fmi2GetDerivatives");
        print_bits(&time, 1, ' ');
        print_bits(rates, count, '\n');
    }
    fmu.FreeInstance(c);
}

int main(int argc, char **argv)
{
    static fmi2ValueReference inputs[MOST], outputs[MOST];
    static double values[MOST];
    fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    unsigned n_inputs, n_outputs, n_states, steps;
    double time = 0.0;
    void *library;
    fmi2Component c;

    require(argc == 5, "four arguments");
    argv = utf8_arguments(argv);
    library = library_open(argv[1]);
    require(library != NULL, argv[1]);
#define FIND(result, name, arguments)                          \
    *(void **)&fmu.name = library_find(library, "fmi2" #name); \
    require(fmu.name != NULL, "fmi2" #name);
    FMI2_FUNCTIONS(FIND)
    script = fopen(argv[4], "r");
    require(script != NULL, argv[4]);
    n_inputs = read_references(inputs);
    n_outputs = read_references(outputs);
    steps = read_count();

    c = fmu.Instantiate("robot", fmi2CoSimulation, argv[3], argv[2], &callbacks, fmi2False, fmi2False);
    require(c != NULL, "fmi2Instantiate");
    require(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "fmi2SetupExperiment");
    require(fmu.EnterInitializationMode(c) == fmi2OK, "fmi2EnterInitializationMode");
    require(fmu.ExitInitializationMode(c) == fmi2OK, "fmi2ExitInitializationMode");
    for (unsigned step = 0; step <= steps; step++) {
        print_bits(&time, 1, ' ');
        require(fmu.GetReal(c, outputs, n_outputs, values) == fmi2OK, "fmi2GetReal");
        print_bits(values, n_outputs, '\n');
        if (step < steps) {
            double h = read_bits();
            for (unsigned i = 0; i < n_inputs; i++)
                values[i] = read_bits();
            require(fmu.SetReal(c, inputs, n_inputs, values) <= fmi2Warning, "fmi2SetReal");
            require(fmu.DoStep(c, time, h, fmi2True) == fmi2OK, "fmi2DoStep");
            time += h;
        }
    }
    fmu.FreeInstance(c);
    n_states = read_count();
    if (n_states > 0)
        exchange(argv, &callbacks, n_states);
    return library_close(library) == 0 ? 0 : 1;
}
