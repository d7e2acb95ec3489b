#include "app/lens/light_measurement.h"

#include "show/site/site_fields.h"
#include "vision/camera_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr Time kCameraWithin = 8s;
constexpr int kFrames = 16;   // whose mean is taken
constexpr int kSettling = 8;  // frames after a change that may still show what was before
constexpr int kSteady = 5;    // frames in a row that are dark, or are not
constexpr double kSteps[] = {0.125, 0.25, 0.5, 1, 2, 4};
constexpr double kDarkest = 40, kFewBright = 0.01;  // of 255; the share of brighter pixels in a dark frame
constexpr double kGoodRms = 0.08;
constexpr int kPixelsAcross = 24;  // of the grid whose values tell the response

std::uint8_t brightest(const Rgba8& pixel) { return std::max({pixel.r, pixel.g, pixel.b}); }

bool isDark(const RgbaImage& image) {
    const auto bright = std::ranges::count_if(image.pixels(), [](const Rgba8& pixel) { return brightest(pixel) > kDarkest; });
    return static_cast<double>(bright) < kFewBright * static_cast<double>(image.pixels().size());
}

// The values of a grid of pixels.
std::vector<double> valuesOf(const GreyImage& image) {
    std::vector<double> values;
    const int step = std::max(1, image.width() / kPixelsAcross);
    for (int y = step / 2; y < image.height(); y += step)
        for (int x = step / 2; x < image.width(); x += step) values.push_back(image.at(x, y));
    return values;
}

}  // namespace

std::string LightResult::sentence() const {
    const std::size_t hot = light.hotPixels.size();
    const std::string words = fmt::format("dark level {:.1f} of 255, {} hot {}", dark, hot, hot == 1 ? "pixel" : "pixels");
    if (!trouble.empty()) return fmt::format("{}; the response is taken as sRGB's: {}", words, trouble);
    const auto middle = light.response[light.response.size() / 2];
    return fmt::format(
        "{}; response from {} exposures, which agree to {:.1f} %; half of the stored range is {:.1f} % of the light", words,
        exposures, 100 * rms, 100 * middle);
}

Result<LightMeasurement::Frame> LightMeasurement::next(LensCamera& camera) {
    for (const Time limit = clock_.now() + kCameraWithin; clock_.now() < limit && !camera.hasEnded();) {
        if (!hooks_.goesOn()) return Error("it was ended before the light was measured");
        if (auto frame = camera.next()) return frame;
    }
    const std::string why = camera.status().detail;
    return Error("the camera gives no picture" + (why.empty() ? "; look at its cable" : ": " + why));
}

Result<void> LightMeasurement::await(LensCamera& camera, bool dark, const std::string& what) {
    for (int inARow = 0; inARow < kSteady;) {
        hooks_.tell(dark ? 0.0 : 0.3, what);
        const Frame frame = TRY(next(camera));
        inARow = isDark(frame->image) == dark ? inARow + 1 : 0;
    }
    return {};
}

// The mean of each pixel's brightest channel.
Result<GreyImage> LightMeasurement::mean(LensCamera& camera, int skipped) {
    GreyImage sum;
    for (int i = 0; i < skipped + kFrames; ++i) {
        const Frame frame = TRY(next(camera));
        if (i < skipped) continue;
        const RgbaImage& image = frame->image;
        if (sum.width() != image.width() || sum.height() != image.height()) sum = GreyImage(image.width(), image.height());
        for (std::size_t pixel = 0; pixel < sum.pixels().size(); ++pixel)
            sum.pixels()[pixel] += static_cast<float>(brightest(image.pixels()[pixel])) / kFrames;
    }
    return sum;
}

// Why it was not measured; empty: it was.
std::string LightMeasurement::measureResponse(int middle, LightResult& result) {
    std::vector<vision::ExposedValues> exposures;
    for (const double step : kSteps) {
        const int wanted = std::max(1, static_cast<int>(std::lround(step * middle)));
        hooks_.tell(0.4 + 0.1 * static_cast<double>(exposures.size()),
                    fmt::format("exposing {:.1f} ms; let nothing move", wanted / 10.0));
        auto camera = open_(wanted);
        if (!camera) return camera.error().message();
        const auto image = mean(**camera, kSettling);
        if (!image) return image.error().message();
        const Time time = (*camera)->description().exposure;
        if (time <= Time::zero()) return "the camera does not let its exposure be set";
        if (exposures.empty() || seconds(time) > 1.2 * exposures.back().time)
            exposures.push_back({seconds(time), valuesOf(*image)});
    }
    if (exposures.size() < 3) return "the camera offers too few exposures";
    const auto fit = vision::fitResponse(exposures, result.dark);
    if (!fit) return fit.error().message();
    if (fit->rms > kGoodRms)
        return fmt::format("the exposures contradict each other by {:.0f} %; something moved, or the camera's gain is not locked",
                           100 * fit->rms);
    result.light.response = fit->response;
    result.exposures = static_cast<int>(exposures.size());
    result.rms = fit->rms;
    return "";
}

Result<LightResult> LightMeasurement::measure(int middle) {
    LightResult result;
    {
        const auto camera = TRY(open_(std::nullopt));
        TRY(await(*camera, true, "cover the camera's lens, so that no light enters"));
        hooks_.tell(0.1, "measuring the dark");
        const vision::DarkFrame dark = vision::darkFrameOf(TRY(mean(*camera, 0)));
        if (dark.hotPixels.size() > show::kMostHotPixels)
            return Error(
                fmt::format("{} pixels show light in the dark; cover the lens so that no light enters", dark.hotPixels.size()));
        result.dark = dark.level;
        result.light.hotPixels = dark.hotPixels;
        result.camera = camera->description();
        TRY(await(*camera, false, "uncover the lens, and point it at something still with dark and bright parts"));
    }
    result.trouble = measureResponse(middle, result);
    if (!hooks_.goesOn()) return Error("it was ended before the light was measured");
    if (!result.trouble.empty()) result.light.response = vision::srgbResponse(result.dark);
    return result;
}

}  // namespace fantascope::app
