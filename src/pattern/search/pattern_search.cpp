#include "pattern/search/pattern_search.h"

#include "pattern/search/instance_colour.h"
#include "pattern/search/paper_method.h"
#include "pattern/search/refined_method.h"
#include "pattern/search/search_bounds.h"
#include "pattern/search/search_space.h"
#include "pattern/shape/grouping.h"

#include "core/check.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

// Fields for declareSearch() etc. that find the first number out of its bounds.
struct Bounds {
    Result<void> broken;

    void number(std::string_view option, double value, double low, double high) {
        if (broken && !(low <= value && value <= high))
            broken = Error(fmt::format("{} = {} must be in {} .. {}", option, value, low, high));
    }
    void integer(std::string_view option, double value, double low, double high) { number(option, value, low, high); }
    void angle(std::string_view option, double value, double lowDegrees, double highDegrees) {
        number(option, value, radians(lowDegrees), radians(highDegrees));
    }
};

Result<void> checkSize(const std::optional<glm::dvec2>& size) {
    if (!size || (0 < size->x && size->x <= size->y && size->y <= 2)) return {};
    return Error(fmt::format("size = [{}, {}] must be [smallest, largest] with 0 < smallest <= largest <= 2", size->x, size->y));
}

Result<void> checkRotation(std::string_view option, const std::optional<glm::dvec2>& range, double maxDegrees) {
    const double max = radians(maxDegrees);
    if (!range || (-max <= range->x && range->x <= range->y && range->y <= max && range->y - range->x <= radians(360))) return {};
    const glm::dvec2 degrees = *range * (180 / std::numbers::pi);
    return Error(
        fmt::format("{0} = [{1:.6g}, {2:.6g}] degrees must be [from, to] with -{3} <= from <= to <= {3} and to - from <= 360",
                    option, degrees.x, degrees.y, maxDegrees));
}

void checkColours(Bounds& bounds, const std::vector<Options::Colours>& colours) {
    for (const Options::Colours& range : colours)
        for (int i = 0; i < 3; ++i) {
            bounds.number("colours", range.from[i], 0, 1);
            bounds.number("colours", range.to[i], 0, 1);
        }
}

bool byId(const ShapeInstance& a, const ShapeInstance& b) { return a.id < b.id; }

}  // namespace

Result<void> PatternSearch::Options::check() const {
    Bounds bounds;
    Options copy = *this;
    declareSearch(bounds, copy);
    declareRefined(bounds, copy.refined);
    declarePaper(bounds, copy.paper);
    declareShapes(bounds, copy);
    checkColours(bounds, colours);
    bounds.number("changeCost", changeCost, 0, 10);
    for (Shape& shape : copy.shapes) {
        declareShape(bounds, shape);
        checkColours(bounds, shape.colours);
    }
    TRY(bounds.broken);
    const auto& [lambdaCreate, lambdaIncrease, lambdaReduce, lambdaDelete] =
        std::tie(paper.lambdaCreate, paper.lambdaIncrease, paper.lambdaReduce, paper.lambdaDelete);
    if (!(-1 < lambdaDelete && lambdaDelete <= lambdaReduce && lambdaReduce <= 0 && 0 <= lambdaIncrease &&
          lambdaIncrease <= lambdaCreate && lambdaCreate < 1))
        return Error(fmt::format(
            "-1 < lambda_delete <= lambda_reduce <= 0 <= lambda_increase <= lambda_create < 1 must hold; they are {}, {}, {}, {}",
            lambdaDelete, lambdaReduce, lambdaIncrease, lambdaCreate));
    TRY(checkSize(size));
    for (const Shape& shape : shapes) {
        TRY(checkSize(shape.size));
        TRY(checkRotation("tilt", shape.tilt, kMaxTilt));
        TRY(checkRotation("turn", shape.turn, kMaxTurn));
    }
    if (colours.empty()) return Error("colours: at least one is needed");
    if (region && !(region->from.x < region->to.x && region->from.y < region->to.y))
        return Error("region: must be the top left corner, then the bottom right one, in canvas heights");
    if (region && method == Method::Paper)
        return Error("region: only the refined method keeps to a region; the paper's method changes the whole pattern");
    if (surface && method == Method::Paper)
        return Error("surface: only the refined method heeds a surface; the paper's method takes it for evenly white");
    return {};
}

std::string PatternSearch::Summary::brief() const {
    return fmt::format("z {:.4f} after {} iterations ({})", z, iterations, name(reason));
}

std::string_view name(PatternSearch::StopReason reason) {
    switch (reason) {
        case PatternSearch::StopReason::NotRun:
            return "not_run";
        case PatternSearch::StopReason::TargetReached:
            return "target_reached";
        case PatternSearch::StopReason::Iterations:
            return "iterations";
        case PatternSearch::StopReason::Time:
            return "time";
        case PatternSearch::StopReason::Interrupted:
            return "interrupted";
    }
    return "";
}

std::string_view name(PatternSearch::Method method) { return method == PatternSearch::Method::Refined ? "refined" : "paper"; }

std::optional<int> PatternSearch::iterationsWithin(double budget, int done, double elapsed) {
    constexpr double kEnough = 0.1;  // share of the budget; below the refined method's kWarm
    if (done == 0 || elapsed < kEnough * budget) return std::nullopt;
    // A cool search accepts fewer moves and is faster. The first moves, which rearrange the start,
    // are the slowest.
    const double faster = 1.12 + 10.0 / done;
    return static_cast<int>(std::min(faster * done * budget / elapsed, double(std::numeric_limits<int>::max() - 1)));
}

PatternSearch::Found PatternSearch::run(const GreyImage& guide, ShapePattern pattern, const Options& options, int threads,
                                        const AskStop& askStop, const Plan& plan) {
    FANTASCOPE_CHECK(options.check().has_value() && !pattern.shapes.empty() && !guide.empty(),
                     "options pass check(), and guide and shapes are not empty");
    pattern.height = std::min(options.rows, guide.height());
    pattern.width = std::max(1, static_cast<int>(std::lround(double(pattern.height) * guide.width() / guide.height())));
    const GreyImage compared = pattern.height == guide.height() ? guide : resized(guide, pattern.width, pattern.height);

    const SearchSpace space(compared, pattern.shapes, pattern.seed, options);
    const std::vector<ShapeInstance> given = pattern.instances;
    Summary summary = options.method == Method::Paper ? searchByPaper(space, pattern.instances, threads, askStop)
                                                      : searchRefined(space, pattern.instances, askStop, plan);
    const auto colour = [&](ShapeInstance& instance) {
        instance.colour = colourOf(instance, pattern.aspect(), pattern.seed, options);
    };
    if (given.empty()) {
        for (ShapeInstance& instance : pattern.instances) colour(instance);
        assignGroups(pattern);
    } else {
        // Given instances keep their colour and movement. A new one joins the group of the nearest
        // given one.
        const std::uint32_t last = std::max_element(given.begin(), given.end(), byId)->id;
        for (ShapeInstance& instance : pattern.instances) {
            if (instance.id <= last) continue;
            colour(instance);
            instance.group = std::min_element(given.begin(), given.end(), [&](const ShapeInstance& a, const ShapeInstance& b) {
                                 return glm::distance(a.centre, instance.centre) < glm::distance(b.centre, instance.centre);
                             })->group;
        }
    }
    return {std::move(pattern), std::move(summary)};
}

}  // namespace fantascope::pattern
