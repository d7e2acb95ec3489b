// Passes, skips, fails and hangs on purpose, for skips_test.cpp. ctest runs it only under `-C
// deliberate`.

#include <gmock/gmock.h>
#include <unistd.h>

TEST(Deliberately, passes) {}
TEST(Deliberately, skips) { GTEST_SKIP() << "there is no peer"; }
TEST(Deliberately, fails) { ADD_FAILURE() << "on purpose"; }
TEST(Deliberately, hangs) {
    for (;;) ::pause();
}
