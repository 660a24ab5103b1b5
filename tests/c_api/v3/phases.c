/* Every function in every phase that an importer can reach, of both interfaces, against the tables of FMI 3.0. */
#include "exchange.h"
#include "importer3.h"
#include "robot.h"
#include <math.h>
#include <string.h>

enum { INSTANTIATED, INITIALIZATION, STEP, UPDATE, TERMINATED, PHASES };
static const char *const names[PHASES] = {"instantiated", "initialization mode", "step mode",
                                          "intermediate update mode", "terminated"};
/* Phases of an instance for Model Exchange. */
enum { EVENT = STEP, CONTINUOUS = UPDATE };
static const char *const exchange_names[PHASES] = {"instantiated", "initialization mode", "event mode",
                                                   "continuous-time mode", "terminated"};

static fmi3FMUState state, made;
static fmi3Byte bytes[1 << 16];
static size_t size, n;

/* One legal call of each function. */
#define CALL(name, call) \
    static fmi3Status call_##name(fmi3Instance c) { return call; }
static const fmi3ValueReference velocity = LEFT_VELOCITY, steps = STEPS;
static fmi3ValueReference other;
static fmi3DependencyKind kind;
static double real;
static int32_t integer;
static bool flag;
static double x[ME_STATES], rates[ME_STATES];
CALL(SetDebugLogging, fmu3.SetDebugLogging(c, false, 0, NULL))
CALL(EnterInitializationMode, fmu3.EnterInitializationMode(c, true, 1e-4, 0.0, true, 1.0))
CALL(ExitInitializationMode, fmu3.ExitInitializationMode(c))
CALL(Terminate, fmu3.Terminate(c))
CALL(Reset, fmu3.Reset(c))
CALL(GetFloat32, fmu3.GetFloat32(c, NULL, 0, NULL, 0))
CALL(GetFloat64, fmu3.GetFloat64(c, &velocity, 1, &real, 1))
CALL(GetInt8, fmu3.GetInt8(c, NULL, 0, NULL, 0))
CALL(GetUInt8, fmu3.GetUInt8(c, NULL, 0, NULL, 0))
CALL(GetInt16, fmu3.GetInt16(c, NULL, 0, NULL, 0))
CALL(GetUInt16, fmu3.GetUInt16(c, NULL, 0, NULL, 0))
CALL(GetInt32, fmu3.GetInt32(c, &steps, 1, &integer, 1))
CALL(GetUInt32, fmu3.GetUInt32(c, NULL, 0, NULL, 0))
CALL(GetInt64, fmu3.GetInt64(c, NULL, 0, NULL, 0))
CALL(GetUInt64, fmu3.GetUInt64(c, NULL, 0, NULL, 0))
CALL(GetBoolean, fmu3.GetBoolean(c, NULL, 0, NULL, 0))
CALL(GetString, fmu3.GetString(c, NULL, 0, NULL, 0))
CALL(GetBinary, fmu3.GetBinary(c, NULL, 0, NULL, NULL, 0))
CALL(GetClock, fmu3.GetClock(c, NULL, 0, NULL))
CALL(SetFloat32, fmu3.SetFloat32(c, NULL, 0, NULL, 0))
CALL(SetFloat64, fmu3.SetFloat64(c, &velocity, 1, &real, 1))
CALL(SetInt8, fmu3.SetInt8(c, NULL, 0, NULL, 0))
CALL(SetUInt8, fmu3.SetUInt8(c, NULL, 0, NULL, 0))
CALL(SetInt16, fmu3.SetInt16(c, NULL, 0, NULL, 0))
CALL(SetUInt16, fmu3.SetUInt16(c, NULL, 0, NULL, 0))
CALL(SetInt32, fmu3.SetInt32(c, NULL, 0, NULL, 0))
CALL(SetUInt32, fmu3.SetUInt32(c, NULL, 0, NULL, 0))
CALL(SetInt64, fmu3.SetInt64(c, NULL, 0, NULL, 0))
CALL(SetUInt64, fmu3.SetUInt64(c, NULL, 0, NULL, 0))
CALL(SetBoolean, fmu3.SetBoolean(c, NULL, 0, NULL, 0))
CALL(SetString, fmu3.SetString(c, NULL, 0, NULL, 0))
CALL(SetBinary, fmu3.SetBinary(c, NULL, 0, NULL, NULL, 0))
CALL(SetClock, fmu3.SetClock(c, NULL, 0, NULL))
CALL(SetFMUState, fmu3.SetFMUState(c, state))
CALL(SerializedFMUStateSize, fmu3.SerializedFMUStateSize(c, state, &size))
CALL(SerializeFMUState, fmu3.SerializeFMUState(c, state, bytes, size))
CALL(GetOutputDerivatives, fmu3.GetOutputDerivatives(c, NULL, 0, NULL, NULL, 0))
CALL(DoStep, fmu3.DoStep(c, 0.0, 0.01, true, &flag, &flag, &flag, &real))
CALL(GetNumberOfVariableDependencies, fmu3.GetNumberOfVariableDependencies(c, 0, &n))
CALL(GetVariableDependencies, fmu3.GetVariableDependencies(c, 0, &n, &other, &n, &kind, 1))
CALL(GetDirectionalDerivative, fmu3.GetDirectionalDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0))
CALL(GetAdjointDerivative, fmu3.GetAdjointDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0))
CALL(EnterConfigurationMode, fmu3.EnterConfigurationMode(c))
CALL(ExitConfigurationMode, fmu3.ExitConfigurationMode(c))
CALL(GetIntervalDecimal, fmu3.GetIntervalDecimal(c, NULL, 0, NULL, NULL))
CALL(GetIntervalFraction, fmu3.GetIntervalFraction(c, NULL, 0, NULL, NULL, NULL))
CALL(GetShiftDecimal, fmu3.GetShiftDecimal(c, NULL, 0, NULL))
CALL(GetShiftFraction, fmu3.GetShiftFraction(c, NULL, 0, NULL, NULL))
CALL(SetIntervalDecimal, fmu3.SetIntervalDecimal(c, NULL, 0, NULL))
CALL(SetIntervalFraction, fmu3.SetIntervalFraction(c, NULL, 0, NULL, NULL))
CALL(SetShiftDecimal, fmu3.SetShiftDecimal(c, NULL, 0, NULL))
CALL(SetShiftFraction, fmu3.SetShiftFraction(c, NULL, 0, NULL, NULL))
CALL(EnterEventMode, fmu3.EnterEventMode(c))
CALL(EnterStepMode, fmu3.EnterStepMode(c))
CALL(EvaluateDiscreteStates, fmu3.EvaluateDiscreteStates(c))
CALL(UpdateDiscreteStates, fmu3.UpdateDiscreteStates(c, &flag, &flag, &flag, &flag, &flag, &real))
CALL(EnterContinuousTimeMode, fmu3.EnterContinuousTimeMode(c))
CALL(CompletedIntegratorStep, fmu3.CompletedIntegratorStep(c, true, &flag, &flag))
CALL(SetTime, fmu3.SetTime(c, 0.0))
CALL(SetContinuousStates, fmu3.SetContinuousStates(c, x, ME_STATES))
CALL(GetContinuousStateDerivatives, fmu3.GetContinuousStateDerivatives(c, rates, ME_STATES))
CALL(GetEventIndicators, fmu3.GetEventIndicators(c, rates, 1))
CALL(GetContinuousStates, fmu3.GetContinuousStates(c, rates, ME_STATES))
CALL(GetNominalsOfContinuousStates, fmu3.GetNominalsOfContinuousStates(c, rates, ME_STATES))
CALL(GetNumberOfEventIndicators, fmu3.GetNumberOfEventIndicators(c, &n))
CALL(GetNumberOfContinuousStates, fmu3.GetNumberOfContinuousStates(c, &n))
CALL(ActivateModelPartition, fmu3.ActivateModelPartition(c, 0, 0.0))

