#include "render/golden.h"

#include "render/scene.h"

#include "source_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
constexpr double kMaxRms = 1.5;
constexpr int kMaxDifference = 140;  // one white sample of four on black is stored as 137

// Golden, new, and eight times their difference, side by side.
RgbaImage sideBySide(const RgbaImage& golden, const RgbaImage& image) {
    RgbaImage all(3 * image.width(), image.height());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const Rgba8 old = golden.at(x, y), now = image.at(x, y);
            const auto apart = [](int a, int b) { return static_cast<std::uint8_t>(std::min(8 * std::abs(a - b), 255)); };
            all.at(x, y) = old;
            all.at(image.width() + x, y) = now;
            all.at(2 * image.width() + x, y) = {apart(old.r, now.r), apart(old.g, now.g), apart(old.b, now.b), 255};
        }
    return all;
}

}  // namespace

std::string differsVisibly(const RgbaImage& golden, const RgbaImage& image) {
    const render::Difference apart = render::difference(golden, image);
    if (apart.rms <= kMaxRms && apart.most <= kMaxDifference) return "";
    return fmt::format("rms {:.2f} ({} is allowed), at most {} ({})", apart.rms, kMaxRms, apart.most, kMaxDifference);
}

testing::AssertionResult looksLikeGolden(const std::string& name, const RgbaImage& image) {
    const fs::path goldenFile = fs::path(sourceFolder() + "/tests/golden") / (name + ".png");
    const fs::path output = FANTASCOPE_GOLDEN_OUTPUT;
    const fs::path newFile = output / (name + ".png"), compareFile = output / (name + ".compare.png");
    fs::remove(newFile);
    fs::remove(compareFile);
    const auto refused = [&](const std::string& why) {
        if (const auto written = writePng(newFile, image); !written)
            return testing::AssertionFailure() << written.error().message();
        return testing::AssertionFailure() << name << ": " << why << "\n  new: " << newFile.string()
                                           << "\n  if it is right, make it golden with tools/approve-golden";
    };

    const auto golden = readRgba(goldenFile);
    if (!golden) return refused(golden.error().message());
    if (golden->width() != image.width() || golden->height() != image.height())
        return refused("it has another size than " + goldenFile.string());
    const std::string apart = differsVisibly(*golden, image);
    if (apart.empty()) return testing::AssertionSuccess();
    if (const auto written = writePng(compareFile, sideBySide(*golden, image)); !written)
        return testing::AssertionFailure() << written.error().message();
    return refused(fmt::format("differs from the golden picture: {}\n  golden: {}\n  compare: {}", apart, goldenFile.string(),
                               compareFile.string()));
}

}  // namespace fantascope
