// The main() of a test program whose devices are umockdev's.

#include "mock_machine.h"

#include <gmock/gmock.h>

#include <cstdio>

int main(int count, char** arguments) {
    if (!fantascope::underUmockdev(arguments)) {
        std::puts("[  SKIPPED ] all tests: Debian's package umockdev is not installed, see tools/peers");
        return 0;
    }
    testing::InitGoogleMock(&count, arguments);
    return RUN_ALL_TESTS();
}
