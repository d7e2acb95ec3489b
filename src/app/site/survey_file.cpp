#include "app/site/survey_file.h"

#include "core/config/config.h"
#include "core/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
// Of an output: the newest, and that of the site before, which `calibrate --undo` brings back.
constexpr std::size_t kKept = 2;
constexpr double kMaxPixel = 32768;
constexpr int kMaxSide = 16384;
constexpr float kMost = 65535;  // of a stored channel

// What the survey file says of an output. The pictures are read only if it counts.
struct Record {
    std::string output;
    fs::path map, dark;  // pictures
    glm::ivec2 camera{0};
    OutputSurvey survey;  // without the pictures
    int number = 0;       // of its pictures, in their names
};

std::uint16_t stored(double share) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * double(kMost)));
}

// Red and green: the projector pixel, as a share of the picture's width and height. Blue: the
// light, as a camera stores it. Transparent: the projector pixel is unknown.
Rgba16Image pictureOf(const vision::ProjectorMap& map, glm::ivec2 projector) {
    Rgba16Image picture(map.at.width(), map.at.height());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            Rgba16& pixel = picture.at(x, y) = {0, 0, stored(srgbFromLinear(map.light.at(x, y))), 0};
            if (!map.isKnown(x, y)) continue;
            const glm::dvec2 share = glm::dvec2(map.at.at(x, y)) / glm::dvec2(projector);
            pixel = {stored(share.x), stored(share.y), pixel.b, std::uint16_t(kMost)};
        }
    return picture;
}

vision::ProjectorMap mapOf(const Rgba16Image& picture, glm::ivec2 projector) {
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    vision::ProjectorMap map{Image<glm::vec2>(picture.width(), picture.height(), glm::vec2(kUnknown)),
                             GreyImage(picture.width(), picture.height())};
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const Rgba16& pixel = picture.at(x, y);
            map.light.at(x, y) = linearFromSrgb(pixel.b / kMost);
            if (pixel.b > 0) ++map.lit;
            if (pixel.a == 0) continue;
            map.at.at(x, y) = glm::vec2(pixel.r, pixel.g) / kMost * glm::vec2(projector);
            ++map.known;
        }
    return map;
}

Rgba16Image pictureOf(const GreyImage& light) {
    Rgba16Image picture(light.width(), light.height());
    for (std::size_t i = 0; i < light.pixels().size(); ++i) {
        const std::uint16_t value = stored(srgbFromLinear(light.pixels()[i]));
        picture.pixels()[i] = {value, value, value};
    }
    return picture;
}

GreyImage lightOf(const Rgba16Image& picture) {
    GreyImage light(picture.width(), picture.height());
    for (std::size_t i = 0; i < light.pixels().size(); ++i) light.pixels()[i] = linearFromSrgb(picture.pixels()[i].g / kMost);
    return light;
}

Result<glm::dvec2> readPixel(const ConfigNode& node) { return node.vector2(-kMaxPixel, kMaxPixel, "px"); }

Result<glm::ivec2> readSize(const ConfigNode& node) {
    const glm::dvec2 size = TRY(node.vector2(1, kMaxSide, "px"));
    return glm::ivec2(size);
}

Result<WarpMesh> readMesh(const ConfigNode& node) {
    WarpMesh mesh;
    ConfigFields fields(node);
    fields.read("points", mesh.points, [](const ConfigNode& value) -> Result<glm::ivec2> {
        return glm::ivec2(TRY(value.vector2(2, WarpMesh::kMaxPoints)));
    });
    fields.choice("between", mesh.between, {"smooth", "straight"});
    fields.list("offsets", mesh.offsets, readPixel);
    TRY(fields.finish());
    return mesh;
}

Result<WarpShape> readWarp(const ConfigNode& node) {
    WarpShape warp;
    ConfigFields fields(node);
    std::vector<glm::dvec2> part, corners;
    const auto share = [](const ConfigNode& value) { return value.vector2(0, 1); };
    fields.list("part", part, share, 2, 2);
    fields.choice("flip", warp.orientation.flip, {"none", "horizontal", "vertical"});
    fields.integer("turns", warp.orientation.quarterTurns, 0, 3);
    fields.list("corners", corners, readPixel, warp.corners.size(), warp.corners.size());
    fields.optional().read("mesh", warp.mesh, readMesh);
    TRY(fields.finish());
    warp.part = {part[0], part[1]};
    std::ranges::copy(corners, warp.corners.begin());
    return warp;
}

