#include "app/command/pose_command.h"

#include "app/base/data_folder.h"
#include "app/base/drawing.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/base/silhouette_file.h"
#include "app/command/pose_trials.h"
#include "app/export/stage_material.h"
#include "app/export/stage_meshes.h"

#include "theatre/energy/pose_hints.h"
#include "theatre/energy/weights_file.h"
#include "theatre/search/solution_choice.h"
#include "theatre/search/troupe.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/stage_file.h"

#include "core/file.h"
#include "core/parallel.h"
#include "plot/cast_figures.h"
#include "plot/cast_picture.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::PoseProblem, theatre::PoseSearch, theatre::PoseTarget, theatre::Troupe;

constexpr double kDefaultSeconds = 20;
constexpr int kFewActors = 3;  // up to so many, for one target, a trial is shorter
constexpr std::int64_t kEvaluationsOfFew = 40'000, kEvaluationsOfMany = 80'000;
constexpr int kRows = 512;    // of the target
constexpr int kMostMore = 2;  // actors that come in where those asked for by the silhouette's size do not satisfy
constexpr std::size_t kMostSolutions = 8;
constexpr double kFarthest = 100;       // metres
constexpr double kNearlyAsGood = 0.02;  // of intersection over union: what somebody may still prefer for another reason

struct Options {
    fs::path target, output;
    std::optional<int> actors;  // none: auto
    std::optional<double> height;
    std::vector<double> statures{Troupe::kStature};
    std::optional<int> trials;
    std::optional<double> seconds;
    std::optional<std::int64_t> evaluations;
    std::uint64_t seed = 1;
    int threads = hardwareThreads();
    PoseSearch::Options search;
    std::optional<fs::path> hints, stage;
    bool invert = false;
    std::vector<fs::path> furtherTargets;
    std::vector<double> furtherHeights, furtherMiddles;
    std::optional<std::string> weights;  // a preset's name, or a file
    std::optional<fs::path> image, view, each, solutions, meshes, report;

    const fs::path& targetOf(std::size_t beam) const { return beam == 0 ? target : furtherTargets[beam - 1]; }
};

std::string onlyPicture(const std::string& file) {
    return plot::Page::knows(file) ? ""
                                   : fmt::format("'{}' is no picture that can be written: its name ends in .png or .svg", file);
}

