#include "drivers/cue_controller/hid_descriptor.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace fantascope::drivers {
namespace {

// More than any real device has; a descriptor that exceeds these is garbage.
constexpr std::size_t kMaxBits = 8 * 16384, kMaxFields = 16384, kMaxUsages = 4096, kMaxDepth = 64;

// Sections 6.2.2.4, 6.2.2.7 and 6.2.2.8: tag and type of an item, as in its first byte above the
// size.
enum Item : std::uint8_t {
    kInput = 0x80,
    kOutput = 0x90,
    kCollection = 0xa0,
    kFeature = 0xb0,
    kEndCollection = 0xc0,
    kUsagePage = 0x04,
    kLogicalMinimum = 0x14,
    kLogicalMaximum = 0x24,
    kReportSize = 0x74,
    kReportId = 0x84,
    kReportCount = 0x94,
    kPush = 0xa4,
    kPop = 0xb4,
    kUsage = 0x08,
    kUsageMinimum = 0x18,
    kUsageMaximum = 0x28,
    kDelimiter = 0xa8
};
constexpr std::uint8_t kLongItem = 0xfe, kMain = 0x00, kTypeMask = 0x0c;

// Section 6.2.2.5.
constexpr std::uint32_t kConstant = 1 << 0, kVariable = 1 << 1, kRelative = 1 << 2, kWrap = 1 << 3, kNullState = 1 << 6;

// An item's data, signed or unsigned depending on its use.
struct Data {
    std::uint32_t bits = 0;
    int bytes = 0;

