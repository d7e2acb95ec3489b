#pragma once

#include "vision/structured_light.h"

#include "media/image.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::vision {

// The light of a grey picture.
struct GreyLight {
    double stored = 0;  // 0..1, as it is sent to the projector
    double light = 0;   // above that of the black picture, as a share of white's
};

// The exponent with which light follows stored values. The light of the black picture may be off:
// where a camera's noise is cut off at zero, black looks too bright. Greys that differ much from
// the others do not count: somebody stood before them.
// Nothing: fewer than five greys agree, or they follow no exponent of 1 .. 4.
std::optional<double> fitGamma(std::vector<GreyLight> greys);

// What a projector's primaries add to one pixel of the camera's picture. Linear light.
struct PrimaryLight {
    std::size_t pixel = 0;  // row by row
    glm::mat3 primaries{};  // columns: the projector's red, green and blue; rows: the camera's channels
    glm::vec3 white{};      // of the white picture
};

// Collects the light of a projector's primaries, from the camera's pictures of plain colours. A
// pixel in which something moved stays undecided; the colours can be taken again to decide it.
// Thread: thread-bound.
class PrimarySight {
public:
    // The pictures to show, as shares of the primaries.
    static constexpr std::array<glm::ivec3, 5> kColours = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}};
    using Pictures = std::array<Image<glm::vec3>, kColours.size()>;

    // `sight`: what the camera sees of the projector's white and black.
    explicit PrimarySight(const LightDecoder& sight);

    // Takes the camera's pictures of the colours, linear light, 1 is saturated.
    void take(const Pictures& pictures);
    // The share of the lit pixels that are undecided, 0..1.
    double undecided() const;
    // The pixels that are known, in their order.
    std::vector<PrimaryLight> light() const;

private:
    enum class State : std::uint8_t { Undecided, Known, Saturated };
    struct Pixel {
        State state = State::Undecided;
        float full = 0, dark = 0;
        PrimaryLight light;
    };
    std::vector<Pixel> pixels_;
};

// By output: factors of the primaries, 0..1, with which the whites of all outputs look alike where
// their light overlaps. Of each primary, the weakest output keeps all of it. A camera that tells no
// colours apart makes the whites equally bright. `outputs`: seen by the same camera.
// Nothing: some outputs share too few of the camera's pixels with the others.
std::optional<std::vector<glm::dvec3>> matchedWhites(std::span<const std::vector<PrimaryLight>> outputs);

}  // namespace fantascope::vision