static fmi3Status get_state(fmi3Instance c)
{
    fmi3FMUState own = NULL;
    fmi3Status result = fmu3.GetFMUState(c, &own);
    CHECK((own != NULL) == (result == fmi3OK), "a state only if all went well");
    if (own)
        CHECK(fmu3.FreeFMUState(c, &own) == fmi3OK && own == NULL, "free");
    return result;
}

static fmi3Status deserialize(fmi3Instance c)
{
    fmi3Status result;
    made = NULL;
    result = fmu3.DeserializeFMUState(c, bytes, size, &made);
    CHECK(made != NULL, "a state");
    return result;
}

static fmi3Status free_state(fmi3Instance c)
{
    fmi3FMUState own = made;
    made = NULL;
    return fmu3.FreeFMUState(c, &own);
}

/* x: fmi3OK, -: fmi3Error. Columns: instantiated, initialization, step, intermediate update, terminated; for Model
   Exchange instantiated, initialization, event, continuous time, terminated. */
static const struct {
    const char *function;
    fmi3Status (*call)(fmi3Instance);
    const char *allowed, *exchange;
} table[] = {
    {"fmi3SetDebugLogging", call_SetDebugLogging, "xxxxx", "xxxxx"},
    {"fmi3EnterInitializationMode", call_EnterInitializationMode, "x----", "x----"},
    {"fmi3ExitInitializationMode", call_ExitInitializationMode, "-x---", "-x---"},
    {"fmi3Terminate", call_Terminate, "--x--", "--xx-"},
    {"fmi3Reset", call_Reset, "xxx-x", "xxxxx"},
    {"fmi3GetFloat32", call_GetFloat32, "xxxxx", "xxxxx"},
    {"fmi3GetFloat64", call_GetFloat64, "xxxxx", "xxxxx"},
    {"fmi3GetInt8", call_GetInt8, "xxxxx", "xxxxx"},
    {"fmi3GetUInt8", call_GetUInt8, "xxxxx", "xxxxx"},
    {"fmi3GetInt16", call_GetInt16, "xxxxx", "xxxxx"},
    {"fmi3GetUInt16", call_GetUInt16, "xxxxx", "xxxxx"},
    {"fmi3GetInt32", call_GetInt32, "xxxxx", "xxxxx"},
    {"fmi3GetUInt32", call_GetUInt32, "xxxxx", "xxxxx"},
    {"fmi3GetInt64", call_GetInt64, "xxxxx", "xxxxx"},
    {"fmi3GetUInt64", call_GetUInt64, "xxxxx", "xxxxx"},
    {"fmi3GetBoolean", call_GetBoolean, "xxxxx", "xxxxx"},
    {"fmi3GetString", call_GetString, "xxxxx", "xxxxx"},
    {"fmi3GetBinary", call_GetBinary, "xxxxx", "xxxxx"},
    {"fmi3GetClock", call_GetClock, "xxxxx", "xxxxx"},
    {"fmi3SetFloat32", call_SetFloat32, "xxxx-", "xxxx-"},
    {"fmi3SetFloat64", call_SetFloat64, "xxxx-", "xxxx-"},
    {"fmi3SetInt8", call_SetInt8, "xxxx-", "xxxx-"},
    {"fmi3SetUInt8", call_SetUInt8, "xxxx-", "xxxx-"},
    {"fmi3SetInt16", call_SetInt16, "xxxx-", "xxxx-"},
    {"fmi3SetUInt16", call_SetUInt16, "xxxx-", "xxxx-"},
    {"fmi3SetInt32", call_SetInt32, "xxxx-", "xxxx-"},
    {"fmi3SetUInt32", call_SetUInt32, "xxxx-", "xxxx-"},
    {"fmi3SetInt64", call_SetInt64, "xxxx-", "xxxx-"},
    {"fmi3SetUInt64", call_SetUInt64, "xxxx-", "xxxx-"},
    {"fmi3SetBoolean", call_SetBoolean, "xxxx-", "xxxx-"},
    {"fmi3SetString", call_SetString, "xxxx-", "xxxx-"},
    {"fmi3SetBinary", call_SetBinary, "xxxx-", "xxxx-"},
    {"fmi3SetClock", call_SetClock, "xxxx-", "xxxx-"},
    {"fmi3GetFMUState", get_state, "xxx-x", "xxxxx"},
    {"fmi3SetFMUState", call_SetFMUState, "xxx-x", "xxxxx"},
    {"fmi3FreeFMUState", free_state, "xxxxx", "xxxxx"},
    {"fmi3SerializedFMUStateSize", call_SerializedFMUStateSize, "xxxxx", "xxxxx"},
    {"fmi3SerializeFMUState", call_SerializeFMUState, "xxxxx", "xxxxx"},
    {"fmi3DeserializeFMUState", deserialize, "xxxxx", "xxxxx"},
    {"fmi3GetOutputDerivatives", call_GetOutputDerivatives, "--xxx", "-----"},
    {"fmi3DoStep", call_DoStep, "--x--", "-----"},
    {"fmi3GetNumberOfVariableDependencies", call_GetNumberOfVariableDependencies, "-----", "-----"},
    {"fmi3GetVariableDependencies", call_GetVariableDependencies, "-----", "-----"},
    {"fmi3GetDirectionalDerivative", call_GetDirectionalDerivative, "-----", "-xxxx"},
    {"fmi3GetAdjointDerivative", call_GetAdjointDerivative, "-----", "-----"},
    {"fmi3EnterConfigurationMode", call_EnterConfigurationMode, "-----", "-----"},
    {"fmi3ExitConfigurationMode", call_ExitConfigurationMode, "-----", "-----"},
    {"fmi3GetIntervalDecimal", call_GetIntervalDecimal, "-----", "-----"},
    {"fmi3GetIntervalFraction", call_GetIntervalFraction, "-----", "-----"},
    {"fmi3GetShiftDecimal", call_GetShiftDecimal, "-----", "-----"},
    {"fmi3GetShiftFraction", call_GetShiftFraction, "-----", "-----"},
    {"fmi3SetIntervalDecimal", call_SetIntervalDecimal, "-----", "-----"},
    {"fmi3SetIntervalFraction", call_SetIntervalFraction, "-----", "-----"},
    {"fmi3SetShiftDecimal", call_SetShiftDecimal, "-----", "-----"},
    {"fmi3SetShiftFraction", call_SetShiftFraction, "-----", "-----"},
    {"fmi3EnterEventMode", call_EnterEventMode, "-----", "---x-"},
    {"fmi3EnterStepMode", call_EnterStepMode, "-----", "-----"},
    {"fmi3EvaluateDiscreteStates", call_EvaluateDiscreteStates, "-----", "-----"},
    {"fmi3UpdateDiscreteStates", call_UpdateDiscreteStates, "-----", "--x--"},
    {"fmi3EnterContinuousTimeMode", call_EnterContinuousTimeMode, "-----", "--x--"},
    {"fmi3CompletedIntegratorStep", call_CompletedIntegratorStep, "-----", "---x-"},
    {"fmi3SetTime", call_SetTime, "-----", "---x-"},
    {"fmi3SetContinuousStates", call_SetContinuousStates, "-----", "---x-"},
    {"fmi3GetContinuousStateDerivatives", call_GetContinuousStateDerivatives, "-----", "-xxxx"},
    {"fmi3GetEventIndicators", call_GetEventIndicators, "-----", "-xxxx"},
    {"fmi3GetContinuousStates", call_GetContinuousStates, "-----", "-xxxx"},
    {"fmi3GetNominalsOfContinuousStates", call_GetNominalsOfContinuousStates, "-----", "-xxxx"},
    {"fmi3GetNumberOfEventIndicators", call_GetNumberOfEventIndicators, "-----", "xxxxx"},
    {"fmi3GetNumberOfContinuousStates", call_GetNumberOfContinuousStates, "-----", "xxxxx"},
    {"fmi3ActivateModelPartition", call_ActivateModelPartition, "-----", "-----"},
};