    std::int64_t asSigned() const {
        if (bytes == 1) return static_cast<std::int8_t>(bits);
        if (bytes == 2) return static_cast<std::int16_t>(bits);
        return static_cast<std::int32_t>(bits);
    }
};

struct Globals {
    std::uint32_t usagePage = 0, reportSize = 0, reportCount = 0;
    int reportId = 0;
    Data low, high;
};

class Parser {
public:
    explicit Parser(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    Result<HidDescriptor> parse() {
        while (at_ < bytes_.size()) TRY(item());
        if (!collections_.empty()) return wrong("a collection has no end");
        if (inDelimiter_) return wrong("a delimiter has no end");
        if (hasIds_)  // anything before the first id belongs to no report
            for (auto* fields : {&found_.inputs, &found_.outputs, &found_.features})
                std::erase_if(*fields, [](const HidField& field) { return field.report == 0; });
        for (const auto& [id, bits] : ends_[0])
            if (id != 0 || !hasIds_) found_.inputReports.push_back({id, (bits + 7) / 8});
        for (const auto& [id, bits] : ends_[1])
            if (id != 0 || !hasIds_) found_.outputReports.push_back({id, (bits + 7) / 8});
        return std::move(found_);
    }

private:
    Error wrong(const std::string& what) const { return Error(fmt::format("report descriptor, byte {}: {}", start_, what)); }

    Result<void> item() {
        start_ = at_;
        const std::uint8_t prefix = bytes_[at_++];
        if (prefix == kLongItem) {
            if (bytes_.size() - at_ < 2 || bytes_.size() - at_ - 2 < bytes_[at_]) return wrong("it ends inside a long item");
            at_ += 2u + bytes_[at_];
            return {};
        }
        Data data;
        data.bytes = (prefix & 3) == 3 ? 4 : prefix & 3;
        if (bytes_.size() - at_ < static_cast<std::size_t>(data.bytes)) return wrong("it ends inside an item");
        for (int byte = 0; byte < data.bytes; ++byte) data.bits |= std::uint32_t{bytes_[at_++]} << (8 * byte);
        const std::uint8_t what = prefix & 0xfc;
        TRY((what & kTypeMask) == kMain ? main(what, data) : stated(what, data));
        if ((what & kTypeMask) == kMain) {
            usages_.clear();
            usageMinimum_.reset();
            usageMaximum_.reset();
        }
        return {};
    }

    Result<void> main(std::uint8_t what, const Data& data) {
        switch (what) {
            case kInput:
                return fields(found_.inputs, ends_[0], data.bits);
            case kOutput:
                return fields(found_.outputs, ends_[1], data.bits);
            case kFeature:
                return fields(found_.features, ends_[2], data.bits);
            case kCollection:
                if (collections_.size() == kMaxDepth) return wrong("collections are nested too deeply");
                collections_.push_back(usages_.empty() ? 0 : whole(usages_.front().first));
                return {};
            case kEndCollection:
                if (collections_.empty()) return wrong("an end without a collection");
                collections_.pop_back();
                return {};
            default:
                return {};
        }
    }

    // Handles global and local items.
    Result<void> stated(std::uint8_t what, const Data& data) {
        switch (what) {
            case kUsagePage:
                globals_.usagePage = data.bits & 0xffff;
                return {};
            case kLogicalMinimum:
                globals_.low = data;
                return {};
            case kLogicalMaximum:
                globals_.high = data;
                return {};
            case kReportSize:
                globals_.reportSize = data.bits;
                return {};
            case kReportCount:
                globals_.reportCount = data.bits;
                return {};
            case kReportId:
                if (data.bits == 0 || data.bits > 255) return wrong(fmt::format("{} is not a report id", data.bits));
                globals_.reportId = static_cast<int>(data.bits);
                hasIds_ = true;
                return {};
            case kPush:
                if (pushed_.size() == kMaxDepth) return wrong("too many pushes");
                pushed_.push_back(globals_);
                return {};
            case kPop:
                if (pushed_.empty()) return wrong("a pop without a push");
                globals_ = pushed_.back();
                pushed_.pop_back();
                return {};
            case kUsage:
                return usages(data, data);
            case kUsageMinimum:
                usageMinimum_ = data;
                return usageRange();
            case kUsageMaximum:
                usageMaximum_ = data;
                return usageRange();
            case kDelimiter:
                if ((data.bits == 1) == inDelimiter_) return wrong("a delimiter out of place");
                inDelimiter_ = data.bits == 1;
                alternatives_ = 0;
                return {};
            default:
                return {};
        }
    }

    // The two ends may come in either order.
    Result<void> usageRange() {
        if (!usageMinimum_ || !usageMaximum_) return {};
        return usages(*std::exchange(usageMinimum_, {}), *std::exchange(usageMaximum_, {}));
    }

    Result<void> usages(Data first, Data last) {
        // An end without a page takes that of the other.
        if (first.bytes == 4 && last.bytes != 4) last = {(first.bits & 0xffff0000) | (last.bits & 0xffff), 4};
        if (last.bytes == 4 && first.bytes != 4) first = {(last.bits & 0xffff0000) | (first.bits & 0xffff), 4};
        if (first.bits > last.bits || (first.bits ^ last.bits) > 0xffff) return wrong("a range of usages that is invalid");
        if (inDelimiter_ && alternatives_++ > 0) return {};
        if (usages_.size() == kMaxUsages) return wrong("too many usages");
        usages_.push_back({first, last});
        return {};
    }

    // A usage without a page takes the page in force at the main item (section 6.2.2.8).
    HidUsage whole(const Data& usage) const {
        return usage.bytes == 4 ? usage.bits : (globals_.usagePage << 16) | (usage.bits & 0xffff);
    }

    Result<void> fields(std::vector<HidField>& found, std::map<int, std::size_t>& ends, std::uint32_t flags) {
        const std::uint64_t bits = globals_.reportSize, count = globals_.reportCount;
        std::size_t& end = ends.try_emplace(globals_.reportId, globals_.reportId != 0 ? 8u : 0u).first->second;
        if (bits > kMaxBits || count > kMaxBits || bits * count > kMaxBits - std::min(end, kMaxBits))
            return wrong("a report that is too long");
        const std::size_t start = end;
        end += static_cast<std::size_t>(bits * count);
        // Padding, or wider than a number.
        if ((flags & kConstant) != 0 || count == 0 || bits == 0 || bits > 32) return {};

        HidField field;
        field.report = globals_.reportId;
        field.offset = start;
        field.bits = static_cast<int>(bits);
        field.array = (flags & kVariable) == 0;
        field.relative = (flags & kRelative) != 0;
        field.wraps = (flags & kWrap) != 0;
        field.hasNull = (flags & kNullState) != 0;
        field.low = globals_.low.asSigned();
        // Many devices write 25 FF and mean 255: the maximum is signed only if the minimum is
        // negative.
        field.high = field.low < 0 ? globals_.high.asSigned() : std::int64_t{globals_.high.bits};
        field.application = collections_.empty() ? 0 : collections_.front();
        if (field.low > field.high) return wrong(fmt::format("a range from {} to {}", field.low, field.high));

        std::vector<HidUsages> usages;
        for (const auto& [first, last] : usages_) usages.push_back({whole(first), whole(last)});
        if (found.size() + (field.array ? 1 : count) > kMaxFields) return wrong("too many controls");
        if (field.array) {
            field.places = static_cast<int>(count);
            field.usages = std::move(usages);
            found.push_back(std::move(field));
            return {};
        }
        // Usages are assigned one by one; the last one serves all remaining controls.
        std::size_t run = 0;
        HidUsage taken = 0;
        for (std::uint64_t index = 0; index < count; ++index) {
            if (!usages.empty()) {
                const HidUsage usage = usages[run].first + taken;
                field.usages = {{usage, usage}};
                if (usage < usages[run].last)
                    ++taken;
                else if (run + 1 < usages.size()) {
                    ++run;
                    taken = 0;
                }
            }
            found.push_back(field);
            field.offset += static_cast<std::size_t>(bits);
        }
        return {};
    }

    const std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0, start_ = 0;
    Globals globals_;
    std::vector<Globals> pushed_;
    std::vector<std::pair<Data, Data>> usages_;
    std::optional<Data> usageMinimum_, usageMaximum_;
    bool inDelimiter_ = false, hasIds_ = false;
    int alternatives_ = 0;
    std::vector<HidUsage> collections_;
    std::map<int, std::size_t> ends_[3];  // bits so far of each report, per kind
    HidDescriptor found_;
};

}  // namespace

std::size_t HidField::usageCount() const {
    std::size_t count = 0;
    for (const HidUsages& run : usages) count += run.last - run.first + 1;
    return count;
}

std::optional<HidUsage> HidField::usageAt(std::size_t index) const {
    for (const HidUsages& run : usages) {
        const std::size_t length = run.last - run.first + 1;
        if (index < length) return run.first + static_cast<HidUsage>(index);
        index -= length;
    }
    return std::nullopt;
}

std::int64_t HidField::valueIn(std::span<const std::uint8_t> report, int place) const {
    const std::size_t first = offset + static_cast<std::size_t>(place) * static_cast<std::size_t>(bits);
    std::uint64_t raw = 0;  // spans up to five bytes
    for (std::size_t byte = first / 8; byte <= (first + static_cast<std::size_t>(bits) - 1) / 8; ++byte)
        raw |= std::uint64_t{report[byte]} << (8 * (byte - first / 8));
    raw = (raw >> (first % 8)) & ((std::uint64_t{1} << bits) - 1);
    const bool negative = low < 0 && (raw >> (bits - 1)) != 0;
    return static_cast<std::int64_t>(raw) - (negative ? std::int64_t{1} << bits : 0);
}

Result<HidDescriptor> parseHidDescriptor(std::span<const std::uint8_t> bytes) { return Parser(bytes).parse(); }

}  // namespace fantascope::drivers
