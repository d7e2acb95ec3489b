#include "app/calibrate/light_survey.h"

#include "vision/map_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace fantascope::app {
namespace {

using vision::LightDecoder;
using vision::StructuredLight;

constexpr Time kCameraWithin = std::chrono::seconds(5);
constexpr int kFirstFrames = 12;
// The longest delay from a picture to its light on the camera that can be measured.
constexpr Time kLongestDelay = std::chrono::milliseconds(800);
constexpr int kEdges = 5;
constexpr int kFulls = 3;
// A pair is shown again while more than this share of the lit pixels is undecided, so many times at
// most.
constexpr double kUndecided = 0.005;
constexpr int kRounds = 4;
// A pair is tried again only if the last try left less than this share of the pixels undecided that
// were undecided before it.
constexpr double kStubborn = 0.7;
constexpr int kSmallestSide = 32;        // of an output, projector pixels
constexpr std::size_t kFewestLit = 400;  // camera pixels
constexpr double kSaturatedShare = 0.2;
// Of the lit pixels, the fewest that must be decoded.
constexpr double kFewestKnown = 0.1;
// The contrast at which one frame a picture is enough, and the most frames.
constexpr double kClearContrast = 25;
constexpr int kMostFrames = 4;
// What seems to have moved is looked at again, so many times at most: somebody may stand before
// much of the picture.
constexpr int kLooks = 3;

GreyImage lightOf(const vision::CameraLight& camera, const RgbaImage& stored) {
    GreyImage light(stored.width(), stored.height());
    camera.addTo(light, stored);
    return light;
}

std::shared_ptr<const RgbaImage> plain(glm::ivec2 size, double stored) {
    const auto value = static_cast<std::uint8_t>(std::lround(255 * stored));
    return std::make_shared<const RgbaImage>(size.x, size.y, Rgba8{value, value, value, 255});
}

// The pixels that differ most between dark and full.
std::vector<std::size_t> brightest(const GreyImage& full, const GreyImage& dark) {
    float most = 0;
    for (std::size_t i = 0; i < full.pixels().size(); ++i) most = std::max(most, full.pixels()[i] - dark.pixels()[i]);
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < full.pixels().size(); ++i)
        if (full.pixels()[i] - dark.pixels()[i] > most / 2) pixels.push_back(i);
    return pixels;
}

double meanOver(const std::vector<std::size_t>& pixels, const GreyImage& light) {
    double sum = 0;
    for (const std::size_t pixel : pixels) sum += light.pixels()[pixel];
    return pixels.empty() ? 0 : sum / static_cast<double>(pixels.size());
}

// Error: the camera sees too little of the output's light, or too much.
Result<void> canBeMeasured(const LightDecoder& sight) {
    const auto dark = sight.dark().pixels();
    if (2 * std::ranges::count_if(dark, [](float light) { return light >= 1; }) > std::ssize(dark))
        return Error(std::string(kCameraWhite));
    if (static_cast<double>(sight.saturated()) > kSaturatedShare * static_cast<double>(sight.lit() + sight.saturated()))
        return Error("the camera is saturated by its light; lower the camera's exposure or gain");
    if (sight.lit() < kFewestLit)
        return Error(
            fmt::format("the camera sees its light on {} pixels, {} are needed; see that the projector is on, turn it or the "
                        "camera, or raise "
                        "the camera's exposure",
                        sight.lit(), kFewestLit));
    return {};
}

GreyImage lessOf(const GreyImage& picture, const GreyImage& complement) {
    GreyImage difference(picture.width(), picture.height());
    for (std::size_t i = 0; i < difference.pixels().size(); ++i)
        difference.pixels()[i] = picture.pixels()[i] - complement.pixels()[i];
    return difference;
}

const Error& ended() {
    static const Error error("it was ended before this output was measured");
    return error;
}

}  // namespace

void LightSurvey::step(const Use& use) {
    const auto seen = rig_.step();
    if (!seen) return;
    const RgbaImage& image = seen->frame->image;
    if (glm::ivec2(image.width(), image.height()) != site_.nominalCamera->size) return;
    heard_ = seen->arrived;
    sight_.see(seen->frame);
    use(*seen);
}

bool LightSurvey::isSilent() const {
    constexpr int kPeriods = 4;
    return rig_.now() - heard_ > kPeriods * period_;
}

Error LightSurvey::stopped() const {
    const std::string trouble = rig_.cameraTrouble();
    return Error("the camera stopped: " +
                 (trouble.empty()
                      ? "there are no pictures of its size any more; look at its cable, and close other programs that "
                        "use it"
                      : trouble));
}

