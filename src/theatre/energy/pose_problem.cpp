#include "theatre/energy/pose_problem.h"

#include "theatre/mask/distance_field.h"
#include "theatre/stage/stage_set.h"

#include "core/disjoint_sets.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fantascope::theatre {
namespace {

constexpr double kMargin = 1.0 / 3;  // around a silhouette, as a share of its height

// A connected component of white pixels (8-connected).
struct Island {
    std::int64_t area = 0;
    glm::ivec2 pixel{0};  // its first in scan order
    int left = 0, right = 0;
};

// Each run of a row is joined with the runs that it touches in the row above. Memory is
// proportional to the number of runs.
std::vector<Island> findIslands(const BitMask& mask) {
    struct Run {
        int from, to;
        std::size_t island;
    };
    std::vector<Island> islands;
    DisjointSets joined;
    std::vector<Run> above, here;
    for (int y = 0; y < mask.height(); ++y) {
        here.clear();
        for (int x = 0; x < mask.width(); ++x) {
            if (!mask.at(x, y)) continue;
            const int from = x;
            while (mask.at(x, y)) ++x;
            here.push_back({from, x, joined.add()});
            islands.push_back({x - from, {from, y}, from, x});
        }
        auto first = above.begin();
        for (const Run& run : here) {
            while (first != above.end() && first->to < run.from) ++first;
            for (auto other = first; other != above.end() && other->from <= run.to; ++other) {
                const auto [keep, gone] = joined.join(other->island, run.island);
                if (keep == gone) continue;
                islands[keep].area += islands[gone].area;
                islands[keep].left = std::min(islands[keep].left, islands[gone].left);
                islands[keep].right = std::max(islands[keep].right, islands[gone].right);
            }
        }
        std::swap(above, here);
    }
    std::vector<Island> whole;
    for (std::size_t i = 0; i < islands.size(); ++i)
        if (joined.root(i) == i) whole.push_back(islands[i]);
    return whole;
}

void sampleContour(PoseTarget& target, std::size_t points) {
    target.area = static_cast<double>(target.mask.count());
    const ContourDisc disc(std::max(1.0, kDiscRadius / target.refPixelsPerPixel));
    for (const glm::ivec2 point : sampled(outerContour(target.mask), points))
        target.contour.push_back(disc.at(target.mask, point));
}

// A picture's silhouette, row 0 at the top.
struct Silhouette {
    BitMask mask;
    int left = 0, right = 0, top = 0, bottom = 0;  // bounding box: columns [left, right), rows [top, bottom)
};

Result<Silhouette> silhouetteOf(const GreyImage& picture) {
    TRY(PoseTarget::checkSize(picture.width(), picture.height()));
    Silhouette found{BitMask(picture.width(), picture.height()), picture.width()};
    BitMask& whole = found.mask;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            if (picture.at(x, y) > 0.5f) whole.fill(y, x, x + 1);
    if (whole.count() == 0) return Error("nothing in it is white; a silhouette is white on black");
    if (whole.count() == std::int64_t{picture.width()} * picture.height())
        return Error("all of it is white; a silhouette is white on black, with some black around");
    for (const Island& island : findIslands(whole)) {
        if (island.area < PoseTarget::kFewest)
            return Error(fmt::format(
                "at column {}, row {} is a white speck of {} pixels; remove it, or draw it larger: fewer than {} are no "
                "silhouette",
                island.pixel.x, island.pixel.y, island.area, PoseTarget::kFewest));
        found.left = std::min(found.left, island.left), found.right = std::max(found.right, island.right);
    }
    found.top = whole.rowsFrom(), found.bottom = whole.rowsTo();
    if (found.right - found.left > PoseTarget::kWidest * (found.bottom - found.top))
        return Error(
            fmt::format("its silhouette is {} pixels wide and {} high; no more than {} times as wide as high can be played",
                        found.right - found.left, found.bottom - found.top, PoseTarget::kWidest));
    return found;
}

// Error: the silhouette has parts that are too far from each other for people to join.
Result<void> checkIslands(const BitMask& mask, int rows) {
    if (findIslands(mask).size() <= 1) return {};
    // Islands are near enough if they are connected after each is dilated by half of the allowed
    // distance.
    const BitMask joined = deeperThan(signedDistance(mask), -0.5 * PoseTarget::kFarApart * rows);
    if (const std::size_t apart = findIslands(joined).size(); apart > 1)
        return Error(
            fmt::format("it has {} parts that are farther from each other than {:.0f} % of its height; join them, or play each "
                        "as a target of its own",
                        apart, 100 * PoseTarget::kFarApart));
    return {};
}

// Whether a pixel is white, by the majority of 3 x 3 samples. `isWhite(dx, dy)` samples at that
// offset into the pixel, 0 .. 1.
template <class IsWhite>
bool isMostlyWhite(IsWhite isWhite) {
    int white = 0;
    for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) white += isWhite((k + 0.5) / 3, (j + 0.5) / 3);
    return white > 4;
}

