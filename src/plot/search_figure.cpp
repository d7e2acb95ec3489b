#include "plot/chart.h"
#include "plot/figures.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::plot {
namespace {

constexpr glm::dvec3 kBlue{0.12, 0.35, 0.8}, kOrange{0.95, 0.55, 0.1}, kRed{0.85, 0.1, 0.1}, kGrey{0.4, 0.4, 0.4};

}  // namespace

Page searchFigure(const SearchHistory& history) {
    Page page(960, 540);
    const std::size_t count = history.zMin.size();
    std::vector<glm::dvec2> lowest, highest, rejected;
    for (std::size_t i = 0; i < count; ++i) {
        const double iteration = static_cast<double>(i) + 1;
        lowest.push_back({iteration, history.zMin[i]});
        highest.push_back({iteration, history.zMax[i]});
        if (!history.accepted[i]) rejected.push_back(lowest.back());
    }
    const bool refined = history.method == "refined";
    Axis z = axisAround(history.zMax, "z, mean difference from the guide (0 .. 1)");
    Chart chart(page, {80, 50}, {930, 480},
                {0, std::max(1.0, static_cast<double>(count)), refined ? "iteration, of 1000 moves" : "iteration"}, z);
    chart.title(fmt::format("z over {} iterations of the {} method, {} {}", count, history.method, rejected.size(),
                            refined ? "without gain" : "rejected"));
    const Stroke bound{kGrey, 1.2, 1, true};
    chart.line(std::vector<glm::dvec2>{{0, history.zBound}, {std::max(1.0, static_cast<double>(count)), history.zBound}}, bound);
    if (!refined) chart.line(highest, {kOrange, 1});
    chart.line(lowest, {kBlue, 1.4});
    chart.discs(rejected, count > 300 ? 1.2 : 2.5, kRed);
    if (!refined) chart.legend("highest z of the candidates", {kOrange});
    chart.legend(refined ? "z" : "lowest z of the candidates", {kBlue});
    chart.legend(refined ? "no better than before" : "rejected", {kRed});
    chart.legend("lower bound of z for white shapes on black", bound);
    return page;
}

}  // namespace fantascope::plot
