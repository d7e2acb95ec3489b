#include "core/config/config_tree.h"

#include "core/text.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

namespace fantascope {
namespace {

namespace fs = std::filesystem;

using Kind = ConfigTree::Kind;

// Line and column, in characters, of the first byte that is not UTF-8, if there is one.
std::optional<std::pair<int, int>> placeOfNoUtf8(std::string_view text) {
    std::pair place{1, 1};
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8Length(text, at);
        if (length == 0) return place;
        place = text[at] == '\n' ? std::pair(place.first + 1, 1) : std::pair(place.first, place.second + 1);
        at += length;
    }
    return std::nullopt;
}

// The line in which a document begins that is not the first: that of its '---', or its own, which
// is `line`.
int beginningOf(int line, const std::string& text) {
    int number = 0, begin = 0;
    std::istringstream lines(text);
    for (std::string each; std::getline(lines, each) && number < line;) {
        ++number;
        if (each.starts_with("---")) begin = number;
    }
    return std::max(begin, 1);
}

// Makes the nodes of one document from what the parser meets.
class Builder : public YAML::EventHandler {
public:
    explicit Builder(std::vector<ConfigTree::Node>& nodes) : nodes_(nodes) {}

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(Kind::Nothing, mark, anchor); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const std::uint32_t meant = anchors_.at(anchor);
        if (std::ranges::find(open_, meant) != open_.end())
            throw YAML::ParserException(mark, "an alias stands for something that it is in");
        put(meant);
    }
    void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& value) override {
        nodes_[add(Kind::Scalar, mark, anchor)].text = value;
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        open_.push_back(add(Kind::List, mark, anchor));
    }
    void OnSequenceEnd() override { open_.pop_back(); }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        open_.push_back(add(Kind::Map, mark, anchor));
    }
    void OnMapEnd() override { open_.pop_back(); }

private:
    void put(std::uint32_t node) {
        if (!open_.empty()) nodes_[open_.back()].parts.push_back(node);
    }
    std::uint32_t add(Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
        const auto node = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({.kind = kind, .text = {}, .line = mark.line + 1, .column = mark.column + 1, .parts = {}});
        put(node);
        if (anchor != 0) anchors_[anchor] = node;
        return node;
    }

    std::vector<ConfigTree::Node>& nodes_;
    std::vector<std::uint32_t> open_;  // the lists and maps that it is in
    std::map<YAML::anchor_t, std::uint32_t> anchors_;
};

}  // namespace

Result<std::shared_ptr<const ConfigTree>> ConfigTree::parse(const std::string& text, const fs::path& file) {
    if (const auto place = placeOfNoUtf8(text))
        return Error(
            fmt::format("{}:{}:{}: not UTF-8; save the file in that encoding", file.string(), place->first, place->second));
    const auto tree = std::make_shared<ConfigTree>();
    tree->file = file;
    std::vector<Node> others;  // of the documents after the first
    try {
        std::istringstream bytes(text);
        YAML::Parser parser(bytes);
        if (Builder first(tree->nodes); parser.HandleNextDocument(first))
            while (true)
                if (Builder next(others); !parser.HandleNextDocument(next)) break;
    } catch (const YAML::ParserException& problem) {
        return Error(fmt::format("{}:{}:{}: not YAML: {}", file.string(), problem.mark.line + 1, problem.mark.column + 1,
                                 printable(problem.msg)));
    }
    if (!others.empty())
        return Error(fmt::format("{}:{}:1: a second document begins here; put it in a file of its own", file.string(),
                                 beginningOf(others.front().line, text)));
    if (tree->nodes.empty() || tree->nodes[0].kind != Kind::Map) {
        const Node root = tree->nodes.empty() ? Node() : tree->nodes[0];
        return Error(fmt::format("{}:1:1: a map of 'key: value' lines is needed, here is {}", file.string(), describe(root)));
    }
    return std::shared_ptr<const ConfigTree>(tree);
}

std::string describe(const ConfigTree::Node& node) {
    if (node.kind == Kind::Scalar) return fmt::format("'{}'", printable(node.text));
    return node.kind == Kind::Map ? "a map" : node.kind == Kind::List ? "a list" : "nothing";
}

bool readsAs(const ConfigTree& a, std::uint32_t first, const ConfigTree& b, std::uint32_t second) {
    // Pairs are met once, since aliases can make a short text into a huge tree.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{first, second}};
    std::set<std::pair<std::uint32_t, std::uint32_t>> met;
    while (!open.empty()) {
        const auto pair = open.back();
        open.pop_back();
        if (!met.insert(pair).second) continue;
        const ConfigTree::Node &one = a.nodes[pair.first], &other = b.nodes[pair.second];
        if (one.kind != other.kind || one.text != other.text || one.parts.size() != other.parts.size()) return false;
        for (std::size_t i = 0; i < one.parts.size(); ++i) open.emplace_back(one.parts[i], other.parts[i]);
    }
    return true;
}

}  // namespace fantascope
