/* Null pointers, wrong references, wrong values, wrong times, wrong FMUs: an error each, and the host lives. */
#include "importer.h"
#include "robot.h"
#include "system.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

static const fmi2ValueReference one = LEFT_VELOCITY;
static fmi2Real real;
static fmi2Integer integer;

void test_null(void)
{
    fmi2Component c = running();
    fmi2FMUstate state = NULL;
    fmi2Byte byte = 0;
    size_t size;
    fmi2EventInfo info;

    /* Without a component there is nobody to log to. */
    forget();
    fmu.FreeInstance(NULL);
    CHECK(fmu.SetDebugLogging(NULL, fmi2True, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.SetupExperiment(NULL, 0, 0, 0, 0, 0) == fmi2Error, "null");
    CHECK(fmu.EnterInitializationMode(NULL) == fmi2Error, "null");
    CHECK(fmu.ExitInitializationMode(NULL) == fmi2Error, "null");
    CHECK(fmu.Terminate(NULL) == fmi2Error, "null");
    CHECK(fmu.Reset(NULL) == fmi2Error, "null");
    CHECK(fmu.GetReal(NULL, &one, 1, &real) == fmi2Error, "null");
    CHECK(fmu.GetInteger(NULL, &one, 1, &integer) == fmi2Error, "null");
    CHECK(fmu.GetBoolean(NULL, &one, 1, &integer) == fmi2Error, "null");
    CHECK(fmu.GetString(NULL, &one, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.SetReal(NULL, &one, 1, &real) == fmi2Error, "null");
    CHECK(fmu.SetInteger(NULL, &one, 1, &integer) == fmi2Error, "null");
    CHECK(fmu.SetBoolean(NULL, &one, 1, &integer) == fmi2Error, "null");
    CHECK(fmu.SetString(NULL, &one, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.GetFMUstate(NULL, &state) == fmi2Error && state == NULL, "null");
    CHECK(fmu.SetFMUstate(NULL, NULL) == fmi2Error, "null");
    CHECK(fmu.FreeFMUstate(NULL, &state) == fmi2Error, "null");
    CHECK(fmu.SerializedFMUstateSize(NULL, NULL, &size) == fmi2Error, "null");
    CHECK(fmu.SerializeFMUstate(NULL, NULL, &byte, 1) == fmi2Error, "null");
    CHECK(fmu.DeSerializeFMUstate(NULL, &byte, 1, &state) == fmi2Error, "null");
    CHECK(fmu.GetDirectionalDerivative(NULL, NULL, 0, NULL, 0, NULL, NULL) == fmi2Error, "null");
    CHECK(fmu.SetRealInputDerivatives(NULL, NULL, 0, NULL, NULL) == fmi2Error, "null");
    CHECK(fmu.GetRealOutputDerivatives(NULL, NULL, 0, NULL, NULL) == fmi2Error, "null");
    CHECK(fmu.DoStep(NULL, 0, 1, 1) == fmi2Error, "null");
    CHECK(fmu.CancelStep(NULL) == fmi2Error, "null");
    CHECK(fmu.GetStatus(NULL, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.GetRealStatus(NULL, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.GetIntegerStatus(NULL, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.GetBooleanStatus(NULL, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.GetStringStatus(NULL, 0, NULL) == fmi2Error, "null");
    CHECK(fmu.EnterEventMode(NULL) == fmi2Error, "null");
    CHECK(fmu.NewDiscreteStates(NULL, &info) == fmi2Error, "null");
    CHECK(fmu.EnterContinuousTimeMode(NULL) == fmi2Error, "null");
    CHECK(fmu.CompletedIntegratorStep(NULL, 0, NULL, NULL) == fmi2Error, "null");
    CHECK(fmu.SetTime(NULL, 0) == fmi2Error, "null");
    CHECK(fmu.SetContinuousStates(NULL, NULL, 0) == fmi2Error, "null");
    CHECK(fmu.GetDerivatives(NULL, NULL, 0) == fmi2Error, "null");
    CHECK(fmu.GetEventIndicators(NULL, NULL, 0) == fmi2Error, "null");
    CHECK(fmu.GetContinuousStates(NULL, NULL, 0) == fmi2Error, "null");
    CHECK(fmu.GetNominalsOfContinuousStates(NULL, NULL, 0) == fmi2Error, "null");

    /* Null arrays are legal without elements, and only then. */
    CHECK_OK(fmu.GetReal(c, NULL, 0, NULL));
    CHECK_OK(fmu.GetInteger(c, NULL, 0, NULL));
    CHECK_OK(fmu.GetBoolean(c, NULL, 0, NULL));
    CHECK_OK(fmu.GetString(c, NULL, 0, NULL));
    CHECK_OK(fmu.SetReal(c, NULL, 0, NULL));
    CHECK_OK(fmu.SetInteger(c, NULL, 0, NULL));
    CHECK_OK(fmu.SetBoolean(c, NULL, 0, NULL));
    CHECK_OK(fmu.SetString(c, NULL, 0, NULL));
    CHECK_ERROR(fmu.GetReal(c, NULL, 1, &real), "'vr' is NULL");
    CHECK_ERROR(fmu.GetReal(c, &one, 1, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.SetReal(c, NULL, 1, &real), "'vr' is NULL");
    CHECK_ERROR(fmu.SetReal(c, &one, 1, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.GetInteger(c, NULL, 1, &integer), "'vr' is NULL");
    CHECK_ERROR(fmu.SetString(c, &one, 1, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.GetReal(c, &one, SIZE_MAX, &real), "elements");
    CHECK_ERROR(fmu.SetDebugLogging(c, fmi2True, 1, NULL), "'categories' is NULL");

    CHECK_ERROR(fmu.GetFMUstate(c, NULL), "'FMUstate' is NULL");
    CHECK_ERROR(fmu.SetFMUstate(c, NULL), "'FMUstate' is NULL");
    CHECK_OK(fmu.FreeFMUstate(c, NULL));
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    CHECK_ERROR(fmu.SerializedFMUstateSize(c, NULL, &size), "'FMUstate' is NULL");
    CHECK_OK(fmu.GetFMUstate(c, &state));
    CHECK_ERROR(fmu.SerializedFMUstateSize(c, state, NULL), "'size' is NULL");
    CHECK_OK(fmu.SerializedFMUstateSize(c, state, &size));
    CHECK_ERROR(fmu.SerializeFMUstate(c, state, NULL, size), "'serializedState' is NULL");
    CHECK_ERROR(fmu.SerializeFMUstate(c, state, &byte, 1), "bytes");
    CHECK_ERROR(fmu.DeSerializeFMUstate(c, NULL, 1, &state), "'serializedState' is NULL");
    CHECK_ERROR(fmu.DeSerializeFMUstate(c, &byte, 1, NULL), "'FMUstate' is NULL");
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    CHECK_ERROR(fmu.GetStatus(c, fmi2DoStepStatus, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.GetRealStatus(c, fmi2LastSuccessfulTime, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.GetBooleanStatus(c, fmi2Terminated, NULL), "'value' is NULL");
    CHECK_ERROR(fmu.GetStringStatus(c, fmi2PendingStatus, NULL), "'value' is NULL");
    fmu.FreeInstance(c);
}

void test_values(void)
{
    const fmi2ValueReference two[] = {LEFT_VELOCITY, 4000000000u};
    const fmi2ValueReference efforts[] = {LEFT_VELOCITY, LEFT_MAX_EFFORT};
    const fmi2ValueReference height = BASE_Z, steps = STEPS, start = INITIAL_Z;
    const fmi2ValueReference every[] = {LEFT_VELOCITY, BASE_Z, INITIAL_Z, GRAVITY_Z};
    const double bad[] = {NAN, INFINITY, -INFINITY};
    double values[4] = {1.5, 0.0, 0.0, 0.0};
    fmi2String string;
    fmi2Component c = running();
    unsigned long long before = hash_state(c);

    CHECK_ERROR(fmu.SetReal(c, two, 2, values), "4000000000");
    CHECK_ERROR(fmu.GetReal(c, two, 2, values), "4000000000");
    CHECK_ERROR(fmu.GetInteger(c, &one, 1, &integer), "is Real, not Integer");
    CHECK_ERROR(fmu.GetBoolean(c, &one, 1, &integer), "is Real, not Boolean");
    CHECK_ERROR(fmu.GetString(c, &one, 1, &string), "is Real, not String");
    CHECK_ERROR(fmu.SetInteger(c, &one, 1, &integer), "is Real, not Integer");
    CHECK_ERROR(fmu.SetBoolean(c, &one, 1, &integer), "is Real, not Boolean");
    CHECK_ERROR(fmu.GetReal(c, &steps, 1, &real), "is Integer, not Real");
    CHECK_ERROR(fmu.SetReal(c, &height, 1, values), "cannot be set");
    CHECK_ERROR(fmu.SetInteger(c, &steps, 1, &integer), "cannot be set");
    CHECK_ERROR(fmu.SetReal(c, &start, 1, values), "fixed");
    for (int i = 0; i < 3; i++) {
        values[1] = bad[i];
        CHECK_ERROR(fmu.SetReal(c, efforts, 2, values), "finite");
    }
    values[1] = -1.0;
    CHECK_ERROR(fmu.SetReal(c, efforts, 2, values), "from 0.0 to 1e30");
    CHECK(hash_state(c) == before, "a set call is all or nothing");
    CHECK_OK(fmu.GetReal(c, every, 4, values));
    CHECK_OK(fmu.SetReal(c, &one, 1, values));

    /* Outside its range a value counts, and that is said once. */
    real = 1e4;
    forget();
    CHECK(fmu.SetReal(c, &one, 1, &real) == fmi2OK, "out of range");
    CHECK(heard.messages == 1 && strcmp(heard.category, "logStatusWarning") == 0, "said once");
    CHECK_OK(fmu.SetReal(c, &one, 1, &real));
    CHECK_OK(fmu.GetReal(c, &one, 1, &values[0]));
    CHECK(values[0] == 1e4, "%g", values[0]);

    /* Not offered, and said so in modelDescription.xml. */
    CHECK_ERROR(fmu.GetDirectionalDerivative(c, &height, 1, &one, 1, &real, &real), "providesDirectionalDerivative");
    fmu.FreeInstance(c);
}

void test_times(void)
{
    const double steps[] = {0.0, -0.01, NAN, INFINITY, 1e300};
    const double starts[] = {NAN, INFINITY, -INFINITY};
    fmi2Component c = instantiate();
    for (int i = 0; i < 3; i++)
        CHECK_ERROR(fmu.SetupExperiment(c, 0, 0.0, starts[i], 0, 0.0), "startTime");
    CHECK_ERROR(fmu.SetupExperiment(c, 0, 0.0, 1.0, 1, 0.5), "stopTime");
    CHECK_ERROR(fmu.SetupExperiment(c, 1, -1e-3, 0.0, 0, 0.0), "tolerance");
    CHECK_OK(fmu.SetupExperiment(c, 1, 1e-4, 2.0, 1, 3.0));
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.ExitInitializationMode(c));
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        CHECK_ERROR(fmu.DoStep(c, 2.0, steps[i], fmi2True), "communicationStepSize");
    CHECK_ERROR(fmu.DoStep(c, 0.0, 0.1, fmi2True), "begin at 0 s");
    CHECK_ERROR(fmu.DoStep(c, NAN, 0.1, fmi2True), "begin");
    CHECK_OK(fmu.DoStep(c, 2.0 + 4e-16, 0.75, fmi2True));
    CHECK_OK(fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &real));
    CHECK(real == (2.0 + 4e-16) + 0.75, "%.17g", real);
    CHECK_OK(fmu.DoStep(c, real, 1e-12, fmi2True));
    CHECK_OK(fmu.DoStep(c, 2.75 - 1e-10, 1e-12, fmi2True));
    forget();
    CHECK(fmu.DoStep(c, 2.75, 0.5, fmi2True) == fmi2OK, "past the stop time");
    CHECK(strcmp(heard.category, "logStatusWarning") == 0, "a warning");
    CHECK_ERROR(fmu.DoStep(c, 3.25, 0.5, fmi2True), "stop time");
    CHECK_OK(fmu.Terminate(c));
    fmu.FreeInstance(c);
}

/* Times that add up with rounding errors, as masters have them. */
void test_jitter(void)
{
    double sum = 0.0;
    fmi2Component c = running();
    for (int i = 0; i < 1000; i++) {
        double product = i * (1.0 / 240.0);
        double h = 1.0 / 240.0 * (1.0 + (i % 3 - 1) * 1e-9);
        CHECK(fmu.DoStep(c, i % 2 ? product : sum, h, fmi2True) == fmi2OK, "step %d", i);
        sum = (i % 2 ? product : sum) + h;
    }
    CHECK_OK(fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &real));
    CHECK(real == sum, "%.17g instead of %.17g", real, sum);
    fmu.FreeInstance(c);
}

void test_instantiate(void)
{
    fmi2CallbackFunctions silent = {NULL, NULL, NULL, NULL, NULL};
    fmi2Component c;
#define REFUSED(words, ...)                                                                       \
    do {                                                                                          \
        forget();                                                                                 \
        CHECK(fmu.Instantiate(__VA_ARGS__, &callbacks, 0, 0) == NULL, "must be refused");         \
        CHECK(heard.messages == 1 && heard.status == fmi2Error, "one error");                     \
        CHECK(strcmp(heard.category, "logStatusError") == 0, "category");                         \
        CHECK(strcmp(heard.instance, "robot") == 0, "instance name '%s'", heard.instance);        \
        CHECK(strstr(heard.text, words) != NULL, "expected '%s'", words);                         \
    } while (0)
    REFUSED("for co-simulation", "robot", fmi2ModelExchange, guid, resources);
    REFUSED("fmuType is -7", "robot", -7, guid, resources);
    REFUSED("fmuGUID is '{wrong}'", "robot", fmi2CoSimulation, "{wrong}", resources);
    REFUSED("fmuGUID is ''", "robot", fmi2CoSimulation, NULL, resources);
    REFUSED("fmuResourceLocation is empty", "robot", fmi2CoSimulation, guid, NULL);
    REFUSED("fmuResourceLocation is empty", "robot", fmi2CoSimulation, guid, "");
    REFUSED("/no/such/place" SEPARATOR "model.json", "robot", fmi2CoSimulation, guid, "file:///no/such/place");
    REFUSED("scheme 'http'", "robot", fmi2CoSimulation, guid, "http://example.org/resources");
    /* A path that printf would choke on arrives unharmed; FMI's escape sign stays doubled. */
    REFUSED("/%s%n%d##r1##/", "robot", fmi2CoSimulation, guid, "file:///%s%n%d#r1#/");

    /* No logger, no callbacks, no name. */
    CHECK(fmu.Instantiate("robot", fmi2CoSimulation, "{wrong}", resources, &silent, 0, 1) == NULL, "wrong guid");
    CHECK(fmu.Instantiate(NULL, fmi2CoSimulation, NULL, NULL, NULL, 1, 1) == NULL, "all null");
    c = fmu.Instantiate(NULL, fmi2CoSimulation, guid, resources, NULL, 1, 1);
    CHECK(c != NULL, "without callbacks");
    CHECK(fmu.DoStep(c, 0.0, 0.1, 1) == fmi2Error, "not initialised");
    fmu.FreeInstance(c);
}

/* Each argument is a resource location that must be found. */
void test_locations(int count, char **locations)
{
    for (int i = 0; i < count; i++) {
        fmi2Component c;
        forget();
        c = fmu.Instantiate("robot", fmi2CoSimulation, guid, locations[i], &callbacks, 0, 0);
        CHECK(c != NULL, "%s", locations[i]);
        fmu.FreeInstance(c);
    }
}

/* Each argument is a folder whose prepared model is broken. */
void test_broken(int count, char **locations)
{
    for (int i = 0; i < count; i++) {
        forget();
        CHECK(fmu.Instantiate("robot", fmi2CoSimulation, guid, locations[i], &callbacks, 0, 0) == NULL, "%s",
              locations[i]);
        CHECK(heard.messages == 1 && heard.status == fmi2Error, "%s", locations[i]);
        CHECK(strstr(heard.text, "model.json") != NULL, "the message names the file");
        CHECK(strstr(heard.text, "export the FMU again") || strstr(heard.text, "unzip"), "the message has a remedy");
        printf("%s\n", heard.text);
    }
}

static fmi2Component inside;
static fmi2Status reentered;

static void reenter(void)
{
    fmi2FMUstate state = NULL;
    heard.reenter = NULL;
    reentered = fmu.GetFMUstate(inside, &state);
    fmu.FreeInstance(inside);
}

void test_logging(void)
{
    const char *name = "100%s of %n #r1#";
    const fmi2String unknown[] = {"logWeather"}, events[] = {"logEvents"}, errors[] = {"logStatusError"};
    fmi2CallbackFunctions copied = callbacks;
    fmi2Component c = fmu.Instantiate(name, fmi2CoSimulation, guid, resources, &copied, 0, 0);
    memset(&copied, 0, sizeof copied);
    CHECK(c != NULL, "instance");
    CHECK_ERROR(fmu.Terminate(c), "instantiated");
    CHECK(strcmp(heard.instance, name) == 0, "'%s'", heard.instance);

    CHECK_ERROR(fmu.SetDebugLogging(c, fmi2True, 1, unknown), "logWeather");
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.SetDebugLogging(c, fmi2True, 1, events));
    forget();
    CHECK(fmu.ExitInitializationMode(c) == fmi2OK, "exit");
    CHECK(heard.messages == 1 && strcmp(heard.category, "logEvents") == 0, "an event");
    forget();
    CHECK(fmu.ExitInitializationMode(c) == fmi2Error && heard.messages == 0, "errors were not asked for");
    CHECK_OK(fmu.SetDebugLogging(c, fmi2True, 1, errors));
    CHECK_ERROR(fmu.ExitInitializationMode(c), "step complete");
    CHECK_OK(fmu.SetDebugLogging(c, fmi2True, 0, NULL));
    CHECK_OK(fmu.SetDebugLogging(c, fmi2False, 0, NULL));
    CHECK_OK(fmu.GetReal(c, &one, 1, &real));

    /* A logger that calls back is refused, and does no harm. */
    forget();
    inside = c;
    reentered = fmi2OK;
    heard.reenter = reenter;
    CHECK(fmu.ExitInitializationMode(c) == fmi2Error, "step complete");
    CHECK(reentered == fmi2Error, "a call from inside the logger");
    CHECK_OK(fmu.GetReal(c, &one, 1, &real));
    fmu.FreeInstance(c);
}
