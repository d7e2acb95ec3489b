// z_camera on the default site: what the simulated camera sees of swaying shapes on two keystoned
// pictures, compared with their guides.

#include "drivers/default_site.h"

#include "vision/compare/guide_comparison.h"

#include "core/file.h"
#include "core/random.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <map>

namespace fantascope::site {
namespace {

constexpr double kAspect = 16.0 / 9;

// Guides like an artist's: two soft strokes; a tree with hard edges.
GreyImage strokes() {
    GreyImage guide(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            const double u = (x + 0.5) / 180, v = (y + 0.5) / 180;
            const double first = (v - 0.5 - 0.22 * std::sin(4 * u)) / 0.08, second = (v - 0.28 - 0.1 * std::cos(5 * u)) / 0.05;
            guide.at(x, y) =
                static_cast<float>(std::min(1.0, 0.85 * std::exp(-first * first / 2) + 0.5 * std::exp(-second * second / 2)));
        }
    return guide;
}

GreyImage tree() {
    GreyImage guide(320, 180);
    const auto branch = [&](glm::dvec2 from, glm::dvec2 to, double width, float value) {
        for (int y = 0; y < 180; ++y)
            for (int x = 0; x < 320; ++x) {
                const glm::dvec2 at((x + 0.5) / 180, (y + 0.5) / 180), along = to - from;
                const double t = std::clamp(glm::dot(at - from, along) / glm::dot(along, along), 0.0, 1.0);
                if (glm::distance(at, from + t * along) < width) guide.at(x, y) = value;
            }
    };
    branch({0.9, 0.95}, {0.85, 0.4}, 0.05, 0.9f);
    branch({0.86, 0.6}, {1.3, 0.25}, 0.035, 0.8f);
    branch({0.86, 0.5}, {0.4, 0.2}, 0.035, 0.8f);
    branch({1.45, 0.2}, {1.46, 0.2}, 0.13, 0.6f);
    return guide;
}

// A pattern like the optimiser's: white discs that cover as much of every neighbourhood as the
// guide is bright.
struct Disc {
    glm::dvec2 centre;
    double radius;
    glm::dvec3 colour;
};

constexpr double kCell = 0.035;  // canvas heights between neighbours

std::vector<Disc> discsAfter(const GreyImage& guide, bool coloured) {
    constexpr std::array<glm::dvec3, 3> kColours{{{1, 1, 1}, {0.2, 1, 0.3}, {0.2, 0.6, 1}}};
    std::vector<Disc> discs;
    Rng rng(5);
    for (double y = kCell / 2; y < 1; y += kCell)
        for (double x = kCell / 2; x < kAspect; x += kCell) {
            const float wanted = guide.at(static_cast<int>(x * 180), static_cast<int>(y * 180));
            const glm::dvec2 centre = glm::dvec2(x, y) + kCell * 0.15 * glm::dvec2(rng.normal(), rng.normal());
            discs.push_back({centre, kCell * std::sqrt(wanted / 3.14159265), kColours[coloured ? rng.below(3) : 0]});
        }
    return discs;
}

// The projector's frame: the discs through its keystone, swaying, faded to `opacity` in linear
// light.
std::shared_ptr<const RgbaImage> frameOf(const std::vector<Disc>& discs, const show::Output& output, double opacity,
                                         double phase) {
    constexpr int kSide = 3;  // samples across and down a pixel
    const glm::ivec2 size = output.size();
    const Homography projectorFromCanvas =
                         *Homography::fromCorners(rectangleCorners(kAspect, 1), output.projection.warp.shape().corners),
                     canvasFromProjector = projectorFromCanvas.inverse();
    Image<glm::dvec3> light(size.x, size.y, glm::dvec3(0));
    for (const Disc& disc : discs) {
        if (disc.radius < 1e-3) continue;
        const glm::dvec2 centre =
            disc.centre + 0.004 * glm::dvec2(std::sin(phase + 5 * disc.centre.y), std::cos(phase + 3 * disc.centre.x));
        glm::dvec2 low(1e9), high(-1e9);
        for (const glm::dvec2 side : {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1)}) {
            const glm::dvec2 pixel = projectorFromCanvas(centre + disc.radius * side);
            low = glm::min(low, pixel);
            high = glm::max(high, pixel);
        }
        for (int y = std::max(0, static_cast<int>(low.y)); y <= std::min(size.y - 1, static_cast<int>(high.y)); ++y)
            for (int x = std::max(0, static_cast<int>(low.x)); x <= std::min(size.x - 1, static_cast<int>(high.x)); ++x)
                for (int i = 0; i < kSide * kSide; ++i) {
                    const glm::dvec2 within((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
                    if (glm::distance(canvasFromProjector(glm::dvec2(x, y) + within), centre) < disc.radius)
                        light.at(x, y) += disc.colour / static_cast<double>(kSide * kSide);
                }
    }
    auto frame = std::make_shared<RgbaImage>(size.x, size.y);
    const auto stored = [&](double linear) {
        return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(std::min(linear, 1.0) * opacity))));
    };
    for (std::size_t i = 0; i < light.pixels().size(); ++i) {
        const glm::dvec3 pixel = light.pixels()[i];
        frame->pixels()[i] = {stored(pixel.r), stored(pixel.g), stored(pixel.b), 255};
    }
    return frame;
}

