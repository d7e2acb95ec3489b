#include "theatre/search/dof_search.h"

#include "theatre/search/cma_es.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {

std::vector<std::size_t> limb(const Body& body, std::size_t joint) {
    std::vector<char> in(body.joints.size(), 0);
    in[joint] = 1;
    for (std::size_t i = joint + 1; i < in.size(); ++i) in[i] = in[body.joints[i].parent];
    if (body.joints[joint].parent != 0) in[body.joints[joint].parent] = 1;
    std::vector<std::size_t> dofs;
    for (std::size_t i = 1; i < in.size(); ++i)
        for (std::size_t k = 0; in[i] != 0 && k < body.joints[i].motion.size(); ++k) dofs.push_back(body.joints[i].first + k);
    return dofs;
}

// The part of `which` that belongs to one actor: his number, his first degree of freedom, and his
// range in `which`.
struct DofSearch::Part {
    std::size_t actor, first, from, to;
};

DofSearch::DofSearch(const PoseProblem& problem) : problem_(problem) {
    for (const Body& body : problem.actors) kinematics_.emplace_back(body);
}

std::vector<DofSearch::Part> DofSearch::partsOf(std::span<const std::size_t> which) const {
    std::vector<Part> parts;
    std::size_t first = 0, next = 0;
    for (std::size_t actor = 0; actor < problem_.actors.size(); ++actor) {
        const std::size_t from = next, end = first + problem_.actors[actor].dofs;
        while (next < which.size() && which[next] < end) ++next;
        if (next > from) parts.push_back({actor, first, from, next});
        first = end;
    }
    return parts;
}

double DofSearch::run(SceneEnergy& energy, std::span<double> dofs, std::span<const std::size_t> which, const Settings& settings,
                      Rng& rng, const std::function<bool()>& goesOn) {
    FANTASCOPE_CHECK(!which.empty(), "a search has something to change");
    const std::vector<Part> parts = partsOf(which);
    CmaEs::Options options;
    options.populationSize = settings.population;
    options.sigma = settings.sigma;
    // The stiffness may change the function on the way, so criteria that compare generations are
    // off or coarse.
    options.tolFun = options.tolHistFun = settings.converged;
    options.tolX = 0;
    options.stagnation = false;
    for (const Part& part : parts) {
        for (std::size_t i = part.from; i < part.to; ++i) options.scales.push_back(Body::scaleOf(which[i] - part.first));
        if (!settings.fullCovariance) options.blocks.push_back(static_cast<int>(part.to - part.from));
    }
    std::vector<double> start;
    for (const std::size_t dof : which) start.push_back(dofs[dof]);

    energy.pose(dofs, settings.stiffness);
    candidate_.assign(dofs.begin(), dofs.end());
    values_.resize(static_cast<std::size_t>(settings.population));
    CmaEs search(start, options);
    double best = 0;
    for (int generation = 0; generation < settings.generations && !search.stopReason(); ++generation) {
        if (const double stiffness = settings.stiffnessAt(generation); stiffness != energy.stiffness())
            energy.pose(dofs, stiffness);
        if (goesOn && !goesOn()) break;
        const std::span<double> candidates = search.ask(rng);
        for (std::size_t k = 0; k < values_.size(); ++k)
            values_[k] = evaluate(energy, parts, which, candidates.subspan(k * which.size(), which.size()));
        const auto least = std::min_element(values_.begin(), values_.end());
        best = *least;
        for (std::size_t i = 0; i < which.size(); ++i)
            dofs[which[i]] = candidates[static_cast<std::size_t>(least - values_.begin()) * which.size() + i];
        search.tell(values_);
    }
    for (const Part& part : parts) {
        const auto pose = dofs.subspan(part.first, problem_.actors[part.actor].dofs);
        std::ranges::copy(held(part.actor, pose), pose.begin());
    }
    return best;
}

// Clamps a candidate to the limits and gives its energy.
double DofSearch::evaluate(SceneEnergy& energy, std::span<const Part> parts, std::span<const std::size_t> which,
                           std::span<double> own) {
    for (std::size_t i = 0; i < which.size(); ++i) candidate_[which[i]] = own[i];
    for (const Part& part : parts) {
        const Body& body = problem_.actors[part.actor];
        const auto pose = std::span(candidate_).subspan(part.first, body.dofs);
        body.limit(pose);
        energy.pose(part.actor, held(part.actor, pose));
    }
    for (std::size_t i = 0; i < which.size(); ++i) own[i] = candidate_[which[i]];
    ++evaluations_;
    return energy.energy();
}

double DofSearch::Settings::stiffnessAt(int generation) const {
    if (!lastStiffness) return stiffness;
    const double growth = *lastStiffness / stiffness;
    return stiffness * std::pow(growth, double(generation) / generations);
}

void DofSearch::disturb(SceneEnergy& energy, std::span<double> dofs, Rng& rng, double stiffness) {
    const auto& actors = problem_.actors;
    const std::size_t actor = rng.below(static_cast<std::uint32_t>(actors.size()));
    const Body& body = actors[actor];
    const std::size_t first = problem_.firstDof(actor);
    std::vector<std::size_t> which;
    const double kind = rng.uniform();
    if (kind < 0.4) {
        for (std::size_t k = 0; k < body.dofs; ++k) which.push_back(first + k);
        run(energy, dofs, which, {.sigma = 0.3, .population = 16, .generations = 10, .stiffness = stiffness}, rng);
    } else if (kind < 0.8) {
        for (const std::size_t k : limb(body, 1 + rng.below(static_cast<std::uint32_t>(body.joints.size() - 1))))
            which.push_back(first + k);
        run(energy, dofs, which, {.sigma = 0.8, .population = 12, .generations = 8, .stiffness = stiffness}, rng);
    } else {
        const auto own = dofs.subspan(first, body.dofs);
        for (std::size_t k = 0; k < own.size(); ++k) own[k] += 0.4 * Body::scaleOf(k) * rng.normal();
        body.limit(own);
    }
}

// The pose with held contacts restored; the pose itself if nothing is held.
std::span<const double> DofSearch::held(std::size_t actor, std::span<const double> pose) {
    if (problem_.continuity.empty() || problem_.continuity[actor].contacts.empty()) return pose;
    held_.assign(pose.begin(), pose.end());
    kinematics_[actor].hold(held_, problem_.continuity[actor].contacts);
    return held_;
}

}  // namespace fantascope::theatre
