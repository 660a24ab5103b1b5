/* Getting and setting: scalars, arrays, wrong lengths, types and references. */
#include "importer3.h"
#include "robot.h"
#include <math.h>
#include <string.h>

static const fmi3ValueReference base = BASE_X, z = BASE_Z, velocity = LEFT_VELOCITY, steps = STEPS,
                                active = CONTACT_ACTIVE, now = TIME, initial = INITIAL_X, mass = BASE_MASS;

void test_v3_values(void)
{
    double values[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    float floats[2];
    int32_t integers[2] = {0, 0};
    int64_t longs[1];
    bool booleans[2];
    size_t sizes[1];
    fmi3Binary binaries[1];
    fmi3String strings[1];
    fmi3Clock clocks[1];
    const fmi3ValueReference mixed[] = {LEFT_VELOCITY, BASE_X, TIME}, unknown = 1000000, last = UINT32_MAX;
    fmi3Instance c = running3();
    drive3(c, 0.0, 0.05, 2);

    /* A vector has as many values as elements; with scalars in any order. */
    CHECK_OK(fmu3.GetFloat64(c, &base, 1, values, 3));
    CHECK(values[0] > 0.0 && values[2] > 0.1, "%g %g", values[0], values[2]);
    CHECK_OK(fmu3.GetFloat64(c, mixed, 3, values + 3, 5));
    CHECK(values[4] == values[0] && values[6] == values[2], "%g %g", values[4], values[6]);
    CHECK(values[7] == 0.1, "time is %.17g", values[7]);
    CHECK_OK(fmu3.GetInt32(c, &steps, 1, integers, 1));
    CHECK(integers[0] > 0, "%d", integers[0]);
    memset(booleans, 0x55, sizeof booleans);
    CHECK_OK(fmu3.GetBoolean(c, &active, 1, booleans, 1));
    CHECK(((unsigned char *)booleans)[0] == 1 && ((unsigned char *)booleans)[1] == 0x55, "one byte of 1");

    /* Wrong lengths; nothing is written. */
    values[0] = values[1] = -7.0;
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 1, values, 2), "2 values");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 1, values, 4), "have 3");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 1, values, 0), "0 values");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 0, values, 1), "1 values");
    CHECK_ERROR(fmu3.GetFloat64(c, mixed, 3, values, 3), "have 5");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 1, values, SIZE_MAX), "elements");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, SIZE_MAX, values, 3), "elements");
    CHECK_ERROR(fmu3.GetFloat64(c, &base, 1, NULL, 3), "NULL");
    CHECK_ERROR(fmu3.GetFloat64(c, NULL, 1, values, 3), "NULL");
    CHECK(values[0] == -7.0 && values[1] == -7.0, "%g %g", values[0], values[1]);
    CHECK_OK(fmu3.GetFloat64(c, NULL, 0, NULL, 0));
    CHECK_OK(fmu3.SetFloat64(c, NULL, 0, NULL, 0));
    CHECK_OK(fmu3.SetBoolean(c, NULL, 0, NULL, 0));

    /* Wrong references and types. */
    CHECK_ERROR(fmu3.GetFloat64(c, &z, 1, values, 1), "base.position");
    CHECK_ERROR(fmu3.GetFloat64(c, &unknown, 1, values, 1), "1000000");
    CHECK_ERROR(fmu3.GetFloat64(c, &last, 1, values, 1), "4294967295");
    CHECK_ERROR(fmu3.GetFloat64(c, &steps, 1, values, 1), "is Int32, not Float64");
    CHECK_ERROR(fmu3.GetInt32(c, &base, 1, integers, 1), "is Float64, not Int32");
    CHECK_ERROR(fmu3.GetBoolean(c, &steps, 1, booleans, 1), "not Boolean");
    CHECK_ERROR(fmu3.GetFloat32(c, &base, 1, floats, 1), "not Float32");
    CHECK_ERROR(fmu3.GetInt64(c, &steps, 1, longs, 1), "not Int64");
    CHECK_ERROR(fmu3.SetInt64(c, &steps, 1, longs, 1), "not Int64");
    CHECK_ERROR(fmu3.GetString(c, &steps, 1, strings, 1), "not String");
    CHECK_ERROR(fmu3.GetBinary(c, &steps, 1, sizes, binaries, 1), "not Binary");
    CHECK_ERROR(fmu3.GetClock(c, &active, 1, clocks), "not Clock");
    CHECK_ERROR(fmu3.SetClock(c, &active, 1, clocks), "not Clock");
    CHECK_ERROR(fmu3.GetUInt8(c, NULL, 3, NULL, 3), "NULL");

    /* What cannot be set. */
    values[0] = 0.5;
    CHECK_ERROR(fmu3.SetFloat64(c, &now, 1, values, 1), "time");
    CHECK_ERROR(fmu3.SetFloat64(c, &base, 1, values, 3), "base.position");
    CHECK_ERROR(fmu3.SetFloat64(c, &initial, 1, values, 3), "fixed");
    CHECK_ERROR(fmu3.SetInt32(c, &steps, 1, integers, 1), "solver.steps");
    values[0] = NAN;
    CHECK_ERROR(fmu3.SetFloat64(c, &velocity, 1, values, 1), "finite");
    values[0] = -3.0;
    CHECK_ERROR(fmu3.SetFloat64(c, &mass, 1, values, 1), "mass");
    CHECK(fmu3.Reset(c) == fmi3OK, "reset");

    /* A vector is set whole or not at all. */
    values[0] = 1.0, values[1] = INFINITY, values[2] = 2.0;
    CHECK_ERROR(fmu3.SetFloat64(c, &initial, 1, values, 3), "finite");
    CHECK_ERROR(fmu3.SetFloat64(c, &initial, 1, values, 2), "2 values");
    CHECK_OK(fmu3.GetFloat64(c, &initial, 1, values + 3, 3));
    CHECK(values[3] == 0.0, "%g", values[3]);
    values[1] = -1.0;
    CHECK_OK(fmu3.SetFloat64(c, &initial, 1, values, 3));
    CHECK_OK(fmu3.GetFloat64(c, &base, 1, values + 3, 3));
    CHECK(values[3] == 1.0 && values[4] == -1.0 && values[5] == 2.0, "%g %g %g", values[3], values[4], values[5]);
    fmu3.FreeInstance(c);
}

