/* Names that a host may use for functions of its own. Linked into the importer and exported, they must not be what the
   FMU's library calls. */
#include <stdio.h>
#include <stdlib.h>

static _Noreturn void taken(const char *name)
{
    printf("the library called the host's %s\n", name);
    exit(3);
}

#define OURS(name) \
    void name(void); \
    void name(void) { taken(#name); }
OURS(fmi2GetReal)
OURS(fmi2SetReal)
OURS(fmi2DoStep)
OURS(fmi2Instantiate)
OURS(fmi2FreeInstance)
OURS(fmi2GetFMUstate)
OURS(fmi2SetFMUstate)
OURS(rust_eh_personality)
OURS(rust_begin_unwind)
OURS(rust_panic)
OURS(__rust_alloc)
OURS(__rust_dealloc)
OURS(__rust_realloc)
OURS(__rg_alloc)
OURS(__rdl_alloc)
OURS(__rdl_dealloc)
OURS(__rdl_realloc)
OURS(call)
OURS(load)
OURS(log)
OURS(exp)
OURS(sin)
OURS(cos)
OURS(atan2)
OURS(pow)
OURS(fma)