Result<void> LightSurvey::stepUntil(Time until, const Use& use) {
    while (rig_.now() < until) {
        if (!hooks_.goesOn()) return ended();
        step(use);
    }
    return {};
}

Result<void> LightSurvey::awaitCamera() {
    std::vector<CalibrationRig::Seen> frames;
    const Time limit = rig_.now() + kCameraWithin;
    while (frames.size() < kFirstFrames && rig_.now() < limit) {
        if (!hooks_.goesOn()) return ended();
        if (const auto seen = rig_.step()) frames.push_back(*seen);
    }
    if (frames.size() < kFirstFrames) {
        const std::string trouble = rig_.cameraTrouble();
        return Error(fmt::format("the camera gave {} pictures in {} s{}", frames.size(), seconds(kCameraWithin),
                                 trouble.empty() ? "; look at its cable, and close other programs that use it" : ": " + trouble));
    }
    const CameraFrame& first = *frames.front().frame;
    const glm::ivec2 declared = site_.nominalCamera->size;
    if (first.image.width() != declared.x || first.image.height() != declared.y)
        return Error(fmt::format("the camera's pictures have {} x {} pixels, the site file says {} x {}; correct camera: size",
                                 first.image.width(), first.image.height(), declared.x, declared.y));
    std::vector<Time> periods;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const CameraFrame &now = *frames[i].frame, &before = *frames[i - 1].frame;
        periods.push_back((now.exposed - before.exposed) /
                          static_cast<Time::rep>(std::max<std::uint64_t>(1, now.sequence - before.sequence)));
        arrival_ = std::max(arrival_, frames[i].arrived - now.exposed);
    }
    std::ranges::nth_element(periods, periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2));
    period_ = periods[periods.size() / 2];
    return {};
}

// Lights the output and darkens it again, and notes between which two frames each change was seen.
// False: what the camera sees does not follow the output.
Result<bool> LightSurvey::measureDelay(std::size_t output) {
    const auto white = plain(site_.outputs[output].size(), 1);
    const auto stillOf = [&](bool lit) -> Result<GreyImage> {
        rig_.show(output, lit ? white : nullptr);
        std::shared_ptr<const CameraFrame> last;
        TRY(stepUntil(rig_.now() + kLongestDelay + 2 * period_, [&](const CalibrationRig::Seen& seen) { last = seen.frame; }));
        if (!last) return stopped();
        return lightOf(light_, last->image);
    };
    const GreyImage full = TRY(stillOf(true)), dark = TRY(stillOf(false));
    const std::vector<std::size_t> pixels = brightest(full, dark);
    const double lit = meanOver(pixels, full), unlit = meanOver(pixels, dark);
    constexpr double kVisible = 0.01;
    if (pixels.size() < kFewestLit || lit - unlit < kVisible) return false;

    // Noise, too, has pixels that differed in the two stills. Afterwards these lie halfway between
    // both, whatever the output shows. One change may be missed, since somebody may pass.
    constexpr double kFollows = 0.6;
    constexpr int kMostStrays = 1;
    int strays = 0;
    Time soonest = Time::min(), latest = Time::max();
    std::vector<Time> arrivals;
    for (int edge = 0; edge < kEdges; ++edge) {
        const bool lights = edge % 2 == 0;
        rig_.show(output, lights ? white : nullptr);
        std::optional<Time> before;
        bool found = false;
        double share = 0;  // of the difference, in the newest picture
        sight_.clear();
        step([&](const CalibrationRig::Seen& seen) { before = seen.frame->exposed; });
        const Time shown = rig_.now();
        // Each change at another moment of the camera's period.
        TRY(stepUntil(shown + kLongestDelay + period_ * edge / kEdges, [&](const CalibrationRig::Seen& seen) {
            share = (meanOver(pixels, lightOf(light_, seen.frame->image)) - unlit) / (lit - unlit);
            if (found) return;
            if ((share > 0.5) != lights) {
                before = seen.frame->exposed;
                return;
            }
            found = true;
            if (before) soonest = std::max(soonest, *before - shown);
            latest = std::min(latest, seen.frame->exposed - shown);
            arrivals.push_back(seen.arrived - seen.frame->exposed);
        }));
        if (!found && isSilent()) return stopped();
        if (!found && sight_.repeatsOne()) return Error(sight_.trouble());
        const double changed = lights ? share : 1 - share;
        if ((!found || changed < kFollows) && ++strays > kMostStrays) return false;
    }
    if (soonest == Time::min()) soonest = latest - period_;
    if (soonest > latest) std::swap(soonest, latest);  // the delay is not the same every time
    const Time margin = period_ / 4;
    delay_ = {soonest - margin, latest + margin};
    std::ranges::sort(arrivals);
    latency_ = delay_.middle() + arrivals[arrivals.size() / 2];
    arrival_ = std::max(arrival_, arrivals.back());
    return true;
}

