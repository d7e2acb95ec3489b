#include "app/lens/simulated_hand.h"

#include "app/base/temporary_folder.h"
#include "app/site/site_models.h"
#include "drivers/site/simulated_site.h"
#include "drivers/site/world.h"

#include "vision/lens_board.h"

#include "core/random.h"
#include "media/image.h"

#include <fmt/format.h>
#include <glm/mat3x3.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using vision::LensBoard;

constexpr int kPoses = 45, kFramesEach = 3;
constexpr double kSquare = 0.028;                 // metres
constexpr double kLux = 300, kReflectance = 0.8;  // a room by day, and white paper
constexpr double kHighlight = 1.4;                // full white, as a multiple of the paper's luminance
constexpr glm::ivec2 kMargins{2, 2};              // of paper around the board, squares, both sides together
constexpr const char* kPicture = "board.png";

RgbaImage paper() {
    constexpr int kCell = 6;  // pixels
    constexpr int kSide = kCell * LensBoard::kCells;
    const glm::ivec2 size = kSide * (LensBoard::kSquares + kMargins), low = kSide * kMargins / 2;
    RgbaImage picture(size.x, size.y, {255, 255, 255, 255});
    for (const LensBoard::Box& box : LensBoard::boxes()) {
        const std::uint8_t value = box.dark ? 50 : 255;
        for (int y = low.y + kCell * box.low.y; y < low.y + kCell * box.high.y; ++y)
            for (int x = low.x + kCell * box.low.x; x < low.x + kCell * box.high.x; ++x)
                picture.at(x, y) = {value, value, value, 255};
    }
    return picture;
}

// The camera's own keys of the `simulation` section, but for those that the board needs otherwise.
Result<std::string> cameraKeysOf(const ConfigNode& simulation) {
    std::string keys;
    for (const auto& [section, node] : TRY(simulation.entries())) {
        if (section != "camera") continue;
        for (const auto& [key, value] : TRY(node.entries()))
            if (key == "read_noise" || key == "shot_noise" || key == "blur" || key == "vignetting")
                keys += fmt::format(", {}: {}", key, TRY(value.number(0, 100)));
    }
    return keys;
}

class Hand final : public LensCamera {
public:
    Hand(TemporaryFolder folder, show::NominalCamera camera, std::string cameraKeys, std::uint64_t seed)
        : folder_(std::move(folder)), camera_(std::move(camera)), cameraKeys_(std::move(cameraKeys)), seed_(seed), rng_(seed) {}

    std::shared_ptr<const CameraFrame> next() override {
        if (hasEnded()) return nullptr;
        if (frames_ % kFramesEach == 0) {
            auto scene = show();
            ++poses_;
            if (!scene) {
                trouble_ = scene.error().message();
                return nullptr;
            }
            scene_ = std::move(*scene);
        }
        ++frames_;
        scene_->clock.advance(kPeriod);
        scene_->site->advanceTo(scene_->clock.now());
        return scene_->world.takeFromCamera();
    }
    bool hasEnded() const override { return poses_ > kPoses || !trouble_.empty(); }
    DeviceStatus status() const override {
        return {.name = "camera", .driver = "simulated", .state = DeviceState::Running, .detail = trouble_};
    }
    CameraDescription description() const override {
        return {.card = "simulated", .serial = {}, .format = {}, .lacks = {}, .exposure = {}};
    }

private:
    static constexpr Time kPeriod = 100ms;
    struct Scene {
        ManualClock clock;
        site::World world{clock};
        std::unique_ptr<site::SimulatedSite> site;
    };

