#include "app/base/frame_run.h"
#include "app/base/output.h"
#include "app/base/report.h"
#include "app/base/silhouette_file.h"
#include "app/base/video_writer.h"
#include "app/command/commands.h"
#include "app/export/motion_sheet.h"
#include "app/export/sequence_folder.h"

#include "theatre/deform/handle_motion.h"
#include "theatre/deform/shape_manipulation.h"
#include "theatre/deform/silhouette_sequence.h"
#include "theatre/deform/triangulated_silhouette.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/motion/sequence_frames.h"

#include "core/clock.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::HandleMotion, theatre::TriangulatedSilhouette;

constexpr double kOutside = 0.5;                    // pixels: what is farther out of the picture leaves it
constexpr int kMargin = 4;                          // around what left it
constexpr double kRounding = 1e-3;                  // of the vertices in the file, pixels
constexpr double kLeastRate = 1, kMostRate = 1000;  // frames a second, of a video
constexpr int kLookRows = 128;                      // in which frames are compared

struct Options {
    fs::path silhouette, motion, output;
    std::optional<double> frameRate;
    std::optional<int> frames;
    int vertices = TriangulatedSilhouette::kVertices;
    bool invert = false;
    std::optional<fs::path> sheet, video, report;
};

void declare(Command& command, Options& options) {
    command.add("SILHOUETTE", options.silhouette, "What is to move, white on black: PNG or JPEG").required();
    command.add("--motion", options.motion, "Its handles and how they move, *.motion.yaml (docs/motion-format.md)").required();
    addOutOption(command, options.output,
                 "The folder to write: a picture a frame, and sequence.yaml (docs/sequence-format.md). A sequence that is "
                 "there already is replaced")
        .required();
    command.addFlag("--invert", options.invert, "The silhouette is black ink on white paper");
    command.add("--fps", options.frameRate, "Frames a second (default: the motion's)")
        .range(HandleMotion::kLeastFramesPerSecond, HandleMotion::kMostFramesPerSecond);
    command.add("--frames", options.frames, "How many, from the motion's beginning to its end (default: by the frame rate)")
        .range(1, HandleMotion::kMostFrames);
    command.add("--vertices", options.vertices, "About how many the triangles inside have: more bend more finely")
        .range(TriangulatedSilhouette::kFewestVertices, TriangulatedSilhouette::kMostVertices)
        .showDefault();
    command.add("--sheet", options.sheet, "Also draw the frames side by side, with the triangles and the handles")
        .check(onlyEnding(".png", "PNG"));
    command.add("--video", options.video, "Also write a video to look at, H.264").check(onlyEnding(".mp4", "MP4"));
    command.add("--report", options.report, "Also write figures, as JSON (docs/report.md)");
    command.footer("Meanwhile the space bar pauses and goes on; escape, q and Ctrl-C end it, and nothing is written.");
}

Result<void> checkOutputs(const Options& options) {
    TRY(SequenceFolder::check(options.output));
    const auto isSame = [](const fs::path& a, const fs::path& b) {
        return fs::weakly_canonical(fs::absolute(a)) == fs::weakly_canonical(fs::absolute(b));
    };
    for (const auto& [input, what] : {std::pair(options.silhouette, "silhouette"), {options.motion, "motion"}}) {
        if (SequenceFolder::replaces(options.output, input))
            return Error(fmt::format("{}: is the {}, and would be overwritten; choose another folder than {}", input.string(),
                                     what, options.output.string()));
        for (const auto& file : {options.sheet, options.video, options.report})
            if (file && isSame(*file, input))
                return Error(fmt::format("{}: is the {}, and would be overwritten; choose another name", input.string(), what));
    }
    for (const auto& file : {options.sheet, options.video, options.report}) {
        if (!file) continue;
        TRY(checkWritable(*file));
        if (SequenceFolder::replaces(options.output, *file))
            return Error(fmt::format("{}: the folder's own files are called so; choose another name", file->string()));
    }
    return {};
}

// When the frames are, and how quickly they are to be played.
struct Schedule {
    int frames = 0;
    double step = 0;  // seconds of the motion between two
    double frameRate = 0;
};