Result<Record> readRecord(const ConfigNode& node) {
    Record record;
    ConfigFields fields(node);
    fields.text("output", record.output);
    fields.integer("number", record.number, 1, std::numeric_limits<int>::max());
    fields.path("map", record.map);
    fields.path("dark", record.dark);
    fields.read("camera", record.camera, readSize);
    fields.read("projector", record.survey.projector, readSize);
    fields.number("gamma", record.survey.gamma, 0.5, 5);
    fields.time("latency", record.survey.latency, 0, 10);
    fields.read("warp", record.survey.warp, readWarp);
    TRY(fields.finish());
    return record;
}

Result<std::vector<Record>> readRecords(const fs::path& file) {
    std::vector<Record> records;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("survey", kVersion);
    fields.list("outputs", records, readRecord);
    TRY(fields.finish());
    return records;
}

Result<Rgba16Image> readPicture(const fs::path& file, glm::ivec2 size) {
    Rgba16Image picture = TRY(readRgba16(file));
    if (glm::ivec2(picture.width(), picture.height()) != size)
        return Error(fmt::format("{}: has {} x {} pixels, the survey says {} x {}; calibrate again", file.string(),
                                 picture.width(), picture.height(), size.x, size.y));
    return picture;
}

Result<OutputSurvey> withPictures(const Record& record) {
    OutputSurvey survey = record.survey;
    survey.map = mapOf(TRY(readPicture(record.map, record.camera)), survey.projector);
    survey.dark = lightOf(TRY(readPicture(record.dark, record.camera)));
    return survey;
}

// Why a record does not count for an output of the site; empty: it does.
std::string whyUnfit(const Record& record, const show::Output& output, const show::Site& site) {
    const glm::ivec2 projector = record.survey.projector;
    if (!site.nominalCamera || site.nominalCamera->size != record.camera)
        return fmt::format("it was surveyed by a camera of {} x {} pixels", record.camera.x, record.camera.y);
    if (projector != output.size()) return fmt::format("it had {} x {} pixels when it was surveyed", projector.x, projector.y);
    if (record.survey.warp != output.projection.warp.shape()) return "its picture was moved since it was surveyed";
    return "";
}

std::string numbers(const auto& points) {
    std::string text;
    for (const glm::dvec2& point : points)
        text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", shortest(point.x), shortest(point.y));
    return '[' + text + ']';
}

std::string textOf(const WarpShape& warp) {
    constexpr std::array<std::string_view, 3> kFlipNames = {"none", "horizontal", "vertical"};
    std::string text = fmt::format(
        "part: {}, flip: {}, turns: {}, corners: {}", numbers(std::array{warp.part.low, warp.part.high}),
        kFlipNames[static_cast<std::size_t>(warp.orientation.flip)], warp.orientation.quarterTurns, numbers(warp.corners));
    if (!warp.mesh.offsets.empty())
        text += fmt::format(",\n           mesh: {{points: [{}, {}], between: {}, offsets: {}}}", warp.mesh.points.x,
                            warp.mesh.points.y, warp.mesh.between == WarpMesh::Between::Smooth ? "smooth" : "straight",
                            numbers(warp.mesh.offsets));
    return text;
}

std::string textOf(const std::vector<Record>& records) {
    std::string text =
        "# Written by fantascope calibrate. Of each output: what the camera saw of its light.\n"
        "fantascope: survey\nversion: 1\noutputs:\n";
    for (const Record& record : records) {
        const OutputSurvey& survey = record.survey;
        text += fmt::format(
            "  - output: {}\n    number: {}\n    map: {}\n    dark: {}\n    camera: [{}, {}]\n    projector: [{}, {}]\n"
            "    gamma: {}\n    latency: {}\n    warp: {{{}}}\n",
            fantascope::quoted(record.output), record.number, fantascope::quoted(record.map.filename().string()),
            fantascope::quoted(record.dark.filename().string()), record.camera.x, record.camera.y, survey.projector.x,
            survey.projector.y, shortest(survey.gamma), shortest(seconds(survey.latency)), textOf(survey.warp));
    }
    return text;
}

