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
    for (int i = 0; i < 100; i++)
        cycle();
    after = in_use();
    CHECK(after == before && before > 0, "%zu bytes before, %zu after 100 cycles", before, after);
}

/* Loads, runs and unloads: the library must really leave. */
void test_unload(const char *path)
{
    for (int i = 0; i < 20; i++) {
        cycle();
        CHECK(library_close(fmu.library) == 0, "%s", library_problem());
        CHECK(!library_is_loaded(path), "still mapped after it was closed");
        load(path);
    }
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

enum { THREADS = 4, INSTANCES = 4 };

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