// The middle of a silhouette along the unrolled screen. Error: the light is beside a curved screen.
Result<double> middleOf(const TargetPlace& place, const Stage& stage) {
    if (place.middle) return *place.middle;
    const glm::dvec3 light = stage.lightOnScreen(place.beam);
    if (const auto middle = unrolledFromFlat(stage.screenOf(place.beam), light, glm::dvec2(light))) return middle->x;
    return Error("its screen is curved, and the light stands beside it; move the light, or make the screen's radius larger");
}

// Error: the light does not reach all of [left, right] x [0, top] of the unrolled screen, because
// of the screen's own curve or another screen.
Result<void> checkWay(const TargetPlace& place, const Stage& stage, double left, double right, double top) {
    if (stage.screens.size() == 1 && !stage.screens[0].isCurved()) return {};
    constexpr int kAlong = 64, kSteps = 64;
    constexpr double kRounding = 1e-6;  // metres
    const Screen& own = stage.screenOf(place.beam);
    const glm::dvec3 light = stage.lightOnScreen(place.beam);
    if (const double most = std::abs(own.radius) * Screen::kMostArc; own.isCurved() && std::max(-left, right) > most)
        return Error(
            fmt::format("its silhouette is to reach from {:.2f} m to {:.2f} m along a screen with a radius of {} m, of which "
                        "{:.2f} m to either side can be seen; make it less high, or the radius larger",
                        left, right, own.radius, most));
    for (int i = 0; i <= kAlong; ++i)
        for (const double y : {0.0, top}) {
            const double x = std::lerp(left, right, double(i) / kAlong);
            if (!flatFromUnrolled(own, light, {x, y}))
                return Error(
                    fmt::format("its silhouette is to reach from {:.2f} m to {:.2f} m along its curved screen, and the light "
                                "does not come to {:.2f} m; move it, make the silhouette less high, or the radius larger",
                                left, right, x));
            const glm::dvec3 from = stage.beams[place.beam].light, to = own.stageFromScreen(own.surface({x, y}));
            glm::dvec3 outward;
            for (std::size_t k = 0; k < stage.screens.size(); ++k)
                for (int step = 0; step <= kSteps; ++step)
                    if (stage.screens[k].distance(glm::mix(from, to, double(step) / kSteps), outward) < -kRounding)
                        return Error(fmt::format(
                            "its silhouette is to reach from {:.2f} m to {:.2f} m along its screen, and screen {} keeps "
                            "the light from {:.2f} m; move either away from the other, or make the silhouette less high",
                            left, right, k + 1, x));
        }
    return {};
}

// Error: [left, right] x [0, top] of the unrolled screen is not entirely in the projector's
// picture, which is measured on the flat screen.
Result<void> checkLit(const TargetPlace& place, const Stage& stage, double left, double right, double top) {
    const auto lit = stage.beams[place.beam].lit;
    if (!lit) return {};
    glm::dvec2 least(left, 0), most(right, top);
    const glm::dvec3 light = stage.lightOnScreen(place.beam);
    for (const double along : {left, 0.5 * (left + right), right})
        for (const double up : {0.0, top})
            if (const auto flat = flatFromUnrolled(stage.screenOf(place.beam), light, {along, up}))
                least = glm::min(least, *flat), most = glm::max(most, *flat);
    // Only the part above the floor must be lit.
    const glm::dvec2 from = lit->from, to = lit->to;
    if (least.x < from.x || most.x > to.x || from.y > 0 || most.y > to.y)
        return Error(
            fmt::format("its silhouette is to be x {:.2f} .. {:.2f} m and y 0 .. {:.2f} m on the screen, and the projector "
                        "lights x {:.2f} .. {:.2f} m "
                        "and y {:.2f} .. {:.2f} m only; make it less high, or the projector's picture larger",
                        least.x, most.x, most.y, from.x, to.x, from.y, to.y));
    return {};
}

