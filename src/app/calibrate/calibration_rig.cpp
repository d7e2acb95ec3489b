#include "app/calibrate/calibration_rig.h"

#include "render/frame_tap.h"
#include "show/cue_list.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace fantascope::app {
namespace {

constexpr double kSiteRate = 240;  // Hz; a simulated camera frame is exposed at most a tick late
constexpr Time kStartUp = std::chrono::milliseconds(100);

// Nothing is ever cued: the outputs' overlays are all that is seen.
std::shared_ptr<const show::CueList> darkList(const show::Site& site) {
    auto list = std::make_shared<show::CueList>();
    list->dark.outputs.resize(site.outputs.size());
    list->dark.levels.assign(site.channelCount(), 0);
    for (const show::Relay& relay : site.relays) list->dark.relays.push_back(relay.safe ? 1 : 0);
    return list;
}

show::Site withoutLights(show::Site site) {
    site.universes.clear();
    site.fixtures.clear();
    site.relayBanks.clear();
    site.relays.clear();
    site.cueController.reset();
    site.buttons.clear();
    site.contactBanks.clear();
    site.contacts.clear();
    return site;
}

}  // namespace

Result<std::unique_ptr<CalibrationRig>> CalibrationRig::open(const show::Site& site, const Options& options,
                                                             const Interrupt& interrupt) {
    if (!site.camera)
        return Error(fmt::format("{}: there is no camera to calibrate with; add one (docs/site-format.md)", site.file.string()));
    std::unique_ptr<CalibrationRig> rig(new CalibrationRig(site, options));
    TRY(rig->begin(options, interrupt));
    return rig;
}

CalibrationRig::CalibrationRig(const show::Site& site, const Options& options)
    : used_(options.simulate ? site : withoutLights(site)) {
    clock_ = options.simulate ? static_cast<Clock*>(&stepped_) : &steady_;
}

Result<void> CalibrationRig::begin(const Options& options, const Interrupt& interrupt) {
    if (!options.simulate) claims_ = TRY(SiteClaims::take(used_, interrupt));
    open_ =
        TRY(OpenSite::open(used_, options.simulate ? Backends::SimulatedHeadless : Backends::AsDeclared, options.seed, *clock_));
    inputs_ = std::make_unique<show::InputLog>(darkList(used_));
    frames_ = std::make_unique<FrameLoop>(used_, *inputs_, render::PictureSources(), options.assets, open_->devices, *clock_);
    if (open_->simulation)
        for (std::size_t output = 0; output < used_.outputs.size(); ++output)
            wall_.push_back(&frames_->tap(output).addNewest(std::numeric_limits<double>::infinity()));
    TRY(frames_->prepare());
    for (std::size_t output = 0; output < used_.outputs.size(); ++output) show(output, nullptr);
    const show::ShowClock showClock(frames_->refreshFrom(clock_->now() + kStartUp));
    frames_->begin(showClock);
    if (open_->simulation) {
        open_->simulation->begin(showClock.runStart());
        stepped_.setParts({{"site", kSiteRate, showClock.runStart(),
                            [this](Time moment) {
                                for (render::NewestFrame* projector : wall_)
                                    if (const render::ShownFrame* frame = projector->next(moment))
                                        open_->world.setFrame(used_.outputs[frame->output].name,
                                                              std::make_shared<const RgbaImage>(frame->image));
                                open_->simulation->advanceTo(moment);
                            },
                            Rank::Watch}});
    }
    clock_->sleepUntil(showClock.runStart());
    return {};
}

CalibrationRig::~CalibrationRig() { stepped_.setParts({}); }

void CalibrationRig::show(std::size_t output, std::shared_ptr<const RgbaImage> picture) {
    const show::Output& site = used_.outputs[output];
    if (!picture) picture = std::make_shared<const RgbaImage>(site.size().x, site.size().y);
    // An overlay lies over everything in the projector's own pixels and values.
    auto& slot = frames_->settingsOf(output);
    slot.writable() =
        std::make_shared<const OutputSettings>(OutputSettings{site.projection, nullptr, std::move(picture), nullptr});
    slot.publish();
}

std::optional<CalibrationRig::Seen> CalibrationRig::step() {
    frames_->step();
    auto frame = open_->devices.camera->newest();
    if (!frame) return std::nullopt;
    return Seen{std::move(frame), clock_->now()};
}

std::string CalibrationRig::cameraTrouble() const {
    const DeviceStatus status = open_->devices.camera->status();
    return status.state == DeviceState::Running ? "" : status.detail;
}

std::string CalibrationRig::outputTrouble(std::size_t output) const {
    const DeviceStatus status = frames_->withFaults(open_->devices.statuses())[output];
    return status.state == DeviceState::Running ? "" : status.detail;
}

}  // namespace fantascope::app
