#include "core/config/config.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <string>
#include <thread>
#include <vector>

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

// The operator must find the line without counting. Example failure: lines counted from 0.
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

// Example failure: a list that is written once and meant twice is read as nothing at its second
// place.
TEST(Config, an_alias_reads_as_what_it_stands_for_and_so_does_its_key) {
    const auto root = ConfigNode::parse("lenses:\n  - &wide {a: [1, 2]}\n  - *wide\n&b b: *wide\n*b : 3\n", "f");
    ASSERT_TRUE(root) << root.error().message();
    const auto entries = root->entries();
    EXPECT_EQ(entries.error().message(), "f:4:1: 'b' is given twice");
    std::vector<ConfigNode> lenses;
    ConfigFields fields(*root);
    fields.read("lenses", lenses, [](const ConfigNode& list) { return list.items(); });
    ASSERT_EQ(lenses.size(), 2u);
    EXPECT_EQ(lenses[0].entries().value().at(0).second.items().value().at(1).integer(0, 9).value(), 2);
    EXPECT_TRUE(lenses[0] == lenses[1]);
    EXPECT_EQ(lenses[1].error("dark").message(), "f:2:5: lenses[1]: dark") << "the place where it is written";
}

// Example failure: a reader of nested lists never ends.
TEST(Config, an_alias_of_something_that_it_is_in_is_refused) {
    EXPECT_EQ(refusal("name: &a [1, [*a]]\n"), "folder/lens.yaml:1:15: not YAML: an alias stands for something that it is in");
    EXPECT_THAT(refusal("&a name: a\nfocal: *b\n"), StartsWith("folder/lens.yaml:2:8: not YAML:"));
}

// A device that stands on another line of a file's new version is the same device.
TEST(Config, nodes_are_equal_that_read_the_same_wherever_they_stand) {
    const auto deviceOf = [](const std::string& text) {
        const auto entries = ConfigNode::parse(text, "f").value().entries().value();
        return entries.back().second;
    };
    const ConfigNode one = deviceOf("device: {driver: sacn, to: [1, 2]}\n");
    EXPECT_TRUE(one == deviceOf("# moved\nother: 1\ndevice:\n  driver: 'sacn'\n  to:\n  - 1\n  - 2\n"));
    EXPECT_FALSE(one == deviceOf("device: {driver: sacn, to: [1, 3]}\n"));
    EXPECT_FALSE(one == deviceOf("device: {driver: sacn, to: [1, 2, 2]}\n"));
    EXPECT_FALSE(one == deviceOf("device: {driver: sacn, to: '[1, 2]'}\n"));
    EXPECT_FALSE(one == deviceOf("device: {to: [1, 2], driver: sacn}\n")) << "in another order";
    EXPECT_FALSE(one == ConfigNode());
    EXPECT_TRUE(ConfigNode() == ConfigNode());
}

// Each alias doubles what is read. Example failure: comparing two such files takes years.
TEST(Config, a_short_text_that_reads_as_a_huge_tree_is_compared_at_once) {
    std::string text = "a0: &a0 [x, x]\n";
    for (int i = 1; i < 60; ++i) text += fmt::format("a{0}: &a{0} [*a{1}, *a{1}]\n", i, i - 1);
    EXPECT_TRUE(ConfigNode::parse(text, "f").value() == ConfigNode::parse("# the same\n" + text, "g").value());
}

// Drivers and playback read what was loaded on threads of their own; tsan sees a node that changes
// as it is read.
TEST(Config, a_node_may_be_read_on_any_thread) {
    const ConfigNode root = ConfigNode::parse("list: [1, 2, 3, 4]\n", "f").value();
    std::vector<std::jthread> readers;
    std::array<std::int64_t, 4> sums{};
    for (std::int64_t& sum : sums)
        readers.emplace_back([&sum, root] {
            const ConfigNode list = root.entries().value().front().second;
            const std::vector<ConfigNode> items = list.items().value();
            for (const ConfigNode& item : items) sum += item.integer(0, 9).value();
        });
    readers.clear();
    EXPECT_THAT(sums, testing::Each(10));
}

// Example failure: whoever mends a file starts the program once for each mistake.
TEST(Config, all_mistakes_are_told_in_the_files_order) {
    EXPECT_EQ(refusal("zoom: 2\nblades: 1\nfocal: 0\n"),
              "folder/lens.yaml:1:1: zoom: unknown key (known here: name, focal, blades)\n"
              "folder/lens.yaml:1:1: 'name' is missing\n"
              "folder/lens.yaml:2:9: blades: 1 is out of range, 3 .. 20 is allowed\n"
              "folder/lens.yaml:3:8: focal: 0 is out of range, 1 .. 1000 mm is allowed");
}

