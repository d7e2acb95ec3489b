#pragma once

#include "app/live/frame_loop.h"
#include "app/site/devices.h"

#include "show/event.h"
#include "show/show_clock.h"
#include "show/site/site_editor.h"

#include "device/screen_event.h"

#include "core/append_log.h"
#include "core/clock.h"
#include "core/config/config_edit.h"
#include "media/image.h"

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// Sets the outputs up while the show runs: turns keys, mouse and the hand controller's buttons into
// the editor's commands, shows what comes of them on the outputs, and writes the site file. Away
// from it the show is as it was, with the new settings.
//
// What it draws and works out takes milliseconds and more, so it has a part of the run for itself.
// Thread: key() and button() from the input thread, tick() from its part's.
class SettingUp {
public:
    // All outlive it, but for the clock.
    SettingUp(const show::Site& site, FrameLoop& frames, Devices& devices, const show::ShowClock& showClock,
              show::EventLog& events);

    static constexpr double kRate = 30;  // Hz

    bool on() const { return on_; }
    // A key of the terminal. Returns whether it is taken: all are while it is on, and before that
    // the one that begins it.
    bool key(const Key& key);
    // A button of the hand controller with a meaning here.
    void button(show::Button button, bool pressed);
    // Does what was asked for. `other`: keys at the displays that are none of this, and when they
    // were pressed.
    void tick(Time moment, const std::function<void(const Key&, Time)>& other);
    // Whether something was set that the file does not have. When the part has ended.
    bool unsaved() const;

private:
    // What an output shows of the editing: drawn anew only when it differs.
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
    // Where a change of the site as it was read belongs in the file as it stands. Error: its output
    // is gone.
    Result<ConfigPath> inFile(const ConfigPath& path) const;
    void repeatHeld(Time moment);
    RgbaImage overlayOf(std::size_t output, const Projection& projection, const Drawn& drawn) const;
    void show();

    FrameLoop& frames_;
    Devices& devices_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    std::atomic<bool> on_ = false;
    AppendLog<Press> presses_;
    AppendLog<Press>::Reader pressed_ = presses_.reader();

    show::SiteEditor editor_;
    std::optional<ConfigDocument> document_;  // none: it could not be read, or not be written
    std::string message_;                     // why the last command was refused
    std::optional<glm::dvec2> pointer_;       // on the chosen output
    std::optional<glm::dvec2> grip_;          // from the mouse to the handle that it drags
    bool legend_ = true, moved_ = false;
    std::optional<glm::dvec2> held_;  // a direction of the hand controller
    Time heldUntil_{}, lastKey_{}, now_{};
    std::vector<Drawn> drawn_;
    std::vector<std::shared_ptr<const render::BlendMap>> blends_;
    bool blendsDue_ = true;
};

}  // namespace fantascope::app
