#include "pattern/search/measure.h"

#include "pattern/motion/pattern_motion.h"
#include "pattern/search/coverage.h"
#include "pattern/search/goal.h"

#include "core/check.h"
#include "core/parallel.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::pattern {
namespace {

std::vector<Silhouette> silhouettesOf(const ShapePattern& pattern) {
    std::vector<Silhouette> silhouettes;
    for (const ElementalShape& shape : pattern.shapes) silhouettes.emplace_back(shape.mesh);
    return silhouettes;
}

InstancePose restPose(const ShapeInstance& instance) { return {instance.centre, instance.size, instance.rotation}; }

Coverage coverageAtRest(const ShapePattern& pattern, const std::vector<Silhouette>& silhouettes, int width, int height) {
    Coverage coverage(width, height);
    for (const ShapeInstance& instance : pattern.instances) coverage.add(silhouettes[instance.shape], restPose(instance));
    return coverage;
}

// The standard deviation of the tone's Gaussian, in pixels.
double toneSigma(const ShapePattern& pattern) { return pattern.height / 36.0; }

// A pattern's picture on a surface; empty: evenly white.
GreyImage seenOn(const GreyImage& surface, GreyImage picture) {
    for (std::size_t i = 0; i < surface.pixels().size(); ++i) picture.pixels()[i] *= surface.pixels()[i];
    return picture;
}

double meanDifference(const GreyImage& a, const GreyImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels().size(); ++i) sum += std::abs(double(a.pixels()[i]) - b.pixels()[i]);
    return sum / static_cast<double>(a.pixels().size());
}

// The share of the covered pixels that more than one instance covers; 0 if none is covered.
double overlapOf(const ShapePattern& pattern, const std::vector<Silhouette>& silhouettes) {
    Image<std::uint8_t> layers(pattern.width, pattern.height);  // 0, 1, or 2 for two and more
    Coverage alone(pattern.width, pattern.height);
    for (const ShapeInstance& instance : pattern.instances) {
        alone.clear();
        alone.add(silhouettes[instance.shape], restPose(instance));
        alone.forEachRun([&](int y, int begin, int end) {
            for (int x = begin; x < end; ++x)
                if (layers.at(x, y) < 2) ++layers.at(x, y);
        });
    }
    std::int64_t covered = 0, several = 0;
    for (const std::uint8_t count : layers.pixels()) {
        covered += count > 0 ? 1 : 0;
        several += count > 1 ? 1 : 0;
    }
    return covered == 0 ? 0 : static_cast<double>(several) / static_cast<double>(covered);
}

// Measures the tone of many pictures of one pattern. A wide Gaussian is taken of a smaller picture,
// which is nearly as exact and much faster.
class ToneOfMany {
public:
    ToneOfMany(const GreyImage& guide, double sigma)
        : sigma_(sigma), factor_(std::max(1, static_cast<int>(sigma / kMinSigma))), guide_(blurredSmall(guide)) {}

    double operator()(const GreyImage& picture) const { return meanDifference(guide_, blurredSmall(picture)); }

private:
    static constexpr double kMinSigma = 5;  // pixels of the smaller picture

    GreyImage blurredSmall(const GreyImage& picture) const {
        const int width = std::max(1, picture.width() / factor_), height = std::max(1, picture.height() / factor_);
        // Resizing averages over squares, which already is a part of the blur.
        const double squared = factor_ * factor_;
        return blurred(resized(picture, width, height), std::sqrt((sigma_ * sigma_ - (squared - 1) / 12) / squared));
    }

    double sigma_;     // pixels
    int factor_;       // by which pictures are shrunk
    GreyImage guide_;  // shrunk and blurred
};

// The first and second moments of a mesh's vertices.
struct VertexMoments {
    glm::dvec3 first{0.0};   // mean of v
    glm::dmat3 second{0.0};  // mean of v v^T

    explicit VertexMoments(const TriangleMesh& mesh) {
        const double count = static_cast<double>(mesh.vertices.size());
        for (const glm::dvec3 v : mesh.vertices) {
            first += v / count;
            second += glm::outerProduct(v, v / count);
        }
    }

    // The mean of |shift + (map v).xy|^2 over the vertices v.
    double meanSquare(glm::dvec2 shift, const glm::dmat3& map) const {
        const glm::dvec2 mean(map * first);
        const glm::dmat3 spread = map * second * glm::transpose(map);
        return glm::dot(shift, shift) + 2 * glm::dot(shift, mean) + spread[0][0] + spread[1][1];
    }
};

