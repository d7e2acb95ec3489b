#include "core/config/config_edit.h"

#include "core/config/config.h"
#include "core/file.h"
#include "core/random.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>

namespace fantascope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string afterSet(const std::string& text, const ConfigPath& path, const ConfigValue& value) {
    auto document = ConfigDocument::parse(text, "f");
    if (!document) return "unreadable: " + document.error().message();
    const auto set = document->set(path, value);
    if (set) return document->text();
    EXPECT_EQ(document->text(), text) << "a refused change leaves the text as it was";
    return "refused: " + set.error().message();
}

std::string afterErase(const std::string& text, const ConfigPath& path) {
    auto document = ConfigDocument::parse(text, "f");
    if (!document) return "unreadable: " + document.error().message();
    const auto erased = document->erase(path);
    if (erased) return document->text();
    EXPECT_EQ(document->text(), text) << "a refused change leaves the text as it was";
    return "refused: " + erased.error().message();
}

TEST(ConfigEdit, a_number_makes_way_for_another_and_nothing_else_moves) {
    EXPECT_EQ(afterSet("a:   1   # one\nb: 2", {"a"}, 0.25), "a:   0.25   # one\nb: 2");
    EXPECT_EQ(afterSet("a: 1\nb: 2", {"b"}, 30), "a: 1\nb: 30") << "no line end at the end";
    EXPECT_EQ(afterSet("{a: 1,b : 'x' , c: [ ]}", {"b"}, 2), "{a: 1,b : 2 , c: [ ]}");
    EXPECT_EQ(afterSet("a: {\"b\":1}\n", {"a", "b"}, -2), "a: {\"b\": -2}\n") << "needs a blank that was not there";
    EXPECT_EQ(afterSet("a: 1\nb: '# no comment'  # but this\n", {"b"}, "x"), "a: 1\nb: x  # but this\n");
    EXPECT_EQ(afterSet("a: \"two\n  lines\" # c\nb: 1\n", {"a"}, 5), "a: 5 # c\nb: 1\n");
    EXPECT_EQ(afterSet("a: two\n  lines\nb: 1\n", {"a"}, 5), "a: 5\nb: 1\n");
}

TEST(ConfigEdit, what_is_equal_keeps_its_spelling) {
    const std::string text = "a: [1.50, 0x1, \"two\"]\n";
    EXPECT_EQ(afterSet(text, {"a", 0}, 1.5), text);
    EXPECT_EQ(afterSet(text, {"a"}, ConfigValue::List{1.5, 2, "two"}), "a: [1.50, 2, \"two\"]\n");
}

TEST(ConfigEdit, values_are_found_by_their_path) {
    const std::string text = "l:\n- a: [1, {b: 2}]\n- - 3\n  - 4\n\"quoted key\": 5\nünïcödé: 6 # é\n? asked\n: 7\n";
    EXPECT_EQ(afterSet(text, {"l", 0, "a", 1, "b"}, 9),
              "l:\n- a: [1, {b: 9}]\n- - 3\n  - 4\n\"quoted key\": 5\nünïcödé: 6 # é\n? asked\n: 7\n");
    EXPECT_EQ(afterSet(text, {"l", 1, 1}, 9),
              "l:\n- a: [1, {b: 2}]\n- - 3\n  - 9\n\"quoted key\": 5\nünïcödé: 6 # é\n? asked\n: 7\n");
    EXPECT_EQ(afterSet(text, {"quoted key"}, 9),
              "l:\n- a: [1, {b: 2}]\n- - 3\n  - 4\n\"quoted key\": 9\nünïcödé: 6 # é\n? asked\n: 7\n");
    EXPECT_EQ(afterSet(text, {"ünïcödé"}, 9),
              "l:\n- a: [1, {b: 2}]\n- - 3\n  - 4\n\"quoted key\": 5\nünïcödé: 9 # é\n? asked\n: 7\n");
    EXPECT_EQ(afterSet(text, {"asked"}, 9),
              "l:\n- a: [1, {b: 2}]\n- - 3\n  - 4\n\"quoted key\": 5\nünïcödé: 6 # é\n? asked\n: 9\n");
}

TEST(ConfigEdit, texts_are_quoted_where_they_must_be) {
    EXPECT_EQ(afterSet("a: 1\n", {"a"}, "north pole"), "a: north pole\n");
    EXPECT_EQ(afterSet("a: [1]\n", {"a", 0}, "x, y"), "a: [\"x, y\"]\n");
    EXPECT_EQ(afterSet("a: 1\n", {"a"}, "x # y"), "a: \"x # y\"\n");
    EXPECT_EQ(afterSet("a: 1\n", {"a"}, ""), "a: \"\"\n");
    EXPECT_EQ(afterSet("a: 1\n", {"a"}, "~"), "a: \"~\"\n");
    EXPECT_EQ(afterSet("a: 1\n", {"a"}, "é\n\"\\\t"), "a: \"é\\n\\\"\\\\\\t\"\n");
    EXPECT_EQ(afterSet("a: 1\n", {"b: c"}, 2), "a: 1\n\"b: c\": 2\n");
}