    // The board at the next place: all over the picture, near and far, tilted to all sides.
    Result<std::unique_ptr<Scene>> show() {
        const auto model = TRY(vision::CameraModel::fromFieldOfView(Pose(), camera_.size, camera_.fieldOfView, camera_.k1,
                                                                    camera_.k2, camera_.centre));
        const double width = LensBoard::kSquares.x / rng_.uniform(0.45, 0.75) * kSquare;  // of the picture at the board, metres
        const glm::dvec2 at = glm::dvec2(poses_ % 3, poses_ / 3 % 3) / 2.0 - 0.5;
        const glm::dvec3 middle(0.7 * at.x * width, 0.7 * at.y * width * model.size.y / model.size.x,
                                width * model.focal / model.size.x);
        constexpr double kGoldenAngle = 2.399963;
        const double way = kGoldenAngle * poses_, tilt = radians(rng_.uniform(18, 36));
        const glm::dmat3 turn = rotationXyz({0, 0, radians(rng_.uniform(-20, 20))}) * rotationXyz({tilt * std::sin(way), 0, 0}) *
                                rotationXyz({0, tilt * std::cos(way), 0});
        const glm::dvec2 size = kSquare * glm::dvec2(LensBoard::kSquares + kMargins);
        // From camera axes to the world's: the camera looks along -z.
        const auto inWorld = [](glm::dvec3 v) { return fmt::format("[{}, {}, {}]", v.x, -v.y, -v.z); };
        const std::string text = fmt::format(
            "fantascope: site\nversion: 1\n"
            "outputs: [{{name: none, display: {{driver: headless}}, size: [16, 16], refresh_rate: 30}}]\n"
            "camera: {{device: {{driver: simulated}}, size: [{}, {}], field_of_view: 60, position: [0, 0, 0], look_at: [0, 0, "
            "-1]}}\n"
            "simulation:\n  ambient: [{lux}, {lux}, {lux}]\n  sky: [20, 20, 20]\n"
            "  camera: {{frame_rate: 30, latency: 0, white: {white}{keys}}}\n"
            "  objects: [{{name: board, reflectance: [{r}, {r}, {r}], rectangle: {{corner: {corner}, right: {right}, up: {up}, "
            "texture: {picture}}}}}]\n",
            camera_.size.x, camera_.size.y, fmt::arg("lux", kLux),
            fmt::arg("white", kHighlight * kLux * kReflectance / std::numbers::pi), fmt::arg("keys", cameraKeys_),
            fmt::arg("r", kReflectance), fmt::arg("corner", inWorld(middle + turn * glm::dvec3(-size.x / 2, size.y / 2, 0))),
            fmt::arg("right", inWorld(turn * glm::dvec3(size.x, 0, 0))),
            fmt::arg("up", inWorld(turn * glm::dvec3(0, -size.y, 0))), fmt::arg("picture", kPicture));
        show::Site room = TRY(show::parseSite(text, folder_ / "site.yaml"));
        room.outputs.clear();
        room.nominalCamera->fieldOfView = camera_.fieldOfView;
        room.nominalCamera->k1 = camera_.k1;
        room.nominalCamera->k2 = camera_.k2;
        room.nominalCamera->centre = camera_.centre;
        auto scene = std::make_unique<Scene>();
        scene->site = TRY(site::SimulatedSite::open(*room.simulation, TRY(simulationOf(room)),
                                                    streamSeed(seed_, {static_cast<std::uint64_t>(poses_)}), scene->world));
        scene->site->begin(scene->clock.now());
        return scene;
    }

    const TemporaryFolder folder_;
    const show::NominalCamera camera_;
    const std::string cameraKeys_;
    const std::uint64_t seed_;
    Rng rng_;
    int poses_ = 0, frames_ = 0;
    std::string trouble_;
    std::unique_ptr<Scene> scene_;
};

}  // namespace

Result<std::unique_ptr<LensCamera>> simulatedHand(const show::Site& site, std::uint64_t seed) {
    if (!site.simulation) return Error(site.file.string() + ": has no 'simulation' section to simulate the camera by");
    const std::string keys = TRY(cameraKeysOf(*site.simulation));
    TemporaryFolder folder = TRY(TemporaryFolder::make());
    TRY(writePng(folder / kPicture, paper()));
    return std::unique_ptr<LensCamera>(new Hand(std::move(folder), *site.nominalCamera, keys, seed));
}

}  // namespace fantascope::app
