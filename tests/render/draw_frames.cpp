// draw_frames FILE: writes the stored values of some frames of a crossfade between two swaying
// patterns, so that processes can be compared.

#include "render/scene.h"

#include "core/file.h"

#include <string>

int main(int count, char** arguments) {
    using namespace fantascope;
    using namespace fantascope::render;
    if (count != 2) return 2;
    constexpr glm::ivec2 kSize{480, 270};
    pattern::ShapePattern other = smallPattern();
    other.seed = 8;
    DrawnOutput output(kSize, keystone(kSize), {moving(smallPattern()), moving(other)});
    std::string bytes;
    for (int frame = 0; frame < 4; ++frame) {
        const float progress = static_cast<float>(frame) / 3;
        const RgbaImage& image = output.frame({{0, 1 - progress}, {1, progress}}, tickTime(frame, 2));
        bytes.append(reinterpret_cast<const char*>(image.pixels().data()), image.pixels().size_bytes());
    }
    return writeFile(arguments[1], bytes) ? 0 : 1;
}
