#include "drawn_night.h"

#include "app/site/site_file.h"
#include "app/site/site_models.h"
#include "drivers/site/simulated_site.h"

#include "show/cue_list.h"
#include "show/patch.h"
#include "show/play/playback_replica.h"

#include "core/file.h"
#include "core/warp.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <utility>

namespace fantascope::app {
namespace {

template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message());
    return std::move(*result);
}

// Smooth noise of a wavelength of one, 0..1, that repeats after a number of cells.
class Noise {
public:
    Noise(int cells, std::uint64_t seed) : cells_(cells) {
        for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(cells * cells); ++i)
            values_.push_back(Rng(seed * 7919 + i).uniform());
    }
    double operator()(double x, double y) const {
        const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
        const double u = x - column, v = y - row;
        return std::lerp(std::lerp(value(column, row), value(column + 1, row), u),
                         std::lerp(value(column, row + 1), value(column + 1, row + 1), u), v);
    }

private:
    double value(int column, int row) const { return values_[static_cast<std::size_t>(row % cells_ * cells_ + column % cells_)]; }

    int cells_;
    std::vector<double> values_;
};

RgbaImage texture(std::uint64_t seed) {
    constexpr int kSize = 256;
    RgbaImage picture(kSize, kSize);
    const int kind = static_cast<int>(seed % 3);
    const Noise stone(128, seed), stains(16, seed + 1), blotches(43, seed), bricks(8, seed);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            double value = 0;
            if (kind == 0) value = 0.3 + 0.4 * stone(x / 2.0, y / 2.0) + 0.2 * stains(x / 16.0, y / 16.0);
            if (kind == 1) value = blotches(x / 6.0, y / 6.0) > 0.5 ? 0.75 : 0.45;
            if (kind == 2) {
                const int course = y / 32, along = (x + course % 2 * 32) % kSize;
                value = y % 32 < 3 || along % 64 < 3 ? 0.8 : 0.35 + 0.35 * bricks(along / 64, course);
            }
            const auto stored = static_cast<std::uint8_t>(255 * value);
            picture.at(x, y) = {stored, static_cast<std::uint8_t>(0.92 * stored), static_cast<std::uint8_t>(0.8 * stored), 255};
        }
    return picture;
}

// A projector's menu: a blue page with a few light lines.
RgbaImage menu(std::uint64_t seed) {
    Rng rng(seed);
    RgbaImage picture(640, 360,
                      seed % 3 == 0   ? Rgba8{10, 30, 160, 255}
                      : seed % 3 == 1 ? Rgba8{90, 90, 90, 255}
                                      : Rgba8{0, 0, 0, 255});
    for (int line = 0; line < 8; ++line) {
        const int top = 20 + 40 * line, width = static_cast<int>(100 + 400 * rng.uniform());
        for (int y = top; y < top + 14; ++y)
            for (int x = 60; x < 60 + width; ++x)
                if (x / 9 % 3 != 0) picture.at(x, y) = {230, 230, 230, 255};
    }
    return picture;
}

