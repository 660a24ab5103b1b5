/* Model Exchange of FMI 3.0 in the hands of an importer that does everything wrong. */
#include "exchange.h"
#include "importer3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = ME_STATES };

fmi3Instance exchange3(void)
{
    fmi3Instance c = fmu3.InstantiateModelExchange("robot", guid, resources, false, false, &heard, logger3);
    if (!c) {
        printf("fmi3InstantiateModelExchange failed: %s\n", heard.text);
        exit(2);
    }
    return c;
}

fmi3Instance exchanging3(double *x)
{
    bool again = true, end = true, nominals = true, values = true, defined = true;
    double next;
    fmi3Instance c = exchange3();
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(c));
    CHECK_OK(fmu3.UpdateDiscreteStates(c, &again, &end, &nominals, &values, &defined, &next));
    CHECK(!again && !end && !nominals && !values && !defined, "no events");
    CHECK_OK(fmu3.EnterContinuousTimeMode(c));
    if (x)
        CHECK_OK(fmu3.GetContinuousStates(c, x, N));
    return c;
}

/* Whether states and derivatives are those, bit for bit. */
static void same(fmi3Instance c, const double *x, const double *rates, const char *after)
{
    double states[N], own[N];
    CHECK_OK(fmu3.GetContinuousStates(c, states, N));
    CHECK_OK(fmu3.GetContinuousStateDerivatives(c, own, N));
    CHECK(memcmp(states, x, sizeof states) == 0, "states after %s", after);
    CHECK(memcmp(own, rates, sizeof own) == 0, "derivatives after %s", after);
}

static void wrong_lengths(fmi3Instance c)
{
    const size_t lengths[] = {0, 1, N - 1, N + 1, 2 * N};
    bool flag;
    double real;
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        size_t n = lengths[i];
        double *block = calloc(n ? n : 1, sizeof *block);
        CHECK_ERROR(fmu3.SetContinuousStates(c, block, n), "states");
        CHECK_ERROR(fmu3.GetContinuousStates(c, block, n), "states");
        CHECK_ERROR(fmu3.GetContinuousStateDerivatives(c, block, n), "derivatives");
        CHECK_ERROR(fmu3.GetNominalsOfContinuousStates(c, block, n), "nominal");
        free(block);
    }
    CHECK_ERROR(fmu3.SetContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu3.GetContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu3.GetContinuousStateDerivatives(c, NULL, N), "NULL");
    CHECK_ERROR(fmu3.GetNominalsOfContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu3.GetNumberOfContinuousStates(c, NULL), "NULL");
    CHECK_ERROR(fmu3.GetNumberOfEventIndicators(c, NULL), "NULL");
    CHECK_ERROR(fmu3.CompletedIntegratorStep(c, true, NULL, &flag), "NULL");
    CHECK_ERROR(fmu3.CompletedIntegratorStep(c, true, &flag, NULL), "NULL");
    CHECK_OK(fmu3.EnterEventMode(c));
    CHECK_ERROR(fmu3.UpdateDiscreteStates(c, NULL, &flag, &flag, &flag, &flag, &real), "NULL");
    CHECK_ERROR(fmu3.UpdateDiscreteStates(c, &flag, &flag, &flag, &flag, &flag, NULL), "NULL");
    CHECK_OK(fmu3.EnterContinuousTimeMode(c));
}

/* Vectors are whole: base.position has three elements, and as many seeds. */
static void wrong_directions(fmi3Instance c)
{
    const fmi3ValueReference position = ME_BASE_X, input = ME_LEFT_VELOCITY, mass = ME_BASE_MASS, none = 1000000u;
    const double seeds[] = {0.0, 0.0, 1.0}, bad[] = {0.0, NAN, 0.0};
    double found[3] = {7.0, 7.0, 7.0};
    CHECK_OK(fmu3.GetDirectionalDerivative(c, &position, 1, &position, 1, seeds, 3, found, 3));
    /* Differences of 3e-9 m, which the last digits of 0.15 m, 3e-17 m, make uncertain by 1e-8. */
    CHECK(fabs(found[0]) < 1e-9 && fabs(found[1]) < 1e-9 && fabs(found[2] - 1.0) < 1e-7, "z by z: %.17g", found[2]);
    found[0] = 7.0;
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &position, 1, bad, 3, found, 3), "finite seed");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &position, 1, seeds, 2, found, 3), "announced");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &position, 1, seeds, 3, found, 1), "announced");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &mass, 1, seeds, 1, found, 3), "states and inputs");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &mass, 1, &input, 1, seeds, 1, found, 1), "outputs and derivatives");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &none, 1, &input, 1, seeds, 1, found, 1), "reference");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, NULL, 1, &input, 1, seeds, 1, found, 3), "NULL");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &input, 1, NULL, 1, found, 3), "NULL");
    CHECK_ERROR(fmu3.GetDirectionalDerivative(c, &position, 1, &input, 1, seeds, 1, NULL, 3), "NULL");
    CHECK(found[0] == 7.0, "a refused call wrote %g", found[0]);
}

