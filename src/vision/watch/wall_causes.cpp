#include "vision/watch/wall_causes.h"

#include <algorithm>

namespace fantascope::vision {
namespace {

constexpr double kNoPicture = 0.12;  // of the usual contrast: less is none
constexpr double kWeak = 0.85, kStrong = 1.25, kMuchStronger = 1.5;
constexpr double kAlike = 0.5;      // of the weakest picture's loss: a picture that loses so much shares its cause
constexpr double kMost = 0.5;       // of the picture
constexpr double kSaturated = 0.3;  // of the bright places
constexpr double kSaturatesSome = 0.05;
constexpr double kBlurred = 0.65;                          // cells
constexpr double kAll = 0.85;                              // of the picture: so much is as good as all of it
constexpr double kSome = 0.1;                              // and so little is hardly anything
constexpr double kHidden = 0.08;                           // of the picture: more is worth a look
constexpr double kFlatLight = 0.08;                        // of full light: what shines without a picture is some other source's
constexpr double kAmbient = 0.012;                         // of full light
constexpr double kLitFog = 0.01;                           // of full light, that fog adds for the light that it takes
constexpr double kLitAround = 1.035, kDarkAround = 0.975;  // times the surroundings' usual light
constexpr double kLighter = 1.15;                          // times the surroundings' usual light
constexpr double kOnWall = 0.5;  // of the other light: so much of it with the surface's texture is no haze
constexpr double kVeil = 0.002;  // linear camera light

// How one output's picture looks.
enum class Look { Usual, Blurred, Weak, Strong, Dark, Foreign, Hidden, Passing };

Look lookOf(const OutputLight& light) {
    const bool isExplained = light.explained >= kAll;
    if (light.saturated > kSaturated) return Look::Strong;
    if (light.contrast < kNoPicture && isExplained) return light.otherLight < kFlatLight ? Look::Dark : Look::Foreign;
    if (light.contrast > kStrong && light.asUsual < kMost) return Look::Strong;
    if (light.contrast > kMuchStronger && light.explained > kMost) return Look::Strong;
    if (light.saturated > kSaturatesSome) return Look::Passing;  // what is left of the picture says little
    if (!isExplained && light.asUsual < kSome) return Look::Foreign;
    if (light.hidden > kHidden && light.explained < 1 - kHidden) return Look::Hidden;
    if (!isExplained) return Look::Passing;
    if (light.blur > kBlurred) return Look::Blurred;
    return light.contrast < kWeak ? Look::Weak : light.contrast > kStrong ? Look::Strong : Look::Usual;
}

// The outputs that were measured, and how they look.
struct Looks {
    const WallLight& light;
    std::vector<std::size_t> outputs;
    std::vector<Look> looks;