std::string listOf(glm::dvec3 v) { return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", v.x, v.y, v.z); }

// A show of leaves that sway, one set a cue, with a lamp that changes.
class Leaves {
public:
    Leaves(std::uint64_t seed, glm::ivec2 size) : seed_(seed), size_(size) {}

    static constexpr double kCue = 9, kFade = 1.5;  // seconds

    RgbaImage at(double time) {
        const int cue = static_cast<int>(time / kCue);
        const double share = std::clamp((time - cue * kCue) / kFade, 0.0, 1.0);
        light_.assign(static_cast<std::size_t>(size_.x * size_.y), 0);
        if (share < 1 && cue > 0) add(cue - 1, time, 1 - share);
        add(cue, time, cue == 0 ? 1 : share);
        RgbaImage picture(size_.x, size_.y);
        float last = 0;
        std::uint8_t stored = 0;  // of `last`: neighbours are mostly equal
        for (std::size_t i = 0; i < light_.size(); ++i) {
            if (light_[i] != std::exchange(last, light_[i]))
                stored = static_cast<std::uint8_t>(std::lround(255 * std::pow(last, 1 / 2.2f)));
            picture.pixels()[i] = {stored, stored, stored, 255};
        }
        return picture;
    }
    // `isDim`: it is dim in two cues of three, else dark.
    static double lampAt(double time, std::uint64_t seed, bool isDim) {
        const int cue = static_cast<int>(time / kCue);
        const auto level = [&](int of) {
            if (of < 0) return isDim ? 0.6 : 0.0;
            return (seed + static_cast<std::uint64_t>(of)) % 3 == 0 ? 1.0 : isDim ? 0.6 : 0.0;
        };
        return std::lerp(level(cue - 1), level(cue), std::clamp((time - cue * kCue) / kFade, 0.0, 1.0));
    }

private:
    void add(int cue, double time, double share) {
        Rng rng(seed_ * 101 + static_cast<std::uint64_t>(cue));
        const int count = 80 + static_cast<int>(160 * rng.uniform());
        const double sizes = 0.6 + 0.9 * rng.uniform();
        for (int i = 0; i < count; ++i) {
            const double x = rng.uniform() * size_.x + 4 * std::sin(time * 1.1 + i),
                         y = rng.uniform() * size_.y + 2 * std::sin(time * 0.8 + 2 * i),
                         turn = rng.uniform() * 3.14 + 0.15 * std::sin(time + i),
                         length = sizes * (0.012 + 0.02 * rng.uniform()) * size_.x, width = length * 0.4;
            const double c = std::cos(turn), s = std::sin(turn);
            for (int row = std::max(0, static_cast<int>(y - length)); row < std::min<double>(size_.y, y + length); ++row)
                for (int column = std::max(0, static_cast<int>(x - length)); column < std::min<double>(size_.x, x + length);
                     ++column) {
                    const double u = (column - x) * c + (row - y) * s, v = (row - y) * c - (column - x) * s;
                    if (u * u / (length * length) + v * v / (width * width) >= 1) continue;
                    float& light = light_[static_cast<std::size_t>(row * size_.x + column)];
                    light = std::max(light, static_cast<float>(share));
                }
        }
    }
    std::uint64_t seed_;
    glm::ivec2 size_;
    std::vector<float> light_;
};

// Draws everything.
class Draw {
public:
    Draw(const NightOptions& options, const std::filesystem::path& folder)
        : options_(options), folder_(folder), rng_(1000 + options.seed) {}

    double in(double low, double high) { return std::lerp(low, high, rng_.uniform()); }
    double logIn(double low, double high) { return std::exp(in(std::log(low), std::log(high))); }

    std::vector<std::string> names;
    std::string faulty, fault;
    glm::dvec3 turn{0.0};  // of the bump, radians
    double faultAt = 0;

    std::string site() {
        const int drawn = 1 + static_cast<int>(in(0.5, 2.99)), outputs = options_.outputs > 0 ? options_.outputs : drawn;
        const glm::ivec2 size = in(0, 1) < 0.5 ? glm::ivec2(640, 360) : glm::ivec2(800, 450);
        std::string text = "fantascope: site\nversion: 1\noutputs:\n";
        const double apart = outputs == 3 ? 4.2 : 5.6;
        for (int i = 0; i < outputs; ++i) {
            names.push_back(std::array{"left", "right", "middle"}[static_cast<std::size_t>(i)]);
            const double middle = outputs == 1   ? 0
                                  : outputs == 2 ? (i - 0.5) * apart
                                                 : std::array{-1, 1, 0}[static_cast<std::size_t>(i)] * apart;
            text += fmt::format(
                "  - name: {}\n    display: {{driver: headless}}\n    size: [{}, {}]\n    refresh_rate: {}\n    projector: "
                "{{position: {}, look_at: {}, "
                "throw_ratio: {:.3f}}}\n    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}\n",
                names.back(), size.x, size.y, options_.refreshRate, listOf({middle + in(-2, 2), in(1.5, 4), in(7, 9)}),
                listOf({middle, 2.5, 0}), in(1.5, 1.8));
        }
        const double fov = outputs == 3 ? 80 : in(58, 70);
        text += fmt::format(
            "universes:\n  - {{number: 1, port: {{driver: simulated}}}}\nfixtures:\n  - {{name: spot, universe: 1, address: 1, "
            "channels: [intensity]}}\n"
            "camera:\n  device: {{driver: simulated}}\n  size: [{}, {}]\n  field_of_view: {:.2f}\n  position: {}\n  look_at: "
            "{}\n  k1: {:.4f}\n  k2: 0\n",
            options_.camera.x, options_.camera.y, fov, listOf({in(-2, 2), in(1.5, 3), in(11, 13)}),
            listOf({in(-0.3, 0.3), in(2, 2.5), 0}), in(-0.1, 0));
        const bool isTrimmed = !options_.lamps.empty();
        text += fmt::format("corrections:\n  geometry: {{mode: {}}}\n", options_.geometry);
        if (isTrimmed)
            text += fmt::format(
                "  lamps: {{mode: {}, fixtures: [spot], relays: [street], speed: {}, hold: 20}}\nrelay_banks: [{{name: "
                "road, device: {{driver: simulated}}}}]\nrelays: [{{name: street, coil: 0, safe: on}}]\n",
                options_.lamps, options_.lampSpeed);
        const double ambient = ambient_ = logIn(0.2, 2);
        text += fmt::format("simulation:\n  ambient: {}\n  sky: [0.02, 0.03, 0.06]\n",
                            listOf({0.7 * ambient, 0.9 * ambient, 1.4 * ambient}));
        if (const auto written = writePng(folder_ / "wall.png", texture(options_.seed)); !written)
            throw std::runtime_error(written.error().message());
        if (const auto written = writePng(folder_ / "menu.png", menu(options_.seed)); !written)
            throw std::runtime_error(written.error().message());
        text +=
            "  objects:\n    - {name: wall, rectangle: {corner: [-12, 0, 0], right: [24, 0, 0], up: [0, 7, 0], texture: "
            "wall.png, texture_size: [2, 2]}, "
            "reflectance: [0.8, 0.8, 0.8]}\n    - {name: ground, rectangle: {corner: [-20, 0, -5], right: [40, 0, 0], up: [0, 0, "
            "25]}, reflectance: "
            "[0.17, 0.21, 0.12]}\n";
        // A spot on one of the pictures; or a flood and a street lamp for all of them.
        if (isTrimmed)
            text += fmt::format(
                "  lamps:\n    spot: {{position: [0, 5, 9], look_at: [0, 2, 0], beam_angle: 90, field_angle: 130, candela: "
                "{:.0f}}}\n  street_lamps:\n    street: {{position: [-4, 7, 9], look_at: [0, 2, 0], beam_angle: 90, "
                "field_angle: 130, candela: {:.0f}}}\n",
                logIn(600, 4000), logIn(600, 1500));
        else
            text +=
                "  lamps:\n    spot: {position: [-2, 5, 6], look_at: [1, 1.5, 0], beam_angle: 25, field_angle: 40, candela: "
                "900}\n";
        text += fmt::format(
            "  camera: {{white: {:.1f}, read_noise: {:.4f}, shot_noise: 0.012, latency: {:.3f}, frame_rate: {}, vignetting: "
            "{:.2f}, blur: {:.2f}, rolling: "
            "{:.3f}}}\n",
            in(30, 60), in(0.002, 0.006), options_.latency, options_.cameraRate, in(0, 0.4), in(0.4, 1.2), in(0, 0.03));
        text += "  walkers:\n";
        const int walkers = static_cast<int>(in(1, 3.99));
        for (int i = 0; i < walkers; ++i)
            text += fmt::format("    - {{name: w{}, path: [[-9, {:.2f}], [9, {:.2f}]], speed: {:.2f}, at: {:.1f}, loop: true}}\n",
                                i, in(1, 5), in(1, 5), in(0.7, 1.6), in(0, 10));
        if (options_.isBusy) text += "  headlights:\n" + headlight(6) + headlight(in(25, 35)) + headlight(in(50, 70));
        drawFault();
        std::vector<std::string> faults = options_.script;
        if (!fault.empty()) faults.push_back(fault);
        for (double at = in(20, 60); options_.isBusy && at < options_.length; at += in(60, 180))
            faults.push_back(fmt::format("kind: fog, at: {:.1f}, until: {:.1f}, rise: 8, density: {:.4f}", at, at + in(20, 40),
                                         in(0.003, 0.03)));
        if (!faults.empty()) text += "  faults:\n";
        for (std::string& line : faults) {
            if (const auto at = line.find("NAME"); at != std::string::npos) line.replace(at, 4, names[0]);
            text += "    - {" + line + "}\n";
        }
        return text;
    }

private:
    // A car's lamp that passes again and again.
    std::string headlight(double at) {
        return fmt::format(
            "    - {{path: [[-25, {:.1f}], [25, {:.1f}]], speed: {:.1f}, at: {:.1f}, every: {:.0f}, beam_angle: 20, field_angle: "
            "45}}\n",
            in(6, 14), in(6, 14), in(6, 14), at, in(30, 90));
    }
    double ambient_ = 1;
    std::string rectangle() {
        const double width = in(0.25, 0.6), height = in(0.35, 0.8), left = in(0.1, 0.9 - width), top = in(0.05, 0.95 - height);
        return fmt::format("[{:.3f}, {:.3f}, {:.3f}, {:.3f}]", left, top, left + width, top + height);
    }
    void drawFault() {
        const std::string& kind = options_.fault;
        if (kind.empty()) return;
        faultAt = std::round(10 * in(options_.faultAt, options_.faultAt + Leaves::kCue)) / 10;
        std::string when = fmt::format("at: {:.1f}", faultAt);
        if (options_.faultLasts > 0) when += fmt::format(", until: {:.1f}", faultAt + options_.faultLasts);
        const std::string output = names[static_cast<std::size_t>(in(0, 0.999 * static_cast<double>(names.size())))];
        const auto ofOutput = [&](const std::string& keys) {
            faulty = output;
            fault = fmt::format("kind: {}, output: {}, {}, {}", kind, output, when, keys);
        };
        const auto ofAll = [&](const std::string& keys) {
            fault = fmt::format("kind: {}, {}{}{}", kind, when, keys.empty() ? "" : ", ", keys);
        };
        const auto drawTurn = [&] {
            const glm::dvec3 degrees = logIn(0.06, 2.2) * glm::normalize(glm::dvec3(in(-1, 1), in(-1, 1), in(-1, 1)));
            turn = degrees * radians(1);
            return fmt::format("turn: {}", listOf(degrees));
        };
        if (kind == "bump") ofOutput(drawTurn());
        if (kind == "defocus") ofOutput(fmt::format("blur: {:.2f}, rise: {:.1f}", logIn(3, 15), in(0, 3)));
        if (kind == "dim") ofOutput(fmt::format("level: {:.2f}, rise: {:.1f}", in(0.2, 0.75), in(0, 3)));
        if (kind == "input") ofOutput("picture: menu.png");
        if (kind == "unplug") {
            faulty = output;
            fault = fmt::format("kind: unplug, device: {}, {}", output, when);
        }
        if (kind == "fog") ofAll(fmt::format("density: {:.3f}, rise: {:.1f}", logIn(0.012, 0.08), in(0, 4)));
        if (kind == "ambient") ofAll(fmt::format("level: {:.1f}, rise: {:.1f}", 1 + logIn(5, 80) / ambient_, in(0, 4)));
        if (kind == "camera_bump") ofAll(drawTurn());
        if (kind == "cover") ofAll(fmt::format("rectangle: {}", rectangle()));
        if (kind == "dirt") ofAll(fmt::format("blur: {:.1f}, veil: {:.2f}", logIn(2, 7), in(0, 0.6)));
        if (kind == "blind") ofAll(fmt::format("level: {}", in(0, 1) < 0.5 ? 0 : 1));
        if (kind == "upside_down") ofAll("");
        if (kind == "freeze") fault = fmt::format("kind: freeze, device: camera, {}", when);
        if (kind == "exposure") ofAll(fmt::format("gain: {:.2f}", in(0, 1) < 0.5 ? in(0.25, 0.6) : in(1.7, 4)));
    }

    const NightOptions& options_;
    const std::filesystem::path folder_;
    Rng rng_;
};

// A simulated site on a clock that is moved by hand.
struct Site {
    ManualClock clock;
    site::World world{clock};
    std::unique_ptr<site::SimulatedSite> simulation;
    Site(const show::Site& plan, std::uint64_t seed) {
        simulation = must(site::SimulatedSite::open(*plan.simulation, must(simulationOf(plan)), seed, world));
        simulation->begin(Time{});
        for (const show::Bank& bank : plan.relayBanks) world.installRelays(bank.name, {true});
    }
};

// What calibrating would have found: the plan's map, which is true, with the light of a white and a
// black picture.
void survey(const show::Site& site, double cameraRate, std::vector<std::optional<vision::WatchedOutput>>& watched) {
    const vision::CameraLight light = cameraLightOf(site);
    const auto pictureOf = [&](std::size_t white, bool any) {
        Site open(site, 99);
        const glm::ivec2 size = site.nominalCamera->size;
        GreyImage sum(size.x, size.y);
        for (std::size_t i = 0; i < site.outputs.size(); ++i) {
            const std::uint8_t stored = any && i == white ? 255 : 0;
            open.world.setFrame(site.outputs[i].name,
                                std::make_shared<RgbaImage>(site.outputs[i].size().x, site.outputs[i].size().y,
                                                            Rgba8{stored, stored, stored, 255}));
        }
        constexpr int kPictures = 3;
        for (int step = 0, pictures = 0; pictures < kPictures; ++step) {
            // The last row is exposed a little later, and the picture arrives later still.
            for (const double part : {0.0, 0.3, 0.95}) {
                open.clock.advanceTo(fromSeconds((step + part) / cameraRate));
                open.simulation->advanceTo(open.clock.now());
            }
            if (const auto frame = open.world.takeFromCamera()) {
                light.addTo(sum, frame->image);
                ++pictures;
            }
        }
        for (float& value : sum.pixels()) value /= kPictures;
        return sum;
    };
    const GreyImage dark = pictureOf(0, false);
    for (std::size_t i = 0; i < watched.size(); ++i) {
        if (!watched[i]) continue;
        GreyImage white = pictureOf(i, true);
        for (std::size_t p = 0; p < white.pixels().size(); ++p)
            watched[i]->map.light.pixels()[p] =
                watched[i]->map.light.pixels()[p] > 0 ? std::max(1e-4f, white.pixels()[p] - dark.pixels()[p]) : 0;
        watched[i]->isSurveyed = true;
        watched[i]->dark = dark;
    }
}

// A picture that is moved on its projector.
RgbaImage shifted(const RgbaImage& picture, const show::PictureShift& shift) {
    const auto map = show::mapOf(shift, {picture.width(), picture.height()});
    if (show::farthestOf(shift) <= 0 || !map) return picture;
    const Homography back = map->inverse();
    RgbaImage moved(picture.width(), picture.height());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const glm::dvec2 from = back({x + 0.5, y + 0.5}) - 0.5;
            const glm::ivec2 corner(glm::floor(from));
            const glm::dvec2 share = from - glm::dvec2(corner);
            if (corner.x < 0 || corner.y < 0 || corner.x + 1 >= picture.width() || corner.y + 1 >= picture.height()) continue;
            const auto light = [&](int dx, int dy) { return static_cast<double>(picture.at(corner.x + dx, corner.y + dy).r); };
            const auto value = static_cast<std::uint8_t>(std::lround(
                std::lerp(std::lerp(light(0, 0), light(1, 0), share.x), std::lerp(light(0, 1), light(1, 1), share.x), share.y)));
            moved.at(x, y) = {value, value, value, 255};
        }
    return moved;
}

