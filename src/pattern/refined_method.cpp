#include "pattern/refined_method.h"

#include "pattern/running_score.h"
#include "pattern/streams.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace fantascope::pattern {
namespace {

constexpr int kMoves = 1000;  // an iteration
// How often the lattice of the tone is moved, in iterations.
constexpr int kJitterEvery = 40;
// The share of the run before the temperature begins to fall; the caller has so long to say how long the run will be.
constexpr double kWarm = 0.05;
// How far the temperature falls until the polish.
constexpr double kCoolest = 1e-3;
// How often a dark place is looked for where light is wanted.
constexpr int kLooks = 8;
// Pixels that an instance must be worth: one that lies hidden under others is not.
constexpr double kWorth = 0.5;

class RefinedSearch {
public:
    explicit RefinedSearch(const SearchSpace& space)
        : space_(space),
          scanner_(space.pixels().x, space.pixels().y),
          score_(space),
          rng_(streamSeed(space.seed(), {Stream::RefinedMoves})) {
        const glm::dvec2 sizes = space.sizes();
        most_ = std::min<std::size_t>(space.options().instances, LayerCounts::kMost);
        typicalArea_ = std::pow(space.meanSide() * space.pixels().y, 2) * sizes.x * sizes.y;
        score_.jitter(rng_);
        start();
    }

