#include "drawn_night.h"

#include "app/site/site_file.h"
#include "app/site/site_models.h"
#include "drivers/site/simulated_site.h"

#include "show/cue_list.h"

#include "core/file.h"
#include "core/warp.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::app {
namespace {

constexpr double kCameraRate = 5;  // Hz: every picture is looked at

template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message());
    return std::move(*result);
}

// Noise of a wavelength, 0..1, that repeats after `size` pixels.
double noise(double x, double y, int cells, std::uint64_t seed) {
    const auto value = [&](int column, int row) {
        Rng rng(seed * 7919 +
                static_cast<std::uint64_t>(((row % cells + cells) % cells) * cells + (column % cells + cells) % cells));
        return rng.uniform();
    };
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    const double u = x - column, v = y - row;
    return std::lerp(std::lerp(value(column, row), value(column + 1, row), u),
                     std::lerp(value(column, row + 1), value(column + 1, row + 1), u), v);
}

RgbaImage texture(std::uint64_t seed) {
    constexpr int kSize = 256;
    RgbaImage picture(kSize, kSize);
    const int kind = static_cast<int>(seed % 3);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            double value = 0;
            if (kind == 0) value = 0.3 + 0.4 * noise(x / 2.0, y / 2.0, 128, seed) + 0.2 * noise(x / 16.0, y / 16.0, 16, seed + 1);
            if (kind == 1) value = noise(x / 6.0, y / 6.0, 43, seed) > 0.5 ? 0.75 : 0.45;
            if (kind == 2) {
                const int course = y / 32, along = (x + course % 2 * 32) % kSize;
                value = y % 32 < 3 || along % 64 < 3 ? 0.8 : 0.35 + 0.35 * noise(along / 64, course, 8, seed);
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
        for (std::size_t i = 0; i < light_.size(); ++i) {
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * std::pow(light_[i], 1 / 2.2f)));
            picture.pixels()[i] = {stored, stored, stored, 255};
        }
        return picture;
    }
    static std::uint8_t lampAt(double time, std::uint64_t seed) {
        const int cue = static_cast<int>(time / kCue);
        const auto level = [&](int of) {
            return of < 0 ? 0.0 : static_cast<double>((seed + static_cast<std::uint64_t>(of)) % 3 == 0);
        };
        return static_cast<std::uint8_t>(
            255 * std::lerp(level(cue - 1), level(cue), std::clamp((time - cue * kCue) / kFade, 0.0, 1.0)));
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
                "  - name: {}\n    display: {{driver: headless}}\n    size: [{}, {}]\n    refresh_rate: 30\n    projector: "
                "{{position: {}, look_at: {}, "
                "throw_ratio: {:.3f}}}\n    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}\n",
                names.back(), size.x, size.y, listOf({middle + in(-2, 2), in(1.5, 4), in(7, 9)}), listOf({middle, 2.5, 0}),
                in(1.5, 1.8));
        }
        const double fov = outputs == 3 ? 80 : in(58, 70);
        text += fmt::format(
            "universes:\n  - {{number: 1, port: {{driver: simulated}}}}\nfixtures:\n  - {{name: spot, universe: 1, address: 1, "
            "channels: [intensity]}}\n"
            "camera:\n  device: {{driver: simulated}}\n  size: [{}, {}]\n  field_of_view: {:.2f}\n  position: {}\n  look_at: "
            "{}\n  k1: {:.4f}\n  k2: 0\n",
            options_.camera.x, options_.camera.y, fov, listOf({in(-2, 2), in(1.5, 3), in(11, 13)}),
            listOf({in(-0.3, 0.3), in(2, 2.5), 0}), in(-0.1, 0));
        text += fmt::format("corrections: {{geometry: {{mode: {}}}}}\n", options_.geometry);
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
        text +=
            "  lamps:\n    spot: {position: [-2, 5, 6], look_at: [1, 1.5, 0], beam_angle: 25, field_angle: 40, candela: 900}\n";
        text += fmt::format(
            "  camera: {{white: {:.1f}, read_noise: {:.4f}, shot_noise: 0.012, latency: {:.3f}, frame_rate: {}, vignetting: "
            "{:.2f}, blur: {:.2f}, rolling: "
            "{:.3f}}}\n",
            in(30, 60), in(0.002, 0.006), options_.latency, kCameraRate, in(0, 0.4), in(0.4, 1.2), in(0, 0.03));
        text += "  walkers:\n";
        const int walkers = static_cast<int>(in(1, 3.99));
        for (int i = 0; i < walkers; ++i)
            text += fmt::format("    - {{name: w{}, path: [[-9, {:.2f}], [9, {:.2f}]], speed: {:.2f}, at: {:.1f}, loop: true}}\n",
                                i, in(1, 5), in(1, 5), in(0.7, 1.6), in(0, 10));
        drawFault();
        std::vector<std::string> faults = options_.script;
        if (!fault.empty()) faults.push_back(fault);
        if (!faults.empty()) text += "  faults:\n";
        for (std::string& line : faults) {
            if (const auto at = line.find("NAME"); at != std::string::npos) line.replace(at, 4, names[0]);
            text += "    - {" + line + "}\n";
        }
        return text;
    }

