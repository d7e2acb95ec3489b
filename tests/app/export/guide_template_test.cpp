#include "app/export/guide_template.h"

#include "app/export/off_screen.h"
#include "app/site/site_models.h"
#include "drivers/site/simulation.h"

#include "pattern/shape/elemental_shape.h"

#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr glm::ivec2 kSize(320, 180);
constexpr double kGrid = 0.5;
const std::string kLeftCorners = "    corners: [[123.07, 48.35], [544.52, 45.43], [538.42, 324.85], [127.57, 283.18]]\n";
const glm::dvec3 kMarker(-4.7, 3.1, 0.01);  // off the middle of the left picture on the wall

// The default site with a small red thing on the wall, and, where wanted, other corners of the left
// output.
class TemplateTest : public testing::Test {
protected:
    void open(const std::string& corners = kLeftCorners) {
        fs::copy(sourceFolder() + "/config/simulated", folder_ / "site", fs::copy_options::recursive);
        std::string text = contentsOf(folder_ / "site/site.yaml");
        const auto replace = [&](const std::string& before, const std::string& after) {
            const auto at = text.find(before);
            ASSERT_NE(at, std::string::npos) << before;
            text.replace(at, before.size(), after);
        };
        replace(kLeftCorners, corners);
        replace(
            "  objects:\n",
            fmt::format(
                "  objects:\n    - {{name: marker, rectangle: {{corner: [{}, {}, {}], right: [0.08, 0, 0], up: [0, 0.08, 0]}}, "
                "reflectance: [0.9, 0, 0]}}\n",
                kMarker.x - 0.04, kMarker.y - 0.04, kMarker.z));
        folder_.file("site/site.yaml", text);
        site_ = show::readSite(folder_ / "site/site.yaml").value();
        nominal_ = simulationOf(site_).value();
        simulation_ = site::readSimulation(*site_.simulation, nominal_).value();
    }
    CanvasView left() const {
        const show::Output& output = site_.outputs[0];
        return {"left", nominal_.outputs[0].projector, vision::Plane{output.surface->point, output.surface->normal},
                output.projection.warp, simulation_.objects};
    }
    GuideTemplate drawn(int threads = 2) const { return drawGuideTemplate(left(), kSize, kGrid, threads); }

    const ScratchFolder folder_;
    show::Site site_;
    site::NominalSite nominal_;
    site::Simulation simulation_;
};

// The middle of the pixels that `counts` says so of.
template <class Counts>
glm::dvec2 middleOf(glm::ivec2 size, Counts counts) {
    glm::dvec2 sum(0.0);
    double weight = 0;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const double share = counts(x, y);
            sum += share * glm::dvec2(x + 0.5, y + 0.5);
            weight += share;
        }
    EXPECT_GT(weight, 0);
    return sum / weight;
}

// The artist paints a dot over what the template shows of the marker; the renderer, the simulated
// projector and the camera must find the light on the marker. Example failures: a template in the
// projector's pixels instead of the canvas, upside down, half a pixel off.
TEST_F(TemplateTest, what_is_drawn_over_a_thing_lights_that_thing) {
    open();
    const GuideTemplate picture = drawn();
    const glm::dvec2 pixel = middleOf(kSize, [&](int x, int y) { return picture.object.at(x, y) == 0 ? 1.0 : 0.0; });

    pattern::ShapePattern dot;
    dot.width = kSize.x;
    dot.height = kSize.y;
    dot.shapes = {pattern::loadShape("circle").value()};
    dot.instances = {{.centre = pixel / static_cast<double>(kSize.y), .size = 0.06}};
    const render::PatternSource source{std::make_shared<const pattern::ShapePattern>(dot), nullptr};
    const auto screen = OffScreen::open(site_.outputs[0].projection, nullptr, render::PictureSources::numbered({source})).value();

    ManualClock clock;
    site::World world(clock);
    const auto simulated = site::SimulatedSite::open(*site_.simulation, nominal_, 1, world).value();
    simulated->begin(Time{});
    const auto seen = [&] {
        simulated->advanceTo(clock.now());
        clock.advance(fromSeconds(0.1));  // a camera frame
        return world.takeFromCamera()->image;
    };
    const RgbaImage dark = seen();
    world.setFrame("left", std::make_shared<const RgbaImage>(screen->draw({{{0, 1.0f}}}, {}, Time{})));
    const RgbaImage lit = seen();
    const glm::dvec2 light =
        middleOf({lit.width(), lit.height()}, [&](int x, int y) { return std::max(0, lit.at(x, y).r - dark.at(x, y).r - 60); });
    EXPECT_LT(glm::distance(light, nominal_.camera->pixelFromWorld(kMarker).value()), 0.5);
}

