#include "pattern/search/paper_method.h"

#include "pattern/search/coverage.h"
#include "pattern/search/goal.h"
#include "pattern/shape/streams.h"

#include "core/parallel.h"
#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

// The random start has this share of the maximum number of instances, so that the number can grow
// and shrink.
constexpr double kStartShare = 0.5;
// The initial share of widely perturbed instances, and the factor by which it adapts.
constexpr double kFirstShare = 0.02, kShareStep = 1.1;

// A candidate for the solution, drawn and evaluated.
struct Candidate {
    std::vector<ShapeInstance> instances;
    std::uint32_t nextId = 1;  // not given yet
    Coverage coverage;         // I'
    double z = 1;
};

// What the difference image says about one reference solution.
struct Heuristics {
    struct Vacancy {
        PixelRectangle cell;
        double createProbability;  // p_cre
    };
    std::vector<Vacancy> vacancies;       // the lattice cells with g_i > lambda_cre
    std::vector<double> instanceIndices;  // g_i of the instance cells, in the order of the reference's instances
};

class PaperSearch {
public:
    explicit PaperSearch(const SearchSpace& space)
        : space_(space), options_(space.options()), paper_(options_.paper), goal_(space.goal()), pixels_(space.pixels()) {
        const double cellSide = paper_.latticeCell * space.meanSide() * std::sqrt(space.sizes().x * space.sizes().y);
        const int side = std::max(1, static_cast<int>(std::lround(cellSide * pixels_.y)));
        for (int y = 0; y < pixels_.y; y += side)
            for (int x = 0; x < pixels_.x; x += side) lattice_.push_back({{x, y}, glm::min(glm::ivec2(x, y) + side, pixels_)});
    }