static fmi3Instance updated;
static size_t row;

static void answers(fmi3Instance c, char allowed, const char *phase)
{
    fmi3Status result;
    forget();
    result = table[row].call(c);
    if (allowed == 'x') {
        CHECK(result == fmi3OK, "%s when %s", table[row].function, phase);
    } else {
        CHECK(result == fmi3Error, "%s when %s", table[row].function, phase);
        CHECK(strstr(heard.text, table[row].function) && strstr(heard.text, phase), "the message names %s and %s",
              table[row].function, phase);
    }
}

static void check(fmi3Instance c, int phase)
{
    answers(c, table[row].allowed[phase], names[phase]);
}

static void update(fmi3InstanceEnvironment environment, double time, bool set, bool get, bool finished, bool may_end,
                   bool *end, double *when)
{
    (void)environment, (void)time, (void)end, (void)when;
    CHECK(set && get && finished && may_end, "%d %d %d %d", set, get, finished, may_end);
    check(updated, UPDATE);
    /* An instance cannot be freed while it works. */
    fmu3.FreeInstance(updated);
}

void test_v3_phases(void)
{
    fmi3Instance helper = running3();
    CHECK_OK(fmu3.GetFMUState(helper, &state));
    CHECK_OK(fmu3.SerializedFMUStateSize(helper, state, &size));
    CHECK(size <= sizeof bytes, "%zu bytes", size);
    for (int phase = 0; phase < PHASES; phase++) {
        for (row = 0; row < sizeof table / sizeof *table; row++) {
            const fmi3ValueReference required[] = {LEFT_VELOCITY};
            fmi3Instance c;
            if (phase == UPDATE && table[row].call == call_GetInt32)
                continue; /* Whole numbers are discrete: see test_v3_updates. */
            c = fmu3.InstantiateCoSimulation("robot", guid, resources, false, false, false, true,
                                             required, phase == UPDATE, &heard, logger3,
                                             phase == UPDATE ? update : NULL);
            CHECK(c != NULL, "instance");
            if (phase >= INITIALIZATION)
                CHECK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0) == fmi3OK, "enter");
            if (phase >= STEP)
                CHECK(fmu3.ExitInitializationMode(c) == fmi3OK, "exit");
            if (phase == TERMINATED)
                CHECK(fmu3.Terminate(c) == fmi3OK, "terminate");
            if (phase == UPDATE) {
                updated = c;
                CHECK(step3(c, 0.0, 1e-3) == fmi3OK, "step");
            } else {
                check(c, phase);
            }
            /* A rejected call has no effect: the instance can be used. */
            CHECK(fmu3.Reset(c) == fmi3OK, "%s has broken the instance", table[row].function);
            fmu3.FreeInstance(c);
        }
    }
    CHECK_OK(fmu3.FreeFMUState(helper, &state));
    fmu3.FreeInstance(helper);
}

