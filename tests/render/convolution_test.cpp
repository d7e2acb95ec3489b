// Compares the blur on the GPU with its definition, a sum over the filter in double precision on
// the CPU.

#include "render/gpu/paint/convolution.h"

#include "render/canvas/fourier_plan.h"
#include "render/drawn_source.h"
#include "render/scene.h"
#include "render/source/penumbra.h"

#include "core/geometry.h"
#include "core/random.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

namespace fantascope::render {
namespace {

// The error of a sum of some thousand terms in single precision.
constexpr double kTransform = 2e-6;

GreyImage randomPicture(glm::ivec2 size, std::uint64_t seed) {
    Rng rng(seed);
    GreyImage picture(size.x, size.y);
    for (float& pixel : picture.pixels()) pixel = rng.uniform() < 0.4 ? 1.0f : 0.0f;
    return picture;
}

// A pattern with a square over each pixel that is 1.
pattern::ShapePattern mosaic(const GreyImage& picture) {
    pattern::ShapePattern pattern = squareAt({0, 0}, std::sqrt(0.5) / picture.height(), glm::vec3(1));
    pattern.width = picture.width();
    pattern.height = picture.height();
    const pattern::ShapeInstance square = pattern.instances[0];
    pattern.instances.clear();
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            if (picture.at(x, y) == 0) continue;
            pattern.instances.push_back(square);
            pattern.instances.back().centre = glm::dvec2(x + 0.5, y + 0.5) / double(picture.height());
        }
    return pattern;
}

// An OpenGL context and everything needed to blur in it.
struct Gpu {
    DrawnOutput context{{16, 16}, rectangleCorners(16, 16), {}};
    static constexpr int kSamples = 4;
    DrawingTools tools{gpu::ShapePainter::create(shaderFolder()).value(),
                       gpu::ProgramCache(shaderFolder()),
                       gpu::Bend(),
                       gpu::Bend(),
                       kSamples,
                       Stopwatch(nullptr)};

    // `picture`, painted with a black margin and blurred by the GPU.
    GreyImage blurred(const GreyImage& picture, const GreyImage& filter, glm::vec2 fromCoverage = {0, 1}, int block = 1) {
        const glm::ivec2 size(picture.width(), picture.height());
        auto convolution = gpu::Convolution::create(size, filter, block, kSamples, tools.programs);
        EXPECT_TRUE(convolution) << convolution.error().message();
        const glm::ivec2 painted = block * (size + 2 * convolution->margin());
        auto layer = gpu::LayerPicture::create(painted, kSamples);
        WarpShape upsideDown{.corners = rectangleCorners(block * size.x, block * size.y)};
        for (glm::dvec2& corner : upsideDown.corners) {
            corner += glm::dvec2(block * convolution->margin());
            corner.y = painted.y - corner.y;
        }
        layer->begin();
        const PatternSource source = resting(mosaic(picture));
        DrawnInstances instances(source, {painted, Warp::of(upsideDown).value()});
        if (!source.pattern->instances.empty()) instances.paint({}, tools);
        convolution->run(*layer, fromCoverage);
        GreyImage result(size.x, size.y);
        glGetTextureImage(convolution->texture(), 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(result.pixels().size_bytes()),
                          result.pixels().data());
        EXPECT_EQ(glGetError(), unsigned{GL_NO_ERROR});
        return result;
    }
};

// The convolution at one pixel by definition, with 0 beyond the border.
double convolved(const GreyImage& picture, const GreyImage& filter, int x, int y) {
    double sum = 0;
    for (int v = 0; v < filter.height(); ++v)
        for (int u = 0; u < filter.width(); ++u) {
            const int fromX = x - (u - filter.width() / 2), fromY = y - (v - filter.height() / 2);
            if (fromX < 0 || fromY < 0 || fromX >= picture.width() || fromY >= picture.height()) continue;
            sum += double{filter.at(u, v)} * double{picture.at(fromX, fromY)};
        }
    return sum;
}

double largestError(const GreyImage& blurred, const GreyImage& picture, const GreyImage& filter) {
    double largest = 0;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            largest = std::max(largest, std::abs(double{blurred.at(x, y)} - convolved(picture, filter, x, y)));
        }
    return largest;
}

