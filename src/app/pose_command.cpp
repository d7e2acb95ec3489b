#include "app/pose_command.h"

#include "app/data_folder.h"
#include "app/output.h"
#include "app/pose_trials.h"
#include "app/progress.h"
#include "app/report.h"
#include "app/silhouette_file.h"
#include "app/stage_meshes.h"

#include "theatre/balance.h"
#include "theatre/cast.h"
#include "theatre/pose_hints.h"
#include "theatre/solution_choice.h"
#include "theatre/stage_file.h"
#include "theatre/troupe.h"
#include "theatre/weights_file.h"

#include "core/parallel.h"
#include "plot/cast_figures.h"
#include "plot/cast_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::PoseProblem, theatre::PoseSearch, theatre::PoseTarget, theatre::Troupe;

constexpr double kDefaultSeconds = 20;
constexpr int kFewActors = 3;  // up to so many a trial is shorter
constexpr std::int64_t kEvaluationsOfFew = 40'000, kEvaluationsOfMany = 80'000;
constexpr int kRows = 512;  // of the target
constexpr std::size_t kMostSolutions = 8;
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
    std::optional<std::string> weights;  // a preset's name, or a file
    std::optional<fs::path> image, view, each, solutions, meshes, report;
};

std::string onlyPicture(const std::string& file) {
    return plot::Page::knows(file) ? ""
                                   : fmt::format("'{}' is no picture that can be written: its name ends in .png or .svg", file);
}

void declare(CLI::App& command, Options& options) {
    command.add_option("TARGET", options.target, "The silhouette, white on black: PNG or JPEG")->required();
    command.add_option("-o,--output", options.output, "The poses to write, C.cast.yaml")
        ->required()
        ->check(onlyYaml("C.cast.yaml"));
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
            fmt::format("How many, 1 .. {}; auto: by the silhouette's area, 1 .. {}", Troupe::kMostActors, Troupe::kMostUnasked))
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
    command.add_option("--hints", options.hints,
                       "Which body parts may come to which points of the target, *.hints.yaml (docs/hints-format.md)");
    command.add_option("--weights", options.weights,
                       "Of the energy's terms: a preset of assets/silhouettes/weights.yaml, such as rabbit, or a file "
                       "(docs/weights-format.md)");
    command.add_option("--stage", options.stage,
                       "Light or projector, platforms and props, *.stage.yaml (docs/stage-format.md); default: a lamp on the "
                       "floor, 7 m before the screen");
    command.add_option("--trials", options.trials, "Searches to take the best of (default: as many as fit into the time)")
        ->check(CLI::Range(1, 1'000'000));
    command
        .add_option("--seconds", options.seconds,
                    fmt::format("End after so long (default {} s, unless --trials is given)", kDefaultSeconds))
        ->check(CLI::Range(0.0, 1e6));
    command.add_option(
        "--evaluations", options.evaluations,
        fmt::format("Of the energy, in a trial (default {}, and {} for more than {} actors; fewer where the time is short)",
                    kEvaluationsOfFew, kEvaluationsOfMany, kFewActors));
    command
        .add_option("--method", options.search.method,
                    "refined, or paper: CMA-ES as Won & Lee 2016 have it, with their refinement")
        ->transform(CLI::CheckedTransformer(std::map<std::string, PoseSearch::Method>{{"refined", PoseSearch::Method::Refined},
                                                                                      {"paper", PoseSearch::Method::Paper}}))
        ->default_str("refined")
        ->type_name("refined|paper");
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

// All that the options ask to be written besides the cast.
std::vector<fs::path> outputsOf(const Options& options) {
    std::vector<fs::path> files{options.output};
    for (const auto& file : {options.image, options.view, options.each, options.report})
        if (file) files.push_back(*file);
    if (options.solutions) files.push_back(*options.solutions / "solutions.png");
    if (options.meshes) files.push_back(*options.meshes / "stage.json");
    return files;
}

