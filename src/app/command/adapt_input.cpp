#include "app/command/adapt_input.h"

#include "app/base/silhouette_file.h"
#include "app/export/stage_material.h"

#include "theatre/deform/triangulated_silhouette.h"
#include "theatre/motion/sequence_frames.h"

#include "core/config/naming.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::MotionProblem, theatre::PoseTarget, theatre::SilhouetteSequence;

constexpr int kRows = 512;            // of the targets
constexpr int kLookRows = 96;         // of those that are compared to find the representative frame
constexpr double kCovered = 0.8;      // intersection over union: what a picture and its triangles have at least
constexpr std::size_t kMostTold = 3;  // warnings of a kind

// In the order of their names.
Result<std::vector<fs::path>> picturesIn(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) return Error(fmt::format("{}: is not there", folder.string()));
    std::vector<fs::path> pictures;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string ending = entry.path().extension().string();
        if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") pictures.push_back(entry.path());
    }
    if (pictures.empty())
        return Error(
            fmt::format("{}: has neither a sequence.yaml nor pictures; 'fantascope deform' writes both", folder.string()));
    std::sort(pictures.begin(), pictures.end());
    return pictures;
}

// A folder without a sequence.yaml is one of pictures.
Result<SilhouetteSequence> sequenceAt(const AdaptOptions& options) {
    const fs::path& given = options.sequence;
    std::error_code ignored;
    const fs::path file = fs::is_directory(given, ignored) ? given / "sequence.yaml" : given;
    Result<SilhouetteSequence> sequence = SilhouetteSequence{};
    if (fs::exists(file, ignored))
        sequence = theatre::readSequence(file);
    else
        sequence->pictures = TRY(picturesIn(given));
    if (sequence && options.frameRate) sequence->framesPerSecond = *options.frameRate;
    return sequence;
}

Result<std::size_t> representativeOf(const AdaptOptions& options, const theatre::Cast& cast, const SilhouetteSequence& sequence,
                                     const std::vector<GreyImage>& pictures) {
    if (options.representative) {
        if (static_cast<std::size_t>(*options.representative) > pictures.size())
            return Error(fmt::format("--representative {}: {} has {} frames", *options.representative, options.sequence.string(),
                                     pictures.size()));
        return static_cast<std::size_t>(*options.representative - 1);
    }
    const auto targetOf = [&](const GreyImage& picture, const fs::path& file) {
        return PoseTarget::from(picture, {}, 1, kLookRows).in(file.string());
    };
    const fs::path& file = cast.targets[0].file;
    const auto silhouette = readSilhouette(file);
    if (!silhouette) return namedIn(options.cast, file, silhouette.error());
    const PoseTarget wanted = TRY(targetOf(*silhouette, file));
    std::vector<PoseTarget> frames;
    for (std::size_t i = 0; i < pictures.size(); ++i) frames.push_back(TRY(targetOf(pictures[i], sequence.pictures[i])));
    const theatre::Likeness best = theatre::mostAlike(frames, wanted);
    if (!best.isEnough())
        return Error(fmt::format(
            "{}: no frame of {} is like its target (the nearest is frame {}, {:.0f} % alike); find poses for one of its pictures "
            "with 'fantascope pose', or say which frame they are of: --representative",
            options.cast.string(), options.sequence.string(), best.frame + 1, 100 * best.overlap));
    return best.frame;
}

// Of the first frame.
std::vector<double> dofsOf(const theatre::Cast& cast, const theatre::PoseProblem& problem) {
    std::vector<double> dofs;
    for (std::size_t i = 0; i < cast.actors.size(); ++i) {
        const std::vector<double> his = theatre::dofsOf(problem.actors[i], cast.actors[i].poses[0]);
        dofs.insert(dofs.end(), his.begin(), his.end());
    }
    return dofs;
}

// Triangles are of the pictures that they come with.
Result<void> checkInterior(const MotionProblem& motion) {
    std::vector<glm::dvec2> corners;
    for (std::size_t i = 0; i < motion.targets.size(); ++i) {
        const PoseTarget& target = motion.targets[i];
        corners.clear();
        for (const glm::dvec2 corner : motion.corners[i]) corners.push_back(target.frame.pixelAt(corner.x, corner.y));
        const double alike = intersectionOverUnion(
            theatre::filled(target.mask.width(), target.mask.height(), motion.triangles, corners), target.mask);
        if (alike < kCovered)
            return Error(fmt::format(
                "frame {}: its triangles are not those of its picture: {:.0f} % of what either covers is in both, and "
                "{:.0f} % are needed; leave 'interior' out of the sequence, or make it with 'fantascope deform'",
                i + 1, 100 * alike, 100 * kCovered));
    }
    return {};
}

