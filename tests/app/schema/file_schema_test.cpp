// The schemas that editors get, against the files that the program reads.

#include "app/schema/file_schema.h"

#include "app/running_show.h"

#include "core/config/config.h"
#include "core/file.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// A YAML node as JSON: words that are numbers become numbers.
Report asJson(const ConfigNode& node) {
    if (node.isMap()) {
        Report map = Report::object();
        for (const auto& [key, value] : valueOf(node.entries())) map[key] = asJson(value);
        return map;
    }
    if (node.isList()) {
        Report list = Report::array();
        for (const ConfigNode& item : valueOf(node.items())) list.push_back(asJson(item));
        return list;
    }
    const std::string word = valueOf(node.text());
    if (word == "true" || word == "false") return word == "true";
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error == std::errc() && end == word.data() + word.size()) return number;
    return word;
}

// As much of JSON schema as the schemas use. Empty: `value` is valid. Else what is wrong, and
// where.
std::string faultOf(const Report& value, const Report& schema, const std::string& place = "") {
    const auto fault = [&](const std::string& what) { return place + ": " + what; };
    if (schema.contains("anyOf")) {
        std::string all;
        for (const Report& form : schema["anyOf"]) {
            const std::string one = faultOf(value, form, place);
            if (one.empty()) return "";
            all += one + "; ";
        }
        return all;
    }
    if (schema.contains("const")) return value == schema["const"] ? "" : fault("another word");
    if (schema.contains("enum"))
        return std::ranges::find(schema["enum"], value) != schema["enum"].end() ? "" : fault("none of the words");
    if (!schema.contains("type")) return "";
    const std::string type = schema["type"].get<std::string>();
    if (type == "string") return value.is_string() ? "" : fault("no text");
    if (type == "boolean") return value.is_boolean() ? "" : fault("no boolean");
    if (type == "number" || type == "integer") {
        if (!value.is_number()) return fault("no number");
        const double number = value.get<double>();
        if (number < schema.value("minimum", number) || number > schema.value("maximum", number)) return fault("out of range");
        return type == "integer" && number != std::floor(number) ? fault("no whole number") : "";
    }
    if (type == "array") {
        if (!value.is_array()) return fault("no list");
        if (value.size() < schema.value("minItems", 0u) || value.size() > schema.value("maxItems", value.size()))
            return fault("too many or too few");
        for (std::size_t i = 0; i < value.size(); ++i)
            if (std::string wrong = faultOf(value[i], schema["items"], fmt::format("{}[{}]", place, i)); !wrong.empty())
                return wrong;
        return "";
    }
    if (!value.is_object()) return fault("no map");
    if (schema.contains("required"))
        for (const Report& key : schema["required"])
            if (!value.contains(key.get<std::string>())) return fault("lacks " + key.get<std::string>());
    for (const auto& [key, child] : value.items()) {
        const bool isKnown = schema.contains("properties") && schema["properties"].contains(key);
        const Report& others = schema["additionalProperties"];
        if (!isKnown && !others.is_object()) return fault("unknown key " + key);
        const Report below = isKnown ? schema["properties"][key] : others;
        if (std::string wrong = faultOf(child, below, place + "." + key); !wrong.empty()) return wrong;
    }
    return "";
}

Report exampleIn(const std::string& document) {
    const std::string text = readFile(std::filesystem::path(sourceFolder()) / "docs" / document).value();
    const std::size_t begin = text.find("```yaml\n") + 8;
    return asJson(valueOf(ConfigNode::parse(text.substr(begin, text.find("```", begin) - begin), "example.yaml")));
}

class Schemas : public testing::Test {
protected:
    static const Report& show() {
        static const Report schema = valueOf(showSchema());
        return schema;
    }
    static const Report& site() {
        static const Report schema = valueOf(siteSchema());
        return schema;
    }
};

TEST_F(Schemas, take_every_file_that_the_program_takes) {
    EXPECT_EQ(faultOf(exampleIn("show-format.md"), show()), "");
    EXPECT_EQ(faultOf(exampleIn("site-format.md"), site()), "");
    for (const char* name : {"light-movement", "foliage", "lettering", "menagerie"}) {
        const auto file = sourceFolder() + "/shows/" + name + "/show.yaml";
        EXPECT_EQ(faultOf(asJson(valueOf(ConfigNode::load(file))), show()), "") << name;
    }
    EXPECT_EQ(faultOf(asJson(valueOf(ConfigNode::load(sourceFolder() + "/config/simulated/site.yaml"))), site()), "");
}

// Example failures: the keys of a kind of source that no example has are unknown; a range is that
// of another key.
TEST_F(Schemas, refuse_what_the_program_refuses) {
    const auto faultAfter = [](Report document, const Report& schema, const char* at, const Report& value) {
        document[Report::json_pointer(at)] = value;
        return faultOf(document, schema);
    };
    const Report example = exampleIn("show-format.md"), ofSite = exampleIn("site-format.md");
    const auto showFault = [&](const char* at, const Report& value) { return faultAfter(example, show(), at, value); };
    EXPECT_THAT(showFault("/sorces", 1), HasSubstr("unknown key sorces"));
    EXPECT_THAT(showFault("/fantascope", "site"), HasSubstr(".fantascope: another word"));
    EXPECT_THAT(showFault("/go_interval", 6), HasSubstr(".go_interval: out of range"));
    EXPECT_THAT(showFault("/at_end", "stop"), HasSubstr(".at_end: none of the words"));
    EXPECT_THAT(showFault("/cues/0/fade", Report{{"in", 1}}), HasSubstr(".cues[0].fade: lacks out"));
    EXPECT_THAT(showFault("/cues/0/parts", Report::array()), HasSubstr("too many or too few"));
    EXPECT_THAT(showFault("/sources/pond/caustics/wave_lenght", 1), HasSubstr("unknown key wave_lenght"));
    EXPECT_THAT(showFault("/sources/ball/mirror_ball/radius", "big"), HasSubstr("radius: no number"));
    EXPECT_THAT(showFault("/looks/night/relays/road-north", "open"), HasSubstr("none of the words"));
    EXPECT_EQ(showFault("/sources/opening/video/speed", 2), "") << "which the example does not have";
    EXPECT_EQ(showFault("/cues/0/follow", 3), "") << "a number or a map";
    const auto siteFault = [&](const char* at, const Report& value) { return faultAfter(ofSite, site(), at, value); };
    EXPECT_THAT(siteFault("/outputs/0/refresh_rate", 1000), HasSubstr("refresh_rate: out of range"));
    EXPECT_THAT(siteFault("/cue_controller/buttons/gi", 3), HasSubstr("unknown key gi"));
    EXPECT_EQ(siteFault("/universes/0/port", Report{{"driver", "artnet"}, {"node", "127.0.0.1"}}), "") << "keys of a driver";
}

}  // namespace
}  // namespace fantascope::app
