/* Model Exchange in the hands of an importer that does everything wrong. */
#include "exchange.h"
#include "importer.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { N = ME_STATES };

fmi2Component exchanging(double *x)
{
    fmi2EventInfo info;
    fmi2Component c = instantiate_as(fmi2ModelExchange);
    CHECK_OK(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    CHECK_OK(fmu.NewDiscreteStates(c, &info));
    CHECK(!info.newDiscreteStatesNeeded && !info.terminateSimulation && !info.nextEventTimeDefined, "no events");
    CHECK_OK(fmu.EnterContinuousTimeMode(c));
    if (x)
        CHECK_OK(fmu.GetContinuousStates(c, x, N));
    return c;
}

/* Whether states and derivatives are those, bit for bit. */
static void same(fmi2Component c, const double *x, const double *rates, const char *after)
{
    double states[N], own[N];
    CHECK_OK(fmu.GetContinuousStates(c, states, N));
    CHECK_OK(fmu.GetDerivatives(c, own, N));
    CHECK(memcmp(states, x, sizeof states) == 0, "states after %s", after);
    CHECK(memcmp(own, rates, sizeof own) == 0, "derivatives after %s", after);
}

static void nothing(fmi2Component c)
{
    double one[N];
    fmi2EventInfo info;
    fmi2Boolean flag;
    CHECK(fmu.EnterEventMode(c) == fmi2Error, "an instance");
    CHECK(fmu.NewDiscreteStates(c, &info) == fmi2Error, "an instance");
    CHECK(fmu.EnterContinuousTimeMode(c) == fmi2Error, "an instance");
    CHECK(fmu.CompletedIntegratorStep(c, fmi2True, &flag, &flag) == fmi2Error, "an instance");
    CHECK(fmu.SetTime(c, 0.0) == fmi2Error, "an instance");
    CHECK(fmu.SetContinuousStates(c, one, N) == fmi2Error, "an instance");
    CHECK(fmu.GetDerivatives(c, one, N) == fmi2Error, "an instance");
    CHECK(fmu.GetEventIndicators(c, one, 0) == fmi2Error, "an instance");
    CHECK(fmu.GetContinuousStates(c, one, N) == fmi2Error, "an instance");
    CHECK(fmu.GetNominalsOfContinuousStates(c, one, N) == fmi2Error, "an instance");
}

/* Arrays that are missing or have another length; blocks of that length, so that valgrind sees a step beyond. */
static void wrong_lengths(fmi2Component c)
{
    const size_t lengths[] = {0, 1, N - 1, N + 1, 2 * N};
    fmi2Boolean flag;
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        size_t n = lengths[i];
        double *block = calloc(n ? n : 1, sizeof *block);
        CHECK_ERROR(fmu.SetContinuousStates(c, block, n), "states");
        CHECK_ERROR(fmu.GetContinuousStates(c, block, n), "states");
        CHECK_ERROR(fmu.GetDerivatives(c, block, n), "derivatives");
        CHECK_ERROR(fmu.GetNominalsOfContinuousStates(c, block, n), "nominal");
        if (n != 1)
            CHECK_ERROR(fmu.GetEventIndicators(c, block, n), "1");
        free(block);
    }
    CHECK_ERROR(fmu.SetContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu.GetContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu.GetDerivatives(c, NULL, N), "NULL");
    CHECK_ERROR(fmu.GetNominalsOfContinuousStates(c, NULL, N), "NULL");
    CHECK_ERROR(fmu.GetEventIndicators(c, NULL, 3), "NULL");
    CHECK_ERROR(fmu.SetContinuousStates(c, (double *)16, SIZE_MAX), "elements");
    CHECK_ERROR(fmu.CompletedIntegratorStep(c, fmi2True, NULL, &flag), "NULL");
    CHECK_ERROR(fmu.CompletedIntegratorStep(c, fmi2True, &flag, NULL), "NULL");
    CHECK_OK(fmu.EnterEventMode(c));
    CHECK_ERROR(fmu.NewDiscreteStates(c, NULL), "NULL");
    CHECK_OK(fmu.EnterContinuousTimeMode(c));
}

