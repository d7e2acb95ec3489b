#include "plot/rendering.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace fantascope::plot {
namespace {

constexpr int kSamples = 3;       // per pixel in each direction
constexpr int kBand = 32;         // rows of pixels drawn at a time, to keep the buffers small
constexpr double kNear = 0.05;    // metres; the near clipping plane
constexpr float kSmooth = 0.65f;  // cosine: edges between normals at a smaller angle are smoothed

struct Axes {
    glm::dvec3 right, up, forward;
};

Axes axesOf(const glm::dvec3& direction) {
    const glm::dvec3 forward = glm::normalize(direction), right = glm::normalize(glm::cross(forward, {0, 1, 0}));
    return {right, glm::cross(right, forward), forward};
}

// A camera's projection. seen(): a place in its frame, x right, y down, z forward, metres. at():
// pixels.
struct Lens {
    Lens(const Camera& camera, double width, double height)
        : axes(axesOf(camera.lookAt - camera.position)),
          position(camera.position),
          middle(0.5 * width, 0.5 * height),
          focus(0.5 * height / std::tan(0.5 * camera.fieldOfView)) {}

    glm::dvec3 seen(const glm::dvec3& place) const {
        const glm::dvec3 d = place - position;
        return {glm::dot(d, axes.right), -glm::dot(d, axes.up), glm::dot(d, axes.forward)};
    }
    glm::dvec2 at(const glm::dvec3& seen) const { return middle + focus / seen.z * glm::dvec2(seen); }

    Axes axes;
    glm::dvec3 position;
    glm::dvec2 middle;
    double focus;
};

struct Corner {
    glm::dvec3 seen;
    glm::vec3 place, normal;
};

Corner between(const Corner& a, const Corner& b, double share) {
    const float s = static_cast<float>(share);
    return {glm::mix(a.seen, b.seen, share), glm::mix(a.place, b.place, s), glm::mix(a.normal, b.normal, s)};
}

// A triangle in the picture. Attributes divided by the depth are linear in the picture.
struct Drawn {
    std::array<glm::dvec2, 3> at;
    std::array<double, 3> nearness;  // 1 / depth
    std::array<glm::vec3, 3> place, normal;
    double top, bottom;
    std::size_t surface;
};

// Per triangle and corner: the mean of those normals around the vertex that are close to the
// triangle's own.
std::vector<std::array<glm::vec3, 3>> normalsOf(const TriangleMesh& mesh) {
    std::vector<glm::vec3> areas, flat;
    std::vector<std::vector<std::size_t>> around(mesh.vertices.size());
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::vec3 area = glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x], mesh.vertices[t.z] - mesh.vertices[t.x]);
        const float length = glm::length(area);
        for (int i = 0; i < 3; ++i) around[t[i]].push_back(areas.size());
        areas.push_back(area);
        flat.push_back(length > 0 ? area / length : glm::vec3(0));
    }
    std::vector<std::array<glm::vec3, 3>> normals(mesh.triangles.size());
    for (std::size_t i = 0; i < normals.size(); ++i)
        for (int corner = 0; corner < 3; ++corner) {
            glm::vec3 sum(0);
            for (const std::size_t other : around[mesh.triangles[i][corner]])
                if (glm::dot(flat[i], flat[other]) > kSmooth) sum += areas[other];
            const float length = glm::length(sum);
            normals[i][static_cast<std::size_t>(corner)] = length > 0 ? sum / length : flat[i];
        }
    return normals;
}

