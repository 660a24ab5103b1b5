/* What the host must not notice: memory, signals, the floating-point control word, threads, mapped libraries. */
#include "importer.h"
#include "robot.h"
#include "system.h"
#include <fenv.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#if defined __x86_64__
#include <xmmintrin.h>
#endif

/* How often instances are made and libraries loaded; wine is slow. */
#ifdef _WIN32
enum { CYCLES = 100, LOADS = 20 };
#else
enum { CYCLES = 10000, LOADS = 1000 };
#endif

static void cycle(void)
{
    fmi2FMUstate state = NULL;
    fmi2Component c = running();
    drive(c, 0.0, 0.02, 2);
    CHECK_OK(fmu.GetFMUstate(c, &state));
    CHECK_OK(fmu.SetFMUstate(c, state));
    CHECK_OK(fmu.FreeFMUstate(c, &state));
    fmu.FreeInstance(c);
}

/* Bytes of the heap that are in use. */
static size_t in_use(void)
{
#ifdef _WIN32
    /* Rust allocates on the process's heap. */
    PROCESS_HEAP_ENTRY entry = {0};
    size_t bytes = 0;
    while (HeapWalk(GetProcessHeap(), &entry))
        if (entry.wFlags & PROCESS_HEAP_ENTRY_BUSY)
            bytes += entry.cbData;
    return bytes;
#else
    return mallinfo2().uordblks;
#endif
}

void test_cycles(void)
{
    size_t before, after;
#ifndef _WIN32
    /* With the thread cache off (GLIBC_TUNABLES, set by the caller) and no fast bins, what is in use is exact. */
    mallopt(M_MXFAST, 0);
#endif
    for (int i = 0; i < 5; i++)
        cycle();
    before = in_use();
    for (int i = 0; i < CYCLES; i++)
        cycle();
    after = in_use();
    CHECK(after == before && before > 0, "%zu bytes before, %zu after %d cycles", before, after, CYCLES);
}

/* Loads, runs and unloads: the library must really leave. */
void test_unload(const char *path)
{
    size_t before = 0, after = 0;
    for (int i = 0; i < LOADS; i++) {
        fmi2Component c = running();
        fmu.FreeInstance(c);
        CHECK(library_close(fmu.library) == 0, "%s", library_problem());
        CHECK(!library_is_loaded(path), "still mapped after it was closed");
        after = in_use();
        if (i == LOADS / 10)
            before = after;
        load(path);
    }
#ifndef _WIN32
    CHECK(after == before, "%zu bytes before, %zu after %d loads", before, after, LOADS);
#else
    (void)before;
    (void)after;
#endif
}

static unsigned long long run(void)
{
    unsigned long long hash;
    fmi2Component c = running();
    drive(c, 0.0, 0.05, 10);
    hash = hash_state(c);
    fmu.FreeInstance(c);
    return hash;
}

void test_control_word(void)
{
#if defined __x86_64__
    unsigned long long expected = run();
    /* Round down, flush to zero, denormals are zero, and no exception masked but the inexact one. */
    const unsigned int strange = 0x2000 | 0x8000 | 0x0040 | 0x1000;
    const unsigned int usual = _mm_getcsr();
    fmi2Component c = running();
    volatile unsigned int after;
    unsigned long long hash;
    for (int i = 0; i < 10; i++) {
        static const fmi2ValueReference commands[] = {LEFT_VELOCITY, RIGHT_VELOCITY};
        double t = i * 0.05, values[2] = {4.0 + t, 4.0 - 2.0 * t};
        fmi2Status set, stepped;
        _mm_setcsr(strange);
        set = fmu.SetReal(c, commands, 2, values);
        stepped = fmu.DoStep(c, t, 0.05, fmi2True);
        after = _mm_getcsr();
        _mm_setcsr(usual);
        CHECK(set == fmi2OK && stepped == fmi2OK, "step %d", i);
        CHECK(after == strange, "the host had %#x and has %#x", strange, after);
    }
    _mm_setcsr(strange);
    hash = hash_state(c);
    _mm_setcsr(usual);
    CHECK(hash == expected, "the result depends on the host's control word");
    fmu.FreeInstance(c);
#endif
}

#ifndef _WIN32
void test_signals(void)
{
    struct sigaction before[32], after[32];
    memset(before, 0, sizeof before);
    memset(after, 0, sizeof after);
    for (int s = 1; s < 32; s++)
        sigaction(s, NULL, &before[s]);
    run();
    for (int s = 1; s < 32; s++) {
        sigaction(s, NULL, &after[s]);
        CHECK(before[s].sa_handler == after[s].sa_handler, "signal %d", s);
    }
}
#endif

enum { THREADS = 8, INSTANCES = 8 };