/* Directions and what they are of. */
static void wrong_directions(fmi2Component c)
{
    const fmi2ValueReference speed = ME_BASE_VX, input = ME_LEFT_VELOCITY, mass = ME_BASE_MASS, none = 1000000u;
    const double one = 1.0, bad[] = {NAN, INFINITY, -INFINITY};
    double found = 7.0;
    for (size_t i = 0; i < 3; i++)
        CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, &input, 1, &bad[i], &found), "finite seed");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, &mass, 1, &one, &found), "states and inputs");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &mass, 1, &input, 1, &one, &found), "outputs and derivatives");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &none, 1, &input, 1, &one, &found), "reference");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, &none, 1, &one, &found), "reference");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, NULL, 1, &input, 1, &one, &found), "NULL");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, NULL, 1, &one, &found), "NULL");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, &input, 1, NULL, &found), "NULL");
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &speed, 1, &input, 1, &one, NULL), "NULL");
    CHECK(found == 7.0, "a refused call wrote %g", found);
}

/* Seeds of any finite size: the derivative grows with them, and the instance keeps every bit. */
static void large_and_small_directions(fmi2Component c)
{
    const fmi2ValueReference speed = ME_LEFT_ACCELERATION, knowns[] = {ME_LEFT_VELOCITY, ME_BASE_VX, ME_BASE_QW};
    const double sizes[] = {1.0, -2.0, 1e-300, 1e-320, 5e-324, 1e300, 1.7e308};
    for (size_t k = 0; k < sizeof knowns / sizeof *knowns; k++) {
        double one = 0.0, found;
        unsigned long long before = hash_state(c);
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            fmi2Status got = fmu.GetDirectionalDerivative(c, &speed, 1, &knowns[k], 1, &sizes[i], &found);
            CHECK(hash_state(c) == before, "state after a seed of %g", sizes[i]);
            CHECK(got == fmi2OK || (got == fmi2Discard && fabs(sizes[i]) > 1e200), "%d for %g", got, sizes[i]);
            if (i == 0)
                one = found;
            if (got == fmi2OK)
                CHECK(fabs(found - one * sizes[i]) <= 1e-9 * fabs(one * sizes[i]) + 1e-320, "%g for %g", found,
                      sizes[i]);
        }
    }
}

/* Sizes that no robot has: an answer or none, never a crash; afterwards all is as before. */
static void monstrous(fmi2Component c, const double *x, const double *rates)
{
    const double sizes[] = {0.0, -0.0, 1e-320, 1e150, -1e150, 1.7e308, -1.7e308};
    double states[N], own[N], value;
    const fmi2ValueReference outputs[] = {ME_REAL_REFERENCES};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int at = -1; at < N; at++) {
            fmi2Status set, got;
            for (int k = 0; k < N; k++)
                states[k] = at < 0 || at == k ? sizes[i] : x[k];
            forget();
            set = fmu.SetContinuousStates(c, states, N);
            CHECK(set == fmi2OK, "%g is finite", sizes[i]);
            got = fmu.GetDerivatives(c, own, N);
            CHECK(got == fmi2OK || got == fmi2Discard, "%d for %g at %d", got, sizes[i], at);
            CHECK(got == fmi2OK || strstr(heard.text, "'der("), "the message names a derivative");
            for (int k = 0; got == fmi2OK && k < N; k++)
                CHECK(isfinite(own[k]), "derivative %d for %g at %d", k, sizes[i], at);
            if (at < 0) {
                for (size_t k = 0; k < sizeof outputs / sizeof *outputs; k++) {
                    fmi2Status read = fmu.GetReal(c, &outputs[k], 1, &value);
                    CHECK(read == fmi2Discard || (read == fmi2OK && isfinite(value)), "variable %u", outputs[k]);
                }
            }
        }
    }
    CHECK_OK(fmu.SetContinuousStates(c, x, N));
    same(c, x, rates, "monstrous states");
}

