#include "test_run.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace fantascope {
namespace {

// Names the test that never comes back, which ctest would end without a word.
class HangWatch : public testing::EmptyTestEventListener {
public:
    HangWatch() {
        if (const char* const patience = std::getenv("FANTASCOPE_TEST_PATIENCE")) patience_ = unsigned(std::atoi(patience));
        std::signal(SIGALRM, [](int) {
            (void)!::write(STDERR_FILENO, hung_.data(), hung_.size());
            std::abort();
        });
    }

private:
    void OnTestStart(const testing::TestInfo& test) override {
        hung_ = std::string(test.test_suite_name()) + '.' + test.name() + " hangs\n";
        ::alarm(patience_);
    }
    void OnTestEnd(const testing::TestInfo&) override { ::alarm(0); }

    static inline std::string hung_;
    unsigned patience_ = 600;  // s; far longer than any test takes, and less than ctest's own for the whole program
};

}  // namespace

int runTests(int& count, char** arguments) {
    testing::InitGoogleMock(&count, arguments);
    testing::UnitTest::GetInstance()->listeners().Append(new HangWatch);  // theirs from now on
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
