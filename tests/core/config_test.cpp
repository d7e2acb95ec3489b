#include "core/config.h"

#include <gmock/gmock.h>

namespace fantascope {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Lens {
    std::string name;
    double focal = 35;
    int blades = 5;
};

Result<Lens> readLens(const std::string& text) {
    const ConfigNode node = TRY(ConfigNode::parse(text, "folder/lens.yaml"));
    Lens lens;
    ConfigFields fields(node);
    fields.text("name", lens.name);
    fields.optional().number("focal", lens.focal, 1, 1000, "mm");
    fields.optional().integer("blades", lens.blades, 3, 20);
    TRY(fields.finish());
    return lens;
}

std::string refusal(const std::string& text) {
    const auto lens = readLens(text);
    return lens ? "accepted" : lens.error().message();
}

TEST(Config, reads_values_and_keeps_defaults_of_absent_keys) {
    const auto lens = readLens("name: Nikkor\nfocal: 85.5\n");
    ASSERT_TRUE(lens) << lens.error().message();
    EXPECT_EQ(lens->name, "Nikkor");
    EXPECT_EQ(lens->focal, 85.5);
    EXPECT_EQ(lens->blades, 5);
}

// The operator finds the line without counting. Example failure: lines counted from 0.
TEST(Config, unknown_key_names_file_line_column_and_the_nearest_key) {
    EXPECT_EQ(refusal("name: Nikkor\n  \nfocall: 85\n"), "folder/lens.yaml:3:1: focall: unknown key (did you mean 'focal'?)");
    EXPECT_THAT(refusal("name: Nikkor\nzzzzzz: 1\n"), HasSubstr("known here: name, focal, blades"));
}

TEST(Config, missing_key_wrong_type_and_range_are_refused_with_place_and_advice) {
    EXPECT_EQ(refusal("focal: 10\n"), "folder/lens.yaml:1:1: 'name' is missing");
    EXPECT_EQ(refusal("name: a\nfocal: wide\n"),
              "folder/lens.yaml:2:8: focal: a number in 1 .. 1000 mm is needed, here is 'wide'");
    EXPECT_EQ(refusal("name: a\nfocal: 1001\n"), "folder/lens.yaml:2:8: focal: 1001 is out of range, 1 .. 1000 mm is allowed");
    EXPECT_THAT(refusal("name: a\nblades: 5.5\n"), HasSubstr("a whole number in 3 .. 20 is needed"));
    EXPECT_THAT(refusal("name: [a]\n"), HasSubstr("a text is needed, here is a list"));
    EXPECT_THAT(refusal("name: a\nfocal: .nan\n"), HasSubstr("a number"));
    EXPECT_THAT(refusal("name: a\nname: b\n"), HasSubstr("twice"));
}

TEST(Config, what_is_not_yaml_is_refused_with_its_place) {
    EXPECT_THAT(refusal("name: [a\n"), StartsWith("folder/lens.yaml:"));
    EXPECT_THAT(refusal("- a\n- b\n"), HasSubstr("a map of 'key: value' lines is needed"));
    EXPECT_THAT(refusal(""), HasSubstr("a map"));
}

TEST(Config, of_several_mistakes_the_first_in_the_file_is_named) {
    EXPECT_THAT(refusal("name: a\nblades: 1\nfocal: 0\n"), HasSubstr(":2:9: blades"));
}

TEST(Config, paths_stay_in_the_files_folder) {
    const auto path = [](const std::string& given) {
        const auto node = ConfigNode::parse("p: " + given + "\n", "folder/x.yaml");
        return (*node->entries())[0].second.path();
    };
    EXPECT_EQ(*path("guides/a.png"), "folder/guides/a.png");
    EXPECT_THAT(path("/etc/passwd").error().message(), HasSubstr("absolute"));
    EXPECT_THAT(path("a/../../b").error().message(), HasSubstr("leaves"));
}

TEST(Config, header_refuses_other_kinds_and_newer_versions) {
    const auto read = [](const std::string& text) -> Result<void> {
        const ConfigNode node = TRY(ConfigNode::parse(text, "x"));
        ConfigFields fields(node);
        fields.header("show", 2);
        return fields.finish();
    };
    EXPECT_TRUE(read("fantascope: show\nversion: 1\n"));
    EXPECT_THAT(read("fantascope: site\nversion: 1\n").error().message(),
                HasSubstr("this is a site file, a show file is needed"));
    EXPECT_THAT(read("fantascope: show\nversion: 3\n").error().message(), HasSubstr("newer program"));
}

TEST(Config, shortest_numbers_read_back_exactly) {
    for (const double value : {0.1, 1.0 / 3, 1e-300, -123456789.125, 0.0}) EXPECT_EQ(std::stod(shortest(value)), value);
}

// An editor of another age, or a file that is none of ours.
TEST(ConfigNode, refuses_what_is_not_utf8_with_its_line) {
    const auto refusal = [](const std::string& text) {
        const auto node = ConfigNode::parse(text, "a.yaml");
        return node ? "accepted" : node.error().message();
    };
    EXPECT_EQ(refusal("name: M\xc3\xbcller \xe2\x82\xac \xf0\x9f\x8c\x99\n"), "accepted");
    EXPECT_EQ(refusal("a: 1\nname: M\xfcller\n"), "a.yaml:2: not UTF-8; save the file in that encoding");
    for (const char* broken : {"a: \xc3", "a: \xc3(", "a: \x80", "a: \xc0\xaf", "a: \xe2\x82", "a: \xf8\x88\x80\x80\x80"})
        EXPECT_EQ(refusal(broken), "a.yaml:1: not UTF-8; save the file in that encoding") << broken;
}

}  // namespace
}  // namespace fantascope
