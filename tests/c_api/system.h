/* What differs between systems: paths, arguments, and how a library is loaded, found again and let go. */
#ifndef SYSTEM_H
#define SYSTEM_H

#ifdef _WIN32
#define SEPARATOR "\\"
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#include <shellapi.h>
#include <stdlib.h>

static inline void *library_open(const char *path)
{
    return (void *)LoadLibraryA(path);
}

static inline void *library_find(void *library, const char *name)
{
    return (void *)GetProcAddress((HMODULE)library, name);
}

/* 0 if it could be closed. */
static inline int library_close(void *library)
{
    return FreeLibrary((HMODULE)library) ? 0 : -1;
}

static inline int library_is_loaded(const char *path)
{
    return GetModuleHandleA(path) != NULL;
}

/* Windows hands arguments over in an old alphabet of the machine; FMI wants UTF-8. */
static inline char **utf8_arguments(char **arguments)
{
    int count;
    LPWSTR *wide = CommandLineToArgvW(GetCommandLineW(), &count);
    for (int i = 0; i < count; i++) {
        int size = WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, NULL, 0, NULL, NULL);
        arguments[i] = malloc(size);
        WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, arguments[i], size, NULL, NULL);
    }
    LocalFree(wide);
    return arguments;
}

static inline const char *library_problem(void)
{
    static char text[32];
    wsprintfA(text, "error %lu", GetLastError());
    return text;
}
#else
#define SEPARATOR "/"
#include <dlfcn.h>
#include <stddef.h>

static inline void *library_open(const char *path)
{
    return dlopen(path, RTLD_NOW | RTLD_LOCAL);
}

static inline void *library_find(void *library, const char *name)
{
    return dlsym(library, name);
}

/* 0 if it could be closed. */
static inline int library_close(void *library)
{
    return dlclose(library);
}

static inline int library_is_loaded(const char *path)
{
    void *found = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
    if (found)
        dlclose(found);
    return found != NULL;
}

static inline char **utf8_arguments(char **arguments)
{
    return arguments;
}

static inline const char *library_problem(void)
{
    return dlerror();
}
#endif

#endif
