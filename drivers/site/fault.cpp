#include "drivers/site/fault.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::site {
namespace {

std::string within(const Fault& fault) {
    return fault.rise > Time{} ? fmt::format(" within {} s", seconds(fault.rise)) : std::string();
}

std::string moved(const Fault& fault) {
    return fmt::format("bumped by {:.3f} m and {:.2f} degrees", glm::length(fault.move),
                       glm::length(fault.turn) * 180 / std::numbers::pi);
}

std::string tellOfProjector(const Fault& fault, bool begins) {
    const std::string projector = "projector " + fault.device;
    switch (fault.kind) {
        case Fault::Kind::Bump:
            return projector + " " + (begins ? moved(fault) : "put back");
        case Fault::Kind::Dim:
            return begins ? fmt::format("{} gives {} of its light{}", projector, fault.level, within(fault))
                          : fmt::format("{} gives all its light again{}", projector, within(fault));
        case Fault::Kind::Defocus:
            return begins ? fmt::format("{} loses its focus by {} pixels{}", projector, fault.blur, within(fault))
                          : fmt::format("{} is in focus again{}", projector, within(fault));
        default:
            return begins ? fmt::format("{} shows {} instead of our picture", projector, fault.pictureName)
                          : fmt::format("{} shows our picture again", projector);
    }
}

std::string tellOfCamera(const Fault& fault, bool begins) {
    switch (fault.kind) {
        case Fault::Kind::CameraBump:
            return "camera " + (begins ? moved(fault) : "put back");
        case Fault::Kind::Cover:
            return begins ? "something covers a part of the camera's picture"
                          : "nothing covers that part of the camera's picture any more";
        case Fault::Kind::Dirt:
            return fmt::format("camera's lens {}{}", begins ? "gets dirty" : "is clean again", within(fault));
        case Fault::Kind::Blind:
            return !begins            ? "camera sees again"
                   : fault.level == 0 ? "camera sees only black"
                   : fault.level == 1 ? "camera sees only white"
                                      : "camera sees only grey";
        case Fault::Kind::UpsideDown:
            return begins ? "camera's picture stands upside down" : "camera's picture stands upright again";
        default:
            return begins ? fmt::format("camera exposes {} times the light{}", fault.level, within(fault))
                          : fmt::format("camera exposes as before{}", within(fault));
    }
}

template <class Use>
void forEach(std::span<const Fault> faults, Fault::Kind kind, Time time, Use use) {
    for (const Fault& fault : faults)
        if (fault.kind == kind)
            if (const double share = fault.shareAt(time); share > 0) use(fault, share);
}

// A factor that is 1 without the fault.
double factor(const Fault& fault, double share) { return 1 + share * (fault.level - 1); }

}  // namespace

double Fault::shareAt(Time time) const {
    const auto share = [&](Time since) { return since < Time{} ? 0.0 : since >= rise ? 1.0 : seconds(since) / seconds(rise); };
    return std::max(0.0, share(time - at) - (until ? share(time - *until) : 0.0));
}

std::string tell(const Fault& fault, bool begins) {
    switch (fault.kind) {
        case Fault::Kind::Unplug:
            return fmt::format("{} {}", fault.device, begins ? "unplugged" : "plugged in again");
        case Fault::Kind::Freeze:
            return fmt::format("{} {}", fault.device, begins ? "froze" : "moves again");
        case Fault::Kind::Graphics:
            return fmt::format("graphics of {} {}", fault.device, begins ? "fail" : "work again");
        case Fault::Kind::Fog:
            return begins ? fmt::format("fog of {} / m comes within {} s", fault.density, seconds(fault.rise))
                          : fmt::format("fog clears within {} s", seconds(fault.rise));
        case Fault::Kind::Ambient:
            return begins ? fmt::format("ambient light becomes {} times as bright{}", fault.level, within(fault))
                          : fmt::format("ambient light becomes as before{}", within(fault));
        case Fault::Kind::Flicker: {
            const bool all = fault.device.empty();
            const std::string lamps = all ? "street lamps" : "street lamp " + fault.device;
            return begins ? fmt::format("{} {} by {} at {} Hz", lamps, all ? "flicker" : "flickers", fault.depth, fault.frequency)
                          : fmt::format("{} {} steadily again", lamps, all ? "shine" : "shines");
        }
        case Fault::Kind::Bump:
        case Fault::Kind::Dim:
        case Fault::Kind::Defocus:
        case Fault::Kind::Input:
            return tellOfProjector(fault, begins);
        default:
            return tellOfCamera(fault, begins);
    }
}

double fogAt(std::span<const Fault> faults, Time time) {
    double fog = 0;
    forEach(faults, Fault::Kind::Fog, time, [&](const Fault& fault, double share) { fog += fault.density * share; });
    return fog;
}

double ambientAt(std::span<const Fault> faults, Time time) {
    double level = 1;
    forEach(faults, Fault::Kind::Ambient, time, [&](const Fault& fault, double share) { level *= factor(fault, share); });
    return level;
}

double flickerAt(std::span<const Fault> faults, const std::string& relay, Time time) {
    double level = 1;
    forEach(faults, Fault::Kind::Flicker, time, [&](const Fault& fault, double) {
        if (!fault.device.empty() && fault.device != relay) return;
        level *= 1 - fault.depth * (0.5 - 0.5 * std::cos(2 * std::numbers::pi * fault.frequency * seconds(time)));
    });
    return level;
}

ProjectorState projectorAt(std::span<const Fault> faults, const std::string& output, Time time) {
    ProjectorState state;
    forEach(faults, Fault::Kind::Dim, time, [&](const Fault& fault, double share) {
        if (fault.device == output) state.level *= factor(fault, share);
    });
    forEach(faults, Fault::Kind::Defocus, time, [&](const Fault& fault, double share) {
        if (fault.device == output) state.blur = std::hypot(state.blur, fault.blur * share);
    });
    forEach(faults, Fault::Kind::Input, time, [&](const Fault& fault, double) {
        if (fault.device == output) state.picture = fault.picture;
    });
    return state;
}

CameraState cameraAt(std::span<const Fault> faults, Time time) {
    CameraState state;
    forEach(faults, Fault::Kind::Cover, time, [&](const Fault& fault, double) { state.covers.push_back(&fault); });
    forEach(faults, Fault::Kind::Dirt, time, [&](const Fault& fault, double share) {
        state.blur = std::hypot(state.blur, fault.blur * share);
        state.veil += fault.veil * share;
    });
    forEach(faults, Fault::Kind::Exposure, time, [&](const Fault& fault, double share) { state.gain *= factor(fault, share); });
    forEach(faults, Fault::Kind::Blind, time, [&](const Fault& fault, double) { state.blind = fault.level; });
    forEach(faults, Fault::Kind::UpsideDown, time, [&](const Fault&, double) { state.upsideDown = true; });
    return state;
}

}  // namespace fantascope::site
