#include "theatre/search/freedom_search.h"

#include "theatre/search/cma_es.h"

#include "core/check.h"

#include <algorithm>

namespace fantascope::theatre {

std::vector<std::size_t> limb(const Body& body, std::size_t joint) {
    std::vector<char> in(body.joints.size(), 0);
    in[joint] = 1;
    for (std::size_t i = joint + 1; i < in.size(); ++i) in[i] = in[body.joints[i].parent];
    if (body.joints[joint].parent != 0) in[body.joints[joint].parent] = 1;
    std::vector<std::size_t> freedoms;
    for (std::size_t i = 1; i < in.size(); ++i)
        for (std::size_t k = 0; in[i] != 0 && k < body.joints[i].motion.size(); ++k) freedoms.push_back(body.joints[i].first + k);
    return freedoms;
}

FreedomSearch::FreedomSearch(const PoseProblem& problem) : problem_(problem) {
    for (const Body& body : problem.actors) kinematics_.emplace_back(body);
}

double FreedomSearch::run(SceneEnergy& energy, std::span<double> freedoms, std::span<const std::size_t> which,
                          const Settings& settings, Rng& rng, const std::function<bool(int)>& beforeGeneration) {
    FANTASCOPE_CHECK(!which.empty(), "a search has something to change");
    // Those of each actor that plays: his number, his first freedom, and which of `which` are his.
    struct Part {
        std::size_t actor, first, from, to;
    };
    std::vector<Part> parts;
    CmaEs::Options options;
    options.populationSize = settings.population;
    options.sigma = settings.sigma;
    // A search that is ended by its generations may change on the way what is searched.
    options.tolFun = options.tolHistFun = settings.converged;
    options.tolX = 0;
    options.stagnation = false;
    std::vector<double> start;
    std::size_t first = 0, next = 0;
    for (std::size_t actor = 0; actor < problem_.actors.size(); ++actor) {
        const std::size_t from = next, end = first + problem_.actors[actor].freedoms;
        for (; next < which.size() && which[next] < end; ++next) {
            options.scales.push_back(Body::scaleOf(which[next] - first));
            start.push_back(freedoms[which[next]]);
        }
        if (next > from) {
            parts.push_back({actor, first, from, next});
            if (!settings.fullCovariance) options.blocks.push_back(static_cast<int>(next - from));
        }
        first = end;
    }

    energy.pose(freedoms);
    candidate_.assign(freedoms.begin(), freedoms.end());
    values_.resize(static_cast<std::size_t>(settings.population));
    CmaEs search(start, options);
    double best = 0;
    for (int generation = 0; generation < settings.generations && !search.stopReason(); ++generation) {
        if (beforeGeneration && !beforeGeneration(generation)) break;
        const std::span<double> candidates = search.ask(rng);
        for (std::size_t k = 0; k < values_.size(); ++k) {
            const auto own = candidates.subspan(k * which.size(), which.size());
            for (std::size_t i = 0; i < which.size(); ++i) candidate_[which[i]] = own[i];
            for (const Part& part : parts) {
                const Body& body = problem_.actors[part.actor];
                const auto pose = std::span(candidate_).subspan(part.first, body.freedoms);
                body.limit(pose);
                energy.pose(part.actor, held(part.actor, pose));
            }
            for (std::size_t i = 0; i < which.size(); ++i) own[i] = candidate_[which[i]];
            values_[k] = energy.energy();
            ++evaluations_;
        }
        const auto least = std::min_element(values_.begin(), values_.end());
        best = *least;
        for (std::size_t i = 0; i < which.size(); ++i)
            freedoms[which[i]] = candidates[static_cast<std::size_t>(least - values_.begin()) * which.size() + i];
        search.tell(values_);
    }
    for (const Part& part : parts) {
        const auto pose = freedoms.subspan(part.first, problem_.actors[part.actor].freedoms);
        std::ranges::copy(held(part.actor, pose), pose.begin());
    }
    return best;
}

void FreedomSearch::disturb(SceneEnergy& energy, std::span<double> freedoms, Rng& rng) {
    const auto& actors = problem_.actors;
    const std::size_t actor = rng.below(static_cast<std::uint32_t>(actors.size()));
    const Body& body = actors[actor];
    const std::size_t first = problem_.firstFreedom(actor);
    std::vector<std::size_t> which;
    const double kind = rng.uniform();
    if (kind < 0.4) {
        for (std::size_t k = 0; k < body.freedoms; ++k) which.push_back(first + k);
        run(energy, freedoms, which, {0.3, 16, 10}, rng);
    } else if (kind < 0.8) {
        for (const std::size_t k : limb(body, 1 + rng.below(static_cast<std::uint32_t>(body.joints.size() - 1))))
            which.push_back(first + k);
        run(energy, freedoms, which, {0.8, 12, 8}, rng);
    } else {
        const auto own = freedoms.subspan(first, body.freedoms);
        for (std::size_t k = 0; k < own.size(); ++k) own[k] += 0.4 * Body::scaleOf(k) * rng.normal();
        body.limit(own);
    }
}

// The pose itself, if nothing is held.
std::span<const double> FreedomSearch::held(std::size_t actor, std::span<const double> pose) {
    if (problem_.continuity.empty() || problem_.continuity[actor].contacts.empty()) return pose;
    held_.assign(pose.begin(), pose.end());
    kinematics_[actor].hold(held_, problem_.continuity[actor].contacts);
    return held_;
}

}  // namespace fantascope::theatre
