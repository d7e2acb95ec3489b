#pragma once

#include <cstdint>
#include <string_view>

namespace fantascope {

// FNV-1a, 64 bits: the same in every build and on every machine. It finds damage and tells names
// apart; it keeps no secret. `hash`: of what came before.
constexpr std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325u) {
    for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
    return hash;
}

}  // namespace fantascope
