// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "theatre/body/body_mesh.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/mesh_shadow.h"

#include "core/file.h"
#include "media/image.h"
#include "media/mesh.h"
#include "pictures.h"
#include "program.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::StartsWith;
using Arguments = std::vector<std::string>;

// A folder with a silhouette, a hill that stands left of the picture's middle and above its lower
// edge, and what the program leaves in out/.
class PoseCommand : public testing::Test {
protected:
    PoseCommand() {
        EXPECT_TRUE(writePng(folder_ / "hill.png", pictureOf(240, 140, [](int x, int y) {
                                 return y < 120 && std::hypot((x + 0.5 - 90) / 80, (y + 0.5 - 120) / 100) < 1;
                             })));
        fs::create_directory(folder_ / "out");
    }

    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    // `pose hill.png -o out/c.cast.yaml` with short trials, and more.
    Outcome find(const Arguments& more) const {
        Arguments arguments = {"pose", "hill.png", "-o", "out/c.cast.yaml"};
        if (std::find(more.begin(), more.end(), "--evaluations") == more.end())
            arguments.insert(arguments.end(), {"--evaluations", "1000"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    nlohmann::json json(const std::string& file) const { return nlohmann::json::parse(text(file)); }
    std::vector<std::string> written(const std::string& folder = "out") const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / folder)) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }

    const ScratchFolder folder_;
};

