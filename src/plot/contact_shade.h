#pragma once

#include "media/image.h"
#include "plot/stage_view.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace fantascope::plot {

// How much of the sky actors and props hide from the floor, on a grid: the sum of the form factors
// of all surface pieces that face a place. Metres, the stage's frame. Thread: const methods are
// reentrant.
class ContactShade {
public:
    explicit ContactShade(const StageView& view);

    // 0 where nothing is hidden, 1 where all of the sky is; may exceed 1.
    float at(const glm::vec3& place) const;

private:
    void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
    void spread(const glm::vec3& place, const glm::vec3& area);

    glm::vec2 origin_{0};
    GreyImage shade_;
};

}  // namespace fantascope::plot