// The triangulation of the targets' interiors. Where nobody says what became of what, one that
// stays leaves the first guess to the poses of the frame beside.
Result<void> addInterior(MotionProblem& motion, SilhouetteSequence& sequence, const std::vector<GreyImage>& pictures,
                         const fs::path& file) {
    const bool hasInterior = sequence.interior.has_value();
    if (!hasInterior) {
        const auto still =
            TRY(theatre::TriangulatedSilhouette::of(pictures[motion.representative], theatre::TriangulatedSilhouette::kVertices)
                    .in(sequence.pictures[motion.representative].string()));
        sequence.interior = {still.rest.triangles, {pictures.size(), still.rest.vertices}};
    }
    motion.triangles = sequence.interior->triangles;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        std::vector<glm::dvec2>& corners = motion.corners.emplace_back();
        for (const glm::dvec2 vertex : sequence.interior->vertices[i])
            corners.push_back(motion.targets[i].given.metresAt(vertex));
    }
    return hasInterior ? checkInterior(motion).in(file.string()) : Result<void>();
}

void tell(const std::vector<std::string>& warnings) {
    for (std::size_t i = 0; i < std::min(kMostTold, warnings.size()); ++i)
        fmt::print(stderr, "adapt: warning: {}\n", warnings[i]);
    if (warnings.size() > kMostTold) fmt::print(stderr, "adapt: warning: and so at {} more\n", warnings.size() - kMostTold);
}

}  // namespace

Result<Adapted> readMotion(const AdaptOptions& options) {
    theatre::Cast cast = TRY(theatre::readCast(options.cast));
    if (cast.stage.beams.size() > 1 || cast.stage.screens[0].isCurved())
        return Error(
            fmt::format("{}: its stage has {}, and poses follow a silhouette that moves on one flat screen; find them with "
                        "'fantascope pose' on a stage with one light and without a 'radius'",
                        options.cast.string(), cast.stage.beams.size() > 1 ? "further_beams" : "a curved screen"));
    if (cast.actors[0].poses.size() != 1)
        return Error(fmt::format("{}: has {} poses of each actor; principal poses are those of one frame", options.cast.string(),
                                 cast.actors[0].poses.size()));
    if (cast.stageFile) TRY(checkStageCanGo(*cast.stageFile, cast.stage, options.output));
    SilhouetteSequence sequence = TRY(sequenceAt(options));
    std::vector<GreyImage> pictures;
    for (const fs::path& file : sequence.pictures) pictures.push_back(TRY(readSilhouette(file)));
    const std::size_t representative = TRY(representativeOf(options, cast, sequence, pictures));
    std::vector<PoseTarget> targets =
        TRY(PoseTarget::ofSequence(pictures, representative, cast.stage, cast.targets[0].height, kRows)
                .in(options.sequence.string()));
    MotionProblem motion{
        {cast.stage, {targets[representative]}, {}, {}}, std::move(targets), representative, {}, {}, sequence.loops};
    for (const theatre::Cast::Actor& actor : cast.actors) motion.principal.actors.push_back(theatre::humanBody(actor.stature));
    motion.principal.buildSkins();
    TRY(addInterior(motion, sequence, pictures, options.sequence));
    std::vector<double> principal = dofsOf(cast, motion.principal);
    return Adapted{options, std::move(cast), std::move(sequence), std::move(motion), std::move(principal)};
}

void warn(const Adapted& adapted) {
    const MotionProblem& motion = adapted.motion;
    std::vector<theatre::BitMask> frames;
    for (const PoseTarget& target : motion.targets) frames.push_back(target.mask);
    std::vector<std::string> warnings;
    for (const auto& [from, to, overlap] : theatre::jumpsOf(frames, motion.loops))
        warnings.push_back(fmt::format(
            "from frame {} to frame {} the silhouette jumps: {:.0f} % of what either covers is in both; poses that were good "
            "there may not be found here: put frames in between",
            from + 1, to + 1, 100 * overlap));
    tell(std::exchange(warnings, {}));
    const auto& vertices = adapted.sequence.interior->vertices;
    const FlatMesh rest{vertices[motion.representative], motion.triangles};
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if (const std::size_t folded = theatre::foldedTriangles(rest, vertices[i]).size(); folded > 0)
            warnings.push_back(fmt::format(
                "frame {}: {} of {} triangles are folded over, against frame {}; whoever is in them is led astray at first",
                i + 1, folded, motion.triangles.size(), motion.representative + 1));
    tell(std::exchange(warnings, {}));
    const std::vector<double> least = theatre::leastOverlaps(frames);
    const std::size_t middle = theatre::middleFrame(least);
    if (theatre::isOffTheMiddle(motion.representative, least))
        fmt::print(stderr,
                   "adapt: frame {} is more like all the others than frame {}, which the poses are of; poses for it, 'fantascope "
                   "pose {}', are likely to follow better\n",
                   middle + 1, motion.representative + 1, adapted.sequence.pictures[middle].string());
}

}  // namespace fantascope::app