/* With an instance for Model Exchange. */
void test_v3_exchange_phases(void)
{
    const fmi3ValueReference input = ME_LEFT_VELOCITY;
    fmi3Instance helper = exchanging3(NULL);
    CHECK_OK(fmu3.GetContinuousStates(helper, x, ME_STATES));
    CHECK_OK(fmu3.GetFloat64(helper, &input, 1, &real, 1));
    CHECK_OK(fmu3.GetFMUState(helper, &state));
    CHECK_OK(fmu3.SerializedFMUStateSize(helper, state, &size));
    CHECK(size <= sizeof bytes, "%zu bytes", size);
    CHECK_OK(fmu3.SerializeFMUState(helper, state, bytes, size));
    for (int phase = 0; phase < PHASES; phase++) {
        for (row = 0; row < sizeof table / sizeof *table; row++) {
            fmi3Instance c = exchange3();
            if (phase >= INITIALIZATION)
                CHECK(fmu3.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0) == fmi3OK, "enter");
            if (phase >= EVENT)
                CHECK(fmu3.ExitInitializationMode(c) == fmi3OK, "exit");
            if (phase == CONTINUOUS)
                CHECK(fmu3.EnterContinuousTimeMode(c) == fmi3OK, "continuous");
            if (phase == TERMINATED)
                CHECK(fmu3.Terminate(c) == fmi3OK, "terminate");
            answers(c, table[row].exchange[phase], exchange_names[phase]);
            /* A rejected call has no effect: the instance can be used. */
            CHECK(fmu3.Reset(c) == fmi3OK, "%s has broken the instance", table[row].function);
            fmu3.FreeInstance(c);
        }
    }
    CHECK_OK(fmu3.FreeFMUState(helper, &state));
    fmu3.FreeInstance(helper);
}
