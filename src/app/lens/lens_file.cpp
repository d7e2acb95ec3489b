#include "app/lens/lens_file.h"

#include "show/site/site_fields.h"

#include "core/config/config.h"
#include "core/config/config_edit.h"
#include "core/file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <system_error>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr double kDegree = std::numbers::pi / 180;

// As precise as a lens is ever known.
double rounded(double value, double parts) { return std::round(value * parts) / parts; }

std::string decimal(double value, int digits) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    while (text.find('.') != std::string::npos && (text.ends_with('0') || text.ends_with('.'))) text.pop_back();
    return text == "-0" ? "0" : text;
}

// Letters, digits and dots of a name; anything else becomes a dash.
std::string forFileName(const std::string& name) {
    std::string safe;
    for (const char c : name) safe += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ? c : '-';
    return safe;
}

fs::path fileFor(const fs::path& folder, const std::string& card, const std::string& serial, glm::ivec2 size) {
    std::string name = forFileName(card);
    if (!serial.empty()) name += "-" + forFileName(serial);
    return folder / fmt::format("{}-{}x{}.lens.yaml", name.starts_with('.') ? "camera" + name : name, size.x, size.y);
}

std::string textOf(const KeptLens& lens) {
    std::string text = fmt::format("fantascope: lens\nversion: {}\ncard: {}\n", kVersion, fantascope::quoted(lens.card));
    if (!lens.serial.empty()) text += fmt::format("serial: {}\n", fantascope::quoted(lens.serial));
    text += fmt::format("size: [{}, {}]\n", lens.size.x, lens.size.y);
    if (lens.fieldOfView > 0)
        text += fmt::format("lens: {{field_of_view: {}, centre: [{}, {}], k1: {}, k2: {}, rms: {}, views: {}}}\n",
                            decimal(lens.fieldOfView / kDegree, 4), decimal(lens.centre.x, 2), decimal(lens.centre.y, 2),
                            decimal(lens.k1, 6), decimal(lens.k2, 6), decimal(lens.rms, 3), lens.views);
    if (!lens.light.response.empty()) {
        std::vector<std::string> values;
        for (const double value : lens.light.response) values.push_back(decimal(value, 5));
        text += fmt::format("response: [{}]\n", fmt::join(values, ", "));
    }
    if (!lens.light.hotPixels.empty()) {
        std::vector<std::string> pixels;
        for (const glm::ivec2 pixel : lens.light.hotPixels) pixels.push_back(fmt::format("[{}, {}]", pixel.x, pixel.y));
        text += fmt::format("hot_pixels: [{}]\n", fmt::join(pixels, ", "));
    }
    return text;
}

Result<void> readOptics(const ConfigNode& node, KeptLens& lens) {
    ConfigFields fields(node);
    fields.angle("field_of_view", lens.fieldOfView, 1, 179);
    fields.vector2("centre", lens.centre, -show::kMostPixels, 2 * show::kMostPixels, "px");
    fields.number("k1", lens.k1, -1, 1);
    fields.number("k2", lens.k2, -1, 1);
    fields.number("rms", lens.rms, 0, 1000, "px");
    fields.integer("views", lens.views, 1, 100000);
    return fields.finish();
}

}  // namespace

KeptLens KeptLens::of(const LensResult& result, const CameraDescription& camera) {
    const vision::CameraModel& lens = result.fit.lens;
    return {camera.card, camera.serial, lens.size,      lens.fieldOfView(), lens.centre,
            lens.k1,     lens.k2,       result.fit.rms, result.views,       {}};
}

std::string KeptLens::camera() const {
    return identityOf({.card = card, .serial = serial, .format = {}, .lacks = {}, .exposure = {}});
}

std::string identityOf(const CameraDescription& camera) {
    return camera.card + (camera.serial.empty() ? "" : ", serial " + camera.serial);
}