void declare(CLI::App& command, Options& options) {
    command.add_option("TARGET", options.target, "The silhouette, white on black: PNG or JPEG")->required();
    addOutOption(command, options.output, "The poses to write, C.cast.yaml")->required()->check(onlyYaml("C.cast.yaml"));
    command
        .add_option_function<std::string>(
            "--actors",
            [&options](const std::string& given) {
                int count = 0;
                if (given == "auto") return;
                if (!CLI::detail::lexical_cast(given, count))
                    throw CLI::ValidationError("--actors", fmt::format("'{}' is neither a number nor 'auto'", given));
                options.actors = count;
            },
            fmt::format("How many, 1 .. {}; auto: by the silhouette's area, 1 .. {}, and up to {} more if they are not enough",
                        Troupe::kMostActors, Troupe::kMostUnasked, kMostMore))
        ->default_str("auto")
        ->type_name("N|auto");
    command.add_option("--height", options.height,
                       fmt::format("Of the silhouette on the screen, metres (default: so that each actor has some {} square "
                                   "metres of it; {} where --actors is auto)",
                                   Troupe::kShare, Troupe::kUsualHeight));
    command.add_option("--stature", options.statures, "Of the actors, metres: one for all, or one for each, separated by commas")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(0.9, 2.1))
        ->capture_default_str();
    command.add_flag("--invert", options.invert, "The silhouettes are black ink on white paper");
    command.add_option("--hints", options.hints,
                       "Which body parts may come to which points of the target, *.hints.yaml (docs/hints-format.md)");
    command.add_option("--weights", options.weights,
                       "Of the energy's terms: a preset of assets/silhouettes/weights.yaml, such as rabbit, or a file "
                       "(docs/weights-format.md)");
    command.add_option("--stage", options.stage,
                       "Light or projector, platforms and props, *.stage.yaml (docs/stage-format.md); default: a lamp on the "
                       "floor, 7 m before the screen");
    command
        .add_option("--further-target", options.furtherTargets,
                    "The silhouettes for the stage's further beams, other lights or screens, in their order, separated by commas")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        .add_option("--further-height", options.furtherHeights,
                    "Of each of them, metres (default: people are as high as on the first screen)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(Troupe::kLeastHeight, Troupe::kMostHeight));
    command
        .add_option(
            "--further-middle", options.furtherMiddles,
            "Where on its screen the middle of each is: metres to the right of where the screen stands (default: where the "
            "shadow falls of people who stand before the first light)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(-kFarthest, kFarthest));
    command.add_option("--trials", options.trials, "Searches to take the best of (default: as many as fit into the time)")
        ->check(CLI::Range(1, 1'000'000));
    command
        .add_option("--seconds", options.seconds,
                    fmt::format("End after so long (default {} s, unless --trials is given)", kDefaultSeconds))
        ->check(CLI::Range(0.0, 1e6));
    command.add_option("--evaluations", options.evaluations,
                       fmt::format("Of the energy, in a trial (default {}, and {} for more than {} actors or targets than one; "
                                   "fewer where the time is short)",
                                   kEvaluationsOfFew, kEvaluationsOfMany, kFewActors));
    addChoice<PoseSearch::Method>(command, "--method", options.search.method,
                                  {{"refined", PoseSearch::Method::Refined}, {"paper", PoseSearch::Method::Paper}},
                                  "refined, or paper: CMA-ES as Won & Lee 2016 have it, with their refinement")
        ->default_str("refined");
    command
        .add_option("--residual", options.search.residual,
                    "The paper's method: the energy that needs no refinement unless artefacts are seen")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command.add_flag("--full-covariance", options.search.fullCovariance,
                     "The paper's method: one covariance for all actors' freedoms, as in the paper; slower");
    command.add_option("--seed", options.seed, "Another seed, other poses; the same seed and trials, the same poses")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{std::numeric_limits<std::int64_t>::max()}))
        ->capture_default_str();
    command.add_option("--threads", options.threads, "How many to use; the poses are the same for any number")
        ->check(CLI::Range(1, 256));
    const CLI::Validator picture(onlyPicture, "PNG|SVG");
    command.add_option("--image", options.image, "Also draw the shadow, in the colours of who throws it")->check(picture);
    command.add_option("--view", options.view, "Also draw the stage with its people, as an outsider would see it")
        ->check(picture);
    command.add_option("--each", options.each, "Also draw each actor's shadow alone, and say how they stand")->check(picture);
    command.add_option("--solutions", options.solutions,
                       fmt::format("A folder for up to {} good solutions that differ most: solutions.png to choose from, and "
                                   "each as a cast",
                                   kMostSolutions));
    command.add_option("--meshes", options.meshes,
                       "A folder for the actors as Wavefront OBJ, and stage.json with light and screen: for other programs");
    command.add_option("--report", options.report, "Also write figures, as JSON");
    command.footer("While it searches, the space bar pauses and goes on; escape, q and Ctrl-C end it with the best so far.");
}

// "", or "-2" for the second beam's.
std::string numbered(std::size_t beam) { return beam == 0 ? "" : fmt::format("-{}", beam + 1); }
// What a silhouette that was turned over is called beside an output: P.inverted.png beside
// P.cast.yaml.
std::string invertedName(const fs::path& output, std::size_t beam) {
    return output.stem().stem().string() + ".inverted" + numbered(beam) + ".png";
}

// All that the options ask to be written.
std::vector<fs::path> outputsOf(const Options& options) {
    std::vector<fs::path> files{options.output};
    for (const auto& file : {options.image, options.view, options.each, options.report})
        if (file) files.push_back(*file);
    if (options.solutions) files.push_back(*options.solutions / "solutions.png");
    if (options.meshes) files.push_back(*options.meshes / "stage.json");
    if (options.invert)
        for (std::size_t i = 0; i <= options.furtherTargets.size(); ++i)
            files.push_back(fs::absolute(options.output).parent_path() / invertedName(options.output, i));
    return files;
}

Result<void> checkOutputs(const Options& options) {
    for (const fs::path& file : outputsOf(options)) {
        TRY(checkWritable(file));
        for (std::size_t i = 0; i <= options.furtherTargets.size(); ++i)
            if (fs::weakly_canonical(file) == fs::weakly_canonical(options.targetOf(i)))
                return Error(fmt::format("{}: is the target, and would be overwritten; choose another name", file.string()));
    }
    return {};
}

