#include "system_calls.h"

#include <dlfcn.h>
#include <sys/resource.h>

#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace {

thread_local std::int64_t opened = 0, compiled = 0;

constexpr int kExecutable = 4;         // PROT_EXEC
constexpr int kCreates = 0100;         // O_CREAT
constexpr int kTemporary = 020000000;  // __O_TMPFILE

// What the C library, or a sanitizer before it, has under this name.
template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

// These stand before the C library's for the whole test program and all its shared libraries;
// <fcntl.h> would declare them otherwise.
extern "C" {

#define FANTASCOPE_OPENS(name)                                            \
    int name(const char* path, int flags, ...) {                          \
        unsigned mode = 0;                                                \
        if ((flags & (kCreates | kTemporary)) != 0) {                     \
            va_list more;                                                 \
            va_start(more, flags);                                        \
            mode = va_arg(more, unsigned);                                \
            va_end(more);                                                 \
        }                                                                 \
        ++opened;                                                         \
        static const auto real = next<int(const char*, int, ...)>(#name); \
        return real(path, flags, mode);                                   \
    }
#define FANTASCOPE_OPENS_AT(name)                                              \
    int name(int folder, const char* path, int flags, ...) {                   \
        unsigned mode = 0;                                                     \
        if ((flags & (kCreates | kTemporary)) != 0) {                          \
            va_list more;                                                      \
            va_start(more, flags);                                             \
            mode = va_arg(more, unsigned);                                     \
            va_end(more);                                                      \
        }                                                                      \
        ++opened;                                                              \
        static const auto real = next<int(int, const char*, int, ...)>(#name); \
        return real(folder, path, flags, mode);                                \
    }
#define FANTASCOPE_OPENS_STREAM(name)                                          \
    FILE* name(const char* path, const char* mode) {                           \
        ++opened;                                                              \
        static const auto real = next<FILE*(const char*, const char*)>(#name); \
        return real(path, mode);                                               \
    }
FANTASCOPE_OPENS(open)
FANTASCOPE_OPENS(open64)
FANTASCOPE_OPENS_AT(openat)
FANTASCOPE_OPENS_AT(openat64)
FANTASCOPE_OPENS_STREAM(fopen)
FANTASCOPE_OPENS_STREAM(fopen64)

int mprotect(void* address, std::size_t length, int protection) {
    if ((protection & kExecutable) != 0) ++compiled;
    static const auto real = next<int(void*, std::size_t, int)>("mprotect");
    return real(address, length, protection);
}

}  // extern "C"

std::int64_t fantascope::filesOpenedSoFar() { return opened; }
std::int64_t fantascope::compilationsSoFar() { return compiled; }
std::int64_t fantascope::waitsSoFar() {
    rusage usage{};
    ::getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nvcsw;
}
