#include "theatre/body/simplify.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

// The weight of a vertex's distance along the surface from those it replaces, against its distance
// from their planes. Without it the straight parts of limbs would become long needles, which break
// where the limbs bend.
constexpr double kSpread = 0.004;

// The sum of squared distances from planes, weighted: x'Ax + 2 b'x + c.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    dvec3 b{0};
    double c = 0;

    void addPlane(const dvec3& n, double d, double weight) {
        xx += weight * n.x * n.x, xy += weight * n.x * n.y, xz += weight * n.x * n.z;
        yy += weight * n.y * n.y, yz += weight * n.y * n.z, zz += weight * n.z * n.z;
        b += weight * d * n, c += weight * d * d;
    }
    void addPoint(const dvec3& p, double weight) {
        xx += weight, yy += weight, zz += weight;
        b -= weight * p, c += weight * glm::dot(p, p);
    }
    Quadric& operator+=(const Quadric& o) {
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz, b += o.b, c += o.c;
        return *this;
    }
    double weight() const { return xx + yy + zz; }
    dvec3 times(const dvec3& p) const {
        return {xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
    }
    double operator()(const dvec3& p) const { return std::max(0.0, glm::dot(p, times(p)) + 2 * glm::dot(b, p) + c); }
    // The minimiser, by Cramer's rule; `otherwise` if there is none.
    dvec3 least(const dvec3& otherwise) const {
        const dvec3 x(xx, xy, xz), y(xy, yy, yz), z(xz, yz, zz), across = glm::cross(y, z);
        const double determinant = glm::dot(x, across);
        if (determinant <= 0) return otherwise;
        return -dvec3(glm::dot(b, across), glm::dot(x, glm::cross(b, z)), glm::dot(x, glm::cross(y, b))) / determinant;
    }
};

class Simplifier {
public:
    Simplifier(const TriangleMesh& mesh, const std::function<double(const glm::vec3&)>& importance)
        : triangles_(mesh.triangles), left_(mesh.triangles.size()) {
        places_.assign(mesh.vertices.begin(), mesh.vertices.end());
        quadrics_.resize(places_.size());
        around_.resize(places_.size());
        changes_.resize(places_.size(), 0);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            const glm::uvec3& corners = triangles_[t];
            const dvec3 normal = normalOf(t);
            const double length = glm::length(normal);
            for (int i = 0; i < 3; ++i) {
                around_[corners[i]].push_back(t);
                if (length == 0) continue;
                const double weight = length * importance(mesh.vertices[corners[i]]);
                quadrics_[corners[i]].addPlane(normal / length, -glm::dot(normal / length, places_[corners[0]]), weight);
                quadrics_[corners[i]].addPoint(places_[corners[i]], kSpread * weight);
            }
        }
    }

    void reduceTo(std::size_t triangles) {
        for (std::uint32_t v = 0; v < places_.size(); ++v) {
            findNeighbours(v, nearA_);
            for (const std::uint32_t other : nearA_)
                if (v < other) offer(v, other);
        }
        while (left_ > triangles && !offers_.empty()) {
            const Offer best = offers_.top();
            offers_.pop();
            if (best.change != changes_[best.from] + changes_[best.to]) continue;  // outdated: one of them has moved since
            collapse(best.from, best.to);
        }
    }

    void reduceWithin(double tolerance, const std::function<bool(const glm::vec3&)>& mayGo) {
        offersAreMade_ = false;
        std::vector<char> isKept(places_.size(), 0);
        for (std::size_t v = 0; v < places_.size(); ++v) isKept[v] = mayGo(glm::vec3(places_[v])) ? 0 : 1;
        std::vector<std::uint32_t> near;
        for (const double share : {0.1, 0.3, 1.0, 1.0})
            for (std::uint32_t v = 0; v < places_.size(); ++v) {
                if (isKept[v] != 0 || around_[v].empty()) continue;
                findNeighbours(v, near);
                for (const std::uint32_t other : near) {
                    if (isKept[other] != 0 || around_[other].empty()) continue;
                    const Quadric both = joined(v, other);
                    if (both(target(v, other)) <= share * share * tolerance * tolerance * both.weight() && collapse(v, other))
                        break;
                }
            }
    }

    TriangleMesh result() const {
        TriangleMesh mesh;
        std::vector<std::uint32_t> number(places_.size(), 0);
        for (std::size_t v = 0; v < places_.size(); ++v) {
            if (around_[v].empty()) continue;
            number[v] = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.emplace_back(places_[v]);
        }
        for (const glm::uvec3& t : triangles_)
            if (t.x != t.y) mesh.triangles.emplace_back(number[t.x], number[t.y], number[t.z]);
        return mesh;
    }

