#pragma once

#include "core/result.h"

#include <sys/types.h>

#include <memory>
#include <string>

namespace fantascope {

// An X server in memory (Xvfb) with one screen of 1280 x 720, for tests with windows. DISPLAY names it for as long as it lives;
// it dies with this program at the latest.
class VirtualXServer {
public:
    // Error: Xvfb is missing or does not start; names the Debian package.
    static Result<std::unique_ptr<VirtualXServer>> start();
    ~VirtualXServer();

private:
    explicit VirtualXServer(pid_t process) : process_(process) {}
    pid_t process_;
};

}  // namespace fantascope
