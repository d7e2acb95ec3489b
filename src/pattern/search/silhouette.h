#pragma once

#include "pattern/shape/shape_pattern.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace fantascope::pattern {

// A mesh prepared for SilhouetteScanner: its edges, each with its adjacent triangles.
class Silhouette {
public:
    explicit Silhouette(const TriangleMesh& mesh);

private:
    friend class SilhouetteScanner;
    struct Side {
        std::uint32_t triangle;
        int direction;  // 1: the triangle's corners run along the edge from `from` to `to`; -1: the other way
    };
    struct Edge {
        std::uint32_t from, to;             // vertices, from < to
        std::uint32_t firstSide, sidesEnd;  // range in sides_
    };

    std::vector<glm::dvec3> vertices_;
    std::vector<glm::uvec3> triangles_;
    std::vector<Edge> edges_;
    std::vector<Side> sides_;
    // The corners of a flat convex shape's outline in order; empty for other shapes.
    std::vector<std::uint32_t> convexOutline_;
};

// Rasterises silhouettes into runs of pixels, in an orthographic view whose height is one canvas
// height. A pixel belongs to a silhouette if its centre is inside a triangle; a centre on the
// common edge of two triangles counts once. The picture's edges clip. This is the inner loop of
// every search: only the edges of the outline are followed, and after the first few silhouettes it
// no longer allocates. Thread: thread-bound.
class SilhouetteScanner {
public:
    SilhouetteScanner(int width, int height);  // of the picture, pixels

    // Calls use(y, begin, end) for disjoint runs begin <= x < end of one instance's silhouette,
    // from the top left on.
    template <class Use>
    void scan(const Silhouette& shape, const InstancePose& pose, Use use) {
        project(shape, pose);
        top_ = height_, bottom_ = 0;
        if (!shape.convexOutline_.empty()) {
            followConvexOutline(shape.convexOutline_);
            for (int y = top_; y < bottom_; ++y)
                if (const Row& row = convexRows_[static_cast<std::size_t>(y)]; row.begin < row.end) use(y, row.begin, row.end);
            return;
        }
        followOutline(shape);
        for (int y = top_; y < bottom_; ++y) {
            int layers = 0, begin = 0;
            for (int i = std::exchange(rows_[static_cast<std::size_t>(y)], -1); i >= 0;) {
                const Crossing& crossing = crossings_[static_cast<std::size_t>(i)];
                if (layers > 0 && begin < crossing.x) use(y, begin, crossing.x);
                begin = crossing.x;
                layers += crossing.change;
                i = crossing.next;
            }
        }
    }

private:
    struct Crossing {
        int x;       // the first pixel whose centre is right of the edge
        int change;  // of the number of layered triangles, from there on
        int next;    // in the same row, by rising x; -1: none
    };
    struct Row {
        int begin, end;
    };
    void project(const Silhouette& shape, const InstancePose& pose);
    void followOutline(const Silhouette& shape);
    void followConvexOutline(const std::vector<std::uint32_t>& outline);
    template <class Cross>
    void followEdge(glm::dvec2 upper, glm::dvec2 lower, Cross cross);

    int width_, height_;
    // The current silhouette.
    std::vector<glm::dvec2> projected_;  // vertices, in pixels
    std::vector<int> facing_;            // triangles: 1 clockwise as seen, -1 anticlockwise, 0 edge-on
    std::vector<Crossing> crossings_;    // the first crossingCount_ are in use
    int crossingCount_ = 0;
    std::vector<int> rows_;  // the first crossing of each row; -1: none
    std::vector<Row> convexRows_;
    int top_ = 0, bottom_ = 0;  // rows with crossings
};

}  // namespace fantascope::pattern
