#pragma once
// What a USB HID device says of its reports: its report descriptor, read as the Device Class
// Definition for Human Interface Devices 1.11 (section 6.2.2) has it. Its tables of usages are the
// HID Usage Tables 1.4.

#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::drivers {

// What a control is for: its usage page in the upper half, its usage in the lower. 0x00090001 is
// button 1; 0 says nothing.
using HidUsage = std::uint32_t;
struct HidUsages {  // from first to last, both included
    HidUsage first = 0, last = 0;
    friend bool operator==(const HidUsages&, const HidUsages&) = default;
};

// One control in a report, or an array of like places that each name a control which is asserted.
struct HidField {
    int report = 0;          // the id of its report; 0: its interface has one report, without an id
    std::size_t offset = 0;  // where it starts: bits from the start of the report, its id included
    int bits = 0;            // of one place: 1..32
    int places = 1;          // more than one in arrays only
    bool array = false;      // its values are indices into its usages, from `low`
    bool relative = false;   // its value is a change
    bool wraps = false;      // its value goes on at the other end of the range
    bool hasNull = false;    // a value outside of the range says nothing
    std::int64_t low = 0, high = 0;
    std::vector<HidUsages> usages;  // one of a variable, or none; an array's in the order of its values
    HidUsage application = 0;       // of the outermost collection: a mouse, a keyboard

    HidUsage usage() const { return usages.empty() ? 0 : usages.front().first; }
    std::size_t usageCount() const;
    // The usage number `index` of an array; nothing beyond its last.
    std::optional<HidUsage> usageAt(std::size_t index) const;
    // What stands at a place. The report must be long enough.
    std::int64_t valueIn(std::span<const std::uint8_t> report, int place = 0) const;
};

struct HidReport {
    int id = 0;
    std::size_t bytes = 0;  // its id included
    friend bool operator==(const HidReport&, const HidReport&) = default;
};

struct HidDescriptor {
    std::vector<HidField> inputs, outputs, features;     // in the descriptor's order; padding left out
    std::vector<HidReport> inputReports, outputReports;  // by id, lowest first
};

// Error: it ends in the middle of an item or a collection, or says what cannot be; with the byte
// where it does. What the program has no use for (long items, reserved tags, units, designators,
// strings) is skipped; of alternative usages (delimiters) the first is taken.
Result<HidDescriptor> parseHidDescriptor(std::span<const std::uint8_t> bytes);

}  // namespace fantascope::drivers