// Clips the triangle at kNear, which leaves none, one or two triangles.
void draw(const std::array<Corner, 3>& triangle, std::size_t surface, const Lens& lens, std::vector<Drawn>& drawn) {
    std::array<Corner, 4> kept;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Corner &a = triangle[i], &b = triangle[(i + 1) % 3];
        if (a.seen.z >= kNear) kept[count++] = a;
        if ((a.seen.z >= kNear) != (b.seen.z >= kNear)) kept[count++] = between(a, b, (kNear - a.seen.z) / (b.seen.z - a.seen.z));
    }
    for (std::size_t i = 2; i < count; ++i) {
        Drawn piece;
        const std::array<const Corner*, 3> corners{&kept[0], &kept[i - 1], &kept[i]};
        for (std::size_t c = 0; c < 3; ++c) {
            piece.at[c] = lens.at(corners[c]->seen);
            piece.nearness[c] = 1 / corners[c]->seen.z;
            piece.place[c] = static_cast<float>(piece.nearness[c]) * corners[c]->place;
            piece.normal[c] = static_cast<float>(piece.nearness[c]) * corners[c]->normal;
        }
        const auto [top, bottom] = std::minmax({piece.at[0].y, piece.at[1].y, piece.at[2].y});
        piece.top = top, piece.bottom = bottom, piece.surface = surface;
        drawn.push_back(piece);
    }
}

// A band of rows of samples.
class Band {
public:
    Band(int width, int rows) : width_(width), rows_(rows) {
        nearness_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows));
        colour_.resize(nearness_.size());
    }

    void clear(int first, const glm::vec3& background) {
        first_ = first;
        std::fill(nearness_.begin(), nearness_.end(), 0.0);
        std::fill(colour_.begin(), colour_.end(), background);
    }

    void add(const Drawn& triangle, const Surface& surface, const glm::vec3& camera) {
        const auto& [a, b, c] = triangle.at;
        const double area = cross(b - a, c - a);
        if (area == 0) return;
        const auto [least, most] = std::minmax({a.x, b.x, c.x});
        // The index of the first sample whose centre is not before `place`, at most `count`.
        const auto sampleFrom = [](double place, int count) {
            return static_cast<int>(std::ceil(std::clamp(place, 0.0, double(count)) - 0.5));
        };
        const int from = sampleFrom(triangle.top - first_, rows_), to = sampleFrom(triangle.bottom - first_, rows_);
        const int left = sampleFrom(least, width_), right = sampleFrom(most, width_);
        const std::array<glm::dvec2, 3> starts{b, c, a}, sides{c - b, a - c, b - a};
        for (int y = from; y < to; ++y) {
            // The range of samples inside all three edges, one sample wider at each end.
            double first = left, last = right;
            for (std::size_t edge = 0; edge < 3; ++edge) {
                const double at = cross(sides[edge], glm::dvec2(0.5, first_ + y + 0.5) - starts[edge]) / area,
                             slope = -sides[edge].y / area;
                if (slope > 0) first = std::max(first, std::floor(-at / slope));
                if (slope < 0) last = std::min(last, std::ceil(-at / slope) + 1);
            }
            if (first >= last) continue;
            for (int x = static_cast<int>(first); x < last; ++x) {
                const glm::dvec2 p(x + 0.5, first_ + y + 0.5);
                const double u = cross(sides[0], p - b) / area, v = cross(sides[1], p - c) / area, w = 1 - u - v;
                if (u < 0 || v < 0 || w < 0) continue;
                const double nearness = u * triangle.nearness[0] + v * triangle.nearness[1] + w * triangle.nearness[2];
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
                if (nearness <= nearness_[i]) continue;
                const auto mixed = [&](const std::array<glm::vec3, 3>& of) {
                    return (static_cast<float>(u) * of[0] + static_cast<float>(v) * of[1] + static_cast<float>(w) * of[2]) /
                           static_cast<float>(nearness);
                };
                const glm::vec3 place = mixed(triangle.place);
                glm::vec3 normal = glm::normalize(mixed(triangle.normal));
                if (glm::dot(normal, camera - place) < 0) normal = -normal;
                const glm::vec4 light = surface.shade(place, normal);
                colour_[i] = glm::mix(colour_[i], glm::vec3(light), light.a);
                if (!surface.translucent) nearness_[i] = nearness;
            }
        }
    }

    Rgba8 pixel(int x, int y) const {
        glm::vec3 sum(0);
        for (int j = 0; j < kSamples; ++j)
            for (int i = 0; i < kSamples; ++i)
                sum += glm::clamp(colour_[static_cast<std::size_t>(y * kSamples + j) * static_cast<std::size_t>(width_) +
                                          static_cast<std::size_t>(x * kSamples + i)],
                                  0.0f, 1.0f);
        const auto byte = [](float linear) {
            return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(linear / (kSamples * kSamples))));
        };
        return {byte(sum.r), byte(sum.g), byte(sum.b), 255};
    }