// How a bump moves a projector's picture on the wall, and what a shift leaves of it.
class BumpedOutput {
public:
    BumpedOutput(const show::Output& output, const vision::CameraModel& projector, glm::dvec3 turn) : size_(output.size()) {
        vision::CameraModel bumped = projector;
        bumped.pose.worldFromLocal = projector.pose.worldFromLocal * rotationXyz(turn);
        constexpr int kPlaces = 9;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
            const glm::dvec2 at = glm::dvec2(i % kPlaces, i / kPlaces) / (kPlaces - 1.0) * glm::dvec2(size_);
            const vision::Ray ray = projector.rayThrough(at);
            const glm::dvec3 wall = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
            if (const auto now = bumped.pixelFromWorld(wall)) places_.emplace_back(at, *now);
        }
    }
    Placed placed(Time at, const show::PictureShift& shift, bool isBumped) const {
        const Homography map = show::mapOf(shift, size_).value_or(Homography());
        Placed placed{at};
        for (const auto& [from, bumped] : places_) {
            const glm::dvec2 to = isBumped ? bumped : from, shown = map(from);
            placed.moved += glm::dot(to - from, to - from);
            placed.missed += glm::dot(shown - to, shown - to);
            placed.shifted += glm::dot(shown - from, shown - from);
        }
        for (double* sum : {&placed.moved, &placed.missed, &placed.shifted})
            *sum = std::sqrt(*sum / static_cast<double>(places_.size()));
        return placed;
    }

