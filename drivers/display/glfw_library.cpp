#include "drivers/display/glfw_library.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace fantascope::drivers {

std::string whyGlfwFailed() {
    const char* why = nullptr;
    glfwGetError(&why);
    return why != nullptr ? why : "unknown reason";
}

Result<std::shared_ptr<GlfwLibrary>> GlfwLibrary::shared() {
    static std::weak_ptr<GlfwLibrary> open;
    if (auto library = open.lock()) return library;
    if (!glfwInit()) return Error(fmt::format("{}; set DISPLAY, or start an X server", whyGlfwFailed()));
    std::shared_ptr<GlfwLibrary> library(new GlfwLibrary);
    open = library;
    return library;
}

GlfwLibrary::~GlfwLibrary() { glfwTerminate(); }

}  // namespace fantascope::drivers