// Maps a target from the unrolled screen to the flat one. `isWhite(place)` tells whether the
// silhouette is white at a place of the unrolled screen, metres. The silhouette lies in [left,
// right] x [0, top].
template <class IsWhite>
PoseTarget onFlatScreen(PoseTarget&& laid, const Stage& stage, double left, double right, double top, IsWhite isWhite) {
    const Screen& screen = stage.screenOf(laid.beam);
    const glm::dvec3 light = stage.lightOnScreen(laid.beam);
    // Its bounding box on the flat screen; the box reaches at least down to the floor.
    glm::dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
    constexpr int kAlong = 256;
    for (int i = 0; i <= kAlong; ++i)
        for (const double y : {0.0, top})
            if (const auto at = flatFromUnrolled(screen, light, {std::lerp(left, right, double(i) / kAlong), y}))
                least = glm::min(least, *at), most = glm::max(most, *at);
    const double pixel = laid.frame.pixel();
    const int rows = static_cast<int>(std::lround(256 / laid.refPixelsPerPixel)),
              margin = static_cast<int>(std::lround(kMargin * rows));
    const int columns = static_cast<int>(std::ceil((most.x - least.x) / pixel));
    const int width = columns + 2 * margin, below = static_cast<int>(std::ceil(std::max(0.0, -least.y) / pixel));
    const int above = std::max(rows, static_cast<int>(std::ceil(most.y / pixel))) + margin, height = above + below;
    const double first = 0.5 * (least.x + most.x) - 0.5 * width * pixel;
    PoseTarget target{ScreenFrame(stage, first, above * pixel, pixel, width, height, laid.beam),
                      BitMask(width, height),
                      0,
                      {},
                      laid.refPixelsPerPixel,
                      laid.given,
                      laid.beam,
                      PoseTarget::Unrolled{screen, light, BitMask(width, height), laid.frame, std::move(laid.mask)}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto at = [&](double dx, double dy) {
                const auto place = unrolledFromFlat(screen, light, target.frame.metresAt({x + dx, y + dy}));
                return place && place->y >= 0 ? place : std::nullopt;
            };
            if (!at(0.5, 0.5)) continue;
            target.unrolled->onScreen.fill(y, x, x + 1);
            const auto isWhiteAt = [&](double dx, double dy) {
                const auto place = at(dx, dy);
                return place && isWhite(*place);
            };
            if (isMostlyWhite(isWhiteAt)) target.mask.fill(y, x, x + 1);
        }
    return target;
}

