#include "theatre/search/cma_es.h"

#include "core/check.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

// Numbers in brackets are the tutorial's equations, B.2 and B.3 its appendices. Steps y and all
// matrices are normalised by the step size and by `scales`: a candidate is x = mean + sigma *
// scales * y.

namespace fantascope::theatre {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::ptrdiff_t kLongestHistory = 20000;  // generations (B.3)
constexpr int kStagnationInterval = 10;            // generations; medians of a long history cost as much as an update

double square(double x) { return x * x; }

Eigen::Map<VectorXd> vectorOf(std::vector<double>& values) { return {values.data(), std::ssize(values)}; }
Eigen::Map<const VectorXd> vectorOf(const std::vector<double>& values) { return {values.data(), std::ssize(values)}; }

// w' (49), by rank.
VectorXd rawWeights(int populationSize) {
    VectorXd weights(populationSize);
    for (int i = 0; i < populationSize; ++i) weights[i] = std::log((populationSize + 1) / 2.0) - std::log(i + 1);
    return weights;
}

// mu_eff and mu_eff^-: the effective number of equal weights.
double effective(const VectorXd& weights) { return square(weights.sum()) / weights.squaredNorm(); }

}  // namespace

struct CmaEs::Block {
    Index first, size;
    double c1, cMu, cC;  // learning rates (56)-(58)
    VectorXd weights;    // by rank (53)
    VectorXd path;       // p_c
    MatrixXd C;          // only its lower triangle is kept
    MatrixXd B, BD;      // C = B D^2 B^T when it was last decomposed
    VectorXd D;
    double condition = 1;   // of C at that time; infinite if it was no longer positive definite
    int interval, age = 0;  // generations from one decomposition to the next, and since the last

    Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
    MatrixXd weighted, rotated;  // scratch of learn
    VectorXd rotatedMean;        // scratch of tell

    Block(Index first, Index size, const Options& options);
    // Updates the block from its part of the steps y (one candidate a column, best first) and of
    // the mean's step.
    void learn(const Eigen::Ref<const MatrixXd, 0, Eigen::OuterStride<>>& y, const Eigen::Ref<const VectorXd>& meanStep,
               double muEffective, bool learnsPath);
    void decompose();
};

CmaEs::Block::Block(Index first, Index size, const Options& options) : first(first), size(size), solver(size) {
    const double n = static_cast<double>(size);
    const VectorXd raw = rawWeights(options.populationSize), better = raw.cwiseMax(0), worse = raw.cwiseMin(0);
    const Index mu = options.populationSize / 2, others = options.populationSize - mu;
    const double muEffective = effective(raw.head(mu)), muEffectiveMinus = effective(raw.tail(others));

    cC = (4 + muEffective / n) / (n + 4 + 2 * muEffective / n);                                       // (56)
    c1 = 2 / (square(n + 1.3) + muEffective);                                                         // (57)
    cMu = std::min(1 - c1, 2 * (muEffective - 2 + 1 / muEffective) / (square(n + 2) + muEffective));  // (58)
    const double alpha =
        std::min({1 + c1 / cMu, 1 + 2 * muEffectiveMinus / (muEffective + 2), (1 - c1 - cMu) / (n * cMu)});  // (50)-(52)
    weights = better / better.sum() - alpha * worse / worse.sum();                                           // (53)
    if (!options.negativeWeights) weights.conservativeResize(mu);

    // The tutorial's interval (B.2) is n times shorter. Ours saves time and has no other effect,
    // since at most a tenth of the matrix is new.
    interval = std::max(1, static_cast<int>(0.1 / (c1 + cMu)));
    path = VectorXd::Zero(size);
    C = B = BD = MatrixXd::Identity(size, size);
    D = VectorXd::Ones(size);
    weighted.resize(size, weights.size());
    rotated.resize(size, weights.size() - mu);
    rotatedMean.resize(size);
}