Result<void> LightSurvey::begin(const std::vector<std::size_t>& outputs) {
    hooks_.tell(0, "waiting for the camera");
    TRY(awaitCamera());
    hooks_.tell(0, "measuring the delay");
    for (const std::size_t output : outputs) {
        const bool seen = TRY(measureDelay(output));
        rig_.show(output, nullptr);
        if (seen) return {};
    }
    const std::string trouble = sight_.trouble();
    if (!trouble.empty()) return Error(trouble);
    return Error(fmt::format(
        "the camera sees no light of the outputs within {} s; see that the projectors are on, turn the camera towards "
        "their light, or raise its exposure. If it does see them, it is too slow: choose another size or format for it",
        seconds(kLongestDelay)));
}

Result<std::vector<LightSurvey::Taken>> LightSurvey::take(std::size_t output, std::size_t count,
                                                          const std::function<Picture(std::size_t)>& picture, int frames,
                                                          const std::function<void(std::size_t, const RgbaImage&)>& colours) {
    sight_.clear();
    std::vector<Taken> taken(count);
    PictureSchedule schedule(delay_, period_);
    FrozenCamera frozen;
    const auto use = [&](const CalibrationRig::Seen& seen) {
        const auto shown = schedule.pictureOf(seen.frame->exposed);
        if (!shown || *shown < 0) return;
        frozen.see(seen.frame, *shown);
        Taken& one = taken[static_cast<std::size_t>(*shown)];
        const RgbaImage& image = seen.frame->image;
        if (one.light.empty()) one.light = GreyImage(image.width(), image.height());
        light_.addTo(one.light, image);
        if (colours) colours(static_cast<std::size_t>(*shown), image);
        ++one.frames;
    };
    for (std::size_t i = 0; i < count; ++i) {
        rig_.show(output, picture(i));
        step(use);
        schedule.show(static_cast<std::int64_t>(i), rig_.now());
        TRY(stepUntil(rig_.now() + schedule.dwell(frames), use));
        hooks_.tell(done_ + share_ * static_cast<double>(i + 1) / static_cast<double>(count), doing_);
    }
    rig_.show(output, nullptr);
    step(use);
    schedule.show(-1, rig_.now());
    TRY(stepUntil(rig_.now() + delay_.latest + arrival_ + 2 * period_, use));
    for (Taken& one : taken)
        for (float& value : one.light.pixels()) value /= static_cast<float>(one.frames);
    if (std::ranges::all_of(taken, [](const Taken& one) { return one.frames == 0; })) return stopped();
    if (frozen.wasFrozen()) {
        const std::string trouble = sight_.trouble();
        return Error(trouble.empty() ? std::string(kCameraFrozen) : trouble);
    }
    done_ += share_;
    return taken;
}

// Shows all pairs but the full one, and those again that were disturbed. Returns how many pictures
// were repeated.
Result<int> LightSurvey::decode(std::size_t output, const StructuredLight& light, double gamma, LightDecoder& decoder) {
    const int frames = std::clamp(static_cast<int>(std::ceil(std::pow(kClearContrast / decoder.contrast(), 2))), 1, kMostFrames);
    int repeated = 0;
    std::vector<std::size_t> due(light.pairs().size() - 1);
    std::iota(due.begin(), due.end(), std::size_t{1});
    for (int round = 0; round < kRounds && !due.empty(); ++round) {
        share_ = round == 0 ? 0.7 : (1 - done_) / 2, doing_ = round == 0 ? "structured light" : "repeating what was disturbed";
        const auto picture = [&](std::size_t i) {
            return std::make_shared<const RgbaImage>(light.picture(due[i / 2], i % 2 == 1, gamma));
        };
        if (round > 0) repeated += static_cast<int>(2 * due.size());
        const std::vector<Taken> taken = TRY(take(output, 2 * due.size(), picture, frames));
        std::vector<std::size_t> again;
        for (std::size_t i = 0; i < due.size(); ++i) {
            const double before = decoder.undecided(due[i]);
            if (taken[2 * i].frames > 0 && taken[2 * i + 1].frames > 0)
                decoder.take(due[i], taken[2 * i].light, taken[2 * i + 1].light);
            const double now = decoder.undecided(due[i]);
            // Pixels that another try decides were disturbed. Pixels that it does not decide have
            // another reason, such as a mirror, and no try will help.
            const bool helps = round == 0 || now < kStubborn * before;
            if (now > kUndecided && helps) again.push_back(due[i]);
        }
        due = std::move(again);
    }
    return repeated;
}