// Turns silhouettes of pictures of one size into targets in one ScreenFrame. Silhouette `by`
// decides the placement and the scale.
Result<std::vector<PoseTarget>> laidOut(std::span<const Silhouette> silhouettes, std::size_t by, const Stage& stage,
                                        double height, int rows, const TargetPlace& place) {
    const Silhouette& measure = silhouettes[by];
    const auto nameOf = [&](std::size_t i) { return silhouettes.size() > 1 ? fmt::format("frame {}", i + 1) : std::string(); };
    int left = measure.left, right = measure.right, top = measure.top;
    for (std::size_t i = 0; i < silhouettes.size(); ++i) {
        const Silhouette& silhouette = silhouettes[i];
        left = std::min(left, silhouette.left), right = std::max(right, silhouette.right), top = std::min(top, silhouette.top);
        if (const int below = silhouette.bottom - measure.bottom; below > PoseTarget::kBelow * (measure.bottom - measure.top))
            return Error(
                fmt::format("{}: its silhouette reaches {} pixels below the floor, which is where frame {} ends; nobody "
                            "throws a shadow there",
                            nameOf(i), below, by + 1));
    }

    // A pixel of the mask is `step` pixels of the picture. Each mask pixel is sampled by area.
    const double step = double(measure.bottom - measure.top) / rows, pixel = height / rows;
    const double middle = 0.5 * (measure.left + measure.right), given = pixel / step;  // a pixel of the picture, metres
    const double half = std::max(middle - left, right - middle) / step, high = (measure.bottom - top) / step;
    const int margin = static_cast<int>(std::lround(kMargin * rows)), columns = static_cast<int>(std::ceil(2 * half));
    const int width = columns + 2 * margin, above = std::max(rows, static_cast<int>(std::ceil(high - 1e-6))) + margin;
    const double x = TRY(middleOf(place, stage)), reach = half * pixel;
    TRY(checkWay(place, stage, x - reach, x + reach, high * pixel));
    TRY(checkLit(place, stage, x - reach, x + reach, high * pixel));
    std::vector<PoseTarget> targets;
    for (std::size_t i = 0; i < silhouettes.size(); ++i) {
        const BitMask& whole = silhouettes[i].mask;
        PoseTarget target{
            ScreenFrame(stage, x - 0.5 * width * pixel, above * pixel, pixel, width, above, place.beam),
            BitMask(width, above),
            0,
            {},
            256.0 / rows,
            ScreenFrame(stage, x - middle * given, measure.bottom * given, given, whole.width(), whole.height(), place.beam),
            place.beam};
        const auto isWhite = [&](double right, double up) {  // from the foot's middle, mask pixels
            return whole.at(static_cast<int>(std::floor(middle + right * step)),
                            static_cast<int>(std::floor(measure.bottom - up * step)));
        };
        for (int y = 0; y < above; ++y)
            for (int column = 0; column < width; ++column)
                if (isMostlyWhite([&](double dx, double dy) { return isWhite(column + dx - 0.5 * width, above - y - dy); }))
                    target.mask.fill(y, column, column + 1);
        auto checked = checkIslands(target.mask, rows);
        if (!checked) return silhouettes.size() > 1 ? checked.error().in(nameOf(i)) : checked.error();
        if (stage.screenOf(place.beam).isCurved())
            target = onFlatScreen(std::move(target), stage, x - reach, x + reach, high * pixel,
                                  [&](const glm::dvec2& at) { return isWhite((at.x - x) / pixel, at.y / pixel); });
        sampleContour(target, std::max<std::size_t>(1, kContourPoints * static_cast<std::size_t>(rows) / 256));
        targets.push_back(std::move(target));
    }
    return targets;
}

void halve(PoseTarget& target, const Stage& stage) { target = target.halved(stage); }

}  // namespace

Result<void> PoseTarget::checkSize(int width, int height) {
    if (std::max(width, height) <= kMostSide) return {};
    return Error(fmt::format("it is {} x {} pixels; no side may have more than {}: scale it down, some 500 are enough", width,
                             height, kMostSide));
}

TargetPlace TargetPlace::on(const Stage& stage, std::size_t beam) {
    if (beam == 0) return {};
    constexpr double kBefore = 1.8;  // distance from the first screen, metres: the middle of a search's start positions
    glm::dvec3 people(stage.beams[0].light.x, 0, std::min(kBefore, 0.5 * stage.beams[0].light.z));
    if (const auto& area = stage.standing) {
        const glm::dvec2 floor = glm::clamp(glm::dvec2(people.x, people.z), area->from, area->to);
        people.x = floor.x, people.z = floor.y;
    }
    const auto larger = [&](std::size_t i) {
        const double light = stage.lightOnScreen(i).z;
        return light / (light - stage.screenOf(i).screenFromStage(people).z);
    };
    const double scale = larger(beam);
    if (!(scale > 0) || !std::isfinite(scale)) return {beam};  // the people are behind the light
    const glm::dvec3 light = stage.lightOnScreen(beam), at = stage.screenOf(beam).screenFromStage(people);
    const auto middle = unrolledFromFlat(stage.screenOf(beam), light, {light.x + scale * (at.x - light.x), light.y});
    if (!middle) return {beam};
    return {beam, middle->x, scale / larger(0)};
}

Result<PoseTarget> PoseTarget::from(const GreyImage& picture, const Stage& stage, double height, int rows,
                                    const TargetPlace& place) {
    const Silhouette silhouette = TRY(silhouetteOf(picture));
    return std::move(TRY(laidOut({&silhouette, 1}, 0, stage, height, rows, place))[0]);
}

