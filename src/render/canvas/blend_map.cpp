#include "render/canvas/blend_map.h"

#include "core/parallel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>
#include <vector>

namespace fantascope::render {
namespace {

// Distances are computed on a lattice over the canvas and interpolated linearly. They have kinks
// only where two edges are equally near.
constexpr int kLattice = 192;  // cells each way
constexpr int kPieces = 48;    // straight pieces per edge of a picture, since a mesh bends edges

bool within(glm::dvec2 point, glm::dvec2 low, glm::dvec2 high) {
    return point.x >= low.x && point.y >= low.y && point.x <= high.x && point.y <= high.y;
}

double distanceTo(glm::dvec2 point, glm::dvec2 from, glm::dvec2 to) {
    const glm::dvec2 along = to - from;
    const double length = glm::dot(along, along),
                 share = length > 0 ? std::clamp(glm::dot(point - from, along) / length, 0.0, 1.0) : 0;
    return glm::distance(point, from + share * along);
}

// What one projector covers of the canvas. Points of the unit canvas are in widths and heights of
// the canvas, 0..1.
class Reach {
public:
    explicit Reach(const Projection& projection) : projection_(projection) {}

    // Whether one of its pixels, lit or black, falls on a point of the canvas's plane.
    bool shines(glm::dvec2 unitCanvas) const {
        return within(projection_.warp.projectorFromCanvas(unitCanvas), glm::dvec2(0), glm::dvec2(projection_.size));
    }
    // Whether the part of the canvas that it shows contains the point.
    bool shows(glm::dvec2 unitCanvas) const {
        const CanvasPart& part = projection_.warp.shape().part;
        return within(unitCanvas, part.low, part.high) && shines(unitCanvas);
    }

    // Finds those edges of its picture that lie inside another picture, and the canvas's distances
    // from them.
    void measure(std::span<const Reach> all, int threads) {
        std::vector<std::pair<glm::dvec2, glm::dvec2>> pieces;
        // `beyond`: a point just outside the picture. There is nothing to blend at an edge where
        // the other picture ends too.
        const auto keep = [&](glm::dvec2 from, glm::dvec2 to, glm::dvec2 beyond) {
            const auto covers = [&](const Reach& other) { return &other != this && other.shows(beyond); };
            if (std::any_of(all.begin(), all.end(), covers)) pieces.emplace_back(from, to);
        };
        const std::array<glm::dvec2, 4> corners = rectangleCorners(1, 1), outwards = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
        const CanvasPart& part = projection_.warp.shape().part;
        const glm::dvec2 size(projection_.size);
        for (std::size_t edge = 0; edge < 4; ++edge)
            for (int piece = 0; piece < kPieces; ++piece) {
                const auto at = [&](double end) {
                    return glm::mix(corners[edge], corners[(edge + 1) % 4], (piece + end) / kPieces);
                };
                // Edges of the canvas's part, where the projector shows them,
                const auto onPart = [&](double end) { return glm::mix(part.low, part.high, at(end)); };
                if (shines(onPart(0.5))) keep(onPart(0), onPart(1), onPart(0.5) + kBeyond * outwards[edge]);
                // and edges of the projector's raster, where it clips that part.
                const auto onRaster = [&](double end, double pixels) {
                    return projection_.warp.canvasFromProjector(at(end) * size + pixels * outwards[edge]);
                };
                const auto from = onRaster(0, 0), middle = onRaster(0.5, 0), to = onRaster(1, 0), beyond = onRaster(0.5, 1);
                if (from && middle && to && beyond && within(*middle, part.low, part.high)) keep(*from, *to, *beyond);
            }
        distances_.assign((kLattice + 1) * (kLattice + 1), kFar);
        parallelFor(kLattice + 1, threads, [&](int row) {
            for (int column = 0; column <= kLattice; ++column)
                for (const auto& [from, to] : pieces) {
                    double& nearest = distances_[static_cast<std::size_t>(row * (kLattice + 1) + column)];
                    nearest = std::min(nearest, distanceTo(glm::dvec2(column, row) / double(kLattice), from, to));
                }
        });
    }
    // Its claim on the light at a point of the canvas, relative to the other projectors' claims; 0
    // where it shows nothing.
    double claim(glm::dvec2 unitCanvas) const {
        if (!shows(unitCanvas)) return 0;
        const glm::dvec2 at = glm::clamp(unitCanvas, 0.0, 1.0) * double(kLattice);
        const glm::ivec2 cell = glm::min(glm::ivec2(at), kLattice - 1);
        const glm::dvec2 share = at - glm::dvec2(cell);
        const double* corner = distances_.data() + cell.y * (kLattice + 1) + cell.x;
        const double distance = glm::mix(glm::mix(corner[0], corner[1], share.x),
                                         glm::mix(corner[kLattice + 1], corner[kLattice + 2], share.x), share.y);
        return std::max(distance * distance, 1e-12);  // the square makes shares start and end smoothly
    }
    double blackLevel() const { return projection_.light.blackLevel; }

private:
    static constexpr double kBeyond = 1e-3;  // widths and heights of the canvas
    static constexpr double kFar = 2;        // distance if there is no edge: more than the canvas's width

