#pragma once
// The figures of Won & Lee 2016 for a cast of one's own. All masks of a figure are of one size.

#include "theatre/mask/bit_mask.h"

#include "media/image.h"
#include "plot/page.h"
#include "plot/stage_view.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// What one actor throws on the screen; his colour is actorColour() of his place in the list.
struct ActorShadow {
    theatre::BitMask mask;
    std::string name;                // "actor 1, 1.75 m"
    std::vector<std::string> notes;  // lines below him in actorsFigure()
};

// The stage in 1280 pixels, each actor with his number.
inline constexpr double kStageAspect = 2;
Page stageFigure(const StageView& view, const Camera& camera);

// The shadow by who throws it: each actor's colour, darker and mixed where several do; hatched in
// red where the target is missed, in black what sticks out of it. With the target's outline, a
// legend and these lines; as large as fits into 760 x 600 points, without the rows and columns in
// which there is nothing. At most 63 actors.
Page shadowFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target, std::span<const std::string> lines);

// Figure 9: each actor's shadow alone, the others' in grey.
Page actorsFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target);

// Figure 8: solutions to choose from, each with a view of its stage (kCellView pixels), its shadow
// and some lines, the first the largest.
inline constexpr glm::ivec2 kCellView{360, 240};
struct SolutionCell {
    RgbaImage view;
    std::vector<ActorShadow> actors;
    std::vector<std::string> lines;
};
Page solutionsFigure(std::span<const SolutionCell> solutions, const theatre::BitMask& target);

// Pages below each other on one.
Page stacked(std::span<const Page> pages);

}  // namespace fantascope::plot
