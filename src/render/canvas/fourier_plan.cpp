#include "render/canvas/fourier_plan.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace fantascope::render {
namespace {

using Complex = std::complex<double>;

// A transform's radices, in falling order, and its length.
struct Passes {
    std::vector<int> radices;
    long long length = 1;
    long long cost() const { return length * static_cast<long long>(radices.size()); }
};

// Extends `begun` by further radices until there are enough points; keeps the cheapest result in
// `best`.
void extend(const Passes& begun, int points, Passes& best) {
    if (begun.length >= points && !begun.radices.empty()) {
        if (best.radices.empty() || begun.cost() < best.cost()) best = begun;
        return;
    }
    for (const int radix : FourierPlan::kRadices) {
        if (!begun.radices.empty() && radix > begun.radices.back()) break;
        Passes next = begun;
        next.radices.push_back(radix);
        next.length *= radix;
        extend(next, points, best);
    }
}

// e^(-2 pi i k / n) for all k below n.
std::vector<Complex> unitRoots(int n) {
    std::vector<Complex> roots;
    for (int k = 0; k < n; ++k) roots.push_back(std::polar(1.0, -2 * std::numbers::pi * k / n));
    return roots;
}

}  // namespace

FourierPlan::FourierPlan(int points) {
    FANTASCOPE_CHECK(points > 0, "a transform has at least one point");
    Passes best;
    extend({}, points, best);
    radices_ = best.radices;
    length_ = static_cast<int>(best.length);
}

int FourierPlan::frequencyAt(int place) const {
    int frequency = 0, span = length_, step = 1;
    for (const int radix : radices_) {
        span /= radix;
        frequency += place / span * step;
        place %= span;
        step *= radix;
    }
    return frequency;
}

std::vector<std::complex<float>> filterSpectrum(const GreyImage& filter, const FourierPlan& rows, const FourierPlan& columns) {
    FANTASCOPE_CHECK(filter.width() % 2 == 1 && filter.height() % 2 == 1, "a filter's sides are odd");
    const auto width = static_cast<std::size_t>(rows.length());
    const std::vector<Complex> rootsOfRows = unitRoots(rows.length()), rootsOfColumns = unitRoots(columns.length());
    const auto root = [](const std::vector<Complex>& roots, int frequency, int at) {
        const auto n = static_cast<long long>(roots.size());
        return roots[static_cast<std::size_t>(((static_cast<long long>(frequency) * at) % n + n) % n)];
    };
    // Transforms every row of the filter, then every column of the result.
    std::vector<std::vector<Complex>> ofRows(static_cast<std::size_t>(filter.height()), std::vector<Complex>(width));
    for (int y = 0; y < filter.height(); ++y)
        for (int place = 0; place < rows.length(); ++place) {
            Complex& sum = ofRows[static_cast<std::size_t>(y)][static_cast<std::size_t>(place)];
            for (int x = 0; x < filter.width(); ++x)
                sum += static_cast<double>(filter.at(x, y)) * root(rootsOfRows, rows.frequencyAt(place), x - filter.width() / 2);
        }
    std::vector<std::complex<float>> spectrum;
    const double points = static_cast<double>(rows.length()) * columns.length();
    std::vector<Complex> sums(width);
    for (int place = 0; place < columns.length(); ++place) {
        std::fill(sums.begin(), sums.end(), Complex(0));
        for (int y = 0; y < filter.height(); ++y) {
            const Complex factor = root(rootsOfColumns, columns.frequencyAt(place), y - filter.height() / 2);
            for (std::size_t x = 0; x < width; ++x) sums[x] += factor * ofRows[static_cast<std::size_t>(y)][x];
        }
        for (const Complex sum : sums) spectrum.emplace_back(sum / points);
    }
    return spectrum;
}

}  // namespace fantascope::render
