#pragma once
// The figures of Ji et al. 2015 for any pattern and any search.

#include "pattern/shape/shape_pattern.h"

#include "media/image.h"
#include "plot/page.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// The difference of guide and pattern, R = I - I' (section 4.1), in the pattern's resolution: blue
// where only the guide has light, red where only the pattern has, white where they agree. `guide`:
// compared values (pattern::comparedGuide), any resolution.
RgbaImage differencePicture(const pattern::ShapePattern& pattern, const GreyImage& guide);

// Figure 4c: that picture with the evaluation lattice and the cells of a few instances, in the
// default sizes of the paper's method.
Page differenceFigure(const pattern::ShapePattern& pattern, const GreyImage& guide);

// A search's history from its report, with one entry per iteration.
struct SearchHistory {
    std::string method;              // "paper" or "refined"
    std::vector<double> zMin, zMax;  // of the candidates; both are z for the refined method
    std::vector<bool> accepted;
    double zBound = 0;
};
// The plot of Figure 5: the lowest and the highest z of each iteration, and which iterations were
// rejected.
Page searchFigure(const SearchHistory& history);

// Figure 6: the movement of a few instances in the first 20 s: of their groups, their local
// movement, and both together.
Page trajectoriesFigure(const pattern::ShapePattern& pattern);

// The power spectra of excitation and movement, with the model's slope of -2 beta (section 4.2,
// stage 1): for the groups' major axis and for local translation.
Page spectrumFigure(const pattern::ShapePattern& pattern);

// |X_i|^2 for bins 0 .. size / 2 of the samples' discrete Fourier transform.
std::vector<double> powerSpectrum(std::span<const double> samples);

}  // namespace fantascope::plot
