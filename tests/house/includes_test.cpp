// Checks the table of docs/design.md that says which folder may include what. It reads every
// include under src and drivers and refuses whatever no line of these tables allows, so a new
// library or neighbour needs a line here, which somebody reviews.

#include "house/repository.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <string_view>

namespace fantascope::house {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using Names = std::vector<std::string_view>;

// Outside libraries by their headers: a folder, or a whole name.
const std::map<std::string_view, Names> kLibraries = {
    {"date", {"date/"}},
    {"fmt", {"fmt/"}},
    {"GLM", {"glm/"}},
    {"Eigen", {"Eigen/"}},
    {"OpenCV", {"opencv2/"}},
    {"yaml-cpp", {"yaml-cpp/"}},
    {"libyaml", {"yaml.h"}},
    {"spdlog", {"spdlog/"}},
    {"assimp", {"assimp/"}},
    {"CGAL", {"CGAL/"}},
    {"FreeType", {"ft2build.h", "freetype/"}},
    {"librsvg", {"librsvg/"}},
    {"FFTW", {"fftw3.h"}},
    {"cairo", {"cairo.h", "cairo-pdf.h", "cairo-svg.h"}},
    {"OpenGL", {"epoxy/gl.h"}},
    {"EGL", {"epoxy/egl.h"}},
    {"GLFW", {"GLFW/"}},
    {"Xlib", {"X11/"}},
    {"XCB", {"xcb/"}},
    {"libav", {"libavcodec/", "libavformat/", "libavutil/", "libswscale/"}},
    {"libusb", {"libusb.h"}},
    {"libmodbus", {"modbus.h"}},
    {"V4L2", {"linux/videodev2.h", "linux/dma-buf.h"}},
    {"CLI11", {"CLI/"}},
    {"Boost", {"boost/"}},
    {"nlohmann-json", {"nlohmann/"}},
    {"POSIX",
     {"sys/", "arpa/", "asm/termbits.h", "net/", "netinet/", "fcntl.h", "grp.h", "ifaddrs.h", "linux/serial.h", "locale.h",
      "poll.h", "sched.h", "signal.h", "spawn.h", "termios.h", "unistd.h", "wchar.h"}},
};
const Names kEverywhere = {"fmt", "GLM"};  // besides the standard library

struct Row {
    std::string_view folder;  // or the beginning of a file's name; the longest row that matches a file is its row
    Names ours;               // what it may include of ours besides its own folder
    Names others;             // libraries
    Names othersInCpp;        // libraries that no header may show
};

// A driver may use its own family and the simulated site's state; its vendor's library stays in its
// .cpp.
const Names kOfDrivers = {"core", "media", "device", "drivers/common", "drivers/site/world.h", "drivers/site/plug.h"};
// A protocol on a serial line has the line from next door.
const Names kOnALine = {
    "core", "media", "device", "drivers/common", "drivers/byte_stream", "drivers/site/world.h", "drivers/site/plug.h"};

const std::vector<Row> kTable = {
    {"core", {}, {}, {"Eigen", "POSIX"}},
    {"core/config", {"core"}, {}, {"yaml-cpp"}},
    {"core/config/yaml_events", {"core"}, {}, {"yaml-cpp", "libyaml"}},
    {"core/log", {}, {}, {"spdlog", "POSIX"}},
    {"media", {"core"}, {}, {"assimp", "CGAL", "FreeType", "librsvg", "OpenCV"}},
    {"device", {"core", "media"}, {}, {}},
    {"vision", {"core", "media"}, {"Eigen"}, {"OpenCV"}},
    {"vision/compare", {"core", "media", "vision"}, {}, {"Eigen"}},
    {"vision/watch", {"core", "media", "vision"}, {}, {"Eigen", "OpenCV"}},

    {"pattern/shape", {"core", "media"}, {}, {}},
    {"pattern/motion", {"core", "pattern/shape"}, {}, {"FFTW"}},
    {"pattern/search", {"core", "media", "pattern/motion", "pattern/shape"}, {"Eigen"}, {}},

    {"theatre/mask", {"core", "media"}, {}, {}},
    {"theatre/body", {"core", "media", "theatre/mask"}, {"Eigen"}, {}},
    {"theatre/stage", {"core", "media", "theatre/body", "theatre/mask"}, {}, {}},
    {"theatre/energy", {"core", "media", "theatre/body", "theatre/mask", "theatre/stage"}, {}, {}},
    {"theatre/search", {"core", "media", "theatre/body", "theatre/energy", "theatre/mask", "theatre/stage"}, {"Eigen"}, {}},
    {"theatre/deform", {"core", "media", "theatre/energy"}, {"Eigen"}, {}},
    {"theatre/print", {"core", "media", "theatre/body", "theatre/energy", "theatre/mask", "theatre/stage"}, {}, {}},
    {"theatre/motion",
     {"core", "media", "theatre/body", "theatre/deform", "theatre/energy", "theatre/mask", "theatre/search", "theatre/stage"},
     {"Eigen"},
     {}},

    {"plot", {"core", "media", "pattern", "theatre"}, {}, {"cairo"}},
    {"show/schedule", {"core"}, {}, {"date"}},
    {"show/site", {"core", "media", "show/schedule"}, {}, {}},
    {"show/course", {"core"}, {}, {}},
    {"show", {"core", "media", "show/course", "show/schedule", "show/site"}, {}, {}},
    {"show/play", {"core", "media", "show"}, {}, {}},
    {"render/canvas", {"core", "media"}, {}, {}},
    {"render/source",
     {"core", "media", "show/show_state.h", "show/source_id.h", "show/source_kinds.h", "pattern/motion", "pattern/shape",
      "theatre/stage"},
     {},
     {"libav"}},
    {"render/gpu", {"core", "media", "render/canvas"}, {}, {"OpenGL"}},
    {"render/gpu/paint",
     {"core", "media", "theatre/stage", "show/show_state.h", "show/source_id.h", "show/source_kinds.h", "render/canvas",
      "render/gpu"},
     {},
     {"OpenGL"}},
    {"render",
     {"core", "media", "device/display_sink.h", "show/show_state.h", "show/source_id.h", "show/source_kinds.h", "theatre/body",
      "theatre/motion", "render/canvas", "render/source", "render/gpu"},
     {},
     {}},

    {"web", {"core"}, {}, {}},
    {"web/server", {"core"}, {}, {"Boost"}},

    {"app/base", {"core", "media", "theatre/energy"}, {"nlohmann-json"}, {"libav", "OpenCV", "POSIX"}},
    {"app/base/command_line", {"core"}, {}, {"CLI11"}},
    {"app/site", {"app/base", "core", "device", "drivers", "media", "render/canvas", "show", "vision"}, {}, {"POSIX"}},
    {"app/keys", {"app/base", "core", "media", "device", "show"}, {}, {}},
    {"app/watch", {"core", "device", "media", "pattern", "render", "show", "vision"}, {}, {}},
    {"app/journal", {"core", "drivers/common", "show"}, {}, {"POSIX"}},
    {"app/check", {"core", "media", "pattern/shape", "show"}, {}, {}},
    {"app/schedule", {"app/base", "core", "show"}, {}, {}},
    {"app/console", {"app/base", "app/keys/lateness.h", "core", "show", "web"}, {}, {}},
    {"app/schema", {"app/base", "app/site", "core", "show"}, {}, {}},
    {"app/reload", {"core", "media", "pattern", "render", "show"}, {}, {}},
    {"app/parts", {"app/base", "app/site", "core", "device", "drivers/common", "show"}, {}, {"POSIX"}},
    {"app/live",
     {"app/base",       "app/console",    "app/journal",   "app/keys", "app/parts", "app/reload",
      "app/schedule",   "app/site",       "app/watch",     "core",     "device",    "drivers/common",
      "drivers/site",   "media",          "pattern/shape", "plot",     "render",    "show",
      "theatre/energy", "theatre/motion", "theatre/stage", "vision",   "web"},
     {},
     {"POSIX"}},
    {"app/calibrate",
     {"app/base", "app/live", "app/parts", "app/site", "core", "device", "media", "plot", "render", "show", "vision"},
     {},
     {}},
    {"app/lens", {"app/base", "app/site", "core", "device", "drivers", "media", "plot", "show", "vision"}, {}, {"POSIX"}},
    {"app/export",
     {"app/base", "app/keys", "app/live", "app/parts", "app/site", "core", "device", "drivers", "media", "plot", "render",
      "theatre/body", "theatre/deform", "theatre/energy", "theatre/motion", "theatre/stage", "vision"},
     {},
     {"nlohmann-json", "OpenCV", "POSIX"}},
    {"app/command",
     {"app", "core", "device", "drivers", "media", "pattern", "plot", "render/source", "show", "theatre", "vision", "web"},
     {},
     {"POSIX"}},

    {"drivers/registry", {"core", "media", "device", "drivers"}, {}, {}},
    {"drivers/common", {"core", "media", "device"}, {}, {"POSIX"}},
    {"drivers/site", {"core", "media", "device", "vision/camera_model.h", "drivers/common"}, {}, {}},
    {"drivers/display", kOfDrivers, {}, {"OpenGL"}},
    {"drivers/display/headless", kOfDrivers, {}, {"OpenGL", "EGL"}},
    {"drivers/display/glfw", kOfDrivers, {}, {"OpenGL", "GLFW"}},
    {"drivers/display/glfw_library", kOfDrivers, {}, {"GLFW"}},
    {"drivers/display/monitor_watch", kOfDrivers, {}, {"POSIX"}},
    {"drivers/display/picture_window", kOfDrivers, {}, {"OpenGL", "GLFW"}},
    {"drivers/display/lost_x_connection", kOfDrivers, {}, {"Xlib"}},
    {"drivers/display/x_screen", kOfDrivers, {}, {"XCB"}},
    {"drivers/dmx", kOnALine, {}, {"POSIX"}},
    {"drivers/modbus", kOnALine, {}, {"libmodbus", "POSIX"}},
    {"drivers/cue_controller", kOfDrivers, {}, {"libusb", "POSIX"}},
    {"drivers/camera", kOfDrivers, {}, {"V4L2", "libav", "POSIX"}},
    {"drivers/byte_stream", kOfDrivers, {}, {"POSIX"}},
};

// "core/clock.h" lies in "core" and in "core/clock.h"; "core_extra/x.h" lies in neither.
bool liesIn(std::string_view path, std::string_view folder) {
    return path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/');
}

bool liesInAny(const Names& folders, std::string_view path) {
    return std::any_of(folders.begin(), folders.end(), [&](std::string_view folder) { return liesIn(path, folder); });
}

std::string_view folderOf(std::string_view path) { return path.substr(0, path.rfind('/')); }

// A file's path as in includes, without "src/".
std::string_view includeName(std::string_view file) { return file.starts_with("src/") ? file.substr(4) : file; }

const Row* rowOf(std::string_view name) {
    const Row* best = nullptr;
    for (const Row& row : kTable) {
        const std::string_view rest = name.starts_with(row.folder) ? name.substr(row.folder.size()) : "none";
        const bool fits = rest.starts_with('/') || rest.starts_with('.');
        if (fits && (best == nullptr || row.folder.size() > best->folder.size())) best = &row;
    }
    return best;
}

std::optional<std::string_view> libraryOf(const std::string& header) {
    if (header.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos) return "standard library";
    for (const auto& [library, names] : kLibraries)
        for (const std::string_view name : names)
            if (name.ends_with('/') ? header.starts_with(name) : header == name) return library;
    return std::nullopt;
}

// Why a file named so in includes may not include <header>, or "".
std::string whyNotOther(const Row& row, std::string_view name, const std::string& header) {
    const auto library = libraryOf(header);
    if (!library) return fmt::format("<{}> belongs to no library of the table", header);
    const auto holds = [&](const Names& libraries) {
        return std::find(libraries.begin(), libraries.end(), *library) != libraries.end();
    };
    if (*library == "standard library" || holds(kEverywhere) || holds(row.others)) return "";
    if (!holds(row.othersInCpp)) return fmt::format("{} may not use {}", row.folder, *library);
    if (!name.ends_with(".cpp")) return fmt::format("{} may use {} in a .cpp only", row.folder, *library);
    return "";
}

// The same for "header".
std::string whyNotOurs(const Row& row, std::string_view name, const std::string& header) {
    if (header.find('/') == std::string::npos) return fmt::format("\"{}\" must be named from its folder", header);
    if (folderOf(header) == folderOf(name) || liesInAny(row.ours, header)) return "";
    return fmt::format("{} may not include {}", row.folder, header);
}

// What the table forbids in one file, each with its place.
std::vector<std::string> forbiddenIncludes(const TextFile& file) {
    const std::string_view name = includeName(file.path);
    const Row* row = rowOf(name);
    if (row == nullptr) return {file.path + ": its folder has no row in the table"};
    std::vector<std::string> forbidden;
    for (std::size_t line = 0; line < file.lines.size(); ++line) {
        char quote = 0, header[256] = "";
        if (std::sscanf(file.lines[line].c_str(), " # include %c%255[^\">]", &quote, header) != 2) continue;
        const std::string why = quote == '<' ? whyNotOther(*row, name, header) : whyNotOurs(*row, name, header);
        if (!why.empty()) forbidden.push_back(fmt::format("{}: {}", place(file, line), why));
    }
    return forbidden;
}

bool isCode(const TextFile& file) {
    return (file.path.starts_with("src/") || file.path.starts_with("drivers/")) &&
           (file.path.ends_with(".h") || file.path.ends_with(".cpp"));
}

TEST(Includes, are_those_of_the_design) {
    std::vector<std::string> forbidden;
    std::size_t files = 0;
    for (const TextFile& file : repositoryFiles()) {
        if (!isCode(file)) continue;
        ++files;
        const auto here = forbiddenIncludes(file);
        forbidden.insert(forbidden.end(), here.begin(), here.end());
    }
    EXPECT_THAT(forbidden, IsEmpty());
    EXPECT_GT(files, 40u) << "the sources were not found";
}

// Tests of the reader itself.
std::vector<std::string> told(const std::string& path, const std::vector<std::string>& lines) {
    return forbiddenIncludes({path, lines});
}

TEST(IncludeReader, takes_what_the_table_allows) {
    EXPECT_THAT(told("src/show/play/playback.cpp", {"#include \"show/play/playback.h\"", "#include <fmt/format.h>",
                                                    "#include <vector>", "#include \"core/clock.h\""}),
                IsEmpty());
    EXPECT_THAT(told("src/render/gpu/paint/painter.cpp", {"#include <epoxy/gl.h>", "#include \"render/gpu/handles.h\""}),
                IsEmpty());
    EXPECT_THAT(told("drivers/display/glfw.cpp", {"#include <GLFW/glfw3.h>", "#include \"drivers/display/shared.h\""}),
                IsEmpty());
}

TEST(IncludeReader, names_the_line_and_the_neighbour) {
    EXPECT_THAT(told("src/show/play/playback.cpp", {"", "  #  include \"device/dmx_port.h\"  // for a moment"}),
                ElementsAre("src/show/play/playback.cpp:2: show/play may not include device/dmx_port.h"));
}

TEST(IncludeReader, keeps_our_folders_apart) {
    EXPECT_THAT(told("src/core/clock.h", {"#include \"show/site/site.h\""}), SizeIs(1));
    EXPECT_THAT(told("src/render/layer.cpp", {"#include \"show/site/site.h\""}), SizeIs(1))
        << "render may see the state and the sources of show, and no more";
    EXPECT_THAT(told("src/show/show.cpp", {"#include \"app/base/report.h\""}), SizeIs(1)) << "nothing includes app";
    EXPECT_THAT(told("drivers/dmx/artnet.cpp", {"#include \"drivers/modbus/tcp.h\""}), SizeIs(1))
        << "a driver knows its own family";
    EXPECT_THAT(told("drivers/dmx/artnet.cpp", {"#include \"drivers/site/simulated_site.h\""}), SizeIs(1))
        << "of the site only its state";
    EXPECT_THAT(told("drivers/camera/v4l2.cpp", {"#include \"vision/camera_model.h\""}), SizeIs(1))
        << "vision is for drivers/site";
    EXPECT_THAT(told("src/core_extra/x.cpp", {}), ElementsAre("src/core_extra/x.cpp: its folder has no row in the table"));
}

TEST(IncludeReader, keeps_libraries_where_they_belong) {
    EXPECT_THAT(told("src/media/image.h", {"#include <opencv2/core.hpp>"}),
                ElementsAre("src/media/image.h:1: media may use OpenCV in a .cpp only"));
    EXPECT_THAT(told("src/media/image.cpp", {"#include <opencv2/core.hpp>"}), IsEmpty());
    EXPECT_THAT(told("drivers/display/glfw.h", {"#include <GLFW/glfw3.h>"}), SizeIs(1)) << "a vendor's header stays in the .cpp";
    EXPECT_THAT(told("drivers/display/headless.cpp", {"#include <GLFW/glfw3.h>"}), SizeIs(1))
        << "each driver has its own library";
    EXPECT_THAT(told("src/render/layer.cpp", {"#include <epoxy/gl.h>"}), SizeIs(1)) << "OpenGL is for render/gpu";
    EXPECT_THAT(told("src/app/command/pattern_command.cpp", {"#include <CLI/CLI.hpp>"}), SizeIs(1))
        << "CLI11 is for app/base/command_line.cpp";
    EXPECT_THAT(told("src/app/live/run.cpp", {"#include <wx/app.h>"}),
                ElementsAre("src/app/live/run.cpp:1: <wx/app.h> belongs to no library of the table"));
    EXPECT_THAT(told("src/app/live/run.cpp", {"#include \"report.h\""}),
                ElementsAre("src/app/live/run.cpp:1: \"report.h\" must be named from its folder"));
}

}  // namespace
}  // namespace fantascope::house
