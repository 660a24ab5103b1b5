/* What an importer needs of FMI 2.0, written from the standard: types, and one list of all functions. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

enum { fmi2False, fmi2True };
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

typedef const fmi2ValueReference *References;
typedef const fmi2Real *Reals;

/* F(result, name, arguments) for every function of the standard. */
#define FMI2_FUNCTIONS(F)                                                                                   \
    F(const char *, GetTypesPlatform, (void))                                                               \
    F(const char *, GetVersion, (void))                                                                     \
    F(fmi2Status, SetDebugLogging, (fmi2Component, fmi2Boolean, size_t, const fmi2String *))                \
    F(fmi2Component, Instantiate,                                                                           \
      (fmi2String, int, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean))   \
    F(void, FreeInstance, (fmi2Component))                                                                  \
    F(fmi2Status, SetupExperiment,                                                                          \
      (fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real))                              \
    F(fmi2Status, EnterInitializationMode, (fmi2Component))                                                 \
    F(fmi2Status, ExitInitializationMode, (fmi2Component))                                                  \
    F(fmi2Status, Terminate, (fmi2Component))                                                               \
    F(fmi2Status, Reset, (fmi2Component))                                                                   \
    F(fmi2Status, GetReal, (fmi2Component, References, size_t, fmi2Real *))                                 \
    F(fmi2Status, GetInteger, (fmi2Component, References, size_t, fmi2Integer *))                           \
    F(fmi2Status, GetBoolean, (fmi2Component, References, size_t, fmi2Boolean *))                           \
    F(fmi2Status, GetString, (fmi2Component, References, size_t, fmi2String *))                             \
    F(fmi2Status, SetReal, (fmi2Component, References, size_t, Reals))                                      \
    F(fmi2Status, SetInteger, (fmi2Component, References, size_t, const fmi2Integer *))                     \
    F(fmi2Status, SetBoolean, (fmi2Component, References, size_t, const fmi2Boolean *))                     \
    F(fmi2Status, SetString, (fmi2Component, References, size_t, const fmi2String *))                       \
    F(fmi2Status, GetFMUstate, (fmi2Component, fmi2FMUstate *))                                             \
    F(fmi2Status, SetFMUstate, (fmi2Component, fmi2FMUstate))                                               \
    F(fmi2Status, FreeFMUstate, (fmi2Component, fmi2FMUstate *))                                            \
    F(fmi2Status, SerializedFMUstateSize, (fmi2Component, fmi2FMUstate, size_t *))                          \
    F(fmi2Status, SerializeFMUstate, (fmi2Component, fmi2FMUstate, fmi2Byte *, size_t))                     \
    F(fmi2Status, DeSerializeFMUstate, (fmi2Component, const fmi2Byte *, size_t, fmi2FMUstate *))           \
    F(fmi2Status, GetDirectionalDerivative,                                                                 \
      (fmi2Component, References, size_t, References, size_t, Reals, fmi2Real *))                           \
    F(fmi2Status, EnterEventMode, (fmi2Component))                                                          \
    F(fmi2Status, NewDiscreteStates, (fmi2Component, fmi2EventInfo *))                                      \
    F(fmi2Status, EnterContinuousTimeMode, (fmi2Component))                                                 \
    F(fmi2Status, CompletedIntegratorStep, (fmi2Component, fmi2Boolean, fmi2Boolean *, fmi2Boolean *))      \
    F(fmi2Status, SetTime, (fmi2Component, fmi2Real))                                                       \
    F(fmi2Status, SetContinuousStates, (fmi2Component, Reals, size_t))                                      \
    F(fmi2Status, GetDerivatives, (fmi2Component, fmi2Real *, size_t))                                      \
    F(fmi2Status, GetEventIndicators, (fmi2Component, fmi2Real *, size_t))                                  \
    F(fmi2Status, GetContinuousStates, (fmi2Component, fmi2Real *, size_t))                                 \
    F(fmi2Status, GetNominalsOfContinuousStates, (fmi2Component, fmi2Real *, size_t))                       \
    F(fmi2Status, SetRealInputDerivatives, (fmi2Component, References, size_t, const fmi2Integer *, Reals)) \
    F(fmi2Status, GetRealOutputDerivatives,                                                                 \
      (fmi2Component, References, size_t, const fmi2Integer *, fmi2Real *))                                 \
    F(fmi2Status, DoStep, (fmi2Component, fmi2Real, fmi2Real, fmi2Boolean))                                 \
    F(fmi2Status, CancelStep, (fmi2Component))                                                              \
    F(fmi2Status, GetStatus, (fmi2Component, int, fmi2Status *))                                            \
    F(fmi2Status, GetRealStatus, (fmi2Component, int, fmi2Real *))                                          \
    F(fmi2Status, GetIntegerStatus, (fmi2Component, int, fmi2Integer *))                                    \
    F(fmi2Status, GetBooleanStatus, (fmi2Component, int, fmi2Boolean *))                                    \
    F(fmi2Status, GetStringStatus, (fmi2Component, int, fmi2String *))

#endif
