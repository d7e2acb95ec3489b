#include "contract/display_sink_contract.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace fantascope::contract {
namespace {

using Rig = DisplaySinkRig;
constexpr const char* kHolds = "";

// Of the picture that was drawn last: GL's row 0 is at the bottom.
std::array<std::uint8_t, 4> storedPixel(const DisplaySink& sink, int x, int y) {
    std::array<std::uint8_t, 4> pixel{};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, sink.framebuffer());
    glReadPixels(x, y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
    return pixel;
}

void fill(const DisplaySink& sink, float linearGrey) {
    const std::array<GLfloat, 4> colour = {linearGrey, linearGrey, linearGrey, 1};
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClearNamedFramebufferfv(sink.framebuffer(), GL_COLOR, 0, colour.data());
}

std::string runsFromTheStart(Rig& rig) {
    const DeviceStatus status = rig.sink->status();
    if (status.state != DeviceState::Running) return fmt::format("it is {}: {}", nameOf(status.state), status.detail);
    if (status.name != rig.name) return fmt::format("it calls itself '{}'", status.name);
    if (status.driver.empty()) return "it does not say which driver it is";
    if (!status.detail.empty()) return fmt::format("it runs and complains: {}", status.detail);
    if (status.losses != 0) return fmt::format("it counts {} losses", status.losses);
    if (rig.sink->size() != rig.size) return fmt::format("its size is {} x {}", rig.sink->size().x, rig.sink->size().y);
    if (!(rig.sink->refreshRate() > 0)) return fmt::format("its refresh rate is {}", rig.sink->refreshRate());
    return kHolds;
}

std::string hasOpenGl(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    GLint major = 0, minor = 0, profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    if (major * 10 + minor < 45 || profile != GL_CONTEXT_CORE_PROFILE_BIT)
        return fmt::format("OpenGL {}.{}, profile {}", major, minor, profile);
    return kHolds;
}

std::string framebufferHoldsStoredSrgb(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    if (glCheckNamedFramebufferStatus(rig.sink->framebuffer(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return "it cannot be drawn into";
    fill(*rig.sink, 0.5f);
    const int middle = storedPixel(*rig.sink, 0, 0)[0], corner = storedPixel(*rig.sink, rig.size.x - 1, rig.size.y - 1)[0];
    // 0.5 in linear light is stored as 188 (IEC 61966-2-1); a plain framebuffer stores 128.
    if (middle != 188 || corner != 188)
        return fmt::format("half of the light is stored as {} and {}, 188 is right", middle, corner);
    return kHolds;
}

std::string pacedWaitsForTheNextRefresh(Rig& rig) {
    for (int frame = 0; frame < 5; ++frame) {
        if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
        const Time before = rig.clock->now();
        const std::int64_t next = rig.sink->nextRefresh();
        const Time due = rig.sink->refreshTime(next);
        if (due <= before) return fmt::format("at {} s the next refresh is said to be at {} s", seconds(before), seconds(due));
        const auto shown = rig.sink->present(true);
        if (!shown) return shown.error().message();
        if (shown.value().refresh != next || shown.value().at != due)
            return fmt::format("frame {}: shown at refresh {} ({} s), the next one was {} ({} s)", frame, shown.value().refresh,
                               seconds(shown.value().at), next, seconds(due));
        if (rig.clock->now() != due)
            return fmt::format("frame {}: it came back at {} s instead of {} s", frame, seconds(rig.clock->now()), seconds(due));
    }
    return kHolds;
}

std::string refreshesAreEvenAndCounted(Rig& rig) {
    const double period = 1 / rig.sink->refreshRate();
    for (const std::int64_t number : {1, 2, 1000}) {
        const double step = seconds(rig.sink->refreshTime(number + 1) - rig.sink->refreshTime(number));
        if (std::abs(step - period) > 1e-8) return fmt::format("refresh {} takes {} s, a period is {} s", number, step, period);
    }
    const std::int64_t before = rig.sink->nextRefresh();
    rig.clock->advance(fromSeconds(7 * period));
    if (rig.sink->nextRefresh() != before + 7)
        return fmt::format("in 7 periods it counted {} refreshes", rig.sink->nextRefresh() - before);
    return kHolds;
}

std::string slowFrameMissesRefreshes(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    const auto first = rig.sink->present(true);
    if (!first) return first.error().message();
    rig.clock->advance(fromSeconds(2.5 / rig.sink->refreshRate()));  // the drawing of the second frame
    const auto second = rig.sink->present(true);
    if (!second) return second.error().message();
    const std::int64_t later = second.value().refresh - first.value().refresh;
    if (later != 3) return fmt::format("a frame that took 2.5 periods was shown {} refreshes later, 3 is right", later);
    return kHolds;
}

std::string unpacedDoesNotWait(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    rig.clock->advance(fromSeconds(3.25 / rig.sink->refreshRate()));
    for (int frame = 0; frame < 2; ++frame) {
        const Time before = rig.clock->now();
        const auto shown = rig.sink->present(false);
        if (!shown) return shown.error().message();
        if (rig.clock->now() != before) return fmt::format("it waited {} s", seconds(rig.clock->now() - before));
        const auto [refresh, at] = shown.value();
        if (at != rig.sink->refreshTime(refresh) || at > before || rig.sink->refreshTime(refresh + 1) <= before)
            return fmt::format("at {} s it showed within refresh {} of {} s, which is not running", seconds(before), refresh,
                               seconds(at));
    }
    return kHolds;
}

// With two outputs on one thread both are drawn before the first is presented.
std::string presentTakesItsOwnContext(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    if (const auto current = rig.neighbour->makeCurrent(); !current) return current.error().message();
    if (const auto shown = rig.sink->present(false); !shown) return shown.error().message();
    if (!glIsBuffer(buffer)) return "after present() another display's context is current";
    return glGetError() == GL_NO_ERROR ? kHolds : "it leaves an OpenGL error behind";
}

std::string leavesItsNeighbourAlone(Rig& rig) {
    for (const auto& [sink, grey] : {std::pair(rig.sink.get(), 1.0f), std::pair(rig.neighbour.get(), 0.0f)}) {
        if (const auto current = sink->makeCurrent(); !current) return current.error().message();
        fill(*sink, grey);
        if (const auto shown = sink->present(false); !shown) return shown.error().message();
    }
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    if (storedPixel(*rig.sink, 1, 1)[0] != 255) return "its picture is its neighbour's";
    rig.unplug();
    if (rig.sink->makeCurrent()) return "makeCurrent() succeeds although it is unplugged";
    if (const auto shown = rig.neighbour->present(false); !shown)
        return "its loss took its neighbour along: " + shown.error().message();
    return kHolds;
}

std::string lossIsAnError(Rig& rig) {
    rig.unplug();
    const Time before = rig.clock->now();
    for (int call = 0; call < 2; ++call) {
        const auto current = rig.sink->makeCurrent();
        if (current) return "makeCurrent() succeeds although it is unplugged";
        if (current.error().message().find(rig.name) == std::string::npos)
            return "the error does not name the output: " + current.error().message();
        if (rig.sink->present(true)) return "present() succeeds although it is unplugged";
        if (rig.sink->present(false)) return "an unpaced present() succeeds although it is unplugged";
    }
    if (rig.clock->now() != before) return "it waits although it is unplugged";
    const DeviceStatus status = rig.sink->status();
    if (status.state == DeviceState::Running) return "its status is running although it is unplugged";
    if (status.detail.empty()) return "its status does not say why";
    if (status.onLoss != LossAction::Dark) return "it declares that a lost projector does not go dark";
    if (status.losses != 1) return fmt::format("one loss counts as {}", status.losses);
    return kHolds;
}

std::string comesBack(Rig& rig) {
    if (const auto current = rig.sink->makeCurrent(); !current) return current.error().message();
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    rig.unplug();
    if (rig.sink->makeCurrent()) return "makeCurrent() succeeds although it is unplugged";
    rig.plugIn();
    if (const auto current = rig.sink->makeCurrent(); !current)
        return "makeCurrent() after the return: " + current.error().message();
    if (!glIsBuffer(buffer)) return "what was in its context is gone after the return";
    if (const auto shown = rig.sink->present(true); !shown) return "present() after the return: " + shown.error().message();
    const DeviceStatus status = rig.sink->status();
    if (status.state != DeviceState::Running || !status.detail.empty())
        return fmt::format("after the return it is {}: {}", nameOf(status.state), status.detail);
    if (status.losses != 1) return fmt::format("a loss and a return count as {} losses", status.losses);
    return kHolds;
}

}  // namespace

Suite<DisplaySinkRig> displaySinkContract() {
    return {
        {"runs from the start as it was asked to", runsFromTheStart},
        {"has a context of OpenGL 4.5 core", hasOpenGl},
        {"its framebuffer holds stored sRGB values", framebufferHoldsStoredSrgb},
        {"a paced frame waits for the next refresh", pacedWaitsForTheNextRefresh},
        {"refreshes are even and counted", refreshesAreEvenAndCounted},
        {"a slow frame misses refreshes", slowFrameMissesRefreshes},
        {"an unpaced frame does not wait", unpacedDoesNotWait},
        {"present() takes its own context", presentTakesItsOwnContext},
        {"leaves its neighbour alone", leavesItsNeighbourAlone},
        {"a loss is an error, noticed, counted and not waited for", lossIsAnError},
        {"comes back with its context", comesBack},
    };
}

}  // namespace fantascope::contract
