#include "pattern/pattern_search.h"

#include "pattern/coverage.h"
#include "pattern/goal.h"
#include "pattern/grouping.h"
#include "pattern/search_bounds.h"
#include "pattern/streams.h"

#include "core/check.h"
#include "core/parallel.h"
#include "core/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

// The random pattern at the start has this share of the most instances, which leaves room on both sides.
constexpr double kStartShare = 0.5;
// Without given sizes, the instances together are as large as this many times the guide's white; overlaps and gaps take the
// difference.
constexpr double kFill = 1.3;
// ... and vary around the middle size by this factor. No middle is smaller (pixels) or larger (canvas heights) than a shape can
// be seen.
constexpr double kSizeSpread = 2, kSmallestMiddle = 2, kLargestMiddle = 0.25;
// The share of widely perturbed instances at the start, and how fast it follows the success.
constexpr double kFirstShare = 0.02, kShareStep = 1.1;

// A shape pattern that is a candidate for the solution, drawn and judged.
struct Candidate {
    std::vector<ShapeInstance> instances;
    std::uint32_t nextId = 1;  // never given so far
    Coverage coverage;         // I'
    double z = 1;
};

// What the difference image tells about the reference solution; the same as long as that stays.
struct Heuristics {
    struct Vacancy {
        PixelRectangle cell;
        double createProbability;  // p_cre
    };
    std::vector<Vacancy> vacancies;       // the cells of the lattice with g_i > lambda_cre
    std::vector<double> instanceIndices;  // g_i of the instance cells, in the order of the reference's instances
};

// The side of a square as large as the shape is at size 1, on average over the allowed rotations.
double typicalSide(const Silhouette& shape, const Options& options, Rng rng) {
    constexpr int kViews = 64, kPixels = 128;
    std::int64_t covered = 0;
    for (int i = 0; i < kViews; ++i) {
        Coverage view(kPixels, kPixels);
        const glm::dvec3 rotation(rng.uniform(-options.tilt, options.tilt), rng.uniform(-options.tilt, options.tilt),
                                  rng.uniform(-options.turn, options.turn));
        view.add(shape, {{0.5, 0.5}, 0.5, rotation});
        covered += view.count({{0, 0}, {kPixels, kPixels}});
    }
    constexpr double kPixelsOfUnit = kPixels * 0.5;  // the shape was drawn at size 0.5
    return std::sqrt(static_cast<double>(covered) / kViews) / kPixelsOfUnit;
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }
double roundedAngle(double angle) { return radians(rounded(angle * 180 / std::numbers::pi, 1e4)); }

// The nearest instance whose numbers are short decimals and whose centre is on the canvas: a file then holds, in few digits, exactly
// what was compared.
ShapeInstance storable(ShapeInstance instance, double aspect) {
    const double right = std::floor(aspect * 1e6) / 1e6;
    instance.centre.x = std::clamp(rounded(instance.centre.x, 1e6), 0.0, right);
    instance.centre.y = std::clamp(rounded(instance.centre.y, 1e6), 0.0, 1.0);
    instance.size = rounded(instance.size, 1e6);
    instance.rotation = {roundedAngle(instance.rotation.x), roundedAngle(instance.rotation.y), roundedAngle(instance.rotation.z)};
    return instance;
}

class Search {
public:
    Search(const GreyImage& guide, std::span<const ElementalShape> shapes, std::uint64_t seed, const Options& options)
        : options_(options),
          seed_(seed),
          goal_(guide),
          pixels_(guide.width(), guide.height()),
          aspect_(double(pixels_.x) / pixels_.y) {
        double meanSide = 0;
        for (const ElementalShape& shape : shapes) {
            silhouettes_.emplace_back(shape.mesh);
            sides_.push_back(
                typicalSide(silhouettes_.back(), options, Rng(streamSeed(seed, {Stream::TypicalViews, sides_.size()}))));
            meanSide += sides_.back() / static_cast<double>(shapes.size());
        }
        sizes_ = options.size ? *options.size : fittingSizes(meanSide);
        const double cellSide = options.latticeCell * meanSide * std::sqrt(sizes_.x * sizes_.y);
        const int side = std::max(1, static_cast<int>(std::lround(cellSide * pixels_.y)));
        for (int y = 0; y < pixels_.y; y += side)
            for (int x = 0; x < pixels_.x; x += side) lattice_.push_back({{x, y}, glm::min(glm::ivec2(x, y) + side, pixels_)});
    }

