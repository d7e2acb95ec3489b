#include "drivers/cue_controller/hid_buttons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>

namespace fantascope::drivers {
namespace {

// HID Usage Tables 1.4: usage pages, then usages with their page.
constexpr HidUsage kSimulation = 0x02, kGenericDevice = 0x06, kKeyboard = 0x07, kLed = 0x08, kButton = 0x09, kConsumer = 0x0c,
                   kSensor = 0x20, kPower = 0x84, kBattery = 0x85, kVendorPages = 0xff00;
constexpr HidUsage kPointer = 0x00010001, kMouse = 0x00010002, kMultiAxisController = 0x00010008, kX = 0x00010030,
                   kY = 0x00010031, kWheel = 0x00010038, kHatSwitch = 0x00010039, kErrorRollOver = 0x00070001,
                   kErrorUndefined = 0x00070003;

constexpr int kMaxButtons = 1 << 16;  // a descriptor with more is garbage

constexpr HidUsage pageOf(HidUsage usage) { return usage >> 16; }

// Usages that are no key although they may have one bit: lamps, battery states, measurements, and
// the usages for "nothing pressed".
bool isNoKey(HidUsage usage) {
    const HidUsage page = pageOf(usage);
    return (usage & 0xffff) == 0 || page == kLed || page == kGenericDevice || page == kSensor || page == kPower ||
           page == kBattery || (page == kKeyboard && usage <= kErrorUndefined);
}

// How many usages of an array come before its first key: four on a keyboard.
std::size_t leadOf(const HidField& array) {
    std::size_t lead = 0;
    for (auto usage = array.usageAt(0); lead < 4 && usage && isNoKey(*usage); usage = array.usageAt(lead)) ++lead;
    return lead;
}

std::optional<HidControl::Kind> kindOf(const HidField& field) {
    using Kind = HidControl::Kind;
    const HidUsage usage = field.usage();
    if (field.array) {
        const auto key = field.usageAt(leadOf(field));
        // Some vendors declare plain bytes as an array.
        const bool hasKeys = key && !isNoKey(*key) && pageOf(*key) < kVendorPages;
        return hasKeys ? std::optional(Kind::Keys) : std::nullopt;
    }
    if (field.high == field.low) return std::nullopt;
    const bool hasAxis = (usage >= kX && usage <= kWheel) || pageOf(usage) == kSimulation;
    if (usage == kHatSwitch) return Kind::Hat;
    // Some report how hard they are pressed, and some count from 0.
    if (pageOf(usage) == kButton) return Kind::Key;
    if (isNoKey(usage)) return std::nullopt;
    if (field.high - field.low == 1) return Kind::Key;
    const bool ofPointer = field.application == kMouse || field.application == kPointer;
    if (ofPointer && (usage == kX || usage == kY)) return std::nullopt;
    if (field.relative && field.wraps) return Kind::Counter;
    // A six-axis knob springs back, although many declare themselves relative.
    if (field.relative && field.application != kMultiAxisController)
        return hasAxis || pageOf(usage) == kConsumer ? std::optional(Kind::Wheel) : std::nullopt;
    if (!hasAxis) return std::nullopt;
    return field.wraps ? Kind::Counter : Kind::Axis;
}

std::size_t bytesOf(const HidDescriptor& descriptor, int report) {
    for (const HidReport& known : descriptor.inputReports)
        if (known.id == report) return known.bytes;
    return 0;
}

// Hysteresis: a side is reached at 3/4 of the way to its end and left at 5/8, so a hand at the edge
// presses only once.
bool isBeyond(std::int64_t value, std::int64_t from, std::int64_t to, bool isDown) {
    const double way = static_cast<double>(value - from) / static_cast<double>(to - from);
    return way > (isDown ? 0.625 : 0.75);
}

constexpr std::int64_t kMaxDetents = 127;  // nobody turns further between two reports

using Down = std::set<int>;

// Adds the control's buttons that are down in a report. False: the report does not say.
bool readDown(const HidControl& control, std::span<const std::uint8_t> report, const Down& before, Down& now) {
    const HidField& field = control.field;
    const auto set = [&](int button, bool down) {
        if (down) now.insert(control.first + button);
    };
    if (control.kind == HidControl::Kind::Keys) {
        const std::size_t lead = leadOf(field);
        for (int place = 0; place < field.places; ++place) {
            const std::int64_t value = field.valueIn(report, place);
            if (value < field.low || value > field.high) continue;
            const auto index = static_cast<std::size_t>(value - field.low);
            const auto usage = field.usageAt(index);
            // Too many keys are down to tell them apart; then every place holds this code.
            if (usage && *usage >= kErrorRollOver && *usage <= kErrorUndefined) return false;
            if (usage && index >= lead) set(static_cast<int>(index - lead), true);
        }
        return true;
    }
    std::int64_t value = field.valueIn(report);
    const bool known = value >= field.low && value <= field.high;
    if (control.kind == HidControl::Kind::Hat) {
        // Clockwise from up, in eighths of a turn; a hat at rest is out of its range.
        const std::int64_t eighth = known ? (value - field.low) * 8 / (field.high - field.low + 1) : -1;
        set(0, eighth == 7 || eighth == 0 || eighth == 1);
        set(1, eighth >= 1 && eighth <= 3);
        set(2, eighth >= 3 && eighth <= 5);
        set(3, eighth >= 5);
        return true;
    }
    if (!known && field.hasNull) return false;
    value = std::clamp(value, field.low, field.high);  // many axes exceed their declared range
    const auto wasDown = [&](int button) { return before.contains(control.first + button); };
    if (control.kind == HidControl::Kind::Key) {
        const double way = static_cast<double>(value - field.low) / static_cast<double>(field.high - field.low);
        set(0, way > (wasDown(0) ? 0.375 : 0.5));
        return true;
    }
    set(0, isBeyond(value, field.low, field.high, wasDown(0)));
    set(1, isBeyond(value, field.high, field.low, wasDown(1)));
    return true;
}

// The detents since the last report.
std::int64_t detentsOf(const HidControl& control, std::span<const std::uint8_t> report, std::optional<std::int64_t>& position) {
    const HidField& field = control.field;
    const std::int64_t value = field.valueIn(report);
    if (value < field.low || value > field.high) return 0;
    if (control.kind == HidControl::Kind::Wheel) return std::clamp(value, -kMaxDetents, kMaxDetents);
    const std::int64_t before = std::exchange(position, value).value_or(value), range = field.high - field.low + 1;
    const std::int64_t turned = ((value - before) % range + range) % range;
    // The shorter way round.
    return std::clamp(2 * turned > range ? turned - range : turned, -kMaxDetents, kMaxDetents);
}

std::string keyName(HidUsage usage) {
    static const std::map<HidUsage, std::string_view> kNames = {{0x00070028, "Enter"},         {0x00070029, "Escape"},
                                                                {0x0007002a, "Backspace"},     {0x0007002b, "Tab"},
                                                                {0x0007002c, "Space"},         {0x00070036, "comma"},
                                                                {0x00070037, "period"},        {0x0007004a, "Home"},
                                                                {0x0007004b, "Page Up"},       {0x0007004c, "Delete"},
                                                                {0x0007004d, "End"},           {0x0007004e, "Page Down"},
                                                                {0x0007004f, "Right"},         {0x00070050, "Left"},
                                                                {0x00070051, "Down"},          {0x00070052, "Up"},
                                                                {0x00070054, "keypad slash"},  {0x00070055, "keypad star"},
                                                                {0x00070056, "keypad minus"},  {0x00070057, "keypad plus"},
                                                                {0x00070058, "keypad Enter"},  {0x00070063, "keypad period"},
                                                                {0x000700e0, "left Control"},  {0x000700e1, "left Shift"},
                                                                {0x000700e2, "left Alt"},      {0x000700e3, "left GUI"},
                                                                {0x000700e4, "right Control"}, {0x000700e5, "right Shift"},
                                                                {0x000700e6, "right Alt"},     {0x000700e7, "right GUI"},
                                                                {0x000c00b5, "next track"},    {0x000c00b6, "previous track"},
                                                                {0x000c00b7, "stop"},          {0x000c00cd, "play/pause"},
                                                                {0x000c00e2, "mute"},          {0x000c00e9, "volume up"},
                                                                {0x000c00ea, "volume down"},   {0x00010090, "up"},
                                                                {0x00010091, "down"},          {0x00010092, "right"},
                                                                {0x00010093, "left"}};
    const HidUsage id = usage & 0xffff;
    if (const auto known = kNames.find(usage); known != kNames.end()) return std::string(known->second);
    if (pageOf(usage) == kButton) return fmt::format("button {}", id);
    if (pageOf(usage) == kKeyboard && id >= 0x04 && id <= 0x1d) return std::string(1, static_cast<char>('A' + id - 0x04));
    if (pageOf(usage) == kKeyboard && id >= 0x1e && id <= 0x27) return fmt::format("{}", (id - 0x1e + 1) % 10);
    if (pageOf(usage) == kKeyboard && id >= 0x59 && id <= 0x62) return fmt::format("keypad {}", (id - 0x59 + 1) % 10);
    if (pageOf(usage) == kKeyboard && id >= 0x3a && id <= 0x45) return fmt::format("F{}", id - 0x3a + 1);
    return fmt::format("{} {:#x}", pageOf(usage) == kConsumer ? "consumer" : fmt::format("usage {:#x}", pageOf(usage)), id);
}

std::string axisName(HidUsage usage) {
    constexpr std::array<std::string_view, 9> kNames = {"X", "Y", "Z", "Rx", "Ry", "Rz", "slider", "dial", "wheel"};
    return usage >= kX && usage <= kWheel ? std::string(kNames[usage - kX]) : fmt::format("axis {:#x}", usage);
}

std::string nameOf(const HidControl& control, int index) {
    using Kind = HidControl::Kind;
    const HidUsage usage = control.field.usage();
    const auto place = static_cast<std::size_t>(index);
    if (control.kind == Kind::Keys) return keyName(*control.field.usageAt(leadOf(control.field) + place));
    if (control.kind == Kind::Key) return control.name.empty() ? keyName(usage) : control.name;
    if (control.kind == Kind::Hat) return std::array{"hat up", "hat right", "hat down", "hat left"}[place];
    if (control.kind == Kind::Touch) return control.name;
    const bool springs = control.kind == Kind::Axis;
    return (control.name.empty() ? axisName(usage) : control.name) + (index == 0 ? springs ? " high" : " on"
                                                                      : springs  ? " low"
                                                                                 : " back");
}

}  // namespace

int HidControl::buttons() const {
    if (kind == Kind::Key || kind == Kind::Touch) return 1;
    if (kind == Kind::Keys) return static_cast<int>(field.usageCount() - leadOf(field));
    return kind == Kind::Hat ? 4 : 2;
}

std::vector<HidControl> controlsOf(const std::vector<HidInterface>& interfaces) {
    using Kind = HidControl::Kind;
    const auto turn = [](Kind kind) {
        if (kind == Kind::Key || kind == Kind::Keys) return 0;
        return kind == Kind::Hat ? 1 : kind == Kind::Axis ? 3 : 2;
    };
    std::vector<HidControl> controls;
    for (const HidInterface& interface : interfaces)
        for (const HidField& field : interface.descriptor.inputs)
            if (const auto kind = kindOf(field))
                controls.push_back({*kind, interface.number, bytesOf(interface.descriptor, field.report), field, 0, ""});
    std::stable_sort(controls.begin(), controls.end(), [&](const HidControl& a, const HidControl& b) {
        return std::pair(turn(a.kind), a.interface) < std::pair(turn(b.kind), b.interface);
    });
    int next = 1;
    for (auto control = controls.begin(); control != controls.end(); next += control++->buttons()) {
        if (control->buttons() > kMaxButtons - next) {
            controls.erase(control, controls.end());
            break;
        }
        control->first = next;
    }
    return controls;
}

int buttonOf(const std::vector<HidControl>& controls, HidUsage usage) {
    for (const HidControl& control : controls) {
        if (control.kind == HidControl::Kind::Key && control.field.usage() == usage) return control.first;
        if (control.kind != HidControl::Kind::Keys) continue;
        const std::size_t lead = leadOf(control.field);
        std::size_t before = 0;
        for (const auto& [first, last] : control.field.usages) {
            const std::size_t index = before + (usage - first);
            if (usage >= first && usage <= last && index >= lead) return control.first + static_cast<int>(index - lead);
            before += last - first + 1;
        }
    }
    return 0;
}

int HidLayout::count() const {
    int count = 0;
    for (const HidControl& control : controls) count += control.buttons();
    return count;
}

int HidLayout::numberOf(int button) const {
    const auto place = std::find(firstKeys.begin(), firstKeys.end(), button);
    if (place != firstKeys.end()) return static_cast<int>(place - firstKeys.begin()) + 1;
    const auto before =
        std::count_if(firstKeys.begin(), firstKeys.end(), [&](int other) { return other != 0 && other < button; });
    return static_cast<int>(firstKeys.size()) + button - static_cast<int>(before);
}

std::vector<NamedButton> buttonsOf(const HidLayout& layout) {
    std::vector<NamedButton> buttons;
    for (const HidControl& control : layout.controls)
        for (int index = 0; index < control.buttons(); ++index)
            buttons.push_back({layout.numberOf(control.first + index), nameOf(control, index)});
    std::sort(buttons.begin(), buttons.end(), [](const NamedButton& a, const NamedButton& b) { return a.number < b.number; });
    return buttons;
}

std::vector<ButtonChange> HidButtons::take(int interface, std::span<const std::uint8_t> report) {
    std::vector<ButtonChange> changes, detents;
    Down now = down_;
    for (std::size_t index = 0; index < layout_.controls.size(); ++index) {
        const HidControl& control = layout_.controls[index];
        const int id = control.field.report;
        if (control.interface != interface || report.size() < control.reportBytes || (id != 0 && report[0] != id)) continue;
        if (!std::all_of(control.marks.begin(), control.marks.end(), [&](const HidControl::Mark& mark) {
                return mark.low <= report[mark.at] && report[mark.at] <= mark.high;
            }))
            continue;
        if (control.kind == HidControl::Kind::Touch) {
            const std::int64_t place = control.field.valueIn(report);
            if (control.field.low <= place && place <= control.field.high)
                detents.push_back({layout_.numberOf(control.first), ButtonChange::What::Detent});
            continue;
        }
        if (control.kind == HidControl::Kind::Wheel || control.kind == HidControl::Kind::Counter) {
            const std::int64_t turned = detentsOf(control, report, positions_[index]);
            for (std::int64_t detent = 0; detent < std::abs(turned); ++detent)
                detents.push_back({layout_.numberOf(control.first + (turned > 0 ? 0 : 1)), ButtonChange::What::Detent});
            continue;
        }
        Down read;
        if (!readDown(control, report, down_, read)) continue;
        now.erase(now.lower_bound(control.first), now.lower_bound(control.first + control.buttons()));
        now.merge(read);
    }
    for (const int button : down_)
        if (!now.contains(button)) changes.push_back({layout_.numberOf(button), ButtonChange::What::Up});
    for (const int button : now)
        if (!down_.contains(button)) changes.push_back({layout_.numberOf(button), ButtonChange::What::Down});
    changes.insert(changes.end(), detents.begin(), detents.end());
    down_ = std::move(now);
    return changes;
}

}  // namespace fantascope::drivers
