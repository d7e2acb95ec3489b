#include "pattern/search/refined_method.h"

#include "pattern/search/running_score.h"
#include "pattern/shape/streams.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::pattern {
namespace {

constexpr int kMoves = 1000;  // per iteration
// The share of the run before the temperature begins to fall. In this time the caller has to plan
// the run's length.
constexpr double kWarm = 0.12;
// The factor by which the temperature falls before the polish.
constexpr double kCoolest = 0.03;
// At the start, each instance takes the best of so many places.
constexpr int kTries = 4;
// How often dark places are looked for: so many times while the start is built, then every
// kLookEvery iterations.
constexpr std::size_t kLooks = 50;
constexpr int kLookEvery = 4;
// What an instance must improve, in pixels, to be created or kept. An instance hidden under others
// improves nothing.
constexpr double kWorth = 0.5;

// The step size of one kind of move. It grows if more than one in three moves are accepted, and
// shrinks if fewer are.
class Step {
public:
    explicit Step(double max) : step_(max), max_(max) {}
    double amount(Rng& rng) const { return step_ * rng.uniform(-kReach, kReach); }
    void learn(bool accepted) { step_ = std::clamp(step_ * (accepted ? kGrow : kShrink), kMin * max_, max_); }

private:
    static constexpr double kReach = 1.7;                               // uniform in +-1.7: a standard deviation of nearly 1
    static constexpr double kGrow = 1.02, kShrink = 0.99, kMin = 0.02;  // kGrow * kShrink^2 is nearly 1
    double step_, max_;
};

class RefinedSearch {
public:
    RefinedSearch(const SearchSpace& space, std::vector<ShapeInstance> given)
        : space_(space),
          scanner_(space.pixels().x, space.pixels().y),
          score_(space),
          rng_(streamSeed(space.seed(), {Stream::RefinedMoves})),
          maxInstances_(std::min<std::size_t>(space.options().instances, LayerCounts::kMax)),
          counts_(space.shapeCount()) {
        const glm::dvec2 sizes = space.sizes();
        typicalArea_ = std::pow(space.meanSide() * space.pixels().y, 2) * sizes.x * sizes.y;
        changeCost_ = space.options().changeCost * typicalArea_;
        continues_ = !given.empty();
        if (continues_)
            resume(std::move(given));
        else
            start();
    }

