#include "theatre/motion/wanted_shadow.h"

#include "theatre/deform/silhouette_sequence.h"
#include "theatre/energy/pose_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fantascope::theatre {
namespace {

constexpr int kLaidRows = 64;  // of the masks, which are not used: only their place is

// A cast's pictures of a beam's screen, in the order of its frames, and where they lie on it.
struct LaidPictures {
    std::vector<GreyImage> pictures;
    ScreenFrame place;
};

Result<LaidPictures> laidSequence(const Cast& cast) {
    const Cast::Sequence& followed = *cast.sequence;
    const SilhouetteSequence sequence = TRY(readSequence(followed.file));
    const std::size_t count = sequence.pictures.size();
    if (followed.representative >= count)
        return Error(fmt::format("{}: has no frame {}, for which the poses were found", followed.file.string(),
                                 followed.representative + 1));
    std::vector<GreyImage> pictures;
    for (const auto& file : sequence.pictures) pictures.push_back(TRY(readGrey(file)));
    const auto targets =
        TRY(PoseTarget::ofSequence(pictures, followed.representative, cast.stage, cast.targets[0].height, kLaidRows)
                .in(followed.file.string()));
    LaidPictures laid{{}, targets[0].given};
    for (std::size_t frame = 0; frame < cast.actors.front().poses.size(); ++frame)
        laid.pictures.push_back(pictures[(followed.first + frame) % count]);
    return laid;
}

Result<LaidPictures> laidPictures(const Cast& cast, std::size_t beam) {
    if (beam == 0 && cast.sequence) return laidSequence(cast);
    if (beam >= cast.targets.size()) return Error(fmt::format("there is no target for beam {}", beam + 1));
    const auto& [file, height, middle] = cast.targets[beam];
    GreyImage picture = TRY(readGrey(file));
    const PoseTarget target = TRY(PoseTarget::from(picture, cast.stage, height, kLaidRows, {beam, middle}).in(file.string()));
    return LaidPictures{{std::move(picture)}, target.given};
}

// A picture of the rectangle: the share of each pixel in which `holds(metres)`.
template <class Holds>
GreyImage shareOf(glm::dvec2 from, glm::dvec2 to, int rows, Holds holds) {
    constexpr int kSide = 4;  // samples across and down a pixel
    const glm::dvec2 size = to - from;
    const int columns = std::max(1, static_cast<int>(std::lround(rows * size.x / size.y)));
    GreyImage picture(columns, rows);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            int held = 0;
            for (int i = 0; i < kSide * kSide; ++i) {
                const glm::dvec2 at((x + (i % kSide + 0.5) / kSide) / columns, (y + (i / kSide + 0.5) / kSide) / rows);
                held += holds(from + size * glm::dvec2(at.x, 1 - at.y));
            }
            picture.at(x, y) = static_cast<float>(held) / (kSide * kSide);
        }
    return picture;
}

}  // namespace

const GreyImage& WantedShadow::at(double frame) const {
    return frames[static_cast<std::size_t>(std::lround(frame)) % frames.size()];
}

Result<WantedShadow> wantedShadow(const Cast& cast, std::size_t beam, glm::dvec2 from, glm::dvec2 to, int rows) {
    const LaidPictures laid = TRY(laidPictures(cast, beam));
    WantedShadow wanted;
    for (const GreyImage& picture : laid.pictures)
        wanted.frames.push_back(shareOf(from, to, rows, [&](glm::dvec2 metres) {
            const glm::dvec2 pixel = laid.place.pixelAt(metres.x, metres.y);
            if (pixel.x < 0 || pixel.y < 0 || pixel.x >= picture.width() || pixel.y >= picture.height()) return false;
            return picture.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y)) > 0.5f;
        }));
    const Screen& screen = cast.stage.screenOf(beam);
    const glm::dvec3 light = cast.stage.lightOnScreen(beam);
    const auto& lit = cast.stage.beams[beam].lit;
    wanted.counted = shareOf(from, to, rows, [&](glm::dvec2 metres) {
        const auto flat = metres.y >= 0 ? flatFromUnrolled(screen, light, metres) : std::nullopt;
        return flat &&
               (!lit || (flat->x >= lit->from.x && flat->x <= lit->to.x && flat->y >= lit->from.y && flat->y <= lit->to.y));
    });
    return wanted;
}

}  // namespace fantascope::theatre
