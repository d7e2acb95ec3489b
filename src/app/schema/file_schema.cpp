#include "app/schema/file_schema.h"

#include "app/base/temporary_folder.h"
#include "app/site/site_file.h"

#include "show/show.h"

#include "core/config/config_trace.h"
#include "core/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <variant>

namespace fantascope::app {

namespace {

namespace fs = std::filesystem;
using Asked = ConfigTrace::Asked;

// Finds all that a reader asks for.
class Explorer {
public:
    Explorer(const fs::path& file, const ReadFile& read) : file_(file), read_(read) {}

    Result<void> explore(const std::vector<Report>& examples) {
        waiting_.assign(examples.begin(), examples.end());
        for (; !waiting_.empty(); waiting_.pop_front()) TRY(readNext());
        return {};
    }
    Report schemaAt(const std::string& place) const;

private:
    Result<void> readNext() {
        const Report document = waiting_.front();
        TRY(writeFile(file_, jsonText(document)));  // JSON is YAML
        const ConfigTrace trace(file_);
        read_(file_);
        for (const auto& [place, asked] : trace.places()) {
            merge(places_[place], asked);
            tryBelow(place, asked, document);
        }
        return {};
    }
    static void merge(Asked& all, const Asked& asked) {
        all.numbers.insert(all.numbers.end(), asked.numbers.begin(), asked.numbers.end());
        for (const std::string& choice : asked.choices)
            if (std::ranges::find(all.choices, choice) == all.choices.end()) all.choices.push_back(choice);
        all.isText = all.isText || asked.isText;
        all.isBoolean = all.isBoolean || asked.isBoolean;
        all.isNamed = all.isNamed || asked.isNamed;
        if (asked.least) all.least = std::min(*asked.least, all.least.value_or(*asked.least));
        if (asked.most) all.most = std::max(*asked.most, all.most.value_or(*asked.most));
        if (asked.keys.empty()) return;
        const bool isFirst = all.keys.empty();
        for (auto& [key, isNeeded] : all.keys) isNeeded = isNeeded && asked.keys.contains(key) && asked.keys.at(key);
        for (const auto& [key, isNeeded] : asked.keys) all.keys.try_emplace(key, isNeeded && isFirst);
    }
    // Tries what stands below a place, in a document that has the place.
    void tryBelow(const std::string& place, const Asked& asked, const Report& document) {
        for (const auto& [key, isNeeded] : asked.keys)
            tryAt(place + "." + key, [&](const Report& value) {
                return put(document, asked.way, [&](Report& map) {
                    if (!map.is_object()) map = Report::object();
                    map[key] = value;
                });
            });
        if (asked.isNamed && asked.keys.empty())
            tryAt(place + ".*", [&](const Report& value) {
                return put(document, asked.way, [&](Report& map) { map = {{"x", value}}; });
            });
        if (asked.least)
            tryAt(place + "[]", [&](const Report& value) {
                return put(document, asked.way,
                           [&](Report& list) { list = std::vector<Report>(std::max<std::size_t>(*asked.least, 1), value); });
            });
        for (const std::string& choice : asked.choices)
            if (tried_.insert(place + "=" + choice).second)
                waiting_.push_back(put(document, asked.way, [&](Report& value) { value = choice; }));
    }
    // Tries a word, a map and a list at a place that was not tried before.
    void tryAt(const std::string& place, auto documentWith) {
        if (!tried_.insert(place).second) return;
        for (const Report& value : {Report("1"), Report::object(), Report::array()}) waiting_.push_back(documentWith(value));
    }
    static Report put(Report document, const std::vector<ConfigTrace::Step>& way, auto change) {
        Report* at = &document;
        for (const ConfigTrace::Step& step : way)
            if (const auto* const key = std::get_if<std::string>(&step))
                at = &(*at)[*key];
            else
                at = &(*at)[std::get<std::size_t>(step)];
        change(*at);
        return document;
    }