/* Rates of positions are velocities; an order for each reference. */
void test_v3_derivatives(void)
{
    const fmi3ValueReference vectors[] = {BASE_X, BASE_QW_VECTOR}, effort = LEFT_EFFORT, speed = BASE_VX;
    const int32_t orders[] = {1, 1}, second[] = {2, 2}, none[] = {0, 0};
    double rates[7], speeds[3];
    fmi3Instance c = running3();
    drive3(c, 0.0, 0.05, 4);
    CHECK_OK(fmu3.GetOutputDerivatives(c, vectors, 2, orders, rates, 7));
    CHECK_OK(fmu3.GetFloat64(c, &speed, 1, speeds, 3));
    for (int i = 0; i < 3; i++)
        CHECK(rates[i] == speeds[i], "%g %g", rates[i], speeds[i]);
    CHECK_ERROR(fmu3.GetOutputDerivatives(c, vectors, 2, orders, rates, 6), "6 values");
    CHECK_ERROR(fmu3.GetOutputDerivatives(c, vectors, 2, none, rates, 7), "order 0");
    CHECK_ERROR(fmu3.GetOutputDerivatives(c, vectors, 2, NULL, rates, 7), "NULL");
    CHECK_DISCARD(fmu3.GetOutputDerivatives(c, vectors, 2, second, rates, 7), "order 2");
    CHECK_DISCARD(fmu3.GetOutputDerivatives(c, &effort, 1, orders, rates, 1), "no derivative");
    CHECK_ERROR(fmu3.GetOutputDerivatives(c, &velocity, 1, orders, rates, 1), "no output");
    CHECK_ERROR(fmu3.GetOutputDerivatives(c, &now, 1, orders, rates, 1), "no output");
    fmu3.FreeInstance(c);
}
