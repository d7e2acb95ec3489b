#pragma once

#include "theatre/print/fabrication.h"

#include "media/image.h"
#include "plot/page.h"

namespace fantascope::plot {

// The print on a table, as somebody sees it who stands beside its lamp.
RgbaImage fabricationView(const theatre::Fabrication& print, int width, int height);

// Where it goes, on A4: plan and side view to scale, with the distances of lamp and screen in
// millimetres, the silhouette's place on the screen, and a bar to check that the printer's driver
// did not scale it. For Page::writeAsPaper().
Page fabricationSheet(const theatre::Fabrication& print, const theatre::PoseTarget& target);

}  // namespace fantascope::plot