std::vector<VertexMoments> verticesOf(const ShapePattern& pattern) {
    std::vector<VertexMoments> vertices;
    for (const ElementalShape& shape : pattern.shapes) vertices.emplace_back(shape.mesh);
    return vertices;
}

}  // namespace

PatternQuality measure(const ShapePattern& pattern, const GreyImage& guide, const GreyImage* surface) {
    const GreyImage compared = resized(guide, pattern.width, pattern.height);
    const std::vector<Silhouette> silhouettes = silhouettesOf(pattern);
    const Coverage coverage = coverageAtRest(pattern, silhouettes, pattern.width, pattern.height);
    const GreyImage light = surface != nullptr ? resized(*surface, pattern.width, pattern.height) : GreyImage();
    const Goal goal(compared, surface != nullptr ? &light : nullptr);
    const double sigma = toneSigma(pattern);
    return {.z = goal.z(coverage),
            .zBound = goal.bound(),
            .tone = meanDifference(blurred(compared, sigma), blurred(seenOn(light, coverage.picture()), sigma)),
            .overlap = overlapOf(pattern, silhouettes)};
}

struct LoopMeasure::Parts {
    const ShapePattern& pattern;
    GreyImage guide;  // in the pattern's resolution
    int threads;
    GreyImage surface;  // in the pattern's resolution; empty: evenly white
    Goal goal = Goal(guide, surface.empty() ? nullptr : &surface);
    ToneOfMany toneOf = ToneOfMany(guide, toneSigma(pattern));
    std::vector<Silhouette> silhouettes = silhouettesOf(pattern);
    std::vector<VertexMoments> vertices = verticesOf(pattern);
    PatternMotion motion = PatternMotion(pattern, threads);

    // The sum over all instances of their vertices' mean squared displacement, in squared canvas
    // heights.
    double squares(std::span<const InstancePose> poses) const {
        double sum = 0;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const ShapeInstance& instance = pattern.instances[i];
            const InstancePose rest = restPose(instance);
            sum += vertices[instance.shape].meanSquare(poses[i].centre - rest.centre,
                                                       canvasFromShape(poses[i]) - canvasFromShape(rest));
        }
        return sum;
    }
};

LoopMeasure::LoopMeasure(const ShapePattern& pattern, const GreyImage& guide, int threads, const GreyImage* surface)
    : parts_(new Parts{pattern, resized(guide, pattern.width, pattern.height), threads,
                       surface != nullptr ? resized(*surface, pattern.width, pattern.height) : GreyImage()}) {}

LoopMeasure::~LoopMeasure() = default;

LoopQuality LoopMeasure::in(const Wind& wind, int moments) const {
    FANTASCOPE_CHECK(moments > 0, "there is a moment to measure");
    const ShapePattern& pattern = parts_->pattern;
    const Wind groupsAtRest{.strength = wind.strength, .ownDirection = 0};
    struct Moment {
        double z, tone, squares;
    };
    std::vector<Moment> seen(static_cast<std::size_t>(moments));
    parallelFor(moments, parts_->threads, [&](int moment) {
        const Time time = parts_->motion.period() * moment / moments;
        std::vector<InstancePose> poses(pattern.instances.size());
        parts_->motion.posesAt(time, wind, poses);
        Coverage coverage(pattern.width, pattern.height);
        for (std::size_t i = 0; i < poses.size(); ++i) coverage.add(parts_->silhouettes[pattern.instances[i].shape], poses[i]);
        parts_->motion.posesAt(time, groupsAtRest, poses);
        seen[static_cast<std::size_t>(moment)] = {
            parts_->goal.z(coverage), parts_->toneOf(seenOn(parts_->surface, coverage.picture())), parts_->squares(poses)};
    });

    LoopQuality mean{0, 0, 0};
    double squares = 0;
    for (const Moment& moment : seen) {
        mean.z += moment.z / moments;
        mean.tone += moment.tone / moments;
        squares += moment.squares / moments;
    }
    if (!pattern.instances.empty())
        mean.localDisplacement = std::sqrt(squares / static_cast<double>(pattern.instances.size())) / pattern.meanSize();
    return mean;
}

GreyImage drawWhiteOnBlack(const ShapePattern& pattern, int width, int height) {
    return coverageAtRest(pattern, silhouettesOf(pattern), width, height).picture();
}

}  // namespace fantascope::pattern
