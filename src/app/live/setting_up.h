#pragma once

#include "app/live/frame_loop.h"
#include "app/site/devices.h"

#include "show/play/event.h"
#include "show/play/show_clock.h"
#include "show/site/site_editor.h"

#include "device/screen_event.h"

#include "core/append_log.h"
#include "core/clock.h"
#include "core/config/config_edit.h"
#include "core/latest_value.h"
#include "media/image.h"
#include "media/projection.h"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// Sets up the outputs while the show runs. It turns keys, mouse and the hand controller's buttons
// into the editor's commands, shows the result on the outputs, and writes the site file. When
// setting up ends, the show is seen again, with the new settings.
//
// Drawing and computing take milliseconds and more, so setting up is a part of its own.
// Thread: key() and button() from the input thread, tick() from its part's thread.
class SettingUp {
public:
    // All arguments by reference outlive this, except `showClock`.
    SettingUp(const show::Site& site, FrameLoop& frames, Devices& devices, const show::ShowClock& showClock,
              show::EventLog& events);

    static constexpr double kRate = 30;  // Hz

    bool on() const { return on_; }
    // Whether pictures are moved, or were a moment ago: where the camera sees them says nothing
    // then.
    // Thread: any.
    bool moves() const { return on_ || settles_ > 0; }
    // Takes a key of the terminal. Returns whether it has taken the key. While setting up is on it
    // takes all keys, otherwise only the key that begins it.
    bool key(const Key& key);
    // Takes a press or release of a hand controller's button for setting up.
    void button(show::Button button, bool pressed);
    // The projections of all outputs, as somebody else has saved them. They are taken over with the
    // next tick in which nothing is unsaved here. Thread: one.
    void adopt(std::vector<Projection> projections);
    // Carries out the commands so far. `other` is called with each key at a display that is not for
    // setting up, and with the moment when it was pressed.
    void tick(Time moment, const std::function<void(const Key&, Time)>& other);
    // Whether some settings are not in the file. Call it when the part has ended.
    bool unsaved() const;

private:
    // What an output shows during setting up. It is redrawn only when this differs.
    struct Drawn {
        WarpShape warp{};
        double canvasAspect = 0;
        TestPicture picture = TestPicture::None;
        bool on = false, chosen = false;
        std::vector<std::string> lines{};
        std::size_t handle = 0;
        std::optional<glm::dvec2> pointer{};
        ProjectorLight light{};
        std::vector<Mask> masks{};
        show::edit::Tool tool = show::edit::Tool::Corners;
        friend bool operator==(const Drawn&, const Drawn&) = default;
    };
    struct Press {
        std::optional<Key> key{};
        show::Button button = show::Button::Go;
        bool pressed = false;
    };

    void tell(const show::event::What& what) { events_.append({showClock_.showTime(now_), what}); }
    void begin();
    void end();
    void take(const Key& key);
    void take(show::Button button, bool pressed, Time moment);
    void take(const ScreenEvent& event, std::size_t output);
    void run(const show::EditCommand& command);
    void save();
    void repeatHeld(Time moment);
    RgbaImage overlayOf(std::size_t output, const Projection& projection, const Drawn& drawn) const;
    void show();
    void takeOver();

    FrameLoop& frames_;
    Devices& devices_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    std::atomic<bool> on_ = false;
    std::atomic<int> settles_ = 0;  // so many ticks after pictures were moved at once
    AppendLog<Press> presses_;
    AppendLog<Press>::Reader pressed_ = presses_.reader();

    show::SiteEditor editor_;
    std::optional<ConfigDocument> document_;  // none: the file could not be read or written
    LatestValue<std::vector<Projection>> adopted_;
    bool adopts_ = false;                // the newest of them, once nothing is unsaved
    std::string message_;                // why the last command was refused
    std::optional<glm::dvec2> pointer_;  // on the chosen output
    std::optional<glm::dvec2> grip_;     // from the mouse to the handle that it drags
    bool legend_ = true, moved_ = false;
    std::optional<glm::dvec2> held_;  // the direction held on the hand controller
    Time heldUntil_{}, lastKey_{}, now_{};
    std::vector<Drawn> drawn_;
    std::vector<std::shared_ptr<const render::BlendMap>> blends_;
    bool blendsDue_ = true;
};

}  // namespace fantascope::app