void PoseTarget::cut(const Stage& stage, BitMask& shadow) const {
    cutToLit(stage, frame, shadow, beam);
    if (unrolled && shadow.width() > 0) shadow.keep(unrolled->onScreen);
}

BitMask PoseTarget::asSeen(const BitMask& shadow) const {
    if (!unrolled) return shadow;
    BitMask seen(unrolled->mask.width(), unrolled->mask.height());
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x)
            if (const auto flat =
                    flatFromUnrolled(unrolled->screen, unrolled->light, unrolled->frame.metresAt({x + 0.5, y + 0.5}))) {
                const glm::dvec2 pixel = glm::floor(frame.pixelAt(flat->x, flat->y));
                if (shadow.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y))) seen.fill(y, x, x + 1);
            }
    return seen;
}

std::optional<glm::dvec2> PoseTarget::flatFromGiven(glm::dvec2 pixel) const {
    const glm::dvec2 place = given.metresAt(pixel);
    return unrolled ? flatFromUnrolled(unrolled->screen, unrolled->light, place) : place;
}

Result<std::vector<PoseTarget>> PoseTarget::ofSequence(std::span<const GreyImage> pictures, std::size_t representative,
                                                       const Stage& stage, double height, int rows) {
    std::vector<Silhouette> silhouettes;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const auto name = fmt::format("frame {}", i + 1);
        if (pictures[i].width() != pictures[0].width() || pictures[i].height() != pictures[0].height())
            return Error(fmt::format("{}: it is {} x {} pixels, and the first frame {} x {}; all are to be of one size", name,
                                     pictures[i].width(), pictures[i].height(), pictures[0].width(), pictures[0].height()));
        silhouettes.push_back(TRY(silhouetteOf(pictures[i]).in(name)));
    }
    return laidOut(silhouettes, representative, stage, height, rows, {});
}

PoseTarget PoseTarget::halved(const Stage& stage) const {
    const int width = (mask.width() + 1) / 2, height = (mask.height() + 1) / 2;
    const glm::dvec2 leftBottom = frame.metresAt({0, mask.height()});
    const double pixel = 2 * frame.pixel();
    PoseTarget target{ScreenFrame(stage, leftBottom.x, leftBottom.y + height * pixel, pixel, width, height, beam),
                      BitMask(width, height),
                      0,
                      {},
                      2 * refPixelsPerPixel,
                      given,
                      beam,
                      unrolled};
    // Pixels are paired from the floor up. A pixel is white if at least half of it is.
    const int cut = 2 * height - mask.height();
    const auto halve = [&](const BitMask& from) {
        BitMask to(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                int white = 0;
                for (int i = 0; i < 4; ++i) white += from.at(2 * x + i % 2, 2 * y - cut + i / 2);
                if (white >= 2) to.fill(y, x, x + 1);
            }
        return to;
    };
    target.mask = halve(mask);
    if (unrolled) target.unrolled->onScreen = halve(unrolled->onScreen);
    sampleContour(target, contour.size() / 2);
    return target;
}

PoseTarget PoseTarget::reshaped(BitMask given) const {
    PoseTarget target = *this;
    target.mask = std::move(given);
    target.contour.clear();
    sampleContour(target, contour.size());
    return target;
}

void PoseProblem::buildSkins() {
    skins.clear();
    for (const Body& actor : actors) {
        const auto first =
            std::find_if(actors.begin(), actors.end(), [&](const Body& other) { return other.stature == actor.stature; });
        const auto index = static_cast<std::size_t>(first - actors.begin());
        skins.push_back(index < skins.size() ? skins[index] : std::make_shared<const BodyMesh>(humanMesh(actor)));
    }
}

PoseProblem in256Rows(PoseProblem problem) {
    for (PoseTarget& target : problem.targets)
        while (target.refPixelsPerPixel < 1) halve(target, problem.stage);
    return problem;
}

PoseProblem simpler(PoseProblem problem) {
    for (auto& skin : problem.skins)
        if (skin->simpler) skin = skin->simpler;
    return problem;
}

PoseProblem forFirstLook(PoseProblem problem) {
    for (PoseTarget& target : problem.targets) halve(target, problem.stage);
    problem.skins.clear();
    return problem;
}

}  // namespace fantascope::theatre