    // Section 4.1, from the random start to a reason to stop.
    PatternSearch::Summary run(int threads, const PatternSearch::AskStop& askStop, std::vector<ShapeInstance>& instances) const {
        PatternSearch::Summary summary;
        Candidate reference = randomPattern();
        Heuristics heuristics = examine(reference);
        std::vector<Candidate> candidates(static_cast<std::size_t>(options_.candidates), reference);
        double share = kFirstShare;
        for (;; ++summary.iterations) {
            const auto reason = whyStop(summary.iterations, reference, askStop);
            if (reason) {
                summary.reason = *reason;
                break;
            }
            parallelFor(options_.candidates, threads, [&](int slot) {
                Rng rng(streamSeed(seed_, {Stream::SearchCandidate, std::uint64_t(summary.iterations), std::uint64_t(slot)}));
                adjust(reference, heuristics, share, rng, candidates[static_cast<std::size_t>(slot)]);
            });
            const auto [best, worst] =
                std::minmax_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
            const bool accepted = best->z < reference.z;
            summary.history.push_back({best->z, worst->z, accepted});
            if (accepted) {
                std::swap(reference, *best);
                heuristics = examine(reference);
            }
            share = adapted(share, accepted, reference.instances.size());
        }
        summary.z = reference.z;
        summary.evaluations = 1 + std::int64_t{options_.candidates} * summary.iterations;
        instances = std::move(reference.instances);
        return summary;
    }

private:
    // The three stop criteria of the paper, and a number of iterations, so that a run that was stopped by time can be repeated.
    std::optional<PatternSearch::StopReason> whyStop(int iterations, const Candidate& reference,
                                                     const PatternSearch::AskStop& askStop) const {
        if (reference.z < options_.targetZ) return PatternSearch::StopReason::TargetReached;
        if (iterations >= options_.iterations) return PatternSearch::StopReason::Iterations;
        return askStop({iterations, reference.z, reference.instances.size()});
    }

    Candidate randomPattern() const {
        Candidate start{.instances = {}, .coverage = Coverage(pixels_.x, pixels_.y)};
        Rng rng(streamSeed(seed_, {Stream::SearchStart}));
        const auto count = static_cast<std::uint32_t>(std::ceil(options_.instances * kStartShare));
        while (start.instances.size() < count) create({{0, 0}, pixels_}, rng, start);
        evaluate(start);
        return start;
    }

    // Compares the reference solution with the guide cell by cell.
    Heuristics examine(const Candidate& reference) const {
        Heuristics found;
        for (const PixelRectangle& cell : lattice_) {
            const double probability = createProbability(goal_.differenceIndex(cell, reference.coverage), options_.lambdaCreate);
            if (probability > 0) found.vacancies.push_back({cell, probability});
        }
        for (const ShapeInstance& instance : reference.instances)
            found.instanceIndices.push_back(goal_.differenceIndex(instanceCell(instance), reference.coverage));
        return found;
    }

    // Makes `candidate` from the reference solution: deletes, reduces, increases and perturbs its instances, creates new ones,
    // and evaluates.
    void adjust(const Candidate& reference, const Heuristics& heuristics, double share, Rng& rng, Candidate& candidate) const {
        candidate.instances.clear();
        candidate.nextId = reference.nextId;
        for (std::size_t i = 0; i < reference.instances.size(); ++i) {
            const double g = heuristics.instanceIndices[i];
            if (rng.uniform() < deleteProbability(g, options_.lambdaDelete)) continue;
            candidate.instances.push_back(adjusted(reference.instances[i], g, share, rng));
        }
        std::vector<const PixelRectangle*> cells;
        for (const Heuristics::Vacancy& vacancy : heuristics.vacancies)
            if (rng.uniform() < vacancy.createProbability) cells.push_back(&vacancy.cell);
        // Where there is room for some only, every cell has the same chance.
        for (std::size_t i = 0; i < cells.size() && candidate.instances.size() < options_.instances; ++i) {
            std::swap(cells[i], cells[i + rng.below(static_cast<std::uint32_t>(cells.size() - i))]);
            create(*cells[i], rng, candidate);
        }
        evaluate(candidate);
    }

