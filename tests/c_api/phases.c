/* Every function in every phase that an importer can reach, of both interfaces, against the tables of FMI 2.0. */
#include "exchange.h"
#include "importer.h"
#include "robot.h"
#include <math.h>
#include <string.h>

enum { INSTANTIATED, INITIALIZATION, COMPLETE, FAILED, TERMINATED, PHASES };
static const char *const names[PHASES] = {"instantiated", "initialization mode", "step complete", "step failed",
                                          "terminated"};
/* Phases of an instance for Model Exchange. */
enum { EVENT = COMPLETE, CONTINUOUS = FAILED };
static const char *const exchange_names[PHASES] = {"instantiated", "initialization mode", "event mode",
                                                   "continuous-time mode", "terminated"};

/* A new instance in the given phase. */
static fmi2Component in_phase(int phase)
{
    const fmi2ValueReference work[] = {MAX_STEPS, LEFT_VELOCITY};
    const double too_little[] = {1.0, 5.0};
    fmi2Component c = instantiate();
    if (phase >= INITIALIZATION)
        CHECK(fmu.EnterInitializationMode(c) == fmi2OK, "enter");
    if (phase >= COMPLETE)
        CHECK(fmu.ExitInitializationMode(c) == fmi2OK, "exit");
    if (phase == FAILED) {
        /* One try of a solver step is not enough: the step is discarded. */
        CHECK(fmu.SetReal(c, work, 2, too_little) == fmi2OK, "work");
        CHECK(fmu.DoStep(c, 0.0, 0.1, fmi2True) == fmi2Discard, "a step that cannot be done");
        CHECK(strcmp(heard.category, "logStatusDiscard") == 0, "category");
    }
    if (phase == TERMINATED)
        CHECK(fmu.Terminate(c) == fmi2OK, "terminate");
    return c;
}

static fmi2FMUstate state;
static fmi2Byte bytes[1 << 16];
static size_t size;

/* One legal call of each function. */
#define CALL(name, call) \
    static fmi2Status name(fmi2Component c) { return call; }
static const fmi2ValueReference velocity = LEFT_VELOCITY, steps = STEPS;
static fmi2Real real;
static fmi2Integer integer;
static fmi2Boolean boolean;
static fmi2String string;
static fmi2Status status;
static fmi2EventInfo info;
static fmi2FMUstate made;
static double x[ME_STATES], rates[ME_STATES];
CALL(set_debug_logging, fmu.SetDebugLogging(c, fmi2False, 0, NULL))
CALL(setup_experiment, fmu.SetupExperiment(c, fmi2True, 1e-4, 0.0, fmi2True, 1.0))
CALL(enter, fmu.EnterInitializationMode(c))
CALL(leave, fmu.ExitInitializationMode(c))
CALL(terminate, fmu.Terminate(c))
CALL(reset, fmu.Reset(c))
CALL(get_real, fmu.GetReal(c, &velocity, 1, &real))
CALL(get_integer, fmu.GetInteger(c, &steps, 1, &integer))
CALL(get_boolean, fmu.GetBoolean(c, NULL, 0, &boolean))
CALL(get_string, fmu.GetString(c, NULL, 0, &string))
CALL(set_real, fmu.SetReal(c, &velocity, 1, &real))
CALL(set_integer, fmu.SetInteger(c, NULL, 0, &integer))
CALL(set_boolean, fmu.SetBoolean(c, NULL, 0, &boolean))
CALL(set_string, fmu.SetString(c, NULL, 0, &string))
CALL(set_state, fmu.SetFMUstate(c, state))
CALL(state_size, fmu.SerializedFMUstateSize(c, state, &size))
CALL(serialize, fmu.SerializeFMUstate(c, state, bytes, size))
CALL(directional, fmu.GetDirectionalDerivative(c, NULL, 0, NULL, 0, NULL, NULL))
CALL(input_derivatives, fmu.SetRealInputDerivatives(c, NULL, 0, NULL, NULL))
CALL(output_derivatives, fmu.GetRealOutputDerivatives(c, NULL, 0, NULL, NULL))
CALL(step, fmu.DoStep(c, 0.0, 0.01, fmi2True))
CALL(cancel, fmu.CancelStep(c))
CALL(get_status, fmu.GetStatus(c, fmi2DoStepStatus, &status))
CALL(get_real_status, fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &real))
CALL(get_integer_status, fmu.GetIntegerStatus(c, fmi2DoStepStatus, &integer))
CALL(get_boolean_status, fmu.GetBooleanStatus(c, fmi2Terminated, &boolean))
CALL(get_string_status, fmu.GetStringStatus(c, fmi2PendingStatus, &string))
CALL(event_mode, fmu.EnterEventMode(c))
CALL(discrete, fmu.NewDiscreteStates(c, &info))
CALL(continuous, fmu.EnterContinuousTimeMode(c))
CALL(integrator, fmu.CompletedIntegratorStep(c, fmi2True, &boolean, &boolean))
CALL(set_time, fmu.SetTime(c, 0.0))
CALL(set_states, fmu.SetContinuousStates(c, x, ME_STATES))
CALL(derivatives, fmu.GetDerivatives(c, rates, ME_STATES))
CALL(indicators, fmu.GetEventIndicators(c, rates, 1))
CALL(get_states, fmu.GetContinuousStates(c, rates, ME_STATES))
CALL(nominals, fmu.GetNominalsOfContinuousStates(c, rates, ME_STATES))

