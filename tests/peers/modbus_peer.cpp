#include "peers/modbus_peer.h"

#include "core/check.h"
#include "source_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace fantascope {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // Debian's own Python, which has its pymodbus
const std::string kScript = sourceFolder() + "/tests/peers/modbus_peer.py";

// Becomes another program, in a child process that ends with the test.
[[noreturn]] void become(std::vector<std::string> words) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
}

std::string lineFrom(int file) {
    std::string line;
    for (char letter = 0; ::read(file, &letter, 1) == 1 && letter != '\n';) line += letter;
    return line;
}

}  // namespace

std::string ModbusPeer::missing() {
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
        become({kPython, "-c", "import pymodbus.server, serial_asyncio"});
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status == 0 ? "" : "pymodbus is not installed: tools/peers installs it";
}

ModbusPeer::ModbusPeer(Wire wire, int lines) : wire_(wire) {
    for (int line = 0; line < lines; ++line)
        places_.push_back(wire == Wire::Tcp ? "0" : (folder_ / fmt::format("line{}", line)).string());
    start();
}

ModbusPeer::~ModbusPeer() { kill(); }

void ModbusPeer::start() {
    int commands[2], answers[2];
    FANTASCOPE_CHECK(::pipe2(commands, O_CLOEXEC) == 0 && ::pipe2(answers, O_CLOEXEC) == 0, "no pipe");
    child_ = ::fork();
    FANTASCOPE_CHECK(child_ >= 0, "no process");
    if (child_ == 0) {
        ::dup2(commands[0], STDIN_FILENO);
        ::dup2(answers[1], STDOUT_FILENO);
        ::setenv("JOURNAL", (folder_ / "journal").c_str(), 1);
        std::vector<std::string> words{kPython, kScript, wire_ == Wire::Tcp ? "tcp" : "rtu"};
        words.insert(words.end(), places_.begin(), places_.end());
        become(std::move(words));
    }
    ::close(commands[0]);
    ::close(answers[1]);
    commands_ = commands[1];
    answers_ = answers[0];
    std::istringstream ready(lineFrom(answers_));
    std::string word;
    ready >> word;
    FANTASCOPE_CHECK(word == "ready", "the Modbus peer does not start");
    for (std::string& place : places_) ready >> place;
}

void ModbusPeer::kill() {
    if (child_ < 0) return;
    // First, because the number of a closed terminal is soon another program's.
    if (wire_ == Wire::Rtu)
        for (const std::string& link : places_) std::filesystem::remove(link);
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = -1;
    ::close(commands_);
    ::close(answers_);
}

void ModbusPeer::restart() {
    kill();
    start();
}

void ModbusPeer::stop() { ::kill(child_, SIGSTOP); }
void ModbusPeer::resume() { ::kill(child_, SIGCONT); }

std::string ModbusPeer::options(int line) const {
    const std::string& place = places_[static_cast<std::size_t>(line)];
    if (wire_ == Wire::Tcp) return fmt::format("driver: modbus_tcp\nhost: 127.0.0.1\nport: {}\n", place);
    return fmt::format("driver: modbus_rtu\ndevice: {}\nparity: none\n", place);  // a pseudo-terminal has no parity
}

std::string ModbusPeer::ask(const std::string& command) const {
    const std::string line = command + "\n";
    FANTASCOPE_CHECK(::write(commands_, line.data(), line.size()) == static_cast<ssize_t>(line.size()),
                     "the Modbus peer has ended");
    std::string answer = lineFrom(answers_);
    FANTASCOPE_CHECK(!answer.empty() && answer != "no such command", "the Modbus peer fails at " + command);
    return answer;
}

std::vector<ModbusPeer::Change> ModbusPeer::journal() const {
    std::vector<Change> changes;
    std::ifstream file(folder_ / "journal");
    for (Change change; file >> change.line >> change.by >> change.coils;) changes.push_back(change);
    return changes;
}

}  // namespace fantascope
