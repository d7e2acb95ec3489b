#include "web/uri.h"

#include <algorithm>
#include <charconv>

namespace fantascope::web {

namespace {

std::optional<std::string> decoded(std::string_view text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned char letter = static_cast<unsigned char>(text[i]);
        if (letter == '%') {
            if (text.size() - i < 3) return std::nullopt;
            const char* const end = text.data() + i + 3;
            const auto [read, failed] = std::from_chars(end - 2, end, letter, 16);
            if (failed != std::errc() || read != end) return std::nullopt;
            i += 2;
        }
        if (letter < 0x20 || letter == 0x7f) return std::nullopt;
        plain += static_cast<char>(letter);
    }
    return plain;
}

}  // namespace

std::optional<Target> splitTarget(std::string_view target) {
    if (!target.starts_with('/')) return std::nullopt;
    const std::size_t question = std::min(target.find('?'), target.size());
    const auto path = decoded(target.substr(0, question));
    if (!path) return std::nullopt;
    Target split{*path, {}};
    for (std::string_view rest = target.substr(std::min(question + 1, target.size())); !rest.empty();) {
        const std::string_view part = rest.substr(0, rest.find('&'));
        rest.remove_prefix(std::min(part.size() + 1, rest.size()));
        const std::size_t equals = std::min(part.find('='), part.size());
        const auto key = decoded(part.substr(0, equals)), value = decoded(part.substr(std::min(equals + 1, part.size())));
        if (!key || !value) return std::nullopt;
        split.query.emplace_back(*key, *value);
    }
    return split;
}

}  // namespace fantascope::web
