#pragma once
// The figures of Won & Lee 2016 for any cast. All masks of a figure have the same size.

#include "theatre/mask/bit_mask.h"

#include "media/image.h"
#include "plot/page.h"
#include "plot/stage_view.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// One actor's shadow on the screen. His colour is actorColour() of his index in the list.
struct ActorShadow {
    theatre::BitMask mask;
    std::string name;                // "actor 1, 1.75 m"
    std::vector<std::string> notes;  // lines below his picture in actorsFigure()
};

// The stage, 1280 pixels wide, with each actor's number.
inline constexpr double kStageAspect = 2;
Page stageFigure(const StageView& view, const Camera& camera);

// The shadow, coloured by who throws it: in each actor's colour, darker and mixed where several do.
// Missed parts of the target are hatched in red, shadow outside it in black. Has the target's
// outline, a legend and `lines`. The picture is cropped to its content and scaled to fit into 760 x
// 600 points. At most 63 actors.
Page shadowFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target, std::span<const std::string> lines);

// Figure 9: each actor's shadow alone, the others' in grey.
Page actorsFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target);

// Figure 8: solutions to choose from, each with a view of its stage (kCellView pixels), its shadow
// and some lines, the first line in the largest font.
inline constexpr glm::ivec2 kCellView{360, 240};
struct SolutionCell {
    RgbaImage view;
    std::vector<ActorShadow> actors;
    std::vector<std::string> lines;
};
Page solutionsFigure(std::span<const SolutionCell> solutions, const theatre::BitMask& target);

// One page with all pages below each other.
Page stacked(std::span<const Page> pages);

}  // namespace fantascope::plot
