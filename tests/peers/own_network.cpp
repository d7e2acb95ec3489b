#include "peers/own_network.h"

#include "core/check.h"
#include "core/clock.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <pwd.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

namespace fantascope::peers {
namespace {

std::string why;
drivers::FileHandle here, far;  // the two namespaces
bool isGuest = false;           // root only in a user namespace of our own

drivers::FileHandle currentNamespace() {
    return drivers::FileHandle(open(fmt::format("/proc/self/task/{}/ns/net", gettid()).c_str(), O_RDONLY | O_CLOEXEC));
}

void ip(const std::string& arguments) {
    if (why.empty() && std::system(("ip " + arguments).c_str()) != 0) why = "'ip " + arguments + "' failed";
}

// Maps a user of the user namespace, `inside` there, to the one `outside`.
void mapUser(unsigned inside, unsigned outsideUser, unsigned outsideGroup) {
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << fmt::format("{} {} 1", inside, outsideUser);
    std::ofstream("/proc/self/gid_map") << fmt::format("{} {} 1", inside, outsideGroup);
}

void becomeNobody() {
    constexpr unsigned kSomebody = 1000;
    if (isGuest) {
        if (unshare(CLONE_NEWUSER) == 0) mapUser(kSomebody, 0, 0);
        return;
    }
    const passwd* const ola = getpwnam("olad");
    if (geteuid() != 0 || ola == nullptr) return;
    if (setgid(ola->pw_gid) != 0 || setuid(ola->pw_uid) != 0) _exit(127);
}

in_addr_t addressOf(const std::string& text) { return text.empty() ? INADDR_ANY : inet_addr(text.c_str()); }

sockaddr_in endpoint(const std::string& address, int port) {
    sockaddr_in internet{};
    internet.sin_family = AF_INET;
    internet.sin_port = htons(static_cast<std::uint16_t>(port));
    internet.sin_addr.s_addr = addressOf(address);
    return internet;
}

}  // namespace

std::string enterOwnNetwork() {
    if (unshare(CLONE_NEWNET) != 0) {
        const unsigned user = geteuid(), group = getegid();
        if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
            return why = fmt::format("no network namespace is permitted: {}", std::strerror(errno));
        isGuest = true;
        mapUser(0, user, group);
    }
    here = currentNamespace();
    std::thread([] {
        if (unshare(CLONE_NEWNET) == 0) far = currentNamespace();
    }).join();
    if (!far.isOpen()) return why = "no second network namespace is permitted";
    const std::string farSpace = fmt::format("/proc/{}/fd/{}", getpid(), far.get());
    ip("link set lo up");
    for (const auto& [ours, theirs, net] : {std::tuple{"near", "far", 77}, {"aside", "apart", 78}}) {
        ip(fmt::format("link add {} type veth peer name {} netns {}", ours, theirs, farSpace));
        ip(fmt::format("addr add 10.{}.0.1/24 brd + dev {}", net, ours));
        ip(fmt::format("link set {} up", ours));
        there([theirs = theirs, net = net] {
            ip(fmt::format("addr add 10.{}.0.2/24 brd + dev {}", net, theirs));
            ip(fmt::format("link set {} up", theirs));
            ip("link set lo up");
        });
    }
    there([] {
        for (int last = 11; last <= 19; ++last) ip(fmt::format("addr add 10.77.0.{}/24 brd + dev far", last));
        ip("route add 224.0.0.0/4 dev far");
    });
    return why;
}

const std::string& whyNoNetwork() { return why; }

void there(const std::function<void()>& what) {
    FANTASCOPE_CHECK(setns(far.get(), CLONE_NEWNET) == 0, "it is our own namespace");
    what();
    FANTASCOPE_CHECK(setns(here.get(), CLONE_NEWNET) == 0, "it is our own namespace");
}

void setLink(const std::string& interface, bool up) {
    const auto set = [&] {
        const drivers::FileHandle file(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        ifreq request{};
        std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
        FANTASCOPE_CHECK(ioctl(file.get(), SIOCGIFFLAGS, &request) == 0, "it is one of our interfaces");
        request.ifr_flags = static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
        FANTASCOPE_CHECK(ioctl(file.get(), SIOCSIFFLAGS, &request) == 0, "it is one of our interfaces");
    };
    if (interface == "near" || interface == "aside")
        set();
    else
        there(set);
}

PlainSocket::PlainSocket(const std::string& interface, const std::string& address, int port)
    : file_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    const int yes = 1, room = 8 << 20;
    setsockopt(file_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    setsockopt(file_.get(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
    setsockopt(file_.get(), SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
    ip_mreqn outwards{};
    outwards.imr_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    setsockopt(file_.get(), IPPROTO_IP, IP_MULTICAST_IF, &outwards, sizeof outwards);
    const sockaddr_in local = endpoint(address, port);
    FANTASCOPE_CHECK(bind(file_.get(), reinterpret_cast<const sockaddr*>(&local), sizeof local) == 0, "the port is free here");
}

void PlainSocket::join(const std::string& interface, const std::string& group) {
    ip_mreqn request{};
    request.imr_multiaddr.s_addr = addressOf(group);
    request.imr_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    FANTASCOPE_CHECK(setsockopt(file_.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0, "a group is free");
}

bool PlainSocket::send(std::span<const std::uint8_t> bytes, const std::string& to, int port) {
    const sockaddr_in remote = endpoint(to, port);
    return sendto(file_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&remote), sizeof remote) ==
           static_cast<ssize_t>(bytes.size());
}

std::vector<std::uint8_t> PlainSocket::receive(int timeout, std::string* from) {
    pollfd waited{file_.get(), POLLIN, 0};
    if (poll(&waited, 1, timeout) <= 0) return {};
    std::vector<std::uint8_t> bytes(2048);
    sockaddr_in sender{};
    socklen_t size = sizeof sender;
    const ssize_t count = recvfrom(file_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&sender), &size);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (from != nullptr) *from = inet_ntoa(sender.sin_addr);
    return bytes;
}

bool eventually(const std::function<bool()>& condition) {
    for (const SteadyClock clock; clock.now() < std::chrono::seconds(30); poll(nullptr, 0, 2))
        if (condition()) return true;
    return false;
}

Peer::Peer(const std::vector<std::string>& arguments, const std::string& log, bool asNobody) {
    std::vector<char*> words;
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (asNobody) becomeNobody();
    execvp(words[0], words.data());
    _exit(127);
}

Peer::~Peer() {
    if (process_ > 0) stop(SIGKILL);
}

int Peer::stop(int signal) {
    kill(process_, signal);
    return wait();
}

int Peer::wait() {
    int status = 0;
    waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool Peer::isRunning() {
    if (process_ <= 0) return false;
    if (waitpid(process_, nullptr, WNOHANG) == 0) return true;
    process_ = -1;
    return false;
}

int runPeer(const std::vector<std::string>& arguments, const std::string& log) { return Peer(arguments, log).wait(); }

bool isInstalled(const std::string& program) { return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0; }

}  // namespace fantascope::peers
