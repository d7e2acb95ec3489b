#include "app/command/adapt_command.h"

#include "app/base/attendance.h"
#include "app/base/contact_sheet.h"
#include "app/base/frame_run.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/base/silhouette_file.h"
#include "app/base/video_writer.h"
#include "app/export/stage_material.h"

#include "theatre/deform/silhouette_sequence.h"
#include "theatre/deform/triangulated_silhouette.h"
#include "theatre/motion/motion_adaptation.h"
#include "theatre/motion/pose_spline.h"
#include "theatre/motion/sequence_frames.h"
#include "theatre/stage/cast.h"

#include "core/naming.h"
#include "core/parallel.h"
#include "plot/cast_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::MotionAdaptation, theatre::MotionProblem, theatre::PoseTarget, theatre::SilhouetteSequence;
using Quality = theatre::PoseSearch::Quality;

constexpr int kRows = 512;     // of the targets
constexpr int kLookRows = 96;  // of those that are compared to find the representative frame
// Intersection over union: what may be the cast's target; what a picture and its triangles have at
// least.
constexpr double kAlike = 0.9, kCovered = 0.8;
constexpr std::size_t kMostTold = 3;  // warnings of a kind
constexpr glm::ivec2 kVideo{960, 540}, kCell{480, 270};
constexpr std::size_t kMostCells = 12;
constexpr double kLeastRate = 30;  // of the video, Hz

struct Options {
    fs::path cast, sequence, output;
    std::optional<int> representative;  // from 1
    std::optional<double> frameRate;
    std::uint64_t seed = 1;
    int threads = hardwareThreads();
    MotionAdaptation::Options search;
    std::optional<fs::path> sheet, video, report;
};

