/* Many steps, long and short ones. */
#include "importer.h"
#include "robot.h"
#include <math.h>
#include <stdint.h>

static uint64_t seed = 12345;

/* Uniform in [0, 1) (Knuth's MMIX generator). */
static double uniform(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (seed >> 11) * 0x1p-53;
}

static double now(fmi2Component c)
{
    double time = NAN;
    CHECK(fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &time) == fmi2OK, "status");
    return time;
}

/* A million steps whose beginnings jitter by 1e-16 to 1e-9: each ends exactly where it was told to. */
void test_million(void)
{
    fmi2Component c = running();
    double time = 0.0;
    for (int i = 0; i < 1000000; i++) {
        double jitter = pow(10.0, -16.0 + 7.0 * uniform());
        double begin = time + (i % 2 ? jitter : -jitter) * (time > 1.0 ? time : 1.0);
        double step = 1e-3;
        CHECK(fmu.DoStep(c, begin, step, fmi2True) == fmi2OK, "step %d", i);
        time = begin + step;
        if (i % 1000 == 0)
            CHECK(now(c) == time, "%.17g instead of %.17g", now(c), time);
        if (failures)
            break;
    }
    CHECK(now(c) == time && fabs(time - 1000.0) < 1e-3, "%.17g instead of %.17g", now(c), time);
    fmu.FreeInstance(c);
}

static void command(fmi2Component c)
{
    static const fmi2ValueReference wheels[] = {LEFT_VELOCITY, RIGHT_VELOCITY, LEFT_REAR_VELOCITY, RIGHT_REAR_VELOCITY};
    static const double speeds[] = {3.0, 3.0, 3.0, 3.0};
    CHECK(fmu.SetReal(c, wheels, 4, speeds) == fmi2OK, "commands");
}

/* The same 30 s in steps of 1e-9 s to 10 s: times are exact, the drive is the same within the tolerance's reach. */
void test_partitions(void)
{
    static const fmi2ValueReference where[] = {BASE_X, BASE_Z, BASE_VX};
    double whole[3], cut[3];
    for (int partition = -1; partition < 20; partition++) {
        fmi2Component c = instantiate();
        double time = 0.0;
        /* The last step ends past the stop time, and is told once. */
        CHECK_OK(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2True, 29.5));
        CHECK_OK(fmu.EnterInitializationMode(c));
        command(c);
        CHECK_OK(fmu.ExitInitializationMode(c));
        while (time < 29.5) {
            /* Partition −1: three steps of 10 s. */
            double step = partition < 0 ? 10.0 : pow(10.0, -9.0 + 10.0 * uniform());
            if (time + step > 29.4)
                step = 30.0 - time;
            CHECK(fmu.DoStep(c, time, step, fmi2True) == fmi2OK, "%.17g s at %.17g s", step, time);
            time = time + step;
            CHECK(now(c) == time, "%.17g instead of %.17g", now(c), time);
        }
        CHECK(fmu.GetReal(c, where, 3, partition < 0 ? whole : cut) == fmi2OK, "outputs");
        if (partition >= 0) {
            /* 10 times the tolerance of 1e-3. */
            CHECK(fabs(cut[0] - whole[0]) < 1e-2, "x: %.17g, in whole steps %.17g", cut[0], whole[0]);
            CHECK(fabs(cut[1] - whole[1]) < 1e-4, "z: %.17g, in whole steps %.17g", cut[1], whole[1]);
            CHECK(fabs(cut[2] - whole[2]) < 1e-3, "speed: %.17g, in whole steps %.17g", cut[2], whole[2]);
        }
        fmu.FreeInstance(c);
    }
    /* 3 rad/s on wheels of 0.1 m. */
    CHECK(fabs(whole[0] - 9.0) < 0.1, "%g m in 30 s", whole[0]);
}
