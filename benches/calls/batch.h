/* Batches of calls and their times. */
#ifndef BATCH_H
#define BATCH_H

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { BATCHES = 20 };

/* Nanoseconds a call, of each batch. */
static double batch[BATCHES];

/* ns */
static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return t.tv_sec * 1e9 + t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Writes `name best median`. */
static void tell(const char *name)
{
    qsort(batch, BATCHES, sizeof *batch, ascending);
    printf("%s %.1f %.1f\n", name, batch[0], batch[BATCHES / 2]);
    fflush(stdout);
}

#endif
