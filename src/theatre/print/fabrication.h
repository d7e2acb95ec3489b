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

// A cast as one solid for a 3D printer, which throws the same shadow in front of a small lamp (Won
// & Lee 2016, section 6, "3D Fabrication"). People, platforms and props are united. Parts thinner
// than a wall are thickened. Feet are joined to a base plate, and reinforced if they are small.
// Lengths are millimetres of the print. Its frame: the origin is in the middle of the plate's upper
// side, which is the stage's floor; x to the right as seen from the lamp, y towards the screen, z
// up. The same input gives the same bytes.
struct Fabrication {
    struct Options {
        double height = 100;  // from the floor to the highest point
        double plate = 0;     // thickness; 0: 3 mm, or 4 % of the height if that is more
        double margin = 8;    // of the plate around everything that stands on it
        double wall = 1.2;    // the thinnest wall that the printer makes well
        double cell = 0;      // of the grid; 0: cellFor(height, wall)
        Result<void> check() const;
    };
    static double cellFor(double height, double wall);

    // Where a part stands on the plate or on a platform.
    struct Contact {
        std::string who;  // "actor 2, left ankle"
        glm::dvec2 place{0};
        double area = 0;                    // of the bearing surface, square millimetres
        double gap = 0;                     // height above the ground, a gap that the print closes; negative: depth in the ground
        double reinforcedBy = 0;            // width of the foot that was added around it; 0: it is large enough
        std::vector<glm::dvec2> outline{};  // convex hull of the bearing surface
    };
    // A body part that was thinner than the wall.
    struct ThinPart {
        std::string who;
        double thickness = 0;  // the median of its thin places
        double height = 0;     // height of a print in which that would be as thick as the wall
    };
    // A rod that holds an actor or a thing that touches nothing that stands.
    struct Rod {
        std::string who;
        double length = 0;
    };

    TriangleMesh mesh;
    double scale = 0;  // millimetres of the print per metre of the stage
    double cell = 0;
    glm::dvec3 stageOrigin{0};                   // the print's origin on the stage, metres
    glm::dvec3 light{0};                         // in the print's frame
    double screen = 0;                           // y of the screen in the print's frame
    std::vector<glm::dvec2> plate;               // its outline, anticlockwise
    double thickness = 0;                        // of the plate
    std::vector<std::vector<glm::dvec2>> marks;  // lines engraved in it: the arrow to the lamp, and one along the screen
    std::vector<Contact> contacts;
    std::vector<ThinPart> thin;
    std::vector<Rod> rods;
    std::vector<std::string> warnings;
    SolidCheck check;
    // Thickness of the thinnest wall. Equals `wall`, with an empty name, if no part is thinner. A
    // wall is measured between two surfaces, through the middle of the solid that they bound.
    double thinnestWall = 0;
    std::string thinnestWallAt{};
    // The share of the surface with another surface straight behind it at less than `wall`. Sharp
    // edges count.
    double shareBelowWall = 0;
    double shadowIou = 0;  // intersection over union of its shadow and the poses', above the floor
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

// `problem` must have skins. `dofs`: of all actors, one after the other. Error: invalid options,
// nothing more than 5 cm above the floor, a grid too large for memory, a surface that is not one
// closed solid, or `watch.askStop` gave true.
Result<Fabrication> fabricate(const PoseProblem& problem, std::span<const double> dofs, const Fabrication::Options& options,
                              const FabricationWatch& watch);

}  // namespace fantascope::theatre
