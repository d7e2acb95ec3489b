#include "theatre/body/body_mesh.h"

#include "theatre/body/human_form.h"
#include "theatre/body/implicit_surface.h"
#include "theatre/body/simplify.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

constexpr std::size_t kTriangles = 5000, kFewTriangles = 1500;

// Grid planes between two places, in steps of about a given size.
void addPlanes(std::vector<double>& planes, double to, double step) {
    const double from = planes.back();
    const int count = std::max(1, static_cast<int>(std::lround((to - from) / step)));
    for (int i = 1; i <= count; ++i) planes.push_back(from + (to - from) * i / count);
}

// The planes are closer at the hands, the ears, the face and the soles.
GridPlanes gridOfAPerson() {
    GridPlanes planes{{{-0.56}, {-0.012}, {-0.092}}};
    auto& [x, y, z] = planes;
    addPlanes(x, -0.435, 0.0045), addPlanes(x, -0.052, 0.0105), addPlanes(x, -0.036, 0.0045), addPlanes(x, 0, 0.0095);
    addPlanes(x, 0.036, 0.0095), addPlanes(x, 0.052, 0.0045), addPlanes(x, 0.435, 0.0105), addPlanes(x, 0.56, 0.0045);
    addPlanes(y, 0.03, 0.005), addPlanes(y, 0.79, 0.0125), addPlanes(y, 0.835, 0.005), addPlanes(y, 1.014, 0.006);
    addPlanes(z, -0.022, 0.0085), addPlanes(z, 0.036, 0.0047), addPlanes(z, 0.08, 0.0065), addPlanes(z, 0.132, 0.009);
    return planes;
}

// The importance of a place at rest. Hands and face are small, and people look at them.
double importance(const glm::vec3& p) {
    const bool isHand = std::abs(p.x) > 0.47f, isFace = p.y > 0.87f && p.z > 0.02f;
    return isHand ? 10 : isFace ? 6 : 1;
}

// The distance of a point from the capsules of each joint at rest, in metres; negative inside.
void feelJoints(const Body& body, const PosedBody& atRest, const dvec3& point, std::vector<double>& distances) {
    distances.assign(body.joints.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < body.capsules.size(); ++i) {
        const CapsuleTouch touch = touching(atRest.capsule(i), {{point, 0}, {point, 0}});
        double& distance = distances[body.capsules[i].joint];
        distance = std::min(distance, -touch.depth);
    }
}

// Each joint's share of a point at rest. The joint with the nearest capsules has the largest share.
// Its parent and children have shares that fall with the distance of their capsules. All other
// joints have none: two limbs may lie beside each other and must not move each other's skin.
void shareOut(const Body& body, const PosedBody& atRest, const dvec3& point, std::vector<double>& shares) {
    // Shares fall to 1/e over `falloff`. They also fall beyond `reach` from the joint, where a
    // rotation moves the skin far. Both are in shares of the stature. They are larger for the
    // spine, which bends over its length.
    struct Bend {
        double falloff, reach;
    };
    constexpr Bend kLimb{0.004, 0.055}, kSpine{0.012, 0.100};
    std::vector<double> distances;
    feelJoints(body, atRest, point, distances);
    const auto nearest = static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
    shares.assign(distances.size(), 0);
    shares[nearest] = 1;
    double sum = 1;
    for (std::size_t j = 0; j < distances.size(); ++j) {
        if (j == nearest || (body.joints[j].parent != nearest && body.joints[nearest].parent != j)) continue;
        const std::size_t between = body.joints[j].parent == nearest ? j : nearest;  // the child's joint
        const Bend& bend = body.joints[between].motion.kind() == JointMotion::Kind::Spherical ? kSpine : kLimb;
        const double beyond = std::max(0.0, glm::distance(point, atRest.place(between)) - bend.reach * body.stature);
        shares[j] = std::exp((distances[nearest] - distances[j] - beyond) / (bend.falloff * body.stature));
        sum += shares[j];
    }
    for (double& share : shares) share /= sum;
}