    PatternSearch::Summary run(std::vector<ShapeInstance>& instances, const PatternSearch::AskStop& askStop,
                               const PatternSearch::Plan& plan) {
        PatternSearch::Summary summary;
        const PatternSearch::Options& options = space_.options();
        std::optional<int> planned;
        if (options.iterations < std::numeric_limits<int>::max()) planned = options.iterations;
        for (;; ++summary.iterations) {
            const PatternSearch::Progress progress{summary.iterations, score_.z(), instances_.size()};
            if (const auto reason = whyStop(progress, planned, askStop)) {
                summary.reason = *reason;
                break;
            }
            if (!planned && plan)
                if (const auto total = plan(progress))
                    // Nothing has cooled yet: the run is the one that --iterations with this number gives.
                    planned = std::max(*total, static_cast<int>(std::ceil(summary.iterations / kWarm)));
            temperature_ = temperatureAt(summary.iterations, planned);
            if (summary.iterations % kJitterEvery == kJitterEvery - 1) score_.jitter(rng_);
            const double before = score_.z();
            for (int i = 0; i < kMoves; ++i) move();
            summary.history.push_back({score_.z(), score_.z(), score_.z() < before});
        }
        summary.z = score_.z();
        summary.evaluations = evaluations_;
        // In the order of their ids: the order in which they lie on each other does not depend on deletions.
        std::sort(instances_.begin(), instances_.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
        instances = std::move(instances_);
        return summary;
    }

private:
    std::optional<PatternSearch::StopReason> whyStop(const PatternSearch::Progress& progress, std::optional<int> planned,
                                                     const PatternSearch::AskStop& askStop) const {
        if (progress.z < space_.options().targetZ) return PatternSearch::StopReason::TargetReached;
        if (progress.iterations >= space_.options().iterations) return PatternSearch::StopReason::Iterations;
        if (planned && progress.iterations >= *planned) return PatternSearch::StopReason::Time;
        return askStop(progress);
    }

    // In pixels of full difference.
    double temperatureAt(int iteration, std::optional<int> planned) const {
        const PatternSearch::Options::Refined& refined = space_.options().refined;
        const double hot = refined.temperature * typicalArea_;
        const double progress = planned ? double(iteration) / *planned : 0;
        if (progress >= 1 - refined.polish) return 0;
        const double cooled = std::max(0.0, (progress - kWarm) / (1 - refined.polish - kWarm));
        return hot * std::pow(kCoolest, cooled);
    }

    // As many instances as would light as much as the guide is white, each where the guide is light.
    void start() {
        const double light = space_.goal().mean() * space_.pixels().x * space_.pixels().y;
        const auto most = static_cast<std::size_t>(std::ceil(light / typicalArea_));
        while (instances_.size() < std::min(most, most_)) {
            place(space_.randomInstance(cellAround(lightPixel()), rng_));
            score_.propose({}, runs_);
            keepNew();
        }
    }

    glm::ivec2 randomPixel() {
        return {rng_.below(static_cast<std::uint32_t>(space_.pixels().x)),
                rng_.below(static_cast<std::uint32_t>(space_.pixels().y))};
    }
    // The lighter the guide, the likelier.
    glm::ivec2 lightPixel() {
        glm::ivec2 pixel = randomPixel();
        for (int look = 0; look < 8 * kLooks && rng_.uniform() >= space_.goal().value(pixel.x, pixel.y); ++look)
            pixel = randomPixel();
        return pixel;
    }
    glm::ivec2 darkPixel() {
        glm::ivec2 pixel = randomPixel();
        for (int look = 0; look < kLooks && !score_.lacksLight(pixel); ++look) pixel = randomPixel();
        return pixel;
    }
    static PixelRectangle cellAround(glm::ivec2 pixel) { return {pixel, pixel + 1}; }

    void move() {
        ++evaluations_;
        const double kind = rng_.uniform();
        if (kind < 0.05 || instances_.empty()) {
            if (instances_.size() >= most_) return;
            place(space_.randomInstance(cellAround(darkPixel()), rng_));
            if (isGood(score_.propose({}, runs_) + kWorth))
                keepNew();
            else
                score_.reject({});
            return;
        }
        const std::size_t index = rng_.below(static_cast<std::uint32_t>(instances_.size()));
        if (kind < 0.10) {
            if (isGood(score_.propose(drawn_[index], {}) - kWorth))
                forget(index);
            else
                score_.reject(drawn_[index]);
            return;
        }
        place(moved(instances_[index], kind));
        if (isGood(score_.propose(drawn_[index], runs_))) {
            score_.accept(runs_);
            std::swap(drawn_[index], runs_);
            instances_[index] = proposed_;
        } else {
            score_.reject(drawn_[index]);
        }
    }

    // Amounts are long-tailed: most moves are fine, some reach as far as the instance is large.
    ShapeInstance moved(ShapeInstance instance, double kind) {
        const auto amount = [&] {
            const double u = rng_.uniform(-1, 1);
            return u * u * u;
        };
        if (kind < 0.20) {
            const std::uint32_t id = instance.id;
            instance = space_.randomInstance(cellAround(darkPixel()), rng_);
            instance.id = id;
            return instance;
        }
        if (kind < 0.60) {
            instance.centre += instance.size * glm::dvec2(amount(), amount());
        } else if (kind < 0.75) {
            instance.rotation.z += std::numbers::pi * amount();
        } else if (kind < 0.85) {
            instance.rotation.x += 0.5 * amount();
            instance.rotation.y += 0.5 * amount();
        } else {
            instance.size *= std::exp(amount());
        }
        return space_.allowed(instance);
    }

    bool isGood(double change) { return change <= 0 || (temperature_ > 0 && rng_.uniform() < std::exp(-change / temperature_)); }

    // Draws the instance that is proposed into runs_.
    void place(const ShapeInstance& instance) {
        proposed_ = instance;
        runs_.clear();
        scanner_.scan(space_.silhouette(instance.shape), {instance.centre, instance.size, instance.rotation},
                      [&](int y, int begin, int end) {
                          runs_.push_back({y, begin, end});
                      });
    }
    void keepNew() {
        score_.accept(runs_);
        instances_.push_back(proposed_);
        instances_.back().id = nextId_++;
        drawn_.push_back(runs_);
    }
    void forget(std::size_t index) {
        score_.accept({});
        std::swap(instances_[index], instances_.back());
        std::swap(drawn_[index], drawn_.back());
        instances_.pop_back();
        drawn_.pop_back();
    }

    const SearchSpace& space_;
    SilhouetteScanner scanner_;
    RunningScore score_;
    Rng rng_;
    std::size_t most_ = 0;    // instances
    double typicalArea_ = 1;  // of an instance, pixels
    double temperature_ = 0;
    std::vector<ShapeInstance> instances_;
    std::vector<PixelRuns> drawn_;  // of each
    std::uint32_t nextId_ = 1;
    std::int64_t evaluations_ = 0;
    ShapeInstance proposed_;
    PixelRuns runs_;  // of proposed_
};

}  // namespace

PatternSearch::Summary searchRefined(const SearchSpace& space, std::vector<ShapeInstance>& instances,
                                     const PatternSearch::AskStop& askStop, const PatternSearch::Plan& plan) {
    return RefinedSearch(space).run(instances, askStop, plan);
}

}  // namespace fantascope::pattern
