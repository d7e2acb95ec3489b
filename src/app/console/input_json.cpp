#include "app/console/input_json.h"

#include "show/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {

namespace {

using show::Input;
using Kind = Input::Kind;

// Reads the values that a wish has, and knows which were asked for.
class Wish {
public:
    explicit Wish(const Report& json) : json_(json) {}

    Result<std::string> text(const char* key) {
        const Report* const value = TRY(of(key));
        return value->is_string() ? Result<std::string>(value->get<std::string>())
                                  : Error(fmt::format("'{}' is a text in quotes", key));
    }
    Result<bool> boolean(const char* key) {
        const Report* const value = TRY(of(key));
        return value->is_boolean() ? Result<bool>(value->get<bool>()) : Error(fmt::format("'{}' is true or false", key));
    }
    Result<float> level(const char* key) {
        const Report* const value = TRY(of(key));
        const double level = value->is_number() ? value->get<double>() : -1;
        if (!(level >= 0 && level <= 1)) return Error(fmt::format("'{}' is a number from 0 to 1", key));
        return static_cast<float>(level);
    }
    bool has(const char* key) const { return json_.contains(key); }
    // Error: there is a value that nobody has asked for.
    Result<void> finish() const {
        for (const auto& [key, value] : json_.items())
            if (std::ranges::find(known_, key) == known_.end())
                return Error(fmt::format("'{}' is not known here; known are {}", key, fmt::join(known_, ", ")));
        return {};
    }

private:
    Result<const Report*> of(const char* key) {
        known_.emplace_back(key);
        if (!json_.contains(key)) return Error(fmt::format("'{}' is missing", key));
        return &json_.at(key);
    }
    const Report& json_;
    std::vector<std::string> known_{"do", "at", "press"};
};

template <class Range>
Result<int> placeOf(const Range& things, const std::string& name, const char* what) {
    return static_cast<int>(TRY(show::findName(name, show::namesOf(things), what)));
}

// The cue with a number, or else with a name.
Result<int> cueOf(const std::vector<show::Cue>& cues, const std::string& called) {
    for (std::size_t cue = 0; cue < cues.size(); ++cue)
        if (show::textOf(cues[cue].number) == called) return static_cast<int>(cue);
    return placeOf(cues, called, "cue");
}

using Read = std::function<Result<void>(Wish&, Input&, const show::Revision&)>;

Result<void> readNothing(Wish&, Input&, const show::Revision&) { return {}; }
Result<void> readList(Wish& wish, Input& input, const show::Revision& revision) {
    if (!wish.has("list")) return {};
    const std::string name = TRY(wish.text("list"));
    input.list = name.empty() ? 0 : TRY(placeOf(revision.show.sides, name, "list")) + 1;
    return {};
}
Result<void> readCue(Wish& wish, Input& input, const show::Revision& revision) {
    TRY(readList(wish, input, revision));
    input.cue = TRY(cueOf(revision.show.cuesOf(input.list), TRY(wish.text("cue"))));
    return {};
}
Result<void> readDark(Wish& wish, Input& input, const show::Revision&) {
    input.kind = TRY(wish.boolean("on")) ? Kind::Dark : Kind::Light;
    return {};
}
Result<void> readLevel(Wish& wish, Input& input, const show::Revision&) {
    input.level = TRY(wish.level("level"));
    return {};
}
Result<void> readLamp(Wish& wish, Input& input, const show::Revision& revision) {
    const std::string name = TRY(wish.text("lamp"));
    const bool isNone = name.empty() && input.kind == Kind::Highlight;
    input.fixture = isNone ? -1 : TRY(placeOf(revision.site.fixtures, name, "lamp"));
    return {};
}
Result<void> readRaised(Wish& wish, Input& input, const show::Revision& revision) {
    TRY(readLamp(wish, input, revision));
    return readLevel(wish, input, revision);
}
Result<void> readRelay(Wish& wish, Input& input, const show::Revision& revision) {
    input.relay = TRY(placeOf(revision.site.relays, TRY(wish.text("relay")), "relay"));
    input.on = TRY(wish.boolean("on"));
    return {};
}

const struct {
    Kind kind;
    Read read;
} kWishes[] = {
    {Kind::Go, readList},         {Kind::Back, readList},     {Kind::Jump, readCue},       {Kind::Load, readCue},
    {Kind::Blackout, readDark},   {Kind::Pause, readNothing}, {Kind::Freeze, readNothing}, {Kind::Panic, readNothing},
    {Kind::Restore, readNothing}, {Kind::Master, readLevel},  {Kind::Lock, readNothing},   {Kind::Corrections, readNothing},
    {Kind::Highlight, readLamp},  {Kind::Solo, readNothing},  {Kind::Level, readLevel},    {Kind::Park, readLamp},
    {Kind::Raise, readRaised},    {Kind::Switch, readRelay},  {Kind::Release, readNothing}};

}  // namespace

Result<Input> inputFrom(const Report& wish, const show::Revision& revision) {
    if (!wish.is_object()) return Error("a wish is an object: {\"do\": \"go\"}");
    const auto found = wish.find("do");
    const std::string what = found != wish.end() && found->is_string() ? found->get<std::string>() : "";
    const auto known = std::ranges::find_if(kWishes, [&](const auto& each) { return show::nameOf(each.kind) == what; });
    if (known == std::end(kWishes)) {
        std::vector<std::string_view> names;
        for (const auto& each : kWishes) names.push_back(show::nameOf(each.kind));
        return Error(fmt::format("'do' is one of {}", fmt::join(names, ", ")));
    }
    Input input{.kind = known->kind};
    Wish values(wish);
    TRY(known->read(values, input, revision));
    TRY(values.finish());
    return input;
}

}  // namespace fantascope::app