TEST(ConfigEdit, a_list_of_lines_is_changed_item_by_item_and_keeps_its_comments) {
    const std::string text =
        "corners:  # from the top left\n  - [12, 8]  # window\n  # the door:\n  - [628, 0]\n\n  -   - 640 # right\n      - 360\n "
        " - [0, 350]\nb: 1\n";
    EXPECT_EQ(afterSet(text, {"corners"}, std::vector<glm::dvec2>{{12.5, 8}, {628, 1}, {640, 361}, {0, 350}}),
              "corners:  # from the top left\n  - [12.5, 8]  # window\n  # the door:\n  - [628, 1]\n\n  -   - 640 # right\n      "
              "- 361\n  - [0, 350]\nb: 1\n");
    EXPECT_EQ(afterSet(text, {"corners"}, std::vector<glm::dvec2>{{1, 2}, {628, 0}}),
              "corners:  # from the top left\n  - [1, 2]  # window\n  # the door:\n  - [628, 0]\n\nb: 1\n");
    EXPECT_EQ(afterSet(text, {"corners"}, 5), "corners: 5  # from the top left\n  # the door:\n\nb: 1\n");
    EXPECT_EQ(afterSet("a:\n- 1\n- 2 # two\n# of b\nb: 1\n", {"a"}, std::array{1, 2, 3}),
              "a:\n- 1\n- 2 # two\n- 3\n# of b\nb: 1\n");
    EXPECT_EQ(afterSet("a:\n  - 1\n  -\n  - - 2\n    - 3", {"a"}, ConfigValue::List{1, 2, ConfigValue::List{2, 3, 4}, 5}),
              "a:\n  - 1\n  - 2\n  - - 2\n    - 3\n    - 4\n  - 5");
}

TEST(ConfigEdit, brackets_stay_brackets_however_they_are_laid_out) {
    EXPECT_EQ(afterSet("a: [ 1,\n     2, # two\n     3 ]\n", {"a"}, std::array{1, 2, 4}), "a: [ 1,\n     2, # two\n     4 ]\n");
    EXPECT_EQ(afterSet("a: [ 1,\n     2  # two\n   ]\n", {"a"}, std::array{1, 2, 4}), "a: [ 1,\n     2, 4  # two\n   ]\n");
    EXPECT_EQ(afterSet("a: [1, 2,]\n", {"a"}, std::array{1, 2, 4}), "a: [1, 2, 4,]\n");
    EXPECT_EQ(afterSet("a: [1, 2, 3]\n", {"a"}, std::array{1}), "a: [1]\n");
    EXPECT_EQ(afterSet("a: [1, # one\n 2, # two\n 3 # three\n]\n", {"a"}, std::array{1, 2}),
              "a: [1, # one\n 2, # two\n  # three\n]\n");
    EXPECT_EQ(afterSet("a: [1, 2]\n", {"a"}, ConfigValue::List{}), "a: []\n");
    EXPECT_EQ(afterSet("a: [ ]\n", {"a"}, std::array{1, 2}), "a: [1, 2]\n");
    EXPECT_EQ(afterSet("a: {b: 1, c: 2, d: 3}\n", {"a"}, ConfigValue::Map{{"e", 4}, {"b", 5}}), "a: {b: 5, e: 4}\n");
    EXPECT_EQ(afterSet("a: {b: 1, c: 2, d: 3}\n", {"a"}, ConfigValue::Map{{"d", 4}}), "a: {d: 4}\n");
    EXPECT_EQ(afterSet("a: {b: 1}\n", {"a"}, ConfigValue::Map{{"c", "x"}}), "a: {c: x}\n");
}

TEST(ConfigEdit, a_long_list_is_broken_and_indented_under_its_key) {
    std::vector<glm::dvec2> points;
    for (int i = 0; i < 20; ++i) points.emplace_back(100 + i, 1000.5);
    EXPECT_EQ(afterSet("m:\n  line: []\n", {"m", "line"}, points),
              "m:\n"
              "  line: [[100, 1000.5], [101, 1000.5], [102, 1000.5], [103, 1000.5], [104, 1000.5], [105, 1000.5], [106, 1000.5], "
              "[107, 1000.5],\n"
              "    [108, 1000.5], [109, 1000.5], [110, 1000.5], [111, 1000.5], [112, 1000.5], [113, 1000.5], [114, 1000.5], "
              "[115, 1000.5],\n"
              "    [116, 1000.5], [117, 1000.5], [118, 1000.5], [119, 1000.5]]\n");
}