// The trials of so many actors, and what they were given.
struct Round {
    PoseProblem problem;
    std::int64_t evaluationsPerTrial;
    PoseTrials trials;
    std::vector<std::size_t> bestFirst;

    const PoseTrials::Trial& best() const { return trials.trials[bestFirst[0]]; }
};

// Everything that a run leaves behind is made of this.
struct Found {
    const Options& options;
    const std::vector<GreyImage>& silhouettes;   // of each beam, white on black
    const std::optional<theatre::Stage>& stage;  // of options.stage
    double height;                               // of the first silhouette, metres
    std::vector<theatre::Cast::Target> further;  // what the further beams' are
    std::vector<Round> rounds{};                 // the best last

    const Round& round() const { return rounds.back(); }
    const PoseProblem& problem() const { return round().problem; }
    const PoseTrials& trials() const { return round().trials; }
    const PoseTrials::Trial& best() const { return round().best(); }
};

// The picture lies beside the file, or will.
theatre::Cast castOf(const Found& found, std::span<const double> freedoms, const fs::path& target) {
    theatre::Cast cast{target, found.height, found.problem().stage, {}, 0, found.options.seed, {}};
    for (const theatre::Body& body : found.problem().actors) {
        cast.actors.push_back({body.stature, {theatre::poseOf(body, freedoms.first(body.freedoms))}});
        freedoms = freedoms.subspan(body.freedoms);
    }
    return cast;
}

// The picture of a beam's silhouette, white on black, as a cast in `folder` names it: the target
// itself where it lies in the folder of `output`, else a picture that is made beside it.
Result<fs::path> placeTarget(const Found& found, const fs::path& folder, const fs::path& output, std::size_t beam) {
    if (found.options.invert) {
        const fs::path file = folder / invertedName(output, beam);
        TRY(writePng(file, found.silhouettes[beam]));
        return file;
    }
    const fs::path& target = found.options.targetOf(beam);
    const Material material = materialFor(output, target, "target" + numbered(beam) + target.extension().string());
    TRY(copyTo(folder, material));
    return folder / material.name;
}

// What it names first, so that the cast never names what is not there.
Result<void> writeCastWithMaterial(const Found& found, std::span<const double> freedoms, const fs::path& file,
                                   const fs::path& output) {
    const fs::path folder = fs::absolute(file).parent_path();
    theatre::Cast cast = castOf(found, freedoms, TRY(placeTarget(found, folder, output, 0)));
    cast.further = found.further;
    for (std::size_t i = 0; i < cast.further.size(); ++i) cast.further[i].file = TRY(placeTarget(found, folder, output, i + 1));
    if (found.options.stage) cast.stageFile = TRY(placeStage(*found.options.stage, *found.stage, output));
    return theatre::writeCast(file, cast);
}

Result<void> drawPictures(const Found& found) {
    const Options& options = found.options;
    if (!options.image && !options.view && !options.each) return {};
    const plot::CastPicture picture = plot::castPicture(found.problem(), found.best().freedoms);
    if (options.image) TRY(picture.shadows().write(*options.image));
    if (options.view) TRY(plot::stageFigure(picture.view, picture.view.overview(plot::kStageAspect)).write(*options.view));
    if (options.each) TRY(picture.each().write(*options.each));
    return {};
}

std::vector<theatre::PlacedActor> placed(const PoseProblem& problem, std::span<const double> freedoms) {
    std::vector<theatre::PlacedActor> actors;
    theatre::PosedBody posed;
    for (const theatre::Body& body : problem.actors) {
        posed.pose(body, freedoms.first(body.freedoms));
        freedoms = freedoms.subspan(body.freedoms);
        actors.push_back({body.stature, {}});
        for (std::size_t i = 0; i < body.joints.size(); ++i) actors.back().joints.push_back(posed.place(i));
    }
    return actors;
}

// What somebody may choose from: the best, and all that are held and nearly as good, or good enough
// for anybody.
std::vector<const PoseTrials::Trial*> acceptedOf(const Found& found) {
    std::vector<const PoseTrials::Trial*> accepted;
    for (const std::size_t i : found.round().bestFirst) {
        const PoseTrials::Trial& trial = found.trials().trials[i];
        const bool isGood =
            trial.isSatisfactory() || (trial.quality.isValid() && trial.quality.iou >= found.best().quality.iou - kNearlyAsGood);
        if (accepted.empty() || isGood) accepted.push_back(&trial);
    }
    return accepted;
}

