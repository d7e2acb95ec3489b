#pragma once
// A USB HID device's report descriptor, parsed as in the Device Class Definition for Human
// Interface Devices 1.11 (section 6.2.2). Usages are from the HID Usage Tables 1.4.

#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::drivers {

// A control's purpose: usage page in the upper half, usage in the lower. 0x00090001 is button 1; 0:
// unknown.
using HidUsage = std::uint32_t;
struct HidUsages {  // from first to last, inclusive
    HidUsage first = 0, last = 0;
    friend bool operator==(const HidUsages&, const HidUsages&) = default;
};

// One control in a report, or an array: several places, each of which names an asserted control.
struct HidField {
    int report = 0;          // the id of its report; 0: the only report of its interface, without an id
    std::size_t offset = 0;  // bits from the start of the report, its id included
    int bits = 0;            // per place: 1..32
    int places = 1;          // more than one only in arrays
    bool array = false;      // its values are indices into its usages, counted from `low`
    bool relative = false;   // its value is a change
    bool wraps = false;      // its value wraps from one end of the range to the other
    bool hasNull = false;    // values outside the range mean nothing
    std::int64_t low = 0, high = 0;
    std::vector<HidUsages> usages;  // at most one for a variable; for an array in the order of its values
    HidUsage application = 0;       // usage of the outermost collection: a mouse, a keyboard

    HidUsage usage() const { return usages.empty() ? 0 : usages.front().first; }
    std::size_t usageCount() const;
    // An array's usage number `index`; nothing beyond the last.
    std::optional<HidUsage> usageAt(std::size_t index) const;
    // The value at a place. The report must be long enough.
    std::int64_t valueIn(std::span<const std::uint8_t> report, int place = 0) const;
};

struct HidReport {
    int id = 0;
    std::size_t bytes = 0;  // its id included
    friend bool operator==(const HidReport&, const HidReport&) = default;
};

struct HidDescriptor {
    std::vector<HidField> inputs, outputs, features;     // in the descriptor's order, without padding
    std::vector<HidReport> inputReports, outputReports;  // sorted by id
};

// Error: it ends inside an item or a collection, or is invalid; it names the byte. Items that the
// program does not use (long items, reserved tags, units, designators, strings) are skipped; of
// alternative usages (delimiters) the first is taken.
Result<HidDescriptor> parseHidDescriptor(std::span<const std::uint8_t> bytes);

}  // namespace fantascope::drivers
