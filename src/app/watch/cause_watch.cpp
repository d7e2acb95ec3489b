#include "app/watch/cause_watch.h"

#include "vision/picture_trouble.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <utility>

namespace fantascope::app {
namespace {

constexpr Time kStep = std::chrono::milliseconds(780);     // between measurements
constexpr Time kUnseen = std::chrono::milliseconds(2500);  // a cause that was not seen for so long is over,
constexpr Time kDoubted = std::chrono::milliseconds(900);  // and one that is not named yet is none
constexpr Time kShort = std::chrono::milliseconds(900);
constexpr Time kLong = std::chrono::milliseconds(1500);
constexpr Time kLonger = std::chrono::milliseconds(3800);  // nobody who passes takes so long
constexpr Time kGone = std::chrono::seconds(3);            // without a picture
constexpr double kMostSaturated = 0.1;                     // of a picture whose place is certain; and hidden of it:
constexpr double kMostHidden = 0.2;
constexpr double kAsWeak = 0.06;  // of the usual light
constexpr int kBlack = 40;        // a stored value

bool isUniform(const RgbaImage& picture) {
    const Rgba8 first = picture.pixels()[0];
    return std::ranges::all_of(picture.pixels(), [&](const Rgba8& pixel) {
        return std::abs(pixel.r - first.r) <= 1 && std::abs(pixel.g - first.g) <= 1 && std::abs(pixel.b - first.b) <= 1;
    });
}

// Enough of a picture to know it again.
std::vector<Rgba8> sampled(const RgbaImage& picture) {
    constexpr std::size_t kEvery = 13;
    std::vector<Rgba8> pixels;
    for (std::size_t i = 0; i < picture.pixels().size(); i += kEvery) pixels.push_back(picture.pixels()[i]);
    return pixels;
}

}  // namespace

CauseWatch::CauseWatch(const show::Site& site, vision::WallWatch& wall, CauseLog& causes, show::EventLog& events)
    : site_(site), wall_(wall), causes_(causes), events_(events), hidden_(site.outputs.size()), saturated_(site.outputs.size()) {}

bool CauseWatch::isUsable(const RgbaImage& picture, bool isLit, Time at) {
    const glm::ivec2 size = site_.nominalCamera->size;
    bool isUsable = false;
    std::vector<Rgba8> pixels = sampled(picture);
    if (picture.width() != size.x || picture.height() != size.y) {
        suspect("",
                {"camera of another size",
                 fmt::format("it sends pictures of {} x {}, and the site file says {} x {}: set its 'size' and calibrate again",
                             picture.width(), picture.height(), size.x, size.y),
                 kShort},
                true, at);
    } else if (isUniform(picture)) {
        if (isLit || picture.pixels()[0].g > kBlack)
            suspect("",
                    {"camera blind", "its picture is the same everywhere: take off its cap, and look at its exposure", kShort},
                    true, at);
    } else if (pixels == picture_) {
        if (isLit)
            suspect("", {"camera frozen", "it repeats one picture again and again: unplug it, and plug it in again", kLong}, true,
                    at);
    } else if (vision::troubleOf(picture) == vision::PictureTrouble::Saturated) {
        suspect("", {"camera saturated", "more than half of its picture is white: set a shorter exposure", kShort}, true, at);
    } else {
        isUsable = true;
    }
    picture_ = std::move(pixels);
    endOthers(true, at);
    return isUsable;
}

void CauseWatch::wait(Time last, Time period, Time now) {
    if (now - last < std::max(kGone, 3 * period)) return;
    suspect("", {"camera gone", "it sends nothing: look at its plug", Time{}}, true, now);
}

void CauseWatch::noteSlowCamera(Time period, Time at) {
    suspect("",
            {"camera slow",
             fmt::format("it sends one picture in {:.1f} s, too few to watch the wall: set a shorter exposure, or "
                         "smaller pictures",
                         seconds(period)),
             kLong},
            true, at);
}

void CauseWatch::endWall(Time at) {
    for (const auto& [name, suspicion] : suspicions_)
        if (!suspicion.ofPicture) causes_.end(name.first, name.second, at);
    std::erase_if(suspicions_, [](const auto& each) { return !each.second.ofPicture; });
}

void CauseWatch::noteLamps(const show::ShowState& shown) {
    vision::LampState state = shown.relays;
    const auto add = [&](float level) {
        state.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(level, 0.0f, 1.0f))));
    };
    for (const float level : shown.levels) add(level);
    add(shown.lamps.share);
    state.push_back(static_cast<std::uint8_t>(shown.lamps.relaysOff));
    lamps_.note(shown.time, std::move(state));
}

// The state of the lamps when a picture was exposed; nothing: they were changing about that moment.
std::optional<vision::LampState> CauseWatch::lampsAt(Time exposed) const {
    if (!lamps_.isSteady(exposed, std::equal_to<>())) return std::nullopt;
    return lamps_.at(exposed);
}

