#include "theatre/stage/mesh_shadow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fantascope::theatre {
namespace {

constexpr std::size_t kDigits = 8;  // of a word
constexpr std::uint64_t kOnes = 0x0101010101010101u, kTops = 0x8080808080808080u;
// The offset of the winding numbers. Rounding may turn a sliver over; the offset keeps its negative
// digits from borrowing from their neighbours.
constexpr std::uint64_t kNone = 64;

}  // namespace

bool MeshShadow::add(const ScreenFrame& frame, const BodyMesh& mesh, std::span<const glm::vec3> vertices, BitMask& mask) {
    // A vertex closer to the light than this, metres, throws a practically unbounded shadow.
    constexpr float kNearest = 1e-3f;
    const std::size_t count = vertices.size();
    x_.resize(count), y_.resize(count);
    const glm::vec3 light(frame.light()), across(frame.onStage({1, 0, 0}));
    const glm::vec2 foot = frame.foot();
    const auto focus = static_cast<float>(frame.focus());
    constexpr float kFar = std::numeric_limits<float>::max();
    float nearest = kFar, left = kFar, right = -kFar, top = kFar, bottom = -kFar;
    for (std::size_t i = 0; i < count; ++i) {
        const float dx = vertices[i].x - light.x, dz = light.z - vertices[i].z;
        const float z = across.x * dz + across.z * dx, scale = focus / z;
        nearest = std::min(nearest, z);
        x_[i] = foot.x + scale * (across.x * dx - across.z * dz);
        y_[i] = foot.y + scale * (light.y - vertices[i].y);
        left = std::min(left, x_[i]), right = std::max(right, x_[i]);
        top = std::min(top, y_[i]), bottom = std::max(bottom, y_[i]);
    }
    if (nearest < kNearest) return false;

    const std::vector<glm::uvec3>& triangles = mesh.atRest.triangles;
    faces_.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const glm::uvec3& c = triangles[t];
        const float ax = x_[c.x], ay = y_[c.x];
        // Rows go down: anticlockwise is negative.
        faces_[t] = (x_[c.y] - ax) * (y_[c.z] - ay) - (x_[c.z] - ax) * (y_[c.y] - ay) < 0;
    }
    findOutline(mesh);
    stride_ = static_cast<std::size_t>(mask.width()) / kDigits + 1;
    turns_.resize(stride_ * static_cast<std::size_t>(mask.height()), 0);
    for (const std::uint32_t e : outline_) {
        const MeshEdge& edge = mesh.edges[e];
        cross({x_[edge.from], y_[edge.from]}, {x_[edge.to], y_[edge.to]}, faces_[edge.left] != 0 ? 1 : -1, mask);
    }

    const auto within = [](float at, int size) { return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(size))); };
    const auto firstWord = static_cast<std::size_t>(within(left - 1, mask.width())) / kDigits;
    const auto lastWord = static_cast<std::size_t>(within(right + 1, mask.width())) / kDigits;
    const int lastRow = std::min(within(bottom + 1, mask.height()), mask.height() - 1);
    for (int y = within(top - 1, mask.height()); y <= lastRow; ++y) {
        std::uint64_t* const turns = &turns_[stride_ * static_cast<std::size_t>(y)];
        std::uint64_t* const row = mask.row(y).data();
        std::uint64_t winding = kNone;  // of the previous pixel
        for (std::size_t i = firstWord; i <= lastWord; ++i) {
            if (turns[i] == 0 && winding == kNone) continue;
            // The running sums of the digits are the digits of a product.
            const std::uint64_t windings = (std::exchange(turns[i], 0) + winding) * kOnes;
            winding = windings >> 56;
            // The highest bit of each digit that is not kNone; then those bits are packed side by
            // side.
            const std::uint64_t away = windings ^ (kNone * kOnes), some = (((away & ~kTops) + ~kTops) | away) & kTops;
            if (i < static_cast<std::size_t>(mask.stride()) * kDigits)
                row[i / kDigits] |= ((some >> 7) * 0x0102040810204080u >> 56) << (8 * (i % kDigits));
        }
        mask.noteRow(y);
    }
    return true;
}

// There is no branch, since it would be unpredictable.
void MeshShadow::findOutline(const BodyMesh& mesh) {
    outline_.resize(mesh.edges.size());
    std::size_t count = 0;
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
        outline_[count] = static_cast<std::uint32_t>(e);
        count += faces_[mesh.edges[e].left] ^ faces_[mesh.edges[e].right];
    }
    outline_.resize(count);
}

// The rows whose centres lie between the ends. A centre at the upper end counts, one at the lower
// end does not, so that an outline crosses each row as often down as up.
void MeshShadow::cross(glm::vec2 a, glm::vec2 b, int turn, const BitMask& mask) {
    if (a.y > b.y) std::swap(a, b), turn = -turn;
    const auto width = static_cast<float>(mask.width()), height = static_cast<float>(mask.height());
    const int from = static_cast<int>(std::ceil(std::clamp(a.y - 0.5f, 0.0f, height)));
    const int to = static_cast<int>(std::ceil(std::clamp(b.y - 0.5f, 0.0f, height)));
    if (from >= to) return;
    const float slope = (b.x - a.x) / (b.y - a.y);
    std::uint64_t* turns = &turns_[stride_ * static_cast<std::size_t>(from)];
    for (int row = from; row < to; ++row, turns += stride_) {
        const float x = a.x + (static_cast<float>(row) + 0.5f - a.y) * slope;
        const auto column = static_cast<std::size_t>(std::ceil(std::clamp(x - 0.5f, 0.0f, width)));
        turns[column / kDigits] += static_cast<std::uint64_t>(std::int64_t{turn}) << (8 * (column % kDigits));
    }
}

}  // namespace fantascope::theatre