void CmaEs::Block::learn(const Eigen::Ref<const MatrixXd, 0, Eigen::OuterStride<>>& y, const Eigen::Ref<const VectorXd>& meanStep,
                         double muEffective, bool learnsPath) {
    path *= 1 - cC;
    if (learnsPath) path += std::sqrt(cC * (2 - cC) * muEffective) * meanStep;  // (45)

    for (Index i = 0; i < weights.size(); ++i) weighted.col(i) = cMu * weights[i] * y.col(i);
    if (const Index worse = rotated.cols(); worse > 0) {
        // A step with a negative weight is rescaled to the expected length: |C^(-1/2) y| = |D^-1
        // B^T y| (46).
        rotated.noalias() = B.transpose() * y.rightCols(worse);
        for (Index i = 0; i < worse; ++i)
            weighted.rightCols(worse).col(i) *=
                static_cast<double>(size) / (rotated.col(i).cwiseQuotient(D).squaredNorm() + 1e-8);
    }
    C *= 1 + (learnsPath ? 0 : c1 * cC * (2 - cC)) - c1 - cMu * weights.sum();
    C.selfadjointView<Eigen::Lower>().rankUpdate(path, c1);
    C.triangularView<Eigen::Lower>() += weighted * y.leftCols(weights.size()).transpose();  // (47)
    if (++age >= interval) decompose();
}

void CmaEs::Block::decompose() {
    age = 0;
    solver.compute(C);                               // reads the lower half
    const VectorXd& squares = solver.eigenvalues();  // ascending
    const double least = squares[0], most = squares[size - 1];
    condition = least > 0 ? most / least : kInfinity;
    B = solver.eigenvectors();
    D = squares.cwiseMax(most * std::numeric_limits<double>::epsilon()).cwiseSqrt();
    BD.noalias() = B * D.asDiagonal();
}

Result<void> CmaEs::Options::check(std::size_t dimensions) const {
    const auto wrong = [](std::string what) { return Error("search: " + std::move(what)); };
    const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
    if (dimensions == 0) return wrong("there is nothing to search: the start has no coordinates");
    if (populationSize < 4) return wrong(fmt::format("population size {}: it must be at least 4", populationSize));
    if (!positive(sigma)) return wrong(fmt::format("sigma {}: the first step size must be a number > 0", sigma));
    if (!scales.empty() && scales.size() != dimensions)
        return wrong(fmt::format("{} scales for {} coordinates: give one for each or none", scales.size(), dimensions));
    for (std::size_t i = 0; i < scales.size(); ++i)
        if (!positive(scales[i])) return wrong(fmt::format("scale {} of coordinate {}: it must be a number > 0", scales[i], i));
    for (const int block : blocks)
        if (block < 1) return wrong(fmt::format("a block of {} coordinates: it must have at least 1", block));
    const std::int64_t sum = std::accumulate(blocks.begin(), blocks.end(), std::int64_t{0});
    if (!blocks.empty() && sum != static_cast<std::int64_t>(dimensions))
        return wrong(fmt::format("blocks of {} coordinates in all for a start of {}: they must be as many", sum, dimensions));
    for (const auto& [what, tolerance] : {std::pair{"tolFun", tolFun}, {"tolHistFun", tolHistFun}, {"tolX", tolX}})
        if (!(tolerance >= 0)) return wrong(fmt::format("{} {}: a tolerance must be >= 0", what, tolerance));
    for (const auto& [what, limit] : {std::pair{"tolXUp", tolXUp}, {"conditionCov", conditionCov}})
        if (!(limit > 1)) return wrong(fmt::format("{} {}: it must be > 1", what, limit));
    return {};
}

std::string_view CmaEs::name(StopReason reason) {
    constexpr std::string_view kNames[] = {"TolFun",       "TolHistFun",         "TolX",      "TolXUp", "ConditionCov",
                                           "NoEffectAxis", "NoEffectCoordinate", "Stagnation"};
    return kNames[static_cast<std::size_t>(reason)];
}

