#include "app/reload/redrawn_pattern.h"

#include "pattern/motion/pattern_motion.h"
#include "pattern/search/refit.h"

#include "core/fit.h"
#include "media/image.h"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace fantascope::app {

Result<RedrawnPattern> RedrawnPattern::of(const pattern::ShapePattern& shown) {
    using pattern::PatternSearch;
    GreyImage drawing = TRY(readGrey(shown.guide));
    const auto anew = [&](const std::string& why) {
        return Error(fmt::format("{}: {}; 'fantascope pattern' makes another pattern of it", shown.guide.string(), why));
    };
    if (!isSameShape(static_cast<double>(drawing.width()) / drawing.height(), shown.aspect()))
        return anew("the drawing has another shape than the pattern");
    if (shown.compare != pattern::CompareSpace::Light) return anew("its pattern was not compared in light");
    if (shown.instances.empty()) return anew("its pattern is empty");
    const GreyImage guide = comparedGuide(std::move(drawing), shown.guideTransfer, shown.compare);
    const GreyImage white(shown.width, shown.height, 1);
    const SteadyClock clock;
    const Time end = clock.now() + kSearch;
    const auto askStop = [&](const PatternSearch::Progress&) {
        return clock.now() >= end ? std::optional(PatternSearch::StopReason::Time) : std::nullopt;
    };
    constexpr int kForEver = std::numeric_limits<int>::max();
    const auto refit = pattern::PatternRefit::of(shown, guide, white, {.iterations = kForEver, .more = 1, .least = 1}, askStop);
    auto found = std::make_shared<const pattern::ShapePattern>(refit.pattern);
    auto motion = std::make_shared<const pattern::PatternMotion>(*found);
    return RedrawnPattern{.source = {std::move(found), std::move(motion)},
                          .made = refit.made,
                          .removed = refit.removed,
                          .changed = refit.changed,
                          .toneBefore = refit.toneBefore,
                          .toneAfter = refit.toneAfter};
}

}  // namespace fantascope::app
