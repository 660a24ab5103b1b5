/* Steps: the bits of FMI 2, steps that are discarded, and the importer's callback within them. */
#include "importer3.h"
#include "robot.h"
#include <math.h>
#include <string.h>

static const fmi3ValueReference velocity = LEFT_VELOCITY, max_steps = MAX_STEPS, base = BASE_X, fixed = STEP_SIZE,
                                mass = BASE_MASS, steps = STEPS;

void test_v3_bits(void)
{
    for (int fixed_step = 0; fixed_step < 2; fixed_step++) {
        double size = fixed_step / 240.0;
        fmi2Component old = running();
        fmi3Instance c = running3();
        CHECK(hash_state(old) == hash_state3(c), "at the start");
        CHECK_OK(fmu.Reset(old));
        CHECK_OK(fmu3.Reset(c));
        CHECK_OK(fmu.SetReal(old, &fixed, 1, &size));
        CHECK_OK(fmu3.SetFloat64(c, &fixed, 1, &size, 1));
        CHECK_OK(fmu.SetupExperiment(old, 1, 1e-4, 1.5, 1, 9.0));
        CHECK_OK(fmu.EnterInitializationMode(old));
        CHECK_OK(fmu.ExitInitializationMode(old));
        CHECK_OK(fmu3.EnterInitializationMode(c, true, 1e-4, 1.5, true, 9.0));
        CHECK_OK(fmu3.ExitInitializationMode(c));
        for (int i = 0; i < 10; i++) {
            drive(old, 1.5 + 0.05 * i, 0.05, 1);
            drive3(c, 1.5 + 0.05 * i, 0.05, 1);
            CHECK(hash_state(old) == hash_state3(c), "after step %d", i);
        }
        fmu.FreeInstance(old);
        fmu3.FreeInstance(c);
    }
}

void test_v3_discard(void)
{
    const double one = 1.0, many = 1e5;
    bool event, end, early;
    double reached = -1.0;
    unsigned long long before, expected;
    fmi3Instance c = running3(), same = running3();
    drive3(c, 0.0, 0.05, 4);
    drive3(same, 0.0, 0.05, 6);
    expected = hash_state3(same);
    CHECK_OK(fmu3.SetFloat64(c, &max_steps, 1, &one, 1));
    before = hash_state3(c);
    forget();
    CHECK(fmu3.DoStep(c, 0.2, 0.1, true, &event, &end, &early, &reached) == fmi3Discard, "too much work");
    CHECK(heard.messages == 1 && strstr(heard.text, "fmi3DoStep"), "one message");
    CHECK(fabs(reached - 0.2) < 1e-12 && !early, "%.17g", reached);
    CHECK(hash_state3(c) == before, "the state is that before the call");
    /* The computation may continue. */
    CHECK_OK(fmu3.SetFloat64(c, &max_steps, 1, &many, 1));
    drive3(c, 0.2, 0.05, 2);
    CHECK_OK(fmu3.SetFloat64(same, &max_steps, 1, &many, 1));
    CHECK(hash_state3(c) == expected, "as if it had not been tried");

    CHECK_ERROR(fmu3.DoStep(c, 0.3, 0.1, true, NULL, &end, &early, &reached), "eventHandlingNeeded");
    CHECK_ERROR(fmu3.DoStep(c, 0.3, 0.1, true, &event, NULL, &early, &reached), "terminateSimulation");
    CHECK_ERROR(fmu3.DoStep(c, 0.3, 0.1, true, &event, &end, NULL, &reached), "earlyReturn");
    CHECK_ERROR(fmu3.DoStep(c, 0.3, 0.1, true, &event, &end, &early, NULL), "lastSuccessfulTime");
    CHECK_ERROR(fmu3.DoStep(c, 0.4, 0.1, true, &event, &end, &early, &reached), "0.4");
    CHECK_ERROR(fmu3.DoStep(c, 0.3, 0.0, true, &event, &end, &early, &reached), "communicationStepSize");
    CHECK_ERROR(fmu3.DoStep(c, 0.3, NAN, true, &event, &end, &early, &reached), "communicationStepSize");
    CHECK_ERROR(fmu3.DoStep(c, NAN, 0.1, true, &event, &end, &early, &reached), "begin");
    CHECK(hash_state3(c) == expected, "nothing has changed");
    fmu3.FreeInstance(c);
    fmu3.FreeInstance(same);
}

static struct {
    fmi3Instance c;
    int calls;
    double last, stop_at, stop_to, set_at, value;
    bool may_end;
} told;

static void update(fmi3InstanceEnvironment environment, double time, bool set, bool get, bool finished, bool may_end,
                   bool *end, double *when)
{
    double position[3], rate[3];
    const int32_t one = 1;
    const fmi3ValueReference active = CONTACT_ACTIVE;
    bool touches = false;
    CHECK(environment == &heard && set && get && finished && may_end == told.may_end, "arguments");
    CHECK(time > told.last, "%.17g after %.17g", time, told.last);
    CHECK(!*end && *when == time, "%d %g", *end, *when);
    told.last = time;
    told.calls++;
    CHECK_OK(fmu3.GetFloat64(told.c, &base, 1, position, 3));
    CHECK_OK(fmu3.GetBoolean(told.c, &active, 1, &touches, 1));
    CHECK_OK(fmu3.GetOutputDerivatives(told.c, &base, 1, &one, rate, 3));
    if (told.calls == 1) {
        const double heavy = 3.0;
        int32_t count;
        CHECK_ERROR(fmu3.SetFloat64(told.c, &mass, 1, &heavy, 1), "requiredIntermediateVariables");
        CHECK_ERROR(fmu3.GetInt32(told.c, &steps, 1, &count, 1), "requiredIntermediateVariables");
        CHECK_ERROR(fmu3.SetFloat64(told.c, &base, 1, position, 3), "output");
        CHECK_ERROR(step3(told.c, time, 0.1), "intermediate update mode");
    }
    if (time >= told.set_at)
        CHECK_OK(fmu3.SetFloat64(told.c, &velocity, 1, &told.value, 1));
    if (time >= told.stop_at) {
        *end = true;
        *when = told.stop_to;
    }
}

