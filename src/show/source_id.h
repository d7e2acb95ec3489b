#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {

// A picture source of the show. A name keeps its id for the program's life, in every revision of
// the show and wherever it stands in the file (SourceNames).
struct SourceId {
    std::uint32_t value = 0;
    friend auto operator<=>(const SourceId&, const SourceId&) = default;
};

// Gives the ids out: 0, 1, 2, ... Thread: bound to one at a time.
class SourceNames {
public:
    // A name that is new gets the next id.
    SourceId idOf(const std::string& name) {
        return {ids_.try_emplace(name, static_cast<std::uint32_t>(ids_.size())).first->second};
    }

private:
    std::map<std::string, std::uint32_t> ids_;
};

// One value for each of some sources, in the order in which they were added.
template <class Value>
class BySource {
public:
    using Entry = std::pair<SourceId, Value>;

    // Of the sources with the ids 0, 1, 2, ...: those of the first show that a program reads.
    static BySource numbered(std::vector<Value> values) {
        BySource result;
        for (Value& value : values) result.add({static_cast<std::uint32_t>(result.size())}, std::move(value));
        return result;
    }
    // Before: the source has no value.
    void add(SourceId source, Value value) { entries_.emplace_back(source, std::move(value)); }

    // Null: the source has no value. No allocation.
    const Value* find(SourceId source) const {
        const auto found = std::ranges::find(entries_, source, &Entry::first);
        return found == entries_.end() ? nullptr : &found->second;
    }
    auto begin() const { return entries_.begin(); }
    auto end() const { return entries_.end(); }
    std::size_t size() const { return entries_.size(); }

private:
    std::vector<Entry> entries_;
};

}  // namespace fantascope::show
