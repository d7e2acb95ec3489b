#include "app/live/setting_up.h"

#include "app/keys/edit_keys.h"
#include "app/site/site_models.h"

#include "show/site/projection_changes.h"

#include "plot/test_picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace fantascope::app {
namespace {

namespace edit = show::edit;

// A direction that is held on the hand controller this long repeats with every tick.
constexpr Time kHold = std::chrono::milliseconds(400);
// Terminal keys that come closer together than this belong to one movement. It is a little more
// than the delay before a terminal repeats a held key.
constexpr Time kPause = std::chrono::milliseconds(600);

bool isCard(TestPicture picture) { return picture == TestPicture::Bars || picture == TestPicture::Ramp; }
// Pictures for judging light are shown with blends. Pictures for judging positions are shown
// without, so that all of each output is visible.
bool blendsShow(TestPicture picture) { return picture == TestPicture::None || isCard(picture); }

}  // namespace

SettingUp::SettingUp(const show::Site& site, FrameLoop& frames, Devices& devices, const show::ShowClock& showClock,
                     show::EventLog& events)
    : frames_(frames),
      devices_(devices),
      showClock_(showClock),
      events_(events),
      editor_(site),
      drawn_(site.outputs.size()),
      blends_(site.outputs.size()) {
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        drawn_[i].warp = site.outputs[i].projection.warp.shape();
        drawn_[i].canvasAspect = site.outputs[i].projection.canvasAspect;
        drawn_[i].light = site.outputs[i].projection.light;
        drawn_[i].masks = site.outputs[i].projection.masks;
    }
    // From here on, changes of the file by others are noticed. A file that cannot be edited is
    // reported when it is to be written.
    if (auto document = ConfigDocument::load(site.file)) document_ = std::move(*document);
}

bool SettingUp::unsaved() const { return !editor_.unsaved().empty(); }

bool SettingUp::key(const Key& key) {
    const bool begins = key == Key{.letter = 'e'};
    if (!on_ && !begins) return false;
    presses_.append(Press{.key = key});
    return true;
}

void SettingUp::button(show::Button button, bool pressed) { presses_.append(Press{.button = button, .pressed = pressed}); }

void SettingUp::adopt(std::vector<Projection> projections) {
    adopted_.writable() = std::move(projections);
    adopted_.publish();
}

void SettingUp::takeOver() {
    const bool isNew = adopted_.update();
    adopts_ = adopts_ || isNew;
    if (!adopts_) return;
    const show::Site& site = editor_.site();
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < site.outputs.size(); ++i)
        if (!show::projectionChanges(site.outputs[i].projection, adopted_.value()[i], i).empty())
            changed.push_back(site.outputs[i].name);
    if (!changed.empty() && unsaved()) {
        if (isNew)
            tell(show::event::RevisionRefused{site.file.filename().string(),
                                              "what was set up here is not written yet; write it, or undo it"});
        return;
    }
    adopts_ = false;
    if (changed.empty()) return;
    settles_ = static_cast<int>(kRate);
    editor_.adopt(adopted_.value());
    if (auto document = ConfigDocument::load(site.file)) document_ = std::move(*document);
    tell(show::event::SiteAdopted{site.file, fmt::format("{}", fmt::join(changed, ", "))});
}

void SettingUp::tick(Time moment, const std::function<void(const Key&, Time)>& other) {
    now_ = moment;
    moved_ = false;
    if (settles_ > 0) --settles_;
    takeOver();
    while (const Press* const press = pressed_.next()) {
        // A terminal does not report the release of a key.
        if (press->key && moment - std::exchange(lastKey_, moment) > kPause) run(edit::Release{});
        if (press->key)
            take(*press->key);
        else
            take(press->button, press->pressed, moment);
    }
    for (std::size_t output = 0; output < devices_.displays.size(); ++output)
        while (const auto event = devices_.displays[output]->pollEvent()) {
            const bool begins = event->kind == ScreenEvent::Kind::KeyDown && event->key == Key{.letter = 'e'};
            if (on_ || begins)
                take(*event, output);
            else if (event->kind == ScreenEvent::Kind::KeyDown)
                other(event->key, event->moment);
        }
    repeatHeld(moment);
    show();
}

void SettingUp::begin() {
    on_ = true;
    legend_ = true;
    message_.clear();
    run(edit::Show{TestPicture::Grid});
    tell(show::event::SettingUpBegan{});
}

void SettingUp::end() {
    on_ = false;
    held_.reset();
    grip_.reset();
    run(edit::Show{TestPicture::None});
    tell(show::event::SettingUpEnded{!unsaved()});
}

void SettingUp::take(const Key& key) {
    if (!on_) return begin();
    if (key == Key{.letter = 'e'} || key.name == Key::Name::Escape) return end();
    if (key == Key{.letter = 'w'} || key.name == Key::Name::Enter) return save();
    if (key == Key{.letter = 'h'}) {
        legend_ = !legend_;
        return;
    }
    const auto& mesh = editor_.site().outputs[editor_.output()].projection.warp.shape().mesh;
    if (const auto command = editCommandFor(key, editor_.tool(), mesh.points)) run(*command);
}

void SettingUp::take(show::Button button, bool pressed, Time moment) {
    using show::Button;
    for (const auto& [which, direction] : {std::pair(Button::Left, glm::dvec2(-1, 0)),
                                           {Button::Right, glm::dvec2(1, 0)},
                                           {Button::Up, glm::dvec2(0, -1)},
                                           {Button::Down, glm::dvec2(0, 1)}}) {
        if (which != button || !on_) continue;
        if (pressed) {
            run(edit::Move{direction});
            held_ = direction;
            heldUntil_ = moment + kHold;
        } else {
            held_.reset();
            run(edit::Release{});
        }
    }
    if (!pressed) return;
    if (button == Button::Edit) return on_ ? end() : begin();
    if (!on_) return;
    if (button == Button::Next) run(edit::Handle{1});
    if (button == Button::Output) run(edit::Output{1});
    if (button == Button::Tool) run(edit::NextTool{});
    if (button == Button::Picture) run(edit::Picture{1});
    if (button == Button::Undo) run(edit::Undo{});
    if (button == Button::Write) save();
}