// The largest few shares, scaled to add up to 1.
void keepLargest(const std::vector<double>& shares, std::array<std::uint16_t, BodyMesh::kInfluences>& joints,
                 std::array<float, BodyMesh::kInfluences>& kept) {
    std::vector<std::uint16_t> order(shares.size());
    for (std::size_t j = 0; j < order.size(); ++j) order[j] = static_cast<std::uint16_t>(j);
    std::stable_sort(order.begin(), order.end(), [&](std::uint16_t a, std::uint16_t b) { return shares[a] > shares[b]; });
    // A smaller share moves no vertex by a millimetre.
    constexpr double kLeast = 0.005;
    double sum = 0;
    for (std::size_t i = 0; i < BodyMesh::kInfluences; ++i)
        if (shares[order[i]] >= kLeast) sum += shares[order[i]];
    for (std::size_t i = 0; i < BodyMesh::kInfluences; ++i) {
        const bool isKept = shares[order[i]] >= kLeast;
        joints[i] = isKept ? order[i] : std::uint16_t{0};
        kept[i] = isKept ? static_cast<float>(shares[order[i]] / sum) : 0.0f;
    }
}

// The skin of humanBody(1).
BodyMesh bound(const Body& body, TriangleMesh form) {
    BodyMesh mesh;
    mesh.atRest = std::move(form);
    mesh.edges = edgesOf(mesh.atRest);
    FANTASCOPE_CHECK(!mesh.edges.empty(), "the human form is closed");
    PosedBody atRest;
    atRest.pose(body, body.restPose(body.joints[0].offset, {1, 0, 0, 0}));
    mesh.joints.resize(mesh.atRest.vertices.size());
    mesh.shares.resize(mesh.atRest.vertices.size());
    std::vector<double> shares;
    for (std::size_t v = 0; v < mesh.shares.size(); ++v) {
        shareOut(body, atRest, mesh.atRest.vertices[v], shares);
        keepLargest(shares, mesh.joints[v], mesh.shares[v]);
    }
    return mesh;
}

// In the simpler skin only the outline matters.
struct UnitMeshes {
    BodyMesh whole, simpler;
    UnitMeshes() {
        const Body body = humanBody(1);
        const TriangleMesh form = simplified(implicitSurface(HumanForm(body), gridOfAPerson(), 1.7), kTriangles, importance);
        whole = bound(body, form);
        simpler = bound(body, simplified(form, kFewTriangles, [](const glm::vec3&) { return 1.0; }));
    }
};

// Vertices are blended in groups. Each component of the sums is contiguous in memory, so that the
// compiler can vectorise the arithmetic.
constexpr std::size_t kGroup = 64;
struct Group {
    std::array<std::array<float, kGroup>, 8> motion;
    std::array<float, kGroup> x, y, z;

    // Kavan et al. 2008, section 4, algorithm 1: the normalised blend moves the points.
    void move() {
        for (std::size_t i = 0; i < kGroup; ++i) {
            const float w = motion[0][i], a = motion[1][i], b = motion[2][i], c = motion[3][i];
            const float dw = motion[4][i], da = motion[5][i], db = motion[6][i], dc = motion[7][i];
            const float twice = 2 / (w * w + a * a + b * b + c * c);
            // v + 2 r x (r x v + w v) + 2 (w d - dw r + r x d), all over the square of the length.
            const float px = x[i], py = y[i], pz = z[i];
            const float ux = b * pz - c * py + w * px + da, uy = c * px - a * pz + w * py + db,
                        uz = a * py - b * px + w * pz + dc;
            x[i] = px + twice * (b * uz - c * uy + w * da - dw * a);
            y[i] = py + twice * (c * ux - a * uz + w * db - dw * b);
            z[i] = pz + twice * (a * uy - b * ux + w * dc - dw * c);
        }
    }
};

}  // namespace