    explicit Looks(const WallLight& measured) : light(measured) {
        for (std::size_t i = 0; i < light.outputs.size(); ++i)
            if (light.outputs[i]) outputs.push_back(i), looks.push_back(lookOf(*light.outputs[i]));
    }
    const OutputLight& of(std::size_t k) const { return *light.outputs[outputs[k]]; }
    std::size_t count(Look look) const { return static_cast<std::size_t>(std::ranges::count(looks, look)); }
    bool all(Look look) const { return !looks.empty() && count(look) == looks.size(); }
    // Some pictures are weak, and the others almost. A projector's lamp weakens its own picture
    // only.
    bool allWeaken() const {
        if (count(Look::Weak) == 0) return false;
        double least = 1;
        for (std::size_t k = 0; k < outputs.size(); ++k) least = std::min(least, of(k).contrast);
        for (std::size_t k = 0; k < outputs.size(); ++k) {
            const bool isTold = looks[k] == Look::Weak || looks[k] == Look::Usual || looks[k] == Look::Passing;
            if (!isTold || 1 - of(k).contrast < kAlike * (1 - least)) return false;
        }
        return true;
    }
    double mean(double OutputLight::*figure) const {
        double sum = 0;
        for (std::size_t k = 0; k < outputs.size(); ++k) sum += of(k).*figure;
        return sum / static_cast<double>(outputs.size());
    }
    // A cause for each output that looks so.
    void each(Look look, Cause cause, auto figure, std::vector<NamedCause>& causes) const {
        for (std::size_t k = 0; k < outputs.size(); ++k)
            if (looks[k] == look) causes.push_back({cause, outputs[k], figure(of(k))});
    }
};

// All pictures are weak. Fog is lit by the projectors, also where no picture is. The camera's
// exposure darkens what is around the pictures as well, a projector's lamp does not.
void addWeak(const Looks& looks, std::vector<NamedCause>& causes) {
    if (looks.light.isSettling) return;  // it cannot be told yet
    const double contrast = looks.mean(&OutputLight::contrast);
    const auto& around = looks.light.surroundings;
    const bool isOne = looks.looks.size() == 1;
    const bool isLighter = around ? around->level > kLitAround : looks.mean(&OutputLight::otherLight) > kLitFog * (1 - contrast);
    if (isLighter || (!isOne && !around))
        causes.push_back({Cause::Fog, {}, contrast});
    else if (!isOne || (around && around->level < kDarkAround))
        causes.push_back({Cause::CameraExposure, {}, contrast});
    else
        causes.push_back({Cause::DimLamp, looks.outputs[0], contrast});
}

void addBlurred(const Looks& looks, std::vector<NamedCause>& causes) {
    std::size_t byCamera = 0;
    for (std::size_t k = 0; k < looks.outputs.size(); ++k) byCamera += looks.of(k).isCameraBlurred ? 1 : 0;
    if (looks.all(Look::Blurred) && (looks.looks.size() > 1 || byCamera > 0))
        causes.push_back({Cause::CameraDirty, {}, looks.mean(&OutputLight::blur)});
    else
        looks.each(
            Look::Blurred, Cause::OutOfFocus, [](const OutputLight& light) { return light.blur; }, causes);
}

// Other light lies over all pictures.
void addOtherLight(const Looks& looks, std::vector<NamedCause>& causes) {
    for (std::size_t k = 0; k < looks.outputs.size(); ++k)
        if (looks.of(k).otherLight < kAmbient) return;
    const auto& around = looks.light.surroundings;
    const double other = looks.mean(&OutputLight::otherLight);
    // Light on the wall shows its texture. Around the pictures it looks like a haze if lamps light
    // what is there.
    const bool isOnWall = looks.mean(&OutputLight::textured) > kOnWall;
    const bool isHaze = around && around->gain < kLighter && around->veil > kVeil && !isOnWall;
    causes.push_back({isHaze ? Cause::CameraDirty : Cause::AmbientLight, {}, other});
}

}  // namespace

std::vector<NamedCause> causesOf(const WallLight& light) {
    const Looks looks(light);
    std::vector<NamedCause> causes;
    if (looks.looks.empty()) return causes;
    const auto& around = light.surroundings;
    const bool isOne = looks.looks.size() == 1;
    if (const std::size_t hidden = looks.count(Look::Hidden); hidden > 0) {
        looks.each(
            Look::Hidden, Cause::BlockedView, [](const OutputLight& of) { return of.hidden; }, causes);
        if (hidden > 1) causes = {{Cause::BlockedView, {}, looks.mean(&OutputLight::hidden)}};
        return causes;
    }
    if (looks.all(Look::Dark) && (!isOne || (around && around->gain < 0.3))) return {{Cause::CameraBlind, {}, 0}};
    if (looks.all(Look::Foreign) && !isOne) return {{Cause::CameraElsewhere, {}, 0}};
    // What passes before one picture, or comes to stay, may be all that is before another.
    const auto contrastOf = [](const OutputLight& of) { return of.contrast; };
    if (looks.count(Look::Passing) == 0) {
        looks.each(Look::Dark, Cause::DeadOutput, contrastOf, causes);
        looks.each(Look::Foreign, Cause::WrongInput, contrastOf, causes);
    }
    if (looks.all(Look::Strong)) return {{Cause::CameraExposure, {}, looks.mean(&OutputLight::contrast)}};
    if (looks.allWeaken())
        addWeak(looks, causes);
    else
        looks.each(Look::Weak, Cause::DimLamp, contrastOf, causes);
    addBlurred(looks, causes);
    if (looks.count(Look::Usual) + looks.count(Look::Passing) == looks.looks.size()) addOtherLight(looks, causes);
    return causes;
}

}  // namespace fantascope::vision