    // The paper perturbs every instance by "a small amount of random perturbation". If all amounts are alike, the good of one is
    // undone by the rest and hardly a candidate is better. So they are long-tailed: largestAmount * u^(1 / share), of which about
    // `share` are larger than 1/e of the largest, while most are a fraction of a pixel. The share follows the success, see
    // adapted().
    ShapeInstance adjusted(ShapeInstance instance, double g, double share, Rng& rng) const {
        const double amount = options_.largestAmount * std::pow(rng.uniform(), 1 / share);
        if (g < options_.lambdaReduce) instance.size *= 1 - std::min(amount, 1.0) * rng.uniform();
        if (g > options_.lambdaIncrease) instance.size *= 1 + amount * rng.uniform();
        instance.size = std::clamp(instance.size, sizes_.x, sizes_.y);

        const auto shift = [&] { return amount * rng.uniform(-1, 1); };
        instance.centre.x += instance.size * shift();
        instance.centre.y += instance.size * shift();
        instance.rotation.x = std::clamp(instance.rotation.x + shift(), -options_.tilt, options_.tilt);
        instance.rotation.y = std::clamp(instance.rotation.y + shift(), -options_.tilt, options_.tilt);
        const double turned = std::remainder(instance.rotation.z + shift(), 2 * std::numbers::pi);  // a free turn has no ends
        instance.rotation.z = std::clamp(turned, -options_.turn, options_.turn);
        return storable(instance, aspect_);
    }

    // A success rule after Rechenberg's (1973): more is perturbed after an acceptance and less after a rejection, in such steps
    // that the share stays when the wanted share of iterations is accepted. At least one instance moves widely, at most all do.
    double adapted(double share, bool accepted, std::size_t instances) const {
        const double down = options_.successRate / (1 - options_.successRate);
        share *= std::pow(kShareStep, accepted ? 1 : -down);
        return std::clamp(share, 1 / (1 + static_cast<double>(instances)), 1.0);
    }

    // A new instance at a random point of the cell, its other transforms random too.
    void create(const PixelRectangle& cell, Rng& rng, Candidate& candidate) const {
        ShapeInstance instance;
        instance.id = candidate.nextId++;
        instance.shape = rng.below(static_cast<std::uint32_t>(silhouettes_.size()));
        instance.centre =
            glm::dvec2(rng.uniform(cell.begin.x, cell.end.x), rng.uniform(cell.begin.y, cell.end.y)) / double(pixels_.y);
        instance.size = sizes_.x * std::pow(sizes_.y / sizes_.x, rng.uniform());
        instance.rotation = {rng.uniform(-options_.tilt, options_.tilt), rng.uniform(-options_.tilt, options_.tilt),
                             rng.uniform(-options_.turn, options_.turn)};
        candidate.instances.push_back(storable(instance, aspect_));
    }

    void evaluate(Candidate& candidate) const {
        candidate.coverage.clear();
        for (const ShapeInstance& instance : candidate.instances)
            candidate.coverage.add(silhouettes_[instance.shape], {instance.centre, instance.size, instance.rotation});
        candidate.z = goal_.z(candidate.coverage);
    }

    // The square around the instance's centre, as far as it lies in the picture; at least a pixel.
    PixelRectangle instanceCell(const ShapeInstance& instance) const {
        const double half = options_.instanceCell * sides_[instance.shape] * instance.size / 2;
        const glm::dvec2 begin = glm::round((instance.centre - half) * double(pixels_.y)),
                         end = glm::round((instance.centre + half) * double(pixels_.y));
        PixelRectangle cell{glm::clamp(glm::ivec2(begin), glm::ivec2(0), pixels_ - 1), glm::ivec2(0)};
        cell.end = glm::clamp(glm::ivec2(end), cell.begin + 1, pixels_);
        return cell;
    }

