#include "theatre/pose_problem.h"

#include "theatre/distance_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace

Result<void> PoseTarget::checkSize(int width, int height) {
    if (std::max(width, height) <= kMostSide) return {};
    return Error(fmt::format("it is {} x {} pixels; no side may have more than {}: scale it down, some 500 are enough", width,
                             height, kMostSide));
}

Result<PoseTarget> PoseTarget::from(const GreyImage& picture, const Stage& stage, double height, int rows) {
    TRY(checkSize(picture.width(), picture.height()));
    BitMask whole(picture.width(), picture.height());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            if (picture.at(x, y) > 0.5f) whole.fill(y, x, x + 1);
    if (whole.count() == 0) return Error("nothing in it is white; a silhouette is white on black");
    if (whole.count() == std::int64_t{picture.width()} * picture.height())
        return Error("all of it is white; a silhouette is white on black, with some black around");
    int left = picture.width(), right = 0;
    for (const Island& island : findIslands(whole)) {
        if (island.area < kFewest)
            return Error(fmt::format(
                "at column {}, row {} is a white speck of {} pixels; remove it, or draw it larger: fewer than {} are no "
                "silhouette",
                island.pixel.x, island.pixel.y, island.area, kFewest));
        left = std::min(left, island.left), right = std::max(right, island.right);
    }
    const int top = whole.rowsFrom(), bottom = whole.rowsTo();
    if (right - left > kWidest * (bottom - top))
        return Error(
            fmt::format("its silhouette is {} pixels wide and {} high; no more than {} times as wide as high can be played",
                        right - left, bottom - top, kWidest));

    // One pixel of the mask is `step` pixels of the picture; it is sampled at the mask's pixels' centres by area.
    const double step = double(bottom - top) / rows, pixel = height / rows;
    const int margin = static_cast<int>(std::lround(kMargin * rows)),
              columns = static_cast<int>(std::ceil((right - left) / step));
    const int width = columns + 2 * margin, above = rows + margin;
    const double middle = 0.5 * (left + right), given = pixel / step;  // a pixel of the picture, metres
    if (stage.lit) {
        const double half = 0.5 * (right - left) / step * pixel, x = stage.light.x;
        const glm::dvec2 from = stage.lit->from, to = stage.lit->to;
        if (x - half < from.x || x + half > to.x || from.y > 0 || height > to.y)
            return Error(
                fmt::format("its silhouette is to be x {:.2f} .. {:.2f} m and y 0 .. {:.2f} m on the screen, and the projector "
                            "lights x {:.2f} .. {:.2f} m "
                            "and y {:.2f} .. {:.2f} m only; make it less high, or the projector's picture larger",
                            x - half, x + half, height, from.x, to.x, from.y, to.y));
    }
    PoseTarget target{
        ScreenFrame(stage, stage.light.x - 0.5 * width * pixel, above * pixel, pixel, width, above),
        BitMask(width, above),
        0,
        {},
        256.0 / rows,
        ScreenFrame(stage, stage.light.x - middle * given, bottom * given, given, picture.width(), picture.height())};
    for (int y = 0; y < above; ++y)
        for (int x = 0; x < width; ++x) {
            // 3 x 3 samples a pixel, or the picture's own pixels where they are fewer.
            int white = 0;
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i)
                    white += whole.at(static_cast<int>(std::floor(middle + (x + (i + 0.5) / 3 - 0.5 * width) * step)),
                                      static_cast<int>(std::floor(bottom - (above - y - (j + 0.5) / 3) * step)));
            if (white > 4) target.mask.fill(y, x, x + 1);
        }
    if (findIslands(target.mask).size() > 1) {
        // Islands are near if they hang together once each has grown by half of how far apart they may be.
        const BitMask joined = deeperThan(signedDistance(target.mask), -0.5 * kFarApart * rows);
        if (const std::size_t apart = findIslands(joined).size(); apart > 1)
            return Error(fmt::format(
                "it has {} parts that are farther from each other than {:.0f} % of its height; join them, or play each "
                "as a target of its own",
                apart, 100 * kFarApart));
    }
    sampleContour(target, std::max<std::size_t>(1, kContourPoints * static_cast<std::size_t>(rows) / 256));
    return target;
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
