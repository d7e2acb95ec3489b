// Measures how a drawing reads on walls that a seed draws: without corrections, with the light's,
// with the pattern's, and with both. Each show is a rehearsal of the built program on a calibrated
// simulated site; z and tone are the camera's, means over the last seconds.

#include "show/site/corrections.h"

#include "core/file.h"
#include "core/random.h"
#include "media/image.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope {
namespace {

// Smooth noise of a wavelength of one, 0..1.
double noise(double x, double y, std::uint64_t seed) {
    const double column = std::floor(x), row = std::floor(y);
    const auto value = [&](double dx, double dy) {
        // The finalizer of splitmix64.
        std::uint64_t hash =
            (seed * 4099 + static_cast<std::uint64_t>(column + dx + 1000)) * 4099 + static_cast<std::uint64_t>(row + dy + 1000);
        hash = (hash ^ hash >> 30) * 0xbf58476d1ce4e5b9;
        hash = (hash ^ hash >> 27) * 0x94d049bb133111eb;
        return static_cast<double>((hash ^ hash >> 31) >> 11) * 0x1p-53;
    };
    const double u = x - column, v = y - row;
    return std::lerp(std::lerp(value(0, 0), value(1, 0), u), std::lerp(value(0, 1), value(1, 1), u), v);
}

// The share of light that a wall gives back at a place. The place is in metres.
double reflectanceOf(const std::string& wall, double x, double y, std::uint64_t seed) {
    const double stain =
        std::clamp(4 * (0.6 * noise(x / 1.1, y / 0.9, seed + 1) + 0.4 * noise(x / 0.4, y / 0.4, seed + 2) - 0.5), 0.0, 1.0);
    const double grain = noise(50 * x, 50 * y, seed + 3);
    if (wall == "grass") return std::lerp(0.1 + 0.12 * grain, 0.3 + 0.1 * grain, stain);  // and bare earth
    if (wall == "gravel") {                                                               // and where it is wet
        const double stones = 0.25 + 0.2 * grain + 0.15 * noise(16 * x, 16 * y, seed + 4);
        return stones * std::lerp(1.0, 0.35, stain);
    }
    const double row = std::floor(y / 0.09), along = x + std::fmod(row, 2) * 0.14;  // brick, and soot
    const bool isMortar = y - row * 0.09 < 0.012 || std::fmod(along, 0.28) < 0.012;
    const double brick = 0.2 + 0.2 * noise(std::floor(along / 0.28) + 0.5, row + 0.5, seed + 4);
    return (isMortar ? 0.55 : brick) * std::lerp(1.0, 0.4, stain);
}

void paint(const std::filesystem::path& file, const std::string& wall, std::uint64_t seed) {
    RgbaImage picture(1600, 1000);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const double light = reflectanceOf(wall, x / 200.0, y / 200.0, seed);
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(light))));
            picture.at(x, y) = {stored, stored, stored, 255};
        }
    if (const auto written = writePng(file, picture); !written) throw std::runtime_error(written.error().message());
}

struct Options {
    std::filesystem::path guide = sourceFolder() + "/shows/light-movement/guides/left.png";
    std::uint64_t seed = 1;
    double least = 0.7, gain = show::Corrections::Pattern{}.gain, seconds = 54;
    int iterations = 300;
};

// {0}, {1}: where the projector stands; {2}, {3}: the camera; {4}: vignetting; {5}: blur.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {{driver: headless}}
    size: [960, 540]
    refresh_rate: 10
    projector: {{position: [{0:.2f}, {1:.2f}, 6], look_at: [0, 1.5, 0], throw_ratio: 1.6}}
    surface: {{point: [0, 0, 0], normal: [0, 0, 1]}}
cue_controller: {{device: {{driver: simulated}}, buttons: {{go: 1}}}}
camera:
  device: {{driver: simulated}}
  size: [480, 270]
  field_of_view: 46
  position: [{2:.2f}, {3:.2f}, 6]
  look_at: [0, 1.5, 0]
simulation:
  ambient: [0.2, 0.25, 0.4]
  objects:
    - {{name: wall, rectangle: {{corner: [-4, -1, 0], right: [8, 0, 0], up: [0, 5, 0], texture: wall.png}}, reflectance: [1, 1, 1]}}
  camera: {{white: 110, latency: 0.05, frame_rate: 5, vignetting: {4:.2f}, blur: {5:.2f}, read_noise: 0.004}}
)";