// A loop's last frame is a step before its end, which is its beginning.
Result<Schedule> scheduleOf(const HandleMotion& motion, const Options& options) {
    Schedule schedule;
    schedule.frameRate = options.frameRate.value_or(motion.framesPerSecond);
    const int last = motion.loops ? 0 : 1;
    const double wanted = std::max(1.0, std::round(motion.seconds * schedule.frameRate) + last);
    if (!options.frames && wanted > HandleMotion::kMostFrames)
        return Error(fmt::format("{}: {:.0f} frames are too many, {} may be: give a smaller --fps, or --frames",
                                 options.motion.string(), wanted, HandleMotion::kMostFrames));
    schedule.frames = options.frames.value_or(static_cast<int>(std::min<double>(wanted, HandleMotion::kMostFrames)));
    schedule.step = motion.seconds / std::max(1, schedule.frames - last);
    if (options.frames && !options.frameRate && schedule.frames > last) schedule.frameRate = 1 / schedule.step;
    if (schedule.frameRate < kLeastRate || schedule.frameRate > kMostRate)
        return Error(fmt::format(
            "--frames {}: would be {:.3g} frames a second, {} .. {} can be played: give --fps, how quickly they are to "
            "be played",
            schedule.frames, schedule.frameRate, kLeastRate, kMostRate));
    return schedule;
}

// All frames are as much larger than the silhouette's picture, so that what leaves it on any side
// is not cut off.
struct Canvas {
    glm::ivec2 leftTop{0}, rightBottom{0};  // pixels on these sides, >= 0
    glm::ivec2 size{0};

    bool isWider() const { return leftTop != glm::ivec2(0) || rightBottom != glm::ivec2(0); }
};

// Everything that a run leaves behind is made of this.
struct Deformed {
    const Options& options;
    TriangulatedSilhouette silhouette;
    HandleMotion motion;
    Schedule schedule;
    std::vector<DeformedFrame> frames{};
    DeformedFrame rest{};
    Canvas canvas{};

    // Of consecutive frames in which triangles are turned over.
    struct Fold {
        std::size_t first, last, most;
        std::vector<std::string> handles;
    };
    std::vector<Fold> folds{};
};

Result<void> checkWhole(std::int64_t made, std::int64_t wanted) {
    if (made < wanted) return Error("interrupted; nothing is written");
    return {};
}

Result<void> deform(Deformed& deformed) {
    std::vector<theatre::CarriedPoint> handles;
    for (const HandleMotion::Handle& handle : deformed.motion.handles) {
        handles.push_back(handle.point);
        deformed.rest.places.push_back(handle.at);
    }
    deformed.rest.vertices = deformed.silhouette.rest.vertices;
    const theatre::ShapeManipulation manipulation(deformed.silhouette.rest, handles);
    const std::int64_t wanted = deformed.schedule.frames;
    const std::int64_t made = TRY(makeFrames("deform", wanted, [&](std::int64_t number) -> Result<void> {
        DeformedFrame frame;
        frame.time = static_cast<double>(number) * deformed.schedule.step;
        frame.places = deformed.motion.placesAt(frame.time);
        frame.vertices = manipulation.deformed(frame.places);
        deformed.frames.push_back(std::move(frame));
        return {};
    }));
    return checkWhole(made, wanted);
}

// Widens the canvas for all that leaves the picture, and moves everything into it.
Result<void> place(Deformed& deformed) {
    const TriangulatedSilhouette& silhouette = deformed.silhouette;
    const glm::ivec2 size(silhouette.width, silhouette.height);
    Canvas& canvas = deformed.canvas;
    for (std::size_t i = 0; i < deformed.frames.size(); ++i) {
        glm::dvec2 least(0), most(size);
        for (const auto& ring : silhouette.outlineAt(deformed.frames[i].vertices).rings)
            for (const glm::dvec2 point : ring) least = glm::min(least, point), most = glm::max(most, point);
        for (int axis = 0; axis < 2; ++axis) {
            const auto beyond = [](double away) {
                return away > kOutside ? static_cast<int>(std::ceil(std::min(away, 1e6))) + kMargin : 0;
            };
            canvas.leftTop[axis] = std::max(canvas.leftTop[axis], beyond(-least[axis]));
            canvas.rightBottom[axis] = std::max(canvas.rightBottom[axis], beyond(most[axis] - size[axis]));
        }
        canvas.size = size + canvas.leftTop + canvas.rightBottom;
        if (auto fits = theatre::PoseTarget::checkSize(canvas.size.x, canvas.size.y); !fits)
            return fits.error().in(
                fmt::format("{}: frame {} ({:.2f} s) leaves the picture, and it cannot be widened so far; move the "
                            "handles less far",
                            deformed.options.motion.string(), i + 1, deformed.frames[i].time));
    }
    const glm::dvec2 shift(canvas.leftTop);
    const auto moved = [&](DeformedFrame& frame) {
        // In steps of a power of ten, whose digits are few.
        for (glm::dvec2& vertex : frame.vertices) vertex = glm::round((vertex + shift) / kRounding) / (1 / kRounding);
        for (glm::dvec2& place : frame.places) place += shift;
    };
    for (DeformedFrame& frame : deformed.frames) moved(frame);
    moved(deformed.rest);
    return {};
}