Result<void> checkOutputs(const Options& options) {
    for (const fs::path& file : outputsOf(options)) {
        TRY(checkWritable(file));
        if (fs::weakly_canonical(file) == fs::weakly_canonical(options.target))
            return Error(fmt::format("{}: is the target, and would be overwritten; choose another name", file.string()));
    }
    return {};
}

// Everything that a run leaves behind is made of this.
struct Found {
    const Options& options;
    const PoseProblem& problem;
    double height;  // of the silhouette, metres
    std::int64_t evaluationsPerTrial;
    PoseTrials trials;
    std::vector<std::size_t> bestFirst;

    const PoseTrials::Trial& best() const { return trials.trials[bestFirst[0]]; }
};

// The picture lies beside the file, or will.
theatre::Cast castOf(const Found& found, std::span<const double> freedoms, const fs::path& target) {
    theatre::Cast cast{target, found.height, found.problem.stage, 0, found.options.seed, {}};
    for (const theatre::Body& body : found.problem.actors) {
        cast.actors.push_back({body.stature, {theatre::poseOf(body, freedoms.first(body.freedoms))}});
        freedoms = freedoms.subspan(body.freedoms);
    }
    return cast;
}

// The target first, so that the cast never names what is not there.
Result<void> writeCastWithTarget(const Found& found, std::span<const double> freedoms, const fs::path& file,
                                 const Material& target) {
    const fs::path folder = fs::absolute(file).parent_path();
    TRY(copyTo(folder, target));
    return theatre::writeCast(file, castOf(found, freedoms, folder / target.name));
}

Material targetFor(const Options& options, const fs::path& output) {
    return materialFor(output, options.target, "target" + options.target.extension().string());
}

