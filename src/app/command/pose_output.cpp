#include "app/command/pose_output.h"

#include "app/base/output.h"
#include "app/base/report.h"
#include "app/export/stage_material.h"
#include "app/export/stage_meshes.h"

#include "theatre/search/solution_choice.h"

#include "plot/cast_figures.h"
#include "plot/cast_picture.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <span>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::PoseProblem, theatre::PoseSearch, theatre::PoseTrials;

// The files of the targets are placed with the cast.
theatre::Cast castOf(const FoundPoses& found, std::span<const double> dofs) {
    theatre::Cast cast{found.targets, found.problem().stage, {}, 0, found.options.search.seed, {}};
    for (const theatre::Body& body : found.problem().actors) {
        cast.actors.push_back({body.stature, {theatre::poseOf(body, dofs.first(body.dofs))}});
        dofs = dofs.subspan(body.dofs);
    }
    return cast;
}

// The picture of a beam's silhouette, white on black, as a cast in `folder` names it: the target
// itself where it lies in the folder of `output`, else a picture that is made beside it.
Result<fs::path> placeTarget(const FoundPoses& found, const fs::path& folder, const fs::path& output, std::size_t beam) {
    if (found.options.invert) {
        const fs::path file = folder / invertedName(output, beam);
        TRY(writePng(file, found.silhouettes[beam]));
        return file;
    }
    const fs::path& target = found.targets[beam].file;
    const Material material = materialFor(output, target, "target" + numbered(beam) + target.extension().string());
    TRY(copyTo(folder, material));
    return folder / material.name;
}

// What it names first, so that the cast never names what is not there.
Result<void> writeCastWithMaterial(const FoundPoses& found, std::span<const double> dofs, const fs::path& file,
                                   const fs::path& output) {
    const fs::path folder = fs::absolute(file).parent_path();
    theatre::Cast cast = castOf(found, dofs);
    for (std::size_t i = 0; i < cast.targets.size(); ++i) cast.targets[i].file = TRY(placeTarget(found, folder, output, i));
    if (found.options.stage) cast.stageFile = TRY(placeStage(*found.options.stage, *found.stage, output));
    return theatre::writeCast(file, cast);
}

Result<void> drawPictures(const FoundPoses& found) {
    const PoseOptions& options = found.options;
    if (!options.image && !options.view && !options.each) return {};
    const plot::CastPicture picture = plot::castPicture(found.problem(), found.best().dofs);
    if (options.image) TRY(picture.shadows().write(*options.image));
    if (options.view) TRY(plot::stageFigure(picture.view, picture.view.overview(plot::kStageAspect)).write(*options.view));
    if (options.each) TRY(picture.each().write(*options.each));
    return {};
}

std::vector<theatre::PlacedActor> placed(const PoseProblem& problem, std::span<const double> dofs) {
    std::vector<theatre::PlacedActor> actors;
    theatre::PosedBody posed;
    for (const theatre::Body& body : problem.actors) {
        posed.pose(body, dofs.first(body.dofs));
        dofs = dofs.subspan(body.dofs);
        actors.push_back({body.stature, {}});
        for (std::size_t i = 0; i < body.joints.size(); ++i) actors.back().joints.push_back(posed.place(i));
    }
    return actors;
}

Result<void> writeSolutions(const FoundPoses& found) {
    const PoseProblem& problem = found.problem();
    const fs::path& folder = *found.options.solutions;
    const std::vector<const PoseTrials::Trial*> accepted = found.trials().accepted();
    std::vector<std::vector<theatre::PlacedActor>> places;
    for (const PoseTrials::Trial* trial : accepted) places.push_back(placed(problem, trial->dofs));
    std::vector<plot::SolutionCell> cells;
    for (const std::size_t choice : theatre::mostDifferent(places, kMostSolutions)) {
        const PoseTrials::Trial& trial = *accepted[choice];
        const std::string file = fmt::format("solution-{}.cast.yaml", cells.size() + 1);
        TRY(writeCastWithMaterial(found, trial.dofs, folder / file, folder / "solutions.png"));
        plot::CastPicture picture = plot::castPicture(problem, trial.dofs);
        const plot::Camera camera = picture.view.closeUp(double(plot::kCellView.x) / plot::kCellView.y);
        // The first beam's shadow; the view shows all.
        plot::CastPicture::Image& image = picture.images[0];
        std::vector<std::string> lines{file};
        lines.insert(lines.end(), image.lines.begin(), image.lines.end());
        cells.push_back(
            {picture.view.draw(camera, plot::kCellView.x, plot::kCellView.y), std::move(image.actors), std::move(lines)});
    }
    return plot::solutionsFigure(cells, problem.targets[0].maskAsSeen()).write(folder / "solutions.png");
}

// The terms of equation 1, weighted: their sum is the total.
Report energyOf(const PoseProblem& problem, const PoseSearch::Quality& quality) {
    const theatre::EnergyTerms& terms = quality.terms;
    const theatre::PoseWeights& w = problem.weights;
    return {{"contour", terms.contour(w)},     {"coverage", w.w4 * terms.coverage}, {"coherence", w.w5 * terms.coherence},
            {"visible", w.w6 * terms.visible}, {"physics", terms.physics(w)},       {"hint", w.w12 * terms.hint},
            {"total", quality.energy}};
}