static fmi2Status get_state(fmi2Component c)
{
    fmi2FMUstate own = NULL;
    fmi2Status result = fmu.GetFMUstate(c, &own);
    CHECK((own != NULL) == (result == fmi2OK), "a state only if all went well");
    CHECK(fmu.FreeFMUstate(c, &own) == fmi2OK && own == NULL, "free");
    return result;
}

static fmi2Status deserialize(fmi2Component c)
{
    fmi2Status result;
    made = NULL;
    result = fmu.DeSerializeFMUstate(c, bytes, size, &made);
    CHECK(made != NULL, "a state");
    return result;
}

static fmi2Status free_state(fmi2Component c)
{
    fmi2FMUstate own = made;
    made = NULL;
    return fmu.FreeFMUstate(c, &own);
}

/* x: fmi2OK, d: fmi2Discard, -: fmi2Error. Columns: instantiated, initialization, complete, failed, terminated; for
   Model Exchange instantiated, initialization, event, continuous time, terminated. */
static const struct {
    const char *function;
    fmi2Status (*call)(fmi2Component);
    const char *allowed, *exchange;
} table[] = {
    {"fmi2SetDebugLogging", set_debug_logging, "xxxxx", "xxxxx"},
    {"fmi2SetupExperiment", setup_experiment, "x----", "x----"},
    {"fmi2EnterInitializationMode", enter, "x----", "x----"},
    {"fmi2ExitInitializationMode", leave, "-x---", "-x---"},
    {"fmi2Terminate", terminate, "--xx-", "--xx-"},
    {"fmi2Reset", reset, "xxxxx", "xxxxx"},
    {"fmi2GetReal", get_real, "xxxxx", "xxxxx"},
    {"fmi2GetInteger", get_integer, "xxxxx", "xxxxx"},
    {"fmi2GetBoolean", get_boolean, "xxxxx", "xxxxx"},
    {"fmi2GetString", get_string, "xxxxx", "xxxxx"},
    {"fmi2SetReal", set_real, "xxx--", "xxxx-"},
    {"fmi2SetInteger", set_integer, "xxx--", "xxxx-"},
    {"fmi2SetBoolean", set_boolean, "xxx--", "xxxx-"},
    {"fmi2SetString", set_string, "xxx--", "xxxx-"},
    {"fmi2GetFMUstate", get_state, "xxxxx", "xxxxx"},
    {"fmi2SerializedFMUstateSize", state_size, "xxxxx", "xxxxx"},
    {"fmi2SerializeFMUstate", serialize, "xxxxx", "xxxxx"},
    {"fmi2DeSerializeFMUstate", deserialize, "xxxxx", "xxxxx"},
    {"fmi2FreeFMUstate", free_state, "xxxxx", "xxxxx"},
    {"fmi2SetFMUstate", set_state, "xxxxx", "xxxxx"},
    {"fmi2GetDirectionalDerivative", directional, "-xxxx", "-xxxx"},
    {"fmi2SetRealInputDerivatives", input_derivatives, "xxx--", "-----"},
    {"fmi2GetRealOutputDerivatives", output_derivatives, "--xxx", "-----"},
    {"fmi2DoStep", step, "--x--", "-----"},
    {"fmi2CancelStep", cancel, "-----", "-----"},
    {"fmi2GetStatus", get_status, "--xxx", "-----"},
    {"fmi2GetRealStatus", get_real_status, "--xxx", "-----"},
    {"fmi2GetIntegerStatus", get_integer_status, "--ddd", "-----"},
    {"fmi2GetBooleanStatus", get_boolean_status, "--xxx", "-----"},
    {"fmi2GetStringStatus", get_string_status, "--xxx", "-----"},
    {"fmi2EnterEventMode", event_mode, "-----", "---x-"},
    {"fmi2NewDiscreteStates", discrete, "-----", "--x--"},
    {"fmi2EnterContinuousTimeMode", continuous, "-----", "--x--"},
    {"fmi2CompletedIntegratorStep", integrator, "-----", "---x-"},
    {"fmi2SetTime", set_time, "-----", "--xx-"},
    {"fmi2SetContinuousStates", set_states, "-----", "---x-"},
    {"fmi2GetDerivatives", derivatives, "-----", "-xxxx"},
    {"fmi2GetEventIndicators", indicators, "-----", "-xxxx"},
    {"fmi2GetContinuousStates", get_states, "-----", "-xxxx"},
    {"fmi2GetNominalsOfContinuousStates", nominals, "-----", "xxxxx"},
};

