/* A small importer: loads a library, records what is logged, counts failed checks. */
#ifndef IMPORTER_H
#define IMPORTER_H

#include "fmi2.h"
#include <stdio.h>

/* All functions of a library, under their names without "fmi2". */
typedef struct {
    void *library;
#define MEMBER(result, name, arguments) result(*name) arguments;
    FMI2_FUNCTIONS(MEMBER)
#undef MEMBER
} Fmu;

/* What the logger last heard, formatted as an importer formats it. */
typedef struct {
    int messages;
    fmi2Status status;
    char instance[256];
    char category[64];
    char text[2048];
    /* Called from inside the logger, if not null. */
    void (*reenter)(void);
} Log;

extern Fmu fmu;
extern Log heard;
extern int failures;
extern const char *guid;
extern const char *resources;

/* Counts and prints a failed check, and goes on. */
#define CHECK(condition, ...)                                              \
    do {                                                                   \
        if (!(condition)) {                                                \
            failures++;                                                    \
            printf("%s:%d: %s: ", __FILE__, __LINE__, #condition);         \
            printf(__VA_ARGS__);                                           \
            printf(" (last message: [%s] %s)\n", heard.category, heard.text); \
        }                                                                  \
    } while (0)

/* An error with a message that contains `words`. */
#define CHECK_ERROR(call, words)                                                       \
    do {                                                                               \
        forget();                                                                      \
        CHECK((call) == fmi2Error, "expected fmi2Error");                              \
        CHECK(heard.messages == 1 && heard.status == fmi2Error, "expected one error"); \
        CHECK(strcmp(heard.category, "logStatusError") == 0, "wrong category");        \
        CHECK(strstr(heard.text, words) != NULL, "expected '%s'", words);              \
    } while (0)

/* fmi2Discard with a message that contains `words`. */
#define CHECK_DISCARD(call, words)                                                         \
    do {                                                                                   \
        forget();                                                                          \
        CHECK((call) == fmi2Discard, "expected fmi2Discard");                              \
        CHECK(heard.messages == 1 && heard.status == fmi2Discard, "expected one message"); \
        CHECK(strcmp(heard.category, "logStatusDiscard") == 0, "wrong category");          \
        CHECK(strstr(heard.text, words) != NULL, "expected '%s'", words);                  \
    } while (0)

/* fmi2OK and not a word. */
#define CHECK_OK(call)                                      \
    do {                                                    \
        forget();                                           \
        CHECK((call) == fmi2OK, "expected fmi2OK");         \
        CHECK(heard.messages == 0, "expected no message");  \
    } while (0)

void load(const char *path);
void forget(void);
extern const fmi2CallbackFunctions callbacks;

/* With `resources`, `guid` and the recording logger. */
fmi2Component instantiate(void);
fmi2Component instantiate_as(fmi2Type type);
/* For Model Exchange, in continuous-time mode at 0 s; `x` gets its states, if it is not null. */
fmi2Component exchanging(double *x);
/* Initialised at 0 s. */
fmi2Component running(void);

/* Bits of all variables named in robot.h, as 16 hexadecimal digits each. */
void print_state(FILE *file, fmi2Component c);
/* The same as one number. */
unsigned long long hash_state(fmi2Component c);

/* n steps of h from `from`, commands that change with time. */
void drive(fmi2Component c, double from, double h, int n);

#endif
