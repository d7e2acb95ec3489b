#pragma once

#include "vision/watch/light_meter.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace fantascope::vision {

// How what a surface gives back has changed since the calibration, by blocks of an output's
// picture.
struct WallChange {
    GreyImage factor;  // on what the calibration saw; 1 where nothing is known nearby
    GreyImage sigma;   // standard deviation of that where it was measured; 0: it was not
    double block = 1;  // side of a block, projector pixels; the blocks begin at the top left
    int pictures = 0;  // that it was measured in
    // Bilinear between the middles of blocks. `pixel`: of the projector, where the picture is when
    // nothing has moved.
    double at(glm::dvec2 pixel) const;
};

// Measures that while the show runs, from what is seen and what was predicted. In a block, how much
// light and dark of the picture differ tells what the surface gives back; smooth light of lamps
// does not matter. What is common to all blocks (fog, a dim lamp, the camera's exposure) is divided
// out. A block in which the picture is not found, because somebody stands there, is not measured.
// Of the newest pictures the median counts, so what passes is nothing. Thread: thread-bound.
class WallReflectance {
public:
    static constexpr int kPictures = 40;  // that the median is taken of

    // Adds a picture, whose place is known. False: it shows too little.
    bool add(const LightMeter::Sight& sight);
    int pictures() const { return static_cast<int>(pictures_.size()); }
    // `cell`: side of a cell, projector pixels.
    WallChange change(double cell) const;

private:
    glm::ivec2 blocks_{0};
    std::vector<std::vector<float>> pictures_;  // newest last: by block the factor; 0: it was not measured
};

}  // namespace fantascope::vision