    // Section 4.1 of the paper, from the random start to a reason to stop.
    PatternSearch::Summary run(std::vector<ShapeInstance>& instances, int threads, const PatternSearch::AskStop& askStop) const {
        PatternSearch::Summary summary;
        Candidate reference = randomPattern();
        Heuristics heuristics = examine(reference);
        std::vector<Candidate> candidates(static_cast<std::size_t>(paper_.candidates), reference);
        double share = kFirstShare;
        for (;; ++summary.iterations) {
            const auto reason = whyStop(summary.iterations, reference, askStop);
            if (reason) {
                summary.reason = *reason;
                break;
            }
            parallelFor(paper_.candidates, threads, [&](int slot) {
                Rng rng(
                    streamSeed(space_.seed(), {Stream::SearchCandidate, std::uint64_t(summary.iterations), std::uint64_t(slot)}));
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
        summary.evaluations = 1 + std::int64_t{paper_.candidates} * summary.iterations;
        instances = std::move(reference.instances);
        return summary;
    }

private:
    // The paper's three stop criteria, and a number of iterations, by which a run that the clock
    // stopped can be repeated.
    std::optional<PatternSearch::StopReason> whyStop(int iterations, const Candidate& reference,
                                                     const PatternSearch::AskStop& askStop) const {
        if (reference.z < options_.targetZ) return PatternSearch::StopReason::TargetReached;
        if (iterations >= options_.iterations) return PatternSearch::StopReason::Iterations;
        return askStop({iterations, reference.z, reference.instances.size(), [&] { return reference.coverage.picture(); }});
    }

    Candidate randomPattern() const {
        Candidate start{.instances = {}, .coverage = Coverage(pixels_.x, pixels_.y)};
        Rng rng(streamSeed(space_.seed(), {Stream::SearchStart}));
        const auto count = static_cast<std::uint32_t>(std::ceil(options_.instances * kStartShare));
        while (start.instances.size() < count) create({{0, 0}, pixels_}, rng, start);
        evaluate(start);
        return start;
    }

    // Compares the reference solution with the guide cell by cell.
    Heuristics examine(const Candidate& reference) const {
        Heuristics found;
        for (const PixelRectangle& cell : lattice_) {
            const double probability = createProbability(goal_.differenceIndex(cell, reference.coverage), paper_.lambdaCreate);
            if (probability > 0) found.vacancies.push_back({cell, probability});
        }
        for (const ShapeInstance& instance : reference.instances)
            found.instanceIndices.push_back(goal_.differenceIndex(instanceCell(instance), reference.coverage));
        return found;
    }

    // Makes `candidate` from the reference solution: deletes, reduces, increases and perturbs its
    // instances, creates new ones, and evaluates the result.
    void adjust(const Candidate& reference, const Heuristics& heuristics, double share, Rng& rng, Candidate& candidate) const {
        candidate.instances.clear();
        candidate.nextId = reference.nextId;
        for (std::size_t i = 0; i < reference.instances.size(); ++i) {
            const double g = heuristics.instanceIndices[i];
            if (rng.uniform() < deleteProbability(g, paper_.lambdaDelete)) continue;
            candidate.instances.push_back(adjusted(reference.instances[i], g, share, rng));
        }
        std::vector<const PixelRectangle*> cells;
        for (const Heuristics::Vacancy& vacancy : heuristics.vacancies)
            if (rng.uniform() < vacancy.createProbability) cells.push_back(&vacancy.cell);
        // In random order: if there is room for only some new instances, every cell has the same
        // chance.
        for (std::size_t i = 0; i < cells.size() && candidate.instances.size() < options_.instances; ++i) {
            std::swap(cells[i], cells[i + rng.below(static_cast<std::uint32_t>(cells.size() - i))]);
            create(*cells[i], rng, candidate);
        }
        evaluate(candidate);
    }

    // The paper perturbs every instance by "a small amount of random perturbation". If all amounts
    // were alike, the gain of one perturbation would be undone by the rest, and hardly any
    // candidate would be better. So the amounts are long-tailed: largestAmount * u^(1 / share).
    // About `share` of them exceed 1/e of the maximum, and most are a fraction of a pixel. The
    // share adapts, see adapted().
    ShapeInstance adjusted(ShapeInstance instance, double g, double share, Rng& rng) const {
        const double amount = paper_.largestAmount * std::pow(rng.uniform(), 1 / share);
        if (g < paper_.lambdaReduce) instance.size *= 1 - std::min(amount, 1.0) * rng.uniform();
        if (g > paper_.lambdaIncrease) instance.size *= 1 + amount * rng.uniform();
        const glm::dvec2 sizes = space_.sizes(instance.shape);
        instance.size = std::clamp(instance.size, sizes.x, sizes.y);

        const auto shift = [&] { return amount * rng.uniform(-1, 1); };
        instance.centre.x += instance.size * shift();
        instance.centre.y += instance.size * shift();
        instance.rotation.x += shift();
        instance.rotation.y += shift();
        instance.rotation.z += shift();
        return space_.allowed(instance);
    }

    // A success rule after Rechenberg (1973): the share grows after an acceptance and shrinks after
    // a rejection, such that it is stationary at the wanted success rate. At least one instance
    // moves widely, at most all do.
    double adapted(double share, bool accepted, std::size_t instances) const {
        const double down = paper_.successRate / (1 - paper_.successRate);
        share *= std::pow(kShareStep, accepted ? 1 : -down);
        return std::clamp(share, 1 / (1 + static_cast<double>(instances)), 1.0);
    }

    void create(const PixelRectangle& cell, Rng& rng, Candidate& candidate) const {
        candidate.instances.push_back(space_.randomInstance(cell, rng));
        candidate.instances.back().id = candidate.nextId++;
    }

    void evaluate(Candidate& candidate) const {
        candidate.coverage.clear();
        for (const ShapeInstance& instance : candidate.instances)
            candidate.coverage.add(space_.silhouette(instance.shape), {instance.centre, instance.size, instance.rotation});
        candidate.z = goal_.z(candidate.coverage);
    }

    // The square around the instance's centre, clipped to the picture; at least one pixel.
    PixelRectangle instanceCell(const ShapeInstance& instance) const {
        const double half = paper_.instanceCell * space_.side(instance.shape) * instance.size / 2;
        const glm::dvec2 begin = glm::round((instance.centre - half) * double(pixels_.y)),
                         end = glm::round((instance.centre + half) * double(pixels_.y));
        PixelRectangle cell{glm::clamp(glm::ivec2(begin), glm::ivec2(0), pixels_ - 1), glm::ivec2(0)};
        cell.end = glm::clamp(glm::ivec2(end), cell.begin + 1, pixels_);
        return cell;
    }

    const SearchSpace& space_;
    const Options& options_;
    const Options::Paper& paper_;
    const Goal& goal_;
    const glm::ivec2 pixels_;
    std::vector<PixelRectangle> lattice_;  // the evaluation lattice
};

}  // namespace

double createProbability(double g, double lambdaCreate) { return g > lambdaCreate ? (g - lambdaCreate) / (1 - lambdaCreate) : 0; }

double deleteProbability(double g, double lambdaDelete) {
    return g < lambdaDelete ? (g - lambdaDelete) / (-1 - lambdaDelete) : 0;
}

PatternSearch::Summary searchByPaper(const SearchSpace& space, std::vector<ShapeInstance>& instances, int threads,
                                     const PatternSearch::AskStop& askStop) {
    return PaperSearch(space).run(instances, threads, askStop);
}

}  // namespace fantascope::pattern
