#pragma once
// Projections, and helpers to look at the pictures for setting up a projector.

#include "plot/test_picture.h"

#include <glm/common.hpp>

#include <array>

namespace fantascope::plot {

inline constexpr glm::ivec2 kSize{1920, 1080};
inline constexpr double kAspect = 16.0 / 9;
inline const std::array<glm::dvec2, 4> kKeystone = {{{103.5, 41.25}, {1811, 12.5}, {1702.75, 1033}, {61, 987.125}}};
inline constexpr std::array<TestPicture, 8> kAll{TestPicture::None,    TestPicture::Grid,    TestPicture::Corners,
                                                 TestPicture::Numbers, TestPicture::Bars,    TestPicture::Ramp,
                                                 TestPicture::Focus,   TestPicture::Identify};

inline bool hidesTheShow(TestPicture picture) {
    return picture != TestPicture::None && picture != TestPicture::Bars && picture != TestPicture::Ramp;
}

inline Projection projection(const WarpShape& shape, glm::ivec2 size = kSize) {
    return {.size = size, .warp = Warp::of(shape).value()};
}
inline Projection straight(glm::ivec2 size = kSize) { return {.size = size, .warp = Warp::straight(size)}; }

inline WarpMesh aMesh(WarpMesh::Between between) {
    return {between,
            {4, 3},
            {{0, 0}, {10, -12}, {20, 10}, {0, 0}, {12, 0}, {40, 30}, {-20, -40}, {-15, 5}, {0, 0}, {0, -30}, {5, 10}, {0, 0}}};
}

inline int alphaOf(const RgbaImage& picture, int x, int y) { return picture.at(x, y).a; }
inline int lightOf(const RgbaImage& picture, int x, int y) { return picture.at(x, y).r; }

// The bounding rectangle, from .. to (exclusive), of the pixels for which a predicate is true.
struct Extent {
    glm::ivec2 from{1 << 30}, to{-1};
    bool any() const { return to.x > 0; }
    glm::ivec2 size() const { return to - from; }
};
template <class Predicate>
inline Extent extentOf(glm::ivec2 size, Predicate predicate) {
    Extent extent;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (predicate(x, y)) extent.from = glm::min(extent.from, {x, y}), extent.to = glm::max(extent.to, {x + 1, y + 1});
    return extent;
}
inline Extent differenceOf(const RgbaImage& a, const RgbaImage& b) {
    return extentOf({a.width(), a.height()}, [&](int x, int y) { return !(a.at(x, y) == b.at(x, y)); });
}

}  // namespace fantascope::plot