std::vector<MeshEdge> edgesOf(const TriangleMesh& mesh) {
    std::vector<MeshEdge> edges;
    edges.reserve(mesh.triangles.size() * 3 / 2);
    constexpr std::uint32_t kNone = ~0u;
    std::unordered_map<std::uint64_t, std::size_t> known;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t from = mesh.triangles[t][i], to = mesh.triangles[t][(i + 1) % 3];
            const auto [found, isNew] =
                known.try_emplace(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), edges.size());
            if (isNew) {
                edges.push_back({from, to, t, kNone});
                continue;
            }
            MeshEdge& edge = edges[found->second];
            if (edge.right != kNone || edge.from == from) return {};
            edge.right = t;
        }
    const bool isClosed = std::all_of(edges.begin(), edges.end(), [](const MeshEdge& edge) { return edge.right != kNone; });
    return isClosed ? edges : std::vector<MeshEdge>();
}

DualQuaternion motionOf(const glm::dquat& turn, const dvec3& shift) {
    const glm::dquat dual = 0.5 * (glm::dquat(0, shift.x, shift.y, shift.z) * turn);
    const double parts[] = {turn.w, turn.x, turn.y, turn.z, dual.w, dual.x, dual.y, dual.z};
    DualQuaternion motion{};
    std::transform(std::begin(parts), std::end(parts), motion.begin(), [](double part) { return static_cast<float>(part); });
    return motion;
}

void jointMotions(const Body& body, const PosedBody& posed, std::span<DualQuaternion> motions) {
    FANTASCOPE_CHECK(body.joints.size() <= BodyMesh::kMostJoints && motions.size() >= body.joints.size(),
                     "a body has few joints");
    std::array<dvec3, BodyMesh::kMostJoints> restPlaces;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
        const Body::Joint& joint = body.joints[j];
        restPlaces[j] = j == 0 ? joint.offset : restPlaces[joint.parent] + joint.offset;
        const glm::dquat& q = posed.turn(j);
        // Of the two quaternions of a rotation, take the one nearer to the parent's.
        double sign = 1;
        if (j > 0) {
            const DualQuaternion& p = motions[joint.parent];
            if (p[0] * q.w + p[1] * q.x + p[2] * q.y + p[3] * q.z < 0) sign = -1;
        }
        motions[j] = motionOf(sign * q, posed.place(j) - q * restPlaces[j]);
    }
}

void BodyMesh::skin(const Body& body, const PosedBody& posed, std::vector<glm::vec3>& vertices) const {
    std::array<DualQuaternion, kMostJoints> motions;
    jointMotions(body, posed, motions);
    vertices.resize(atRest.vertices.size());
    Group group{};
    for (std::size_t first = 0; first < vertices.size(); first += kGroup) {
        const std::size_t count = std::min(kGroup, vertices.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const auto& from = joints[first + i];
            const auto& share = shares[first + i];
            DualQuaternion blend;
            for (std::size_t k = 0; k < 8; ++k) blend[k] = share[0] * motions[from[0]][k];
            for (std::size_t n = 1; n < kInfluences && share[n] > 0; ++n)
                for (std::size_t k = 0; k < 8; ++k) blend[k] += share[n] * motions[from[n]][k];
            for (std::size_t k = 0; k < 8; ++k) group.motion[k][i] = blend[k];
            const glm::vec3& p = atRest.vertices[first + i];
            group.x[i] = p.x, group.y[i] = p.y, group.z[i] = p.z;
        }
        group.move();
        for (std::size_t i = 0; i < count; ++i) vertices[first + i] = {group.x[i], group.y[i], group.z[i]};
    }
}

BodyMesh humanMesh(const Body& body) {
    static const UnitMeshes unit;
    const auto scaled = [&](BodyMesh mesh) {
        for (glm::vec3& vertex : mesh.atRest.vertices) vertex *= static_cast<float>(body.stature);
        return mesh;
    };
    BodyMesh mesh = scaled(unit.whole);
    mesh.simpler = std::make_shared<const BodyMesh>(scaled(unit.simpler));
    return mesh;
}

}  // namespace fantascope::theatre
