#include "app/export/cast_scene.h"

#include "theatre/deform/silhouette_sequence.h"

#include "core/config/naming.h"
#include "media/image.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr int kMaskRows = 512;  // of the target

// The frame, counted from 0, of a cast's principal poses.
std::size_t principalOf(const theatre::Cast::Sequence& sequence, std::size_t frames, std::size_t all) {
    const std::size_t own = (sequence.representative + all - sequence.first % all) % all;
    return own < frames ? own : 0;
}

Result<theatre::PoseTarget> targetOf(const theatre::Cast& cast, std::optional<std::size_t>& frame, const fs::path& file) {
    if (!cast.sequence) {
        frame = frame.value_or(0);
        const auto& [target, height, middle] = cast.targets[0];
        const auto silhouette = readGrey(target);
        if (!silhouette) return namedIn(file, target, silhouette.error());
        return theatre::PoseTarget::from(*silhouette, cast.stage, height, kMaskRows).in(target.string());
    }
    const auto& [name, representative, first] = *cast.sequence;
    const auto read = theatre::readSequence(name);
    if (!read) return namedIn(file, name, read.error());
    const theatre::SilhouetteSequence& sequence = *read;
    if (representative >= sequence.pictures.size())
        return Error(fmt::format("{}: has no frame {}, for which the poses of {} were found", name.string(), representative + 1,
                                 file.string()));
    if (!frame) frame = principalOf(*cast.sequence, cast.actors[0].poses.size(), sequence.pictures.size());
    std::vector<GreyImage> pictures;
    for (const fs::path& picture : sequence.pictures) {
        auto grey = readGrey(picture);
        if (!grey) return namedIn(name, picture, grey.error());
        pictures.push_back(std::move(*grey));
    }
    auto targets = TRY(theatre::PoseTarget::ofSequence(pictures, representative, cast.stage, cast.targets[0].height, kMaskRows)
                           .in(name.string()));
    return std::move(targets[(first + *frame) % targets.size()]);
}

}  // namespace

Result<CastScene> readCastScene(const fs::path& file, std::optional<std::size_t> frame) {
    theatre::Cast cast = TRY(theatre::readCast(file));
    const std::size_t frames = cast.actors[0].poses.size();
    if (frame && *frame >= frames)
        return Error(fmt::format("{}: --frame {} is beyond the last frame, {}", file.string(), *frame, frames - 1));
    theatre::PoseTarget target = TRY(targetOf(cast, frame, file));
    theatre::PoseProblem problem{cast.stage, {std::move(target)}, {}, {}};
    for (std::size_t beam = 1; beam < cast.targets.size(); ++beam) {
        const auto& [picture, height, middle] = cast.targets[beam];
        const auto silhouette = readGrey(picture);
        if (!silhouette) return namedIn(file, picture, silhouette.error());
        problem.targets.push_back(
            TRY(theatre::PoseTarget::from(*silhouette, cast.stage, height, kMaskRows, {beam, middle}).in(picture.string())));
    }
    std::vector<double> dofs;
    for (const theatre::Cast::Actor& actor : cast.actors) {
        problem.actors.push_back(theatre::humanBody(actor.stature));
        const std::vector<double> his = theatre::dofsOf(problem.actors.back(), actor.poses[*frame]);
        dofs.insert(dofs.end(), his.begin(), his.end());
    }
    problem.buildSkins();
    return CastScene{std::move(cast), *frame, std::move(problem), std::move(dofs)};
}

}  // namespace fantascope::app