Report actorsOf(const PoseProblem& problem, const PoseTrials::Trial& best) {
    Report actors = Report::array();
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const PoseSearch::Actor& quality = best.quality.actors[i];
        Report points = Report::array();
        for (const glm::dvec2& contact : quality.contacts) points.push_back({contact.x, contact.y});
        actors.push_back({{"stature", problem.actors[i].stature},
                          {"margin", quality.margin},
                          {"lowest_point", quality.lowest},
                          {"contacts", points},
                          {"deepest_penetration", quality.deepest},
                          {"within_limits", quality.withinLimits}});
    }
    return actors;
}

Report beamsOf(const FoundPoses& found, const PoseTrials::Trial& best) {
    Report beams = Report::array();
    for (std::size_t i = 0; i < best.quality.matches.size(); ++i) {
        const PoseSearch::Quality::Match& match = best.quality.matches[i];
        beams.push_back({{"target", found.targets[i].file.string()},
                         {"height", found.targets[i].height},
                         {"iou", match.iou},
                         {"flat_iou", match.flatIou},
                         {"contour_mean_px", match.contourMean},
                         {"contour_max_px", match.contourMost}});
    }
    return beams;
}

// Of this process so far, megabytes.
double peakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

// Of each number of actors that was tried, in turn.
Report roundsOf(const FoundPoses& found) {
    Report rounds = Report::array();
    for (const theatre::PoseRounds::Round& round : found.rounds.rounds)
        rounds.push_back({{"actors", round.problem.actors.size()},
                          {"trials", round.trials.trials.size()},
                          {"iou", round.best().quality.iou},
                          {"valid", round.best().quality.isValid()}});
    return rounds;
}

// The trials, and what they spent.
void addTrials(Report& report, const FoundPoses& found) {
    std::int64_t evaluations = 0;
    double spent = 0;
    std::size_t satisfactory = 0;
    Report& trials = report["trials"] = Report::array();
    for (const PoseTrials::Trial& trial : found.trials().trials) {
        trials.push_back({{"number", trial.number + 1},
                          {"seed", trial.seed},
                          {"iou", trial.quality.iou},
                          {"valid", trial.quality.isValid()},
                          {"energy", trial.quality.energy},
                          {"evaluations", trial.evaluations},
                          {"seconds", trial.seconds},
                          {"finished", trial.isFinished()}});
        evaluations += trial.evaluations;
        spent += trial.seconds;
        satisfactory += trial.isSatisfactory() ? 1 : 0;
    }
    const auto count = static_cast<double>(found.trials().trials.size());
    report["best_trial"] = found.best().number + 1;
    report["finished_trials"] = found.trials().finished;
    report["satisfactory_share"] = static_cast<double>(satisfactory) / count;
    // Without a satisfactory one nobody knows: infinite, which is written as null.
    report["expected_trials"] = count / static_cast<double>(satisfactory);
    report["seconds_per_trial"] = spent / count;
    report["evaluations"] = evaluations;
    report["evaluations_per_trial"] = found.round().evaluationsPerTrial;
    report["seconds"] = found.trials().seconds;
    report["peak_memory_mb"] = peakMemory();
    report["stop_reason"] = name(found.trials().reason);
    report["seed"] = found.options.search.seed;
}

Report reportOf(const FoundPoses& found) {
    const PoseTrials::Trial& best = found.best();
    Report report;
    report["iou"] = best.quality.iou;
    report["iou_without_props"] = best.quality.iouWithoutProps;
    report["props_cover"] = best.quality.propsCover;
    report["valid"] = best.quality.isValid();
    report["contour_mean_px"] = best.quality.contourMean;
    report["contour_max_px"] = best.quality.contourMost;
    report["beams"] = beamsOf(found, best);
    report["energy"] = energyOf(found.problem(), best.quality);
    report["method"] = name(found.options.search.search.method);
    report["height"] = found.targets[0].height;
    report["rounds"] = roundsOf(found);
    report["actors"] = actorsOf(found.problem(), best);
    addTrials(report, found);
    return report;
}

}  // namespace

Result<void> writeAll(const FoundPoses& found) {
    const PoseOptions& options = found.options;
    TRY(writeCastWithMaterial(found, found.best().dofs, options.output, options.output));
    TRY(drawPictures(found));
    if (options.solutions) TRY(writeSolutions(found));
    if (options.meshes) TRY(writeStageMeshes(*options.meshes, found.problem(), found.best().dofs));
    if (options.report) TRY(writeReport(*options.report, reportOf(found)));
    return {};
}

std::string brief(const FoundPoses& found) {
    const PoseTrials::Trial& best = found.best();
    const std::size_t finished = found.trials().finished, actors = found.problem().actors.size();
    std::string each;
    if (best.quality.matches.size() > 1)
        for (const PoseSearch::Quality::Match& match : best.quality.matches)
            each += fmt::format("{}{:.3f}", each.empty() ? " (" : ", ", match.iou);
    if (!each.empty()) each += " on its screens)";
    std::string text = fmt::format("{}: IoU {:.3f}{}, {} actor{}, {} m high", found.options.output.string(), best.quality.iou,
                                   each, actors, actors == 1 ? "" : "s", found.targets[0].height);
    if (finished > 0)
        text += fmt::format(", the best of {} trial{}", finished, finished == 1 ? "" : "s");
    else
        text += fmt::format(", reached in an unfinished search after {:.0f} s; more --seconds may improve it",
                            found.trials().seconds);
    if (best.quality.propsCover > 0)
        text += fmt::format("; the people's shadow alone {:.3f}, and platforms and props cover {:.0f} % of the target",
                            best.quality.iouWithoutProps, 100 * best.quality.propsCover);
    if (!best.quality.isValid())
        text += fmt::format("; nobody can hold these poses{}", finished > 0 ? ": more --trials or other --actors may help" : "");
    return text;
}

}  // namespace fantascope::app