Result<LightSurvey::Output> LightSurvey::survey(std::size_t output) {
    if (const std::string trouble = rig_.outputTrouble(output); !trouble.empty()) return Error(trouble);
    const glm::ivec2 projector = site_.outputs[output].size(), camera = site_.nominalCamera->size;
    if (std::min(projector.x, projector.y) < kSmallestSide)
        return Error(fmt::format("its picture of {} x {} pixels is too small to measure; each side needs at least {}",
                                 projector.x, projector.y, kSmallestSide));
    done_ = 0, share_ = 0.1, doing_ = "looking for its light";
    const auto whiteOrBlack = [&](std::size_t i) { return plain(projector, i % 2 == 0 ? 1 : 0); };
    const std::vector<Taken> seen = TRY(take(output, 2 * kFulls, whiteOrBlack, 1));
    const auto decoderOf = [&](int period) {
        LightDecoder decoder(StructuredLight(projector, period), camera);
        for (std::size_t i = 0; i < seen.size(); i += 2)
            if (seen[i].frames > 0 && seen[i + 1].frames > 0) decoder.take(0, seen[i].light, seen[i + 1].light);
        return decoder;
    };
    const LightDecoder sight = decoderOf(2);
    if (const auto can = canBeMeasured(sight); !can) {
        if (isSilent()) return stopped();
        // Black pictures alone: the camera looks elsewhere, on a dark night.
        const std::string blind = sight_.isBlack() && !sight_.repeatsOne() ? "" : sight_.trouble();
        return blind.empty() ? can.error() : Error(blind);
    }

    share_ = 0.15, doing_ = "measuring its greys and colours";
    Output found;
    TRY(measureResponse(output, sight, found));
    const StructuredLight light(projector, StructuredLight::periodFor(projector, static_cast<double>(sight.lit())));
    LightDecoder decoder = decoderOf(light.period());
    found.repeated += TRY(decode(output, light, found.gamma, decoder));
    found.map = decoder.map();
    found.period = light.period();
    found.dark = decoder.dark();
    if (static_cast<double>(found.map.known) < kFewestKnown * static_cast<double>(found.map.lit)) {
        if (isSilent()) return stopped();
        const std::string trouble = sight_.trouble();
        return Error(trouble.empty() ? fmt::format("only {} of the {} camera pixels that it lights could be measured; see that "
                                                   "nothing moves or flickers, and calibrate again",
                                                   found.map.known, found.map.lit)
                                     : trouble);
    }
    found.full = decoder.full();
    return found;
}

Result<double> LightSurvey::movedSince(std::size_t output, const Output& found, double still) {
    using Axis = StructuredLight::Axis;
    const StructuredLight light(site_.outputs[output].size(), found.period);
    const auto picture = [&](std::size_t i) {
        return std::make_shared<const RgbaImage>(
            light.picture(light.firstPhase(i / 2 == 0 ? Axis::Across : Axis::Down), i % 2 == 1, found.gamma));
    };
    std::optional<double> least;
    for (int look = 0; look < kLooks && (!least || *least > still); ++look) {
        done_ = 0, share_ = 1, doing_ = "looking whether something has moved";
        const auto taken = take(output, 4, picture, 1);
        if (!taken) return hooks_.goesOn() ? taken.error() : Error("the calibration was ended");
        if (std::ranges::any_of(*taken, [](const Taken& one) { return one.frames == 0; })) continue;  // a picture was missed
        const auto along = [&](Axis axis, std::size_t i) {
            return vision::movedSince(found.map, light, axis, lessOf((*taken)[i].light, (*taken)[i + 1].light));
        };
        const auto across = along(Axis::Across, 0), down = along(Axis::Down, 2);
        if (!across || !down) return Error("the camera sees too little of its light");
        const double moved = std::hypot(*across, *down);
        least = least ? std::min(*least, moved) : moved;
    }
    if (!least) return Error("the camera missed the pictures that would tell");
    return *least;
}

}  // namespace fantascope::app
