#include "app/command/device_trial.h"

#include "app/live/run_report.h"

#include "core/text.h"
#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr Time kAtOnce = 10ms;     // fast enough for a finger
constexpr Time kToBeSeen = 400ms;  // how long a fixture or a relay keeps its state

std::string shown(const std::vector<bool>& states) {
    std::string text;
    for (const bool on : states) text += on ? " on" : " off";
    return text;
}

// "sculpture intensity (slot 1)", "slot 1". Slots count from 1, coils and inputs from 0, as in the
// site file.
std::string called(const DeviceTrial::Names& names, std::size_t place, std::string_view kind, std::size_t number) {
    const std::string plain = fmt::format("{} {}", kind, number);
    const auto found = names.find(place);
    return found == names.end() ? plain : fmt::format("{} ({})", found->second, plain);
}
std::string slotCalled(const DeviceTrial::Names& names, std::size_t slot) { return called(names, slot, "slot", slot + 1); }

// The mean of a picture's stored values, 0..1.
double brightnessOf(const RgbaImage& image) {
    double sum = 0;
    for (const Rgba8 pixel : image.pixels()) sum += pixel.r + pixel.g + pixel.b;
    return image.empty() ? 0 : sum / (3 * 255.0 * static_cast<double>(image.pixels().size()));
}

}  // namespace

Result<void> DeviceTrial::every(Time period, const Device& device, const std::function<Result<void>()>& step) {
    std::optional<std::string> missing;  // and why
    bool wasThere = false;
    for (Time moment = clock_.now();; moment = std::max(moment + period, clock_.now())) {
        clock_.sleepUntil(moment);
        if (!goesOn()) break;
        const DeviceStatus status = device.status();
        if (status.state == DeviceState::Running) {
            if (missing || !wasThere) out_ << fmt::format("{} ({}) is there", status.name, status.driver) << std::endl;
            missing.reset();
            wasThere = true;
            TRY(step());
        } else if (missing != status.detail) {
            missing = status.detail;
            out_ << fmt::format("{} ({}) is {}: {}", status.name, status.driver, nameOf(status.state), printable(status.detail))
                 << std::endl;
        }
    }
    if (!wasThere) return Error(device.status().name + " was not there");
    return {};
}

Result<void> DeviceTrial::chase(DmxPort& port, const std::vector<std::size_t>& slots, const Names& names) {
    std::array<std::uint8_t, kDmxSlots> frame{};
    std::size_t next = 0;
    const auto tried = every(kToBeSeen, port, [&]() -> Result<void> {
        const std::size_t slot = slots[next++ % slots.size()];
        frame.fill(0);
        frame[slot] = 255;
        out_ << fmt::format("{} is at full", slotCalled(names, slot)) << std::endl;
        (void)port.send(frame);  // lost just now: the next round reports it
        return {};
    });
    frame.fill(0);
    (void)port.send(frame);
    return tried;
}

Result<void> DeviceTrial::click(RelayBank& bank, const std::vector<bool>& safeStates, const Names& names, RelayGuard* guard) {
    std::vector<std::size_t> relays;
    for (std::size_t coil = 0; coil < safeStates.size(); ++coil)
        if (names.empty() || names.contains(coil)) relays.push_back(coil);
    std::size_t next = 0;
    auto tried = every(kToBeSeen, bank, [&]() -> Result<void> {
        if (guard != nullptr) guard->arm();
        std::vector<bool> states = safeStates;
        const std::size_t relay = relays[next / 2 % relays.size()];
        if (next++ % 2 == 0) states[relay] = !states[relay];
        if (const auto written = bank.write(states); !written) {
            out_ << written.error().message() << std::endl;
            return {};
        }
        const auto read = bank.read();
        if (!read) return {};
        out_ << fmt::format("{} is {}; the bank says{}", called(names, relay, "coil", relay), states[relay] ? "on" : "off",
                            shown(*read))
             << std::endl;
        if (*read == states) return {};
        std::string wrong;
        for (const std::size_t coil : relays)
            if ((*read)[coil] != states[coil]) wrong += (wrong.empty() ? ": look at " : ", ") + called(names, coil, "coil", coil);
        return Error(fmt::format("{} was told{} and says{}{}", bank.status().name, shown(states), shown(*read),
                                 names.empty() ? "" : wrong));
    });
    if (next == 0) return tried;  // nothing was switched
    const auto safe = bank.write(safeStates);
    if (safe) {
        if (guard != nullptr) guard->dismiss();
        return tried;
    }
    const std::string unsafe = sentenceOf({{bank.status().name, safe.error().message()}});
    return Error(tried ? unsafe : tried.error().message() + "; " + unsafe);
}

Result<void> DeviceTrial::tellPresses(CueController& controller, const Names& names) {
    return every(kAtOnce, controller, [&]() -> Result<void> {
        while (const auto event = controller.poll())
            out_ << fmt::format(
                        "{} {}",
                        called(names, static_cast<std::size_t>(event->button), "button", static_cast<std::size_t>(event->button)),
                        event->pressed ? "down" : "up")
                 << std::endl;
        return {};
    });
}

Result<void> DeviceTrial::tellContacts(InputBank& bank, const Names& names) {
    return every(kAtOnce, bank, [&]() -> Result<void> {
        while (const auto change = bank.poll())
            out_ << fmt::format("{} {}{}", called(names, change->contact, "input", change->contact),
                                change->closed ? "closed" : "open", change->witnessed ? "" : ", as it was found")
                 << std::endl;
        return {};
    });
}

Result<void> DeviceTrial::tellDesk(DmxSource& source, const Names& names) {
    std::map<std::string, DmxInput> last;
    return every(kAtOnce, source, [&]() -> Result<void> {
        while (const auto frame = source.receive()) {
            const auto [known, isNew] = last.try_emplace(frame->source, *frame);
            if (isNew) out_ << fmt::format("'{}' sends with priority {}", frame->source, frame->priority) << std::endl;
            for (std::size_t slot = 0; slot < kDmxSlots; ++slot)
                if (isNew ? frame->slots[slot] != 0 : frame->slots[slot] != known->second.slots[slot])
                    out_ << fmt::format("'{}': {} is {}", frame->source, slotCalled(names, slot), frame->slots[slot])
                         << std::endl;
            known->second = *frame;
        }
        return {};
    });
}

Result<void> DeviceTrial::snapshot(CameraSource& camera, const std::filesystem::path& file) {
    std::shared_ptr<const CameraFrame> first, newest;
    std::uint64_t frames = 0;
    TRY(every(kAtOnce, camera, [&]() -> Result<void> {
        auto frame = camera.newest();
        if (!frame) return {};
        ++frames;
        newest = std::move(frame);
        if (first) return {};
        first = newest;
        TRY(writePng(file, first->image));
        out_ << fmt::format("{}: {} x {}, brightness {:.2f} of 1", file.string(), first->image.width(), first->image.height(),
                            brightnessOf(first->image))
             << std::endl;
        return {};
    }));
    if (!first) return Error(camera.status().name + " is there and gives no picture");
    if (newest->exposed > first->exposed)
        out_ << fmt::format("{:.1f} pictures a second, {} missed",
                            static_cast<double>(frames - 1) / seconds(newest->exposed - first->exposed),
                            newest->sequence - first->sequence + 1 - frames)
             << std::endl;
    return {};
}

}  // namespace fantascope::app
