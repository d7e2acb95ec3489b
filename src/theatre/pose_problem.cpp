#include "theatre/pose_problem.h"

#include "theatre/distance_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::theatre {
namespace {

constexpr double kMargin = 1.0 / 3;  // of the silhouette's height, around it

// White pixels that hang together, over corners too.
struct Island {
    std::int64_t area = 0;
    glm::ivec2 pixel{0};  // its first
    int left = 0, right = 0;
};

// Runs of a row join those that they touch in the row above: no more memory than the runs take.
std::vector<Island> findIslands(const BitMask& mask) {
    struct Run {
        int from, to;
        std::size_t island;
    };
    std::vector<Island> islands;
    std::vector<std::size_t> parents;
    const auto rootOf = [&](std::size_t i) {
        while (parents[i] != i) i = parents[i] = parents[parents[i]];
        return i;
    };
    std::vector<Run> above, here;
    for (int y = 0; y < mask.height(); ++y) {
        here.clear();
        for (int x = 0; x < mask.width(); ++x) {
            if (!mask.at(x, y)) continue;
            const int from = x;
            while (mask.at(x, y)) ++x;
            here.push_back({from, x, islands.size()});
            parents.push_back(islands.size());
            islands.push_back({x - from, {from, y}, from, x});
        }
        auto first = above.begin();
        for (const Run& run : here) {
            while (first != above.end() && first->to < run.from) ++first;
            for (auto other = first; other != above.end() && other->from <= run.to; ++other) {
                const std::size_t a = rootOf(other->island), b = rootOf(run.island);
                if (a == b) continue;
                const std::size_t keep = std::min(a, b), gone = std::max(a, b);
                parents[gone] = keep;
                islands[keep].area += islands[gone].area;
                islands[keep].left = std::min(islands[keep].left, islands[gone].left);
                islands[keep].right = std::max(islands[keep].right, islands[gone].right);
            }
        }
        std::swap(above, here);
    }
    std::vector<Island> whole;
    for (std::size_t i = 0; i < islands.size(); ++i)
        if (parents[i] == i) whole.push_back(islands[i]);
    return whole;
}

void sampleContour(PoseTarget& target, std::size_t points) {
    target.area = static_cast<double>(target.mask.count());
    const ContourDisc disc(std::max(1.0, kDiscRadius / target.pixelsOf256));
    for (const glm::ivec2 point : sampled(outerContour(target.mask), points))
        target.contour.push_back(disc.at(target.mask, point));
}

// A picture's silhouette, row 0 at the top.
struct Silhouette {
    BitMask mask;
    int left = 0, right = 0, top = 0, bottom = 0;  // the columns and rows that it lies in: [left, right) x [top, bottom)
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

// Error: it has parts that nobody could join.
Result<void> checkIslands(const BitMask& mask, int rows) {
    if (findIslands(mask).size() <= 1) return {};
    // Islands are near if they hang together once each has grown by half of how far apart they may be.
    const BitMask joined = deeperThan(signedDistance(mask), -0.5 * PoseTarget::kFarApart * rows);
    if (const std::size_t apart = findIslands(joined).size(); apart > 1)
        return Error(
            fmt::format("it has {} parts that are farther from each other than {:.0f} % of its height; join them, or play each "
                        "as a target of its own",
                        apart, 100 * PoseTarget::kFarApart));
    return {};
}

// Silhouettes of pictures of one size as targets in one frame on the screen, which is laid by one of them.
Result<std::vector<PoseTarget>> laidOut(std::span<const Silhouette> silhouettes, std::size_t by, const Stage& stage,
                                        double height, int rows) {
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

    // One pixel of the mask is `step` pixels of the picture; it is sampled at the mask's pixels' centres by area.
    const double step = double(measure.bottom - measure.top) / rows, pixel = height / rows;
    const double middle = 0.5 * (measure.left + measure.right), given = pixel / step;  // a pixel of the picture, metres
    const double half = std::max(middle - left, right - middle) / step, high = (measure.bottom - top) / step;
    const int margin = static_cast<int>(std::lround(kMargin * rows)), columns = static_cast<int>(std::ceil(2 * half));
    const int width = columns + 2 * margin, above = std::max(rows, static_cast<int>(std::ceil(high - 1e-6))) + margin;
    if (stage.lit) {
        const double reach = half * pixel, top = high * pixel, x = stage.light.x;
        const glm::dvec2 from = stage.lit->from, to = stage.lit->to;
        if (x - reach < from.x || x + reach > to.x || from.y > 0 || top > to.y)
            return Error(
                fmt::format("its silhouette is to be x {:.2f} .. {:.2f} m and y 0 .. {:.2f} m on the screen, and the projector "
                            "lights x {:.2f} .. {:.2f} m "
                            "and y {:.2f} .. {:.2f} m only; make it less high, or the projector's picture larger",
                            x - reach, x + reach, top, from.x, to.x, from.y, to.y));
    }
    std::vector<PoseTarget> targets;
    for (std::size_t i = 0; i < silhouettes.size(); ++i) {
        const BitMask& whole = silhouettes[i].mask;
        PoseTarget target{
            ScreenFrame(stage, stage.light.x - 0.5 * width * pixel, above * pixel, pixel, width, above),
            BitMask(width, above),
            0,
            {},
            256.0 / rows,
            ScreenFrame(stage, stage.light.x - middle * given, measure.bottom * given, given, whole.width(), whole.height())};
        for (int y = 0; y < above; ++y)
            for (int x = 0; x < width; ++x) {
                // 3 x 3 samples a pixel, or the picture's own pixels where they are fewer.
                int white = 0;
                for (int j = 0; j < 3; ++j)
                    for (int k = 0; k < 3; ++k)
                        white += whole.at(static_cast<int>(std::floor(middle + (x + (k + 0.5) / 3 - 0.5 * width) * step)),
                                          static_cast<int>(std::floor(measure.bottom - (above - y - (j + 0.5) / 3) * step)));
                if (white > 4) target.mask.fill(y, x, x + 1);
            }
        auto checked = checkIslands(target.mask, rows);
        if (!checked) return silhouettes.size() > 1 ? checked.error().in(nameOf(i)) : checked.error();
        sampleContour(target, std::max<std::size_t>(1, kContourPoints * static_cast<std::size_t>(rows) / 256));
        targets.push_back(std::move(target));
    }
    return targets;
}

}  // namespace

Result<void> PoseTarget::checkSize(int width, int height) {
    if (std::max(width, height) <= kMostSide) return {};
    return Error(fmt::format("it is {} x {} pixels; no side may have more than {}: scale it down, some 500 are enough", width,
                             height, kMostSide));
}

Result<PoseTarget> PoseTarget::from(const GreyImage& picture, const Stage& stage, double height, int rows) {
    const Silhouette silhouette = TRY(silhouetteOf(picture));
    return std::move(TRY(laidOut({&silhouette, 1}, 0, stage, height, rows))[0]);
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
    return laidOut(silhouettes, representative, stage, height, rows);
}

PoseTarget PoseTarget::halved(const Stage& stage) const {
    const int width = (mask.width() + 1) / 2, height = (mask.height() + 1) / 2;
    const glm::dvec2 leftBottom = frame.metresAt({0, mask.height()});
    const double pixel = 2 * frame.pixel();
    PoseTarget target{ScreenFrame(stage, leftBottom.x, leftBottom.y + height * pixel, pixel, width, height),
                      BitMask(width, height),
                      0,
                      {},
                      2 * pixelsOf256,
                      given};
    // From the floor up; a pixel is white if half of it is.
    const int cut = 2 * height - mask.height();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            int white = 0;
            for (int i = 0; i < 4; ++i) white += mask.at(2 * x + i % 2, 2 * y - cut + i / 2);
            if (white >= 2) target.mask.fill(y, x, x + 1);
        }
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

void PoseProblem::dress() {
    skins.clear();
    for (const Body& actor : actors) {
        const auto first =
            std::find_if(actors.begin(), actors.end(), [&](const Body& other) { return other.stature == actor.stature; });
        const auto index = static_cast<std::size_t>(first - actors.begin());
        skins.push_back(index < skins.size() ? skins[index] : std::make_shared<const BodyMesh>(humanMesh(actor)));
    }
}

PoseProblem in256Rows(PoseProblem problem) {
    while (problem.target.pixelsOf256 < 1) problem.target = problem.target.halved(problem.stage);
    return problem;
}

PoseProblem simpler(PoseProblem problem) {
    for (auto& skin : problem.skins)
        if (skin->simpler) skin = skin->simpler;
    return problem;
}

PoseProblem forFirstLook(PoseProblem problem) {
    problem.target = problem.target.halved(problem.stage);
    problem.skins.clear();
    return problem;
}

}  // namespace fantascope::theatre
