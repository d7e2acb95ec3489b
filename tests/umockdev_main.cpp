// The main() of a test program whose devices are umockdev's.

#include "mock_machine.h"
#include "test_run.h"

#include <cstdio>

int main(int count, char** arguments) {
    if (!fantascope::underUmockdev(arguments)) {
        std::puts("skipped: all tests: Debian's package umockdev is not installed, see tools/peers");
        return fantascope::kSkipped;
    }
    return fantascope::runTests(count, arguments);
}
