#include "app/base/attendance.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/command/adapt_input.h"
#include "app/command/adapt_output.h"
#include "app/command/commands.h"

#include "theatre/motion/motion_cast.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::MotionAdaptation;

void declareSearch(Command& command, AdaptOptions& options) {
    command
        .add("--wanted", options.search.wanted,
             "Intersection over union of shadow and target: a frame that has it is not searched any further")
        .range(0.0, 1.0)
        .showDefault();
    command.add("--searches", options.search.searches, "Steps of local search, for a frame that has not")
        .range(0, 100'000)
        .showDefault();
    command.add("--passes", options.search.passes, "In which each frame is fitted between both its neighbours")
        .range(0, 100)
        .showDefault();
    command.add("--seed", options.seed, "Another seed, another motion; the same seed, the same motion")
        .range(std::uint64_t{0}, std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        .showDefault();
    command.add("--threads", options.search.threads, "How many to use; the motion is the same for any number").range(1, 256);
}

void declare(Command& command, AdaptOptions& options) {
    command.add("CAST", options.cast, "The principal poses, *.cast.yaml, as 'fantascope pose' finds them").required();
    command
        .add("SEQUENCE", options.sequence,
             "The silhouette that moves: a folder that 'fantascope deform' wrote, or one with a picture a frame, in the "
             "order of their names")
        .required();
    addOutOption(command, options.output, "The motion to write, M.cast.yaml. An interrupted one is resumed")
        .required()
        .check(onlyYaml("M.cast.yaml"));
    command
        .add("--representative", options.representative,
             "The frame that the poses are of, from 1 (default: the one most like the cast's target)")
        .positive();
    command
        .add("--fps", options.frameRate,
             "Frames a second, whatever the sequence says: the same frames, sooner or later (default: the sequence's; of a "
             "folder of pictures 12)")
        .range(1.0, 1000.0);
    declareSearch(command, options);
    command.add("--sheet", options.sheet, "Also draw people and shadow at moments of the motion, side by side")
        .check(onlyEnding(".png", "PNG"));
    command
        .add("--video", options.video,
             "Also write a video of people and shadow, H.264, with poses in between where there are fewer than 30 a second")
        .check(onlyEnding(".mp4", "MP4"));
    command.add("--report", options.report, "Also write figures, as JSON (docs/report.md)");
    command.footer(
        "Meanwhile the space bar pauses and goes on; escape, q and Ctrl-C end it with the frames that are done, and the same "
        "command goes on from there.");
}

std::vector<fs::path> outputsOf(const AdaptOptions& options) {
    std::vector<fs::path> files{options.output};
    for (const auto& file : {options.sheet, options.video, options.report})
        if (file) files.push_back(*file);
    return files;
}

// A motion that was interrupted is resumed, if it is of these poses and this sequence.
MotionAdaptation::Frames resumed(const Adapted& adapted) {
    std::error_code ignored;
    if (!fs::exists(adapted.options.output, ignored)) return {};
    const auto written = theatre::readCast(adapted.options.output);
    if (!written) return {};
    MotionAdaptation::Frames frames = theatre::resumedFrames(adapted.motion, adapted.principal, *written);
    if (!frames.empty())
        fmt::print(stderr, "adapt: goes on with {} of {} frames from {}\n", written->actors[0].poses.size(), frames.size(),
                   adapted.options.output.string());
    return frames;
}

void adapt(Adapted& adapted) {
    SteadyClock clock;
    Attendance attendance(clock);
    const WorkClock worked(clock, attendance);
    Progress progress("adapt", clock, std::cerr, standardErrorIsTerminal());
    const std::size_t all = adapted.motion.targets.size();
    const auto steps = static_cast<double>(all * (1 + static_cast<std::size_t>(adapted.options.search.passes)));
    const Time start = worked.now();
    adapted.seconds.assign(all, 0);
    MotionAdaptation::Frames known = resumed(adapted);
    double done =
        static_cast<double>(std::count_if(known.begin(), known.end(), [](const auto& frame) { return frame.has_value(); }));
    std::string last = "first frame";
    adapted.frames = MotionAdaptation::run(
        adapted.motion, adapted.principal, adapted.options.seed, adapted.options.search,
        {.tell =
             [&](std::size_t frame, const theatre::AdaptedFrame& found) {
                 adapted.seconds[frame] = seconds(worked.now() - start);
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

Result<void> run(const AdaptOptions& options) {
    const SteadyClock clock;
    const Time start = clock.now();
    for (const fs::path& file : outputsOf(options)) TRY(checkWritable(file));
    if (fs::weakly_canonical(fs::absolute(options.output)) == fs::weakly_canonical(fs::absolute(options.cast)))
        return Error(fmt::format("{}: is the principal poses' file, and would be overwritten; choose another name",
                                 options.output.string()));
    Adapted adapted = TRY(readMotion(options));
    warn(adapted);
    adapt(adapted);
    TRY(writeMotion(adapted));
    if (options.report) TRY(writeFigures(*options.report, adapted, seconds(clock.now() - start)));
    TRY(drawMotion(adapted));
    fmt::print("{}\n", brief(adapted));
    return {};
}

}  // namespace

void addAdaptCommand(Program& program) {
    addCommand<AdaptOptions>(program, "adapt", "Let poses follow a silhouette that moves", declare, run);
}

}  // namespace fantascope::app