    // Sizes with which the most instances light as much as the guide is white, and a little more.
    glm::dvec2 fittingSizes(double meanSide) const {
        const double light = goal_.mean() * aspect_;
        const double middle =
            std::clamp(std::sqrt(kFill * light / options_.instances) / meanSide, kSmallestMiddle / pixels_.y, kLargestMiddle);
        return {middle / kSizeSpread, middle * kSizeSpread};
    }

    const Options& options_;
    const std::uint64_t seed_;
    const Goal goal_;
    const glm::ivec2 pixels_;
    const double aspect_;
    std::vector<Silhouette> silhouettes_;  // of each shape
    std::vector<double> sides_;            // of each shape: its typicalSide
    glm::dvec2 sizes_{0.0};                // smallest and largest
    std::vector<PixelRectangle> lattice_;  // the evaluation lattice
};

// Finds the first number that is out of its bounds.
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

glm::vec3 colourOf(std::uint32_t id, std::uint64_t seed, const std::vector<Options::Colours>& colours) {
    Rng rng(streamSeed(seed, {Stream::InstanceColour, id}));
    const Options::Colours& range = colours[rng.below(static_cast<std::uint32_t>(colours.size()))];
    const glm::dvec3 colour = glm::mix(range.from, range.to, rng.uniform());
    return {rounded(colour.r, 1e4), rounded(colour.g, 1e4), rounded(colour.b, 1e4)};
}

}  // namespace

Result<void> PatternSearch::Options::check() const {
    Bounds bounds;
    Options copy = *this;
    declareSearch(bounds, copy);
    declareShapes(bounds, copy);
    bounds.integer("iterations", copy.iterations, 0, std::numeric_limits<int>::max());
    for (Colours& range : copy.colours)
        for (int i = 0; i < 3; ++i) {
            bounds.number("colours", range.from[i], 0, 1);
            bounds.number("colours", range.to[i], 0, 1);
        }
    TRY(bounds.broken);
    if (!(-1 < lambdaDelete && lambdaDelete <= lambdaReduce && lambdaReduce <= 0 && 0 <= lambdaIncrease &&
          lambdaIncrease <= lambdaCreate && lambdaCreate < 1))
        return Error(fmt::format(
            "-1 < lambda_delete <= lambda_reduce <= 0 <= lambda_increase <= lambda_create < 1 must hold, here are {}, {}, {}, {}",
            lambdaDelete, lambdaReduce, lambdaIncrease, lambdaCreate));
    if (size && !(0 < size->x && size->x <= size->y && size->y <= 2))
        return Error(
            fmt::format("size = [{}, {}] must be the smallest and the largest, 0 < smallest <= largest <= 2", size->x, size->y));
    if (colours.empty()) return Error("colours: at least one is needed");
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

double createProbability(double g, double lambdaCreate) { return g > lambdaCreate ? (g - lambdaCreate) / (1 - lambdaCreate) : 0; }

double deleteProbability(double g, double lambdaDelete) {
    return g < lambdaDelete ? (g - lambdaDelete) / (-1 - lambdaDelete) : 0;
}

PatternSearch::Found PatternSearch::run(const GreyImage& guide, ShapePattern pattern, const Options& options, int threads,
                                        const AskStop& askStop) {
    FANTASCOPE_CHECK(options.check().has_value() && !pattern.shapes.empty() && !guide.empty(),
                     "the search is given what it needs");
    pattern.height = std::min(options.rows, guide.height());
    pattern.width = std::max(1, static_cast<int>(std::lround(double(pattern.height) * guide.width() / guide.height())));
    const GreyImage compared = pattern.height == guide.height() ? guide : resized(guide, pattern.width, pattern.height);

    const Search search(compared, pattern.shapes, pattern.seed, options);
    Summary summary = search.run(threads, askStop, pattern.instances);
    for (ShapeInstance& instance : pattern.instances) instance.colour = colourOf(instance.id, pattern.seed, options.colours);
    assignGroups(pattern);
    return {std::move(pattern), std::move(summary)};
}

}  // namespace fantascope::pattern
