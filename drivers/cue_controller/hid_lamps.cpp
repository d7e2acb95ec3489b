#include "drivers/cue_controller/hid_lamps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fantascope::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;
using State = ButtonLight::State;

std::uint8_t byteOf(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }
std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xff); }
std::uint8_t high(std::size_t value) { return static_cast<std::uint8_t>(value >> 8 & 0xff); }

// P.I. Engineering's data reports of the XK-24 and of the sticks, and
// https://github.com/Xkeys-Lib/xkeys (core/src/xkeys.ts): 35 bytes without an id, the command
// first.
class XkeysBacklights final : public HidLamps {
public:
    explicit XkeysBacklights(XkeysLamps kind) : kind_(std::move(kind)) {}

    int count() const override { return static_cast<int>(kind_.blue.size()); }

    std::vector<HidOutReport> begin(double brightness) const override {
        const std::uint8_t intensity = byteOf(255 * brightness);
        return {report({kSetIntensity, intensity, kind_.red != 0 ? intensity : std::uint8_t(0)})};
    }

    std::vector<HidOutReport> show(int button, const ButtonLight& light) override {
        if (button < 1 || button > count()) return {};
        const int blue = kind_.blue[static_cast<std::size_t>(button - 1)];
        const bool alarms = light.state == State::Alarm;
        std::uint8_t shown = light.state == State::Off ? kOff : light.state == State::Ready ? kOn : kFlash;
        if (kind_.red == 0) return {backlight(blue, shown)};
        if (alarms) shown = kOff;
        return {backlight(blue, shown), backlight(blue + kind_.red, alarms ? kOn : kOff)};
    }

private:
    static constexpr std::uint8_t kSetBacklight = 181, kSetIntensity = 187;
    static constexpr std::uint8_t kOff = 0, kOn = 1, kFlash = 2;

    static HidOutReport report(Bytes bytes) {
        bytes.resize(35);
        return {0, false, 0, std::move(bytes)};
    }
    static HidOutReport backlight(int index, std::uint8_t shown) {
        return report({kSetBacklight, static_cast<std::uint8_t>(index), shown, 1});
    }

    const XkeysLamps kind_;
};

// https://docs.elgato.com/streamdeck/hid (general, module-6, stream-deck-neo),
// https://github.com/abcminiuser/python-elgato-streamdeck (Devices),
// https://github.com/Julusian/node-elgato-stream-deck (imageWriter). Orientation of the pictures:
// Boatswain's doc/stream-deck.md.
class StreamDeckKeys final : public HidLamps {
public:
    explicit StreamDeckKeys(const StreamDeckLamps& kind) : kind_(kind) {}

    int count() const override { return kind_.keys + kind_.colours; }

    std::vector<HidOutReport> begin(double brightness) const override {
        const std::uint8_t percent = byteOf(100 * brightness);
        // A program before us may have stopped in the middle of a picture; an empty report ends it.
        return {output({}), isMain() ? feature({0x03, 0x08, percent}, 32) : feature({0x05, 0x55, 0xaa, 0xd1, 0x01, percent}, 17)};
    }

    std::vector<HidOutReport> show(int button, const ButtonLight& light) override {
        if (button < 1 || button > count()) return {};
        const int key = button - 1;
        if (key >= kind_.keys) {
            const Rgba8 colour = colourOf(light.state);
            return {feature({0x03, 0x06, low(static_cast<std::size_t>(key)), colour.r, colour.g, colour.b}, 32)};
        }
        const Bytes file = keyPictureFile(light, kind_.picture);
        const std::size_t head = isMain() ? 8 : 16;
        // The first version takes a picture in two halves.
        const std::size_t most = isOriginal() ? file.size() / 2 : reportBytes() - head;
        std::vector<HidOutReport> reports;
        for (std::size_t at = 0; at < file.size(); at += most) {
            const std::size_t count = std::min(most, file.size() - at);
            Bytes bytes = headOf(key, reports.size(), at + count == file.size(), count);
            bytes.insert(bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(at),
                         file.begin() + static_cast<std::ptrdiff_t>(at + count));
            reports.push_back(output(std::move(bytes)));
        }
        return reports;
    }

private:
    bool isMain() const { return kind_.protocol == StreamDeckLamps::Protocol::Main; }
    bool isOriginal() const { return kind_.protocol == StreamDeckLamps::Protocol::Original; }
    std::size_t reportBytes() const { return isOriginal() ? 8191 : 1024; }