/* The checks' log is shared, so the threads only calculate. */
static void *thread(void *result)
{
    static const fmi2ValueReference commands[] = {LEFT_VELOCITY, RIGHT_VELOCITY};
    fmi2CallbackFunctions silent = {NULL, NULL, NULL, NULL, NULL};
    fmi2Component c[INSTANCES];
    unsigned long long *hashes = result;
    for (int k = 0; k < INSTANCES; k++) {
        c[k] = fmu.Instantiate("robot", fmi2CoSimulation, guid, resources, &silent, 0, 0);
        fmu.SetupExperiment(c[k], fmi2False, 0.0, 0.0, fmi2False, 0.0);
        fmu.EnterInitializationMode(c[k]);
        fmu.ExitInitializationMode(c[k]);
    }
    for (int i = 0; i < 10; i++) {
        double t = i * 0.05, values[2] = {4.0 + t, 4.0 - 2.0 * t};
        for (int k = 0; k < INSTANCES; k++) {
            fmu.SetReal(c[k], commands, 2, values);
            fmu.DoStep(c[k], t, 0.05, fmi2True);
        }
    }
    for (int k = 0; k < INSTANCES; k++) {
        hashes[k] = hash_state(c[k]);
        fmu.FreeInstance(c[k]);
    }
    return NULL;
}

void test_threads(void)
{
    pthread_t threads[THREADS];
    unsigned long long hashes[THREADS][INSTANCES], expected = run();
    for (int t = 0; t < THREADS; t++)
        CHECK(pthread_create(&threads[t], NULL, thread, hashes[t]) == 0, "thread %d", t);
    for (int t = 0; t < THREADS; t++) {
        pthread_join(threads[t], NULL);
        for (int k = 0; k < INSTANCES; k++)
            CHECK(hashes[t][k] == expected, "instance %d of thread %d", k, t);
    }
}

/* A few steps of whatever robot this is, and all its Real variables. */
static unsigned long long steps_of_any(const Fmu *functions, fmi2Component c, int from, int count)
{
    unsigned long long hash = 14695981039346656037u;
    for (int i = from; i < from + count; i++)
        functions->DoStep(c, i * 0.01, 0.01, fmi2True);
    for (fmi2ValueReference reference = 0; reference < 400; reference++) {
        double value = 0.0;
        if (functions->GetReal(c, &reference, 1, &value) == fmi2OK)
            for (size_t k = 0; k < sizeof value; k++)
                hash = (hash ^ ((unsigned char *)&value)[k]) * 1099511628211u;
    }
    return hash;
}

static fmi2Component start_any(const Fmu *functions, const char *its_guid, const char *its_resources)
{
    fmi2CallbackFunctions silent = {NULL, NULL, NULL, NULL, NULL};
    fmi2Component c = functions->Instantiate("any", fmi2CoSimulation, its_guid, its_resources, &silent, 0, 0);
    CHECK(c != NULL, "%s", its_resources);
    functions->EnterInitializationMode(c);
    functions->ExitInitializationMode(c);
    return c;
}

/* Two robots, each with a library of its own, step by step in turn: the bits of each alone. */
void test_two(const char *library, const char *other_resources, const char *other_guid)
{
    const Fmu first = fmu;
    Fmu second;
    unsigned long long alone[2], both[2] = {0, 0};
    fmi2Component c[2];
    load(library);
    second = fmu;
    fmu = first;
    CHECK(second.library != first.library, "one library under two names");
    c[0] = start_any(&first, guid, resources);
    alone[0] = steps_of_any(&first, c[0], 0, 20);
    first.FreeInstance(c[0]);
    c[1] = start_any(&second, other_guid, other_resources);
    alone[1] = steps_of_any(&second, c[1], 0, 20);
    second.FreeInstance(c[1]);
    CHECK(alone[0] != alone[1], "two different robots");

    c[0] = start_any(&first, guid, resources);
    c[1] = start_any(&second, other_guid, other_resources);
    for (int i = 0; i < 20; i++) {
        both[0] = steps_of_any(&first, c[0], i, 1);
        both[1] = steps_of_any(&second, c[1], i, 1);
    }
    CHECK(both[0] == alone[0] && both[1] == alone[1], "they meet");
    /* One leaves, the other stays. */
    first.FreeInstance(c[0]);
    CHECK(second.DoStep(c[1], 0.2, 0.01, fmi2True) == fmi2OK, "the other goes on");
    second.FreeInstance(c[1]);
    library_close(second.library);
}

#ifndef _WIN32
/* What a worker of a host may have: half of what musl gives a thread. */
enum { SMALL_STACK = 64 * 1024 };

static void *life(void *result)
{
    fmi2FMUstate state = NULL;
    fmi2Component c = start_any(&fmu, guid, resources);
    *(unsigned long long *)result = steps_of_any(&fmu, c, 0, 20);
    CHECK(fmu.GetFMUstate(c, &state) == fmi2OK, "saved");
    CHECK(fmu.SetFMUstate(c, state) == fmi2OK, "restored");
    CHECK(fmu.FreeFMUstate(c, &state) == fmi2OK, "freed");
    fmu.FreeInstance(c);
    return NULL;
}

/* A whole life in a thread with little stack has the bits of one in the first thread. */
void test_stack(void)
{
    pthread_t thread;
    pthread_attr_t small;
    unsigned long long here = 0, there = 1;
    life(&here);
    CHECK(pthread_attr_init(&small) == 0 && pthread_attr_setstacksize(&small, SMALL_STACK) == 0, "stack");
    CHECK(pthread_create(&thread, &small, life, &there) == 0, "thread");
    pthread_join(thread, NULL);
    pthread_attr_destroy(&small);
    CHECK(here == there, "other bits");
}
#endif