static fmi3Instance updating(bool may_end)
{
    const fmi3ValueReference required[] = {BASE_X, LEFT_VELOCITY, CONTACT_ACTIVE};
    fmi3Instance c = fmu3.InstantiateCoSimulation("robot", guid, resources, false, false, false, may_end, required, 3,
                                                  &heard, logger3, update);
    CHECK(c != NULL, "instance");
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(c));
    memset(&told, 0, sizeof told);
    told.c = c;
    told.may_end = may_end;
    told.last = -1.0;
    told.stop_at = told.set_at = INFINITY;
    return c;
}

void test_v3_updates(void)
{
    bool event, end, early;
    double reached, speed = 5.0, value;
    const fmi3ValueReference wheel = LEFT_SPEED;
    fmi3Instance c = updating(false), plain;
    unsigned long long expected;

    /* Called until the end of the step, which is where the last call is. */
    CHECK(step3(c, 0.0, 0.25) == fmi3OK, "step");
    CHECK(told.calls > 3 && told.last == 0.25, "%d calls, the last at %g", told.calls, told.last);
    /* A request is not heard where it is not allowed. */
    told.stop_at = 0.0;
    CHECK(step3(c, 0.25, 0.25) == fmi3OK, "step");
    CHECK(told.last == 0.5, "%g", told.last);
    fmu3.FreeInstance(c);

    /* An input that is set within a step counts from there on. */
    c = updating(true);
    CHECK_OK(fmu3.SetFloat64(c, &velocity, 1, &speed, 1));
    told.set_at = 0.15, told.value = -5.0;
    CHECK(step3(c, 0.0, 0.5) == fmi3OK, "step");
    CHECK_OK(fmu3.GetFloat64(c, &wheel, 1, &value, 1));
    CHECK(fabs(value + 5.0) < 0.01, "%g", value);
    fmu3.FreeInstance(c);

    /* An early return, at once or later. */
    c = updating(true);
    told.stop_at = 0.1, told.stop_to = 0.0;
    forget();
    CHECK(fmu3.DoStep(c, 0.0, 0.5, true, &event, &end, &early, &reached) == fmi3OK, "early");
    CHECK(early && !event && !end && reached == told.last && reached >= 0.1 && reached < 0.2, "%.17g", reached);
    told.stop_at = 0.3, told.stop_to = 0.41;
    CHECK(fmu3.DoStep(c, reached, 0.5, true, &event, &end, &early, &reached) == fmi3OK, "early");
    CHECK(early && reached == 0.41, "%.17g", reached);
    told.stop_at = 0.0, told.stop_to = 1e9;
    CHECK(fmu3.DoStep(c, 0.41, 0.09, true, &event, &end, &early, &reached) == fmi3OK, "in time");
    CHECK(!early && reached == 0.5, "%.17g", reached);
    told.stop_to = NAN;
    CHECK(fmu3.DoStep(c, 0.5, 0.5, true, &event, &end, &early, &reached) == fmi3OK, "at once");
    CHECK(early && reached == told.last && reached < 0.6, "%.17g", reached);
    fmu3.FreeInstance(c);

    /* A step that fails is taken back whole, with the inputs that were set in it. */
    c = updating(true);
    drive3(c, 0.0, 0.05, 2);
    value = 30.0;
    CHECK_OK(fmu3.SetFloat64(c, &max_steps, 1, &value, 1));
    expected = hash_state3(c);
    told.set_at = 0.0, told.value = -1.0;
    CHECK(fmu3.DoStep(c, 0.1, 5.0, true, &event, &end, &early, &reached) == fmi3Discard || told.calls > 30, "work");
    if (reached == 0.1)
        CHECK(hash_state3(c) == expected, "taken back");
    fmu3.FreeInstance(c);

    /* Fixed steps: one call each. */
    c = updating(true);
    CHECK(fmu3.Reset(c) == fmi3OK, "reset");
    value = 0.01;
    CHECK_OK(fmu3.SetFloat64(c, &fixed, 1, &value, 1));
    CHECK_OK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(c));
    CHECK(step3(c, 0.0, 0.1) == fmi3OK, "step");
    CHECK(told.calls == 10, "%d calls", told.calls);
    plain = instantiate3();
    CHECK_OK(fmu3.SetFloat64(plain, &fixed, 1, &value, 1));
    CHECK_OK(fmu3.EnterInitializationMode(plain, false, 0.0, 0.0, false, 0.0));
    CHECK_OK(fmu3.ExitInitializationMode(plain));
    CHECK(step3(plain, 0.0, 0.1) == fmi3OK, "step");
    fmu3.FreeInstance(plain);
    fmu3.FreeInstance(c);
}
