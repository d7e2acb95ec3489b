#pragma once
// The figures of Ji et al. 2015 for a pattern and for a search of one's own.

#include "pattern/shape/shape_pattern.h"

#include "media/image.h"
#include "plot/page.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// What guide and pattern differ by, R = I - I' (section 4.1), in the pattern's resolution: blue
// where the guide alone has light, red where the pattern alone has, white where they agree.
// `guide`: stored values, any resolution.
RgbaImage differencePicture(const pattern::ShapePattern& pattern, const GreyImage& guide);

// Figure 4c: that picture with the evaluation lattice and with the instance cells of a few
// instances, in the sizes that the paper's method has them by default.
Page differenceFigure(const pattern::ShapePattern& pattern, const GreyImage& guide);

// A search's course, as its report has it: an entry an iteration.
struct SearchHistory {
    std::string method;              // "paper" or "refined"
    std::vector<double> zMin, zMax;  // of the candidates; of the refined method both are z
    std::vector<bool> accepted;
    double zBound = 0;
};
// Figure 5's plot: the lowest and the highest z of each iteration, and which iterations were
// rejected.
Page searchFigure(const SearchHistory& history);

// Figure 6: how a few instances move in the first 20 s: their groups, they themselves, and both
// together.
Page trajectoriesFigure(const pattern::ShapePattern& pattern);

// The power of excitation and movement over frequency, with the slope -2 beta of the model (section
// 4.2, stage 1): of the groups' major axis and of the local translation.
Page spectrumFigure(const pattern::ShapePattern& pattern);

// |X_i|^2 for bins 0 .. size / 2 of the samples' discrete Fourier transform.
std::vector<double> powerSpectrum(std::span<const double> samples);

}  // namespace fantascope::plot
