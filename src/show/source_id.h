#pragma once

#include "core/clock.h"

#include <algorithm>
#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {

// The id of a source. A name keeps its id in every revision of the show and wherever it is in the
// file, until it stands for another picture (SourceNames).
struct SourceId {
    std::uint32_t value = 0;
    friend auto operator<=>(const SourceId&, const SourceId&) = default;
};

// Assigns the ids 0, 1, 2, ... Thread: bound to one thread at a time.
class SourceNames {
public:
    // The id of a name; a new name gets the next id.
    SourceId idOf(const std::string& name) {
        const auto [found, isNew] = ids_.try_emplace(name, next_);
        if (isNew) ++next_;
        return {found->second};
    }
    // From now on the name stands for another picture, and has another id.
    void renew(const std::string& name) { ids_.erase(name); }

private:
    std::map<std::string, std::uint32_t> ids_;
    std::uint32_t next_ = 0;
};

// A map from some sources to values, in the order in which they were added.
template <class Value>
class BySource {
public:
    using Entry = std::pair<SourceId, Value>;

    // The values of the sources with the ids 0, 1, 2, ...: those of the first show that a program
    // reads.
    static BySource numbered(std::vector<Value> values) {
        BySource result;
        for (Value& value : values) result.add({static_cast<std::uint32_t>(result.size())}, std::move(value));
        return result;
    }
    // The source must not have a value yet.
    void add(SourceId source, Value value) { entries_.emplace_back(source, std::move(value)); }

    // The value of a source; null if it has none. Allocates nothing.
    const Value* find(SourceId source) const {
        const auto found = std::ranges::find(entries_, source, &Entry::first);
        return found == entries_.end() ? nullptr : &found->second;
    }
    void eraseIf(auto isGone) {
        std::erase_if(entries_, [&](const Entry& entry) { return isGone(entry.first); });
    }
    auto begin() const { return entries_.begin(); }
    auto end() const { return entries_.end(); }
    std::size_t size() const { return entries_.size(); }

private:
    std::vector<Entry> entries_;
};

// For how long of their own time sources play until they are over. What goes on for ever is not
// there.
using PlayLengths = BySource<Time>;

}  // namespace fantascope::show