void test_exchange(void)
{
    const double bad[] = {NAN, INFINITY, -INFINITY}, half = 0.5;
    const fmi2ValueReference gravity = ME_GRAVITY_Z, restitution = ME_GROUND_RESTITUTION, speed = ME_LEFT_VELOCITY;
    double x[N], rates[N], states[N], nominals[N];
    fmi2FMUstate state = NULL;
    fmi2EventInfo info;
    size_t size;
    fmi2Byte *bytes;
    fmi2Component c = exchanging(x), stepping, other;
    CHECK_OK(fmu.GetDerivatives(c, rates, N));
    CHECK_OK(fmu.GetNominalsOfContinuousStates(c, nominals, N));
    for (int i = 0; i < N; i++)
        CHECK(nominals[i] > 0.0 && isfinite(nominals[i]), "nominal value %d is %g", i, nominals[i]);
    nothing(NULL);
    wrong_lengths(c);
    same(c, x, rates, "wrong lengths");
    wrong_directions(c);
    large_and_small_directions(c);
    same(c, x, rates, "wrong directions");

    /* All states or none. */
    for (size_t i = 0; i < 3; i++) {
        for (int at = 0; at < N; at++) {
            char name[32];
            for (int k = 0; k < N; k++)
                states[k] = k == at ? bad[i] : 2.0 * x[k] + 1.0;
            snprintf(name, sizeof name, "continuous state %d ", at);
            CHECK_ERROR(fmu.SetContinuousStates(c, states, N), name);
        }
        CHECK_ERROR(fmu.SetTime(c, bad[i]), "time");
    }
    CHECK_ERROR(fmu.SetTime(c, 1e300), "time");
    same(c, x, rates, "states that are no numbers");
    monstrous(c, x, rates);

    /* Parameters wait for an event; inputs do not. Restitution would be an event itself. */
    CHECK_ERROR(fmu.SetReal(c, &gravity, 1, &half), "event mode");
    CHECK_OK(fmu.SetReal(c, &speed, 1, &half));
    CHECK_OK(fmu.EnterEventMode(c));
    CHECK_ERROR(fmu.SetReal(c, &restitution, 1, &half), "restitution");
    CHECK_OK(fmu.EnterContinuousTimeMode(c));

    /* Saved in continuous-time mode, and restored in every other phase. */
    for (int k = 0; k < N; k++)
        states[k] = x[k] + 1e-3 * nominals[k];
    CHECK_OK(fmu.SetTime(c, 0.25));
    CHECK_OK(fmu.SetContinuousStates(c, states, N));
    CHECK_OK(fmu.GetDerivatives(c, rates, N));
    CHECK_OK(fmu.GetFMUstate(c, &state));
    CHECK_OK(fmu.SerializedFMUstateSize(c, state, &size));
    bytes = malloc(size);
    CHECK_OK(fmu.SerializeFMUstate(c, state, bytes, size));
    for (int phase = 0; phase < 4; phase++) {
        other = instantiate_as(fmi2ModelExchange);
        if (phase >= 1)
            CHECK_OK(fmu.EnterInitializationMode(other));
        if (phase >= 2)
            CHECK_OK(fmu.ExitInitializationMode(other));
        if (phase >= 3)
            CHECK_OK(fmu.Terminate(other));
        CHECK_OK(fmu.SetFMUstate(other, state));
        same(other, states, rates, "a restore");
        /* It is in continuous-time mode. */
        CHECK_ERROR(fmu.NewDiscreteStates(other, &info), "continuous-time mode");
        CHECK_OK(fmu.EnterEventMode(other));
        fmu.FreeInstance(other);
    }
    /* A state of one interface is none of the other. */
    stepping = instantiate();
    CHECK_ERROR(fmu.SetFMUstate(stepping, state), "saved state refused");
    fmu.FreeInstance(stepping);
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    for (size_t at = 0; at < size; at += at < 100 ? 1 : 13) {
        bytes[at] ^= (fmi2Byte)(1 << at % 8);
        CHECK_ERROR(fmu.DeSerializeFMUstate(c, bytes, size, &state), "saved state refused");
        bytes[at] ^= (fmi2Byte)(1 << at % 8);
    }
    same(c, states, rates, "damaged states");
    CHECK_OK(fmu.DeSerializeFMUstate(c, bytes, size, &state));
    CHECK_OK(fmu.Reset(c));
    CHECK_OK(fmu.SetFMUstate(c, state));
    same(c, states, rates, "a state of bytes");
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    free(bytes);
    fmu.FreeInstance(c);
}