TEST(ConfigEdit, a_missing_key_comes_at_the_end_of_its_map_in_its_style) {
    EXPECT_EQ(afterSet("a:\n    b: 1 # one\n\n# of c\nc: 2\n", {"a", "d"}, 3), "a:\n    b: 1 # one\n    d: 3\n\n# of c\nc: 2\n");
    EXPECT_EQ(afterSet("a:\n  - b: 1\n    c:\n      d: 1", {"a", 0, "e"}, 3), "a:\n  - b: 1\n    c:\n      d: 1\n    e: 3");
    EXPECT_EQ(afterSet("a: 1", {"b"}, 2), "a: 1\nb: 2");
    EXPECT_EQ(afterSet("a:\nb: {}\n", {"b", "c"}, 2), "a:\nb: {c: 2}\n");
    EXPECT_EQ(afterSet("a: {b: 1 }\n", {"a", "c"}, 2), "a: {b: 1, c: 2 }\n");
    EXPECT_EQ(afterSet("a: { # none yet\n}\n", {"a", "c"}, 2), "a: { # none yet\nc: 2}\n");
    EXPECT_EQ(afterSet("{}", {"a"}, 2), "{a: 2}");
    EXPECT_EQ(afterSet("a: |\n  text\n  # text\n\n# of b\nb: 1\n", {"c"}, 2), "a: |\n  text\n  # text\n\n# of b\nb: 1\nc: 2\n");
    EXPECT_EQ(afterSet("m:\n  a: |\n    text\n\n# of b\nb: 1\n", {"m", "c"}, 2),
              "m:\n  a: |\n    text\n  c: 2\n\n# of b\nb: 1\n");
    EXPECT_EQ(afterSet("m:\n  a: |+ # keep\n    text\n\n# of b\nb: 1\n", {"m", "c"}, 2),
              "m:\n  a: |+ # keep\n    text\n\n  c: 2\n# of b\nb: 1\n");
    EXPECT_EQ(afterSet("---\na: 1\n...\n", {"b"}, 2), "---\na: 1\nb: 2\n...\n");
}

TEST(ConfigEdit, what_is_missing_on_the_way_is_made) {
    EXPECT_EQ(afterSet("a: 1\n", {"b", "c", "d"}, 2), "a: 1\nb: {c: {d: 2}}\n");
    EXPECT_EQ(afterSet("a:  # later\nb: 1\n", {"a", "c"}, 2), "a: {c: 2}  # later\nb: 1\n");
    EXPECT_EQ(afterSet("a: ~\n", {"a", 0, "b"}, 2), "a: [{b: 2}]\n");
    EXPECT_EQ(afterSet("a: [1]\n", {"a", 1}, 2), "a: [1, 2]\n");
    EXPECT_EQ(afterSet("a:\n- 1\n", {"a", 1, "b"}, 2), "a:\n- 1\n- {b: 2}\n");
    EXPECT_EQ(afterSet("a: [1]\n", {"a", 2}, 2), "refused: f:1:4: a[2]: the list is shorter than that");
    EXPECT_EQ(afterSet("a: 1\n", {"b", 1}, 2), "refused: f:1:1: b[1]: the list is shorter than that");
}

TEST(ConfigEdit, line_ends_and_the_byte_order_mark_stay) {
    EXPECT_EQ(afterSet("\xEF\xBB\xBF"
                       "a: 1 # é\r\nb:\r\n  c: 2\r\n# d\r\n",
                       {"b", "e"}, 3),
              "\xEF\xBB\xBF"
              "a: 1 # é\r\nb:\r\n  c: 2\r\n  e: 3\r\n# d\r\n");
    EXPECT_EQ(afterSet("\xEF\xBB\xBF"
                       "a: 1\n",
                       {"b"}, 3),
              "\xEF\xBB\xBF"
              "a: 1\nb: 3\n");
    EXPECT_EQ(afterSet("a:\r\n  - 1\r\n  - 2\r\nb: 1\r\n", {"a"}, 3), "a: 3\r\nb: 1\r\n");
}

TEST(ConfigEdit, entries_and_items_are_taken_away_with_their_lines) {
    EXPECT_EQ(afterErase("a: 1\n# of b\nb:\n  - 2\n  - 3 # three\nc: 4\n", {"b"}), "a: 1\n# of b\nc: 4\n");
    EXPECT_EQ(afterErase("a: 1\nb: 2", {"b"}), "a: 1");
    EXPECT_EQ(afterErase("a: 1\nb: 2\n", {"a"}), "b: 2\n");
    EXPECT_EQ(afterErase("l:\n  - name: x  # ex\n    size: 1\n", {"l", 0, "name"}), "l:\n  -\n    size: 1\n");
    EXPECT_EQ(afterErase("l: [1, 2, 3]\n", {"l", 0}), "l: [2, 3]\n");
    EXPECT_EQ(afterErase("l: [1, 2, 3]\n", {"l", 1}), "l: [1, 3]\n");
    EXPECT_EQ(afterErase("l: [1,\n    2,\n    3]\n", {"l", 1}), "l: [1,\n    \n    3]\n");
    EXPECT_EQ(afterErase("l: [1]\n", {"l", 0}), "l: []\n");
    EXPECT_EQ(afterErase("m:\n  # why\n  a: 1\nb: 2\n", {"m", "a"}), "m: {}\n  # why\nb: 2\n");
    EXPECT_EQ(afterErase("a: 1\n", {"b", 3, "c"}), "a: 1\n") << "what is not there is gone already";
    EXPECT_EQ(afterErase("a: 1\n", {"a"}), "refused: f:1:4: a: the file's last key cannot be removed");
}

