/* Derivatives of inputs and outputs with respect to time. */
#include "importer.h"
#include "robot.h"
#include <math.h>
#include <string.h>

static const fmi2ValueReference wheels[] = {LEFT_VELOCITY, RIGHT_VELOCITY, LEFT_REAR_VELOCITY,
                                            RIGHT_REAR_VELOCITY};
static const fmi2Integer first[] = {1, 1, 1, 1}, second[] = {2, 2, 2, 2};

/* Drives for 2 s in `n` steps, wheels at u(t) = 3 t − t²/2 rad/s; `orders` derivatives are told. */
static void ramp(fmi2Component c, int n, int orders)
{
    for (int i = 0; i < n; i++) {
        double t = 2.0 * i / n, h = 2.0 * (i + 1) / n - t;
        double u = 3 * t - t * t / 2, v = 3 - t;
        double value[] = {u, u, u, u}, rate[] = {v, v, v, v}, bend[] = {-1, -1, -1, -1};
        CHECK(fmu.SetReal(c, wheels, 4, value) == fmi2OK, "set");
        if (orders >= 1)
            CHECK(fmu.SetRealInputDerivatives(c, wheels, 4, first, rate) == fmi2OK, "first");
        if (orders >= 2)
            CHECK(fmu.SetRealInputDerivatives(c, wheels, 4, second, bend) == fmi2OK, "second");
        CHECK(fmu.DoStep(c, t, h, fmi2True) == fmi2OK, "step %d", i);
    }
}

static double get(fmi2Component c, fmi2ValueReference reference)
{
    double value = NAN;
    CHECK(fmu.GetReal(c, &reference, 1, &value) == fmi2OK, "reference %u", reference);
    return value;
}

void test_input_derivatives(void)
{
    const fmi2ValueReference mixed[] = {LEFT_VELOCITY, GRAVITY_Z}, outputs[] = {LEFT_VELOCITY, BASE_X};
    const fmi2Integer orders[] = {1, 4}, zero[] = {1, 0};
    double rates[] = {1.0, 1.0}, bad[] = {1.0, NAN}, whole, cut, stairs, held;
    unsigned long long expected;
    fmi2FMUstate before = NULL;
    fmi2Component c = running(), other = running(), samples = running();

    /* One step of 2 s with the whole polynomial is the same drive as 200 steps with it, and not that of samples
       that are held. The tolerance is 1e-3 m; holding samples of 0.1 s loses half a step: 0.05 s · u · R. */
    ramp(c, 1, 2);
    ramp(other, 200, 2);
    ramp(samples, 20, 0);
    whole = get(c, BASE_X);
    cut = get(other, BASE_X);
    stairs = get(samples, BASE_X);
    CHECK(fabs(whole - cut) < 1e-3, "%.17g %.17g", whole, cut);
    CHECK(fabs(whole - stairs) > 1e-2, "%.17g %.17g", whole, stairs);
    /* The wheels turn by 6 − 8/6 rad and roll. */
    CHECK(fabs(whole - 0.1 * (6.0 - 8.0 / 6.0)) < 1e-3, "%.17g m", whole);

    /* The input stands where its polynomial has ended, and stays. */
    CHECK(fabs(get(c, LEFT_VELOCITY) - 4.0) < 1e-14, "%.17g", get(c, LEFT_VELOCITY));
    CHECK_OK(fmu.DoStep(c, 2.0, 1.0, fmi2True));
    CHECK(fabs(get(c, LEFT_VELOCITY) - 4.0) < 1e-14, "%.17g", get(c, LEFT_VELOCITY));
    CHECK(fabs(get(c, LEFT_SPEED) - 4.0) < 1e-3, "%.17g", get(c, LEFT_SPEED));

    /* A saved state holds what is told for the step to come. */
    CHECK_OK(fmu.SetRealInputDerivatives(c, wheels, 2, first, rates));
    CHECK_OK(fmu.GetFMUstate(c, &before));
    CHECK_OK(fmu.DoStep(c, 3.0, 0.5, fmi2False));
    expected = hash_state(c);
    held = get(c, LEFT_VELOCITY);
    CHECK(fabs(held - 4.5) < 1e-14, "%.17g", held);
    CHECK_OK(fmu.SetFMUstate(c, before));
    CHECK_OK(fmu.DoStep(c, 3.0, 0.5, fmi2True));
    CHECK(hash_state(c) == expected, "rolled back");
    CHECK_OK(fmu.SetFMUstate(c, before));

    /* Nothing of a bad call is set: the step is the same. */
    rates[0] = 7.0;
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, mixed, 2, first, rates), "no input");
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, outputs, 2, first, rates), "no input");
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, wheels, 2, zero, rates), "begin at 1");
    CHECK_DISCARD(fmu.SetRealInputDerivatives(c, wheels, 2, orders, rates), "up to 3");
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, wheels, 2, first, bad), "a number from");
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, NULL, 2, first, rates), "NULL");
    CHECK_ERROR(fmu.SetRealInputDerivatives(c, wheels, 2, NULL, rates), "NULL");
    CHECK_OK(fmu.DoStep(c, 3.0, 0.5, fmi2True));
    CHECK(hash_state(c) == expected, "all or nothing");
    CHECK_OK(fmu.FreeFMUstate(c, &before));
    fmu.FreeInstance(c);
    fmu.FreeInstance(other);
    fmu.FreeInstance(samples);
}

