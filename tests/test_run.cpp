#include "test_run.h"

#include <gmock/gmock.h>

#include <cstdio>

namespace fantascope {

int runTests(int& count, char** arguments) {
    testing::InitGoogleMock(&count, arguments);
    if (RUN_ALL_TESTS() != 0) return 1;
    const testing::UnitTest& unit = *testing::UnitTest::GetInstance();
    if (unit.test_to_run_count() == 0) {
        std::puts("no test has a name that the filter wants");
        return 1;
    }
    for (int i = 0; i < unit.total_test_suite_count(); ++i) {
        const testing::TestSuite& suite = *unit.GetTestSuite(i);
        for (int j = 0; j < suite.total_test_count(); ++j) {
            const testing::TestInfo& test = *suite.GetTestInfo(j);
            for (int part = 0; part < test.result()->total_part_count(); ++part)
                if (const auto& result = test.result()->GetTestPartResult(part); result.skipped())
                    std::printf("skipped: %s.%s: %s\n", suite.name(), test.name(), result.message());
        }
    }
    return unit.skipped_test_count() > 0 ? kSkipped : 0;
}

}  // namespace fantascope