// One place in the text stands for two values, or means more than its value. Example failure:
// changing one projector's corners changes all.
TEST(ConfigEdit, what_would_change_more_than_one_place_is_refused) {
    EXPECT_THAT(afterSet("a: &x [1, 2]\nb: *x\n", {"b"}, 1), HasSubstr("refused: f:2:4: b: an alias (*) stands here"));
    EXPECT_THAT(afterSet("a: &x [1, 2]\nb: *x\n", {"b", 0}, 5),
                HasSubstr("refused: f:2:4: b[0]: this is an alias (*) of another place"));
    EXPECT_THAT(afterSet("a: &x [1, 2]\nb: *x\n", {"a", 0}, 5),
                HasSubstr("refused: f:1:4: a[0]: an alias (*) elsewhere means this place"));
    EXPECT_THAT(afterSet("a: &x [1, 2]\nb: *x\n", {"a"}, 5), HasSubstr("an anchor (&) stands here"));
    EXPECT_THAT(afterSet("a: [&x 1, 2]\nb: *x\n", {"a"}, std::array{1}), HasSubstr("an anchor (&) stands here"));
    EXPECT_THAT(afterSet("a: !!float 3\n", {"a"}, 5), HasSubstr("a tag (!) stands here"));
    EXPECT_THAT(afterErase("a: &x 1\nb: *x\n", {"a"}), HasSubstr("an anchor (&) stands here"));
    EXPECT_THAT(afterSet("a: 1\na: 2\n", {"a"}, 5), HasSubstr("the key 'a' is given twice"));
    EXPECT_THAT(afterSet("a: [b: 1]\n", {"a", 0, "c"}, 5), HasSubstr("change it by hand"));
    EXPECT_THAT(afterSet("a: {b, c}\n", {"a", "b"}, 5), HasSubstr("change it by hand"));
    EXPECT_EQ(afterSet("a: &x {b: 1}\nc: 2\n", {"a", "b"}, 5), "a: &x {b: 5}\nc: 2\n") << "nobody means the anchor";
    EXPECT_EQ(afterSet("a: &x\n  - 1\nc: 2\n", {"a", 1}, 5), "a: &x\n  - 1\n  - 5\nc: 2\n");
    EXPECT_EQ(afterSet("a: &x 1\nb: *x\nc: 2\n", {"c"}, 5), "a: &x 1\nb: *x\nc: 5\n");
}

TEST(ConfigEdit, a_path_through_something_else_is_refused) {
    EXPECT_EQ(afterSet("a: 1\n", {"a", "b"}, 5), "refused: f:1:4: a.b: a map is needed, here is a single value");
    EXPECT_EQ(afterSet("a: [1]\n", {"a", "b"}, 5), "refused: f:1:4: a.b: a map is needed, here is a list");
    EXPECT_EQ(afterSet("a: {}\n", {"a", 0}, 5), "refused: f:1:4: a[0]: a list is needed, here is a map");
}

TEST(ConfigEdit, texts_that_cannot_be_changed_safely_are_refused) {
    const auto why = [](const std::string& text) {
        const auto document = ConfigDocument::parse(text, "f");
        return document ? "accepted" : document.error().message();
    };
    EXPECT_EQ(why("a: 1\n---\nb: 1\n"), "f:2:1: a second document begins here; put it in a file of its own");
    EXPECT_THAT(why("a: [1\n"), HasSubstr("not YAML"));
    EXPECT_THAT(why("- 1\n"), HasSubstr("a map of 'key: value' lines is needed"));
    EXPECT_THAT(why(""), HasSubstr("a map"));
    EXPECT_THAT(why(std::string("\xFF\xFE"
                                "a\0:\0 \0b\0",
                                10)),
                HasSubstr("UTF-16"));
    EXPECT_THAT(why("a: \xFF\n"), HasSubstr("f:1:4: not UTF-8"));
}

// ---- Any document, any path, any value

// A document's contents, read independently of the code under test, by ConfigNode.
struct Tree {
    std::string text;
    std::vector<Tree> items;
    std::map<std::string, Tree> entries;
    enum { Single, List, Map } kind = Single;
};

bool operator==(const Tree& a, const Tree& b) {
    const auto number = [](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        return text.empty() || *end != 0 ? std::optional<double>() : value;
    };
    const bool sameText = a.text == b.text || (number(a.text) && number(a.text) == number(b.text));
    return a.kind == b.kind && sameText && a.items == b.items && a.entries == b.entries;
}

Result<Tree> treeOf(const ConfigNode& node) {
    Tree tree;
    if (node.isMap()) {
        tree.kind = Tree::Map;
        for (const auto& [key, value] : TRY(node.entries())) tree.entries[key] = TRY(treeOf(value));
    } else if (node.isList()) {
        tree.kind = Tree::List;
        for (const ConfigNode& item : TRY(node.items())) tree.items.push_back(TRY(treeOf(item)));
    } else if (const auto text = node.text()) {
        tree.text = *text;
    }
    return tree;
}

Tree treeOf(const ConfigValue& value) {
    Tree tree;
    if (value.number() != nullptr) tree.text = shortest(*value.number());
    if (value.text() != nullptr) tree.text = *value.text();
    if (value.list() != nullptr) {
        tree.kind = Tree::List;
        for (const ConfigValue& item : *value.list()) tree.items.push_back(treeOf(item));
    }
    if (value.map() != nullptr) {
        tree.kind = Tree::Map;
        for (const auto& [key, part] : *value.map()) tree.entries[key] = treeOf(part);
    }
    return tree;
}