CmaEs::CmaEs(std::span<const double> mean, const Options& options)
    : options_(options),
      sigma_(options.sigma),
      bestValue_(kInfinity),
      mean_(mean.begin(), mean.end()),
      meanStep_(mean.size()),
      pathSigma_(mean.size()),
      bestPoint_(mean_) {
    FANTASCOPE_CHECK(options.check(mean.size()), "a search's options must pass check()");
    const int lambda = options.populationSize;
    const double n = static_cast<double>(mean.size());
    if (options_.scales.empty()) options_.scales.assign(mean.size(), 1.0);
    if (options_.blocks.empty()) options_.blocks.assign(1, static_cast<int>(mean.size()));

    muEffective_ = effective(rawWeights(lambda).head(lambda / 2));
    cSigma_ = (muEffective_ + 2) / (n + muEffective_ + 5);                                   // (55)
    dSigma_ = 1 + 2 * std::max(0.0, std::sqrt((muEffective_ - 1) / (n + 1)) - 1) + cSigma_;  // (55)
    chi_ = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * square(n)));                          // E |N(0, I)|
    blocks_.reserve(
        options_.blocks.size());  // an Eigen solver must not be moved before its first use: it would copy uninitialised members
    Index first = 0;
    for (const int size : options_.blocks) {
        blocks_.emplace_back(first, size, options);
        first += size;
    }

    const std::size_t all = mean.size() * static_cast<std::size_t>(lambda);
    normals_.resize(all), candidates_.resize(all), steps_.resize(all);
    values_.resize(static_cast<std::size_t>(lambda)), ranking_.resize(static_cast<std::size_t>(lambda));
    for (auto* history : {&bestValues_, &medianValues_, &sorted_}) history->reserve(kLongestHistory);
}

CmaEs::CmaEs(CmaEs&&) noexcept = default;
CmaEs& CmaEs::operator=(CmaEs&&) noexcept = default;
CmaEs::~CmaEs() = default;

std::span<double> CmaEs::ask(Rng& rng) {
    for (double& normal : normals_) normal = rng.normal();  // (38)
    const Index n = std::ssize(mean_), lambda = options_.populationSize;
    const Eigen::Map<const MatrixXd> z(normals_.data(), n, lambda);
    Eigen::Map<MatrixXd> x(candidates_.data(), n, lambda);
    const auto mean = vectorOf(std::as_const(mean_)), scales = vectorOf(std::as_const(options_.scales));
    for (const Block& block : blocks_)
        x.middleRows(block.first, block.size).noalias() = block.BD * z.middleRows(block.first, block.size);  // (39)
    for (Index k = 0; k < lambda; ++k) x.col(k) = mean + sigma_ * scales.cwiseProduct(x.col(k));             // (40)
    return candidates_;
}

void CmaEs::tell(std::span<const double> values) {
    FANTASCOPE_CHECK(values.size() == values_.size(), "tell wants a value for each candidate");
    rankCandidates(values);
    const Index n = std::ssize(mean_), lambda = options_.populationSize, mu = lambda / 2;
    const Eigen::Map<const MatrixXd> x(candidates_.data(), n, lambda);
    const auto scales = vectorOf(std::as_const(options_.scales));
    auto mean = vectorOf(mean_);
    Eigen::Map<MatrixXd> y(steps_.data(), n, lambda);  // best first
    for (Index i = 0; i < lambda; ++i) y.col(i) = (x.col(ranking_[i]) - mean).cwiseQuotient(sigma_ * scales);

    auto meanStep = vectorOf(meanStep_);
    meanStep.noalias() = y.leftCols(mu) * blocks_.front().weights.head(mu);  // (41)
    mean += sigma_ * scales.cwiseProduct(meanStep);                          // (42)

    auto path = vectorOf(pathSigma_);
    path *= 1 - cSigma_;
    const double push = std::sqrt(cSigma_ * (2 - cSigma_) * muEffective_);
    for (Block& block : blocks_) {  // C^(-1/2) = B D^-1 B^T
        block.rotatedMean.noalias() = block.B.transpose() * meanStep.segment(block.first, block.size);
        block.rotatedMean.array() *= push / block.D.array();
        path.segment(block.first, block.size).noalias() += block.B * block.rotatedMean;  // (43)
    }
    ++generation_;
    const double length = path.norm();
    sigma_ *= std::exp(cSigma_ / dSigma_ * (length / chi_ - 1));  // (44)

    // h_sigma: a long path means that sigma is far too small. Then the matrix must not learn from
    // the path.
    const double unbiased = length / std::sqrt(1 - std::pow(1 - cSigma_, 2 * generation_));
    const bool learnsPath = unbiased < (1.4 + 2 / (static_cast<double>(n) + 1)) * chi_;
    for (Block& block : blocks_)
        block.learn(y.middleRows(block.first, block.size), meanStep.segment(block.first, block.size), muEffective_, learnsPath);
    stopReason_ = reasonToStop();
}

