#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/geometry.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::pattern {

// Creates a shape pattern from an artist's sketch.
struct PatternSearch {
    enum class Method {
        Refined,  // one move at a time, judged exactly; see refined_method.h
        Paper     // Ji et al. 2015, section 4.1, as written; see paper_method.h
    };

    // A rectangle of the canvas, in canvas heights; its edges belong to it.
    struct Region {
        glm::dvec2 from{0.0}, to{1.0};
        bool contains(glm::dvec2 point) const {
            return point.x >= from.x && point.x <= to.x && point.y >= from.y && point.y <= to.y;
        }
    };

    // All defaults work with any guide and any shapes.
    struct Options {
        Method method = Method::Refined;

        // Where a pattern that is given may change: instances whose centre lies elsewhere stay as
        // they are. The refined method only.
        std::optional<Region> region;

        // When it stops; the caller may stop it as well.
        double targetZ = 0;                                // z_0: once z is below it, 0..1
        int iterations = std::numeric_limits<int>::max();  // after so many, >= 0

        // What is compared: the guide is resampled to so many rows of pixels, unless it has fewer.
        // 16 .. 4096.
        int rows = 720;

        std::uint32_t instances = 1000;  // the pattern never has more; 1 .. 100,000
        // The smallest and the largest instance in canvas heights, 0 < x <= y <= 2. Without it,
        // sizes around that of which `instances` would light the guide's white, and a little more.
        std::optional<glm::dvec2> size;
        double tilt = radians(40);   // the largest rotation about x and y, 0 .. pi: beyond, flat shapes are slivers
        double turn = radians(180);  // the largest rotation about z, 0 .. pi

        // Colours in linear light, 0..1: those between two, or those of a picture of stored sRGB
        // values that is laid over the canvas, each instance's the mean of what lies under it.
        struct Colours {
            glm::dvec3 from{1.0}, to{1.0};
            std::shared_ptr<const RgbaImage> picture = nullptr;  // never empty
        };
        // An instance gets a colour of one entry; never empty.
        std::vector<Colours> colours = std::vector<Colours>(1);

        // What one shape has of its own; what is absent is as for all.
        struct Shape {
            double share = 1;  // of the new instances, in proportion to the other shapes' shares; 0.001 .. 1000
            std::optional<glm::dvec2> size;
            std::optional<glm::dvec2> tilt;  // [from, to], -pi <= from <= to <= pi
            std::optional<glm::dvec2> turn;  // [from, to], -2 pi <= from <= to <= 2 pi, at most 2 pi apart
            std::vector<Colours> colours;    // empty: as for all
        };
        // In the order of the pattern's; a shape beyond the last entry has nothing of its own.
        std::vector<Shape> shapes;

        struct Refined {
            // What a wrong pixel, a wrong tone and a pixel that several instances cover weigh
            // against each other; 0 .. 100.
            double zWeight = 1, toneWeight = 0.5, overlapWeight = 0.12;
            // The share of the covered pixels that several instances may cover at no cost where the
            // guide is white; 0 .. 1. Shapes that lie a little on each other open no gaps when they
            // sway.
            double overlapFree = 0.13;
            // The temperature at the start, as the share of a typical instance's pixels that may be
            // lost in a move; 0 .. 10.
            double temperature = 0.015;
            // The share of the iterations, the last ones, that accept nothing worse; 0 .. 1.
            double polish = 0.1;
        } refined;

        struct Paper {
            // The thresholds for the difference indices; -1 < delete <= reduce <= 0 <= increase <=
            // create < 1. Small ones keep the greys of a drawing better, large ones its edges.
            double lambdaCreate = 0.1, lambdaIncrease = 0.05, lambdaReduce = -0.05, lambdaDelete = -0.1;
            // The sides of the evaluation cells, as multiples of the side of a square as large as a
            // shape: in the lattice a typical one, in an instance cell this instance's. > 0. At 2,
            // an instance that stands alone in the dark has g_i = -1/4.
            double latticeCell = 2, instanceCell = 2;

            int candidates = 12;  // new ones in each iteration (Figure 5), 1 .. 1000
            // The largest amount of a perturbation, as a share of the instance's size (radians for
            // rotations): 0 .. 10.
            double largestAmount = 0.5;
            // The share of iterations that should be accepted; perturbations grow when more are.
            // 0.01 .. 0.99.
            double successRate = 0.5;
        } paper;

        // Error: names the option, its value and the rule.
        Result<void> check() const;
    };

    enum class StopReason { NotRun, TargetReached, Iterations, Time, Interrupted };

    // What the caller sees between two iterations.
    struct Progress {
        int iterations = 0;  // done so far
        double z = 1;        // of the reference solution
        std::size_t instances = 0;
        std::function<GreyImage()> picture;  // draws the reference solution, white on black as it is compared
    };
    // Asked before every iteration: a reason to stop now, with the best pattern so far, or nothing.
    using AskStop = std::function<std::optional<StopReason>(const Progress&)>;
    // How many iterations the whole run will have, once the caller can tell: asked before each
    // iteration until it answers, unless Options::iterations says. The refined method cools by it,
    // and stops there with the reason Time. With the same number as Options::iterations the run
    // repeats.
    using Plan = std::function<std::optional<int>(const Progress&)>;

    // What a Plan may answer: how many iterations fit into `budget` seconds when the first `done`
    // took `elapsed`; nothing while that is too few to tell.
    static std::optional<int> iterationsWithin(double budget, int done, double elapsed);

    // Iteration by iteration, for a picture as Figure 5.
    struct Iteration {
        double zMin = 1, zMax = 1;  // of the candidates; with the refined method both are z after the iteration
        bool accepted = false;      // zMin was better than the reference solution's
    };
    struct Summary {
        StopReason reason = StopReason::NotRun;
        double z = 1;
        int iterations = 0;
        std::int64_t evaluations = 0;  // of the goal function: whole pictures (paper) or single moves (refined)
        std::vector<Iteration> history;

        std::string brief() const;
    };
    struct Found {
        ShapePattern pattern;
        Summary summary;
    };

    // `guide`: stored values, in any resolution. `pattern` brings seed, shapes (at least one),
    // motion and what else the search does not touch; its resolution, instances and groups are
    // filled. The refined method goes on from instances that it brings; what remains of them keeps
    // its id, colour and group. The result depends on these, the options and the number of
    // iterations alone, not on `threads`. Options must pass check(). Thread: reentrant; askStop is
    // called on the caller's.
    static Found run(const GreyImage& guide, ShapePattern pattern, const Options& options, int threads, const AskStop& askStop,
                     const Plan& plan = {});
};

// As reports say it: "target_reached", "iterations", "time", "interrupted".
std::string_view name(PatternSearch::StopReason reason);
// As the command line and reports say it: "refined", "paper".
std::string_view name(PatternSearch::Method method);

}  // namespace fantascope::pattern