TEST_F(PoseCommand, writes_a_cast_with_its_target_beside_it) {
    const Outcome done = find({"--trials", "2", "--actors", "2", "--height", "1.5", "--stature", "1.6,1.8", "--seed", "7"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.out, AllOf(StartsWith("out/c.cast.yaml: IoU 0."), HasSubstr("2 actors, 1.5 m high, the best of 2 trials")));
    EXPECT_THAT(written(), ElementsAre("c.cast.yaml", "c.target.png"));
    fs::rename(folder_ / "out", folder_ / "moved");  // as a folder it can go anywhere
    const auto cast = theatre::readCast(folder_ / "moved/c.cast.yaml");
    ASSERT_TRUE(cast) << cast.error().message();
    EXPECT_EQ(readFile(cast->targets[0].file).value(), text("hill.png"));
    EXPECT_EQ(cast->targets[0].height, 1.5);
    EXPECT_EQ(cast->seed, 7u);
    EXPECT_EQ(cast->framesPerSecond, 0);
    ASSERT_EQ(cast->actors.size(), 2u);
    EXPECT_EQ(cast->actors[0].stature, 1.6);
    EXPECT_EQ(cast->actors[1].stature, 1.8);
}

// Example failures: a refused run leaves the turned picture behind; two targets of one name in
// different folders become one picture.
TEST_F(PoseCommand, ink_on_paper_is_noticed_and_turned_over_beside_the_cast) {
    const GreyImage hill = readGrey(folder_ / "hill.png").value();
    fs::create_directory(folder_ / "other");
    ASSERT_TRUE(writePng(folder_ / "ink.png", inverted(hill)));
    ASSERT_TRUE(
        writePng(folder_ / "other/ink.png", inverted(pictureOf(80, 90, [](int x, int y) { return x > 9 && x < 70 && y > 9; }))));
    const auto pose = [&](const Arguments& more) {
        Arguments arguments = {"pose", "ink.png", "-o", "out/c.cast.yaml", "--trials", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    };
    EXPECT_THAT(pose({"--evaluations", "1000"}).errors, AllOf(HasSubstr("ink.png: looks like black ink"), HasSubstr("--invert")));
    fs::remove_all(folder_ / "out");
    fs::create_directory(folder_ / "out");
    EXPECT_THAT(pose({"--invert", "--evaluations", "1"}), exits(1));
    EXPECT_THAT(written(), IsEmpty());
    fs::copy(folder_ / "ink.png", folder_ / "c.inverted.png");
    EXPECT_THAT(run({"pose", "c.inverted.png", "-o", "c.cast.yaml", "--invert"}).errors, HasSubstr("would be overwritten"));
    const Outcome done = pose({"--invert", "--evaluations", "1000"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.errors, Not(HasSubstr("ink on white paper")));
    EXPECT_THAT(written(), ElementsAre("c.cast.yaml", "c.inverted.png"));
    EXPECT_EQ(readGrey(folder_ / "out/c.inverted.png").value(), hill);
    EXPECT_EQ(theatre::readCast(folder_ / "out/c.cast.yaml").value().targets[0].file, folder_ / "out/c.inverted.png");
    ASSERT_TRUE(
        writeFile(folder_ / "two.stage.yaml",
                  "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\nfurther_beams:\n  - {light: [-4, 0, 1.5], screen: {at: "
                  "[2.5, 0, 1.5], turned: -90}}\n"));
    ASSERT_THAT(pose({"--invert", "--evaluations", "1000", "--stage", "two.stage.yaml", "--further-target", "other/ink.png"}),
                exits(0));
    EXPECT_EQ(readGrey(folder_ / "out/c.inverted.png").value(), hill);
    EXPECT_EQ(readGrey(folder_ / "out/c.inverted-2.png").value().width(), 80);
}

TEST_F(PoseCommand, refers_to_a_target_beside_or_below_it) {
    ASSERT_THAT(run({"pose", "hill.png", "-o", "c.cast.yaml", "--trials", "1", "--evaluations", "1000"}), exits(0));
    EXPECT_THAT(text("c.cast.yaml"), HasSubstr("target: hill.png"));
    EXPECT_FALSE(fs::exists(folder_ / "c.target.png"));
}

TEST_F(PoseCommand, gives_the_same_file_for_a_seed_on_any_number_of_threads) {
    std::vector<std::string> found;
    for (const Arguments& more : {Arguments{"--threads", "1"}, {"--threads", "3"}, {"--threads", "1", "--seed", "2"}}) {
        Arguments arguments = {"--trials", "3", "--actors", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        ASSERT_THAT(find(arguments), exits(0));
        found.push_back(text("out/c.cast.yaml"));
    }
    EXPECT_EQ(found[0], found[1]);
    EXPECT_NE(found[0], found[2]);
}

TEST_F(PoseCommand, reports_what_it_found_and_each_trial) {
    ASSERT_THAT(find({"--trials", "3", "--actors", "2", "--report", "out/r.json"}), exits(0));
    const nlohmann::json report = json("out/r.json");
    for (const char* key : {"iou", "contour_mean_px", "contour_max_px", "seconds", "seconds_per_trial", "height"})
        EXPECT_GT(report[key].get<double>(), 0) << key;
    double sum = 0;
    for (const char* term : {"contour", "coverage", "coherence", "visible", "physics", "hint"})
        sum += report["energy"][term].get<double>();
    EXPECT_NEAR(report["energy"]["total"].get<double>(), sum, 1e-9 * sum);
    EXPECT_EQ(report["stop_reason"], "trials");
    EXPECT_EQ(report["seed"], 1);
    EXPECT_EQ(report["finished_trials"], 3);

    ASSERT_EQ(report["trials"].size(), 3u);
    std::int64_t evaluations = 0;
    int satisfactory = 0;
    double best = 0;
    bool anyValid = false;
    for (const nlohmann::json& trial : report["trials"]) anyValid |= trial["valid"].get<bool>();
    for (const nlohmann::json& trial : report["trials"]) {
        EXPECT_TRUE(trial["finished"].get<bool>());
        EXPECT_TRUE(trial["seed"].is_number_unsigned());
        EXPECT_GE(trial["evaluations"].get<int>(), 1000);
        evaluations += trial["evaluations"].get<int>();
        const bool valid = trial["valid"].get<bool>();
        const double iou = trial["iou"].get<double>();
        if (valid || !anyValid) best = std::max(best, iou);
        satisfactory += valid && iou >= 0.95;
    }
    EXPECT_EQ(report["evaluations"], evaluations);
    EXPECT_EQ(report["iou"], best);
    EXPECT_EQ(report["trials"][report["best_trial"].get<std::size_t>() - 1]["iou"], best);
    EXPECT_DOUBLE_EQ(report["satisfactory_share"].get<double>(), satisfactory / 3.0);
    if (satisfactory == 0) {
        EXPECT_TRUE(report["expected_trials"].is_null());
    } else {
        EXPECT_DOUBLE_EQ(report["expected_trials"].get<double>(), 3.0 / satisfactory);
    }

    ASSERT_EQ(report["actors"].size(), 2u);
    for (const nlohmann::json& actor : report["actors"]) {
        for (const char* key : {"margin", "lowest_point", "deepest_penetration", "stature"})
            EXPECT_TRUE(actor[key].is_number()) << key;
        for (const nlohmann::json& point : actor["contacts"]) EXPECT_EQ(point.size(), 2u);
        EXPECT_TRUE(actor["within_limits"].is_boolean());
    }
}

// The shadow of a closed surface in a picture on the screen, by every triangle and every pixel: no
// code of the program's.
struct OtherShadow {
    explicit OtherShadow(const nlohmann::json& stage) {
        const auto vector = [](const nlohmann::json& v) { return glm::dvec3(v[0], v[1], v[2]); };
        light = vector(stage["light"]);
        origin = vector(stage["screen"]["origin"]), u = vector(stage["screen"]["u"]), v = vector(stage["screen"]["v"]);
        width = stage["target_px"][0], height = stage["target_px"][1];
        dark.assign(static_cast<std::size_t>(width * height), 0);
    }
    glm::dvec2 pixelOf(const glm::dvec3& point) const {
        const glm::dvec3 normal = glm::cross(u, v), ray = point - light;
        const glm::dvec3 hit = light + ray * (glm::dot(origin - light, normal) / glm::dot(ray, normal)) - origin;
        return {width * glm::dot(hit, u) / glm::dot(u, u), height * glm::dot(hit, v) / glm::dot(v, v)};
    }
    void add(const TriangleMesh& mesh) {
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::dvec2 a = pixelOf(mesh.vertices[t.x]), b = pixelOf(mesh.vertices[t.y]), c = pixelOf(mesh.vertices[t.z]);
            const auto side = [](glm::dvec2 from, glm::dvec2 to, glm::dvec2 at) {
                return (to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x);
            };
            const int left = std::max(0, static_cast<int>(std::min({a.x, b.x, c.x}) - 1));
            const int right = std::min(width, static_cast<int>(std::max({a.x, b.x, c.x}) + 1));
            const int top = std::max(0, static_cast<int>(std::min({a.y, b.y, c.y}) - 1));
            const int bottom = std::min(height, static_cast<int>(std::max({a.y, b.y, c.y}) + 1));
            for (int y = top; y < bottom; ++y)
                for (int x = left; x < right; ++x) {
                    const glm::dvec2 at(x + 0.5, y + 0.5);
                    const double ab = side(a, b, at), bc = side(b, c, at), ca = side(c, a, at);
                    if ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0))
                        dark[static_cast<std::size_t>(y * width + x)] = 1;
                }
        }
    }

    glm::dvec3 light, origin, u, v;
    int width, height;
    std::vector<char> dark;
};

// Anybody can cast the shadow again from the meshes. Example failures: the screen hangs where the
// masks do, with their margin, and not where the given picture does; row 0 is at the floor.
TEST_F(PoseCommand, leaves_meshes_that_throw_the_shadow_that_it_reports) {
    ASSERT_EQ(
        find({"--trials", "2", "--actors", "2", "--evaluations", "4000", "--meshes", "out/m", "--report", "out/r.json"}).status,
        0);
    EXPECT_THAT(written("out/m"), ElementsAre("actor-1.obj", "actor-2.obj", "stage.json"));
    OtherShadow shadow(json("out/m/stage.json"));
    EXPECT_EQ(shadow.width, 240);
    EXPECT_EQ(shadow.height, 140);
    for (const char* file : {"out/m/actor-1.obj", "out/m/actor-2.obj"}) {
        const auto mesh = readMesh(folder_ / file);
        ASSERT_TRUE(mesh) << mesh.error().message();
        EXPECT_GT(mesh->triangles.size(), 2000u);
        shadow.add(*mesh);
    }

    // Against the target as it was drawn.
    const GreyImage target = readGrey(folder_ / "hill.png").value();
    double both = 0, either = 0, darkPixels = 0;
    for (std::size_t i = 0; i < shadow.dark.size(); ++i) {
        const bool white = target.pixels()[i] > 0.5f, dark = shadow.dark[i] != 0;
        both += white && dark, either += white || dark, darkPixels += dark;
    }
    EXPECT_NEAR(both / either, json("out/r.json")["iou"].get<double>(), 0.05);

    // Against the skins of the cast.
    const theatre::Cast cast = theatre::readCast(folder_ / "out/c.cast.yaml").value();
    const theatre::PoseTarget laid = theatre::PoseTarget::from(target, cast.stage, cast.targets[0].height, 256).value();
    theatre::BitMask mask(240, 140);
    theatre::MeshShadow skinShadow;
    for (const theatre::Cast::Actor& actor : cast.actors) {
        const theatre::Body body = theatre::humanBody(actor.stature);
        const theatre::BodyMesh mesh = theatre::humanMesh(body);
        theatre::PosedBody posed;
        posed.pose(body, theatre::dofsOf(body, actor.poses[0]));
        std::vector<glm::vec3> vertices;
        mesh.skin(body, posed, vertices);
        ASSERT_TRUE(skinShadow.add(laid.given, mesh, vertices, mask));
    }
    int different = 0;
    for (int y = 0; y < 140; ++y)
        for (int x = 0; x < 240; ++x) different += mask.at(x, y) != (shadow.dark[static_cast<std::size_t>(y * 240 + x)] != 0);
    EXPECT_LE(different, 0.002 * darkPixels);
}

TEST_F(PoseCommand, draws_pictures_and_solutions_to_choose_from) {
    ASSERT_EQ(find({"--trials", "3", "--actors", "1", "--image", "out/image.png", "--view", "out/view.svg", "--each",
                    "out/each.png", "--solutions", "out/choice"})
                  .status,
              0);
    EXPECT_THAT(written(), ElementsAre("c.cast.yaml", "c.target.png", "choice", "each.png", "image.png", "view.svg"));
    EXPECT_GT(readRgba(folder_ / "out/image.png").value().width(), 500);
    EXPECT_GT(readRgba(folder_ / "out/each.png").value().height(), 300);
    EXPECT_THAT(text("out/view.svg"), HasSubstr("<svg"));
    const auto names = written("out/choice");
    EXPECT_THAT(names, testing::IsSupersetOf({"solution-1.cast.yaml", "solutions.png", "solutions.target.png"}));
    EXPECT_LE(names.size(), 5u);
    for (const std::string& name : names) {
        if (name.ends_with(".yaml")) {
            EXPECT_TRUE(theatre::readCast(folder_ / "out/choice" / name)) << name;
        }
    }
    // The first is the best.
    const auto best = theatre::readCast(folder_ / "out/c.cast.yaml").value(),
               first = theatre::readCast(folder_ / "out/choice/solution-1.cast.yaml").value();
    EXPECT_EQ(first.actors[0].poses[0].root, best.actors[0].poses[0].root);
    EXPECT_EQ(first.actors[0].poses[0].turns, best.actors[0].poses[0].turns);
}

TEST_F(PoseCommand, chooses_actors_for_a_height_and_a_height_for_actors) {
    const auto found = [&](const Arguments& more) {
        Arguments arguments = {"--trials", "1", "--report", "out/r.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(find(arguments), exits(0));
        const nlohmann::json report = json("out/r.json");
        std::size_t fewest = 100;
        for (const nlohmann::json& round : report["rounds"]) fewest = std::min(fewest, round["actors"].get<std::size_t>());
        return std::pair(fewest, report["height"].get<double>());
    };
    // The hill has 1.26 squares of its height: 3.6 square metres at 1.7 m.
    EXPECT_EQ(found({}), std::pair(std::size_t{6}, 1.7));
    EXPECT_EQ(found({"--actors", "auto", "--height", "1"}).first, 2u);
    EXPECT_NEAR(found({"--actors", "2"}).second, 0.98, 0.021);
}

// Won & Lee 2016, section 4: the last resort is one more actor. Nobody has so many arms as a comb
// has teeth.
TEST_F(PoseCommand, adds_actors_where_so_many_are_not_enough) {
    EXPECT_TRUE(writePng(folder_ / "hill.png", pictureOf(240, 140, [](int x, int y) {
                             return isIn(x, y, 20, 20, 200, 100) && (y > 100 || x % 20 < 10);
                         })));
    const Arguments wanted = {"--trials", "2", "--height", "1", "--report", "out/r.json"};
    const Outcome done = find(wanted);
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.errors, AllOf(HasSubstr("2 actors are not enough"), HasSubstr("3 actors are not enough")));
    const nlohmann::json rounds = json("out/r.json")["rounds"];
    ASSERT_EQ(rounds.size(), 3u);
    std::vector<int> actors;
    double best = 0;
    const bool anyValid =
        std::any_of(rounds.begin(), rounds.end(), [](const auto& round) { return round["valid"].template get<bool>(); });
    for (const nlohmann::json& round : rounds) {
        actors.push_back(round["actors"].get<int>());
        EXPECT_EQ(round["trials"], 2);
        if (round["valid"].get<bool>() == anyValid) best = std::max(best, round["iou"].get<double>());
    }
    EXPECT_EQ(json("out/r.json")["iou"].get<double>(), best);
    EXPECT_EQ(theatre::readCast(folder_ / "out/c.cast.yaml")->actors.size(), static_cast<std::size_t>(actors.back()));
    std::sort(actors.begin(), actors.end());
    EXPECT_THAT(actors, ElementsAre(2, 3, 4));

    Arguments told = wanted;
    told.insert(told.end(), {"--actors", "2"});
    EXPECT_THAT(find(told).errors, testing::Not(HasSubstr("not enough")));
    EXPECT_EQ(json("out/r.json")["rounds"].size(), 1u);
}

TEST_F(PoseCommand, the_papers_method_is_another) {
    const auto cast = [&](const Arguments& more) {
        Arguments arguments = {"--trials", "1", "--actors", "2", "--report", "out/r.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_THAT(find(arguments), exits(0));
        return text("out/c.cast.yaml");
    };
    const std::string refined = cast({});
    EXPECT_EQ(json("out/r.json")["method"], "refined");
    const std::string paper = cast({"--method", "paper"});
    EXPECT_EQ(json("out/r.json")["method"], "paper");
    EXPECT_NE(paper, refined);
    EXPECT_EQ(cast({"--method", "paper"}), paper);
    EXPECT_NE(cast({"--method", "paper", "--full-covariance"}), paper);
}

// The easy wrong version leaves a cast whose people lean on nothing, or one that opens on this
// machine alone.
TEST_F(PoseCommand, a_stage_goes_with_the_cast_and_its_meshes) {
    ASSERT_TRUE(
        writeFile(folder_ / "halls/box.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"));
    ASSERT_TRUE(writeFile(folder_ / "halls/hall.stage.yaml",
                          "fantascope: stage\nversion: 1\nlight: [0, 0.1, 7]\n"
                          "platforms:\n  - {name: step, centre: [1.5, 0.1, 2], size: [0.5, 0.2, 0.5]}\n"
                          "props:\n  - {name: box, mesh: box.obj, at: [-0.5, 0, 2]}\n"));
    const Outcome done = find({"--trials", "1", "--actors", "1", "--stage", "halls/hall.stage.yaml", "--meshes", "out/m",
                               "--image", "out/i.png", "--view", "out/v.png", "--report", "out/r.json"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.out, HasSubstr("; the people's shadow alone 0."));
    EXPECT_GT(json("out/r.json")["props_cover"].get<double>(), 0.01);
    EXPECT_NE(json("out/r.json")["iou_without_props"], json("out/r.json")["iou"]);
    EXPECT_THAT(written("out/m"), ElementsAre("actor-1.obj", "prop-box.obj", "prop-step.obj", "stage.json"));
    const auto box = readMesh(folder_ / "out/m/prop-box.obj"), step = readMesh(folder_ / "out/m/prop-step.obj");
    ASSERT_TRUE(box && step);
    float left = 9, top = 0;
    for (const glm::vec3& vertex : box->vertices) left = std::min(left, vertex.x);
    for (const glm::vec3& vertex : step->vertices) top = std::max(top, vertex.y);
    EXPECT_FLOAT_EQ(left, -0.5f);
    EXPECT_FLOAT_EQ(top, 0.2f);

    fs::remove_all(folder_ / "halls");
    fs::rename(folder_ / "out", folder_ / "moved");
    const auto cast = theatre::readCast(folder_ / "moved/c.cast.yaml");
    ASSERT_TRUE(cast) << cast.error().message();
    ASSERT_EQ(cast->stage.props.size(), 1u);
    EXPECT_EQ(cast->stage.platforms.size(), 1u);
    const Outcome drawn = run({"plot", "moved/c.cast.yaml", "-o", "moved/all.png"});
    EXPECT_THAT(drawn, exits(0));
}

// Two lights with a screen each, the first hollow: the same people throw a shadow on both.
TEST_F(PoseCommand, one_set_of_poses_serves_several_screens) {
    ASSERT_TRUE(writeFile(folder_ / "corner.stage.yaml",
                          "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\nscreen: {radius: 12}\n"
                          "further_beams:\n  - {light: [-4, 0, 1.5], screen: {at: [2.5, 0, 1.5], turned: -90}}\n"));
    ASSERT_TRUE(writePng(folder_ / "wall.png", pictureOf(80, 90, [](int x, int y) { return x > 9 && x < 70 && y > 9; })));
    const Arguments corner = {"--stage", "corner.stage.yaml", "--further-target", "wall.png", "--actors", "2", "--trials", "2"};
    std::vector<std::string> found;
    for (const char* threads : {"1", "3"}) {
        Arguments arguments = corner;
        for (const char* more : {"--threads", threads, "--report", "out/r.json", "--image", "out/i.png", "--each", "out/e.png",
                                 "--view", "out/v.png", "--solutions", "out/choice", "--meshes", "out/meshes"})
            arguments.emplace_back(more);
        const Outcome done = find(arguments);
        ASSERT_THAT(done, exits(0));
        EXPECT_THAT(done.out, HasSubstr(" on its screens)"));
        found.push_back(text("out/c.cast.yaml"));
    }
    EXPECT_EQ(found[0], found[1]);
    EXPECT_THAT(written(), IsSupersetOf({"c.cast.yaml", "c.target.png", "c.target-2.png"}));

    const nlohmann::json beams = json("out/r.json")["beams"];
    ASSERT_EQ(beams.size(), 2u);
    EXPECT_EQ(json("out/r.json")["iou"], std::min(beams[0]["iou"].get<double>(), beams[1]["iou"].get<double>()));
    EXPECT_NE(beams[0]["iou"], beams[0]["flat_iou"]) << "curved";
    EXPECT_EQ(beams[1]["iou"], beams[1]["flat_iou"]) << "flat";
    EXPECT_EQ(beams[1]["target"], "wall.png");
    const nlohmann::json stage = json("out/meshes/stage.json");
    EXPECT_EQ(stage["screen"]["radius"], 12);
    // Upright, and as high as the picture on its screen.
    const auto& down = stage["further_beams"][0]["screen"]["v"];
    EXPECT_NEAR(down[1].get<double>(), -beams[1]["height"].get<double>() * 90 / 80, 1e-9);
    EXPECT_NEAR(down[0].get<double>(), 0, 1e-9);

    fs::rename(folder_ / "out", folder_ / "moved");
    const auto cast = theatre::readCast(folder_ / "moved/c.cast.yaml");
    ASSERT_TRUE(cast) << cast.error().message();
    ASSERT_EQ(cast->targets.size(), 2u);
    EXPECT_EQ(readFile(cast->targets[1].file).value(), text("wall.png"));
    for (const char* figure : {"cast", "stage", "shadow", "side"})
        EXPECT_THAT(run({"plot", "moved/c.cast.yaml", "--figure", figure, "-o", "moved/f.png"}), exits(0)) << figure;
    // What follows a silhouette that moves knows one flat screen.
    const Outcome adapted = run({"adapt", "moved/c.cast.yaml", ".", "-o", "moved/m.cast.yaml"});
    EXPECT_THAT(adapted, exits(1));
    EXPECT_THAT(adapted.errors, HasSubstr("its stage has further_beams"));
}

TEST_F(PoseCommand, says_how_many_further_targets_a_stage_wants) {
    const std::string lamp = "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\n";
    ASSERT_TRUE(writeFile(folder_ / "one.stage.yaml", lamp));
    ASSERT_TRUE(writeFile(folder_ / "two.stage.yaml", lamp + "further_beams: [{light: [3, 0, 6]}]\n"));
    const auto refusal = [&](const Arguments& more) {
        const Outcome outcome = find(more);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(written(), IsEmpty());
        return outcome.errors;
    };
    EXPECT_THAT(refusal({"--further-target", "hill.png"}), HasSubstr("the stage without a --stage has one light"));
    EXPECT_THAT(refusal({"--stage", "one.stage.yaml", "--further-target", "hill.png"}),
                AllOf(HasSubstr("one.stage.yaml has one light"), HasSubstr("further_beams")));
    EXPECT_THAT(refusal({"--stage", "two.stage.yaml"}),
                AllOf(HasSubstr("has 1 further beam and so 1 further target, 0 are given"), HasSubstr("name one for each")));
    EXPECT_THAT(refusal({"--stage", "two.stage.yaml", "--further-target", "hill.png,hill.png"}), HasSubstr("2 are given"));
    EXPECT_THAT(refusal({"--stage", "two.stage.yaml", "--further-target", "hill.png", "--further-height", "1,2"}),
                HasSubstr("--further-height: 2 for 1 further target"));
    EXPECT_THAT(refusal({"--stage", "two.stage.yaml", "--further-target", "none.png"}), HasSubstr("none.png"));
    EXPECT_THAT(refusal({"--stage", "two.stage.yaml", "--further-target", "hill.png", "--image", "hill.png"}),
                HasSubstr("would be overwritten"));
}

// The world refuses: one message, status 1, and nothing is written.
TEST_F(PoseCommand, bad_input_is_refused_with_one_message_and_leaves_nothing) {
    const auto refusal = [&](const std::string& target, const Arguments& more = {}) {
        Arguments arguments = {"pose", target, "--trials", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        if (std::find(more.begin(), more.end(), "-o") == more.end()) arguments.insert(arguments.end(), {"-o", "out/c.cast.yaml"});
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_THAT(outcome.errors, StartsWith("fantascope: error: "));
        EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
        EXPECT_THAT(written(), IsEmpty());
        return outcome.errors;
    };
    const auto refusalOf = [&](const GreyImage& picture) {
        EXPECT_TRUE(writePng(folder_ / "t.png", picture));
        return refusal("t.png");
    };
    EXPECT_THAT(refusal("nowhere.png"), HasSubstr("nowhere.png: cannot be read"));
    EXPECT_THAT(refusal("."), HasSubstr("is a folder"));
    folder_.file("words.png", "This is no picture.");
    EXPECT_THAT(refusal("words.png"), HasSubstr("words.png: not a PNG or JPEG picture"));
    const std::string png = text("hill.png");
    folder_.file("half.png", png.substr(0, png.size() / 2));
    EXPECT_THAT(refusal("half.png"), HasSubstr("half.png: the picture is truncated"));
    EXPECT_THAT(refusalOf(GreyImage(50, 50)), HasSubstr("t.png: nothing is drawn, it is black all over"));
    EXPECT_THAT(refusalOf(GreyImage(50, 50, 1.0f)), HasSubstr("t.png: nothing is drawn, it is white all over"));
    EXPECT_THAT(refusalOf(pictureOf(50, 50, [](int x, int y) { return isIn(x, y, 20, 30, 3, 1); })), HasSubstr("3 pixels"));
    EXPECT_THAT(
        refusalOf(pictureOf(400, 100, [](int x, int y) { return isIn(x, y, 10, 10, 50, 80) || isIn(x, y, 300, 10, 50, 80); })),
        HasSubstr("2 parts"));
    RgbaImage red(50, 50, {0, 0, 0});
    for (int y = 10; y < 40; ++y)
        for (int x = 10; x < 40; ++x) red.at(x, y) = {255, 60, 40};
    ASSERT_TRUE(writePng(folder_ / "red.png", red));
    EXPECT_THAT(refusal("red.png"), HasSubstr("red.png: is a picture in colours; draw it white on black"));
    // Ten thousand pixels a side, and not one of them decoded: there are none.
    folder_.file("huge.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x27\x10\0\0\x27\x10\x08\0\0\0\0", 29));
    EXPECT_THAT(refusal("huge.png"), HasSubstr("huge.png: it is 10000 x 10000 pixels; no side may have more than 2048"));

    EXPECT_THAT(refusal("hill.png", {"--actors", "0"}), HasSubstr("--actors 0: 1 .. 49 can play"));
    EXPECT_THAT(refusal("hill.png", {"--actors", "50"}), HasSubstr("--actors 50: 1 .. 49 can play"));
    EXPECT_THAT(refusal("hill.png", {"--height", "20"}), HasSubstr("--height 20: "));
    EXPECT_THAT(refusal("hill.png", {"--height", "5", "--actors", "2"}), HasSubstr("too large for 2 actors: take --height"));
    EXPECT_THAT(refusal("hill.png", {"--height", "0.5", "--actors", "30"}), HasSubstr("too small for 30 actors: take --height"));
    EXPECT_THAT(refusal("hill.png", {"--actors", "3", "--stature", "1.5,1.6"}), HasSubstr("2 are given for 3 actors"));
    EXPECT_THAT(refusal("hill.png", {"--evaluations", "10"}), HasSubstr("evaluations: 10 are too few"));
    // Before the search, not after it.
    EXPECT_THAT(refusal("hill.png", {"-o", "hill.png/c.yaml"}), HasSubstr("hill.png is not a folder"));
    for (const char* option : {"--image", "--view", "--each"})
        EXPECT_THAT(refusal("hill.png", {option, "hill.png/x.png"}), HasSubstr("hill.png is not a folder")) << option;
    for (const char* option : {"--report", "--meshes", "--solutions"})
        EXPECT_THAT(refusal("hill.png", {option, "hill.png/x"}), HasSubstr("hill.png is not a folder")) << option;
    EXPECT_THAT(refusal("hill.png", {"--image", "hill.png"}), HasSubstr("is the target, and would be overwritten"));
}

// What is nearly grey is no colour.
TEST_F(PoseCommand, takes_grey_pictures) {
    RgbaImage soft(60, 60, {40, 40, 40});
    for (int y = 10; y < 60; ++y)
        for (int x = 10; x < 50; ++x) soft.at(x, y) = {200, 210, 190};
    ASSERT_TRUE(writePng(folder_ / "soft.png", soft));
    EXPECT_THAT(run({"pose", "soft.png", "-o", "out/c.cast.yaml", "--trials", "1", "--evaluations", "1000", "--actors", "1"}),
                exits(0));
}

TEST_F(PoseCommand, wrong_usage_has_a_status_of_its_own_and_points_to_the_help) {
    const std::vector<Arguments> wrong = {{"--actors", "many"}, {"--seconds", "-1"}, {"--trials", "0"}, {"--threads", "0"},
                                          {"--stature", "3"},   {"--seed", "-1"},    {"--nonsense"},    {"--image", "out/i.jpg"}};
    for (const Arguments& arguments : wrong) {
        const Outcome outcome = find(arguments);
        EXPECT_THAT(outcome, exits(2)) << arguments[0];
        EXPECT_THAT(outcome.errors, StartsWith("fantascope: error: "));
        EXPECT_THAT(outcome.errors, HasSubstr("See 'fantascope pose --help'."));
    }
    EXPECT_THAT(run({"pose"}), exits(2));
    EXPECT_THAT(run({"pose", "hill.png", "-o", "hill.png"}), exits(2));
    EXPECT_THAT(run({"pose", "--help"}), exits(0));
}

// The signal is sent once the first line of progress says that the search runs: its first trial
// would take years.
TEST_F(PoseCommand, ctrl_c_keeps_the_unfinished_one_if_there_is_no_other) {
    EXPECT_EQ(interruptProgram({"pose", "hill.png", "-o", "out/c.cast.yaml", "--evaluations", "1000000000000", "--actors", "1",
                                "--seconds", "100000", "--report", "out/r.json"},
                               folder_ / ".", 1),
              0);
    const nlohmann::json report = json("out/r.json");
    EXPECT_EQ(report["stop_reason"], "interrupted");
    EXPECT_EQ(report["finished_trials"], 0);
    EXPECT_FALSE(report["trials"][0]["finished"].get<bool>());
    EXPECT_TRUE(theatre::readCast(folder_ / "out/c.cast.yaml"));
}

}  // namespace
}  // namespace fantascope
