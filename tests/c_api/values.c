/* When values that are set take effect. */
#include "importer.h"
#include "robot.h"
#include <math.h>
#include <string.h>

static double get(fmi2Component c, fmi2ValueReference reference)
{
    double value = NAN;
    CHECK(fmu.GetReal(c, &reference, 1, &value) == fmi2OK, "reference %u", reference);
    return value;
}

static void set(fmi2Component c, fmi2ValueReference reference, double value)
{
    CHECK(fmu.SetReal(c, &reference, 1, &value) == fmi2OK, "reference %u", reference);
}

static double rate(fmi2Component c, fmi2ValueReference reference)
{
    const fmi2Integer one = 1;
    double value = NAN;
    CHECK(fmu.GetRealOutputDerivatives(c, &reference, 1, &one, &value) == fmi2OK, "derivative of %u", reference);
    return value;
}

/* Outputs at the start: a rover 1 m up falls, and a wheel that is told to turn does so with its whole effort. */
void test_initialization(void)
{
    fmi2Component c = instantiate();
    CHECK_OK(fmu.EnterInitializationMode(c));
    set(c, INITIAL_Z, 1.0);
    set(c, INITIAL_VX, 0.25);
    CHECK(get(c, BASE_Z) == 1.0, "before the end of initialisation: %g", get(c, BASE_Z));
    CHECK_OK(fmu.ExitInitializationMode(c));
    CHECK(get(c, BASE_Z) == 1.0 && get(c, BASE_VX) == 0.25, "%g %g", get(c, BASE_Z), get(c, BASE_VX));
    CHECK(get(c, LEFT_EFFORT) == 0.0, "%g", get(c, LEFT_EFFORT));
    CHECK(fabs(rate(c, BASE_VZ) + 9.81) < 1e-9, "%.17g", rate(c, BASE_VZ));
    /* 14.2 kg at 0.25 m/s */
    CHECK(fabs(get(c, KINETIC) - 0.5 * 14.2 * 0.0625) < 1e-12, "%.17g", get(c, KINETIC));
    CHECK(fmu.Reset(c) == fmi2OK, "reset");

    CHECK_OK(fmu.EnterInitializationMode(c));
    set(c, INITIAL_Z, 1.0);
    set(c, LEFT_VELOCITY, 5.0);
    set(c, LEFT_MAX_EFFORT, 2.0);
    CHECK_OK(fmu.ExitInitializationMode(c));
    CHECK(get(c, LEFT_EFFORT) == 2.0, "%g", get(c, LEFT_EFFORT));
    CHECK(get(c, LEFT_ACCELERATION) > 100.0, "2 N.m on 0.004 kg.m2: %g", get(c, LEFT_ACCELERATION));
    /* From now on an input shows only in what the next step ends with: no feed-through. */
    set(c, LEFT_VELOCITY, -5.0);
    CHECK(get(c, LEFT_EFFORT) == 2.0, "%g", get(c, LEFT_EFFORT));
    CHECK_OK(fmu.DoStep(c, 0.0, 0.2, fmi2True));
    CHECK(fabs(get(c, LEFT_SPEED) + 5.0) < 1e-3, "%.17g", get(c, LEFT_SPEED));
    fmu.FreeInstance(c);
}

/* Where the rover comes to rest if its base has this mass. */
static double resting_height(double mass)
{
    double z;
    fmi2Component c = instantiate();
    set(c, BASE_MASS, mass);
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    CHECK_OK(fmu.DoStep(c, 0.0, 3.0, fmi2True));
    z = get(c, BASE_Z);
    /* Statics: a quarter of the weight, and half of what the head (1 kg, 0.12 m ahead) shifts over 0.34 m. */
    CHECK(fabs(get(c, CONTACT_Z) - (mass + 4.2) * 9.81 / 4 - 9.81 * 0.12 / 0.68) < 1e-2, "%g N", get(c, CONTACT_Z));
    fmu.FreeInstance(c);
    return z;
}

/* Kinetic energy of the rover turning about its base at 2 rad/s. */
static double turning_energy(double mass)
{
    double energy;
    fmi2Component c = instantiate();
    set(c, BASE_MASS, mass);
    set(c, INITIAL_WZ, 2.0);
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    energy = get(c, KINETIC);
    fmu.FreeInstance(c);
    return energy;
}

void test_parameters(void)
{
    const fmi2ValueReference mass = BASE_MASS;
    const double heavy = 30.0;
    double speed, light_z, heavy_z;
    fmi2Component c = instantiate();
    set(c, INITIAL_Z, 100.0);
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    CHECK_OK(fmu.DoStep(c, 0.0, 0.1, fmi2True));
    speed = get(c, BASE_VZ);
    CHECK(fabs(speed + 0.981) < 1e-9, "%.17g", speed);
    /* Tunable: from the next step on, and no earlier. */
    set(c, GRAVITY_Z, -1.62);
    CHECK(get(c, BASE_VZ) == speed, "%.17g", get(c, BASE_VZ));
    CHECK_OK(fmu.DoStep(c, 0.1, 0.1, fmi2True));
    CHECK(fabs(get(c, BASE_VZ) + 0.981 + 0.162) < 1e-9, "%.17g", get(c, BASE_VZ));
    CHECK_ERROR(fmu.SetReal(c, &mass, 1, &heavy), "fixed parameter");
    CHECK(get(c, BASE_MASS) == 10.0, "%g", get(c, BASE_MASS));
    fmu.FreeInstance(c);

    /* The contact stiffness follows from the mass: any mass sinks in by the same 0.1 mm. */
    light_z = resting_height(10.0);
    heavy_z = resting_height(heavy);
    CHECK(fabs(light_z - heavy_z) < 2e-5, "%.17g %.17g", light_z, heavy_z);
    /* So does the inertia: 20 kg more, in the shape of 10 kg with 0.283333333 kg.m2. */
    speed = turning_energy(heavy) - turning_energy(10.0);
    CHECK(fabs(speed - 0.5 * 2 * 0.283333333 * 4.0) < 1e-9, "%.17g J", speed);
}
