#pragma once

#include "theatre/energy/pose_problem.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// Discovery of principal poses (Won & Lee 2016, section 4): poses of all actors at once whose
// shadow is the target's.
//
// A trial's length is a number of evaluations of the energy, never a time: the same problem, seed
// and options give the same poses, byte for byte, on any number of threads.
// Thread: reentrant.
class PoseSearch {
public:
    enum class Method {
        Refined,  // refined_method.h
        Paper     // paper_method.h
    };
    struct Options {
        Method method = Method::Refined;
        std::int64_t evaluations = 40'000;  // of a trial; 1000 or more
        int population = 40;                // lambda of the CMA-ES, 4 .. 1000

        // Of the paper's method.
        double residual = 150;        // the energy that needs no refinement unless artefacts are seen, >= 0
        bool fullCovariance = false;  // between actors too: the paper's CMA-ES to the letter, and slower

        // Error: names the option that is out of range.
        Result<void> check() const;
    };

    enum class StopReason {
        NotRun,
        Evaluations,
        Satisfied,  // the paper's method: little residual energy and no visible artefacts
        Interrupted
    };

    // How good poses are, for people and reports.
    struct Actor {
        double margin = 0;                   // of balance, metres
        bool touches = false;                // the floor, or a platform
        double lowest = 0;                   // height of the lowest point above what is under it, metres
        double deepest = 0;                  // in the own body, another's, the floor, a screen, a platform or a prop, metres
        bool withinLimits = false;           // all joint angle measures between their bounds
        double outside = 0;                  // how far what bears is outside where people may stand, metres
        std::vector<glm::dvec2> contacts{};  // (x, z) of all that touches the floor or a platform, metres

        // He stands with kStandMargin to spare, within the joints' limits, no deeper than
        // kMostDepth in anything, nor farther than that from where he may stand.
        bool isValid() const;
    };
    struct Quality {
        double energy = 0;
        EnergyTerms terms;
        // Of a beam's shadow and target.
        struct Match {
            double iou = 0;                           // intersection over union, as seen on the screen
            double flatIou = 0;                       // on the flat one, which is curved for the former
            double iouWithoutProps = 0;               // of the people's shadow alone, without that of platforms and props
            double propsCover = 0;                    // the share of the target that is in the shadow of platforms and props
            double contourMean = 0, contourMost = 0;  // |p - p'|, pixels of a target 256 high
        };
        std::vector<Match> matches;               // of each beam
        double iou = 0, iouWithoutProps = 0;      // the least of theirs
        double propsCover = 0;                    // the most
        double contourMean = 0, contourMost = 0;  // of all
        std::vector<Actor> actors;

        bool isValid() const;  // everyone is
    };
    static constexpr double kStandMargin = 0.01, kMostDepth = 0.02;  // metres

    struct Trial {
        std::vector<double> dofs;  // of all actors, one after the other
        Quality quality;
        std::uint64_t seed = 0;
        std::int64_t evaluations = 0;
        StopReason reason = StopReason::NotRun;
        std::vector<double>
            history;  // of the local search: the best energy after each change, in coarse pixels and then in fine ones
    };

    struct Progress {
        std::int64_t evaluations = 0;
        double energy = 0;
    };
    // Asked now and then; true ends the trial with the best so far.
    using AskStop = std::function<bool(const Progress&)>;

    // The actors' T-poses in a row before the screen, looking at it.
    static std::vector<double> start(const PoseProblem& problem);

    // One trial by the options' method. Quality is measured in the problem's own pixels.
    static Trial run(const PoseProblem& problem, std::uint64_t seed, const Options& options, const AskStop& askStop = {});

    // The seed (63 bits) of a trial, from 0, of a search's.
    static std::uint64_t trialSeed(std::uint64_t seed, std::uint64_t number);

    static Quality measure(const PoseProblem& problem, std::span<const double> dofs);
};

std::string_view name(PoseSearch::Method method);
std::string_view name(PoseSearch::StopReason reason);

}  // namespace fantascope::theatre