/* The answer of a row: of the table of phases, or that nothing is allowed. */
static void answers(fmi2Component c, size_t row, char allowed, const char *phase)
{
    fmi2Status result;
    forget();
    result = table[row].call(c);
    if (allowed != '-') {
        fmi2Status expected = allowed == 'd' ? fmi2Discard : fmi2OK;
        CHECK(result == expected, "%s when %s", table[row].function, phase);
    } else {
        CHECK(result == fmi2Error, "%s when %s", table[row].function, phase);
        CHECK(strstr(heard.text, table[row].function) && strstr(heard.text, phase), "the message names %s and %s",
              table[row].function, phase);
        /* A rejected call has no effect: the instance can be used. */
        CHECK(fmu.Reset(c) == fmi2OK, "%s has broken the instance", table[row].function);
    }
}

/* With an instance for Model Exchange. */
void test_exchange_phases(void)
{
    const fmi2ValueReference input = ME_LEFT_VELOCITY;
    fmi2Component helper = exchanging(NULL);
    CHECK_OK(fmu.GetContinuousStates(helper, x, ME_STATES));
    CHECK_OK(fmu.GetReal(helper, &input, 1, &real));
    CHECK_OK(fmu.GetFMUstate(helper, &state));
    CHECK_OK(fmu.SerializedFMUstateSize(helper, state, &size));
    CHECK(size <= sizeof bytes, "%zu bytes", size);
    CHECK_OK(fmu.SerializeFMUstate(helper, state, bytes, size));
    for (int phase = 0; phase < PHASES; phase++) {
        for (size_t row = 0; row < sizeof table / sizeof *table; row++) {
            fmi2Component c = instantiate_as(fmi2ModelExchange);
            if (phase >= INITIALIZATION)
                CHECK(fmu.EnterInitializationMode(c) == fmi2OK, "enter");
            if (phase >= EVENT)
                CHECK(fmu.ExitInitializationMode(c) == fmi2OK, "exit");
            if (phase == CONTINUOUS)
                CHECK(fmu.EnterContinuousTimeMode(c) == fmi2OK, "continuous");
            if (phase == TERMINATED)
                CHECK(fmu.Terminate(c) == fmi2OK, "terminate");
            answers(c, row, table[row].exchange[phase], exchange_names[phase]);
            fmu.FreeInstance(c);
        }
    }
    CHECK_OK(fmu.FreeFMUstate(helper, &state));
    fmu.FreeInstance(helper);
}