private:
    glm::ivec2 size_;
    std::vector<std::pair<glm::dvec2, glm::dvec2>> places_;  // before and after
};

show::CueList cuesOf(const show::Site& site) {
    show::CueList cues;
    cues.dark.outputs.resize(site.outputs.size());
    cues.dark.levels.resize(site.channelCount());
    cues.farthestShift = site.corrections.geometry.farthest;
    cues.shiftSpeed = site.corrections.geometry.speed;
    cues.dark.relays.assign(site.relays.size(), 1);
    const show::Corrections::Lamps& lamps = site.corrections.lamps;
    cues.trim = {static_cast<float>(lamps.least), lamps.speed, static_cast<int>(lamps.relays.size()), lamps.hold};
    return cues;
}

// A site, its show, and the watch of it.
class Night {
public:
    Night(const NightOptions& options, const show::Site& site)
        : options_(options),
          site_(site),
          open_(site, options.seed),
          inputs_(cuesOf(site)),
          playback_(inputs_),
          frames_(site.outputs.size()),
          given_(site.outputs.size()) {
        auto watched = must(watchedOutputsOf(site));
        if (options.isSurveyed) survey(site, options.cameraRate, watched);
        std::vector<ShownLight::Frames> sources;
        for (std::size_t i = 0; i < site.outputs.size(); ++i) {
            leaves_.emplace_back(options.seed * 10 + i, site.outputs[i].size());
            sources.push_back({[this, i](Time now) { return nextFrame(i, now); }, [](Time) {}});
        }
        watch_.emplace(site, watched, cameraLightOf(site), sources, inputs_, events_, show::ShowClock());
    }