    PatternSearch::Summary run(std::vector<ShapeInstance>& instances, const PatternSearch::AskStop& askStop,
                               const PatternSearch::Plan& plan) {
        PatternSearch::Summary summary;
        const PatternSearch::Options& options = space_.options();
        std::optional<int> planned;
        if (options.iterations < std::numeric_limits<int>::max()) planned = options.iterations;
        for (;; ++summary.iterations) {
            const PatternSearch::Progress progress{summary.iterations, score_.z(), instances_.size() + kept_.size(),
                                                   [this] { return score_.picture(); }};
            if (const auto reason = whyStop(progress, planned, askStop)) {
                summary.reason = *reason;
                break;
            }
            if (!planned && plan)
                if (const auto total = plan(progress))
                    // At least so many that cooling has not begun: the run then equals one with
                    // this number as Options::iterations.
                    planned = std::max(*total, static_cast<int>(std::ceil(summary.iterations / kWarm)));
            temperature_ = temperatureAt(summary.iterations, planned);
            const double before = score_.z();
            if (summary.iterations % kLookEvery == 0) score_.findDarkPlaces();
            for (int i = 0; i < kMoves; ++i) move();
            summary.history.push_back({score_.z(), score_.z(), score_.z() < before});
        }
        summary.z = score_.z();
        summary.evaluations = evaluations_;
        instances = std::move(instances_);
        instances.insert(instances.end(), kept_.begin(), kept_.end());
        // By id, so that the stacking order does not depend on deletions.
        std::sort(instances.begin(), instances.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
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

    // The temperature, in pixels of full difference.
    double temperatureAt(int iteration, std::optional<int> planned) const {
        const PatternSearch::Options::Refined& refined = space_.options().refined;
        const double hot = refined.temperature * typicalArea_;
        const double progress = planned ? double(iteration) / *planned : 0;
        if (progress >= 1 - refined.polish) return 0;
        const double cooled = continues_ ? 1 : std::max(0.0, (progress - kWarm) / (1 - refined.polish - kWarm));
        return hot * std::pow(kCoolest, cooled);
    }

    // Places as many instances as together are as large as the guide's white, each where light is
    // lacking.
    void start() {
        const double light = space_.goal().wantedCoverage() * space_.pixels().x * space_.pixels().y;
        const auto wanted = std::min(maxInstances_, static_cast<std::size_t>(std::ceil(light / typicalArea_)));
        for (std::size_t count = 0; count < wanted; ++count) {
            if (count % std::max<std::size_t>(1, wanted / kLooks) == 0) score_.findDarkPlaces();
            double lowest = std::numeric_limits<double>::max();
            ShapeInstance best;
            for (int i = 0; i < kTries; ++i) {
                place(newInstance());
                if (const double change = score_.propose(kNothing, mask_); change < lowest) lowest = change, best = proposed_;
            }
            place(best);
            score_.propose(kNothing, mask_);
            keepNew();
        }
    }

    void resume(std::vector<ShapeInstance> given) {
        for (const ShapeInstance& instance : given) {
            place(instance);
            score_.propose(kNothing, mask_);
            score_.accept(kNothing, mask_);
            nextId_ = std::max(nextId_, instance.id + 1);
            ++counts_[instance.shape];
            if (isInRegion(instance)) {
                instances_.push_back(instance);
                drawn_.push_back(mask_);
                asGiven_.push_back(true);
            } else {
                kept_.push_back(instance);
            }
        }
    }

    bool isInRegion(const ShapeInstance& instance) const {
        const auto& region = space_.options().region;
        return !region || region->contains(instance.centre);
    }

    ShapeInstance newInstance() {
        const glm::ivec2 pixel = score_.darkPlace(rng_);
        return space_.randomInstance({pixel, pixel + 1}, rng_, counts_);
    }

    void move() {
        ++evaluations_;
        const double kind = rng_.uniform();
        if (kind < 0.03 || instances_.empty()) {
            if (instances_.size() + kept_.size() >= maxInstances_) return;
            place(newInstance());
            if (isGood(kNothing, mask_, -kWorth - changeCost_)) keepNew();
            return;
        }
        const std::size_t index = rng_.below(static_cast<std::uint32_t>(instances_.size()));
        if (kind < 0.06) {
            // Without a new instance its cost is saved.
            if (isGood(drawn_[index], kNothing, kWorth + (asGiven_[index] ? -changeCost_ : changeCost_))) forget(index);
        } else if (kind < 0.10) {
            ShapeInstance elsewhere = newInstance();
            elsewhere.id = continues_ ? nextId_ : instances_[index].id;
            if (replace(index, elsewhere) && continues_) ++nextId_;
        } else if (kind < 0.40) {
            ShapeInstance shifted = instances_[index];
            shifted.centre += shifted.size * glm::dvec2(shift_.amount(rng_), shift_.amount(rng_));
            shift_.learn(replace(index, shifted));
        } else if (kind < 0.55) {
            ShapeInstance turned = instances_[index];
            const double angle = turn_.amount(rng_);
            turned.rotation.z += angle;
            aboutPivot(turned, index, glm::dmat2(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)));
            turn_.learn(replace(index, turned));
        } else if (kind < 0.70) {
            ShapeInstance tilted = instances_[index];
            tilted.rotation.x += tilt_.amount(rng_);
            tilted.rotation.y += tilt_.amount(rng_);
            tilt_.learn(replace(index, tilted));
        } else {
            ShapeInstance scaled = instances_[index];
            const glm::dvec2 sizes = space_.sizes(scaled.shape);
            scaled.size = std::clamp(scaled.size * std::exp(scale_.amount(rng_)), sizes.x, sizes.y);
            aboutPivot(scaled, index, glm::dmat2(scaled.size / instances_[index].size));
            scale_.learn(replace(index, scaled));
        }
    }

    // Moves the instance so that a random one of its points stays in place: what fits there keeps
    // fitting.
    void aboutPivot(ShapeInstance& instance, std::size_t index, const glm::dmat2& change) {
        if (drawn_[index].empty()) return;
        const glm::dvec2 pivot = (glm::dvec2(drawn_[index].randomPixel(rng_)) + 0.5) / double(space_.pixels().y);
        instance.centre = pivot + change * (instance.centre - pivot);
    }

    // Replaces an instance by another one if that is good. True: it did.
    bool replace(std::size_t index, const ShapeInstance& instance) {
        place(space_.allowed(instance));
        if (!isInRegion(proposed_) || !isGood(drawn_[index], mask_, asGiven_[index] ? -changeCost_ : 0)) return false;
        score_.accept(drawn_[index], mask_);
        asGiven_[index] = false;
        std::swap(drawn_[index], mask_);
        --counts_[instances_[index].shape], ++counts_[proposed_.shape];
        instances_[index] = proposed_;
        return true;
    }

    // Whether a move is accepted: if it raises the goal by c, with probability exp((bonus - c) /
    // temperature). The limit of c is drawn first, so that the score can reject a move early.
    bool isGood(const PixelMask& out, const PixelMask& in, double bonus) {
        const double limit = bonus + (temperature_ > 0 ? -temperature_ * std::log(1 - rng_.uniform()) : 0);
        return score_.propose(out, in, limit) <= limit;
    }

    // Makes `instance` the proposed one and draws it into mask_.
    void place(const ShapeInstance& instance) {
        proposed_ = instance;
        mask_.draw(scanner_, space_.silhouette(instance.shape), {instance.centre, instance.size, instance.rotation});
    }
    void keepNew() {
        score_.accept(kNothing, mask_);
        instances_.push_back(proposed_);
        instances_.back().id = nextId_++;
        ++counts_[proposed_.shape];
        drawn_.push_back(mask_);
        asGiven_.push_back(false);
    }
    void forget(std::size_t index) {
        score_.accept(drawn_[index], kNothing);
        --counts_[instances_[index].shape];
        std::swap(instances_[index], instances_.back());
        std::swap(drawn_[index], drawn_.back());
        asGiven_[index] = asGiven_.back();
        instances_.pop_back();
        drawn_.pop_back();
        asGiven_.pop_back();
    }

    const SearchSpace& space_;
    SilhouetteScanner scanner_;
    RunningScore score_;
    Rng rng_;
    const std::size_t maxInstances_;
    double typicalArea_ = 1;  // pixels
    double changeCost_ = 0;   // pixels
    bool continues_ = false;  // it started from given instances
    double temperature_ = 0;
    // In sizes of the instance; in radians (turn_, tilt_); as natural logarithms of the size's
    // factor.
    Step shift_{0.3}, turn_{0.8}, tilt_{0.3}, scale_{0.3};
    std::vector<ShapeInstance> instances_;  // inside the region: may change
    std::vector<PixelMask> drawn_;          // of instances_
    std::vector<bool> asGiven_;             // of instances_: given, and not changed yet
    std::vector<ShapeInstance> kept_;       // outside the region
    std::vector<std::uint32_t> counts_;     // instances of each shape, in both
    std::uint32_t nextId_ = 1;
    std::int64_t evaluations_ = 0;
    ShapeInstance proposed_;
    PixelMask mask_;  // of proposed_
    const PixelMask kNothing;
};

}  // namespace

PatternSearch::Summary searchRefined(const SearchSpace& space, std::vector<ShapeInstance>& instances,
                                     const PatternSearch::AskStop& askStop, const PatternSearch::Plan& plan) {
    return RefinedSearch(space, std::move(instances)).run(instances, askStop, plan);
}

}  // namespace fantascope::pattern
