#pragma once

#include "plot/edit_sheet.h"

namespace fantascope::plot {

// Draws frame, lines of text, outlines of masks, handles and pointer of an edit view.
void drawEditMarks(EditSheet& edit);

}  // namespace fantascope::plot
