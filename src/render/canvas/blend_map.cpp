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

// Distances are worked out for a lattice over the canvas and are straight in between: they bend
// only where two edges are equally near.
constexpr int kLattice = 192;  // cells each way
constexpr int kPieces = 48;    // of each of a picture's four edges, since a mesh bends them

bool within(glm::dvec2 point, glm::dvec2 low, glm::dvec2 high) {
    return point.x >= low.x && point.y >= low.y && point.x <= high.x && point.y <= high.y;
}

double distanceTo(glm::dvec2 point, glm::dvec2 from, glm::dvec2 to) {
    const glm::dvec2 along = to - from;
    const double length = glm::dot(along, along),
                 share = length > 0 ? std::clamp(glm::dot(point - from, along) / length, 0.0, 1.0) : 0;
    return glm::distance(point, from + share * along);
}

// One projector's reach over the canvas.
class Reach {
public:
    explicit Reach(const Projection& projection) : projection_(projection) {}

    // Whether its pixels, lit or black, fall onto a point of the canvas's plane.
    bool shines(glm::dvec2 canvas) const {
        return within(projection_.warp.projectorFromCanvas(canvas), glm::dvec2(0), glm::dvec2(projection_.size));
    }
    // Whether its part of the picture does.
    bool shows(glm::dvec2 canvas) const {
        const CanvasPart& part = projection_.warp.shape().part;
        return within(canvas, part.low, part.high) && shines(canvas);
    }

    // Finds those edges of its picture that lie inside another one, and how far the canvas is from
    // them.
    void measure(std::span<const Reach> all, int threads) {
        std::vector<std::pair<glm::dvec2, glm::dvec2>> pieces;
        // `beyond`: just outside of the picture. An edge that ends the other picture too is none to
        // blend at.
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
                // An edge of the canvas's part where it is seen,
                const auto onPart = [&](double end) { return glm::mix(part.low, part.high, at(end)); };
                if (shines(onPart(0.5))) keep(onPart(0), onPart(1), onPart(0.5) + kBeyond * outwards[edge]);
                // and of the projector's own raster where that cuts the part off.
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
    // How much it wants to have of the light at a point of the canvas, beside what the others want;
    // none where it shows nothing.
    double claim(glm::dvec2 canvas) const {
        if (!shows(canvas)) return 0;
        const glm::dvec2 at = glm::clamp(canvas, 0.0, 1.0) * double(kLattice);
        const glm::ivec2 cell = glm::min(glm::ivec2(at), kLattice - 1);
        const glm::dvec2 share = at - glm::dvec2(cell);
        const double* corner = distances_.data() + cell.y * (kLattice + 1) + cell.x;
        const double distance = glm::mix(glm::mix(corner[0], corner[1], share.x),
                                         glm::mix(corner[kLattice + 1], corner[kLattice + 2], share.x), share.y);
        return std::max(distance * distance, 1e-12);  // its square starts and ends without a kink
    }
    double blackLevel() const { return projection_.light.blackLevel; }

private:
    static constexpr double kBeyond = 1e-3;  // widths and heights of the canvas
    static constexpr double kFar = 2;        // from an edge that is none: more than the canvas is wide

    const Projection& projection_;
    std::vector<double> distances_;  // [row][column] of the lattice, in widths and heights of the canvas
};

// Light that a mask leaves at a pixel, 0..1.
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
    // How far inside the polygon: a point is inside when a ray from it crosses the edges an odd
    // number of times.
    double distance = INFINITY;
    bool inside = false;
    for (std::size_t i = 0; i < mask.polygon.size(); ++i) {
        const glm::dvec2 a = mask.polygon[i], b = mask.polygon[(i + 1) % mask.polygon.size()];
        distance = std::min(distance, distanceTo(pixel, a, b));
        if ((a.y > pixel.y) != (b.y > pixel.y) && pixel.x < a.x + (pixel.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    if (!inside) distance = -distance;
    // An edge is never sharper than a pixel, so that it does not show steps.
    const double hidden = std::clamp(distance / std::max(mask.feather, 1.0) + 0.5, 0.0, 1.0);
    return mask.hidesOutside ? hidden : 1 - hidden;
}

}  // namespace

std::optional<BlendMap> blendMap(std::span<const Projection> onCanvas, std::size_t which, int threads) {
    const Projection& own = onCanvas[which];
    if (onCanvas.size() == 1 && own.masks.empty()) return std::nullopt;
    std::vector<Reach> reaches(onCanvas.begin(), onCanvas.end());
    for (Reach& reach : reaches) reach.measure(reaches, threads);

    // The blacks of all projectors that shine on a point, and how many they are.
    const auto blackAt = [&](glm::dvec2 canvas) {
        std::pair<double, int> black{0, 0};
        for (const Reach& reach : reaches)
            if (reach.shines(canvas)) black = {black.first + reach.blackLevel(), black.second + 1};
        return black;
    };
    // Every place where several projectors shine is on one of them: a look at some of the pixels of
    // each is enough.
    double brightestBlack = 0;
    for (const Projection& projection : onCanvas) {
        constexpr int kLooks = 96;
        for (int i = 0; i < kLooks * kLooks; ++i) {
            const glm::dvec2 pixel = (glm::dvec2(i % kLooks, i / kLooks) + 0.5) / double(kLooks) * glm::dvec2(projection.size);
            if (const auto canvas = projection.warp.canvasFromProjector(pixel))
                brightestBlack = std::max(brightestBlack, blackAt(*canvas).first);
        }
    }

    BlendMap map(own.size.x, own.size.y);
    const double range = 1 - own.light.blackLevel;
    parallelFor(own.size.y, threads, [&](int y) {
        for (int x = 0; x < own.size.x; ++x) {
            const glm::dvec2 pixel(x + 0.5, y + 0.5);
            double share = 1, lift = 0;
            if (const auto canvas = own.warp.canvasFromProjector(pixel)) {
                double claims = 0;
                for (const Reach& reach : reaches) claims += reach.claim(*canvas);
                const double claim = reaches[which].claim(*canvas);
                if (claims > 0) share = claim / claims;
                const auto [black, count] = blackAt(*canvas);
                if (count > 0) lift = (brightestBlack - black) / count / range;
            }
            for (const Mask& mask : own.masks) share *= lightThrough(mask, pixel, own.size);
            map.at(x, y) = {share * (1 - brightestBlack) / range, lift};
        }
    });
    return map;
}

}  // namespace fantascope::render
