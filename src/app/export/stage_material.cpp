#include "app/export/stage_material.h"

#include "app/base/output.h"

#include "core/file.h"

#include <fmt/format.h>

#include <vector>

namespace fantascope::app {

namespace fs = std::filesystem;

Result<fs::path> placeStage(const fs::path& source, const theatre::Stage& stage, const fs::path& output) {
    const fs::path folder = fs::absolute(output).parent_path();
    const Material material = materialFor(output, fs::absolute(source), "stage");
    const fs::path own = folder / material.name;
    if (!material.copied) return own;
    std::vector<fs::path> files{fs::absolute(source)};
    for (const theatre::Prop& prop : stage.props) files.push_back(fs::absolute(prop.file));
    for (const fs::path& file : files) {
        const std::string name = TRY(relativeTo(files.front(), file));
        TRY(copyTo(own, {file, name, true}));
    }
    return own / source.filename();
}

Result<void> checkStageCanGo(const fs::path& source, const theatre::Stage& stage, const fs::path& output) {
    if (!materialFor(output, fs::absolute(source), "stage").copied) return {};
    for (const theatre::Prop& prop : stage.props)
        if (endingOf(prop.file) == ".gltf")
            return Error(
                fmt::format("{}: prop '{}' is a .gltf, which refers to other files that would not be found beside the cast; "
                            "export it as .glb, or write the cast into the stage file's folder",
                            source.string(), prop.name));
    return {};
}

}  // namespace fantascope::app