// The default site with a script of faults, and the two comparisons, which know only its nominal
// file.
class Night {
public:
    explicit Night(const std::string& faults) {
        const std::string file = sourceFolder() + "/config/simulated/site.yaml";
        const ConfigNode simulation = ConfigNode::parse(readFile(file).value() + "  faults: [" + faults + "]\n", file).value();
        const NominalSite nominal = nominalPartsOf(site_);
        simulated_ = SimulatedSite::open(section(simulation), nominal, 1, world_).value();
        world_.installRelays("road", {false, false});
        simulated_->begin(Time{});
        for (std::size_t i = 0; i < 2; ++i)
            comparisons_.emplace_back(
                vision::NominalView{
                    *nominal.camera, {}, nominal.outputs[i].projector, kAspect, site_.outputs[i].projection.warp, {}},
                guides_[i], guides_[i]);
    }

    struct Scores {
        std::optional<double> left, right;
    };
    // The scores of the camera frame that is exposed `at` seconds.
    Scores at(double time) {
        for (std::size_t i = 0; i < 2; ++i)
            world_.setFrame(site_.outputs[i].name, frameOf(discs_[coloured_][i], site_.outputs[i], opacity_, time));
        clock_.advanceTo(fromSeconds(time));
        simulated_->advanceTo(clock_.now());
        clock_.advanceTo(fromSeconds(time + 0.06));
        const auto frame = world_.takeFromCamera();
        const auto z = [&](std::size_t output) -> std::optional<double> {
            const auto seen = comparisons_[output].compare(frame->image);
            return seen ? std::optional(seen->z) : std::nullopt;
        };
        return {z(0), z(1)};
    }
    void setLamps(bool sculpture, bool roads) {
        std::array<std::uint8_t, kDmxSlots> slots{};
        slots[0] = sculpture ? 255 : 0;
        world_.setSlots(1, slots);
        world_.setRelays("road", {roads, roads});
    }
    double opacity_ = 1;
    bool coloured_ = false;

private:
    static ConfigNode section(const ConfigNode& file) {
        const auto entries = file.entries().value();
        for (const auto& [key, node] : entries)
            if (key == "simulation") return node;
        return file;
    }
    const show::Site site_ = defaultSite();
    const std::array<GreyImage, 2> guides_{strokes(), tree()};
    const std::array<std::array<std::vector<Disc>, 2>, 2> discs_{{{discsAfter(guides_[0], false), discsAfter(guides_[1], false)},
                                                                  {discsAfter(guides_[0], true), discsAfter(guides_[1], true)}}};
    ManualClock clock_;
    World world_{clock_};
    std::unique_ptr<SimulatedSite> simulated_;
    std::vector<vision::GuideComparison> comparisons_;
};

