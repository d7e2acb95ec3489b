#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/mask/bit_mask.h"

#include "core/result.h"
#include "media/mesh.h"
#include "media/solid.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::theatre {

// A cast as one solid that a printer makes, and that throws the same shadow before a small lamp
// (Won & Lee 2016, section 6, "3D Fabrication"): people, platforms and props united, what is
// thinner than a wall made thicker, feet joined to a base plate and reinforced where they are
// small. Lengths are millimetres of the print. Its frame: the origin in the middle of the plate's
// upper side, which is the stage's floor; x to the right as seen from the lamp, y towards the
// screen, z up. The same input, the same bytes.
struct Fabrication {
    struct Options {
        double height = 100;  // from the floor to the highest point
        double plate = 0;     // thickness; 0: 3, and of a high print 4 % of its height
        double margin = 8;    // of the plate around what stands on it
        double wall = 1.2;    // the thinnest that the printer makes well
        double cell = 0;      // of the grid; 0: cellFor(height, wall)
        Result<void> check() const;
    };
    static double cellFor(double height, double wall);

    // Where a part stands on the plate or on a platform.
    struct Contact {
        std::string who;  // "actor 2, left ankle"
        glm::dvec2 place{0};
        double area = 0;                    // of what bears
        double gap = 0;                     // height above the ground, which was closed; negative: depth in the ground
        double reinforcedBy = 0;            // how far a foot was added around it; 0: it is large enough
        std::vector<glm::dvec2> outline{};  // of what bears: convex
    };
    // A body part that was thinner than the wall.
    struct ThinPart {
        std::string who;
        double thickness = 0;  // the median of its thin places
        double height = 0;     // of a print in which that is as thick as the wall
    };
    // Holds an actor or a thing that nothing bears.
    struct Rod {
        std::string who;
        double length = 0;
    };

    TriangleMesh mesh;
    double scale = 0;  // millimetres a metre of the stage
    double cell = 0;
    glm::dvec3 stageOrigin{0};                   // where the print's origin is on the stage, metres
    glm::dvec3 light{0};                         // in the print's frame
    double screen = 0;                           // the y of the screen
    std::vector<glm::dvec2> plate;               // its outline, anticlockwise
    double thickness = 0;                        // of the plate
    std::vector<std::vector<glm::dvec2>> marks;  // lines engraved in it: the arrow to the lamp, and one along the screen
    std::vector<Contact> contacts;
    std::vector<ThinPart> thin;
    std::vector<Rod> rods;
    std::vector<std::string> warnings;
    SolidCheck check;
    // Thinnest wall found; equals `wall` and an empty name if none is thinner. A wall is measured
    // between two surfaces, through the middle of the solid that they bound.
    double thinnestWall = 0;
    std::string thinnestWallAt{};
    // The share of the surface that has another surface straight behind it, nearer than `wall`;
    // sharp edges count.
    double shareBelowWall = 0;
    double shadowIou = 0;  // of its shadow and the poses', above the floor
    double targetIou = 0;  // of its shadow and the target's
    double posesIou = 0;   // of the poses' shadow and the target's
    BitMask shadow;        // of the print

    glm::dvec3 fromStage(const glm::dvec3& point) const {
        const glm::dvec3 d = scale * (point - stageOrigin);
        return {d.x, -d.z, d.y};
    }
};

struct FabricationWatch {
    std::function<void(double share, const char* what)> tell;
    std::function<bool()> askStop;
};

// `problem` has skins; `dofs` of all actors, one after the other. Error: options that cannot be,
// nothing higher than a hand above the floor, a grid beyond what a machine holds, or it was
// stopped.
Result<Fabrication> fabricate(const PoseProblem& problem, std::span<const double> dofs, const Fabrication::Options& options,
                              const FabricationWatch& watch);

}  // namespace fantascope::theatre