Result<Tree> treeOfText(const std::string& text) { return treeOf(TRY(ConfigNode::parse(text, "f"))); }

void put(Tree& tree, const ConfigPath& path, std::size_t step, const Tree& value) {
    if (step == path.size()) {
        tree = value;
    } else if (const std::string* key = path[step].key()) {
        tree.kind = Tree::Map;
        put(tree.entries[*key], path, step + 1, value);
    } else {
        tree.kind = Tree::List;
        if (*path[step].index() == tree.items.size()) tree.items.emplace_back();
        put(tree.items[*path[step].index()], path, step + 1, value);
    }
}

void eraseFrom(Tree& tree, const ConfigPath& path, std::size_t step) {
    if (const std::string* key = path[step].key()) {
        const auto entry = tree.entries.find(*key);
        if (entry != tree.entries.end() && step + 1 < path.size()) eraseFrom(entry->second, path, step + 1);
        if (entry != tree.entries.end() && step + 1 == path.size()) tree.entries.erase(entry);
    } else if (const std::size_t index = *path[step].index(); index < tree.items.size()) {
        if (step + 1 < path.size())
            eraseFrom(tree.items[index], path, step + 1);
        else
            tree.items.erase(tree.items.begin() + static_cast<std::ptrdiff_t>(index));
    }
}

const std::vector<std::string> kKeys = {"a", "name", "two words", "ünï", "# hash", "it's", "x: y", "[", "- d", "7"};
const std::vector<std::string> kTexts = {"plain", "two words", "é",  "a # b", "a, b", "",   "- x",
                                         "{",     "'",         "\"", "true",  "1.50", "x:", "~x"};

const std::string& anyOf(const std::vector<std::string>& texts, Rng& rng) { return texts[rng.below(texts.size())]; }

ConfigValue randomValue(Rng& rng, int depth) {
    const std::uint32_t kind = rng.below(depth > 0 ? 6 : 3);
    if (kind == 0) return anyOf(kTexts, rng);
    if (kind < 3) return std::round(rng.uniform(-100, 100)) / 8;
    if (kind == 3) return std::vector<glm::dvec2>(rng.below(30), glm::dvec2(rng.uniform(), 1));
    if (kind == 4) {
        ConfigValue::List list;
        for (std::uint32_t i = rng.below(5); i > 0; --i) list.push_back(randomValue(rng, depth - 1));
        return list;
    }
    std::map<std::string, ConfigValue> entries;
    for (std::uint32_t i = rng.below(4); i > 0; --i) entries.emplace(anyOf(kKeys, rng), randomValue(rng, depth - 1));
    return ConfigValue::Map(entries.begin(), entries.end());
}

// A path to anything in the tree, or to something new in it.
ConfigPath randomPath(const Tree& tree, Rng& rng) {
    ConfigPath path;
    const Tree* at = &tree;
    while (path.empty() || rng.below(5) > 0) {
        if (at->kind == Tree::Map && (at->entries.empty() || rng.below(6) == 0)) {
            path.emplace_back(anyOf(kKeys, rng));
            const auto found = at->entries.find(*path.back().key());
            if (found == at->entries.end()) break;
            at = &found->second;
        } else if (at->kind == Tree::Map) {
            const auto entry = std::next(at->entries.begin(), rng.below(at->entries.size()));
            path.emplace_back(entry->first);
            at = &entry->second;
        } else if (at->kind == Tree::List) {
            const std::uint32_t index = rng.below(at->items.size() + 1);
            path.emplace_back(index);
            if (index == at->items.size()) break;
            at = &at->items[index];
        } else {
            break;
        }
    }
    return path;
}

std::string labelOf(const ConfigPath& path) {
    std::string label;
    for (const ConfigStep& step : path) label += "/" + (step.key() != nullptr ? *step.key() : std::to_string(*step.index()));
    return label;
}

// Writes documents like people who know all of YAML except anchors and tags. Each comment names the
// value that contains it.
class Author {
public:
    explicit Author(std::uint64_t seed) : rng_(seed) {}