void test_phases(void)
{
    fmi2Component helper = running();
    CHECK_OK(fmu.GetFMUstate(helper, &state));
    CHECK_OK(fmu.SerializedFMUstateSize(helper, state, &size));
    CHECK(size <= sizeof bytes, "%zu bytes", size);
    for (int phase = 0; phase < PHASES; phase++) {
        for (size_t row = 0; row < sizeof table / sizeof *table; row++) {
            fmi2Component c = in_phase(phase);
            answers(c, row, table[row].allowed[phase], names[phase]);
            fmu.FreeInstance(c);
        }
    }
    /* FMI 2.0.4, 4.2.3: "If a status is required which cannot be retrieved by the slave it returns fmi2Discard." No
       kind has an Integer value. */
    CHECK_DISCARD(fmu.GetIntegerStatus(helper, fmi2DoStepStatus, &integer), "Integer");
    CHECK_DISCARD(fmu.GetStatus(helper, fmi2Terminated, &status), "kind");
    CHECK_DISCARD(fmu.GetStatus(helper, 77, &status), "77");
    CHECK_DISCARD(fmu.GetRealStatus(helper, fmi2Terminated, &real), "Real");
    CHECK_DISCARD(fmu.GetBooleanStatus(helper, fmi2DoStepStatus, &boolean), "Boolean");
    CHECK_DISCARD(fmu.GetStringStatus(helper, fmi2LastSuccessfulTime, &string), "String");
    CHECK_ERROR(fmu.GetStatus(helper, fmi2DoStepStatus, NULL), "NULL");
    CHECK_OK(fmu.FreeFMUstate(helper, &state));
    fmu.FreeInstance(helper);
}

/* What a discarded step leaves behind, and the way back. */
void test_discard(void)
{
    const fmi2ValueReference max_steps = MAX_STEPS;
    const double one = 1.0, many = 1e5;
    fmi2FMUstate before = NULL;
    unsigned long long expected;
    fmi2Component c = running();
    drive(c, 0.0, 0.05, 4);
    CHECK_OK(fmu.GetFMUstate(c, &before));
    drive(c, 0.2, 0.05, 2);
    expected = hash_state(c);

    CHECK_OK(fmu.SetFMUstate(c, before));
    CHECK_OK(fmu.SetReal(c, &max_steps, 1, &one));
    forget();
    CHECK(fmu.DoStep(c, 0.2, 0.1, fmi2False) == fmi2Discard, "too much work");
    CHECK(heard.status == fmi2Discard && heard.messages == 1, "one message");
    CHECK_OK(fmu.GetStatus(c, fmi2DoStepStatus, &status));
    CHECK(status == fmi2Discard, "%d", status);
    CHECK_OK(fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &real));
    CHECK(fabs(real - 0.2) < 1e-12, "the step has changed nothing: %.17g", real);
    CHECK_OK(fmu.GetBooleanStatus(c, fmi2Terminated, &boolean));
    CHECK(boolean == fmi2False, "%d", boolean);
    CHECK_ERROR(fmu.DoStep(c, real, 0.01, fmi2False), "step failed");
    CHECK_ERROR(fmu.SetReal(c, &max_steps, 1, &many), "step failed");
    CHECK_ERROR(fmu.SetReal(c, &max_steps, 1, &many), "the last fmi2DoStep failed: only fmi2SetFMUstate");

    CHECK_OK(fmu.SetFMUstate(c, before));
    drive(c, 0.2, 0.05, 2);
    CHECK(hash_state(c) == expected, "restored after a discarded step");
    CHECK_OK(fmu.FreeFMUstate(c, &before));
    fmu.FreeInstance(c);
}
