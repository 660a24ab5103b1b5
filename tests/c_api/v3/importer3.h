/* The importer's FMI 3.0 side: the functions of the same library, and the same log. */
#ifndef IMPORTER3_H
#define IMPORTER3_H

#include "../importer.h"
#include "fmi3.h"

/* All functions of a library, under their names without "fmi3". */
typedef struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI3_FUNCTIONS(MEMBER)
#undef MEMBER
} Fmu3;

extern Fmu3 fmu3;

/* Finds the functions in fmu.library. */
void load3(void);
/* The recording logger. */
void logger3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message);

fmi3Instance instantiate3(void);
/* For Model Exchange. */
fmi3Instance exchange3(void);
/* The same in continuous-time mode at 0 s; `x` gets its states, if it is not null. */
fmi3Instance exchanging3(double *x);
/* Initialised at 0 s. */
fmi3Instance running3(void);
/* Of all Float64 variables: the same number as hash_state gives of FMI 2's. */
unsigned long long hash_state3(fmi3Instance c);
/* As drive of FMI 2. */
void drive3(fmi3Instance c, double from, double h, int n);
/* A step to be done whole. */
fmi3Status step3(fmi3Instance c, double t, double h);

#endif