    std::string document() {
        std::string text = maybeCommentLine(0, "");
        text += blockMap(0, "", 4, false) + maybeCommentLine(0, "");
        if (rng_.below(4) == 0) text = "---\n" + text;
        if (rng_.below(4) == 0) text += "...\n";
        if (rng_.below(4) == 0 && text.find_last_of("|>") == std::string::npos) text.pop_back();
        if (rng_.below(3) == 0)
            for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
        if (rng_.below(4) == 0) text.insert(0, "\xEF\xBB\xBF");
        return text;
    }
    const std::vector<std::pair<std::string, std::string>>& comments() const {
        return comments_;
    }  // each with the label of its value

private:
    std::string pad(std::uint32_t indent) const { return std::string(indent, ' '); }
    std::string comment(const std::string& label) {
        std::string text = "#" + std::to_string(comments_.size()) + " in " + label + ";";
        comments_.emplace_back(text, label);
        return text;
    }
    std::string maybeComment(const std::string& label) {
        return rng_.below(3) == 0 ? pad(1 + rng_.below(3)) + comment(label) : pad(rng_.below(5) == 0 ? 2 : 0);
    }
    std::string maybeCommentLine(std::uint32_t indent, const std::string& label) {
        const std::uint32_t kind = rng_.below(6);
        return kind == 0 ? "\n" : kind == 1 ? pad(rng_.below(2) * indent) + comment(label) + "\n" : "";
    }
    std::string quote(const std::string& text, bool mayBePlain) {
        if (mayBePlain && !text.empty() && text.find_first_of("#:[]{},'\"-~") == std::string::npos) return text;
        std::string quoted;
        const bool single = rng_.below(2) == 0;
        for (const char c : text) quoted += single && c == '\'' ? "''" : !single && c == '"' ? "\\\"" : std::string(1, c);
        return single ? "'" + quoted + "'" : "\"" + quoted + "\"";
    }
    std::string scalar() {
        const std::uint32_t kind = rng_.below(4);
        if (kind == 0) return std::to_string(rng_.below(1000)) + ".50";
        if (kind == 1) return "-" + std::to_string(rng_.below(9));
        return quote(anyOf(kTexts, rng_), kind == 2);
    }
    std::set<std::string> keys() {
        std::set<std::string> keys;
        for (std::uint32_t i = 1 + rng_.below(3); i > 0; --i) keys.insert(anyOf(kKeys, rng_));
        return keys;
    }
    std::string flow(std::uint32_t indent, const std::string& label, int depth) {
        const std::uint32_t kind = rng_.below(depth > 0 ? 4 : 2);
        if (kind < 2) return scalar();
        const bool lines = rng_.below(4) == 0, map = kind == 2;
        const auto space = [&] { return lines ? maybeComment(label) + "\n" + pad(indent) : pad(rng_.below(2)); };
        std::string text = (map ? "{" : "[") + space();
        int count = 0;
        for (const std::string& key : rng_.below(6) == 0 ? std::set<std::string>() : keys()) {
            if (count > 0) text += (rng_.below(5) == 0 ? " ," : ",") + (lines ? space() : " ");
            text += map ? quote(key, true) + ": " + flow(indent, label + "/" + key, depth - 1)
                        : flow(indent, label + "/" + std::to_string(count), depth - 1);
            ++count;
        }
        if (count > 0 && rng_.below(6) == 0) text += ",";
        return text + space() + (map ? "}" : "]");
    }
    // The text after "key:" or "-", with the line's end. `outer` is the label of the surrounding
    // value.
    std::string value(std::uint32_t indent, const std::string& outer, const std::string& label, int depth, bool inList) {
        const std::uint32_t kind = rng_.below(depth > 0 ? 8 : 4);
        if (kind == 0) return maybeComment(outer) + "\n";
        if (kind == 1)
            return " " + anyOf({"|", ">", "|-", "|+", ">+"}, rng_) + maybeComment(label) + "\n" + pad(indent + 2) +
                   "text # text\n" + pad(rng_.below(2) * indent) + "\n" + pad(indent + 2) + "- more: [\n" +
                   (rng_.below(2) == 0 ? "\n" : "");
        if (kind == 2) return pad(1 + rng_.below(3)) + scalar() + maybeComment(outer) + "\n";
        if (kind == 3) return " " + flow(indent + 3, label, 3) + maybeComment(outer) + "\n";
        if (kind == 4 && inList) return " " + blockMap(indent + 2, label, depth - 1, true);
        if (kind == 5 && inList) return "   " + blockList(indent + 4, label, depth - 1, true);
        const std::string lead = maybeComment(outer) + "\n";
        if (kind < 6) return lead + blockMap(indent + 1 + rng_.below(4), label, depth - 1, false);
        return lead + blockList(indent + (inList ? 1 : 0) + 2 * rng_.below(2), label, depth - 1, false);
    }
    std::string blockMap(std::uint32_t indent, const std::string& label, int depth, bool onLine) {
        std::string text;
        for (const std::string& key : keys()) {
            if (!onLine || !text.empty()) text += maybeCommentLine(indent, label) + pad(indent);
            text += quote(key, true) + (rng_.below(6) == 0 ? " :" : ":");
            text += value(indent, label, label + "/" + key, depth, false);
        }
        return text;
    }
    std::string blockList(std::uint32_t indent, const std::string& label, int depth, bool onLine) {
        std::string text;
        const std::uint32_t count = 1 + rng_.below(3);
        for (std::uint32_t i = 0; i < count; ++i) {
            if (!onLine || !text.empty()) text += maybeCommentLine(indent, label) + pad(indent);
            text += "-" + value(indent, label, label + "/" + std::to_string(i), depth, true);
        }
        return text;
    }

    Rng rng_;
    std::vector<std::pair<std::string, std::string>> comments_;
};