// Ranks the candidates, best first; updates the best of all so far and the histories of (B.3).
void CmaEs::rankCandidates(std::span<const double> values) {
    std::transform(values.begin(), values.end(), values_.begin(),
                   [](double value) { return std::isfinite(value) ? value : kInfinity; });
    std::iota(ranking_.begin(), ranking_.end(), 0);
    std::sort(ranking_.begin(), ranking_.end(),
              [this](int a, int b) { return std::pair(values_[a], a) < std::pair(values_[b], b); });

    const double best = values_[ranking_.front()];
    if (best < bestValue_) {
        bestValue_ = best;
        std::copy_n(candidates_.begin() + ranking_.front() * std::ssize(mean_), mean_.size(), bestPoint_.begin());
    }
    for (auto* history : {&bestValues_, &medianValues_})
        if (std::ssize(*history) == kLongestHistory) history->erase(history->begin());
    bestValues_.push_back(best);
    medianValues_.push_back(values_[ranking_[ranking_.size() / 2]]);
}

// Whether the newest 30 % of the history are no better than its first 30 %, by the median.
bool CmaEs::stagnates(const std::vector<double>& history) {
    const auto n = std::ssize(mean_), lambda = std::ptrdiff_t{options_.populationSize};
    const std::ptrdiff_t window = std::min(std::max(std::ptrdiff_t{generation_ / 5}, 120 + 30 * n / lambda), kLongestHistory);
    const std::ptrdiff_t part = window * 3 / 10;
    if (std::ssize(history) < window) return false;
    const auto median = [&](auto begin) {
        sorted_.assign(begin, begin + part);
        std::nth_element(sorted_.begin(), sorted_.begin() + part / 2, sorted_.end());
        return sorted_[static_cast<std::size_t>(part / 2)];
    };
    return median(history.end() - part) >= median(history.end() - window);
}

std::optional<CmaEs::StopReason> CmaEs::reasonToStop() {
    const std::size_t window = 10 + static_cast<std::size_t>(std::ceil(30.0 * std::ssize(mean_) / options_.populationSize));
    if (bestValues_.size() >= window) {
        const auto [least, most] =
            std::minmax_element(bestValues_.end() - static_cast<std::ptrdiff_t>(window), bestValues_.end());
        // An infinite value makes the range infinite or NaN, and neither stops the search. Equal
        // values do: 0 <= 0.
        if (*most - *least <= options_.tolHistFun) return StopReason::TolHistFun;
        if (std::max(*most, values_[ranking_.back()]) - *least <= options_.tolFun) return StopReason::TolFun;
    }
    const double tolX = options_.tolX * options_.sigma;
    const auto isShort = [&](const Block& block) {
        return sigma_ * std::sqrt(block.C.diagonal().maxCoeff()) < tolX && sigma_ * block.path.cwiseAbs().maxCoeff() < tolX;
    };
    if (std::all_of(blocks_.begin(), blocks_.end(), isShort)) return StopReason::TolX;
    for (const Block& block : blocks_) {
        if (sigma_ * block.D[block.size - 1] > options_.tolXUp * options_.sigma) return StopReason::TolXUp;
        if (!(block.condition <= options_.conditionCov)) return StopReason::ConditionCov;
    }
    // Stops if a fraction of a standard deviation is lost to rounding, along one axis (a different
    // one each generation) or along any coordinate.
    const auto mean = vectorOf(std::as_const(mean_)), scales = vectorOf(std::as_const(options_.scales));
    for (const Block& block : blocks_) {
        const auto m = mean.segment(block.first, block.size).array(), unit = scales.segment(block.first, block.size).array();
        if ((m == m + 0.2 * sigma_ * unit * block.C.diagonal().array().sqrt()).any()) return StopReason::NoEffectCoordinate;
        const Index axis = generation_ % block.size;
        if ((m == m + 0.1 * sigma_ * unit * block.BD.col(axis).array()).all()) return StopReason::NoEffectAxis;
    }
    if (options_.stagnation && generation_ % kStagnationInterval == 0 && stagnates(bestValues_) && stagnates(medianValues_))
        return StopReason::Stagnation;
    return std::nullopt;
}

}  // namespace fantascope::theatre
