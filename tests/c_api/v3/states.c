/* Saved states of FMI 3: the run goes on bit for bit; states, and instances, of FMI 2 are refused. */
#include "importer3.h"
#include "robot.h"
#include <stdlib.h>
#include <string.h>

void test_v3_states(void)
{
    fmi3FMUState state = NULL, copy = NULL, null = NULL;
    fmi2FMUstate old = NULL;
    size_t size = 0;
    fmi3Byte *bytes;
    unsigned long long here, expected;
    fmi3Instance c = running3(), other = instantiate3();
    fmi2Component older = running();

    drive3(c, 0.0, 0.05, 4);
    here = hash_state3(c);
    CHECK_OK(fmu3.GetFMUState(c, &state));
    drive3(c, 0.2, 0.05, 4);
    expected = hash_state3(c);
    CHECK_OK(fmu3.SetFMUState(other, state));
    CHECK(hash_state3(other) == here && here != expected, "another instance");
    drive3(other, 0.2, 0.05, 4);
    CHECK(hash_state3(other) == expected, "another instance goes on");
    CHECK_OK(fmu3.SerializedFMUStateSize(c, state, &size));
    bytes = malloc(size);
    CHECK_OK(fmu3.SerializeFMUState(c, state, bytes, size));
    CHECK_ERROR(fmu3.SerializeFMUState(c, state, bytes, size - 1), "bytes");
    CHECK_OK(fmu3.Reset(other));
    CHECK_OK(fmu3.DeserializeFMUState(other, bytes, size, &copy));
    CHECK_OK(fmu3.SetFMUState(other, copy));
    drive3(other, 0.2, 0.05, 4);
    CHECK(hash_state3(other) == expected, "from bytes");
    for (size_t i = 0; i < size; i += 7) {
        bytes[i] ^= 0x10;
        CHECK(fmu3.DeserializeFMUState(other, bytes, size, &null) == fmi3Error && !null, "byte %zu is damaged", i);
        bytes[i] ^= 0x10;
    }

    /* Of the other version. */
    CHECK_OK(fmu.GetFMUstate(older, &old));
    CHECK_ERROR(fmu3.SetFMUState(c, old), "fmi2 functions");
    CHECK_ERROR(fmu.SetFMUstate(older, state), "fmi3 functions");
    CHECK_ERROR(fmu.DeSerializeFMUstate(older, (fmi2Byte *)bytes, size, &null), "fmi3 functions");
    CHECK(hash_state3(c) == expected, "nothing has changed");
    CHECK_ERROR(fmu3.Terminate(older), "made by fmi2");
    CHECK_ERROR(fmu.Terminate(c), "made by fmi3");
    fmu3.FreeInstance(older);
    fmu.FreeInstance(c);
    CHECK(fmu.DoStep(older, 0.0, 0.01, 1) == fmi2OK, "it was not freed");
    CHECK(step3(c, 0.4, 0.01) == fmi3OK, "it was not freed");

    CHECK_ERROR(fmu3.GetFMUState(c, NULL), "NULL");
    CHECK_ERROR(fmu3.SetFMUState(c, NULL), "NULL");
    CHECK_ERROR(fmu3.DeserializeFMUState(c, bytes, size, NULL), "NULL");
    CHECK_ERROR(fmu3.DeserializeFMUState(c, NULL, size, &null), "NULL");
    CHECK_ERROR(fmu3.DeserializeFMUState(c, bytes, 0, &null), "too short");
    CHECK_OK(fmu3.FreeFMUState(c, NULL));
    CHECK_OK(fmu3.FreeFMUState(c, &null));
    CHECK_OK(fmu3.FreeFMUState(c, &state));
    CHECK_OK(fmu3.FreeFMUState(c, &copy));
    CHECK_OK(fmu.FreeFMUstate(older, &old));
    free(bytes);
    fmu.FreeInstance(older);
    fmu3.FreeInstance(c);
    fmu3.FreeInstance(other);
}
