#pragma once

#include "theatre/energy/pose_problem.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// Discovery of principal poses (Won & Lee 2016, section 4): poses of all actors at once whose
// shadow matches the target.
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

        // Only for the paper's method.
        double residual = 150;        // energy up to which no refinement is needed unless artefacts are visible, >= 0
        bool fullCovariance = false;  // between actors too: exactly the paper's CMA-ES, and slower

        // Error: names the option that is out of range.
        Result<void> check() const;
    };

    enum class StopReason {
        NotRun,
        Evaluations,
        Satisfied,  // only the paper's method: the residual energy is low and no artefacts are visible
        Interrupted
    };

    // The quality of poses, for people and reports.
    struct Actor {
        double margin = 0;     // of balance, metres
        bool touches = false;  // whether he touches the floor or a platform
        double lowest = 0;     // height of the lowest point above what is under it, metres
        double deepest = 0;    // greatest depth in his own body, another's, the floor, a screen, a platform or a prop, metres
        bool withinLimits = false;           // all joint angle measures between their bounds
        double outside = 0;                  // how far a contact lies outside the standing area, metres
        std::vector<glm::dvec2> contacts{};  // (x, z) of all that touches the floor or a platform, metres

        // Whether he touches the ground with a margin of at least kStandMargin, is within the joint
        // limits, and neither penetrates anything nor leaves the standing area by more than
        // kMostDepth.
        bool isValid() const;
    };
    struct Quality {
        double energy = 0;
        EnergyTerms terms;
        // Of a beam's shadow and target.
        struct Match {
            double iou = 0;                           // intersection over union, as seen on the screen
            double flatIou = 0;                       // the same on the flat screen, which differs if the screen is curved
            double iouWithoutProps = 0;               // of the people's shadow alone, without platforms and props
            double propsCover = 0;                    // share of the target that platforms and props cover
            double contourMean = 0, contourMost = 0;  // |p - p'|, pixels of a target 256 high
        };
        std::vector<Match> matches;               // of each beam
        double iou = 0, iouWithoutProps = 0;      // the minimum over the beams
        double propsCover = 0;                    // the maximum over the beams
        double contourMean = 0, contourMost = 0;  // of all
        std::vector<Actor> actors;

        bool isValid() const;  // whether every actor is valid
    };
    static constexpr double kStandMargin = 0.01, kMostDepth = 0.02;  // metres

    struct Trial {
        std::vector<double> dofs;  // of all actors, one after the other
        Quality quality;
        std::uint64_t seed = 0;
        std::int64_t evaluations = 0;
        StopReason reason = StopReason::NotRun;
        std::vector<double>
            history;  // of the local search: the best energy after each change, first in coarse pixels, then in fine ones
    };

    struct Progress {
        std::int64_t evaluations = 0;
        double energy = 0;
    };
    // Called now and then. True stops the trial with the best so far.
    using AskStop = std::function<bool(const Progress&)>;

    // The actors' T-poses in a row in front of the screen, looking at it.
    static std::vector<double> start(const PoseProblem& problem);

    // One trial by the options' method. Quality is measured in the problem's own pixels.
    static Trial run(const PoseProblem& problem, std::uint64_t seed, const Options& options, const AskStop& askStop = {});

    // The seed (63 bits) of trial `number` (from 0) of a search with `seed`.
    static std::uint64_t trialSeed(std::uint64_t seed, std::uint64_t number);

    static Quality measure(const PoseProblem& problem, std::span<const double> dofs);
};

std::string_view name(PoseSearch::Method method);
std::string_view name(PoseSearch::StopReason reason);

}  // namespace fantascope::theatre