void declare(CLI::App& command, Options& options) {
    command.add_option("CAST", options.cast, "The principal poses, *.cast.yaml, as 'fantascope pose' finds them")->required();
    command
        .add_option("SEQUENCE", options.sequence,
                    "The silhouette that moves: a folder that 'fantascope deform' wrote, or one with a picture a frame, in the "
                    "order of their names")
        ->required();
    addOutOption(command, options.output, "The motion to write, M.cast.yaml. An interrupted one is resumed")
        ->required()
        ->check(onlyYaml("M.cast.yaml"));
    command
        .add_option("--representative", options.representative,
                    "The frame that the poses are of, from 1 (default: the one most like the cast's target)")
        ->check(CLI::PositiveNumber);
    command
        .add_option(
            "--fps", options.frameRate,
            "Frames a second, whatever the sequence says: the same frames, sooner or later (default: the sequence's; of a "
            "folder of pictures 12)")
        ->check(CLI::Range(1.0, 1000.0));
    command
        .add_option("--wanted", options.search.wanted,
                    "Intersection over union of shadow and target: a frame that has it is not searched any further")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command.add_option("--searches", options.search.searches, "Steps of local search, for a frame that has not")
        ->check(CLI::Range(0, 100'000))
        ->capture_default_str();
    command.add_option("--passes", options.search.passes, "In which each frame is fitted between both its neighbours")
        ->check(CLI::Range(0, 100))
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Another seed, another motion; the same seed, the same motion")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{std::numeric_limits<std::int64_t>::max()}))
        ->capture_default_str();
    command.add_option("--threads", options.threads, "How many to use; the motion is the same for any number")
        ->check(CLI::Range(1, 256));
    command.add_option("--sheet", options.sheet, "Also draw people and shadow at moments of the motion, side by side")
        ->check(onlyEnding(".png", "PNG"));
    command
        .add_option(
            "--video", options.video,
            "Also write a video of people and shadow, H.264, with poses in between where there are fewer than 30 a second")
        ->check(onlyEnding(".mp4", "MP4"));
    command.add_option("--report", options.report, "Also write figures, as JSON (docs/report.md)");
    command.footer(
        "Meanwhile the space bar pauses and goes on; escape, q and Ctrl-C end it with the frames that are done, and the same "
        "command goes on from there.");
}

std::vector<fs::path> outputsOf(const Options& options) {
    std::vector<fs::path> files{options.output};
    for (const auto& file : {options.sheet, options.video, options.report})
        if (file) files.push_back(*file);
    return files;
}

// --- What is read

// A folder without a sequence.yaml is one of pictures, in the order of their names.
Result<SilhouetteSequence> sequenceAt(const Options& options) {
    const fs::path& given = options.sequence;
    std::error_code ignored;
    const fs::path file = fs::is_directory(given, ignored) ? given / "sequence.yaml" : given;
    if (fs::exists(file, ignored)) {
        SilhouetteSequence sequence = TRY(theatre::readSequence(file));
        sequence.framesPerSecond = options.frameRate.value_or(sequence.framesPerSecond);
        return sequence;
    }
    if (!fs::is_directory(given, ignored)) return Error(fmt::format("{}: is not there", given.string()));
    SilhouetteSequence sequence;
    for (const auto& entry : fs::directory_iterator(given)) {
        const std::string ending = entry.path().extension().string();
        if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") sequence.pictures.push_back(entry.path());
    }
    if (sequence.pictures.empty())
        return Error(
            fmt::format("{}: has neither a sequence.yaml nor pictures; 'fantascope deform' writes both", given.string()));
    std::sort(sequence.pictures.begin(), sequence.pictures.end());
    if (options.frameRate) sequence.framesPerSecond = *options.frameRate;
    return sequence;
}

// Of two targets on one stage, each in a frame of its own whose middle is before the light.
double overlap(const PoseTarget& a, const PoseTarget& b) {
    const int shift = (a.mask.width() - b.mask.width()) / 2, up = a.mask.height() - b.mask.height();
    std::int64_t both = 0;
    for (int y = 0; y < a.mask.height(); ++y)
        for (int x = 0; x < a.mask.width(); ++x) {
            const glm::ivec2 other(x - shift, y - up);
            const bool isInside = other.x >= 0 && other.y >= 0 && other.x < b.mask.width() && other.y < b.mask.height();
            both += a.mask.at(x, y) && isInside && b.mask.at(other.x, other.y);
        }
    return static_cast<double>(both) / (a.area + b.area - static_cast<double>(both));
}

Result<std::size_t> representativeOf(const Options& options, const theatre::Cast& cast, const SilhouetteSequence& sequence,
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
    const auto silhouette = readSilhouette(cast.target);
    if (!silhouette) return namedIn(options.cast, cast.target, silhouette.error());
    const PoseTarget wanted = TRY(targetOf(*silhouette, cast.target));
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        if (const double alike = overlap(TRY(targetOf(pictures[i], sequence.pictures[i])), wanted); alike > most)
            most = alike, best = i;
    if (most < kAlike)
        return Error(fmt::format(
            "{}: no frame of {} is like its target (the nearest is frame {}, {:.0f} % alike); find poses for one of its pictures "
            "with 'fantascope pose', or say which frame they are of: --representative",
            options.cast.string(), options.sequence.string(), best + 1, 100 * most));
    return best;
}

// Everything that a run needs and leaves behind.
struct Adapted {
    const Options& options;
    theatre::Cast cast;  // the principal poses
    SilhouetteSequence sequence;
    MotionProblem motion;
    std::vector<double> principal;
    MotionAdaptation::Frames frames{};
    std::vector<double> seconds{};  // of each frame, when it was done
    bool isWhole() const {
        return std::all_of(frames.begin(), frames.end(), [](const auto& frame) { return frame.has_value(); });
    }
};

// Of the first frame.
std::vector<double> freedomsOf(const theatre::Cast& cast, const theatre::PoseProblem& problem) {
    std::vector<double> freedoms;
    for (std::size_t i = 0; i < cast.actors.size(); ++i) {
        const std::vector<double> his = theatre::freedomsOf(problem.actors[i], cast.actors[i].poses[0]);
        freedoms.insert(freedoms.end(), his.begin(), his.end());
    }
    return freedoms;
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

Result<Adapted> readAll(const Options& options) {
    theatre::Cast cast = TRY(theatre::readCast(options.cast));
    if (cast.stage.beams() > 1 || cast.stage.screens[0].isCurved())
        return Error(
            fmt::format("{}: its stage has {}, and poses follow a silhouette that moves on one flat screen; find them with "
                        "'fantascope pose' on a stage with one light and without a 'radius'",
                        options.cast.string(), cast.stage.beams() > 1 ? "further_beams" : "a curved screen"));
    if (cast.actors[0].poses.size() != 1)
        return Error(fmt::format("{}: has {} poses of each actor; principal poses are those of one frame", options.cast.string(),
                                 cast.actors[0].poses.size()));
    if (cast.stageFile) TRY(checkStageCanGo(*cast.stageFile, cast.stage, options.output));
    SilhouetteSequence sequence = TRY(sequenceAt(options));
    std::vector<GreyImage> pictures;
    for (const fs::path& file : sequence.pictures) pictures.push_back(TRY(readSilhouette(file)));
    const std::size_t representative = TRY(representativeOf(options, cast, sequence, pictures));
    std::vector<PoseTarget> targets =
        TRY(PoseTarget::ofSequence(pictures, representative, cast.stage, cast.height, kRows).in(options.sequence.string()));
    MotionProblem motion{
        {cast.stage, targets[representative], {}, {}}, std::move(targets), representative, {}, {}, sequence.loops};
    for (const theatre::Cast::Actor& actor : cast.actors) motion.principal.actors.push_back(theatre::humanBody(actor.stature));
    motion.principal.dress();
    const bool hasInterior = sequence.interior.has_value();
    if (!hasInterior) {
        // Nobody says what became of what: a triangulation that stays leaves the first guess to the
        // poses of the frame beside.
        const auto still =
            TRY(theatre::TriangulatedSilhouette::of(pictures[representative], theatre::TriangulatedSilhouette::kVertices)
                    .in(sequence.pictures[representative].string()));
        sequence.interior = {still.rest.triangles, {pictures.size(), still.rest.vertices}};
    }
    motion.triangles = sequence.interior->triangles;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        std::vector<glm::dvec2>& corners = motion.corners.emplace_back();
        for (const glm::dvec2 vertex : sequence.interior->vertices[i])
            corners.push_back(motion.targets[i].given.metresAt(vertex));
    }
    if (hasInterior) TRY(checkInterior(motion).in(options.sequence.string()));
    std::vector<double> principal = freedomsOf(cast, motion.principal);
    return Adapted{options, std::move(cast), std::move(sequence), std::move(motion), std::move(principal)};
}

void tell(const std::vector<std::string>& warnings) {
    for (std::size_t i = 0; i < std::min(kMostTold, warnings.size()); ++i)
        fmt::print(stderr, "adapt: warning: {}\n", warnings[i]);
    if (warnings.size() > kMostTold) fmt::print(stderr, "adapt: warning: and so at {} more\n", warnings.size() - kMostTold);
}

// What is hard to follow is followed as well as can be, and told of.
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

// --- What is done

// A motion that was interrupted, if it is of these poses and this sequence.
MotionAdaptation::Frames knownOf(const Adapted& adapted) {
    std::error_code ignored;
    if (!fs::exists(adapted.options.output, ignored)) return {};
    const auto cast = theatre::readCast(adapted.options.output);
    if (!cast || !cast->sequence || cast->actors.size() != adapted.cast.actors.size()) return {};
    const auto& [file, representative, first] = *cast->sequence;
    const std::size_t count = cast->actors[0].poses.size(), all = adapted.motion.targets.size();
    const std::size_t own = (representative + all - first) % all;  // of its poses, those of the representative frame
    if (representative != adapted.motion.representative || count >= all || first >= all || own >= count) return {};
    for (std::size_t a = 0; a < cast->actors.size(); ++a) {
        const theatre::Body& body = adapted.motion.principal.actors[a];
        const auto his = std::span(adapted.principal).subspan(adapted.motion.principal.firstFreedom(a), body.freedoms);
        const theatre::ActorPose there = cast->actors[a].poses[own], wanted = theatre::poseOf(body, his);
        if (there.root != wanted.root || there.turns != wanted.turns) return {};
    }
    MotionAdaptation::Frames known(all);
    for (std::size_t i = 0; i < count; ++i)
        if (i != own)
            for (std::vector<theatre::ActorPose>& poses = known[(first + i) % all].emplace().poses;
                 const theatre::Cast::Actor& actor : cast->actors)
                poses.push_back(actor.poses[i]);
    fmt::print(stderr, "adapt: goes on with {} of {} frames from {}\n", count, all, adapted.options.output.string());
    return known;
}

void adapt(Adapted& adapted) {
    SteadyClock clock;
    Attendance attendance(clock);
    Progress progress("adapt", clock, std::cerr, standardErrorIsTerminal());
    const std::size_t all = adapted.motion.targets.size();
    const auto steps = static_cast<double>(all * (1 + static_cast<std::size_t>(adapted.options.search.passes)));
    const Time start = clock.now();
    adapted.seconds.assign(all, 0);
    MotionAdaptation::Frames known = knownOf(adapted);
    double done =
        static_cast<double>(std::count_if(known.begin(), known.end(), [](const auto& frame) { return frame.has_value(); }));
    std::string last = "first frame";
    MotionAdaptation::Options options = adapted.options.search;
    options.threads = adapted.options.threads;
    adapted.frames = MotionAdaptation::run(
        adapted.motion, adapted.principal, adapted.options.seed, options,
        {.tell =
             [&](std::size_t frame, const theatre::AdaptedFrame& found) {
                 adapted.seconds[frame] = seconds(clock.now() - start - attendance.paused());
                 last = fmt::format("frame {}  IoU {:.3f}{}", frame + 1, found.quality.iou,
                                    found.quality.isValid() ? "" : " (cannot be held)");
                 progress.update(++done / steps, last);
             },
         .askStop =
             [&] {
                 progress.update(done / steps, last);
                 return !attendance.goesOn([&] { progress.update(done / steps, last + "  paused, space goes on"); });
             }},
        std::move(known));
}

// --- What is written

// The sequence as the motion refers to it: where it is if that is beside or below the motion, else
// a copy there.
Result<fs::path> placeSequence(const Adapted& adapted) {
    const fs::path folder = fs::absolute(adapted.options.output).parent_path();
    const std::string stem = adapted.options.output.stem().stem().string();
    std::error_code ignored;
    const fs::path given = adapted.options.sequence, file = fs::is_directory(given, ignored) ? given / "sequence.yaml" : given;
    if (fs::exists(file, ignored) && !materialFor(adapted.options.output, file, "").copied) return file;
    SilhouetteSequence sequence = adapted.sequence;
    const bool isBelow = std::none_of(sequence.pictures.begin(), sequence.pictures.end(), [&](const fs::path& picture) {
        return materialFor(adapted.options.output, picture, "").copied;
    });
    const fs::path own = isBelow ? folder / (stem + ".sequence.yaml") : folder / (stem + ".sequence") / "sequence.yaml";
    if (!isBelow)
        for (std::size_t i = 0; i < sequence.pictures.size(); ++i) {
            const fs::path& source = sequence.pictures[i];
            const Material picture{source, fmt::format("frame-{:04}{}", i + 1, source.extension().string()), true};
            TRY(copyTo(own.parent_path(), picture));
            sequence.pictures[i] = own.parent_path() / picture.name;
        }
    TRY(theatre::writeSequence(own, sequence));
    return own;
}

// The frames that are there, in the order in which they are played: they hang together, in a loop
// also over its end.
std::vector<std::size_t> framesThere(const Adapted& adapted) {
    const std::size_t all = adapted.frames.size();
    std::size_t first = adapted.motion.representative;
    for (std::size_t steps = 1; steps < all && adapted.frames[(first + all - 1) % all] && (first > 0 || adapted.motion.loops);
         ++steps)
        first = (first + all - 1) % all;
    if (adapted.isWhole()) first = 0;
    std::vector<std::size_t> there;
    for (std::size_t i = first; there.size() < all && adapted.frames[i]; i = (i + 1) % all) {
        there.push_back(i);
        if (i + 1 == all && !adapted.motion.loops) break;
    }
    return there;
}

Result<void> writeMotion(const Adapted& adapted) {
    const std::vector<std::size_t> there = framesThere(adapted);
    theatre::Cast cast = adapted.cast;
    const fs::path sequence = TRY(placeSequence(adapted));
    cast.sequence = {sequence, adapted.motion.representative, there.front()};
    cast.framesPerSecond = adapted.sequence.framesPerSecond;
    cast.seed = adapted.options.seed;
    const fs::path folder = fs::absolute(adapted.options.output).parent_path();
    const Material target = materialFor(adapted.options.output, cast.target, "target" + cast.target.extension().string());
    TRY(copyTo(folder, target));
    cast.target = folder / target.name;
    if (cast.stageFile) cast.stageFile = TRY(placeStage(*cast.stageFile, cast.stage, adapted.options.output));
    for (std::size_t a = 0; a < cast.actors.size(); ++a) {
        cast.actors[a].poses.clear();
        for (const std::size_t frame : there) cast.actors[a].poses.push_back(adapted.frames[frame]->poses[a]);
    }
    return theatre::writeCast(adapted.options.output, cast);
}

// People and their shadow, against a frame's silhouette.
RgbaImage pictureOf(const Adapted& adapted, std::size_t frame, std::span<const double> freedoms, glm::ivec2 size) {
    theatre::PoseProblem problem = adapted.motion.principal;
    problem.target = adapted.motion.targets[frame];
    const plot::CastPicture picture = plot::castPicture(problem, freedoms);
    return picture.view.draw(picture.view.closeUp(double(size.x) / size.y), size.x, size.y);
}

// As it would be played: with poses in between where the frames are few.
Result<void> film(const Adapted& adapted, const std::vector<std::size_t>& there, const fs::path& file) {
    const auto& principal = adapted.motion.principal;
    const double rate = std::max(adapted.sequence.framesPerSecond, kLeastRate);
    const bool loops = adapted.motion.loops && adapted.isWhole();
    std::vector<theatre::PoseSpline> splines;
    for (std::size_t a = 0; a < principal.actors.size(); ++a) {
        std::vector<theatre::ActorPose> poses;
        for (const std::size_t frame : there) poses.push_back(adapted.frames[frame]->poses[a]);
        splines.emplace_back(principal.actors[a], principal.stage, std::move(poses), loops);
    }
    const auto video = TRY(VideoWriter::open(file, kVideo, rate, VideoKind::Film));
    const double last = static_cast<double>(there.size()) - (loops ? 0 : 1), step = adapted.sequence.framesPerSecond / rate;
    const auto count = static_cast<std::int64_t>(std::floor(last / step)) + (loops ? 0 : 1);
    const std::int64_t made = TRY(makeFrames("video", count, [&](std::int64_t number) -> Result<void> {
        const double frame = static_cast<double>(number) * step;
        std::vector<double> freedoms;
        for (theatre::PoseSpline& spline : splines) {
            const std::vector<double>& his = spline.at(frame);
            freedoms.insert(freedoms.end(), his.begin(), his.end());
        }
        const std::size_t nearest = there[static_cast<std::size_t>(std::lround(frame)) % there.size()];
        return video->write(pictureOf(adapted, nearest, freedoms, kVideo), number);
    }));
    if (made == 0) return {};
    return video->finish();
}

Result<void> drawPictures(const Adapted& adapted) {
    const Options& options = adapted.options;
    const std::vector<std::size_t> there = framesThere(adapted);
    if (options.sheet) {
        std::vector<LabelledPicture> cells;
        const std::size_t count = std::min(kMostCells, there.size());
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t i = there[count == 1 ? 0 : k * (there.size() - 1) / (count - 1)];
            cells.push_back({fmt::format("frame {}, IoU {:.3f}", i + 1, adapted.frames[i]->quality.iou),
                             pictureOf(adapted, i, adapted.frames[i]->freedoms, kCell)});
        }
        TRY(writePng(*options.sheet, contactSheet(cells, 3)));
    }
    if (options.video) TRY(film(adapted, there, *options.video));
    return {};
}

// Over the frames that there are.
double mean(const Adapted& adapted, double Quality::*figure) {
    double sum = 0, count = 0;
    for (const auto& frame : adapted.frames)
        if (frame) sum += frame->quality.*figure, ++count;
    return sum / count;
}

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

Report reportOf(const Adapted& adapted, double seconds) {
    const auto motion = measureMotion(adapted.motion, adapted.frames, adapted.sequence.framesPerSecond);
    Report report, rows = Report::array();
    double worst = 1;
    bool areValid = true;
    std::int64_t evaluations = 0;
    for (std::size_t i = 0; i < adapted.frames.size(); ++i) {
        const auto& frame = adapted.frames[i];
        if (!frame) continue;
        worst = std::min(worst, frame->quality.iou);
        areValid = areValid && frame->quality.isValid();
        evaluations += frame->evaluations;
        rows.push_back({{"frame", i + 1},
                        {"iou", frame->quality.iou},
                        {"iou_without_props", frame->quality.iouWithoutProps},
                        {"valid", frame->quality.isValid()},
                        {"energy", frame->quality.energy},
                        {"evaluations", frame->evaluations},
                        {"done_at", adapted.seconds[i]}});
    }
    report["representative"] = adapted.motion.representative + 1;
    report["fps"] = adapted.sequence.framesPerSecond;
    report["loops"] = adapted.motion.loops;
    report["iou_mean"] = mean(adapted, &Quality::iou);
    report["iou_worst"] = worst;
    report["iou_without_props_mean"] = mean(adapted, &Quality::iouWithoutProps);
    report["props_cover_mean"] = mean(adapted, &Quality::propsCover);
    report["valid"] = areValid;
    report["fastest_joint"] = degrees(motion.fastestJoint);
    report["fastest_root"] = motion.fastestRoot;
    report["farthest_contact"] = motion.farthestContact;
    report["evaluations"] = evaluations;
    report["seconds"] = seconds;
    report["seed"] = adapted.options.seed;
    report["frames"] = std::move(rows);
    return report;
}

std::string brief(const Adapted& adapted) {
    double worst = 1;
    std::string fallen;
    std::size_t there = 0;
    for (std::size_t i = 0; i < adapted.frames.size(); ++i) {
        if (!adapted.frames[i]) continue;
        ++there;
        worst = std::min(worst, adapted.frames[i]->quality.iou);
        if (!adapted.frames[i]->quality.isValid()) fallen += fmt::format("{} {}", fallen.empty() ? "" : ",", i + 1);
    }
    std::string text = fmt::format("{}: {} frames from frame {}, mean IoU {:.3f}, worst {:.3f}", adapted.options.output.string(),
                                   there, adapted.motion.representative + 1, mean(adapted, &Quality::iou), worst);
    if (const double cover = mean(adapted, &Quality::propsCover); cover > 0)
        text += fmt::format("; the people's shadow alone {:.3f}, and platforms and props cover {:.0f} % of the targets",
                            mean(adapted, &Quality::iouWithoutProps), 100 * cover);
    if (!adapted.isWhole()) text += fmt::format("; interrupted, of {}: the same command goes on", adapted.frames.size());
    if (!fallen.empty()) text += fmt::format("; nobody can hold frame{}", fallen);
    return text;
}

Result<void> run(const Options& options) {
    const SteadyClock clock;
    const Time start = clock.now();
    for (const fs::path& file : outputsOf(options)) TRY(checkWritable(file));
    if (fs::weakly_canonical(fs::absolute(options.output)) == fs::weakly_canonical(fs::absolute(options.cast)))
        return Error(fmt::format("{}: is the principal poses' file, and would be overwritten; choose another name",
                                 options.output.string()));
    Adapted adapted = TRY(readAll(options));
    warn(adapted);
    adapt(adapted);
    TRY(writeMotion(adapted));
    if (options.report) TRY(writeReport(*options.report, reportOf(adapted, seconds(clock.now() - start))));
    TRY(drawPictures(adapted));
    fmt::print("{}\n", brief(adapted));
    return {};
}

}  // namespace

void addAdaptCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "adapt", "Let poses follow a silhouette that moves", declare, run);
}

}  // namespace fantascope::app
