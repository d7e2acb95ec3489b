#include "theatre/mask/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fantascope::theatre {
namespace {

constexpr double kFar = 1e12;

// The lower envelope of parabolas: out[i] = min over j of (i - j)^2 + in[j].
class Envelope {
public:
    void run(std::vector<double>& values) {
        const auto count = static_cast<int>(values.size());
        from_.resize(values.size() + 1);
        apex_.resize(values.size());
        int last = 0;
        apex_[0] = 0, from_[0] = -kFar, from_[1] = kFar;
        const auto value = [&](int i) { return values[static_cast<std::size_t>(i)]; };
        for (int i = 1; i < count; ++i) {
            double cross = 0;
            for (;; --last) {
                const int j = apex_[static_cast<std::size_t>(last)];
                cross = (value(i) + double(i) * i - value(j) - double(j) * j) / (2.0 * (i - j));
                if (cross > from_[static_cast<std::size_t>(last)] || last == 0) break;
            }
            if (cross > from_[static_cast<std::size_t>(last)]) ++last;
            apex_[static_cast<std::size_t>(last)] = i;
            from_[static_cast<std::size_t>(last)] = last == 0 ? -kFar : cross;
            from_[static_cast<std::size_t>(last) + 1] = kFar;
        }
        out_.resize(values.size());
        for (int i = 0, k = 0; i < count; ++i) {
            while (from_[static_cast<std::size_t>(k) + 1] < i) ++k;
            const int j = apex_[static_cast<std::size_t>(k)];
            out_[static_cast<std::size_t>(i)] = double(i - j) * (i - j) + value(j);
        }
        values.swap(out_);
    }

private:
    std::vector<double> from_, out_;
    std::vector<int> apex_;
};

// Squared distances to the nearest pixel that is white, or that is black.
Image<double> squaredDistances(const BitMask& mask, bool toWhite) {
    Image<double> field(mask.width(), mask.height());
    Envelope envelope;
    std::vector<double> line;
    for (int x = 0; x < mask.width(); ++x) {
        line.clear();
        for (int y = 0; y < mask.height(); ++y) line.push_back(mask.at(x, y) == toWhite ? 0 : kFar);
        envelope.run(line);
        for (int y = 0; y < mask.height(); ++y) field.at(x, y) = line[static_cast<std::size_t>(y)];
    }
    for (int y = 0; y < mask.height(); ++y) {
        line.assign(field.row(y).begin(), field.row(y).end());
        envelope.run(line);
        std::copy(line.begin(), line.end(), field.row(y).begin());
    }
    return field;
}

}  // namespace

GreyImage signedDistance(const BitMask& mask) {
    const Image<double> white = squaredDistances(mask, true), black = squaredDistances(mask, false);
    GreyImage distance(mask.width(), mask.height());
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            distance.at(x, y) =
                static_cast<float>(mask.at(x, y) ? std::sqrt(black.at(x, y)) - 0.5 : 0.5 - std::sqrt(white.at(x, y)));
    return distance;
}

BitMask deeperThan(const GreyImage& distance, double depth) {
    BitMask mask(distance.width(), distance.height());
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (distance.at(x, y) > depth) mask.fill(y, x, x + 1);
    return mask;
}

}  // namespace fantascope::theatre
