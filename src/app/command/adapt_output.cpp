#include "app/command/adapt_output.h"

#include "app/base/contact_sheet.h"
#include "app/base/frame_run.h"
#include "app/base/output.h"
#include "app/base/report.h"
#include "app/base/video_writer.h"
#include "app/export/stage_material.h"

#include "theatre/motion/motion_cast.h"
#include "theatre/motion/pose_spline.h"

#include "plot/cast_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::SilhouetteSequence;
using Quality = theatre::PoseSearch::Quality;

constexpr glm::ivec2 kVideo{960, 540}, kCell{480, 270};
constexpr std::size_t kMostCells = 12;
constexpr double kLeastRate = 30;  // of the video, Hz

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

// People and their shadow, against a frame's silhouette.
RgbaImage pictureOf(const Adapted& adapted, std::size_t frame, std::span<const double> dofs, glm::ivec2 size) {
    theatre::PoseProblem problem = adapted.motion.principal;
    problem.targets[0] = adapted.motion.targets[frame];
    const plot::CastPicture picture = plot::castPicture(problem, dofs);
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
        std::vector<double> dofs;
        for (theatre::PoseSpline& spline : splines) {
            const std::vector<double>& his = spline.at(frame);
            dofs.insert(dofs.end(), his.begin(), his.end());
        }
        const std::size_t nearest = there[static_cast<std::size_t>(std::lround(frame)) % there.size()];
        return video->write(pictureOf(adapted, nearest, dofs, kVideo), number);
    }));
    if (made == 0) return {};
    return video->finish();
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

}  // namespace

Result<void> writeMotion(const Adapted& adapted) {
    const std::vector<std::size_t> there = playedFrames(adapted.motion, adapted.frames);
    theatre::Cast cast = adapted.cast;
    const fs::path sequence = TRY(placeSequence(adapted));
    cast.sequence = {sequence, adapted.motion.representative, there.front()};
    cast.framesPerSecond = adapted.sequence.framesPerSecond;
    cast.seed = adapted.options.seed;
    const fs::path folder = fs::absolute(adapted.options.output).parent_path();
    const Material target =
        materialFor(adapted.options.output, cast.targets[0].file, "target" + cast.targets[0].file.extension().string());
    TRY(copyTo(folder, target));
    cast.targets[0].file = folder / target.name;
    if (cast.stageFile) cast.stageFile = TRY(placeStage(*cast.stageFile, cast.stage, adapted.options.output));
    for (std::size_t a = 0; a < cast.actors.size(); ++a) {
        cast.actors[a].poses.clear();
        for (const std::size_t frame : there) cast.actors[a].poses.push_back(adapted.frames[frame]->poses[a]);
    }
    return theatre::writeCast(adapted.options.output, cast);
}

Result<void> drawMotion(const Adapted& adapted) {
    const AdaptOptions& options = adapted.options;
    const std::vector<std::size_t> there = playedFrames(adapted.motion, adapted.frames);
    if (options.sheet) {
        std::vector<LabelledPicture> cells;
        const std::size_t count = std::min(kMostCells, there.size());
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t i = there[count == 1 ? 0 : k * (there.size() - 1) / (count - 1)];
            cells.push_back({fmt::format("frame {}, IoU {:.3f}", i + 1, adapted.frames[i]->quality.iou),
                             pictureOf(adapted, i, adapted.frames[i]->dofs, kCell)});
        }
        TRY(writePng(*options.sheet, contactSheet(cells, 3)));
    }
    if (options.video) TRY(film(adapted, there, *options.video));
    return {};
}

Result<void> writeFigures(const fs::path& file, const Adapted& adapted, double seconds) {
    return writeReport(file, reportOf(adapted, seconds));
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

}  // namespace fantascope::app
