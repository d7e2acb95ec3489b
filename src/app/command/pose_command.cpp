#include "app/base/attendance.h"
#include "app/base/data_folder.h"
#include "app/base/progress.h"
#include "app/base/silhouette_file.h"
#include "app/command/commands.h"
#include "app/command/pose_options.h"
#include "app/command/pose_output.h"
#include "app/export/stage_material.h"

#include "theatre/energy/pose_hints.h"
#include "theatre/energy/weights_file.h"
#include "theatre/stage/stage_file.h"

#include <fmt/format.h>

#include <iostream>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::PoseRounds, theatre::PoseTarget, theatre::Troupe;

constexpr int kRows = 512;  // of the targets

Result<theatre::PoseWeights> weightsOf(const PoseOptions& options) {
    if (!options.weights) return theatre::PoseWeights{};
    if (fs::path(*options.weights).extension() == ".yaml") return theatre::readWeights(*options.weights);
    return theatre::readWeights(TRY(dataFolder()) / "assets/silhouettes/weights.yaml", *options.weights);
}

Result<double> areaOf(const std::vector<GreyImage>& silhouettes, const std::vector<fs::path>& files,
                      const theatre::Stage& stage) {
    std::vector<PoseTarget> targets;
    for (std::size_t i = 0; i < silhouettes.size(); ++i)
        targets.push_back(TRY(PoseTarget::from(silhouettes[i], {}, 1, kRows).in(files[i].string())));
    return theatre::areaToFill(targets, stage);
}

std::vector<theatre::Cast::Target> targetsOf(const PoseOptions& options, const theatre::Stage& stage, double height) {
    std::vector<theatre::Cast::Target> targets;
    for (const fs::path& file : options.targets()) {
        const std::size_t beam = targets.size();
        theatre::Cast::Target& target = targets.emplace_back(theatre::targetOn(stage, beam, height));
        target.file = file;
        if (beam > 0 && !options.furtherHeights.empty()) target.height = options.furtherHeights[beam - 1];
        if (beam > 0 && !options.furtherMiddles.empty()) target.middle = options.furtherMiddles[beam - 1];
    }
    return targets;
}

Result<std::vector<PoseTarget>> laidOut(const FoundPoses& found, const theatre::Stage& stage) {
    std::vector<PoseTarget> targets;
    for (std::size_t i = 0; i < found.targets.size(); ++i) {
        const auto& [file, height, middle] = found.targets[i];
        auto laid = PoseTarget::from(found.silhouettes[i], stage, height, kRows, {i, middle}).in(file.string());
        if (!laid && i > 0 && found.options.furtherMiddles.empty())
            return Error(laid.error().message() + "; --further-middle and --further-height lay it elsewhere");
        targets.push_back(TRY(std::move(laid)));
    }
    return targets;
}

std::string told(const theatre::TrialsProgress& now) {
    const std::string best = now.best
                                 ? fmt::format("best IoU {:.3f}{}", now.best->iou, now.best->isValid() ? "" : " (cannot be held)")
                                 : std::string("none finished");
    return fmt::format("trial {}  {}  energy {:.0f}{}", now.trial + 1, best, now.energy,
                       now.isPaused ? "  paused, space goes on" : "");
}

Result<PoseRounds> search(const PoseRounds::Task& task, const PoseRounds::Options& options, Clock& clock, Time start) {
    Attendance attendance(clock);
    std::optional<Progress> progress;  // of each round
    PoseRounds::Watch watch;
    watch.begins = [&] { progress.emplace("pose", clock, std::cerr, standardErrorIsTerminal()); };
    watch.tell = [&](const theatre::TrialsProgress& now) { progress->update(now.share, told(now)); };
    watch.goesOn = [&](const std::function<void()>& whilePaused) { return attendance.goesOn(whilePaused); };
    watch.notEnough = [&](const PoseRounds::Round& round) {
        progress.reset();
        const std::size_t actors = round.problem.actors.size();
        fmt::print(stderr, "pose: {} not enough (IoU {:.3f}{}); going on with one more\n",
                   actors == 1 ? "1 actor is" : fmt::format("{} actors are", actors), round.best().quality.iou,
                   round.best().quality.isValid() ? "" : ", cannot be held");
    };
    return PoseRounds::run(task, options, WorkClock(clock, attendance), start, watch);
}

Result<void> run(const PoseOptions& options) {
    SteadyClock clock;
    const Time start = clock.now();
    // Whatever can be refused is refused before the search begins.
    TRY(checkOutputs(options));
    std::vector<GreyImage> silhouettes;
    for (const fs::path& file : options.targets()) silhouettes.push_back(TRY(readDrawnSilhouette(file, options.invert)));
    std::optional<theatre::Stage> given;
    if (options.stage) {
        given = TRY(theatre::readStage(*options.stage));
        TRY(checkStageCanGo(*options.stage, *given, options.output));
    }
    const theatre::Stage stage = given.value_or(theatre::Stage{});
    TRY(checkFurther(options, stage.beams.size() - 1));
    const double area = TRY(areaOf(silhouettes, options.targets(), stage));
    const Troupe troupe = TRY(Troupe::of(area, options.actors, options.height, options.statures));
    FoundPoses found{options, std::move(silhouettes), std::move(given), targetsOf(options, stage, troupe.height), {}};
    const std::vector<PoseTarget> targets = TRY(laidOut(found, stage));
    const theatre::PoseWeights weights = TRY(weightsOf(options));
    std::vector<theatre::PoseHint> hints;
    if (options.hints) hints = TRY(theatre::readHints(*options.hints, targets[0], stage));
    PoseRounds::Options rounds = options.search;
    rounds.mostMore = options.actors ? 0 : PoseRounds::kMostMore;
    found.rounds = TRY(search({stage, targets, weights, hints, area, troupe, options.statures}, rounds, clock, start));
    TRY(writeAll(found));
    fmt::print("{}\n", brief(found));
    return {};
}

}  // namespace

void addPoseCommand(Program& program) {
    addCommand<PoseOptions>(program, "pose", "Find poses of people whose shadow is a silhouette", declarePose, run);
}

}  // namespace fantascope::app