double sumOf(const GreyImage& image) {
    double sum = 0;
    for (const float value : image.pixels()) sum += double{value};
    return sum;
}

// Odd and even sizes, primes, one pixel, filters wider than the picture, discs with fractional
// diameters. Example failures: the quarters of an odd picture overlap or leave a gap; the border
// wraps around; the filter is off by a pixel.
TEST(Convolution, is_the_sum_over_the_filter_for_every_size_and_diameter) {
    Gpu gpu;
    for (const glm::ivec2 size : {glm::ivec2(1, 1), {2, 3}, {37, 23}, {64, 48}, {101, 7}}) {
        const GreyImage picture = randomPicture(size, 5);
        for (const double diameter : {1.0, 2.5, 7.0, 15.6, 31.0, 80.0})
            EXPECT_LT(largestError(gpu.blurred(picture, discFilter(diameter)), picture, discFilter(diameter)), kTransform)
                << size.x << " x " << size.y << ", diameter " << diameter;
    }
}

// A picture that is painted more finely than it is blurred gives the same result.
TEST(Convolution, averages_a_finer_picture) {
    Gpu gpu;
    const GreyImage picture = randomPicture({37, 23}, 5), disc = discFilter(7);
    for (const int block : {2, 4}) EXPECT_LT(largestError(gpu.blurred(picture, disc, {0, 1}, block), picture, disc), kTransform);
}

// Example failure: a filter that is upside down or mirrored, which a disc would not reveal.
TEST(Convolution, keeps_any_filter_the_right_way_round) {
    Gpu gpu;
    GreyImage filter(9, 5);
    Rng rng(3);
    for (float& value : filter.pixels()) value = static_cast<float>(rng.uniform());
    const GreyImage picture = randomPicture({41, 30}, 6);
    EXPECT_LT(largestError(gpu.blurred(picture, filter), picture, filter), kTransform * sumOf(filter));

    // A single pixel gives the filter itself.
    GreyImage hole(21, 21);
    hole.at(10, 10) = 1;
    const GreyImage thrown = gpu.blurred(hole, filter);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 9; ++x) EXPECT_NEAR(thrown.at(6 + x, 8 + y), filter.at(x, y), 1e-5) << x << ", " << y;
}

// Beyond the canvas there is full light, and white stays white.
TEST(Convolution, pads_with_white) {
    Gpu gpu;
    const GreyImage white = gpu.blurred(GreyImage(50, 40), discFilter(21), {1, -1});
    for (const float lit : white.pixels()) ASSERT_NEAR(lit, 1, 1.0 / 255);
    const GreyImage allDark(50, 40, 1.0f);
    const GreyImage lit = gpu.blurred(allDark, discFilter(21), {1, -1});
    EXPECT_NEAR(lit.at(25, 20), 0, 1.0 / 255);
    EXPECT_NEAR(lit.at(0, 20), 0.5, 0.04) << "half of the disc lies in the light outside";
    EXPECT_NEAR(lit.at(49, 39), 0.75, 0.04);
}

TEST(FourierPlan, goes_over_every_frequency_once_and_wastes_little) {
    for (int points = 1; points <= 2200; ++points) {
        const FourierPlan plan(points);
        ASSERT_GE(plan.length(), points);
        ASSERT_LE(plan.length(), 1.34 * points + 3) << points;
    }
    const FourierPlan plan(336);
    std::set<int> frequencies;
    for (int place = 0; place < plan.length(); ++place) frequencies.insert(plan.frequencyAt(place));
    EXPECT_EQ(frequencies.size(), static_cast<std::size_t>(plan.length()));
    EXPECT_EQ(*frequencies.rbegin(), plan.length() - 1);
}

}  // namespace
}  // namespace fantascope::render
