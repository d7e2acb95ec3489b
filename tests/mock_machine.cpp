#include "mock_machine.h"

#include "core/check.h"

#include <dlfcn.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>

namespace fantascope {

MockMachine::MockMachine() : testbed_(umockdev_testbed_new()) {}

MockMachine::~MockMachine() { g_object_unref(testbed_); }

std::filesystem::path MockMachine::root() const {
    gchar* const folder = umockdev_testbed_get_root_dir(testbed_);
    std::filesystem::path root(folder);
    g_free(folder);
    return root;
}

bool underUmockdev(char** arguments) {
    constexpr const char* kLibrary = "libumockdev-preload.so.0";
    const char* const before = std::getenv("LD_PRELOAD");
    if (before != nullptr && std::string_view(before).find(kLibrary) != std::string_view::npos)
        return dlopen(kLibrary, RTLD_LAZY | RTLD_NOLOAD) != nullptr;
    setenv("LD_PRELOAD", (kLibrary + std::string(before != nullptr ? ":" : "") + (before != nullptr ? before : "")).c_str(), 1);
    // The sanitizers want to be first; their library is linked, and all is well as long as nothing
    // that is preloaded is built with one.
    const char* const options = std::getenv("ASAN_OPTIONS");
    setenv("ASAN_OPTIONS", (std::string(options != nullptr ? options : "") + ":verify_asan_link_order=0").c_str(), 1);
    execv("/proc/self/exe", arguments);
    FANTASCOPE_CHECK(false, "the program cannot start itself again");
    return false;
}

}  // namespace fantascope
