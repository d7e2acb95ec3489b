#include "plot/cast_figures.h"

#include "core/check.h"
#include "plot/mask_outline.h"
#include "plot/palette.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fantascope::plot {
namespace {

constexpr double kText = 14, kLine = 20, kMargin = 24;  // points
constexpr int kSamples = 3;                             // per pixel in each direction
constexpr glm::dvec3 kPaper{0.975}, kOthers{0.82}, kMissed{1, 0.87, 0.87}, kRed{0.86, 0.05, 0.1};
constexpr Stroke kOutline{{0, 0, 0}, 1.6}, kFrame{{0.6, 0.6, 0.6}, 1};

// What covers a place: one bit per actor, and one for the target.
using Cover = std::uint64_t;
constexpr int kMaxActors = 63;
constexpr Cover kTarget = Cover{1} << kMaxActors;

// Looks up what covers a place. Between pixel centres the masks are interpolated, so that outlines
// are straight from pixel to pixel.
class Covers {
public:
    Covers(std::span<const ActorShadow> actors, const theatre::BitMask& target)
        : width_(target.width()), height_(target.height()), covers_(width_, height_) {
        FANTASCOPE_CHECK(actors.size() <= static_cast<std::size_t>(kMaxActors), "a picture has at most kMaxActors actors");
        add(target, kTarget);
        for (std::size_t i = 0; i < actors.size(); ++i) add(actors[i].mask, Cover{1} << i);
    }

    Cover at(const glm::dvec2& pixel) const {
        const glm::dvec2 low = glm::floor(pixel - 0.5), f = pixel - 0.5 - low;
        const int x = static_cast<int>(low.x), y = static_cast<int>(low.y);
        const Cover a = cover(x, y), b = cover(x + 1, y), c = cover(x, y + 1), d = cover(x + 1, y + 1);
        const Cover all = a & b & c & d;
        Cover found = all;
        for (Cover rest = (a | b | c | d) & ~all; rest != 0; rest &= rest - 1) {
            const Cover bit = rest & ~(rest - 1);
            const auto has = [&](Cover of) { return (of & bit) != 0 ? 1.0 : 0.0; };
            if (glm::mix(glm::mix(has(a), has(b), f.x), glm::mix(has(c), has(d), f.x), f.y) > 0.5) found |= bit;
        }
        return found;
    }

private:
    void add(const theatre::BitMask& mask, Cover bit) {
        FANTASCOPE_CHECK(mask.width() == width_ && mask.height() == height_, "the masks of a figure have the same size");
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                if (mask.at(x, y)) covers_.at(x, y) |= bit;
    }
    Cover cover(int x, int y) const { return x < 0 || y < 0 || x >= width_ || y >= height_ ? 0 : covers_.at(x, y); }

    int width_, height_;
    Image<Cover> covers_;
};

// Lines at 45 degrees, rising or falling to the right; `at` in points.
bool isHatched(const glm::dvec2& at, bool rising) {
    constexpr double kPeriod = 9, kShare = 0.3;
    const double along = (rising ? at.x + at.y : at.x - at.y) / kPeriod;
    return along - std::floor(along) < kShare;
}

// The colour of a place in shadowFigure(). Inks are mixed in sRGB, since they are not light.
glm::dvec3 inkOf(Cover cover, const glm::dvec2& at) {
    const Cover actors = cover & ~kTarget;
    if (actors == 0) {
        if ((cover & kTarget) == 0) return kPaper;
        return isHatched(at, true) ? kRed : kMissed;
    }
    glm::dvec3 sum(0);
    int count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kMaxActors); ++i)
        if ((actors >> i & 1) != 0) sum += actorColour(i), ++count;
    const glm::dvec3 ink = sum / double(count) * (count > 1 ? 0.62 : 1.0);
    return (cover & kTarget) == 0 && isHatched(at, false) ? 0.25 * ink : ink;
}

// The colour of a place in one actor's picture.
glm::dvec3 inkOfOne(Cover cover, std::size_t actor, const glm::dvec2& at) {
    const Cover his = Cover{1} << actor;
    if ((cover & his) != 0) return inkOf(cover & (his | kTarget), at);
    return (cover & ~kTarget) != 0 ? kOthers : kPaper;
}