// Reading continues after a wrong item of a list, and inside a map in it.
TEST(Config, mistakes_in_several_items_are_all_told) {
    const auto node = ConfigNode::parse("lenses:\n  - {a: 1, other: 2}\n  - {a: x}\n  - {a: 3}\n", "f");
    std::vector<double> lenses;
    ConfigFields fields(*node);
    fields.list("lenses", lenses, [](const ConfigNode& item) -> Result<double> {
        double a = 0;
        ConfigFields own(item);
        own.number("a", a, 0, 2);
        TRY(own.finish());
        return a;
    });
    EXPECT_EQ(fields.finish().error().message(),
              "f:2:12: lenses[0].other: unknown key (known here: a)\n"
              "f:3:9: lenses[1].a: a number in 0 .. 2 is needed, here is 'x'\n"
              "f:4:9: lenses[2].a: 3 is out of range, 0 .. 2 is allowed");
}

// Example failure: one typo is reported as "unknown key 'nme'" and as "'name' is missing", at two
// places.
TEST(Config, a_key_that_is_misspelt_is_not_missing_too) {
    for (const char* slip : {"nme", "Name", "namee"})
        EXPECT_EQ(refusal(std::string(slip) + ": Nikkor\n"),
                  "folder/lens.yaml:1:1: " + std::string(slip) + ": unknown key (did you mean 'name'?)");
}

// Whoever pastes two files into one believes that both count.
TEST(Config, a_second_document_is_refused_with_its_place) {
    EXPECT_THAT(refusal("name: a\n---\nname: b\n"), StartsWith("folder/lens.yaml:2:1: a second document begins here"));
    EXPECT_THAT(refusal("---\nname: a\n...\n---\nname: b\n"), StartsWith("folder/lens.yaml:4:1: a second document"));
    EXPECT_EQ(refusal("---\nname: a\n...\n"), "accepted");
    EXPECT_EQ(refusal("# first\n---\nname: a\n"), "accepted");
}

// A foreign file must not control the terminal that shows messages about it.
// Example failure: "\x1b[2J" in a name clears the screen, or a value of 70 KB scrolls everything
// away.
TEST(Config, what_is_quoted_of_a_file_is_harmless_and_short) {
    const std::string escape = "\"\\e[2J\"", longText(70'000, 'x');
    for (const std::string& text :
         {"name: a\nfocal: " + escape, "name: " + escape, "name: a\n" + escape + ": 1", "name: a\nfocal: " + longText,
          "name: " + longText, "name: a\n" + longText.substr(0, 900) + ": 1"}) {
        const std::string message = refusal(text + "\n");
        EXPECT_NE(message, "accepted");
        EXPECT_EQ(message.find('\x1b'), std::string::npos) << message;
        EXPECT_LT(message.size(), 600u);
    }
    EXPECT_THAT(refusal("name: a\nfocal: " + escape + "\n"), HasSubstr("here is '\\x1b[2J'"));
    EXPECT_THAT(refusal("name: a\nfocal: " + longText + "\n"), HasSubstr("xxx...'"));
    EXPECT_THAT(refusal("name: |\n  two\n  lines\n"), HasSubstr("a text on one line without control characters is needed"));
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

// A very old editor, or a foreign file.
TEST(ConfigNode, refuses_what_is_not_utf8_with_its_place) {
    const auto refusal = [](const std::string& text) {
        const auto node = ConfigNode::parse(text, "a.yaml");
        return node ? "accepted" : node.error().message();
    };
    EXPECT_EQ(refusal("name: M\xc3\xbcller \xe2\x82\xac \xf0\x9f\x8c\x99\n"), "accepted");
    EXPECT_EQ(refusal("a: 1\nname: M\xfcller\n"), "a.yaml:2:8: not UTF-8; save the file in that encoding");
    EXPECT_EQ(refusal("n\xc3\xa4me: \xff\n"), "a.yaml:1:7: not UTF-8; save the file in that encoding") << "in characters";
    for (const char* broken : {"a: \xc3", "a: \xc3(", "a: \x80", "a: \xc0\xaf", "a: \xe2\x82", "a: \xf8\x88\x80\x80\x80"})
        EXPECT_EQ(refusal(broken), "a.yaml:1:4: not UTF-8; save the file in that encoding") << broken;
}

}  // namespace
}  // namespace fantascope