// A site before a wall, and a show of one drawing.
class Wall {
public:
    Wall(const Options& options, std::string name) : options_(options), name_(std::move(name)) {
        Rng rng(options.seed);
        const auto in = [&](double low, double high) { return std::lerp(low, high, rng.uniform()); };
        paint(folder_ / "wall.png", name_, options.seed);
        write("show.yaml",
              "fantascope: show\nversion: 1\ntitle: Wall\nsources: {drawing: {pattern: drawing.pattern.yaml}}\nlooks: {all: "
              "{outputs: {left: [{source: drawing}]}}}\ncues: [{name: one, look: all, fade: 0.1}]\n");
        write("few.pattern-settings.yaml", "fantascope: pattern-settings\nversion: 1\nsearch: {rows: 360}\n");
        site_ = fmt::format(kSite, in(-1.8, 1.8), in(1, 3), in(-1.5, 1.5), in(1, 2.5), in(0, 0.3), in(0.4, 1));
        write("site.yaml", site_ + correctionsOf(false, false));
        run("calibrate . --simulate --write");
        run(fmt::format("pattern '{}' -o drawing.pattern.yaml --iterations {} --settings few.pattern-settings.yaml",
                        std::filesystem::absolute(options.guide).string(), options.iterations));
        site_ = must(readFile(folder_ / "site.yaml"));
        site_.resize(site_.find("corrections:"));
    }
    // Plays the show, and prints a line.
    void play(bool light, bool pattern) const {
        write("site.yaml", site_ + correctionsOf(light, pattern));
        run(fmt::format("rehearse . --site site.yaml --from one --seconds {} --as-fast-as-possible --report r.json",
                        options_.seconds));
        const nlohmann::json report = nlohmann::json::parse(must(readFile(folder_ / "r.json")));
        const auto mean = [&](const char* key) {
            double sum = 0;
            int count = 0;
            for (const auto& entry : report[key]["left"])
                if (entry[0] > options_.seconds - 6) sum += entry[1].get<double>(), ++count;
            return count > 0 ? sum / count : std::nan("");
        };
        fmt::print("{:7} {:3} {:8} z {:.4f} tone {:.4f}, exchanges {}\n", name_, options_.seed,
                   light && pattern ? "both"
                   : light          ? "light"
                   : pattern        ? "pattern"
                                    : "neither",
                   mean("z_camera"), mean("tone_camera"), report["patterns"].size());
        std::fflush(stdout);
    }

private:
    template <class T>
    static T must(Result<T> result) {
        if (!result) throw std::runtime_error(result.error().message());
        return std::move(*result);
    }
    void write(const std::string& name, const std::string& text) const {
        if (const auto written = writeFile(folder_ / name, text); !written) throw std::runtime_error(written.error().message());
    }
    std::string correctionsOf(bool light, bool pattern) const {
        const auto mode = [](bool is) { return is ? "automatic" : "off"; };
        return fmt::format("corrections: {{light: {{mode: {}, least: {}}}, pattern: {{mode: {}, gain: {}}}}}\n", mode(light),
                           options_.least, mode(pattern), options_.gain);
    }
    void run(const std::string& arguments) const {
        const std::string command =
            fmt::format("cd '{}' && '{}' {} >said 2>&1", folder_.path().string(), FANTASCOPE_PROGRAM, arguments);
        if (std::system(command.c_str()) != 0)
            throw std::runtime_error(fmt::format("fantascope {}:\n{}", arguments, must(readFile(folder_ / "said"))));
    }

    const Options& options_;
    const std::string name_;
    const ScratchFolder folder_;
    std::string site_;  // without its corrections
};

}  // namespace
}  // namespace fantascope

int main(int argc, char** argv) {
    CLI::App app("Measures how a drawing reads on drawn walls with corrections");
    fantascope::Options options;
    std::uint64_t first = 1, last = 3;
    std::vector<std::string> walls{"grass", "gravel", "brick"};
    app.add_option("walls", walls, "grass, gravel, brick (default: each)")->check(CLI::IsMember({"grass", "gravel", "brick"}));
    app.add_option("--guide", options.guide, "the drawing")->check(CLI::ExistingFile);
    app.add_option("--first", first, "first seed");
    app.add_option("--last", last, "last seed");
    app.add_option("--least", options.least, "of the correction of light, as in a site file");
    app.add_option("--gain", options.gain, "of the correction of patterns, as in a site file");
    app.add_option("--iterations", options.iterations, "of the search for the pattern");
    CLI11_PARSE(app, argc, argv);
    try {
        for (options.seed = first; options.seed <= last; ++options.seed)
            for (const std::string& name : walls) {
                const fantascope::Wall wall(options, name);
                for (const auto& [light, pattern] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}})
                    wall.play(light, pattern);
            }
    } catch (const std::exception& error) {
        return fmt::print(stderr, "walls_bench: {}\n", error.what()), 1;
    }
}