static double rate(fmi2Component c, fmi2ValueReference reference)
{
    const fmi2Integer one = 1;
    double value = NAN;
    CHECK(fmu.GetRealOutputDerivatives(c, &reference, 1, &one, &value) == fmi2OK, "derivative of %u", reference);
    return value;
}

void test_output_derivatives(void)
{
    const fmi2ValueReference some[] = {BASE_X, LEFT_EFFORT}, input[] = {BASE_X, LEFT_VELOCITY};
    const fmi2Integer zero[] = {1, 0};
    double values[] = {77.0, 78.0}, before, after, half = 1e-4;
    fmi2Component c = running();
    drive(c, 0.0, 0.05, 10);

    CHECK(rate(c, BASE_X) == get(c, BASE_VX), "a position's is the velocity");
    CHECK(rate(c, LEFT_SPEED) == get(c, LEFT_ACCELERATION), "a velocity's is the acceleration");
    /* The others against central differences over 0.2 ms of a smooth drive. */
    CHECK(fmu.DoStep(c, 0.5, 0.1 - half, fmi2True) == fmi2OK, "to just before 0.6 s");
    before = get(c, BASE_QW);
    CHECK(fmu.DoStep(c, 0.6 - half, half, fmi2True) == fmi2OK, "to 0.6 s");
    values[0] = rate(c, BASE_QW);
    CHECK(fmu.DoStep(c, 0.6, half, fmi2True) == fmi2OK, "to just after 0.6 s");
    after = get(c, BASE_QW);
    CHECK(fabs(values[0] - (after - before) / (2 * half)) < 1e-3, "%g %g", values[0], (after - before) / (2 * half));

    /* Forces may jump, so they have none; nothing is written unless all is known. */
    values[0] = 77.0;
    CHECK_DISCARD(fmu.GetRealOutputDerivatives(c, some, 2, first, values), "effort");
    CHECK_DISCARD(fmu.GetRealOutputDerivatives(c, some, 1, second, values), "up to 1");
    CHECK_ERROR(fmu.GetRealOutputDerivatives(c, input, 2, first, values), "no output");
    CHECK_ERROR(fmu.GetRealOutputDerivatives(c, some, 2, zero, values), "begin at 1");
    CHECK_ERROR(fmu.GetRealOutputDerivatives(c, some, 2, first, NULL), "NULL");
    CHECK(values[0] == 77.0 && values[1] == 78.0, "%g %g", values[0], values[1]);
    fmu.FreeInstance(c);
}
