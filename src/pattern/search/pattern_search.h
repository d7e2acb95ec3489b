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

// Searches for a shape pattern that reads as an artist's drawing, the guide.
struct PatternSearch {
    enum class Method {
        Refined,  // one move at a time, evaluated exactly; see refined_method.h
        Paper     // Ji et al. 2015, section 4.1, as written; see paper_method.h
    };

    // A rectangle of the canvas, in canvas heights, including its edges.
    struct Region {
        glm::dvec2 from{0.0}, to{1.0};
        bool contains(glm::dvec2 point) const {
            return point.x >= from.x && point.x <= to.x && point.y >= from.y && point.y <= to.y;
        }
    };

    // The defaults work with any guide and any shapes.
    struct Options {
        Method method = Method::Refined;

        // Where a given pattern may change: instances whose centre lies outside stay as they are.
        // The refined method only.
        std::optional<Region> region;

        // What a change must win to be worth it, as a share of a typical instance's pixels, 0 ..
        // 10: the first change of a given instance, its removal, and a new instance. Above 0 the
        // search changes a given pattern only where that helps much. The refined method only.
        double changeCost = 0;

        // When to stop. The caller may stop the search as well, see AskStop.
        double targetZ = 0;                                // z_0: stop once z is below it, 0..1
        int iterations = std::numeric_limits<int>::max();  // stop after so many, >= 0

        // What the pattern is seen on: the light that a white shape gives at each place of the
        // canvas, as a share of the light that stands for the guide's white; any resolution. Null:
        // 1 everywhere. The refined method only.
        std::shared_ptr<const GreyImage> surface;

        // The resolution of the comparison: the guide is resampled to so many rows of pixels,
        // unless it has fewer. 16 .. 4096.
        int rows = 720;

        std::uint32_t instances = 1000;  // maximum, 1 .. 100,000
        // The sizes of the smallest and the largest instance in canvas heights, 0 < x <= y <= 2.
        // Absent: derived from the guide, so that `instances` of them together are a little larger
        // than its white.
        std::optional<glm::dvec2> size;
        double tilt = radians(40);   // maximum rotation about x and y, 0 .. pi; larger ones turn flat shapes into slivers
        double turn = radians(180);  // maximum rotation about z, 0 .. pi

        // Colours to choose from. Either a range between two colours in linear light, 0..1, or a
        // picture of stored sRGB values that is laid over the canvas: an instance's colour is the
        // mean of the picture under it.
        struct Colours {
            glm::dvec3 from{1.0}, to{1.0};
            std::shared_ptr<const RgbaImage> picture = nullptr;  // null: the range; never an empty picture
        };
        // Each instance draws one entry. Never empty.
        std::vector<Colours> colours = std::vector<Colours>(1);

        // The options of one shape; absent ones are those of all shapes.
        struct Shape {
            double share = 1;  // of new instances, relative to the other shapes' shares; 0.001 .. 1000
            std::optional<glm::dvec2> size;
            std::optional<glm::dvec2> tilt;  // [from, to], -pi <= from <= to <= pi
            std::optional<glm::dvec2> turn;  // [from, to], -2 pi <= from <= to <= 2 pi, at most 2 pi apart
            std::vector<Colours> colours;    // empty: those of all shapes
        };
        // In the order of ShapePattern::shapes. Shapes beyond the last entry have no options of
        // their own.
        std::vector<Shape> shapes;

        struct Refined {
            // The weights of wrong pixels, wrong tone and overlap in the goal; 0 .. 100.
            double zWeight = 1, toneWeight = 1.5, overlapWeight = 0.12;
            // Where the guide is white, this share of the covered pixels may overlap at no cost; 0
            // .. 1. Shapes that overlap a little open no gaps when they sway.
            double overlapFree = 0.13;
            // The temperature at the start, as a share of a typical instance's pixels; 0 .. 10.
            double temperature = 0.015;
            // The share of the iterations, at the end, that accept no worsening; 0 .. 1.
            double polish = 0.1;
        } refined;

        struct Paper {
            // The thresholds of the difference indices; -1 < delete <= reduce <= 0 <= increase <=
            // create < 1. Small ones preserve a drawing's greys better, large ones its edges.
            double lambdaCreate = 0.1, lambdaIncrease = 0.05, lambdaReduce = -0.05, lambdaDelete = -0.1;
            // The sides of the evaluation cells, > 0. The unit is the side of a square with the
            // area of a shape: of a typical shape for lattice cells, of the instance for its cell.
            // At 2, an instance alone in the dark has g_i = -1/4.
            double latticeCell = 2, instanceCell = 2;

            int candidates = 12;  // per iteration (Figure 5), 1 .. 1000
            // The maximum perturbation, as a share of the instance's size (radians for rotations),
            // 0 .. 10.
            double largestAmount = 0.5;
            // The wanted share of accepted iterations, 0.01 .. 0.99. Perturbations grow if more are
            // accepted.
            double successRate = 0.5;
        } paper;

        // Error: names the option, its value and the rule it breaks.
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
    // Called before every iteration. Returns a reason to stop with the best pattern so far, or
    // nothing to go on.
    using AskStop = std::function<std::optional<StopReason>(const Progress&)>;
    // Returns the run's total number of iterations once the caller can tell. It is called before
    // each iteration until it returns one, unless Options::iterations is set. The refined method
    // cools towards that iteration and stops there with the reason Time. A run with this number as
    // Options::iterations gives the same result.
    using Plan = std::function<std::optional<int>(const Progress&)>;

    // For a Plan: how many iterations fit into `budget` seconds if the first `done` took `elapsed`
    // seconds; nothing while it is too early to tell.
    static std::optional<int> iterationsWithin(double budget, int done, double elapsed);

    // One iteration, for a figure like Figure 5.
    struct Iteration {
        double zMin = 1, zMax = 1;  // of the candidates; both are z after the iteration for the refined method
        bool accepted = false;      // zMin was below the reference solution's z
    };
    struct Summary {
        StopReason reason = StopReason::NotRun;
        double z = 1;
        int iterations = 0;
        std::int64_t evaluations = 0;  // of the goal function: of whole pictures (paper) or single moves (refined)
        std::vector<Iteration> history;

        std::string brief() const;
    };
    struct Found {
        ShapePattern pattern;
        Summary summary;
    };

    // `guide`: compared values (comparedGuide), in any resolution. `pattern`: has seed, shapes (at
    // least one), motion and everything else that the search leaves alone; its resolution,
    // instances and groups are filled in. The refined method starts from its instances, if any;
    // those that remain keep their id, colour and group. One that is moved to another part of the
    // picture is another one, with an id of its own. The result depends on these arguments and the
    // number of iterations alone, not on `threads`. `options` must pass check(). Thread: reentrant;
    // askStop and plan are called on the calling thread.
    static Found run(const GreyImage& guide, ShapePattern pattern, const Options& options, int threads, const AskStop& askStop,
                     const Plan& plan = {});
};

// As reports write it: "target_reached", "iterations", "time", "interrupted".
std::string_view name(PatternSearch::StopReason reason);
// As the command line and reports write it: "refined", "paper".
std::string_view name(PatternSearch::Method method);

}  // namespace fantascope::pattern
