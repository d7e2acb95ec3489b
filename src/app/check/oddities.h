#pragma once
// What is allowed in a show or a site, but perhaps not meant. Each function adds lines, with their
// places, to `oddities`.

#include "show/cue_list.h"
#include "show/schedule/nights.h"
#include "show/show.h"
#include "show/site/site.h"
#include "show/source_id.h"

#include <string>
#include <vector>

namespace fantascope::app {

// A source whose picture has a shape of its own.
struct ShapedSource {
    const show::Source* source;
    double aspect;  // width / height
    double rows;    // of its picture's pixels; 0: it has none
};
// Sources that are not of the shape of a canvas that shows them, or have far more pixels than that;
// and canvases of unknown shape.
void noteShapes(const show::CueList& cues, const show::BySource<ShapedSource>& shaped, const show::Site& site,
                std::vector<std::string>& oddities);
// Shapes that were found as light cover the white of the drawing. As leaves, their shadows would
// show its negative.
void noteNegatives(const show::Source& source, std::vector<std::string>& oddities);
// Looks, sources and cues that are never seen, and what a look asks of a source that cannot do it.
void noteUnseen(const show::Show& show, std::vector<std::string>& oddities);
// Outputs, fixtures and relays of the site that no look of the show names.
void noteUnnamed(const show::Show& show, const show::Site& site, std::vector<std::string>& oddities);
// Buttons and contacts of the site for lists that the show does not have.
void noteLists(const show::Show& show, const show::Site& site, std::vector<std::string>& oddities);
// Places of a canvas that no output's part shows.
void noteGaps(const show::Site& site, std::vector<std::string>& oddities);
// A schedule that plays nothing.
void noteNights(const show::Show& show, const show::Nights& nights, std::vector<std::string>& oddities);
// A site with simulated devices can be rehearsed, one with real devices can be run. In a mixture
// `run` refuses the simulated devices.
void noteSimulated(const show::Site& site, std::vector<std::string>& oddities);

}  // namespace fantascope::app
