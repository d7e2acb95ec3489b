#include "drivers/virtual_x_server.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace fantascope {

Result<std::unique_ptr<VirtualXServer>> VirtualXServer::start() {
    // The server picks a free number itself and writes it here; when it cannot start, the pipe just closes.
    int ends[2];
    if (pipe(ends) != 0) return Error("no pipe for Xvfb");
    const pid_t process = fork();
    if (process < 0) return Error("no process for Xvfb");
    if (process == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ends[0]);
        const std::string descriptor = std::to_string(ends[1]);
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x720x24", "-nolisten", "tcp", nullptr);
        _exit(127);
    }
    close(ends[1]);
    std::string number;
    for (char digit = 0; read(ends[0], &digit, 1) == 1 && digit != '\n';) number += digit;
    close(ends[0]);
    std::unique_ptr<VirtualXServer> server(new VirtualXServer(process));
    if (number.empty()) return Error("Xvfb does not start; install Debian's package xvfb, as tools/setup does");
    setenv("DISPLAY", (":" + number).c_str(), 1);
    return server;
}

VirtualXServer::~VirtualXServer() {
    unsetenv("DISPLAY");
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
}

}  // namespace fantascope