    const fs::path file_;
    const ReadFile& read_;
    std::deque<Report> waiting_;
    std::set<std::string> tried_;
    std::map<std::string, Asked> places_;
};

// The widest of some ranges.
Report numberOf(const std::vector<ConfigTrace::Number>& ranges) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool isWhole = true;
    for (const auto& range : ranges) {
        low = std::min(low, range.low);
        high = std::max(high, range.high);
        isWhole = isWhole && range.isWhole;
    }
    constexpr double kAny = 1e18;  // no limit that anybody meets
    Report number{{"type", isWhole ? "integer" : "number"}};
    const auto limit = [&](const char* key, double value) {
        if (std::abs(value) >= kAny) return;
        if (isWhole)
            number[key] = static_cast<std::int64_t>(value);
        else
            number[key] = value;
    };
    limit("minimum", low);
    limit("maximum", high);
    return number;
}

Report Explorer::schemaAt(const std::string& place) const {
    const auto found = places_.find(place);
    if (found == places_.end()) return Report::object();
    const Asked& asked = found->second;
    std::vector<Report> forms;
    if (!asked.numbers.empty()) forms.push_back(numberOf(asked.numbers));
    if (asked.isBoolean) forms.push_back({{"type", "boolean"}});
    if (!asked.choices.empty()) forms.push_back({{"enum", asked.choices}});
    if (asked.isText) forms.push_back({{"type", "string"}});
    if (asked.least) {
        Report list{{"type", "array"}, {"items", schemaAt(place + "[]")}, {"minItems", *asked.least}};
        if (asked.most && *asked.most < std::numeric_limits<std::size_t>::max()) list["maxItems"] = *asked.most;
        forms.push_back(std::move(list));
    }
    if (!asked.keys.empty()) {
        Report map{{"type", "object"}, {"properties", Report::object()}, {"additionalProperties", false}};
        for (const auto& [key, isNeeded] : asked.keys) {
            map["properties"][key] = schemaAt(place + "." + key);
            if (isNeeded) map["required"].push_back(key);
        }
        forms.push_back(std::move(map));
    } else if (asked.isNamed) {
        forms.push_back({{"type", "object"}, {"additionalProperties", schemaAt(place + ".*")}});
    }
    if (forms.empty()) return Report::object();
    return forms.size() == 1 ? forms[0] : Report{{"anyOf", forms}};
}

}  // namespace

Result<Report> schemaOf(const std::string& kind, const std::vector<Report>& examples, const ReadFile& read) {
    const TemporaryFolder folder = TRY(TemporaryFolder::make());
    Explorer explorer(folder / (kind + ".yaml"), read);
    TRY(explorer.explore(examples));
    Report schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", fmt::format("A {} of Fantascope", kind)}};
    schema.update(explorer.schemaAt(""));
    schema["properties"]["fantascope"] = {{"const", kind}};
    return schema;
}

Result<Report> showSchema() {
    const Report example = parseJson(R"({"fantascope": "show", "version": "2", "title": "t", "start": "schedule",
        "schedule": {"nights": [{"cue": "c", "from": "sunset"}]}, "sources": {"s": {"solid": ["0", "0", "0"]}},
        "looks": {"l": {}}, "lists": {"b": {"cues": [{"name": "d", "look": "l", "fade": "1"}], "start": "d"}},
        "cues": [{"name": "c", "look": "l", "fade": "1", "with": {"b": "d"}}]})");
    return schemaOf("show", {example}, [](const fs::path& file) { (void)show::Show::load(file); });
}

Result<Report> siteSchema() {
    const Report example = parseJson(R"({"fantascope": "site", "version": "1",
        "outputs": [{"name": "o", "display": {"driver": "headless"}, "size": ["64", "36"], "refresh_rate": "30"}],
        "universes": [{"number": "1", "port": {"driver": "simulated"}}],
        "fixtures": [{"name": "f", "universe": "1", "address": "1", "channels": ["i"]}],
        "relay_banks": [{"name": "b", "device": {"driver": "simulated"}}],
        "relays": [{"name": "r", "coil": "0", "safe": "on"}],
        "contact_banks": [{"name": "k", "device": {"driver": "simulated"}}],
        "contacts": [{"name": "g", "input": "0", "closes": "go"}],
        "cue_controller": {"device": {"driver": "simulated"}, "buttons": {"go": "1"}},
        "camera": {"device": {"driver": "simulated"}, "size": ["64", "36"], "field_of_view": "60",
                   "position": ["0", "1", "9"], "look_at": ["0", "1", "0"]},
        "place": {"latitude": "1", "longitude": "1", "time_zone": "Europe/Vienna"},
        "simulation": {"objects": [{"name": "w", "rectangle": {"corner": ["0", "0", "0"], "right": ["1", "0", "0"], "up": ["0", "1", "0"]}}]}})");
    return schemaOf("site", {example}, [](const fs::path& file) { (void)readSite(file); });
}

}  // namespace fantascope::app
