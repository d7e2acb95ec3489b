#include "core/config/naming.h"

#include "core/config/config.h"

#include <optional>

namespace fantascope {
namespace {

namespace fs = std::filesystem;

// The first value in a file that is the path of `named`, relative to the file's folder.
std::optional<ConfigNode> naming(const ConfigNode& node, const fs::path& named) {
    std::vector<ConfigNode> children;
    if (node.isMap()) {
        if (const auto entries = node.entries())
            for (const auto& [key, value] : *entries) children.push_back(value);
    } else if (node.isList()) {
        if (auto items = node.items()) children = std::move(items).value();
    } else if (const auto path = node.path(); path && path->lexically_normal() == named) {
        return node;
    }
    for (const ConfigNode& child : children)
        if (auto found = naming(child, named)) return found;
    return std::nullopt;
}

}  // namespace

Error namedIn(const fs::path& file, const fs::path& named, const Error& cause) {
    const auto root = ConfigNode::load(file);
    const auto key = root ? naming(*root, named.lexically_normal()) : std::nullopt;
    return key ? key->error(cause) : cause;
}

}  // namespace fantascope
