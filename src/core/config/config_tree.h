#pragma once
// A YAML document as a value: what ConfigNode (core/config.h) points into.

#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace fantascope {

// One document. Never changed once it is parsed, so any thread may read it.
struct ConfigTree {
    enum class Kind { Nothing, Scalar, List, Map };
    struct Node {
        Kind kind = Kind::Nothing;
        std::string text;                  // of a scalar
        int line = 1, column = 1;          // in characters, from 1
        std::vector<std::uint32_t> parts;  // of a list; of a map key, value, key, value: indices into `nodes`
    };
    std::filesystem::path file;
    std::vector<Node> nodes;  // the first is the root, a map; an alias is another index of the node that it means

    // Error: not UTF-8, not YAML, more than one document, no map, or an alias of something that it
    // is in; with the place. `file` is for messages alone.
    static Result<std::shared_ptr<const ConfigTree>> parse(const std::string& text, const std::filesystem::path& file);
};

// What stands there, for a message: "'5'", "a list", "nothing".
std::string describe(const ConfigTree::Node& node);

// Whether two nodes read the same, wherever they stand.
bool readsAs(const ConfigTree& a, std::uint32_t first, const ConfigTree& b, std::uint32_t second);

}  // namespace fantascope