void test_v3_exchange(void)
{
    const double bad[] = {NAN, INFINITY, -INFINITY}, sizes[] = {0.0, 1e-320, 1e150, 1.7e308}, half = 0.5;
    const fmi3ValueReference friction = ME_GROUND_FRICTION;
    double x[N], rates[N], states[N], own[N], real;
    bool flag;
    size_t n = 77;
    fmi3FMUState state = NULL;
    fmi3Instance other, c = exchanging3(x);
    CHECK_OK(fmu3.GetContinuousStateDerivatives(c, rates, N));
    CHECK_OK(fmu3.GetNumberOfContinuousStates(c, &n));
    CHECK(n == N, "%zu states", n);
    CHECK_OK(fmu3.GetNumberOfEventIndicators(c, &n));
    CHECK(n == 1, "%zu event indicators", n);
    CHECK_OK(fmu3.GetEventIndicators(c, &real, 1));
    CHECK(real > 0.0, "nothing has left: %g", real);
    CHECK(fmu3.SetContinuousStates(NULL, x, N) == fmi3Error, "an instance");
    wrong_lengths(c);
    wrong_directions(c);
    same(c, x, rates, "wrong calls");

    for (size_t i = 0; i < 3; i++) {
        for (int at = 0; at < N; at++) {
            for (int k = 0; k < N; k++)
                states[k] = k == at ? bad[i] : 2.0 * x[k] + 1.0;
            CHECK_ERROR(fmu3.SetContinuousStates(c, states, N), "continuous state");
        }
        CHECK_ERROR(fmu3.SetTime(c, bad[i]), "time");
    }
    same(c, x, rates, "states that are no numbers");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        fmi3Status got;
        for (int k = 0; k < N; k++)
            states[k] = sizes[i];
        CHECK_OK(fmu3.SetContinuousStates(c, states, N));
        got = fmu3.GetContinuousStateDerivatives(c, own, N);
        CHECK(got == fmi3OK || got == fmi3Discard, "%d for %g", got, sizes[i]);
    }
    CHECK_OK(fmu3.SetContinuousStates(c, x, N));
    same(c, x, rates, "monstrous states");
    CHECK_ERROR(fmu3.SetFloat64(c, &friction, 1, &half, 1), "event mode");

    CHECK_OK(fmu3.SetTime(c, 0.25));
    CHECK_OK(fmu3.GetFMUState(c, &state));
    for (int phase = 0; phase < 4; phase++) {
        other = exchange3();
        if (phase >= 1)
            CHECK_OK(fmu3.EnterInitializationMode(other, false, 0.0, 0.0, false, 0.0));
        if (phase >= 2)
            CHECK_OK(fmu3.ExitInitializationMode(other));
        if (phase >= 3)
            CHECK_OK(fmu3.Terminate(other));
        CHECK_OK(fmu3.SetFMUState(other, state));
        same(other, x, rates, "a restore");
        CHECK_ERROR(fmu3.UpdateDiscreteStates(other, &flag, &flag, &flag, &flag, &flag, &real),
                    "continuous-time mode");
        fmu3.FreeInstance(other);
    }
    other = instantiate3();
    CHECK_ERROR(fmu3.SetFMUState(other, state), "saved state refused");
    fmu3.FreeInstance(other);
    CHECK_OK(fmu3.FreeFMUState(c, &state));
    fmu3.FreeInstance(c);
}
