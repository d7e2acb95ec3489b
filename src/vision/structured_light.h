#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fantascope::vision {

// Structured light: pictures that tell every camera pixel which projector pixel lights it. A Gray
// code says in which stripe of the projector's picture (Inokuchi et al. 1984), the phase of a
// shifted sinusoid says where within the stripe (Sansoni et al. 1999).
//
// Every picture has a complement, in which light and dark are exchanged. Only the difference of the
// two counts, divided by the full light: it does not depend on other light or on the wall's colour.
// The sum of the two equals that of the full and the dark picture. Where it does not, something
// moved in between.
class StructuredLight {
public:
    enum class Axis { Across, Down };
    // A picture and its complement.
    struct Pair {
        enum class Kind { Full, Code, Phase };
        Kind kind = Kind::Full;    // Full: everything lit; the complement is dark
        Axis axis = Axis::Across;  // along which the picture varies
        int index = 0;             // Code: the bit, coarsest first; Phase: the shift, in sixths of a period
    };

    // `projector`: its pixels, each side >= 2. `period`: of the sinusoid, projector pixels, even.
    StructuredLight(glm::ivec2 projector, int period);

    // The shortest period that a camera sees well. `cameraPixels`: how many of its pixels the
    // projector lights.
    static int periodFor(glm::ivec2 projector, double cameraPixels);

    glm::ivec2 projector() const { return projector_; }
    int period() const { return period_; }
    int bits(Axis axis) const;
    // In the order in which they are best shown: the full picture first.
    const std::vector<Pair>& pairs() const { return pairs_; }
    // The index of the pair of the sinusoid along an axis that is not shifted.
    std::size_t firstPhase(Axis axis) const;
    // A pair's picture in stored values, to be sent to a projector whose light is stored ^ gamma.
    RgbaImage picture(std::size_t pair, bool complement, double gamma) const;

    // The sinusoid is shown at so many shifts, half of them as complements.
    static constexpr int kShifts = 6;

private:
    glm::ivec2 projector_;
    int period_;
    std::vector<Pair> pairs_;
};

// Which projector pixel lights each pixel of the camera's picture.
struct ProjectorMap {
    Image<glm::vec2> at;             // by camera pixel: projector pixels from the top left; NaN: unknown
    GreyImage light;                 // how bright the projector's full light is there, linear; 0: not lit
    std::size_t lit = 0, known = 0;  // camera pixels that the projector lights, and those that are known

    bool isKnown(int x, int y) const { return at.at(x, y).x == at.at(x, y).x; }
};

// Decodes what a camera saw of structured light. A pixel in which something moved stays undecided;
// the same pair can be taken again to decide it. Thread: thread-bound.
class LightDecoder {
public:
    // `camera`: pixels of its picture.
    LightDecoder(StructuredLight light, glm::ivec2 camera);

    // Takes the camera's pictures of a pair, linear light, `camera` pixels each; 1 is a saturated
    // pixel, which is not decoded. The full pair comes first, best several times: a pixel's median
    // counts. Another pair that is taken again decides only pixels that were undecided.
    void take(std::size_t pair, const GreyImage& picture, const GreyImage& complement);
    // The share of the lit pixels that a pair left undecided, 0..1; 1 if it was not taken.
    double undecided(std::size_t pair) const;
    // How many camera pixels the projector lights; 0 before the full pair.
    std::size_t lit() const { return litCount_; }
    // The indices of these pixels, row by row.
    std::vector<std::size_t> litPixels() const;
    // How many times brighter a typical lit pixel's full light is than the noise; 0 if none is lit.
    double contrast() const;
    // The pixels' usual light under the full and the dark picture.
    const GreyImage& full() const { return full_; }
    const GreyImage& dark() const { return dark_; }
    // Camera pixels that the projector's full light saturates.
    std::size_t saturated() const { return saturatedCount_; }

    ProjectorMap map() const;

private:
    // The differences of a pair; NaN where it is undecided.
    struct Difference {
        GreyImage value;
        std::size_t decided = 0;
    };
    void takeFull(const GreyImage& picture, const GreyImage& complement);
    float position(StructuredLight::Axis axis, int x, int y) const;

    StructuredLight light_;
    glm::ivec2 camera_;
    std::vector<GreyImage> fulls_, darks_;
    GreyImage full_, dark_;  // the pixels' medians
    Image<std::uint8_t> lit_;
    std::size_t litCount_ = 0;
    std::size_t saturatedCount_ = 0;
    double noise_ = 0;
    std::vector<Difference> differences_;  // by pair
};

}  // namespace fantascope::vision