Result<void> drawPictures(const Found& found) {
    const Options& options = found.options;
    if (!options.image && !options.view && !options.each) return {};
    const plot::CastPicture picture = plot::castPicture(found.problem, found.best().freedoms);
    if (options.image) TRY(plot::shadowFigure(picture.actors, picture.view.target, picture.lines).write(*options.image));
    if (options.view) TRY(plot::stageFigure(picture.view, picture.view.overview(plot::kStageAspect)).write(*options.view));
    if (options.each) TRY(plot::actorsFigure(picture.actors, picture.view.target).write(*options.each));
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

// What somebody may choose from: the best, and all that are held and nearly as good, or good enough for anybody.
std::vector<const PoseTrials::Trial*> acceptedOf(const Found& found) {
    std::vector<const PoseTrials::Trial*> accepted;
    for (const std::size_t i : found.bestFirst) {
        const PoseTrials::Trial& trial = found.trials.trials[i];
        const bool isGood =
            trial.isSatisfactory() || (trial.quality.isValid() && trial.quality.iou >= found.best().quality.iou - kNearlyAsGood);
        if (accepted.empty() || isGood) accepted.push_back(&trial);
    }
    return accepted;
}

Result<void> writeSolutions(const Found& found) {
    const PoseProblem& problem = found.problem;
    const fs::path& folder = *found.options.solutions;
    const std::vector<const PoseTrials::Trial*> accepted = acceptedOf(found);
    std::vector<std::vector<theatre::PlacedActor>> places;
    for (const PoseTrials::Trial* trial : accepted) places.push_back(placed(problem, trial->freedoms));
    std::vector<plot::SolutionCell> cells;
    for (const std::size_t choice : theatre::mostDifferent(places, kMostSolutions)) {
        const PoseTrials::Trial& trial = *accepted[choice];
        const std::string file = fmt::format("solution-{}.cast.yaml", cells.size() + 1);
        TRY(writeCastWithTarget(found, trial.freedoms, folder / file, targetFor(found.options, folder / "solutions.png")));
        plot::CastPicture picture = plot::castPicture(problem, trial.freedoms);
        const plot::Camera camera = picture.view.closeUp(double(plot::kCellView.x) / plot::kCellView.y);
        std::vector<std::string> lines{file};
        lines.insert(lines.end(), picture.lines.begin(), picture.lines.end());
        cells.push_back(
            {picture.view.draw(camera, plot::kCellView.x, plot::kCellView.y), std::move(picture.actors), std::move(lines)});
    }
    return plot::solutionsFigure(cells, problem.target.mask).write(folder / "solutions.png");
}

// The terms of equation 1, weighted: their sum is the total.
Report energyOf(const PoseProblem& problem, const PoseSearch::Quality& quality) {
    const theatre::EnergyTerms& terms = quality.terms;
    const theatre::PoseWeights& w = problem.weights;
    return {{"contour", terms.contour(w)},     {"coverage", w.w4 * terms.coverage}, {"coherence", w.w5 * terms.coherence},
            {"visible", w.w6 * terms.visible}, {"physics", terms.physics(w)},       {"hint", w.w12 * terms.hint},
            {"total", quality.energy}};
}

Report actorsOf(const PoseProblem& problem, const PoseTrials::Trial& best, std::span<const TriangleMesh> skins) {
    Report actors = Report::array();
    theatre::Contacts contacts;
    for (std::size_t i = 0; i < skins.size(); ++i) {
        const PoseSearch::Actor& quality = best.quality.actors[i];
        theatre::findContacts(skins[i].vertices, problem.skins[i]->edges, contacts);
        Report points = Report::array();
        if (contacts.touches)
            for (const theatre::Contact& contact : contacts.discs) points.push_back({contact.place.x, contact.place.y});
        actors.push_back({{"stature", problem.actors[i].stature},
                          {"margin", quality.margin},
                          {"lowest_point", quality.lowest},
                          {"contacts", points},
                          {"deepest_penetration", quality.deepest},
                          {"within_limits", quality.withinLimits}});
    }
    return actors;
}

Report reportOf(const Found& found, std::span<const TriangleMesh> skins) {
    const PoseTrials::Trial& best = found.best();
    Report report;
    report["iou"] = best.quality.iou;
    report["valid"] = best.quality.isValid();
    report["contour_mean_px"] = best.quality.contourMean;
    report["contour_max_px"] = best.quality.contourMost;
    report["energy"] = energyOf(found.problem, best.quality);
    report["height"] = found.height;
    report["actors"] = actorsOf(found.problem, best, skins);
    std::int64_t evaluations = 0;
    double spent = 0;
    std::size_t satisfactory = 0;
    Report& trials = report["trials"] = Report::array();
    for (const PoseTrials::Trial& trial : found.trials.trials) {
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
    const auto count = static_cast<double>(found.trials.trials.size());
    report["best_trial"] = best.number + 1;
    report["finished_trials"] = found.trials.finished;
    report["satisfactory_share"] = static_cast<double>(satisfactory) / count;
    // Without a satisfactory one nobody knows: infinite, which is written as null.
    report["expected_trials"] = count / static_cast<double>(satisfactory);
    report["seconds_per_trial"] = spent / count;
    report["evaluations"] = evaluations;
    report["evaluations_per_trial"] = found.evaluationsPerTrial;
    report["seconds"] = found.trials.seconds;
    report["stop_reason"] = name(found.trials.reason);
    report["seed"] = found.options.seed;
    return report;
}

std::string brief(const Found& found) {
    const PoseTrials::Trial& best = found.best();
    const std::size_t finished = found.trials.finished, actors = found.problem.actors.size();
    std::string text = fmt::format("{}: IoU {:.3f}, {} actor{}, {} m high", found.options.output.string(), best.quality.iou,
                                   actors, actors == 1 ? "" : "s", found.height);
    if (finished > 0)
        text += fmt::format(", the best of {} trial{}", finished, finished == 1 ? "" : "s");
    else
        text += "; no trial was finished: take more --seconds, or fewer --evaluations";
    if (!best.quality.isValid())
        text += fmt::format("; nobody can hold these poses{}", finished > 0 ? ": more --trials or other --actors may help" : "");
    return text;
}

Result<theatre::PoseWeights> weightsOf(const Options& options) {
    if (!options.weights) return theatre::PoseWeights{};
    if (fs::path(*options.weights).extension() == ".yaml") return theatre::readWeights(*options.weights);
    return theatre::readWeights(dataFolder() / "assets/silhouettes/weights.yaml", *options.weights);
}

// As many evaluations of a trial as a thread finishes within the time, but no more than a trial needs. What is found so stands in the report, and
// --evaluations repeats it.
std::int64_t evaluationsWithin(double seconds, PoseSearch::Options options, const PoseProblem& problem, std::uint64_t seed,
                               const Clock& clock) {
    constexpr std::int64_t kProbe = 1000;
    constexpr double kSpare = 0.75;  // threads get in each other's way, and a trial's end has its own cost
    const Time start = clock.now();
    const std::int64_t enough = std::exchange(options.evaluations, kProbe);
    const PoseSearch::Trial probe = PoseSearch::run(problem, seed, options);
    const double took = fantascope::seconds(clock.now() - start);
    const double fit = kSpare * (seconds - took) * static_cast<double>(probe.evaluations) / std::max(took, 1e-3);
    return std::clamp(static_cast<std::int64_t>(fit), kProbe, enough);
}

Result<void> run(const Options& options) {
    SteadyClock clock;
    const Time start = clock.now();
    // Whatever can be refused is refused before the search begins.
    TRY(checkOutputs(options));
    const GreyImage silhouette = TRY(readSilhouette(options.target));
    theatre::Stage stage;
    if (options.stage) stage = TRY(theatre::readStage(*options.stage));
    const theatre::PoseWeights weights = TRY(weightsOf(options));
    const std::string file = options.target.string();
    // Wherever the light is.
    const double area = TRY(PoseTarget::from(silhouette, {}, 1, kRows).in(file)).area / (kRows * kRows);
    const Troupe troupe = TRY(Troupe::of(area, options.actors, options.height, options.statures));
    TRY(stage.checkHolders(troupe.statures.size()));
    PoseProblem problem{stage, TRY(PoseTarget::from(silhouette, stage, troupe.height, kRows).in(file)), {}, weights};
    if (options.hints) problem.hints = TRY(theatre::readHints(*options.hints, problem.target));
    for (const double stature : troupe.statures) problem.actors.push_back(theatre::humanBody(stature));
    problem.dress();
    PoseTrials::Options search{options.search, options.seed, options.trials, options.seconds, options.threads};
    if (!options.trials && !options.seconds) search.seconds = kDefaultSeconds;
    const bool areFew = troupe.statures.size() <= std::size_t{kFewActors};
    search.search.evaluations = options.evaluations.value_or(areFew ? kEvaluationsOfFew : kEvaluationsOfMany);
    TRY(search.search.check());
    if (search.seconds) {
        // All that came before counts.
        const auto left = [&] { return std::max(0.0, *search.seconds - seconds(clock.now() - start)); };
        if (!options.evaluations)
            search.search.evaluations = evaluationsWithin(left(), search.search, problem, options.seed, clock);
        search.seconds = left();
    }
    Found found{options,
                problem,
                troupe.height,
                search.search.evaluations,
                PoseTrials::run(problem, search, clock, std::cerr, standardErrorIsTerminal()),
                {}};
    found.bestFirst = found.trials.bestFirst();

    TRY(writeCastWithTarget(found, found.best().freedoms, options.output, targetFor(options, options.output)));
    TRY(drawPictures(found));
    if (options.solutions) TRY(writeSolutions(found));
    if (options.meshes || options.report) {
        const std::vector<TriangleMesh> skins = skinsOf(problem, found.best().freedoms);
        if (options.meshes) TRY(writeStageMeshes(*options.meshes, problem.target, stage, skins));
        if (options.report) TRY(writeReport(*options.report, reportOf(found, skins)));
    }
    fmt::print("{}\n", brief(found));
    return {};
}

}  // namespace

void addPoseCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "pose", "Find poses of people whose shadow is a silhouette", declare, run);
}

}  // namespace fantascope::app