    Bytes headOf(int key, std::size_t page, bool last, std::size_t count) const {
        if (isMain()) {
            return {0x02, 0x07, low(static_cast<std::size_t>(key)), last, low(count), high(count), low(page), high(page)};
        }
        if (isOriginal()) {
            const int column = key % kind_.columns;
            key += kind_.columns - 1 - 2 * column;
            ++page;
        }
        Bytes head = {0x02, 0x01, low(page), 0, last, low(static_cast<std::size_t>(key + 1))};
        head.resize(16);
        return head;
    }
    HidOutReport output(Bytes bytes) const {
        bytes.resize(reportBytes());
        bytes[0] = 0x02;
        return {0, false, 0x02, std::move(bytes)};
    }
    static HidOutReport feature(Bytes bytes, std::size_t size) {
        bytes.resize(size);
        return {0, true, bytes[0], std::move(bytes)};
    }

    const StreamDeckLamps kind_;
};

constexpr HidUsage kLedPage = 0x08;

class LedPage final : public HidLamps {
public:
    explicit LedPage(const std::vector<HidInterface>& interfaces) {
        for (const HidInterface& interface : interfaces)
            for (const HidField& field : interface.descriptor.outputs) {
                if (field.array || field.usage() >> 16 != kLedPage || field.high == field.low) continue;
                for (const HidReport& report : interface.descriptor.outputReports)
                    if (report.id == field.report) lamps_.push_back({field, reportOf(interface.number, report)});
            }
    }

    int count() const override { return static_cast<int>(lamps_.size()); }
    std::vector<HidOutReport> begin(double) const override { return {}; }

    std::vector<HidOutReport> show(int button, const ButtonLight& light) override {
        if (button < 1 || button > count()) return {};
        const auto& [field, index] = lamps_[static_cast<std::size_t>(button - 1)];
        HidOutReport& report = reports_[index];
        const auto value = static_cast<std::uint64_t>(light.state == State::Off ? field.low : field.high);
        for (int bit = 0; bit < field.bits; ++bit) {
            const std::size_t at = field.offset + static_cast<std::size_t>(bit);
            const std::uint8_t mask = static_cast<std::uint8_t>(1u << at % 8);
            std::uint8_t& byte = report.bytes[at / 8];
            byte = static_cast<std::uint8_t>((value >> bit & 1) != 0 ? byte | mask : byte & ~mask);
        }
        return {report};  // the whole report, so the other lamps in it keep their state
    }

private:
    // Its index in reports_.
    std::size_t reportOf(int interface, const HidReport& wanted) {
        for (std::size_t i = 0; i < reports_.size(); ++i)
            if (reports_[i].interface == interface && reports_[i].id == wanted.id) return i;
        Bytes bytes(wanted.bytes);
        if (wanted.id != 0) bytes[0] = static_cast<std::uint8_t>(wanted.id);
        reports_.push_back({interface, false, wanted.id, std::move(bytes)});
        return reports_.size() - 1;
    }

    std::vector<std::pair<HidField, std::size_t>> lamps_;  // each with its report
    std::vector<HidOutReport> reports_;
};

}  // namespace

std::unique_ptr<HidLamps> lampsOf(const HidLampKind& kind, const std::vector<HidInterface>& interfaces) {
    std::unique_ptr<HidLamps> lamps;
    if (const auto* xkeys = std::get_if<XkeysLamps>(&kind)) lamps = std::make_unique<XkeysBacklights>(*xkeys);
    if (const auto* deck = std::get_if<StreamDeckLamps>(&kind)) lamps = std::make_unique<StreamDeckKeys>(*deck);
    if (std::holds_alternative<LedPageLamps>(kind)) lamps = std::make_unique<LedPage>(interfaces);
    return lamps != nullptr && lamps->count() > 0 ? std::move(lamps) : nullptr;
}

}  // namespace fantascope::drivers