Record recordOf(const std::string& output, const OutputSurvey& survey, int number, const fs::path& folder) {
    return {output,
            folder / fmt::format("{}.{}.png", output, number),
            folder / fmt::format("{}.{}.dark.png", output, number),
            {survey.map.at.width(), survey.map.at.height()},
            survey,
            number};
}

// Whether a survey gives this name to a file: OUTPUT.NUMBER.png, OUTPUT.NUMBER.dark.png, or one of
// its files, with an ending more, that a program had not written whole.
bool isSurveys(std::string_view name) {
    if (name.starts_with("survey.yaml.")) return true;
    constexpr std::string_view kPicture = ".png", kDark = ".dark";
    const size_t end = name.rfind(kPicture);
    if (end == name.npos) return false;
    const std::string_view unfinished = name.substr(end + kPicture.size());
    std::string_view numbered = name.substr(0, end);
    if (numbered.ends_with(kDark)) numbered.remove_suffix(kDark.size());
    const size_t output = numbered.find_last_not_of("0123456789");
    return (unfinished.empty() || unfinished.front() == '.') && output != name.npos && output > 0 && numbered[output] == '.' &&
           output + 1 < numbered.size();
}

// Removes pictures that no record names any more, and what a program left that was ended while it
// wrote.
void removeUnnamed(const fs::path& folder, const std::vector<Record>& records) {
    std::set<fs::path> named;
    for (const Record& record : records) named.insert({record.map.filename(), record.dark.filename()});
    std::error_code ignored;
    std::vector<fs::path> unnamed;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const fs::path name = entry.path().filename();
        if (!named.contains(name) && isSurveys(name.native()) && entry.is_regular_file(ignored)) unnamed.push_back(entry.path());
    }
    for (const fs::path& file : unnamed) fs::remove(file, ignored);
}

}  // namespace

fs::path surveyFileOf(const fs::path& site) { return site.parent_path() / (site.stem().string() + ".survey") / "survey.yaml"; }

Result<std::optional<Survey>> readSurvey(const show::Site& site) {
    const fs::path file = surveyFileOf(site.file);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return std::optional<Survey>();
    Survey survey;
    for (const Record& record : TRY(readRecords(file))) {
        const auto output = std::ranges::find(site.outputs, record.output, &show::Output::name);
        if (output == site.outputs.end() || survey.outputs.contains(record.output)) continue;
        const std::string why = whyUnfit(record, *output, site);
        if (why.empty()) {
            survey.outputs[record.output] = TRY(withPictures(record));
            survey.unfit.erase(record.output);
        } else {
            survey.unfit.try_emplace(record.output, why + "; calibrate it again");
        }
    }
    return std::optional(std::move(survey));
}

Result<void> writeSurvey(const show::Site& site, const std::map<std::string, OutputSurvey>& measured) {
    const fs::path file = surveyFileOf(site.file), folder = file.parent_path();
    std::vector<Record> before = [&] {
        auto read = readRecords(file);
        return read ? std::move(*read) : std::vector<Record>();
    }();
    // The site as it stands becomes the one before. Its records may not be the newest: after a way
    // back, or if the program ended between survey and site.
    std::ranges::stable_partition(before, [&](const Record& record) {
        const auto output = std::ranges::find(site.outputs, record.output, &show::Output::name);
        return output != site.outputs.end() && whyUnfit(record, *output, site).empty();
    });
    int number = 0;
    for (const Record& record : before) number = std::max(number, record.number);
    ++number;
    std::vector<Record> records;
    for (const auto& [output, survey] : measured) {
        records.push_back(recordOf(output, survey, number, folder));
        TRY(writePng(records.back().map, pictureOf(survey.map, survey.projector)));
        TRY(writePng(records.back().dark, pictureOf(survey.dark)));
    }
    for (const Record& record : before)
        if (static_cast<std::size_t>(std::ranges::count(records, record.output, &Record::output)) < kKept)
            records.push_back(record);
    TRY(writeFile(file, textOf(records)));
    removeUnnamed(folder, records);
    return {};
}

Result<std::vector<std::string>> checkSurvey(const fs::path& file) {
    std::set<std::string> outputs;
    for (const Record& record : TRY(readRecords(file))) {
        TRY(withPictures(record));
        outputs.insert(record.output);
    }
    return std::vector<std::string>(outputs.begin(), outputs.end());
}

}  // namespace fantascope::app
