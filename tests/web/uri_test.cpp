#include "web/uri.h"

#include <gmock/gmock.h>

namespace fantascope::web {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(Uri, is_taken_apart_and_decoded) {
    const auto target = splitTarget("/api/v1/caf%C3%A9%20?a=1&b=x%26y&c&d=");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->path, "/api/v1/caf\xc3\xa9 ");
    EXPECT_THAT(target->query, ElementsAre(Pair("a", "1"), Pair("b", "x&y"), Pair("c", ""), Pair("d", "")));
}

TEST(Uri, that_is_none_is_refused) {
    for (const char* const bad : {"", "a", "http://localhost/", "/%", "/%4", "/%4g", "/%00", "/a%0ab", "/?%7f", "/\x01"})
        EXPECT_FALSE(splitTarget(bad)) << bad;
}

}  // namespace
}  // namespace fantascope::web
