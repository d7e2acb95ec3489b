#pragma once

#include "pattern/search/goal.h"
#include "pattern/search/pattern_search.h"
#include "pattern/search/silhouette.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::pattern {

// What a search method aims at and may choose from: the guide, the shapes, and the allowed sizes
// and rotations of instances. Constant during a search. Thread: every method is reentrant.
class SearchSpace {
public:
    // `guide`: compared values in the pattern's resolution. `options` outlives it.
    SearchSpace(const GreyImage& guide, std::span<const ElementalShape> shapes, std::uint64_t seed,
                const PatternSearch::Options& options);

    const PatternSearch::Options& options() const { return options_; }
    std::uint64_t seed() const { return seed_; }
    const Goal& goal() const { return goal_; }
    glm::ivec2 pixels() const { return pixels_; }  // of the comparison
    double aspect() const { return aspect_; }
    std::size_t shapeCount() const { return silhouettes_.size(); }
    const Silhouette& silhouette(std::uint32_t shape) const { return silhouettes_[shape]; }
    // The side of a square with the shape's area at size 1, averaged over the allowed rotations;
    // and the mean over all shapes, weighted by their shares.
    double side(std::uint32_t shape) const { return sides_[shape]; }
    double meanSide() const { return meanSide_; }
    // The smallest and the largest size of a shape; and those of a typical shape, whose side is
    // meanSide().
    glm::dvec2 sizes(std::uint32_t shape) const { return limits_[shape].sizes; }
    glm::dvec2 sizes() const { return typicalSizes_; }

    // An instance of a random shape, size and rotation at a random point of `cell`, without an id.
    // The shape is drawn by the shares. `counts`, if given, is how many instances of each shape
    // there are; shapes with too few for their share are then drawn.
    ShapeInstance randomInstance(const PixelRectangle& cell, Rng& rng, std::span<const std::uint32_t> counts = {}) const;
    // The nearest allowed instance with its centre on the canvas and rounded numbers, so that a
    // file holds exactly what was compared in few digits.
    ShapeInstance allowed(ShapeInstance instance) const;

private:
    struct Limits {
        glm::dvec2 sizes, tilt, turn;  // each (from, to); canvas heights, radians
    };
    void setSizes();
    glm::dvec2 fittingSizes() const;
    std::uint32_t randomShape(Rng& rng, std::span<const std::uint32_t> counts) const;

    const PatternSearch::Options& options_;
    const std::uint64_t seed_;
    const Goal goal_;
    const glm::ivec2 pixels_;
    const double aspect_;
    std::vector<Silhouette> silhouettes_;
    std::vector<double> sides_;
    std::vector<Limits> limits_;
    std::vector<double> shares_;  // of each shape; their sum is 1
    bool areAlike_ = true;        // every shape has the same share
    double meanSide_ = 0;
    glm::dvec2 typicalSizes_{0.0};
};

}  // namespace fantascope::pattern
