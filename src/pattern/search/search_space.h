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

// What every search method looks for and may choose from: the guide, the shapes, and how large and
// how turned an instance may be. Constant during a search. Thread: every method is reentrant.
class SearchSpace {
public:
    // `guide`: stored values in the pattern's resolution. Both outlive it.
    SearchSpace(const GreyImage& guide, std::span<const ElementalShape> shapes, std::uint64_t seed,
                const PatternSearch::Options& options);

    const PatternSearch::Options& options() const { return options_; }
    std::uint64_t seed() const { return seed_; }
    const Goal& goal() const { return goal_; }
    glm::ivec2 pixels() const { return pixels_; }  // of the comparison
    double aspect() const { return aspect_; }
    std::size_t shapeCount() const { return silhouettes_.size(); }
    const Silhouette& silhouette(std::uint32_t shape) const { return silhouettes_[shape]; }
    // The side of a square as large as the shape is at size 1, on average over the allowed
    // rotations; and the mean by the shapes' shares.
    double side(std::uint32_t shape) const { return sides_[shape]; }
    double meanSide() const { return meanSide_; }
    // The smallest and the largest instance of a shape; and those of a typical shape, whose side is
    // meanSide().
    glm::dvec2 sizes(std::uint32_t shape) const { return limits_[shape].sizes; }
    glm::dvec2 sizes() const { return typicalSizes_; }

    // An instance of a random shape, size and rotation, at a random point of `cell`; without an id.
    // The shape is drawn by the shares; where `counts` says how many instances of each shape there
    // are, from those of which there are too few for the shares.
    ShapeInstance randomInstance(const PixelRectangle& cell, Rng& rng, std::span<const std::uint32_t> counts = {}) const;
    // The nearest instance that is allowed and whose numbers are short decimals, with its centre on
    // the canvas: a file then holds, in few digits, exactly what was compared.
    ShapeInstance allowed(ShapeInstance instance) const;

private:
    struct Limits {
        glm::dvec2 sizes, tilt, turn;  // each from, to; canvas heights, radians
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
    std::vector<double> shares_;  // of 1
    bool areAlike_ = true;        // every shape has the same share
    double meanSide_ = 0;
    glm::dvec2 typicalSizes_{0.0};
};

}  // namespace fantascope::pattern
