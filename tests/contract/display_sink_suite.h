#pragma once

#include "device/display_sink.h"

#include "contract/rig.h"

#include <epoxy/gl.h>
#include <glm/vec2.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace fantascope::contract {

// A display with requested size kSize and rate kRefreshRate, on a clock that stands still unless
// somebody moves it, which detects waiting.
class DisplaySinkRig : public Rig<DisplaySink> {
public:
    static constexpr glm::ivec2 kSize{64, 36};
    static constexpr double kRefreshRate = 30;

    virtual ManualClock& manualClock() = 0;
    // Another output of the same kind on the same thread.
    virtual DisplaySink& otherOutput() = 0;
    // Removes what its context was made on; a new context can be made after kRetry. False: that is
    // impossible.
    static constexpr Time kRetry = std::chrono::seconds(1);
    virtual bool loseContext() { return false; }
};

// Fills the picture with a grey of linear light; the display's context is current.
inline void fill(const DisplaySink& sink, float light) {
    const std::array<GLfloat, 4> colour = {light, light, light, 1};
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClearNamedFramebufferfv(sink.framebuffer(), GL_COLOR, 0, colour.data());
}

// The stored red of one pixel; GL's row 0 is at the bottom.
inline int storedRed(const DisplaySink& sink, int x, int y) {
    std::array<std::uint8_t, 4> pixel{};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, sink.framebuffer());
    glReadPixels(x, y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
    return pixel[0];
}

