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

// Minimises a black-box function of many variables. Each generation is asked for, evaluated by the
// caller in any order, and told:
//
//     while (!search.stopReason()) {
//         const std::span<double> candidates = search.ask(rng);
//         for (...) values[k] = f(candidates.subspan(k * n, n));
//         search.tell(values);
//     }
//
// It is the tutorial's default strategy. The covariance matrix may be block-diagonal, for variables
// known to belong together (the joints of one actor). Each block learns its own matrix and path at
// the faster rates of its own dimension; the ranking and the step size are common.
//
// Only the ranking of the values matters, except in the stop criteria. The same start, options and
// Rng give the same bytes. A generation does not allocate, except for one vector inside Eigen when
// a block is decomposed. Thread: one at a time.
class CmaEs {
public:
    struct Options {
        int populationSize = 40;       // lambda
        double sigma = 1;              // the first step size: sigma * scales are the first standard deviations
        std::vector<double> scales{};  // one a coordinate, in its unit; empty: all 1
        std::vector<int> blocks{};     // sizes of consecutive blocks; empty: one block, which is the full strategy
        // Whether the worse half of a generation has negative weights in the covariance update
        // (53). This saves up to a quarter of the evaluations, but the search fails if many
        // candidates are repaired. A penalty on candidates that are left where they are does no
        // harm.
        bool negativeWeights = false;

        // When to stop (B.3). A tolerance of 0 or an infinite limit turns its criterion off. Equal
        // values always stop the search, and so does a step that is lost to rounding.
        double tolFun = 1e-11;  // range of the best values of the last 10 + ceil(30 n / lambda) generations and of all the newest
        double tolHistFun = 1e-12;   // range of those best values alone
        double tolX = 1e-12;         // all standard deviations and path components, against the first sigma
        double tolXUp = 1e4;         // the longest axis, against the first sigma
        double conditionCov = 1e14;  // condition number of a block
        bool stagnation = true;      // neither the best nor the median values fall any more

        // Error: names the option that is invalid for a start of `dimensions` coordinates.
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
    // bounds; its value must belong to the repaired candidate. It must stay finite and near, since
    // a point far outside the distribution disturbs the adaptation.
    std::span<double> ask(Rng& rng);

    // Takes the value of each candidate. A value that is not finite ranks last. Among equal values
    // the first ranks better.
    void tell(std::span<const double> values);

    std::size_t dimensions() const { return mean_.size(); }
    std::span<const double> mean() const { return mean_; }                // the distribution's centre, the best guess under noise
    double sigma() const { return sigma_; }                               // in units of `scales`
    int generation() const { return generation_; }                        // how many generations were told
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
    double muEffective_, cSigma_, dSigma_, chi_;  // of the step size: (55), and the expected length of a random path

    std::vector<double> mean_, meanStep_, pathSigma_, bestPoint_;
    std::vector<double> normals_, candidates_, steps_;  // populationSize times n
    std::vector<double> values_;                        // by candidate
    std::vector<int> ranking_;                          // candidates, best first
    std::vector<Block> blocks_;
    std::vector<double> bestValues_, medianValues_, sorted_;  // by generation, for the stop criteria; their scratch
};

}  // namespace fantascope::theatre
