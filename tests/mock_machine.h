#pragma once
// A machine of umockdev's, for devices that are not there.

#include <filesystem>

struct _UMockdevTestbed;

namespace fantascope {

// A machine that has only what is plugged into it here. One at a time.
class MockMachine {
public:
    MockMachine();
    ~MockMachine();
    MockMachine(const MockMachine&) = delete;
    MockMachine& operator=(const MockMachine&) = delete;

    _UMockdevTestbed* testbed() const { return testbed_; }
    std::filesystem::path root() const;  // under which its /dev and /sys really lie

private:
    _UMockdevTestbed* testbed_;
};

// Starts the program again under umockdev's library, at the beginning of main(); programs that it
// starts are under it too. Returns there whether it is under it: not where Debian's package
// umockdev is not installed.
bool underUmockdev(char** arguments);

}  // namespace fantascope