void SettingUp::repeatHeld(Time moment) {
    if (on_ && held_ && moment >= heldUntil_) run(edit::Move{*held_});
}

void SettingUp::take(const ScreenEvent& event, std::size_t output) {
    using Kind = ScreenEvent::Kind;
    if (event.kind == Kind::KeyDown) return take(event.key);
    if (event.kind == Kind::KeyUp) return run(edit::Release{});
    if (event.kind == Kind::ButtonDown) {
        run(edit::OutputNumber{output});
        run(edit::Grasp{event.at});
        const show::EditHandle handle = editor_.handles()[editor_.handle()];
        if (handle.at) grip_ = *handle.at - event.at;
    }
    if (event.kind == Kind::ButtonUp) {
        grip_.reset();
        run(edit::Release{});
    }
    if (output != editor_.output()) return;
    pointer_ = event.at;
    if (grip_ && event.kind == Kind::PointerMoved) run(edit::MoveTo{event.at + *grip_});
}

void SettingUp::run(const show::EditCommand& command) {
    const std::size_t output = editor_.output();
    const Result<void> done = editor_.apply(command);
    if (editor_.output() != output) pointer_.reset();
    // A message about a key stays readable when the key is released.
    if (!std::holds_alternative<edit::Release>(command)) message_ = done ? "" : done.error().message();
    moved_ |= std::holds_alternative<edit::Move>(command) || std::holds_alternative<edit::MoveTo>(command);
}

void SettingUp::save() {
    const std::filesystem::path& file = editor_.site().file;
    const auto written = [&]() -> Result<void> {
        if (!document_) document_ = TRY(ConfigDocument::load(file));
        TRY(applyChanges(*document_, editor_.site(), editor_.unsaved()));
        return document_->save();
    }();
    if (written) {
        editor_.saved();
        adopts_ = false;
        message_.clear();
        tell(show::event::SiteSaved{file, file.string() + ".previous"});
    } else {
        document_.reset();  // it may contain some of the changes
        message_ = written.error().message();
        tell(show::event::SiteNotSaved{message_});
    }
}

RgbaImage SettingUp::overlayOf(std::size_t output, const Projection& projection, const Drawn& drawn) const {
    const show::Site& site = editor_.site();
    std::vector<plot::EditView::Handle> handles;
    if (drawn.chosen) {
        const auto all = editor_.handles();
        for (std::size_t handle = 0; handle < all.size(); ++handle)
            if (all[handle].at) handles.push_back({*all[handle].at, all[handle].label, handle == drawn.handle});
    }
    return plot::drawEditView({.projection = projection,
                               .aspect = canvasAspectInPixels(site, site.outputs[output].canvas),
                               .name = site.outputs[output].name,
                               .number = static_cast<int>(output) + 1,
                               .picture = drawn.picture,
                               .handles = std::move(handles),
                               .pointer = drawn.pointer,
                               .lines = drawn.lines,
                               .masks = drawn.chosen && drawn.tool == edit::Tool::Masks,
                               .chosen = drawn.chosen});
}

void SettingUp::show() {
    const show::Site& site = editor_.site();
    bool warpsMoved = false;
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        const Projection& projection = site.outputs[i].projection;
        warpsMoved |= drawn_[i].warp != projection.warp.shape();
        blendsDue_ |= drawn_[i].masks != projection.masks || drawn_[i].light.blackLevel != projection.light.blackLevel;
    }
    // Blends take long to compute, so this waits until nothing moves.
    blendsDue_ |= warpsMoved;
    const bool newBlends = blendsDue_ && !moved_ && blendsShow(editor_.picture());
    if (newBlends) {
        for (std::size_t i = 0; i < site.outputs.size(); ++i) blends_[i] = blendOf(site, i);
        blendsDue_ = false;
    }
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        Projection projection = site.outputs[i].projection;
        projection.canvasAspect = warpsMoved ? canvasAspectOf(site, site.outputs[i].canvas) : drawn_[i].canvasAspect;
        Drawn now{.warp = projection.warp.shape(),
                  .canvasAspect = projection.canvasAspect,
                  .picture = editor_.picture(),
                  .on = on_,
                  .chosen = i == editor_.output(),
                  .light = projection.light,
                  .masks = projection.masks};
        if (on_ && now.chosen) {
            now.lines = editor_.lines();
            if (!message_.empty()) now.lines.push_back(message_);
            if (legend_)
                for (const std::string& line : editKeyLegend()) now.lines.push_back(line);
            now.handle = editor_.handle();
            now.tool = editor_.tool();
            now.pointer = pointer_;
        }
        if (now == drawn_[i] && !newBlends) continue;
        auto settings = std::make_shared<OutputSettings>();
        settings->projection = projection;
        if (blendsShow(editor_.picture())) settings->blend = blends_[i];
        if (on_) {
            settings->overlay = std::make_shared<const RgbaImage>(overlayOf(i, projection, now));
            if (isCard(now.picture))
                settings->card = std::make_shared<const RgbaImage>(plot::drawColourCard(now.picture, projection.size));
        }
        drawn_[i] = std::move(now);
        frames_.settingsOf(i).writable() = std::move(settings);
        frames_.settingsOf(i).publish();
    }
}

}  // namespace fantascope::app