TEST(ConfigEdit, in_any_document_any_value_is_set_and_all_else_reads_as_before) {
    int changed = 0;
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        Author author(seed);
        const std::string text = author.document();
        auto document = ConfigDocument::parse(text, "f");
        ASSERT_TRUE(document) << seed << ": " << document.error().message() << "\n" << text;
        Rng rng(streamSeed(seed, {1}));
        Tree expected = treeOfText(text).value();
        std::vector<std::string> labels;
        for (int change = 0; change < 3; ++change) {
            const ConfigPath path = randomPath(expected, rng);
            const ConfigValue value = randomValue(rng, 2);
            const std::string before = document->text();
            // Text that keeps its blank lines ("|+") would also take those after what is removed,
            // so this is refused.
            const bool erases =
                rng.below(4) == 0 && text.find('+') == std::string::npos && (path.size() > 1 || expected.entries.size() > 1);
            const auto set = erases ? document->erase(path) : document->set(path, value);
            ASSERT_TRUE(set) << seed << ": " << labelOf(path) << ": " << set.error().message() << "\n" << before;
            if (erases)
                eraseFrom(expected, path, 0);
            else
                put(expected, path, 0, treeOf(value));
            ASSERT_EQ(treeOfText(document->text()).value(), expected) << seed << labelOf(path) << "\n"
                                                                      << before << "\n==>\n"
                                                                      << document->text();
            labels.push_back(labelOf(erases ? ConfigPath(path.begin(), path.end() - 1) : path));  // with the comment on the line
            changed += before != document->text() ? 1 : 0;
        }
        for (const auto& [comment, label] : author.comments()) {
            const bool replaced = std::any_of(labels.begin(), labels.end(), [&, &l = label](const std::string& other) {
                return l == other || l.starts_with(other + "/");
            });
            ASSERT_TRUE(replaced || document->text().find(comment) != std::string::npos) << seed << ": " << comment << "\n"
                                                                                         << text;
        }
    }
    EXPECT_GT(changed, 1400);
}

// Whatever happened to a file, it is refused, or its other values stay. Bytes are changed one by
// one, mostly to ones that mean something in YAML.
TEST(ConfigEdit, files_with_damage_are_refused_or_changed_rightly) {
    const std::string marks = "\n\n  :#-[]{},'\"&*!|>%@`\t\r\xFF\xC3?~a1";
    int refused = 0, changed = 0;
    for (const char* name : {"config/simulated/site.yaml", "shows/light-movement/show.yaml"}) {
        const std::string whole = readFile(std::filesystem::path(sourceFolder()) / name).value();
        const auto wellRead = treeOfText(whole);
        ASSERT_TRUE(wellRead) << wellRead.error().message();
        for (std::uint64_t seed = 0; seed < 250; ++seed) {
            Rng rng(streamSeed(seed, {2}));
            std::string text = whole;
            for (std::uint32_t i = 1 + rng.below(4); i > 0; --i) {
                const std::size_t at = rng.below(text.size());
                const char mark = rng.below(8) == 0 ? static_cast<char>(rng.below(256)) : marks[rng.below(marks.size())];
                if (rng.below(3) == 0)
                    text.erase(at, 1 + rng.below(3));
                else
                    text.replace(at, rng.below(2), 1, mark);
            }
            const ConfigPath path = randomPath(*wellRead, rng);
            const ConfigValue value = randomValue(rng, 2);
            auto document = ConfigDocument::parse(text, "f");
            if (!document || !document->set(path, value)) {
                ++refused;
                continue;
            }
            ++changed;
            const auto before = treeOfText(text);
            if (!before) continue;  // a key occurs twice, but not on the path
            Tree expected = *before;
            put(expected, path, 0, treeOf(value));
            ASSERT_EQ(treeOfText(document->text()).value(), expected) << labelOf(path) << "\n" << text;
        }
    }
    EXPECT_GT(refused, 50);
    EXPECT_GT(changed, 100);
}

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

TEST(ConfigEdit, in_the_default_site_moved_corners_change_their_line_alone) {
    const std::filesystem::path site = std::filesystem::path(sourceFolder()) / "config/simulated/site.yaml";
    const std::string text = readFile(site).value();
    auto document = ConfigDocument::load(site);
    ASSERT_TRUE(document) << document.error().message();
    const std::array<glm::dvec2, 4> corners = {{{95.5, 45.43}, {516.93, 48.35}, {512.43, 283.18}, {101.58, 325}}};
    ASSERT_TRUE(document->set({"outputs", 1, "corners"}, corners));

    std::vector<std::string> removed, added;
    const auto before = linesOf(text), after = linesOf(document->text());
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] == after[i]) continue;
        removed.push_back(before[i]);
        added.push_back(after[i]);
    }
    EXPECT_THAT(removed, ElementsAre("    corners: [[95.48, 45.43], [516.93, 48.35], [512.43, 283.18], [101.58, 324.85]]"));
    EXPECT_THAT(added, ElementsAre("    corners: [[95.5, 45.43], [516.93, 48.35], [512.43, 283.18], [101.58, 325]]"));
}

// ---- Saving

ConfigDocument loaded(const std::filesystem::path& path) { return ConfigDocument::load(path).value(); }