template <class Ink>
RgbaImage painted(const Covers& covers, double perPixel, int width, int height, Ink ink) {
    RgbaImage picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            glm::dvec3 sum(0);
            for (int i = 0; i < kSamples * kSamples; ++i) {
                const glm::dvec2 at(x + (i % kSamples + 0.5) / kSamples, y + (i / kSamples + 0.5) / kSamples);
                sum += ink(covers.at(perPixel * at), at);
            }
            const auto byte = [](double value) {
                return static_cast<std::uint8_t>(std::lround(255 * value / (kSamples * kSamples)));
            };
            picture.at(x, y) = {byte(sum.r), byte(sum.g), byte(sum.b), 255};
        }
    return picture;
}

theatre::BitMask cut(const theatre::BitMask& mask, glm::ivec2 from, glm::ivec2 to) {
    theatre::BitMask part(to.x - from.x, to.y - from.y);
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x)
            if (mask.at(from.x + x, from.y + y)) part.fill(y, x, x + 1);
    return part;
}

// Masks cropped to their common content, with a margin.
struct Cropped {
    Cropped(std::span<const ActorShadow> of, const theatre::BitMask& wholeTarget) : actors(of.begin(), of.end()) {
        glm::ivec2 from(wholeTarget.width(), wholeTarget.height()), to(0);
        for (int y = 0; y < wholeTarget.height(); ++y)
            for (int x = 0; x < wholeTarget.width(); ++x) {
                const auto isWhite = [&](const ActorShadow& actor) { return actor.mask.at(x, y); };
                if (!wholeTarget.at(x, y) && std::none_of(of.begin(), of.end(), isWhite)) continue;
                from = glm::min(from, glm::ivec2(x, y)), to = glm::max(to, glm::ivec2(x + 1, y + 1));
            }
        if (from.x >= to.x) from = glm::ivec2(0), to = {wholeTarget.width(), wholeTarget.height()};
        const int room = 1 + (to.y - from.y) / 16;
        from = glm::max(from - room, glm::ivec2(0));
        to = glm::min(to + room, glm::ivec2(wholeTarget.width(), wholeTarget.height()));
        target = cut(wholeTarget, from, to);
        for (ActorShadow& actor : actors) actor.mask = cut(actor.mask, from, to);
    }
    // The largest size in whole points with this aspect that fits.
    glm::dvec2 fitting(double width, double height) const {
        const glm::dvec2 size(target.width(), target.height());
        return glm::max(glm::dvec2(1), glm::round(std::min(width / size.x, height / size.y) * size));
    }

    std::vector<ActorShadow> actors;
    theatre::BitMask target;
};

template <class Ink>
void drawShadow(Page& page, const Covers& covers, const theatre::BitMask& target, glm::dvec2 topLeft, glm::dvec2 size, Ink ink) {
    page.picture(painted(covers, target.height() / size.y, static_cast<int>(size.x), static_cast<int>(size.y), ink), topLeft,
                 topLeft + size);
    const double scale = size.y / target.height();
    page.clip(topLeft, topLeft + size);
    for (std::vector<glm::dvec2> ring : maskOutline(target)) {
        for (glm::dvec2& point : ring) point = topLeft + scale * point;
        page.line(ring, kOutline);
    }
    page.endClip();
    page.frame(topLeft, topLeft + size, kFrame);
}

void drawBadge(Page& page, std::size_t actor, glm::dvec2 centre) {
    page.disc(centre, 12, {1, 1, 1});
    page.disc(centre, 11, actorColour(actor));
    page.disc(centre, 8, {1, 1, 1});
    page.text(fmt::format("{}", actor + 1), centre, 13, Anchor::Middle);
}

