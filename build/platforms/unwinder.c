/* What keeps the Linux library from needing libpthread.so and libdl.so.

   Rust turns a panic into an error code by unwinding the stack. The unwinder that is linked in (LLVM's libunwind, from
   zig) calls five functions which old glibc keeps outside of libc.so. They are defined here instead, for this library
   alone: nothing of this file is exported.

   Only a panic ever comes here, and a panic is a bug of the simulator. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>

/* The unwinder's one lock. Its initial bytes are all zero, as those of a mutex are; glibc 2.17 has mutexes in libc.so,
   which do nothing as long as the process has no threads. Readers then wait for each other, which they may. */
_Static_assert(sizeof(pthread_mutex_t) <= sizeof(pthread_rwlock_t), "a mutex fits into the lock's place");
_Static_assert(_Alignof(pthread_mutex_t) <= _Alignof(pthread_rwlock_t), "a mutex fits into the lock's place");

int pthread_rwlock_rdlock(pthread_rwlock_t *lock)
{
    return pthread_mutex_lock((pthread_mutex_t *)lock);
}

int pthread_rwlock_wrlock(pthread_rwlock_t *lock)
{
    return pthread_mutex_lock((pthread_mutex_t *)lock);
}

int pthread_rwlock_unlock(pthread_rwlock_t *lock)
{
    return pthread_mutex_unlock((pthread_mutex_t *)lock);
}

/* The unwinder looks for _dl_find_object (glibc 2.35) by its name, and without it asks dl_iterate_phdr, which every
   glibc has. */
void *dlsym(void *restrict library, const char *restrict name)
{
    (void)library;
    (void)name;
    return NULL;
}

/* Names of functions, for traces that nobody asks for. */
int dladdr(const void *address, Dl_info *info)
{
    (void)address;
    (void)info;
    return 0;
}
