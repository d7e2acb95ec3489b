#pragma once

#include "theatre/energy/scene_energy.h"
#include "theatre/print/fabrication.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::theatre {

// The first stage of a print: what is printed, where it stands and on which plate. Everything is in
// the solid's frame: millimetres, the stage's axes, the floor at y = 0, the origin under the
// plate's middle.

constexpr double kPrintedLow = 0.01;    // metres of the stage: a part no higher has a negligible shadow
constexpr double kPrintedMark = 1;      // width of engraved lines, mm
constexpr double kPrintedFigure = 100;  // height of the print for which reinforcement lengths are given, mm

struct PrintFrame {
    double scale = 0;           // millimetres a metre of the stage
    glm::dvec3 stageOrigin{0};  // the solid's origin on the stage, metres

    glm::dvec3 inSolid(const glm::dvec3& onStage) const { return scale * (onStage - stageOrigin); }
    glm::dvec3 onStage(const glm::dvec3& inSolid) const { return stageOrigin + inSolid / scale; }
};

// An actor, a platform or a prop, with its mesh in the solid's frame.
struct PrintPiece {
    std::string name;
    std::optional<std::size_t> actor{};
    bool isPlatform = false;
    TriangleMesh mesh{};
};

// A part of a piece that stands on the plate or on a platform.
struct Footing {
    std::size_t piece = 0;
    double ground = 0;  // height of the ground under it, mm
    std::vector<glm::dvec3> bearing{};
    Fabrication::Contact contact{};  // (x, z)
};

struct PrintLayout {
    PrintFrame frame;
    std::vector<PrintPiece> pieces{};
    std::vector<Footing> footings{};
    std::vector<glm::dvec2> hull{};                // (x, z) hull of everything on the plate; the plate is wider by its margin
    std::vector<std::vector<glm::dvec2>> marks{};  // (x, z), lines that are engraved
    std::vector<std::string> warnings{};

    // The piece with the vertex nearest to a place.
    const PrintPiece& pieceAt(const glm::dvec3& place) const;
    // The name of a piece. For an actor also the joint with the largest share of the skin's vertex
    // nearest to a place.
    static std::string partAt(const PoseProblem& problem, const PrintPiece& piece, const glm::dvec3& place);
};

// `scene` must be posed. Error: nothing more than 5 cm above the floor.
Result<PrintLayout> layOut(const PoseProblem& problem, const SceneEnergy& scene, const Fabrication::Options& options);

}  // namespace fantascope::theatre