// Draws a legend entry, a sample of an ink with its meaning. Returns the place of the next one.
glm::dvec2 drawKey(Page& page, glm::dvec2 topLeft, Cover cover, std::string_view text) {
    constexpr int kWidth = 28, kHeight = 16;
    RgbaImage sample(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const glm::dvec3 ink = 255.0 * inkOf(cover, {x + 0.5, y + 0.5});
            sample.at(x, y) = {std::uint8_t(ink.r), std::uint8_t(ink.g), std::uint8_t(ink.b), 255};
        }
    page.picture(sample, topLeft, topLeft + glm::dvec2(kWidth, kHeight));
    page.frame(topLeft, topLeft + glm::dvec2(kWidth, kHeight), kFrame);
    page.text(text, topLeft + glm::dvec2(kWidth + 10, 0.5 * kHeight), kText, Anchor::Left);
    return topLeft + glm::dvec2(0, kHeight + 10);
}

}  // namespace

Page stageFigure(const StageView& view, const Camera& camera) {
    constexpr int kWidth = 1280, kHeight = static_cast<int>(kWidth / kStageAspect);
    Page page(kWidth, kHeight);
    page.picture(view.draw(camera, kWidth, kHeight), {0, 0}, {kWidth, kHeight});
    for (std::size_t i = 0; i < view.actors.size(); ++i) {
        // The badge goes above his highest point in the picture.
        std::optional<glm::dvec2> highest;
        for (const glm::vec3& vertex : view.actors[i].mesh.vertices) {
            const auto at = camera.pixelAt(vertex, kWidth, kHeight);
            if (at && (!highest || at->y < highest->y)) highest = at;
        }
        if (highest) drawBadge(page, i, *highest - glm::dvec2(0, 18));
    }
    return page;
}

Page shadowFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target, std::span<const std::string> lines) {
    const Cropped cropped(actors, target);
    const glm::dvec2 size = cropped.fitting(760, 600);
    const std::string several = "several at once", missed = "target without shadow", out = "shadow beyond the target",
                      edge = "target";
    double column = 0;
    {
        const Page ruler(1, 1);
        for (const std::string& text : {several, missed, out, edge}) column = std::max(column, 38 + ruler.textWidth(text, kText));
        for (std::size_t i = 0; i < actors.size(); ++i) column = std::max(column, 38 + ruler.textWidth(actors[i].name, kText));
        for (const std::string& line : lines) column = std::max(column, ruler.textWidth(line, kText));
    }
    const double rows = static_cast<double>(actors.size() + 4) * 26 + 20 + static_cast<double>(lines.size()) * kLine;
    Page page(static_cast<int>(std::ceil(size.x + column + 3 * kMargin)),
              static_cast<int>(std::ceil(std::max(size.y, rows) + 2 * kMargin)));
    const glm::dvec2 origin(kMargin);
    drawShadow(page, Covers(cropped.actors, cropped.target), cropped.target, origin, size, inkOf);

    glm::dvec2 at = origin + glm::dvec2(size.x + kMargin, 0);
    Cover all = 0;
    for (std::size_t i = 0; i < actors.size(); ++i) {
        at = drawKey(page, at, Cover{1} << i | kTarget, actors[i].name);
        if (i < 2) all |= Cover{1} << i;
    }
    if (actors.size() > 1) at = drawKey(page, at, all | kTarget, several);
    at = drawKey(page, at, kTarget, missed);
    if (!actors.empty()) at = drawKey(page, at, 1, out);
    page.line(at + glm::dvec2(0, 8), at + glm::dvec2(28, 8), kOutline);
    page.text(edge, at + glm::dvec2(38, 8), kText, Anchor::Left);
    at.y += 26 + 20;
    for (const std::string& line : lines) {
        page.text(line, at, kText, Anchor::Left);
        at.y += kLine;
    }
    return page;
}