    // One exposure of the camera.
    void step(std::int64_t number) {
        const Time exposed = tickTime(number, options_.cameraRate), frameTime = fromSeconds(1 / options_.refreshRate);
        open_.clock.advanceTo(exposed);
        playback_.stateAt(exposed, state_);
        for (std::size_t i = 0; i < frames_.size(); ++i) {
            frames_[i].push_back({i,
                                  exposed,
                                  {number, exposed - frameTime / 2, exposed, {}},
                                  shifted(leaves_[i].at(seconds(exposed)), state_.shifts[i])});
            open_.world.setFrame(site_.outputs[i].name, std::make_shared<const RgbaImage>(frames_[i].back().image));
        }
        state_.levels[0] = static_cast<float>(Leaves::lampAt(seconds(exposed), options_.seed, !options_.lamps.empty()));
        light(exposed);
        open_.simulation->advanceTo(exposed);
        watch(exposed);
        // The last row is exposed a little later, and the picture arrives later still.
        for (const double part : {0.3, 0.6, 0.95}) {
            open_.clock.advanceTo(exposed + fromSeconds(part / options_.cameraRate));
            open_.simulation->advanceTo(open_.clock.now());
            watch(open_.clock.now());
        }
    }
    const show::ShowState& state() const { return state_; }
    const std::vector<LampMoment>& lamps() const { return lamps_; }
    std::string told() const {
        std::string told;
        show::EventLog::Reader reader = events_.reader();
        while (const show::Event* const event = reader.next())
            told += fmt::format("{:.1f} {}\n", seconds(event->at), sentenceOf(*event));
        return told;
    }
    const DriftWatch& result() const { return *watch_; }

private:
    void watch(Time now) {
        const double still = seconds(now) - options_.standsStillAt;
        if (options_.standsStillAt >= 0 && still >= 0 && still < 4) return;
        watch_->tick(open_.world.takeFromCamera(), state_, false, now);
    }
    // The newest frame that has come to the watch, once.
    const render::ShownFrame* nextFrame(std::size_t output, Time now) {
        std::deque<render::ShownFrame>& frames = frames_[output];
        const render::ShownFrame* next = nullptr;
        for (; !frames.empty() && frames.front().showTime + fromSeconds(options_.frameDelay) <= now; frames.pop_front()) {
            given_[output] = std::move(frames.front());
            next = &given_[output];
        }
        return next;
    }
    // Gives the lamps what the show asks and the camera leaves.
    void light(Time at) {
        show::Look look = state_;
        show::applyTrim(site_, state_.lamps, look);
        std::array<std::uint8_t, kDmxSlots> slots{};
        show::slotsOf(site_, look, 1, slots);
        open_.world.setSlots(1, slots);
        if (site_.relays.empty()) return;
        open_.world.setRelays(site_.relayBanks[0].name, {look.relays[0] != 0});
        lamps_.push_back({at, state_.levels[0], look.levels[0], look.relays[0] != 0});
    }