// Measures the whole chain. Each bump lasts from n.05 to n.75 s; the camera looks at n.4 during it,
// and at n.9 when it is over.
TEST(GuideComparisonOnSite, rises_while_a_projector_is_bumped_and_only_for_its_own_output) {
    const std::vector<std::pair<std::string, double>> bumps = {{"move: [0.06, 0, 0]", 1.05},
                                                               {"turn: [0, 0.5, 0]", 1.5},
                                                               {"turn: [0, 1, 0]", 2.5},
                                                               {"turn: [1, 0, 0]", 2.5},
                                                               {"turn: [0, 0, 3]", 1.5}};
    std::string faults;
    for (std::size_t i = 0; i < bumps.size(); ++i)
        faults += fmt::format("{{kind: bump, output: left, at: {0}.05, until: {0}.75, {1}}}, ", i + 1, bumps[i].first);
    Night night(faults);
    const Night::Scores right = night.at(0.5);
    ASSERT_TRUE(right.left && right.right);
    fmt::print("in place: left {:.4f}, right {:.4f}\n", *right.left, *right.right);
    EXPECT_LT(*right.left, 0.05);
    EXPECT_LT(*right.right, 0.05);
    for (std::size_t i = 0; i < bumps.size(); ++i) {
        const auto& [bump, rise] = bumps[i];
        const auto second = static_cast<double>(i + 1);
        const Night::Scores bumped = night.at(second + 0.4), back = night.at(second + 0.9);
        ASSERT_TRUE(bumped.left && bumped.right && back.left && back.right);
        fmt::print("{}: left {:.4f}, right {:.4f}; put back: left {:.4f}, right {:.4f}\n", bump, *bumped.left, *bumped.right,
                   *back.left, *back.right);
        EXPECT_GT(*bumped.left, rise * *right.left) << bump;
        EXPECT_NEAR(*back.left, *right.left, 0.004) << bump;
        EXPECT_NEAR(*bumped.right, *right.right, 0.004) << bump;
    }
}

TEST(GuideComparisonOnSite, stays_put_through_fades_colours_swaying_and_lamps) {
    Night night("{kind: fog, at: 20, density: 0.03}");
    double time = 0;
    const double base = night.at(time).left.value();
    const auto staysPut = [&](const std::string& what, double tolerance) {
        const auto scores = night.at(time += 0.3);  // another moment of the swaying, other noise
        ASSERT_TRUE(scores.left) << what;
        fmt::print("{}: left {:.4f}, in place {:.4f}\n", what, *scores.left, base);
        EXPECT_NEAR(*scores.left, base, tolerance) << what;
    };
    staysPut("later", 0.005);
    night.setLamps(true, false);
    staysPut("sculpture's lamp", 0.005);
    night.setLamps(false, true);
    staysPut("road lamps", 0.012);
    night.setLamps(false, false);
    for (const double opacity : {0.5, 0.2, 0.1}) {
        night.opacity_ = opacity;
        staysPut(fmt::format("opacity {}", opacity), 0.006);
    }
    night.opacity_ = 1;
    night.coloured_ = true;
    staysPut("colours", 0.008);
    night.setLamps(true, true);
    staysPut("colours and all lamps", 0.015);
    night.coloured_ = false;
    night.setLamps(false, false);
    time = 20;
    staysPut("fog", 0.005);
}

// A blackout is not a wrong picture, but a lamp that shines into it is not a right one.
TEST(GuideComparisonOnSite, has_no_value_in_the_dark_and_a_bad_one_under_lamps_alone) {
    Night night("");
    night.opacity_ = 0;
    const auto dark = night.at(0);
    EXPECT_FALSE(dark.left || dark.right);
    night.setLamps(true, true);
    const auto lit = night.at(1);
    EXPECT_GT(lit.left.value_or(1), 0.1);
    EXPECT_GT(lit.right.value_or(1), 0.1);
}

}  // namespace
}  // namespace fantascope::site