TEST(ConfigEditSave, the_persons_version_stays_beside_however_often_it_is_saved) {
    const ScratchFolder folder;
    const auto file = folder.file("site.yaml", "a: 1  # mine\n");
    auto document = loaded(file);
    ASSERT_TRUE(document.save());
    EXPECT_THAT(folder.names(), ElementsAre("site.yaml")) << "nothing was changed";
    for (const double value : {2, 3, 4}) {
        ASSERT_TRUE(document.set({"a"}, value));
        ASSERT_TRUE(document.save());
        EXPECT_EQ(*readFile(file), document.text());
    }
    EXPECT_EQ(*readFile(file), "a: 4  # mine\n");
    EXPECT_EQ(*readFile(folder / "site.yaml.previous"), "a: 1  # mine\n");
    EXPECT_THAT(folder.names(), ElementsAre("site.yaml", "site.yaml.previous"));
}

TEST(ConfigEditSave, what_somebody_else_wrote_meanwhile_is_kept) {
    const ScratchFolder folder;
    const auto file = folder.file("site.yaml", "a: 1\nl:\n  - {name: x, c: 1}\n  - {name: y, c: 1}\n");
    auto document = loaded(file);
    ASSERT_TRUE(document.set({"l", 1, "c"}, 2));
    ASSERT_TRUE(document.save());
    ASSERT_TRUE(document.set({"l", 1, "c"}, 3));
    ASSERT_TRUE(document.set({"l", 1, "c"}, 4));
    const std::string theirs = "# theirs\na: 5\nl:\n  - {name: x, c: 7}\n  - {name: y, d: 8, c: 2}\n";
    folder.file("site.yaml", theirs);
    const auto saved = document.save();
    ASSERT_TRUE(saved) << saved.error().message();
    EXPECT_EQ(*readFile(file), "# theirs\na: 5\nl:\n  - {name: x, c: 7}\n  - {name: y, d: 8, c: 4}\n");
    EXPECT_EQ(document.text(), *readFile(file));
    EXPECT_EQ(*readFile(folder / "site.yaml.previous"), theirs);
}

// Example failure: somebody inserts an output, and the corners of the second go to the first.
TEST(ConfigEditSave, a_change_that_no_longer_fits_leaves_both_alone) {
    const ScratchFolder folder;
    const auto refusal = [&](const ConfigPath& path, const std::string& theirs) {
        const auto file = folder.file("site.yaml", "a: 1\nl:\n  - {name: x, c: 1}\n  - {name: y, c: 1}\np: [[1, 2], [3, 4]]\n");
        auto document = loaded(file);
        EXPECT_TRUE(document.set(path, 9));
        const std::string mine = document.text();
        folder.file("site.yaml", theirs);
        const auto saved = document.save();
        EXPECT_EQ(document.text(), saved ? *readFile(file) : mine);
        EXPECT_EQ(*readFile(file), saved ? document.text() : theirs);
        EXPECT_EQ(std::filesystem::remove(folder / "site.yaml.previous"), saved.has_value());
        return saved ? "saved" : folder.relative(saved.error().message());
    };
    const std::string was = "site.yaml: ", end = " was changed in the file by somebody else since it was read; read it again";
    EXPECT_EQ(refusal({"a"}, "a: 2\n"), was + "a" + end);
    EXPECT_EQ(refusal({"a"}, "b: 2\n"), was + "a" + end);
    EXPECT_EQ(refusal({"b"}, "b: 2\n"), was + "b" + end);
    EXPECT_EQ(refusal({"l", 1, "c"}, "l:\n  - {name: w, c: 1}\n  - {name: x, c: 1}\n  - {name: y, c: 1}\n"),
              was + "l[1].c" + end);
    EXPECT_EQ(refusal({"l", 2, "c"}, "l:\n  - {name: x, c: 1}\n  - {name: y, c: 1}\n  - {name: z}\n"), was + "l[2].c" + end);
    EXPECT_EQ(refusal({"p", 1, 0}, "p: [[0, 0], [1, 2], [3, 4]]\n"), was + "p[1][0]" + end);
    EXPECT_EQ(refusal({"p", 1, 0}, "p: [[0, 0], [3, 4]]\n"), "saved");
    EXPECT_THAT(refusal({"a"}, "a: [1\n"), HasSubstr("site.yaml:2:1: not YAML"));
}

TEST(ConfigEditSave, what_cannot_be_written_leaves_the_file_as_it_was) {
    const ScratchFolder folder;
    const std::string text = "a: 1\n";
    const auto file = folder.file("site.yaml", text);
    auto document = loaded(file);
    ASSERT_TRUE(document.set({"a"}, 2));

    folder.file("site.yaml.previous/in the way", "x");
    EXPECT_EQ(folder.relative(document.save().error().message()), "site.yaml.previous: cannot be written: Is a directory");
    EXPECT_EQ(*readFile(file), text) << "no version is lost: then rather none is written";
    std::filesystem::remove_all(folder / "site.yaml.previous");

    std::filesystem::remove(file);
    EXPECT_EQ(folder.relative(document.save().error().message()), "site.yaml: cannot be read: No such file or directory");

    folder.file("site.yaml", text);
    ASSERT_TRUE(document.save()) << "the changes were kept";
    EXPECT_EQ(*readFile(file), "a: 2\n");
    EXPECT_EQ(*readFile(folder / "site.yaml.previous"), text);
}

}  // namespace
}  // namespace fantascope
