#pragma once

#include "theatre/print/fabrication.h"

#include "media/image.h"
#include "plot/page.h"

namespace fantascope::plot {

// The print on a table, seen from beside its lamp.
RgbaImage fabricationView(const theatre::Fabrication& print, int width, int height);

// How to set it up, on A4: plan and side view to scale, the distances of lamp and screen in
// millimetres, the silhouette's place on the screen, and a bar to check that the printer did not
// scale the page. For Page::writeAsPaper().
Page fabricationSheet(const theatre::Fabrication& print, const theatre::PoseTarget& target);

}  // namespace fantascope::plot