// Every promise of device/display_sink.h.
inline Suite<DisplaySinkRig> displaySinkSuite() {
    const auto serves = [](DisplaySinkRig& rig) -> std::string {
        for (const bool leads : {true, false}) {
            CONTRACT_REQUIRE(rig.port().poll(), "poll() does not find it");
            CONTRACT_SUCCEEDS(rig.port().makeCurrent());
            fill(rig.port(), 1);
            CONTRACT_SUCCEEDS(rig.port().finish());
            CONTRACT_REQUIRE(storedRed(rig.port(), 0, 0) == 255, "what is drawn is not there");
            CONTRACT_SUCCEEDS(leads ? rig.port().present() : rig.port().presentWith(rig.clock().now()));
        }
        return "";
    };
    return joined<DisplaySinkRig>(
        lifeClauses<DisplaySinkRig>(serves),
        {
            {"it has the size and the refresh rate that it was asked for",
             [](DisplaySinkRig& rig) -> std::string {
                 const glm::ivec2 size = rig.port().size();
                 CONTRACT_REQUIRE(size == DisplaySinkRig::kSize, "its size is {} x {}", size.x, size.y);
                 CONTRACT_REQUIRE(rig.port().refreshRate() == DisplaySinkRig::kRefreshRate, "its rate is {}",
                                  rig.port().refreshRate());
                 return "";
             }},
            {"it has a context of OpenGL 4.5 core",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 GLint major = 0, minor = 0, profile = 0;
                 glGetIntegerv(GL_MAJOR_VERSION, &major);
                 glGetIntegerv(GL_MINOR_VERSION, &minor);
                 glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
                 CONTRACT_REQUIRE(std::pair(major, minor) >= std::pair(4, 5), "OpenGL {}.{}", major, minor);
                 CONTRACT_REQUIRE(profile == GL_CONTEXT_CORE_PROFILE_BIT, "its profile is {}", profile);
                 return "";
             }},
            {"its framebuffer is of its size and holds stored sRGB values",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 const GLenum state = glCheckNamedFramebufferStatus(rig.port().framebuffer(), GL_FRAMEBUFFER);
                 CONTRACT_REQUIRE(state == GL_FRAMEBUFFER_COMPLETE, "it cannot be drawn into, status {:#x}", state);
                 fill(rig.port(), 0.5f);
                 const glm::ivec2 last = DisplaySinkRig::kSize - 1;
                 for (const glm::ivec2 pixel : {glm::ivec2(0), last}) {
                     // Half of the light is stored as 188 (IEC 61966-2-1); a framebuffer of linear
                     // values stores 128.
                     const int stored = storedRed(rig.port(), pixel.x, pixel.y);
                     CONTRACT_REQUIRE(stored == 188, "half of the light is stored as {} at {}, {}", stored, pixel.x, pixel.y);
                 }
                 return "";
             }},
            {"leading frames are shown at one refresh after the other, and the display waits for it or for the one before",
             [](DisplaySinkRig& rig) -> std::string {
                 const Time period = fromSeconds(1 / DisplaySinkRig::kRefreshRate);
                 std::int64_t last = -1;
                 for (int frame = 0; frame < 5; ++frame) {
                     CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                     const Time before = rig.clock().now();
                     const std::int64_t next = rig.port().nextRefresh();
                     const Time due = rig.port().refreshTime(next);
                     CONTRACT_REQUIRE(due > before, "at {} s the next refresh is said to be at {} s", seconds(before),
                                      seconds(due));
                     const auto shown = rig.port().present();
                     CONTRACT_SUCCEEDS(shown);
                     CONTRACT_REQUIRE(shown->refresh == next && shown->at == due,
                                      "shown at refresh {} ({} s), the next was {} ({} s)", shown->refresh, seconds(shown->at),
                                      next, seconds(due));
                     CONTRACT_REQUIRE(last < 0 || next == last + 1, "after refresh {} came {}", last, next);
                     last = next;
                     const Time after = rig.clock().now();
                     CONTRACT_REQUIRE(after <= due && after >= due - period - Time(1),
                                      "it came back at {} s, the refresh is at {} s", seconds(after), seconds(due));
                 }
                 return "";
             }},
            {"a following frame is shown within the refresh that is running, without waiting, where the leading one is shown "
             "already",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 rig.manualClock().advance(fromSeconds(3.25 / DisplaySinkRig::kRefreshRate));
                 for (int frame = 0; frame < 2; ++frame) {
                     const Time now = rig.clock().now();
                     const auto shown = rig.port().presentWith(now);
                     CONTRACT_SUCCEEDS(shown);
                     CONTRACT_REQUIRE(rig.clock().now() == now, "it waited {} s", seconds(rig.clock().now() - now));
                     CONTRACT_REQUIRE(shown->at == rig.port().refreshTime(shown->refresh), "refresh {} is not at {} s",
                                      shown->refresh, seconds(shown->at));
                     CONTRACT_REQUIRE(shown->at <= now && now < rig.port().refreshTime(shown->refresh + 1),
                                      "at {} s refresh {} of {} s is not running", seconds(now), shown->refresh,
                                      seconds(shown->at));
                 }
                 return "";
             }},
            {"a following frame is shown with the leading one, and its display does not wait longer than that",
             [](DisplaySinkRig& rig) -> std::string {
                 for (int frame = 0; frame < 5; ++frame) {
                     CONTRACT_SUCCEEDS(rig.otherOutput().makeCurrent());
                     const auto leading = rig.otherOutput().present();
                     CONTRACT_SUCCEEDS(leading);
                     const auto shown = rig.port().presentWith(leading->at);
                     CONTRACT_SUCCEEDS(shown);
                     CONTRACT_REQUIRE(shown->at == leading->at, "the leading frame is shown at {} s, this one at {} s",
                                      seconds(leading->at), seconds(shown->at));
                     CONTRACT_REQUIRE(rig.clock().now() <= leading->at, "it waited until {} s, the refresh is at {} s",
                                      seconds(rig.clock().now()), seconds(leading->at));
                 }
                 return "";
             }},
            {"refreshes are even and counted, shown or not",
             [](DisplaySinkRig& rig) -> std::string {
                 const double period = 1 / DisplaySinkRig::kRefreshRate;
                 for (const std::int64_t number : {1, 2, 1000}) {
                     const double step = seconds(rig.port().refreshTime(number + 1) - rig.port().refreshTime(number));
                     CONTRACT_REQUIRE(std::abs(step - period) < 1e-8, "refresh {} lasts {} s, a period is {} s", number, step,
                                      period);
                 }
                 const std::int64_t before = rig.port().nextRefresh();
                 rig.manualClock().advance(fromSeconds(7 * period));
                 const std::int64_t counted = rig.port().nextRefresh() - before;
                 CONTRACT_REQUIRE(counted == 7, "in 7 periods it counted {} refreshes", counted);
                 return "";
             }},
            {"a slow frame misses refreshes",
             [](DisplaySinkRig& rig) -> std::string {
                 const double period = 1 / DisplaySinkRig::kRefreshRate;
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 CONTRACT_SUCCEEDS(rig.port().present());
                 rig.manualClock().advance(fromSeconds(2.5 * period));  // while the second frame is drawn
                 const Time finished = rig.clock().now();
                 const auto second = rig.port().present();
                 CONTRACT_SUCCEEDS(second);
                 CONTRACT_REQUIRE(second->at > finished && second->at <= finished + fromSeconds(period),
                                  "a frame that was finished at {} s was shown at {} s", seconds(finished), seconds(second->at));
                 return "";
             }},
            // With several outputs on one thread all are drawn before the first is presented.
            {"finish() and present() make their own context current",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 GLuint buffer = 0;
                 glCreateBuffers(1, &buffer);
                 CONTRACT_SUCCEEDS(rig.otherOutput().makeCurrent());
                 CONTRACT_SUCCEEDS(rig.port().finish());
                 CONTRACT_REQUIRE(glIsBuffer(buffer), "after finish() another display's context is current");
                 CONTRACT_SUCCEEDS(rig.otherOutput().makeCurrent());
                 CONTRACT_SUCCEEDS(rig.port().presentWith(rig.clock().now()));
                 CONTRACT_REQUIRE(glIsBuffer(buffer), "after present() another display's context is current");
                 const GLenum error = glGetError();
                 CONTRACT_REQUIRE(error == GL_NO_ERROR, "it leaves the OpenGL error {:#x} behind", error);
                 return "";
             }},
            {"outputs keep their own pictures",
             [](DisplaySinkRig& rig) -> std::string {
                 for (const auto& [sink, light] : {std::pair(&rig.port(), 1.0f), std::pair(&rig.otherOutput(), 0.0f)}) {
                     CONTRACT_SUCCEEDS(sink->makeCurrent());
                     fill(*sink, light);
                     CONTRACT_SUCCEEDS(sink->presentWith(rig.clock().now()));
                 }
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 const int stored = storedRed(rig.port(), 1, 1);
                 CONTRACT_REQUIRE(stored == 255, "its white became {} when another output was drawn", stored);
                 return "";
             }},
            {"a lost display shows nothing, says so and names itself, at once",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_REQUIRE(rig.port().status().onLoss == LossAction::Dark, "a projector without a signal goes dark");
                 rig.lose();
                 const Time before = rig.clock().now();
                 CONTRACT_REQUIRE(!rig.port().poll(), "poll() finds it");
                 for (const bool leads : {true, false}) {
                     const auto shown = leads ? rig.port().present() : rig.port().presentWith(before);
                     CONTRACT_REQUIRE(!shown, "{} claims success", leads ? "present()" : "presentWith()");
                     CONTRACT_REQUIRE(shown.error().message().find(rig.port().status().name) != std::string::npos,
                                      "which display? {}", shown.error().message());
                 }
                 CONTRACT_REQUIRE(rig.clock().now() == before, "it waited {} s", seconds(rig.clock().now() - before));
                 return "";
             }},
            {"what is in its context outlives a loss",
             [](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 GLuint buffer = 0;
                 glCreateBuffers(1, &buffer);
                 const int context = rig.port().context();
                 for (const bool lost : {true, false}) {
                     lost ? rig.lose() : rig.giveBack();
                     CONTRACT_REQUIRE(rig.port().context() == context, "context {} has become {}", context, rig.port().context());
                     CONTRACT_SUCCEEDS(rig.otherOutput().makeCurrent());
                     CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                     CONTRACT_REQUIRE(glIsBuffer(buffer), "after the {} it is gone", lost ? "loss" : "return");
                 }
                 return "";
             }},
            {"a context that is lost is told by poll(), and another one follows",
             [serves](DisplaySinkRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 GLuint buffer = 0;
                 glCreateBuffers(1, &buffer);
                 const int context = rig.port().context();
                 CONTRACT_REQUIRE(context > 0, "its context has the number {}", context);
                 if (!rig.loseContext()) return "";
                 CONTRACT_REQUIRE(!rig.port().present(), "present() claims success");
                 CONTRACT_REQUIRE(rig.port().context() == context, "present() tells of it, and only poll() may");
                 for (int time = 0; time < 2; ++time) {
                     CONTRACT_REQUIRE(!rig.port().poll(), "poll() does not find it");
                     CONTRACT_REQUIRE(rig.port().context() == 0, "without a context it has number {}", rig.port().context());
                     CONTRACT_REQUIRE(!rig.port().makeCurrent(), "the lost context is current");
                     CONTRACT_REQUIRE(!rig.port().presentWith(rig.clock().now()), "presentWith() claims success");
                     if (auto wrong = misreports(rig.port(), false); !wrong.empty()) return wrong;
                 }
                 CONTRACT_REQUIRE(rig.port().status().losses == 1, "{} losses", rig.port().status().losses);
                 (void)rig.otherOutput().poll();
                 (void)rig.otherOutput().poll();  // the other one releases it, too
                 rig.manualClock().advance(DisplaySinkRig::kRetry);
                 CONTRACT_REQUIRE(rig.port().poll(), "it does not come back: {}", rig.port().status().detail);
                 CONTRACT_REQUIRE(rig.port().context() > context, "the next context has number {} after {}", rig.port().context(),
                                  context);
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 CONTRACT_REQUIRE(!glIsBuffer(buffer), "it is the same context");
                 return serves(rig);
             }},
            // So that its contents can be prepared before people watch.
            {"a display that is missing at the start has its context all the same",
             [](DisplaySinkRig& rig) -> std::string {
                 rig.unplug();
                 rig.reopen();
                 CONTRACT_REQUIRE(!rig.port().poll(), "poll() finds it");
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 fill(rig.port(), 1);
                 GLuint buffer = 0;
                 glCreateBuffers(1, &buffer);
                 rig.giveBack();
                 CONTRACT_SUCCEEDS(rig.otherOutput().makeCurrent());
                 CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                 CONTRACT_REQUIRE(glIsBuffer(buffer), "once it is there it is another one");
                 CONTRACT_REQUIRE(storedRed(rig.port(), 1, 1) == 255, "what was drawn before it came is lost");
                 return "";
             }},
            {"a picture is shown when it says, and handing it over takes no longer than the call",
             [](DisplaySinkRig& rig) -> std::string {
                 for (const bool leads : {true, false}) {
                     const Time before = rig.clock().now();
                     CONTRACT_SUCCEEDS(rig.port().makeCurrent());
                     CONTRACT_SUCCEEDS(rig.port().finish());
                     const auto shown = leads ? rig.port().present() : rig.port().presentWith(before);
                     CONTRACT_SUCCEEDS(shown);
                     const Time after = rig.clock().now();
                     CONTRACT_REQUIRE(shown->swapped == shown->at || (before <= shown->swapped && shown->swapped <= after),
                                      "called from {} s to {} s it swapped at {} s", seconds(before), seconds(after),
                                      seconds(shown->swapped));
                     CONTRACT_REQUIRE(Time{} <= shown->swap && shown->swap <= after - before, "the swap took {} s of {} s",
                                      seconds(shown->swap), seconds(after - before));
                 }
                 return "";
             }},
        });
}

}  // namespace fantascope::contract