// The handles that most of the triangles are nearest to, no more than three.
std::vector<std::string> handlesAt(const Deformed& deformed, const std::vector<std::size_t>& triangles) {
    std::map<std::size_t, std::size_t> counts;
    const FlatMesh& rest = deformed.silhouette.rest;
    for (const std::size_t i : triangles) {
        const glm::dvec2 middle =
            (rest.vertices[rest.triangles[i].x] + rest.vertices[rest.triangles[i].y] + rest.vertices[rest.triangles[i].z]) / 3.0;
        const auto& handles = deformed.motion.handles;
        const auto nearest = std::min_element(handles.begin(), handles.end(), [&](const auto& a, const auto& b) {
            return glm::distance(a.at, middle) < glm::distance(b.at, middle);
        });
        ++counts[static_cast<std::size_t>(nearest - handles.begin())];
    }
    std::vector<std::pair<std::size_t, std::size_t>> sorted(counts.begin(), counts.end());
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    std::vector<std::string> names;
    constexpr std::size_t kMost = 3;
    for (std::size_t i = 0; i < std::min(kMost, sorted.size()); ++i)
        names.push_back(deformed.motion.handles[sorted[i].first].name);
    return names;
}

void findFolds(Deformed& deformed) {
    for (std::size_t i = 0; i < deformed.frames.size(); ++i) {
        const std::vector<std::size_t> folded = theatre::foldedTriangles(deformed.silhouette.rest, deformed.frames[i].vertices);
        if (folded.empty()) continue;
        const std::vector<std::string> handles = handlesAt(deformed, folded);
        if (deformed.folds.empty() || deformed.folds.back().last + 1 != i) deformed.folds.push_back({i, i, 0, {}});
        Deformed::Fold& fold = deformed.folds.back();
        fold.last = i;
        if (folded.size() > fold.most) fold.most = folded.size(), fold.handles = handles;
    }
}

// The best that can be done is written all the same: a fold may lie where nobody sees it.
void warn(const Deformed& deformed) {
    for (const Deformed::Fold& fold : deformed.folds) {
        const auto timeOf = [&](std::size_t frame) { return deformed.frames[frame].time; };
        const std::string when = fold.first == fold.last ? fmt::format("frame {} ({:.2f} s)", fold.first + 1, timeOf(fold.first))
                                                         : fmt::format("frames {} to {} ({:.2f} to {:.2f} s)", fold.first + 1,
                                                                       fold.last + 1, timeOf(fold.first), timeOf(fold.last));
        fmt::print(stderr,
                   "deform: warning: {}: up to {} of {} triangles fold over, at '{}'; move what is there less far, or give the "
                   "place another handle\n",
                   when, fold.most, deformed.silhouette.rest.triangles.size(), fmt::join(fold.handles, "', '"));
    }
}

// From the first file to the last Ctrl-C is heard by makeFrames alone: it ends the drawing, and all
// is removed, or comes too late and all is there.
Result<void> write(const Deformed& deformed) {
    const Options& options = deformed.options;
    const glm::ivec2 size = deformed.canvas.size;
    std::unique_ptr<SequenceFolder> folder;
    std::unique_ptr<VideoWriter> video;
    theatre::SilhouetteSequence sequence{{}, deformed.schedule.frameRate, deformed.motion.loops, {}};
    sequence.interior = {deformed.silhouette.rest.triangles, {}};
    const std::int64_t wanted = deformed.schedule.frames;
    const auto open = [&]() -> Result<void> {
        folder = TRY(SequenceFolder::open(options.output));
        if (options.video) video = TRY(VideoWriter::open(*options.video, size, deformed.schedule.frameRate, VideoKind::Film));
        return {};
    };
    const auto draw = [&](std::int64_t number) -> Result<void> {
        const DeformedFrame& frame = deformed.frames[static_cast<std::size_t>(number)];
        const GreyImage picture = pictureOf(deformed.silhouette, frame, size);
        sequence.pictures.push_back(folder->frame(number));
        sequence.interior->vertices.push_back(frame.vertices);
        TRY(writePng(sequence.pictures.back(), picture));
        if (video) TRY(video->write(opaque(picture), number));
        return {};
    };
    const auto finish = [&]() -> Result<void> {
        TRY(folder->finish(sequence));
        if (options.sheet)
            TRY(writePng(*options.sheet,
                         motionSheet(deformed.silhouette, deformed.motion, deformed.rest, deformed.frames, size)));
        if (video) TRY(video->finish());
        return {};
    };
    const std::int64_t made = TRY(makeFrames("draw", wanted, [&](std::int64_t number) -> Result<void> {
        if (number == 0) TRY(open());
        TRY(draw(number));
        if (number + 1 == wanted) TRY(finish());
        return {};
    }));
    return checkWhole(made, wanted);
}

