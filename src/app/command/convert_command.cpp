#include "app/base/output.h"
#include "app/command/commands.h"
#include "app/export/motion_scene.h"

#include "core/file.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path cast, output;
    std::optional<double> frameRate;
    std::optional<std::size_t> actor;
};

void declare(Command& command, Options& options) {
    command.add("CAST", options.cast, "A cast's poses or motion, *.cast.yaml").required();
    addOutOption(
        command, options.output,
        "What to write: .glb or .gltf (all actors with their skins, props, light and screen) or .bvh (one actor's skeleton "
        "and motion)")
        .required()
        .check({[](const std::string& file) {
                    const std::string ending = fs::path(file).extension().string();
                    return ending == ".glb" || ending == ".gltf" || ending == ".bvh"
                               ? ""
                               : fmt::format("'{}' does not end in .glb, .gltf or .bvh", file);
                },
                "GLB|GLTF|BVH"});
    command.add("--fps", options.frameRate, "Frames per second, with interpolated poses (default: the cast's)")
        .range(1.0, 1000.0);
    command.add("--actor", options.actor, "For a .bvh: the actor, counted from 1 (default: all, each in a file of its own)");
    command.footer("docs/converting.md says how other programs read the files.");
}

// The actors to write, each with his file.
Result<std::vector<std::pair<std::size_t, fs::path>>> filesOf(const Options& options, std::size_t actors) {
    std::vector<std::pair<std::size_t, fs::path>> files;
    if (options.actor) {
        if (*options.actor < 1 || *options.actor > actors)
            return Error(fmt::format("--actor {}: the cast has actors 1 .. {}", *options.actor, actors));
        files.emplace_back(*options.actor - 1, options.output);
    } else if (actors == 1) {
        files.emplace_back(0, options.output);
    } else {
        for (std::size_t i = 0; i < actors; ++i)
            files.emplace_back(
                i, options.output.parent_path() / fmt::format("{}-actor-{}.bvh", options.output.stem().string(), i + 1));
    }
    return files;
}

std::string lengthOf(const MotionScene& scene) {
    if (scene.framesPerSecond == 0) return "a still";
    return fmt::format("{} frames at {:g} per second", scene.frames(), scene.framesPerSecond);
}

Result<void> run(const Options& options) {
    TRY(checkWritable(options.output));
    const std::string ending = options.output.extension().string();
    if (options.actor && ending != ".bvh") return Error("--actor is for a .bvh, which holds one actor; a glTF holds all");
    const MotionScene scene = TRY(readMotionScene(options.cast, options.frameRate));
    if (ending != ".bvh") {
        TRY(writeFile(options.output, gltfOf(scene, ending == ".glb")));
        fmt::print("{}: {} actor{}, {}\n", options.output.string(), scene.actors.size(), scene.actors.size() == 1 ? "" : "s",
                   lengthOf(scene));
        return {};
    }
    for (const auto& [actor, file] : TRY(filesOf(options, scene.actors.size()))) {
        TRY(writeFile(file, bvhOf(scene, actor)));
        fmt::print("{}: actor {}, {}\n", file.string(), actor + 1, lengthOf(scene));
    }
    return {};
}

}  // namespace

void addConvertCommand(Program& program) {
    addCommand<Options>(program, "convert", "Write a cast's poses or motion for other programs: glTF or BVH", declare, run);
}

}  // namespace fantascope::app