private:
    static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

    int width_, rows_, first_ = 0;
    std::vector<double> nearness_;
    std::vector<glm::vec3> colour_;
};

}  // namespace

std::optional<glm::dvec2> Camera::pixelAt(const glm::dvec3& point, int width, int height) const {
    const Lens lens(*this, width, height);
    const glm::dvec3 seen = lens.seen(point);
    if (seen.z <= 0) return std::nullopt;
    return lens.at(seen);
}

Camera Camera::fitting(std::span<const glm::dvec3> points, const glm::dvec3& direction, double fieldOfView, double aspect,
                       double margin) {
    const Axes axes = axesOf(direction);
    const double tall = std::tan(0.5 * fieldOfView) * (1 - margin), wide = tall * aspect;
    // A point (x, y, z) in the camera's axes is inside the view from (cx, cy, cz) horizontally if
    // |x - cx| <= wide (z - cz). So cx - wide cz is at least the maximum of x - wide z, and cx +
    // wide cz at most the minimum of x + wide z. The same holds vertically.
    constexpr double kFar = std::numeric_limits<double>::infinity();
    double left = kFar, right = -kFar, low = kFar, high = -kFar;
    for (const glm::dvec3& point : points) {
        const double x = glm::dot(point, axes.right), y = glm::dot(point, axes.up), z = glm::dot(point, axes.forward);
        left = std::min(left, x + wide * z), right = std::max(right, x - wide * z);
        low = std::min(low, y + tall * z), high = std::max(high, y - tall * z);
    }
    const double back = std::min((left - right) / (2 * wide), (low - high) / (2 * tall));
    Camera camera;
    camera.position = 0.5 * (left + right) * axes.right + 0.5 * (low + high) * axes.up + back * axes.forward;
    camera.lookAt = camera.position + axes.forward;
    camera.fieldOfView = fieldOfView;
    return camera;
}

RgbaImage rendered(std::span<const Surface> surfaces, const Camera& camera, const glm::vec3& background, int width, int height) {
    const Lens lens(camera, width * kSamples, height * kSamples);
    std::vector<Drawn> drawn;
    for (const bool translucent : {false, true})
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            if (surfaces[s].translucent != translucent) continue;
            const TriangleMesh& mesh = surfaces[s].mesh;
            const auto normals = normalsOf(mesh);
            for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
                if (normals[i][0] == glm::vec3(0)) continue;  // the triangle has no area
                std::array<Corner, 3> triangle;
                for (std::size_t c = 0; c < 3; ++c) {
                    const glm::vec3 place = mesh.vertices[mesh.triangles[i][static_cast<int>(c)]];
                    triangle[c] = {lens.seen(place), place, normals[i][c]};
                }
                draw(triangle, s, lens, drawn);
            }
        }
    RgbaImage picture(width, height);
    Band band(width * kSamples, kBand * kSamples);
    for (int first = 0; first < height; first += kBand) {
        band.clear(first * kSamples, background);
        for (const Drawn& triangle : drawn)
            if (triangle.bottom > first * kSamples && triangle.top < (first + kBand) * kSamples)
                band.add(triangle, surfaces[triangle.surface], glm::vec3(camera.position));
        for (int y = first; y < std::min(height, first + kBand); ++y)
            for (int x = 0; x < width; ++x) picture.at(x, y) = band.pixel(x, y - first);
    }
    return picture;
}

}  // namespace fantascope::plot
