// The simulated widget of our driver tests, as seen by an independent program: OLA accepts it as a
// DMX USB PRO for sending and receiving. What both agree on is the protocol.

#include "contract/eventually.h"
#include "contract/widget_socket.h"
#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <net/if.h>
#include <pwd.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace fantascope::contract {
namespace {

using testing::HasSubstr;

// A background program, ended with the object or with the test.
class Background {
public:
    // Runs as `user`; its output goes to `log`.
    Background(const std::vector<std::string>& command, const std::string& log, const passwd* user = nullptr) : child_(fork()) {
        if (child_ != 0) return;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
        dup2(out, STDOUT_FILENO);
        dup2(out, STDERR_FILENO);
        if (user != nullptr) {
            const bool changed =
                initgroups(user->pw_name, user->pw_gid) == 0 && setgid(user->pw_gid) == 0 && setuid(user->pw_uid) == 0;
            if (!changed) _exit(126);
            prctl(PR_SET_PDEATHSIG, SIGKILL);  // changing the user clears this
        }
        std::vector<char*> words;
        for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
        words.push_back(nullptr);
        execvp(words[0], words.data());
        _exit(127);
    }
    ~Background() {
        if (ended()) return;
        kill(child_, SIGTERM);
        waitpid(child_, nullptr, 0);
    }
    bool ended() {
        if (!ended_) ended_ = waitpid(child_, nullptr, WNOHANG) == child_;
        return ended_;
    }

private:
    const pid_t child_;
    bool ended_ = false;
};

// A network namespace for this process, so that the daemon's ports are free and nobody else
// receives it.
bool hasOwnNetwork() {
    if (unshare(CLONE_NEWNET) != 0) return false;
    const drivers::FileHandle socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq loopback{};
    loopback.ifr_name[0] = 'l';
    loopback.ifr_name[1] = 'o';
    loopback.ifr_flags = IFF_UP;
    return ioctl(socket.get(), SIOCSIFFLAGS, &loopback) == 0;
}

class OlaTest : public testing::Test {
protected:
    void SetUp() override {
        const passwd* const user = getpwnam("olad");  // it refuses to run as root
        if (user == nullptr || access("/usr/bin/olad", X_OK) != 0) GTEST_SKIP() << "OLA is missing; tools/peers installs it";
        if (!hasOwnNetwork()) GTEST_SKIP() << "only root may have a network of its own for olad";
        for (const char* plugin : {"artnet", "dummy",   "e131",     "espnet",  "ftdidmx",          "gpio",    "karate",
                                   "kinet",  "milinst", "nanoleaf", "opendmx", "openpixelcontrol", "osc",     "pathport",
                                   "renard", "sandnet", "shownet",  "spi",     "stageprofi",       "uartdmx", "usbdmx"})
            folder_.file(fmt::format("ola-{}.conf", plugin), "enabled = false\n");
        folder_.file("ola-usbserial.conf",
                     fmt::format("enabled = true\ndevice_dir = {}\ndevice_prefix = ttyUSB\npro_fps_limit = 40\n",
                                 socket_.file().parent_path().string()));
        for (const std::string& name : folder_.names()) ASSERT_EQ(chown((folder_ / name).c_str(), user->pw_uid, user->pw_gid), 0);
        ASSERT_EQ(chown(folder_.path().c_str(), user->pw_uid, user->pw_gid), 0);
        ASSERT_EQ(chmod(socket_.file().parent_path().c_str(), 0755), 0);
        ASSERT_EQ(chmod(socket_.line().name().c_str(), 0666), 0);
        olad_ = std::make_unique<Background>(
            std::vector<std::string>{"olad", "-c", folder_.path().string(), "--no-http", "--no-register-with-dns-sd", "-l", "3"},
            log_ / "olad", user);
        eventually("OLA has found a device", [&] { return ola("ola_dev_info", {}).find("Device") != std::string::npos; });
    }

    // The output of one of OLA's programs.
    std::string ola(const std::string& program, std::vector<std::string> words) const {
        words.insert(words.begin(), program);
        Background call(words, log_ / "call");
        eventually("OLA's program ends", [&] { return call.ended(); });
        return readFile(log_ / "call").value();
    }

    ScratchFolder folder_, log_;
    // OLA locks a line by its file's name, machine-wide.
    Socket<Widget> socket_{[](int line) { return std::make_unique<Widget>(line, "12345678"); },
                           fmt::format("ttyUSB{}", getpid())};
    std::unique_ptr<Background> olad_;
};

TEST_F(OlaTest, takes_our_widget_for_a_dmx_usb_pro_and_sends_by_it) {
    Widget& widget = socket_.farEnd();
    EXPECT_THAT(ola("ola_dev_info", {}), HasSubstr("DMX USB PRO, Serial #: 12345678, firmware 1.4"));
    ola("ola_patch", {"-d", "1", "-p", "0", "-u", "1"});
    Widget::Frame frame;
    for (std::size_t slot = 0; slot < frame.size(); ++slot) frame[slot] = static_cast<std::uint8_t>(3 + 7 * slot);
    ola("ola_set_dmx", {"-u", "1", "-d", fmt::format("{}", fmt::join(frame, ","))});
    eventually("OLA's frame", [&] { return widget.out().has_value(); });
    EXPECT_EQ(widget.out(), frame) << "slot by slot";
    EXPECT_EQ(widget.complaint(), "") << readFile(log_ / "olad").value();
}

TEST_F(OlaTest, receives_by_our_widget) {
    ola("ola_patch", {"-d", "1", "-i", "-p", "0", "-u", "2"});
    std::vector<std::uint8_t> desk(512);
    for (std::size_t slot = 0; slot < desk.size(); ++slot) desk[slot] = static_cast<std::uint8_t>(200 - slot % 199);
    const std::string wanted = fmt::format("2 {}\n", fmt::join(desk, ","));  // slot by slot
    const Background recorder({"ola_recorder", "--record", log_ / "show", "--universes", "2"}, log_ / "recorder");
    eventually("OLA has received", [&] {
        socket_.farEnd().comesIn(desk);
        const auto show = readFile(log_ / "show");
        return show && show->find(wanted) != std::string::npos;
    });
    EXPECT_EQ(socket_.farEnd().complaint(), "") << readFile(log_ / "olad").value();
}

}  // namespace
}  // namespace fantascope::contract
