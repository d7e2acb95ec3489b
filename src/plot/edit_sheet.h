#pragma once

#include "core/warp.h"
#include "plot/sheet.h"
#include "plot/test_picture.h"
#include "plot/wall.h"

#include <glm/vec2.hpp>

#include <functional>
#include <string>
#include <vector>

namespace fantascope::plot {

// What the parts of an edit view share: a sheet in wall pixels, and the canvas on it. Points of the
// unit canvas are in widths and heights of the canvas, 0..1. Thread: thread-bound.
struct EditSheet {
    explicit EditSheet(const EditView& view);

    const EditView& view;
    const Warp& warp;
    const CanvasPart part;  // of the unit canvas that the output shows
    const Wall wall;
    Sheet sheet;
    const double unit;                // Sheet::unit()
    const double light;               // grey value of frame, handles and texts
    std::vector<glm::dvec2> outline;  // of the canvas's part, on the wall
    Box seen{};                       // the bounding box of its visible part, on the wall

    // A point of the part, by shares of its width and height, on the unit canvas.
    glm::dvec2 inPart(glm::dvec2 share) const { return part.low + share * (part.high - part.low); }
    glm::dvec2 onWall(glm::dvec2 unitCanvas) const { return wall.fromProjector(warp.projectorFromCanvas(unitCanvas)); }
    bool isInside(glm::dvec2 point) const;  // the sheet
    double chosenReach() const;             // of the chosen handle, wall pixels

    // Polylines on the wall: a straight line on the canvas, and a circle with a radius in canvas
    // heights.
    std::vector<glm::dvec2> straight(glm::dvec2 from, glm::dvec2 to) const;
    std::vector<glm::dvec2> circle(glm::dvec2 centre, double radius) const;

    // Draws an arrow at the edge that points to a place outside the sheet. `value`: its grey value.
    void pointAt(glm::dvec2 at, const std::string& label, double value, bool chosen);
    // Writes a label below and to the right of a place, or on another side if there is more room.
    // `clear`: distance to keep.
    void labelBeside(glm::dvec2 at, double clear, const std::string& label, bool chosen);

private:
    std::vector<glm::dvec2> curve(const std::function<glm::dvec2(double)>& unitCanvas, int pieces) const;
};

}  // namespace fantascope::plot