private:
    double ambient_ = 1;
    std::string rectangle() {
        const double width = in(0.25, 0.6), height = in(0.35, 0.8), left = in(0.1, 0.9 - width), top = in(0.05, 0.95 - height);
        return fmt::format("[{:.3f}, {:.3f}, {:.3f}, {:.3f}]", left, top, left + width, top + height);
    }
    void drawFault() {
        const std::string& kind = options_.fault;
        if (kind.empty()) return;
        const std::string when = fmt::format("at: {:.1f}", in(options_.faultAt, options_.faultAt + Leaves::kCue));
        const std::string output = names[static_cast<std::size_t>(in(0, 0.999 * static_cast<double>(names.size())))];
        const auto ofOutput = [&](const std::string& keys) {
            faulty = output;
            fault = fmt::format("kind: {}, output: {}, {}, {}", kind, output, when, keys);
        };
        const auto ofAll = [&](const std::string& keys) {
            fault = fmt::format("kind: {}, {}{}{}", kind, when, keys.empty() ? "" : ", ", keys);
        };
        const auto turn = [&](double most) {
            return fmt::format("turn: {}", listOf({in(-most, most), in(-most, most), in(-most, most)}));
        };
        if (kind == "bump") ofOutput(turn(1.2));
        if (kind == "defocus") ofOutput(fmt::format("blur: {:.2f}, rise: {:.1f}", logIn(3, 15), in(0, 3)));
        if (kind == "dim") ofOutput(fmt::format("level: {:.2f}, rise: {:.1f}", in(0.2, 0.75), in(0, 3)));
        if (kind == "input") ofOutput("picture: menu.png");
        if (kind == "unplug") {
            faulty = output;
            fault = fmt::format("kind: unplug, device: {}, {}", output, when);
        }
        if (kind == "fog") ofAll(fmt::format("density: {:.3f}, rise: {:.1f}", logIn(0.012, 0.08), in(0, 4)));
        if (kind == "ambient") ofAll(fmt::format("level: {:.1f}, rise: {:.1f}", 1 + logIn(5, 80) / ambient_, in(0, 4)));
        if (kind == "camera_bump") ofAll(turn(1.2));
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
    }
};

// What calibrating would have found: the plan's map, which is true, with the light of a white and a
// black picture.
void survey(const show::Site& site, std::vector<std::optional<vision::WatchedOutput>>& watched) {
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
        for (int i = 0; i < kPictures; ++i) {
            // The last row is exposed a little later, and the picture arrives later still.
            for (const double part : {0.0, 0.3, 0.95}) {
                open.clock.advanceTo(fromSeconds((i + part) / kCameraRate));
                open.simulation->advanceTo(open.clock.now());
            }
            const auto frame = open.world.takeFromCamera();
            light.addTo(sum, frame->image);
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
    NightResult result;
    const std::filesystem::path file = folder.path() / "site.yaml";
    const std::string text = draw.site();
    if (const auto written = writeFile(file, text); !written) throw std::runtime_error(written.error().message());
    const show::Site site = must(readSite(file));
    result.output = draw.faulty;
    result.outputs = draw.names;
    result.drawn = draw.fault;
    auto watched = must(watchedOutputsOf(site));
    if (options.isSurveyed) survey(site, watched);

    Site open(site, options.seed);
    const show::CueList cues;
    show::InputLog inputs(cues);
    show::EventLog events;
    const std::size_t outputs = site.outputs.size();
    std::vector<Leaves> leaves;
    std::vector<render::ShownFrame> frames(outputs);
    std::vector<char> isNew(outputs, 0);
    std::vector<ShownLight::Frames> sources;
    for (std::size_t i = 0; i < outputs; ++i) {
        leaves.emplace_back(options.seed * 10 + i, site.outputs[i].size());
        sources.push_back(
            {[&frames, &isNew, i](Time) { return std::exchange(isNew[i], 0) != 0 ? &frames[i] : nullptr; }, [](Time) {}});
    }
    DriftWatch watch(site, watched, cameraLightOf(site), sources, inputs, events, show::ShowClock());
    show::ShowState state;
    state.shifts.resize(outputs);
    state.levels.resize(1);
    const Time frameTime = fromSeconds(1 / 30.0);
    for (std::int64_t step = 0; seconds(tickTime(step, kCameraRate)) < options.length; ++step) {
        const Time exposed = tickTime(step, kCameraRate);
        const double time = seconds(exposed);
        open.clock.advanceTo(exposed);
        for (std::size_t i = 0; i < outputs; ++i) {
            frames[i] = {i, exposed, {step, exposed - frameTime / 2, exposed, {}}, leaves[i].at(time)};
            isNew[i] = 1;
            open.world.setFrame(site.outputs[i].name, std::make_shared<const RgbaImage>(frames[i].image));
        }
        std::array<std::uint8_t, kDmxSlots> slots{};
        slots[0] = Leaves::lampAt(time, options.seed);
        open.world.setSlots(1, slots);
        state.levels[0] = slots[0] / 255.0f;
        open.simulation->advanceTo(exposed);
        watch.tick(exposed);
        // The last row is exposed a little later, and the picture arrives later still.
        for (const double part : {0.3, 0.6, 0.95}) {
            open.clock.advanceTo(exposed + fromSeconds(part / kCameraRate));
            open.simulation->advanceTo(open.clock.now());
            if (const auto frame = open.world.takeFromCamera()) watch.see(*frame, state, false, open.clock.now());
        }
    }
    result.causes = watch.causes();
    result.drifts = watch.series();
    return result;
}

}  // namespace fantascope::app
