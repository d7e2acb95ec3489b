#include "theatre/search/troupe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace fantascope::theatre {
namespace {

constexpr auto kMost = Troupe::kMostActors;

// The number of actors of kStature that these people are equivalent to.
double weightOf(std::span<const double> statures) {
    double sum = 0;
    for (const double stature : statures) sum += stature * stature / (Troupe::kStature * Troupe::kStature);
    return sum;
}

std::string people(double count) { return fmt::format("{:.0f} actor{}", count, count == 1 ? "" : "s"); }

// The option for heights at which these people have neither too little nor too much of the
// silhouette, rounded inwards to centimetres. Empty if there is none.
std::string heightsThatFit(double area, double weight) {
    const double least = std::max(Troupe::kLeastHeight, std::sqrt(Troupe::kLeastShare * weight / area));
    const double most = std::min(Troupe::kMostHeight, std::sqrt(Troupe::kMostShare * weight / area));
    if (least > most) return "";
    return fmt::format("--height {:.2f} .. {:.2f}", std::ceil(100 * least) / 100, std::floor(100 * most) / 100);
}

// The option for numbers of actors that fit this height. Empty if there is none.
std::string actorsThatFit(double squareMetres, double weightOfOne) {
    const double least = std::max(1.0, std::ceil(squareMetres / (Troupe::kMostShare * weightOfOne)));
    const double most = std::min(double{kMost}, std::floor(squareMetres / (Troupe::kLeastShare * weightOfOne)));
    if (least > most) return "";
    return least == most ? fmt::format("--actors {:.0f}", least) : fmt::format("--actors {:.0f} .. {:.0f}", least, most);
}

}  // namespace

Result<Troupe> Troupe::of(double area, std::optional<int> actors, std::optional<double> height,
                          std::span<const double> statures) {
    if (actors && (*actors < 1 || *actors > kMostActors))
        return Error(
            fmt::format("--actors {}: 1 .. {} can play, or 'auto' for as many as the silhouette needs", *actors, kMostActors));
    if (height && !(*height >= kLeastHeight && *height <= kMostHeight))
        return Error(fmt::format("--height {}: the silhouette may be {} .. {} metres high on the screen", *height, kLeastHeight,
                                 kMostHeight));
    if (statures.size() > 1) {
        const auto given = static_cast<int>(statures.size());
        if (given > kMostActors || (actors && *actors != given))
            return Error(fmt::format("--stature: {} are given for {}; give one for all or one for each", given,
                                     people(actors.value_or(kMostActors))));
        actors = given;
    }
    const double ofOne = weightOf(statures) / static_cast<double>(statures.size());
    if (!actors) {
        if (!height) height = kUsualHeight;
        const double needed = std::round(area * *height * *height / (kShare * ofOne));
        actors = static_cast<int>(std::clamp(needed, 1.0, double{kMostUnasked}));
    }
    const double weight = ofOne * *actors;
    if (!height) {
        const double wanted = std::sqrt(kShare * weight / area);
        height = std::round(100 * std::clamp(wanted, kLeastHeight, kMostHeight)) / 100;
    }
    const double squareMetres = area * *height * *height, each = squareMetres / weight;
    if (each < kLeastShare || each > kMostShare) {
        std::string advice = heightsThatFit(area, weight);
        if (const std::string others = actorsThatFit(squareMetres, ofOne); !others.empty() && statures.size() == 1)
            advice += (advice.empty() ? "" : ", or ") + others;
        return Error(fmt::format("the silhouette has {:.2f} square metres at a height of {} m, too {} for {}: {}", squareMetres,
                                 *height, each < kLeastShare ? "small" : "large", people(*actors),
                                 advice.empty() ? "give --height and --actors" : "take " + advice));
    }
    Troupe troupe{{statures.begin(), statures.end()}, *height};
    troupe.statures.resize(static_cast<std::size_t>(*actors), statures[0]);
    return troupe;
}

double areaToFill(std::span<const PoseTarget> silhouettes, const Stage& stage) {
    double area = 0;
    for (std::size_t i = 0; i < silhouettes.size(); ++i) {
        const PoseTarget& target = silhouettes[i];
        const double scale = TargetPlace::on(stage, i).scale, rows = 256 / target.refPixelsPerPixel;
        area += scale * scale * target.area / (rows * rows) / static_cast<double>(silhouettes.size());
    }
    return area;
}

Cast::Target targetOn(const Stage& stage, std::size_t beam, double height) {
    if (beam == 0) return {{}, height};
    const auto inCentimetres = [](double metres) { return std::round(100 * metres) / 100; };
    const TargetPlace place = TargetPlace::on(stage, beam);
    return {{},
            std::clamp(inCentimetres(height * place.scale), Troupe::kLeastHeight, Troupe::kMostHeight),
            inCentimetres(place.middle.value_or(stage.lightOnScreen(beam).x))};
}

}  // namespace fantascope::theatre
