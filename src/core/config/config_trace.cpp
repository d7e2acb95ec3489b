#include "core/config/config_trace.h"

#include "core/check.h"

#include <utility>

namespace fantascope {
namespace {

thread_local ConfigTrace* listening = nullptr;

}  // namespace

ConfigTrace::ConfigTrace(std::filesystem::path file) : file_(std::move(file)) {
    FANTASCOPE_CHECK(listening == nullptr, "one trace listens at a time");
    listening = this;
}

ConfigTrace::~ConfigTrace() { listening = nullptr; }

ConfigTrace* ConfigTrace::of(const std::filesystem::path& file) {
    return listening != nullptr && listening->file_ == file ? listening : nullptr;
}

ConfigTrace::Asked* ConfigTrace::at(std::uint32_t node) {
    const auto where = nodes_.find(node);
    if (where == nodes_.end()) return nullptr;
    const auto [asked, isNew] = places_.try_emplace(where->second.place);
    if (isNew) asked->second.way = where->second.way;
    return &asked->second;
}

void ConfigTrace::name(std::uint32_t node, std::uint32_t parent, std::string_view place, Step step) {
    Node named = nodes_[parent];
    named.place += place;
    named.way.push_back(std::move(step));
    nodes_[node] = std::move(named);
}

}  // namespace fantascope