std::optional<CauseWatch::Measured> CauseWatch::measure(const show::ShowState& shown, Time at,
                                                        const std::function<void(vision::WallLight&)>& explain) {
    noteLamps(shown);
    if (measured_ && at - *measured_ < kStep) return std::nullopt;
    measured_ = at;
    const auto lamps = lampsAt(at);
    if (!lamps || lamps != measuredWith_) wall_.lampsChange(lamps);
    measuredWith_ = lamps;
    vision::WallLight light = wall_.measureLight();
    if (explain) explain(light);
    for (std::size_t i = 0; i < hidden_.size(); ++i)
        if (light.outputs[i]) {
            hidden_[i] = light.outputs[i]->explained < 1 - kMostHidden;
            saturated_[i] = light.outputs[i]->saturated > kMostSaturated;
        }
    if (std::ranges::none_of(light.outputs, [](const auto& output) { return output.has_value(); })) return std::nullopt;
    std::vector<vision::NamedCause> named = vision::causesOf(light);
    keepWeak(light, named);
    const bool isLost = std::ranges::any_of(named, [](const vision::NamedCause& cause) {
        return cause.cause == vision::Cause::CameraElsewhere || cause.cause == vision::Cause::CameraBlind ||
               cause.cause == vision::Cause::BlockedView || cause.cause == vision::Cause::WrongInput ||
               cause.cause == vision::Cause::DeadOutput;
    });
    if (isLost && wall_.isUpsideDown()) {
        suspect("", {"camera upside down", "its picture is turned by half a turn: turn it back", kLong}, false, at);
    } else {
        for (const vision::NamedCause& cause : named) suspect(nameOf(cause), wordsOf(cause), false, at);
    }
    if (!light.isSettling) endOthers(false, at);  // else they cannot be told
    const bool isClear =
        std::ranges::all_of(named, [](const auto& cause) { return cause.output || cause.cause == vision::Cause::AmbientLight; });
    return Measured{std::move(light), isClear};
}

// Fog and another exposure weaken all pictures alike; where there is only one, a dim lamp does so,
// too. None of these becomes another while the pictures stay as weak, whatever the lamps around
// them do.
void CauseWatch::keepWeak(const vision::WallLight& light, std::vector<vision::NamedCause>& named) {
    double contrast = 0;
    int measured = 0;
    for (const auto& output : light.outputs)
        if (output) contrast += output->contrast, ++measured;
    const auto stays = [&](double figure) {
        return weak_ && causes_.isOpen(nameOf(*weak_), wordsOf(*weak_).cause) && std::abs(weak_->figure - figure) < kAsWeak;
    };
    if (light.isSettling && stays(contrast / measured)) named.push_back(*weak_);
    for (vision::NamedCause& cause : named) {
        if (cause.cause != vision::Cause::Fog && cause.cause != vision::Cause::CameraExposure &&
            (cause.cause != vision::Cause::DimLamp || measured > 1))
            continue;
        if (stays(cause.figure)) cause.cause = weak_->cause, cause.output = weak_->output;
        weak_ = cause;
    }
}

// The output's name; "": the cause is of all of them.
std::string CauseWatch::nameOf(const vision::NamedCause& named) const {
    return named.output ? site_.outputs[*named.output].name : "";
}

void CauseWatch::suspect(const std::string& output, const Words& words, bool ofPicture, Time at) {
    const auto [found, isNew] = suspicions_.try_emplace({output, words.cause}, Suspicion{at, at, ofPicture});
    Suspicion& suspicion = found->second;
    suspicion.last = at;
    suspicion.ofPicture = ofPicture;
    if (at - suspicion.since < words.lasts || causes_.isOpen(output, words.cause)) return;
    causes_.begin(output, words.cause, suspicion.since);
    events_.append({at, show::event::CauseBegan{output, words.cause, words.advice}});
}

void CauseWatch::endOthers(bool ofPicture, Time at) {
    for (auto it = suspicions_.begin(); it != suspicions_.end();) {
        const auto& [name, suspicion] = *it;
        const bool isNamed = causes_.isOpen(name.first, name.second);
        if (suspicion.ofPicture != ofPicture || at - suspicion.last < (isNamed ? kUnseen : kDoubted)) {
            ++it;
            continue;
        }
        if (isNamed) {
            causes_.end(name.first, name.second, suspicion.last);
            events_.append({at, show::event::CauseEnded{name.first, name.second}});
        }
        it = suspicions_.erase(it);
    }
}

CauseWatch::Words CauseWatch::wordsOf(const vision::NamedCause& named) const {
    const double percent = 100 * named.figure;
    switch (named.cause) {
        case vision::Cause::OutOfFocus:
            return {"out of focus", fmt::format("it is blurred by about {:.0f} camera pixels: focus its lens", named.figure),
                    kLong};
        case vision::Cause::DimLamp:
            return {"dim projector lamp",
                    fmt::format("it gives {:.0f} % of its usual light: look at its lamp and its power mode", percent), kLong};
        case vision::Cause::DeadOutput:
            return {"dead output", "its picture is not on the wall: look at its power, its shutter and its cable", kLong};
        case vision::Cause::WrongInput:
            return {"wrong input", "something else is on the wall: look at its menu and its input", kLong};
        case vision::Cause::BlockedView:
            return {"blocked view", fmt::format("{:.0f} % of the picture is hidden: look for what stands before it", percent),
                    kShort};
        case vision::Cause::Fog:
            return {"fog", fmt::format("{:.0f} % of the usual light is left", percent), kLong};
        case vision::Cause::AmbientLight:
            return {"ambient light", fmt::format("other light on the wall is {:.0f} % of full light: find its lamp", percent),
                    kLonger};
        case vision::Cause::CameraDirty:
            return {"camera dirty", "its picture is hazy or not sharp: clean and focus its lens", kLong};
        case vision::Cause::CameraBlind:
            return {"camera blind", "it sees no picture: look whether something covers it, and whether the projectors have power",
                    kLong};
        case vision::Cause::CameraExposure:
            return {"camera exposure", fmt::format("everything is {:.0f} % as bright as usual: lock its exposure", percent),
                    kLong};
        case vision::Cause::CameraElsewhere:
            return {"camera moved", "no picture is where it belongs: look where the camera points, and calibrate again", kLong};
    }
    return {};
}

}  // namespace fantascope::app