// Of each frame.
std::vector<double> leastOverlaps(const Deformed& deformed) {
    const double scale = kLookRows / double(deformed.canvas.size.y);
    std::vector<theatre::BitMask> looks;
    for (DeformedFrame frame : deformed.frames) {
        for (glm::dvec2& vertex : frame.vertices) vertex *= scale;
        looks.push_back(theatre::filled(static_cast<int>(std::ceil(scale * deformed.canvas.size.x)), kLookRows,
                                        deformed.silhouette.rest.triangles, frame.vertices));
    }
    return theatre::leastOverlaps(looks);
}

Report reportOf(const Deformed& deformed, const GreyImage& source, double seconds) {
    const GreyImage rest =
        drawn(deformed.silhouette.outlineAt(deformed.silhouette.rest.vertices), source.width(), source.height());
    std::size_t both = 0, either = 0;
    for (std::size_t i = 0; i < source.pixels().size(); ++i) {
        const bool a = source.pixels()[i] > 0.5f, b = rest.pixels()[i] > 0.5f;
        both += a && b, either += a || b;
    }
    const auto areaOf = [&](const std::vector<glm::dvec2>& vertices) {
        double area = 0;
        for (const glm::uvec3& triangle : deformed.silhouette.rest.triangles)
            area += std::abs(theatre::doubleArea(triangle, vertices)) / 2;
        return area;
    };
    Report report;
    report["frames"] = deformed.frames.size();
    report["fps"] = deformed.schedule.frameRate;
    report["loops"] = deformed.motion.loops;
    report["size"] = {deformed.canvas.size.x, deformed.canvas.size.y};
    report["widened"] = {deformed.canvas.leftTop.x, deformed.canvas.leftTop.y, deformed.canvas.rightBottom.x,
                         deformed.canvas.rightBottom.y};
    report["vertices"] = deformed.silhouette.rest.vertices.size();
    report["triangles"] = deformed.silhouette.rest.triangles.size();
    report["rest_iou"] = static_cast<double>(both) / static_cast<double>(either);
    const double areaAtRest = areaOf(deformed.rest.vertices);
    Report rows = Report::array();
    for (const DeformedFrame& frame : deformed.frames)
        rows.push_back({{"time", frame.time},
                        {"area", areaOf(frame.vertices) / areaAtRest},
                        {"folded", theatre::foldedTriangles(deformed.silhouette.rest, frame.vertices).size()}});
    report["middle_frame"] = theatre::middleFrame(leastOverlaps(deformed)) + 1;
    report["rows"] = std::move(rows);
    report["seconds"] = seconds;
    return report;
}

std::string brief(const Deformed& deformed) {
    const Canvas& canvas = deformed.canvas;
    std::string text = fmt::format("{}: {}, {} x {} pixels, {} triangles", deformed.options.output.string(),
                                   outcomeOf(deformed.schedule.frames, deformed.schedule.frames, deformed.schedule.frameRate),
                                   canvas.size.x, canvas.size.y, deformed.silhouette.rest.triangles.size());
    if (const std::vector<double> least = leastOverlaps(deformed); theatre::isOffTheMiddle(0, least))
        text += fmt::format("; frame {} is more like all the others than the first is: poses for it are likely to follow better",
                            theatre::middleFrame(least) + 1);
    if (canvas.isWider())
        text += fmt::format(
            "; all pictures are wider than the silhouette's by {} pixels on the left, {} at the top, {} on the right, {} at the "
            "bottom, since it leaves it",
            canvas.leftTop.x, canvas.leftTop.y, canvas.rightBottom.x, canvas.rightBottom.y);
    return text;
}

Result<void> run(const Options& options) {
    const SteadyClock clock;
    const Time start = clock.now();
    TRY(checkOutputs(options));
    const GreyImage picture = TRY(readDrawnSilhouette(options.silhouette, options.invert));
    TriangulatedSilhouette silhouette =
        TRY(TriangulatedSilhouette::of(picture, options.vertices).in(options.silhouette.string()));
    HandleMotion motion = TRY(theatre::readMotion(options.motion, silhouette));
    const Schedule schedule = TRY(scheduleOf(motion, options));
    Deformed deformed{options, std::move(silhouette), std::move(motion), schedule};
    TRY(deform(deformed));
    TRY(place(deformed));
    findFolds(deformed);
    TRY(write(deformed));
    if (options.report) TRY(writeReport(*options.report, reportOf(deformed, picture, seconds(clock.now() - start))));
    warn(deformed);
    fmt::print("{}\n", brief(deformed));
    return {};
}

}  // namespace

void addDeformCommand(Program& program) {
    addCommand<Options>(program, "deform", "Move a silhouette by its handles, as rigidly as can be, into a sequence of pictures",
                        declare, run);
}

}  // namespace fantascope::app
