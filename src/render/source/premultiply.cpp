#include "render/source/premultiply.h"

#include <array>
#include <cmath>

namespace fantascope::render {
namespace {

// [alpha][stored value]
using Table = std::array<std::array<std::uint8_t, 256>, 256>;

Table makeTable() {
    Table table{};
    for (std::size_t alpha = 0; alpha < 256; ++alpha)
        for (std::size_t value = 0; value < 256; ++value) {
            const float light = linearFromSrgb(static_cast<float>(value) / 255) * static_cast<float>(alpha) / 255;
            table[alpha][value] = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(light)));
        }
    return table;
}

}  // namespace

void premultiply(std::span<Rgba8> pixels) {
    static const Table kTable = makeTable();
    for (Rgba8& pixel : pixels) {
        if (pixel.a == 255) continue;
        const auto& row = kTable[pixel.a];
        pixel = {row[pixel.r], row[pixel.g], row[pixel.b], pixel.a};
    }
}

}  // namespace fantascope::render