// By the site's drawings the left picture is 5.12 m x 2.88 m and its lower left corner stands at
// (-5.92, 0.9).
TEST_F(TemplateTest, the_grid_is_in_metres_of_the_wall) {
    open();
    EXPECT_NEAR(left().sizeOnSurface()->x, 5.12, 0.01);
    EXPECT_NEAR(left().sizeOnSurface()->y, 2.88, 0.01);
    const RgbaImage picture = drawn().picture;
    const auto rowOf = [](double y) { return (0.9 + 2.88 - y) / 2.88 * kSize.y; };
    const auto columnOf = [](double x) { return (x + 5.92) / 5.12 * kSize.x; };
    // Away from the letters and the axes in the middle.
    const double plain = picture.at(static_cast<int>(columnOf(-1.75)), static_cast<int>(rowOf(1.75))).g;
    for (const double y : {2.0, 2.5}) {
        const int row = static_cast<int>(std::lround(rowOf(y) - 0.5)), column = static_cast<int>(columnOf(-1.75));
        const double darkest =
            std::min({picture.at(column, row - 1).g, picture.at(column, row).g, picture.at(column, row + 1).g});
        EXPECT_LT(darkest, 0.85 * plain) << "y " << y;
        EXPECT_GT(picture.at(column, row + 5).g, 0.95 * plain) << "between the lines";
    }
    for (const double x : {-2.0, -1.5}) {
        const int column = static_cast<int>(std::lround(columnOf(x) - 0.5)), row = static_cast<int>(rowOf(1.75));
        const double darkest =
            std::min({picture.at(column - 1, row).g, picture.at(column, row).g, picture.at(column + 1, row).g});
        EXPECT_LT(darkest, 0.85 * plain) << "x " << x;
    }
}

// With the whole projector picture for a canvas, sculpture and pole stand in the light. What the
// template marks there is what the wall does not get, asked from the wall's side.
TEST_F(TemplateTest, marks_what_is_hidden_from_the_projector) {
    open("");
    const GuideTemplate picture = drawn();
    const CanvasView view = left();
    std::vector<site::SceneObject> others;
    for (const site::SceneObject& object : view.objects)
        if (object.name != "wall" && object.name != "marker") others.push_back(object);
    const site::Scene inTheWay(others);
    int hidden = 0, wrong = 0, hatched = 0;
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const vision::Ray ray =
                view.projector.rayThrough(view.warp.projectorFromCanvas(glm::dvec2(x + 0.5, y + 0.5) / glm::dvec2(kSize)));
            const bool blocked = inTheWay.blocked(view.surface->hitBy(ray).value(), view.projector.pose.position);
            hidden += blocked;
            wrong += blocked != (picture.meets.at(x, y) == Meets::Object);
            const Rgba8 colour = picture.picture.at(x, y);
            hatched += blocked && colour.r - colour.b > 70;
        }
    EXPECT_GT(hidden, 0.05 * kSize.x * kSize.y);
    EXPECT_LE(wrong, 0.002 * kSize.x * kSize.y) << "the edges, and the last centimetres of the ground in front of the wall";
    EXPECT_GT(hatched, hidden / 12) << "it can be seen";
    EXPECT_LT(hatched, hidden / 2) << "and what it lies on too";
}

TEST_F(TemplateTest, marks_what_the_projector_cannot_reach) {
    // The canvas's left quarter lies left of the projector's picture.
    open("    corners: [[-160, 0], [480, 0], [480, 360], [-160, 360]]\n");
    const GuideTemplate picture = drawn();
    for (const int x : {1, 40, 78}) EXPECT_EQ(picture.meets.at(x, 90), Meets::NoLight) << x;
    for (const int x : {82, 200}) EXPECT_NE(picture.meets.at(x, 90), Meets::NoLight) << x;
}

TEST_F(TemplateTest, is_the_same_on_any_number_of_threads) {
    open("");
    EXPECT_EQ(drawn(1).picture, drawn(3).picture);
}

TEST_F(TemplateTest, as_a_command_writes_the_picture_or_says_what_to_do) {
    open();
    const auto run = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"template", "site", "-o", "t.png"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, folder_.path());
    };
    const Outcome done = run({"--output", "left", "--size", "320x180", "--grid", "0.5"});
    EXPECT_THAT(done, exits(0));
    EXPECT_EQ(readRgba(folder_ / "t.png").value(), drawn().picture);
    EXPECT_THAT(done.out, HasSubstr("5.12 x 2.88 m"));
    fs::remove(folder_ / "t.png");

    EXPECT_THAT(run({"--output", "lefft"}), exits(1));
    EXPECT_THAT(run({"--output", "lefft"}).errors, HasSubstr("did you mean 'left'?"));
    std::string text = contentsOf(folder_ / "site/site.yaml");
    text.resize(text.find("simulation:"));
    folder_.file("site/site.yaml", text);
    const Outcome bare = run({"--output", "left"});
    EXPECT_THAT(bare, exits(1));
    EXPECT_THAT(bare.errors, testing::AllOf(HasSubstr("'simulation'"), HasSubstr("photograph")));
    EXPECT_FALSE(fs::exists(folder_ / "t.png"));
}

}  // namespace
}  // namespace fantascope::app
