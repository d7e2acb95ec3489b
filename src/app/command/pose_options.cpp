#include "app/command/pose_options.h"

#include "app/base/command.h"
#include "app/base/output.h"

#include "plot/page.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::PoseRounds, theatre::PoseSearch, theatre::Troupe;

constexpr double kFarthest = 100;  // metres

std::string onlyPicture(const std::string& file) {
    return plot::Page::knows(file) ? ""
                                   : fmt::format("'{}' is no picture that can be written: its name ends in .png or .svg", file);
}

void declareActors(Command& command, PoseOptions& options) {
    command.add("TARGET", options.target, "The silhouette, white on black: PNG or JPEG").required();
    addOutOption(command, options.output, "The poses to write, C.cast.yaml").required().check(onlyYaml("C.cast.yaml"));
    command
        .addParsed(
            "--actors",
            [&options](const std::string& given) {
                if (given == "auto") return std::string();
                options.actors = wholeNumber(given);
                return options.actors ? "" : fmt::format("'{}' is neither a number nor 'auto'", given);
            },
            fmt::format("How many, 1 .. {}; auto: by the silhouette's area, 1 .. {}, and up to {} more if they are not enough",
                        Troupe::kMostActors, Troupe::kMostUnasked, PoseRounds::kMostMore))
        .defaultText("auto")
        .typeName("N|auto");
    command.add("--height", options.height,
                fmt::format("Of the silhouette on the screen, metres (default: so that each actor has some {} square "
                            "metres of it; {} where --actors is auto)",
                            Troupe::kShare, Troupe::kUsualHeight));
    command.add("--stature", options.statures, "Of the actors, metres: one for all, or one for each, separated by commas")
        .delimiter(',')
        .noExtraArguments()
        .range(0.9, 2.1)
        .showDefault();
}

void declareTask(Command& command, PoseOptions& options) {
    command.addFlag("--invert", options.invert, "The silhouettes are black ink on white paper");
    command.add("--hints", options.hints,
                "Which body parts may come to which points of the target, *.hints.yaml (docs/hints-format.md)");
    command.add("--weights", options.weights,
                "Of the energy's terms: a preset of assets/silhouettes/weights.yaml, such as rabbit, or a file "
                "(docs/weights-format.md)");
    command.add("--stage", options.stage,
                "Light or projector, platforms and props, *.stage.yaml (docs/stage-format.md); default: a lamp on the "
                "floor, 7 m in front of the screen");
}

void declareFurther(Command& command, PoseOptions& options) {
    command
        .add("--further-target", options.furtherTargets,
             "The silhouettes for the stage's further beams, other lights or screens, in their order, separated by commas")
        .delimiter(',')
        .noExtraArguments();
    command
        .add("--further-height", options.furtherHeights,
             "Of each of them, metres (default: people are as high as on the first screen)")
        .delimiter(',')
        .noExtraArguments()
        .range(Troupe::kLeastHeight, Troupe::kMostHeight);
    command
        .add("--further-middle", options.furtherMiddles,
             "Where on its screen the middle of each is: metres to the right of where the screen stands (default: where the "
             "shadow falls of people who stand in front of the first light)")
        .delimiter(',')
        .noExtraArguments()
        .range(-kFarthest, kFarthest);
}

void declareSearch(Command& command, PoseOptions& options) {
    command.add("--trials", options.search.trials, "Searches to take the best of (default: as many as fit into the time)")
        .range(1, 1'000'000);
    command
        .add("--seconds", options.search.seconds,
             fmt::format("End after so long (default {} s, unless --trials is given)", PoseRounds::kDefaultSeconds))
        .range(0.0, 1e6);
    command.add("--evaluations", options.search.evaluations,
                fmt::format("Of the energy, in a trial (default {}, and {} for more than {} actors or targets than one; "
                            "fewer where the time is short)",
                            PoseRounds::kEvaluationsOfFew, PoseRounds::kEvaluationsOfMany, PoseRounds::kFewActors));
    command
        .addChoice<PoseSearch::Method>("--method", options.search.search.method,
                                       {{"refined", PoseSearch::Method::Refined}, {"paper", PoseSearch::Method::Paper}},
                                       "refined, or paper: CMA-ES as Won & Lee 2016 have it, with their refinement")
        .defaultText("refined");
    command
        .add("--residual", options.search.search.residual,
             "The paper's method: the energy that needs no refinement unless artefacts are seen")
        .nonNegative()
        .showDefault();
    command.addFlag("--full-covariance", options.search.search.fullCovariance,
                    "The paper's method: one covariance for all actors' degrees of freedom, as in the paper; slower");
    command.add("--seed", options.search.seed, "Another seed, other poses; the same seed and trials, the same poses")
        .range(std::uint64_t{0}, std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        .showDefault();
    command.add("--threads", options.search.threads, "How many to use; the poses are the same for any number").range(1, 256);
}

void declarePictures(Command& command, PoseOptions& options) {
    const ValueCheck picture{onlyPicture, "PNG|SVG"};
    command.add("--image", options.image, "Also draw the shadow, in the colours of who throws it").check(picture);
    command.add("--view", options.view, "Also draw the stage with its people, as an outsider would see it").check(picture);
    command.add("--each", options.each, "Also draw each actor's shadow alone, and say how they stand").check(picture);
    command.add("--solutions", options.solutions,
                fmt::format("A folder for up to {} good solutions that differ most: solutions.png to choose from, and "
                            "each as a cast",
                            kMostSolutions));
    command.add("--meshes", options.meshes,
                "A folder for the actors as Wavefront OBJ, and stage.json with light and screen: for other programs");
    command.add("--report", options.report, "Also write figures, as JSON");
    command.footer("While it searches, the space bar pauses and goes on; escape, q and Ctrl-C end it with the best so far.");
}

// All that the options ask to be written.
std::vector<fs::path> outputsOf(const PoseOptions& options) {
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

}  // namespace

std::vector<fs::path> PoseOptions::targets() const {
    std::vector<fs::path> files{target};
    files.insert(files.end(), furtherTargets.begin(), furtherTargets.end());
    return files;
}

void declarePose(Command& command, PoseOptions& options) {
    declareActors(command, options);
    declareTask(command, options);
    declareFurther(command, options);
    declareSearch(command, options);
    declarePictures(command, options);
}

std::string numbered(std::size_t beam) { return beam == 0 ? "" : fmt::format("-{}", beam + 1); }

std::string invertedName(const fs::path& output, std::size_t beam) {
    return output.stem().stem().string() + ".inverted" + numbered(beam) + ".png";
}

Result<void> checkOutputs(const PoseOptions& options) {
    for (const fs::path& file : outputsOf(options)) {
        TRY(checkWritable(file));
        for (const fs::path& target : options.targets())
            if (fs::weakly_canonical(file) == fs::weakly_canonical(target))
                return Error(fmt::format("{}: is the target, and would be overwritten; choose another name", file.string()));
    }
    return {};
}

Result<void> checkFurther(const PoseOptions& options, std::size_t beams) {
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

}  // namespace fantascope::app