Result<void> writeSolutions(const Found& found) {
    const PoseProblem& problem = found.problem();
    const fs::path& folder = *found.options.solutions;
    const std::vector<const PoseTrials::Trial*> accepted = acceptedOf(found);
    std::vector<std::vector<theatre::PlacedActor>> places;
    for (const PoseTrials::Trial* trial : accepted) places.push_back(placed(problem, trial->freedoms));
    std::vector<plot::SolutionCell> cells;
    for (const std::size_t choice : theatre::mostDifferent(places, kMostSolutions)) {
        const PoseTrials::Trial& trial = *accepted[choice];
        const std::string file = fmt::format("solution-{}.cast.yaml", cells.size() + 1);
        TRY(writeCastWithMaterial(found, trial.freedoms, folder / file, folder / "solutions.png"));
        plot::CastPicture picture = plot::castPicture(problem, trial.freedoms);
        const plot::Camera camera = picture.view.closeUp(double(plot::kCellView.x) / plot::kCellView.y);
        // The first beam's shadow; the view shows all.
        plot::CastPicture::Image& image = picture.images[0];
        std::vector<std::string> lines{file};
        lines.insert(lines.end(), image.lines.begin(), image.lines.end());
        cells.push_back(
            {picture.view.draw(camera, plot::kCellView.x, plot::kCellView.y), std::move(image.actors), std::move(lines)});
    }
    return plot::solutionsFigure(cells, problem.target.maskAsSeen()).write(folder / "solutions.png");
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

Report beamsOf(const Found& found, const PoseTrials::Trial& best) {
    Report beams = Report::array();
    for (std::size_t i = 0; i < best.quality.matches.size(); ++i) {
        const PoseSearch::Quality::Match& match = best.quality.matches[i];
        beams.push_back({{"target", found.options.targetOf(i).string()},
                         {"height", i == 0 ? found.height : found.further[i - 1].height},
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
Report roundsOf(const Found& found) {
    Report rounds = Report::array();
    for (const Round& round : found.rounds)
        rounds.push_back({{"actors", round.problem.actors.size()},
                          {"trials", round.trials.trials.size()},
                          {"iou", round.best().quality.iou},
                          {"valid", round.best().quality.isValid()}});
    return rounds;
}

Report reportOf(const Found& found) {
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
    report["method"] = name(found.options.search.method);
    report["height"] = found.height;
    report["rounds"] = roundsOf(found);
    report["actors"] = actorsOf(found.problem(), best);
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
    report["best_trial"] = best.number + 1;
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
    report["seed"] = found.options.seed;
    return report;
}

std::string brief(const Found& found) {
    const PoseTrials::Trial& best = found.best();
    const std::size_t finished = found.trials().finished, actors = found.problem().actors.size();
    std::string each;
    if (best.quality.matches.size() > 1)
        for (const PoseSearch::Quality::Match& match : best.quality.matches)
            each += fmt::format("{}{:.3f}", each.empty() ? " (" : ", ", match.iou);
    if (!each.empty()) each += " on its screens)";
    std::string text = fmt::format("{}: IoU {:.3f}{}, {} actor{}, {} m high", found.options.output.string(), best.quality.iou,
                                   each, actors, actors == 1 ? "" : "s", found.height);
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

Result<theatre::PoseWeights> weightsOf(const Options& options) {
    if (!options.weights) return theatre::PoseWeights{};
    if (fs::path(*options.weights).extension() == ".yaml") return theatre::readWeights(*options.weights);
    return theatre::readWeights(TRY(dataFolder()) / "assets/silhouettes/weights.yaml", *options.weights);
}

// As many evaluations of a trial as a thread finishes within the time, but no more than a trial
// needs. What is found so stands in the report, and --evaluations repeats it.
std::int64_t evaluationsWithin(double seconds, PoseSearch::Options options, const PoseProblem& problem, std::uint64_t seed,
                               const Clock& clock) {
    constexpr std::int64_t kProbe = 1500;
    constexpr double kSpare = 0.74;  // threads get in each other's way
    const std::int64_t enough = std::exchange(options.evaluations, kProbe);
    // What an evaluation takes is felt between the first time that the probe asks and the last; a
    // trial's beginning and end take theirs once.
    struct Look {
        std::int64_t evaluations = 0;
        Time at{};
    };
    std::optional<Look> first;
    Look last;
    const Time start = clock.now();
    PoseSearch::run(problem, seed, options, [&](const PoseSearch::Progress& now) {
        last = {now.evaluations, clock.now()};
        if (!first) first = last;
        return false;
    });
    const double took = fantascope::seconds(clock.now() - start), searching = fantascope::seconds(last.at - first->at);
    const double each = searching / static_cast<double>(std::max<std::int64_t>(1, last.evaluations - first->evaluations));
    const double fit = kSpare * (seconds - took - (took - searching)) / std::max(each, 1e-6);
    return static_cast<std::int64_t>(std::clamp(fit, 1000.0, static_cast<double>(enough)));
}

// Searches with these actors until `seconds` after the start, if there is such an end; with
// `isLast` false only half of what is left of them, unless something satisfies.
Result<Round> searchWith(const Options& options, PoseProblem problem, std::optional<double> seconds, bool isLast, Time start,
                         Clock& clock) {
    problem.dress();
    PoseTrials::Options trials{options.search, options.seed, options.trials, seconds, {}, options.threads};
    const bool isShort = problem.actors.size() <= std::size_t{kFewActors} && problem.beams() == 1;
    trials.search.evaluations = options.evaluations.value_or(isShort ? kEvaluationsOfFew : kEvaluationsOfMany);
    TRY(trials.search.check());
    if (seconds) {
        // All that came before counts.
        const auto left = [&] { return std::max(0.0, *seconds - fantascope::seconds(clock.now() - start)); };
        const double share = isLast ? 1 : 0.5;
        if (!options.evaluations)
            trials.search.evaluations = evaluationsWithin(share * left(), trials.search, problem, options.seed, clock);
        trials.seconds = left();
        if (!isLast) trials.patience = share * left();
    }
    Round round{std::move(problem), trials.search.evaluations, {}, {}};
    round.trials = PoseTrials::run(round.problem, trials, clock, std::cerr, standardErrorIsTerminal());
    round.bestFirst = round.trials.bestFirst();
    return round;
}

// Won & Lee 2016, section 4: the last resort is one more actor, and all begins anew.
Result<void> search(Found& found, double area, const Troupe& first, Time start, Clock& clock) {
    const Options& options = found.options;
    std::optional<double> seconds = options.seconds;
    if (!options.trials && !seconds) seconds = kDefaultSeconds;
    theatre::Stage stage = found.stage.value_or(theatre::Stage{});
    const PoseTarget target = TRY(PoseTarget::from(found.silhouettes[0], stage, first.height, kRows).in(options.target.string()));
    std::vector<PoseTarget> further;
    for (std::size_t i = 1; i < found.silhouettes.size(); ++i) {
        const auto& [file, height, middle] = found.further[i - 1];
        auto laid = PoseTarget::from(found.silhouettes[i], stage, height, kRows, {i, middle}).in(file.string());
        if (!laid && options.furtherMiddles.empty())
            return Error(laid.error().message() + "; --further-middle and --further-height lay it elsewhere");
        further.push_back(TRY(std::move(laid)));
    }
    const theatre::PoseWeights weights = TRY(weightsOf(options));
    std::vector<theatre::PoseHint> hints;
    if (options.hints) hints = TRY(theatre::readHints(*options.hints, target, stage));
    const int most = options.actors ? 0 : kMostMore;
    for (int more = 0; more <= most; ++more) {
        Result<Troupe> troupe = first;
        if (more > 0) troupe = Troupe::of(area, static_cast<int>(first.statures.size()) + more, first.height, options.statures);
        if (!troupe) break;  // they would have too little of it
        TRY(stage.checkHolders(troupe->statures.size()));
        PoseProblem problem{stage, target, {}, weights, {}, hints, {}, further};
        for (const double stature : troupe->statures) problem.actors.push_back(theatre::humanBody(stature));
        found.rounds.push_back(TRY(searchWith(options, std::move(problem), seconds, more == most, start, clock)));
        const Round& round = found.round();
        if (round.best().isSatisfactory() || round.trials.reason == PoseTrials::StopReason::Interrupted) break;
        if (more < most)
            fmt::print(stderr, "pose: {} not enough (IoU {:.3f}{}); going on with one more\n",
                       troupe->statures.size() == 1 ? "1 actor is" : fmt::format("{} actors are", troupe->statures.size()),
                       round.best().quality.iou, round.best().quality.isValid() ? "" : ", cannot be held");
    }
    const auto best = std::max_element(found.rounds.begin(), found.rounds.end(), [](const Round& a, const Round& b) {
        return isBetter(b.best().quality, a.best().quality);
    });
    std::rotate(best, best + 1, found.rounds.end());
    return {};
}

Result<void> checkFurther(const Options& options, std::size_t beams) {
    const std::size_t given = options.furtherTargets.size();
    const std::string names = options.stage ? options.stage->string() : "the stage without a --stage";
    if (given != beams)
        return Error(beams == 0
                         ? fmt::format("--further-target: {} has one light and one screen; give it further_beams "
                                       "(docs/stage-format.md), or leave the option out",
                                       names)
                         : fmt::format("--further-target: {} has {} further beam{} and so {} further target{}, {} {} given; name "
                                       "one for each, in their order, with commas between",
                                       names, beams, beams == 1 ? "" : "s", beams, beams == 1 ? "" : "s", given,
                                       given == 1 ? "is" : "are"));
    for (const auto& [option, count] : {std::pair("--further-height", options.furtherHeights.size()),
                                        std::pair("--further-middle", options.furtherMiddles.size())})
        if (count != 0 && count != given)
            return Error(fmt::format("{}: {} for {} further target{}; give one for each, or none", option, count, given,
                                     given == 1 ? "" : "s"));
    return {};
}

// People are as high on all screens: with the first target's height goes each other's.
theatre::Cast::Target furtherTarget(const Options& options, const theatre::Stage& stage, std::size_t beam, double height) {
    const theatre::TargetPlace place = theatre::TargetPlace::on(stage, beam);
    theatre::Cast::Target target{options.targetOf(beam), 0, 0};
    const auto inCentimetres = [](double metres) { return std::round(100 * metres) / 100; };
    target.height = options.furtherHeights.empty()
                        ? std::clamp(inCentimetres(height * place.scale), Troupe::kLeastHeight, Troupe::kMostHeight)
                        : options.furtherHeights[beam - 1];
    target.middle = options.furtherMiddles.empty() ? inCentimetres(place.middle.value_or(stage.lightOnScreen(beam).x))
                                                   : options.furtherMiddles[beam - 1];
    return target;
}

Result<void> run(const Options& options) {
    SteadyClock clock;
    const Time start = clock.now();
    // Whatever can be refused is refused before the search begins.
    TRY(checkOutputs(options));
    std::vector<GreyImage> silhouettes;
    for (std::size_t i = 0; i <= options.furtherTargets.size(); ++i)
        silhouettes.push_back(TRY(readDrawnSilhouette(options.targetOf(i), options.invert)));
    std::optional<theatre::Stage> stage;
    if (options.stage) {
        stage = TRY(theatre::readStage(*options.stage));
        TRY(checkStageCanGo(*options.stage, *stage, options.output));
    }
    TRY(checkFurther(options, stage ? stage->further.size() : 0));
    // What people have to fill, in squares of the first silhouette's height, wherever the light is:
    // on average over the beams.
    double area = 0;
    for (std::size_t i = 0; i < silhouettes.size(); ++i) {
        const PoseTarget target = TRY(PoseTarget::from(silhouettes[i], {}, 1, kRows).in(options.targetOf(i).string()));
        const double scale = i == 0 ? 1 : theatre::TargetPlace::on(*stage, i).scale;
        area += scale * scale * target.area / (kRows * kRows) / static_cast<double>(silhouettes.size());
    }
    const Troupe troupe = TRY(Troupe::of(area, options.actors, options.height, options.statures));
    Found found{options, silhouettes, stage, troupe.height, {}};
    for (std::size_t i = 1; i < silhouettes.size(); ++i)
        found.further.push_back(furtherTarget(options, *stage, i, troupe.height));
    TRY(search(found, area, troupe, start, clock));

    TRY(writeCastWithMaterial(found, found.best().freedoms, options.output, options.output));
    TRY(drawPictures(found));
    if (options.solutions) TRY(writeSolutions(found));
    if (options.meshes) TRY(writeStageMeshes(*options.meshes, found.problem(), found.best().freedoms));
    if (options.report) TRY(writeReport(*options.report, reportOf(found)));
    fmt::print("{}\n", brief(found));
    return {};
}

}  // namespace

void addPoseCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "pose", "Find poses of people whose shadow is a silhouette", declare, run);
}

}  // namespace fantascope::app
