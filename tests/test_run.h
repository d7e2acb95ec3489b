#pragma once
// What the exit code of a test program says, so that ctest tells a skipped program from a passed
// one and never a failed one from either.

namespace fantascope {

constexpr int kSkipped = 77;  // also in CMakeLists.txt: SKIP_RETURN_CODE

// Runs the tests that the filter wants. Returns 1 if one failed or the filter wants none; kSkipped
// if none failed and some were skipped, each told in a line "skipped: NAME: why"; else 0.
int runTests(int& count, char** arguments);

}  // namespace fantascope
