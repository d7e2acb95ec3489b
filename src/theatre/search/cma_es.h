#pragma once
// Evolution strategy with covariance matrix adaptation: N. Hansen, The CMA Evolution Strategy: A
// Tutorial, 2016 (arXiv:1604.00772).

#include "core/random.h"
#include "core/result.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// Minimises a function of many variables of which nothing but values is known. Each generation is
// asked for, evaluated by the caller in any way and order, and told:
//
//     while (!search.stopReason()) {
//         const std::span<double> candidates = search.ask(rng);
//         for (...) values[k] = f(candidates.subspan(k * n, n));
//         search.tell(values);
//     }
//
// The tutorial's default strategy. Its covariance matrix may be made of blocks along the diagonal,
// for variables known to belong together (the joints of one actor): each block learns its own
// matrix and path at the faster rates of its own dimension, while the ranking and the step size are
// common.
//
// Only the order of the values matters, save for the stop criteria that look at them. Same start,
// options and Rng: same bytes. No generation allocates, but for one vector inside Eigen when a
// block is decomposed. Thread: one at a time.
class CmaEs {
public:
    struct Options {
        int populationSize = 40;       // lambda
        double sigma = 1;              // the first step size: sigma * scales are the first standard deviations
        std::vector<double> scales{};  // one a coordinate, in its unit; none: all 1
        std::vector<int> blocks{};     // sizes of consecutive blocks; none: one, which is the full strategy
        // Whether the worse half of a generation narrows the matrix (53). That takes up to a
        // quarter fewer evaluations, but the search breaks down where many candidates are repaired;
        // a penalty on candidates left where they are does no harm.
        bool negativeWeights = false;

        // When to stop (B.3). A tolerance of 0 or an infinite limit turns its criterion off, but
        // equal values always stop, and so does a step that rounding swallows.
        double tolFun = 1e-11;  // range of the best values of the last 10 + ceil(30 n / lambda) generations and of all the newest
        double tolHistFun = 1e-12;   // range of those best values alone
        double tolX = 1e-12;         // all standard deviations and path components, against the first sigma
        double tolXUp = 1e4;         // the longest axis, against the first sigma
        double conditionCov = 1e14;  // condition number of a block
        bool stagnation = true;      // neither the best nor the middle values fall any more

        // What is wrong with them for a start of `dimensions` coordinates.
        Result<void> check(std::size_t dimensions) const;
    };

    enum class StopReason { TolFun, TolHistFun, TolX, TolXUp, ConditionCov, NoEffectAxis, NoEffectCoordinate, Stagnation };
    static std::string_view name(StopReason reason);

    struct Best {
        double value;                   // infinite while no value was finite
        std::span<const double> point;  // valid until the next tell; the start while no value was finite
    };

    // `mean` is where to start; the options must pass check(mean.size()).
    CmaEs(std::span<const double> mean, const Options& options);
    CmaEs(CmaEs&&) noexcept;
    CmaEs& operator=(CmaEs&&) noexcept;
    ~CmaEs();

    // A new generation: populationSize candidates of dimensions() coordinates, one after the other,
    // valid until the next ask. A candidate may be repaired in place, for instance moved within
    // bounds; what stands there when tell is called is what its value belongs to. It must be
    // finite, and near: a point far outside the distribution shakes it.
    std::span<double> ask(Rng& rng);

    // The value of each candidate. One that is not a finite number is as bad as can be; among
    // equals the first is the better.
    void tell(std::span<const double> values);

    std::size_t dimensions() const { return mean_.size(); }
    std::span<const double> mean() const { return mean_; }                // the distribution's centre, the best guess under noise
    double sigma() const { return sigma_; }                               // in units of `scales`
    int generation() const { return generation_; }                        // how many were told
    Best best() const { return {bestValue_, bestPoint_}; }                // of all candidates so far
    std::optional<StopReason> stopReason() const { return stopReason_; }  // after the newest generation

private:
    struct Block;

    void rankCandidates(std::span<const double> values);
    std::optional<StopReason> reasonToStop();
    bool stagnates(const std::vector<double>& history);

    Options options_;
    double sigma_;
    int generation_ = 0;
    double bestValue_;
    std::optional<StopReason> stopReason_;
    double muEffective_, cSigma_, dSigma_, chi_;  // of the step size: (55), and the length to expect of a random path

    std::vector<double> mean_, meanStep_, pathSigma_, bestPoint_;
    std::vector<double> normals_, candidates_, steps_;  // populationSize times n
    std::vector<double> values_;                        // by candidate
    std::vector<int> ranking_;                          // candidates, best first
    std::vector<Block> blocks_;
    std::vector<double> bestValues_, medianValues_, sorted_;  // by generation, for the stop criteria; their scratch
};

}  // namespace fantascope::theatre