private:
    struct Offer {
        double cost = 0;
        std::uint32_t from = 0, to = 0, change = 0;
        bool operator<(const Offer& o) const { return std::tie(cost, from, to) > std::tie(o.cost, o.from, o.to); }
    };

    dvec3 normalOf(std::uint32_t t) const {
        const glm::uvec3& c = triangles_[t];
        return glm::cross(places_[c.y] - places_[c.x], places_[c.z] - places_[c.x]);
    }
    static bool has(const glm::uvec3& t, std::uint32_t v) { return t.x == v || t.y == v || t.z == v; }

    void findNeighbours(std::uint32_t v, std::vector<std::uint32_t>& near) const {
        near.clear();
        for (const std::uint32_t t : around_[v])
            for (int i = 0; i < 3; ++i)
                if (triangles_[t][i] != v) near.push_back(triangles_[t][i]);
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
    }

    Quadric joined(std::uint32_t a, std::uint32_t b) const {
        Quadric quadric = quadrics_[a];
        return quadric += quadrics_[b];
    }
    dvec3 target(std::uint32_t a, std::uint32_t b) const { return joined(a, b).least(0.5 * (places_[a] + places_[b])); }
    void offer(std::uint32_t a, std::uint32_t b) { offers_.push({joined(a, b)(target(a, b)), a, b, changes_[a] + changes_[b]}); }

    // Link condition: the surface stays a closed manifold if the two ends share only the two
    // neighbours that belong to the edge's triangles.
    bool keepsTheSurface(std::uint32_t a, std::uint32_t b) {
        findNeighbours(a, nearA_);
        findNeighbours(b, nearB_);
        common_.clear();
        std::set_intersection(nearA_.begin(), nearA_.end(), nearB_.begin(), nearB_.end(), std::back_inserter(common_));
        return common_.size() == 2 && nearA_.size() + nearB_.size() > 7;
    }
    // Twice the area over the sum of the squared sides: 0.29 for an equilateral triangle, 0 for a
    // needle.
    static double quality(const dvec3& a, const dvec3& b, const dvec3& c) {
        const dvec3 ab = b - a, ac = c - a, bc = c - b;
        const double sides = glm::dot(ab, ab) + glm::dot(ac, ac) + glm::dot(bc, bc);
        return sides > 0 ? glm::length(glm::cross(ab, ac)) / sides : 0;
    }
    // Whether a triangle of `moved` turns by more than about 75 degrees, or becomes a needle.
    bool spoils(std::uint32_t moved, std::uint32_t gone, const dvec3& to) const {
        for (const std::uint32_t t : around_[moved]) {
            if (has(triangles_[t], gone)) continue;
            std::array<dvec3, 3> p, q;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t corner = triangles_[t][static_cast<int>(i)];
                p[i] = places_[corner], q[i] = corner == moved ? to : p[i];
            }
            const dvec3 before = glm::cross(p[1] - p[0], p[2] - p[0]), after = glm::cross(q[1] - q[0], q[2] - q[0]);
            if (glm::dot(before, after) < 0.25 * glm::length(before) * glm::length(after)) return true;
            const double wellShaped = quality(q[0], q[1], q[2]);
            if (wellShaped < 0.002 && wellShaped < quality(p[0], p[1], p[2])) return true;
        }
        return false;
    }

    bool collapse(std::uint32_t kept, std::uint32_t gone) {
        const dvec3 to = target(kept, gone);
        if (!keepsTheSurface(kept, gone) || spoils(kept, gone, to) || spoils(gone, kept, to)) return false;
        for (const std::uint32_t t : around_[gone]) {
            glm::uvec3& corners = triangles_[t];
            if (has(corners, kept)) {
                for (int i = 0; i < 3; ++i)
                    if (corners[i] != gone) std::erase(around_[corners[i]], t);
                corners = glm::uvec3(0);
                --left_;
            } else {
                for (int i = 0; i < 3; ++i)
                    if (corners[i] == gone) corners[i] = kept;
                around_[kept].push_back(t);
            }
        }
        around_[gone].clear();
        places_[kept] = to;
        quadrics_[kept] += quadrics_[gone];
        // The sum can never again equal that of an earlier offer: both counts only grow, and the
        // removed vertex is in no new offer.
        changes_[kept] += changes_[gone] + 1;
        changes_[gone] += changes_[kept] + 1;
        if (!offersAreMade_) return true;
        findNeighbours(kept, nearA_);
        for (const std::uint32_t other : nearA_) offer(std::min(kept, other), std::max(kept, other));
        return true;
    }

    std::vector<dvec3> places_;
    std::vector<glm::uvec3> triangles_;  // removed ones are 0, 0, 0
    std::size_t left_;
    std::vector<Quadric> quadrics_;
    std::vector<std::vector<std::uint32_t>> around_;  // the triangles at each vertex
    std::vector<std::uint32_t> changes_;              // how often each vertex moved
    std::priority_queue<Offer> offers_;
    bool offersAreMade_ = true;
    std::vector<std::uint32_t> nearA_, nearB_, common_;  // scratch
};

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t triangles,
                        const std::function<double(const glm::vec3&)>& importance) {
    Simplifier simplifier(mesh, importance);
    simplifier.reduceTo(triangles);
    return simplifier.result();
}

TriangleMesh simplifiedWithin(const TriangleMesh& mesh, double tolerance, const std::function<bool(const glm::vec3&)>& mayGo) {
    Simplifier simplifier(mesh, [](const glm::vec3&) { return 1.0; });
    simplifier.reduceWithin(tolerance, mayGo);
    return simplifier.result();
}

}  // namespace fantascope::theatre