    const NightOptions& options_;
    const show::Site& site_;
    Site open_;
    std::vector<LampMoment> lamps_;
    show::InputLog inputs_;
    show::EventLog events_;
    show::PlaybackReplica playback_;
    std::vector<Leaves> leaves_;
    std::vector<std::deque<render::ShownFrame>> frames_;  // by output: those that are under way to the watch
    std::vector<render::ShownFrame> given_;               // and the one that it was given last
    std::optional<DriftWatch> watch_;
    show::ShowState state_;
};

}  // namespace

const std::vector<DrawnFault>& drawnFaults() {
    static const std::vector<DrawnFault> faults{
        {"bump", "out of place", true},  {"defocus", "out of focus", true}, {"dim", "dim projector lamp", true},
        {"unplug", "dead output", true}, {"input", "wrong input", true},    {"fog", "fog"},
        {"ambient", "ambient light"},    {"cover", "blocked view"},         {"camera_bump", "camera moved"},
        {"dirt", "camera dirty"},        {"blind", "camera blind"},         {"upside_down", "camera upside down"},
        {"freeze", "camera frozen"},     {"exposure", "camera exposure"}};
    return faults;
}

NightResult playNight(const NightOptions& options) {
    const ScratchFolder folder;
    Draw draw(options, folder.path());
    const std::filesystem::path file = folder.path() / "site.yaml";
    if (const auto written = writeFile(file, draw.site()); !written) throw std::runtime_error(written.error().message());
    const show::Site site = must(readSite(file));
    NightResult result;
    result.outputs = draw.names;
    result.output = draw.faulty;
    result.drawn = draw.fault;
    result.faultAt = draw.faultAt;
    const auto faulty = static_cast<std::size_t>(std::ranges::find(draw.names, draw.faulty) - draw.names.begin());
    std::optional<BumpedOutput> bumped;
    if (options.fault == "bump")
        bumped.emplace(site.outputs[faulty], must(simulationOf(site)).outputs[faulty].projector, draw.turn);
    Night night(options, site);
    for (std::int64_t step = 0; seconds(tickTime(step, options.cameraRate)) < options.length; ++step) {
        night.step(step);
        const Time at = tickTime(step, options.cameraRate);
        for (std::size_t i = 0; i < site.outputs.size(); ++i) {
            double& most = result.farthest[site.outputs[i].name];
            most = std::max(most, static_cast<double>(show::farthestOf(night.state().shifts[i])));
        }
        if (bumped) result.placed.push_back(bumped->placed(at, night.state().shifts[faulty], seconds(at) >= draw.faultAt));
    }
    result.causes = night.result().causes();
    result.drifts = night.result().series();
    result.lamps = night.lamps();
    result.otherLight = night.result().lamps();
    result.told = night.told();
    return result;
}

}  // namespace fantascope::app
