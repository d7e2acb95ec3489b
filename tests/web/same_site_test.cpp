#include "web/same_site.h"

#include <gmock/gmock.h>

namespace fantascope::web {
namespace {

// A page elsewhere whose name leads here sends that name.
TEST(SameSite, is_for_this_machine_by_its_own_names_alone) {
    for (const char* const host : {"localhost", "localhost:8080", "127.0.0.1:80", "[::1]:8080", "[::1]"})
        EXPECT_TRUE(isForThisMachine({.host = host, .isLocal = true})) << host;
    for (const char* const host : {"", "evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil", "::1"})
        EXPECT_FALSE(isForThisMachine({.host = host, .isLocal = true})) << host;
    EXPECT_FALSE(isForThisMachine({.host = "localhost", .isLocal = false})) << "it comes from another machine";
}

TEST(SameSite, comes_from_its_own_page_or_from_none) {
    const auto comes = [](const char* origin, const char* fetchSite) {
        return isFromOwnPage({.host = "localhost:8080", .origin = origin, .fetchSite = fetchSite});
    };
    EXPECT_TRUE(comes("", "")) << "a script";
    EXPECT_TRUE(comes("http://localhost:8080", "same-origin"));
    EXPECT_TRUE(comes("", "none"));
    EXPECT_FALSE(comes("http://evil.example", ""));
    EXPECT_FALSE(comes("null", ""));
    EXPECT_FALSE(comes("http://localhost:8081", "same-site")) << "another port is another page";
    EXPECT_FALSE(comes("", "cross-site"));
}

}  // namespace
}  // namespace fantascope::web