Result<fs::path> lensFolder() {
    const auto from = [](const char* name) -> fs::path {
        const char* value = std::getenv(name);
        return value != nullptr ? value : "";
    };
    if (const fs::path data = from("XDG_DATA_HOME"); data.is_absolute()) return data / "fantascope/lenses";
    if (const fs::path home = from("HOME"); home.is_absolute()) return home / ".local/share/fantascope/lenses";
    return Error("there is no place to keep lenses: set HOME, or XDG_DATA_HOME, to a folder");
}

Result<KeptLens> readLens(const fs::path& file) {
    KeptLens lens;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("lens", kVersion);
    fields.text("card", lens.card);
    fields.optional().text("serial", lens.serial);
    fields.read("size", lens.size, show::readSize);
    fields.optional().read("lens", lens, [&](const ConfigNode& node) -> Result<KeptLens> {
        KeptLens with = lens;
        TRY(readOptics(node, with));
        return with;
    });
    fields.optional().read("response", lens.light.response, show::readResponse);
    fields.optional().list("hot_pixels", lens.light.hotPixels, show::readWholePixel, 0, show::kMostHotPixels);
    TRY(fields.finish());
    return lens;
}

Result<fs::path> keepLens(const fs::path& folder, KeptLens lens) {
    const fs::path file = fileFor(folder, lens.card, lens.serial, lens.size);
    std::error_code ignored;
    if (fs::exists(file, ignored)) {
        const KeptLens before = TRY(readLens(file));
        if (lens.light == KeptLight()) lens.light = before.light;
        if (lens.fieldOfView == 0) {
            KeptLens merged = before;
            merged.light = lens.light;
            lens = merged;
        }
    }
    TRY(writeFile(file, textOf(lens)));
    return file;
}

Result<std::optional<KeptLens>> keptLens(const fs::path& folder, const CameraDescription& camera, glm::ivec2 size) {
    const fs::path file = fileFor(folder, camera.card, camera.serial, size);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return std::optional<KeptLens>();
    KeptLens lens = TRY(readLens(file));
    // Two names may give one file.
    if (lens.card != camera.card || lens.serial != camera.serial || lens.size != size) return std::optional<KeptLens>();
    return std::optional(std::move(lens));
}

Result<void> writeLens(const show::Site& site, const KeptLens& lens) {
    ConfigDocument document = TRY(ConfigDocument::load(site.file));
    if (lens.fieldOfView > 0) {
        TRY(document.set({"camera", "field_of_view"}, rounded(lens.fieldOfView / kDegree, 1e4)));
        TRY(document.set({"camera", "k1"}, rounded(lens.k1, 1e6)));
        TRY(document.set({"camera", "k2"}, rounded(lens.k2, 1e6)));
        TRY(document.set({"camera", "centre"}, glm::dvec2(rounded(lens.centre.x, 100), rounded(lens.centre.y, 100))));
        if (lens.card.empty())
            TRY(document.erase({"camera", "lens_of"}));
        else
            TRY(document.set({"camera", "lens_of"}, lens.camera()));
    }
    if (!lens.light.response.empty()) {
        std::vector<double> response;
        for (const double value : lens.light.response) response.push_back(rounded(value, 1e5));
        TRY(document.set({"camera", "response"}, response));
        if (lens.light.hotPixels.empty()) {
            TRY(document.erase({"camera", "hot_pixels"}));
        } else {
            std::vector<glm::dvec2> pixels(lens.light.hotPixels.begin(), lens.light.hotPixels.end());
            TRY(document.set({"camera", "hot_pixels"}, pixels));
        }
    }
    return document.save();
}

std::string lensMismatch(const show::Site& site, const CameraDescription& camera) {
    if (!site.nominalCamera || site.nominalCamera->lensOf.empty() || camera.card.empty()) return "";
    const std::string &its = site.nominalCamera->lensOf, here = identityOf(camera);
    if (its == here) return "";
    return fmt::format(
        "the lens in {} is that of '{}', the camera is '{}'; take its kept lens with 'fantascope lens SITE --kept "
        "--write', or measure it with 'fantascope lens SITE --write'",
        site.file.string(), its, here);
}

}  // namespace fantascope::app
