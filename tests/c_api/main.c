/* importer LIBRARY RESOURCES GUID TEST [ARGUMENT…]: runs one test; exit code 0 if every check holds. */
#include "importer.h"
#include "v3/importer3.h"
#include "system.h"
#include <stdlib.h>
#include <string.h>

void test_phases(void);
void test_discard(void);
void test_null(void);
void test_values(void);
void test_times(void);
void test_jitter(void);
void test_instantiate(void);
void test_locations(int count, char **locations);
void test_broken(int count, char **locations);
void test_logging(void);
void test_states(void);
void test_damage(void);
void test_save(const char *path);
void test_resume(const char *path);
void test_foreign(const char *path);
void test_input_derivatives(void);
void test_output_derivatives(void);
void test_initialization(void);
void test_parameters(void);
void test_million(void);
void test_partitions(void);
void test_two(const char *library, const char *other_resources, const char *other_guid);
void test_reset(void);
void test_cycles(void);
void test_unload(const char *path);
void test_control_word(void);
void test_signals(void);
void test_threads(void);
void test_stack(void);
void test_exchange_phases(void);
void test_exchange(void);
void test_v3_exchange_phases(void);
void test_v3_exchange(void);
void test_v3_phases(void);
void test_v3_values(void);
void test_v3_derivatives(void);
void test_v3_states(void);
void test_v3_bits(void);
void test_v3_discard(void);
void test_v3_updates(void);
void test_v3_instantiate(void);
void test_v3_logging(void);

static const struct {
    const char *name;
    void (*run)(void);
} tests[] = {
    {"phases", test_phases},
    {"discard", test_discard},
    {"null", test_null},
    {"values", test_values},
    {"times", test_times},
    {"jitter", test_jitter},
    {"instantiate", test_instantiate},
    {"logging", test_logging},
    {"states", test_states},
    {"damage", test_damage},
    {"input_derivatives", test_input_derivatives},
    {"output_derivatives", test_output_derivatives},
    {"initialization", test_initialization},
    {"parameters", test_parameters},
#ifndef WITHOUT_LONG
    {"million", test_million},
    {"partitions", test_partitions},
#endif
    {"reset", test_reset},
    {"cycles", test_cycles},
    {"control_word", test_control_word},
#ifndef _WIN32
    {"signals", test_signals},
    {"stack", test_stack},
#endif
    {"threads", test_threads},
    {"exchange_phases", test_exchange_phases},
    {"exchange", test_exchange},
    {"v3_exchange_phases", test_v3_exchange_phases},
    {"v3_exchange", test_v3_exchange},
    {"v3_phases", test_v3_phases},
    {"v3_values", test_v3_values},
    {"v3_derivatives", test_v3_derivatives},
    {"v3_states", test_v3_states},
    {"v3_bits", test_v3_bits},
    {"v3_discard", test_v3_discard},
    {"v3_updates", test_v3_updates},
    {"v3_instantiate", test_v3_instantiate},
    {"v3_logging", test_v3_logging},
};

int main(int argc, char **argv)
{
    int known = 0;
    if (argc < 5)
        return 2;
    argv = utf8_arguments(argv);
    resources = argv[2];
    guid = argv[3];
    load(argv[1]);
    load3();
    CHECK(strcmp(fmu.GetTypesPlatform(), "default") == 0, "platform");
    CHECK(strcmp(fmu.GetVersion(), "2.0") == 0, "version");
    CHECK(strcmp(fmu3.GetVersion(), "3.0") == 0, "version");
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
        if (strcmp(argv[4], tests[i].name) == 0) {
            tests[i].run();
            known = 1;
        }
    }
    if (strcmp(argv[4], "locations") == 0)
        test_locations(argc - 5, argv + 5);
    else if (strcmp(argv[4], "broken") == 0)
        test_broken(argc - 5, argv + 5);
    else if (strcmp(argv[4], "save") == 0)
        test_save(argv[5]);
    else if (strcmp(argv[4], "resume") == 0)
        test_resume(argv[5]);
    else if (strcmp(argv[4], "foreign") == 0)
        test_foreign(argv[5]);
    else if (strcmp(argv[4], "two") == 0)
        test_two(argv[5], argv[6], argv[7]);
    else if (strcmp(argv[4], "unload") == 0)
        test_unload(argv[1]);
    else if (!known)
        return 2;
    return failures ? 1 : 0;
}