Page actorsFigure(std::span<const ActorShadow> actors, const theatre::BitMask& target) {
    constexpr double kMaxWidth = 1280;
    const Cropped cropped(actors, target);
    const glm::dvec2 size = cropped.fitting(380, 300);
    const Covers covers(cropped.actors, cropped.target);
    double width = size.x;
    std::size_t lines = 0;
    {
        const Page ruler(1, 1);
        for (std::size_t i = 0; i < actors.size(); ++i) {
            width = std::max(width, 34 + ruler.textWidth(actors[i].name, kText));
            for (const std::string& note : actors[i].notes) width = std::max(width, ruler.textWidth(note, kText));
            lines = std::max(lines, actors[i].notes.size());
        }
    }
    const glm::dvec2 cell(width + kMargin, 34 + size.y + 12 + static_cast<double>(lines) * kLine + kMargin);
    const std::size_t columns = std::clamp<std::size_t>(static_cast<std::size_t>((kMaxWidth - kMargin) / cell.x), 1,
                                                        std::max<std::size_t>(1, actors.size()));
    const std::size_t rows = (actors.size() + columns - 1) / columns;
    Page page(static_cast<int>(std::ceil(static_cast<double>(columns) * cell.x + kMargin)),
              static_cast<int>(std::ceil(static_cast<double>(rows) * cell.y + kMargin)));
    for (std::size_t i = 0; i < actors.size(); ++i) {
        const glm::dvec2 origin = glm::dvec2(kMargin) + glm::dvec2(i % columns, i / columns) * cell;
        drawBadge(page, i, origin + 12.0);
        page.text(actors[i].name, origin + glm::dvec2(34, 12), kText, Anchor::Left);
        const glm::dvec2 topLeft = origin + glm::dvec2(0, 34);
        drawShadow(page, covers, cropped.target, topLeft, size,
                   [&](Cover cover, const glm::dvec2& at) { return inkOfOne(cover, i, at); });
        glm::dvec2 at = topLeft + glm::dvec2(0, size.y + 18);
        for (const std::string& note : actors[i].notes) {
            page.text(note, at, kText, Anchor::Left);
            at.y += kLine;
        }
    }
    return page;
}

Page solutionsFigure(std::span<const SolutionCell> solutions, const theatre::BitMask& target) {
    constexpr double kMaxShadow = 340, kMaxWidth = 1480, kGap = 8;
    const glm::dvec2 view(kCellView);
    std::vector<Cropped> shadows;
    std::size_t lines = 0;
    double width = 0;
    for (const SolutionCell& solution : solutions) {
        shadows.emplace_back(solution.actors, target);
        width = std::max(width, shadows.back().fitting(kMaxShadow, view.y).x);
        lines = std::max(lines, solution.lines.size());
    }
    const glm::dvec2 cell(view.x + kGap + width + kMargin, view.y + 16 + static_cast<double>(lines) * kLine + kMargin);
    const std::size_t columns = std::clamp<std::size_t>(static_cast<std::size_t>((kMaxWidth - kMargin) / cell.x), 1,
                                                        std::max<std::size_t>(1, solutions.size()));
    const std::size_t rows = (solutions.size() + columns - 1) / columns;
    Page page(static_cast<int>(std::ceil(static_cast<double>(columns) * cell.x + kMargin)),
              static_cast<int>(std::ceil(static_cast<double>(rows) * cell.y + kMargin)));
    for (std::size_t i = 0; i < solutions.size(); ++i) {
        const SolutionCell& solution = solutions[i];
        const glm::dvec2 origin = glm::dvec2(kMargin) + glm::dvec2(i % columns, i / columns) * cell;
        const theatre::BitMask& cropped = shadows[i].target;
        page.picture(solution.view, origin, origin + view);
        page.frame(origin, origin + view, kFrame);
        drawShadow(page, Covers(shadows[i].actors, cropped), cropped, origin + glm::dvec2(view.x + kGap, 0),
                   shadows[i].fitting(kMaxShadow, view.y), inkOf);
        glm::dvec2 at = origin + glm::dvec2(0, view.y + 18);
        for (std::size_t line = 0; line < solution.lines.size(); ++line) {
            page.text(solution.lines[line], at, line == 0 ? kText + 2 : kText - 1, Anchor::Left);
            at.y += kLine;
        }
    }
    return page;
}

Page stacked(std::span<const Page> pages) {
    glm::ivec2 size(1, 0);
    for (const Page& page : pages) size = {std::max(size.x, page.width()), size.y + page.height()};
    Page all(size.x, std::max(1, size.y));
    double top = 0;
    for (const Page& page : pages) {
        all.page(page, {0, top});
        top += page.height();
    }
    return all;
}

}  // namespace fantascope::plot
