/* Saved states: the run goes on bit for bit, in the same instance, another one, another process. */
#include "importer.h"
#include "robot.h"
#include <stdlib.h>
#include <string.h>

static fmi2Byte *serialized(fmi2Component c, size_t *size)
{
    fmi2FMUstate state = NULL;
    fmi2Byte *bytes;
    CHECK_OK(fmu.GetFMUstate(c, &state));
    CHECK_OK(fmu.SerializedFMUstateSize(c, state, size));
    bytes = malloc(*size);
    CHECK_OK(fmu.SerializeFMUstate(c, state, bytes, *size));
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    CHECK(state == NULL, "free sets the pointer to null");
    return bytes;
}

/* Falling, driving, tunables changed on the way: all of it must be in the state. */
static fmi2Component halfway(void)
{
    const fmi2ValueReference start = INITIAL_Z, tunables[] = {GRAVITY_Z, GROUND_FRICTION};
    const double height = 0.4, values[] = {-3.7, 0.5};
    fmi2Component c = instantiate();
    CHECK_OK(fmu.SetupExperiment(c, fmi2True, 1e-4, 0.0, fmi2True, 1.0));
    CHECK_OK(fmu.EnterInitializationMode(c));
    CHECK_OK(fmu.SetReal(c, &start, 1, &height));
    CHECK_OK(fmu.ExitInitializationMode(c));
    drive(c, 0.0, 0.05, 6);
    CHECK_OK(fmu.SetReal(c, tunables, 2, values));
    return c;
}

static void rest(fmi2Component c)
{
    drive(c, 0.3, 0.05, 8);
}

void test_states(void)
{
    fmi2FMUstate state = NULL, same;
    unsigned long long expected, here;
    size_t size;
    fmi2Byte *bytes;
    fmi2Component c = halfway(), other = instantiate();

    here = hash_state(c);
    bytes = serialized(c, &size);
    CHECK_OK(fmu.GetFMUstate(c, &state));
    rest(c);
    expected = hash_state(c);
    CHECK(expected != here, "the robot moves");

    for (int i = 0; i < 2; i++) {
        CHECK_OK(fmu.SetFMUstate(c, state));
        CHECK(hash_state(c) == here, "outputs after going back");
        rest(c);
        CHECK(hash_state(c) == expected, "same instance");
    }
    CHECK_OK(fmu.SetFMUstate(other, state));
    CHECK(hash_state(other) == here, "outputs in another instance");
    rest(other);
    CHECK(hash_state(other) == expected, "another instance");

    /* A state that is already there is used again. */
    same = state;
    CHECK_OK(fmu.GetFMUstate(other, &state));
    CHECK(state == same, "reused");
    CHECK_OK(fmu.Reset(c));
    CHECK_OK(fmu.SetFMUstate(c, state));
    CHECK(hash_state(c) == expected, "the overwritten state");
    CHECK_OK(fmu.FreeFMUstate(c, &state));

    /* After fmi2Reset and from bytes. */
    CHECK_OK(fmu.Reset(other));
    CHECK_OK(fmu.DeSerializeFMUstate(other, bytes, size, &state));
    CHECK_OK(fmu.SetFMUstate(other, state));
    rest(other);
    CHECK(hash_state(other) == expected, "after a reset, from bytes");
    CHECK_OK(fmu.FreeFMUstate(other, &state));
    free(bytes);
    fmu.FreeInstance(c);
    fmu.FreeInstance(other);
}

/* Bytes that were cut, changed, or never were a state. */
void test_damage(void)
{
    size_t size;
    fmi2FMUstate state = NULL;
    fmi2Component c = halfway();
    unsigned long long before = hash_state(c);
    fmi2Byte *bytes = serialized(c, &size);
    for (size_t cut = 0; cut < size; cut += cut < 100 ? 1 : 37) {
        /* A copy of exactly this size, so that valgrind sees every read past its end. */
        fmi2Byte *copy = malloc(cut ? cut : 1);
        memcpy(copy, bytes, cut);
        CHECK_ERROR(fmu.DeSerializeFMUstate(c, copy, cut, &state), "saved state refused");
        free(copy);
    }
    for (size_t at = 0; at < size; at += at < 100 ? 1 : 13) {
        bytes[at] ^= (fmi2Byte)(1 << at % 8);
        CHECK_ERROR(fmu.DeSerializeFMUstate(c, bytes, size, &state), "saved state refused");
        bytes[at] ^= (fmi2Byte)(1 << at % 8);
    }
    CHECK(state == NULL, "nothing was made");
    CHECK_OK(fmu.DeSerializeFMUstate(c, bytes, size, &state));
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    CHECK(hash_state(c) == before, "the instance has not moved");
    free(bytes);
    fmu.FreeInstance(c);
}

/* First process: writes the state to a file, goes on, prints where it ends. */
void test_save(const char *path)
{
    size_t size;
    fmi2Component c = halfway();
    fmi2Byte *bytes = serialized(c, &size);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, size, file) == size, "%s", path);
    fclose(file);
    free(bytes);
    rest(c);
    print_state(stdout, c);
    fmu.FreeInstance(c);
}

/* Second process: goes on from the file, prints where it ends. */
void test_resume(const char *path)
{
    static fmi2Byte bytes[1 << 20];
    fmi2FMUstate state = NULL;
    fmi2Component c = instantiate();
    FILE *file = fopen(path, "rb");
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    CHECK_OK(fmu.DeSerializeFMUstate(c, bytes, size, &state));
    CHECK_OK(fmu.SetFMUstate(c, state));
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    rest(c);
    print_state(stdout, c);
    fmu.FreeInstance(c);
}

/* The state of another FMU. */
void test_foreign(const char *path)
{
    static fmi2Byte bytes[1 << 20];
    fmi2FMUstate state = NULL;
    fmi2Component c = instantiate();
    FILE *file = fopen(path, "rb");
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    CHECK_ERROR(fmu.DeSerializeFMUstate(c, bytes, size, &state), "another FMU");
    fmu.FreeInstance(c);
}

void test_reset(void)
{
    const fmi2ValueReference changed[] = {INITIAL_Z, GRAVITY_Z, GROUND_FRICTION};
    const double values[] = {1.0, -1.0, 0.1};
    unsigned long long expected;
    fmi2Component c = running();
    drive(c, 0.0, 0.05, 10);
    expected = hash_state(c);
    for (int i = 0; i < 2; i++) {
        CHECK_OK(fmu.Reset(c));
        if (i) {
            CHECK_OK(fmu.SetupExperiment(c, fmi2True, 0.1, 7.0, fmi2True, 8.0));
            CHECK_OK(fmu.SetReal(c, changed, 3, values));
            CHECK_OK(fmu.EnterInitializationMode(c));
            CHECK_OK(fmu.ExitInitializationMode(c));
            CHECK_OK(fmu.DoStep(c, 7.0, 0.3, fmi2True));
            CHECK_OK(fmu.Reset(c));
        }
        CHECK_OK(fmu.EnterInitializationMode(c));
        CHECK_OK(fmu.ExitInitializationMode(c));
        drive(c, 0.0, 0.05, 10);
        CHECK(hash_state(c) == expected, "after fmi2Reset");
    }
    fmu.FreeInstance(c);
}
