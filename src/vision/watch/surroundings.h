#pragma once

#include "vision/watch/usual_by_lamps.h"

#include "media/image.h"

#include <optional>
#include <vector>

namespace fantascope::vision {

// What is seen around the pictures, compared with what is usual there.
struct SurroundingsLight {
    double gain = 1;   // of the light that is usual
    double veil = 0;   // light that is added everywhere, linear
    double level = 1;  // the whole light / the usual
};

// Measures the light of all that the outputs do not light: sky, ground, walls beside the pictures.
// It tells what lies before the camera from what lies on the wall. Thread: thread-bound.
class Surroundings {
public:
    // `mask`: by camera pixel, 1 where no output gives light.
    explicit Surroundings(const GreyImage& mask) : mask_(mask) {}

    // `seen`: by camera pixel, linear light; negative where it is saturated. Nothing: there is too
    // little to see around the pictures, or what is usual is not known yet.
    std::optional<SurroundingsLight> measure(const GreyImage& seen);
    bool isLearning() const;
    // Other lamps change. In a new state, what they add from the last picture to the next ones
    // becomes usual. Nothing: they are changing.
    void lampsChange(const std::optional<LampState>& state);

private:
    void learn(const std::vector<double>& now);

    GreyImage mask_;
    struct Usual {
        std::vector<double> light{};  // by patch; negative: it does not count
        double noise = 0;             // variance of a patch's light, of the camera's noise
        int pictures = 0;             // from which they were learned
    };
    UsualByLamps<Usual> usual_;
    SurroundingsLight now_, kept_;  // at the last measurement, and before the lamps changed
};

}  // namespace fantascope::vision