    const Projection& projection_;
    std::vector<double> distances_;  // [row][column] of the lattice, in widths and heights of the canvas
};

// The share of the light that a mask lets through at a pixel, 0..1.
double lightThrough(const Mask& mask, glm::dvec2 pixel, glm::ivec2 size) {
    if (mask.image) {
        const GreyImage& image = *mask.image;
        const glm::dvec2 at = pixel / glm::dvec2(size) * glm::dvec2(image.width(), image.height()) - 0.5, corner = glm::floor(at);
        const auto value = [&](int x, int y) {
            return static_cast<double>(image.at(std::clamp(static_cast<int>(corner.x) + x, 0, image.width() - 1),
                                                std::clamp(static_cast<int>(corner.y) + y, 0, image.height() - 1)));
        };
        const glm::dvec2 share = at - corner;
        return glm::mix(glm::mix(value(0, 0), value(1, 0), share.x), glm::mix(value(0, 1), value(1, 1), share.x), share.y);
    }
    // The signed distance from the polygon's edges. A point is inside if a ray from it crosses the
    // edges an odd number of times.
    double distance = INFINITY;
    bool inside = false;
    for (std::size_t i = 0; i < mask.polygon.size(); ++i) {
        const glm::dvec2 a = mask.polygon[i], b = mask.polygon[(i + 1) % mask.polygon.size()];
        distance = std::min(distance, distanceTo(pixel, a, b));
        if ((a.y > pixel.y) != (b.y > pixel.y) && pixel.x < a.x + (pixel.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    if (!inside) distance = -distance;
    // An edge is at least a pixel soft, so that it shows no steps.
    const double hidden = std::clamp(distance / std::max(mask.feather, 1.0) + 0.5, 0.0, 1.0);
    return mask.hidesOutside ? hidden : 1 - hidden;
}

}  // namespace

std::optional<BlendMap> blendMap(std::span<const Projection> onCanvas, std::size_t which, int threads) {
    const Projection& own = onCanvas[which];
    if (onCanvas.size() == 1 && own.masks.empty()) return std::nullopt;
    std::vector<Reach> reaches(onCanvas.begin(), onCanvas.end());
    for (Reach& reach : reaches) reach.measure(reaches, threads);

    // The sum of the black levels of all projectors that shine on a point, and their number.
    const auto blackAt = [&](glm::dvec2 unitCanvas) {
        std::pair<double, int> black{0, 0};
        for (const Reach& reach : reaches)
            if (reach.shines(unitCanvas)) black = {black.first + reach.blackLevel(), black.second + 1};
        return black;
    };
    // Every overlap lies in some projector's picture, so it is enough to sample each picture's
    // pixels.
    double brightestBlack = 0;
    for (const Projection& projection : onCanvas) {
        constexpr int kLooks = 96;
        for (int i = 0; i < kLooks * kLooks; ++i) {
            const glm::dvec2 pixel = (glm::dvec2(i % kLooks, i / kLooks) + 0.5) / double(kLooks) * glm::dvec2(projection.size);
            if (const auto unitCanvas = projection.warp.canvasFromProjector(pixel))
                brightestBlack = std::max(brightestBlack, blackAt(*unitCanvas).first);
        }
    }

    BlendMap map(own.size.x, own.size.y);
    const double range = 1 - own.light.blackLevel;
    parallelFor(own.size.y, threads, [&](int y) {
        for (int x = 0; x < own.size.x; ++x) {
            const glm::dvec2 pixel(x + 0.5, y + 0.5);
            double share = 1, lift = 0;
            if (const auto unitCanvas = own.warp.canvasFromProjector(pixel)) {
                double claims = 0;
                for (const Reach& reach : reaches) claims += reach.claim(*unitCanvas);
                const double claim = reaches[which].claim(*unitCanvas);
                if (claims > 0) share = claim / claims;
                const auto [black, count] = blackAt(*unitCanvas);
                if (count > 0) lift = (brightestBlack - black) / count / range;
            }
            for (const Mask& mask : own.masks) share *= lightThrough(mask, pixel, own.size);
            map.at(x, y) = {share * (1 - brightestBlack) / range, lift};
        }
    });
    return map;
}

}  // namespace fantascope::render
