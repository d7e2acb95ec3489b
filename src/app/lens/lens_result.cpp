#include "app/lens/lens_result.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::app {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Pixels; views that miss by more come from a bent board, or from another model of lens.
double goodRms(glm::ivec2 size) { return std::max(0.7, 1e-3 * size.x); }

// Whether the board has the same tilt in all views, or nearly so.
bool areAlike(const vision::LensFit& fit) {
    const double least = std::cos(vision::kLeastTilt * kDegree);
    const auto isLike = [&](const vision::LensFit::View& a, const vision::LensFit::View& b) {
        return !a.used || !b.used || glm::dot(a.normal, b.normal) > least;
    };
    return std::ranges::all_of(
        fit.views, [&](const auto& a) { return std::ranges::all_of(fit.views, [&](const auto& b) { return isLike(a, b); }); });
}

std::string troubleOf(const LensResult& result) {
    const vision::LensFit& fit = result.fit;
    if (result.views < vision::kFewestViews)
        return fmt::format("only {} views fit together, {} are needed; take more, all over the picture and tilted to all sides",
                           result.views, vision::kFewestViews);
    if (fit.rms > goodRms(fit.lens.size))
        return fmt::format(
            "it misses the board's corners by {:.2f} px, {:.2f} are allowed; glue the board flat on a stiff plate, and "
            "hold it still. A fish-eye lens cannot be described",
            fit.rms, goodRms(fit.lens.size));
    if (result.needs.isUncertain && areAlike(fit))
        return "all views are alike: the board has the same tilt in each; turn each of its edges towards the camera in turn";
    if (result.needs.isUncertain)
        return fmt::format("it is known to {:.1f} px only, {:.1f} are needed; {}", fit.uncertainty,
                           vision::goodUncertainty(fit.lens.size), result.needs.sentence());
    const auto model = vision::CameraModel::fromFieldOfView(Pose(), fit.lens.size, fit.lens.fieldOfView(), fit.lens.k1,
                                                            fit.lens.k2, fit.lens.centre);
    return model ? "" : model.error().message();
}

}  // namespace

std::string LensResult::sentence() const {
    const vision::CameraModel& lens = fit.lens;
    std::string words = fmt::format(
        "rms {:.2f} px over {} views ({} corners); field of view {:.2f} degrees, centre {:.1f}, {:.1f}, k1 {:.4f}, k2 {:.4f}; "
        "known to {:.2f} px",
        fit.rms, views, fit.points, lens.fieldOfView() / kDegree, lens.centre.x, lens.centre.y, lens.k1, lens.k2,
        fit.uncertainty);
    if (leftOut > 0) words += fmt::format("; {} {} not fit the others", leftOut, leftOut == 1 ? "view does" : "views do");
    if (!trouble.empty()) words += "; not good enough: " + trouble;
    return words;
}

Report LensResult::report() const {
    Report report;
    report["rms_px"] = fit.rms;
    report["uncertainty_px"] = fit.uncertainty;
    report["views"] = views;
    report["left_out"] = leftOut;
    report["corners"] = fit.points;
    report["size"] = {fit.lens.size.x, fit.lens.size.y};
    report["field_of_view"] = fit.lens.fieldOfView() / kDegree;
    report["centre"] = {fit.lens.centre.x, fit.lens.centre.y};
    report["k1"] = fit.lens.k1;
    report["k2"] = fit.lens.k2;
    report["unseen"] = needs.places;
    if (!trouble.empty()) report["trouble"] = trouble;
    return report;
}

Result<LensResult> lensOf(const std::vector<vision::BoardView>& views, const Missed& missed, int leftOut) {
    if (views.empty()) return Error(missed.pictures > 0 ? missed.why() : "there was no picture");
    if (static_cast<int>(views.size()) < vision::kFewestFitted)
        return Error(fmt::format(
            "the board was found in {} {} only, {} are needed; {}", views.size(), views.size() == 1 ? "picture" : "pictures",
            vision::kFewestViews,
            missed.pictures > 0 ? "in the others, " + missed.why() : "take more, all over the picture and tilted to all sides"));
    LensResult result;
    result.fit = TRY(vision::fitLens(views));
    result.needs = vision::needsOf(views, &result.fit);
    result.views = result.fit.usedViews();
    result.leftOut = leftOut + static_cast<int>(views.size()) - result.views;
    result.trouble = troubleOf(result);
    return result;
}

}  // namespace fantascope::app
