#pragma once
// Fantascope, killed at the n-th system call by which it changes the files of a folder.

#include "drivers/common/file_handle.h"

#include "core/check.h"
#include "program.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope {

// Calls by which a file gets or loses a name or bytes, and which of their arguments is its path. A
// call with a path relative to a folder other than the working one counts for none.
struct ChangingCall {
    long number;
    unsigned path;
};
constexpr unsigned kDescriptor = 100;  // the first argument is an open file
inline constexpr std::array kChangingCalls = {
    ChangingCall{SYS_openat, 1},
    ChangingCall{SYS_open, 0},
    ChangingCall{SYS_creat, 0},
    ChangingCall{SYS_linkat, 3},
    ChangingCall{SYS_link, 1},
    ChangingCall{SYS_rename, 1},
    ChangingCall{SYS_renameat, 3},
    ChangingCall{SYS_renameat2, 3},
    ChangingCall{SYS_mkdir, 0},
    ChangingCall{SYS_mkdirat, 1},
    ChangingCall{SYS_unlink, 0},
    ChangingCall{SYS_unlinkat, 1},
    ChangingCall{SYS_symlink, 1},
    ChangingCall{SYS_write, kDescriptor},
    ChangingCall{SYS_pwrite64, kDescriptor},
    ChangingCall{SYS_writev, kDescriptor},
    ChangingCall{SYS_ftruncate, kDescriptor},
    ChangingCall{SYS_truncate, 0},
};

class KilledProgram {
public:
    // Runs the program in `folder`, which it is to change, and kills it just before it makes its
    // n-th call; 0: the first.
    KilledProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder, int n)
        : folder_(std::filesystem::canonical(folder)) {
        int gate[2];
        FANTASCOPE_CHECK(::pipe2(gate, O_CLOEXEC) == 0, "there are pipes");
        child_ = ::fork();
        if (child_ == 0) {
            char byte = 0;
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            if (::read(gate[0], &byte, 1) != 1 || ::chdir(folder_.c_str()) != 0 || !askTracer()) ::_exit(127);
            for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(::open("/dev/null", O_RDWR), stream);
            execute(arguments);
        }
        const drivers::FileHandle waits(gate[0]), go(gate[1]);
        FANTASCOPE_CHECK(
            ::ptrace(PTRACE_SEIZE, child_, nullptr, PTRACE_O_TRACESECCOMP | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL) == 0,
            "a program may be traced");
        FANTASCOPE_CHECK(::write(gate[1], "g", 1) == 1, "the pipe can be written to");
        follow(n);
    }

    // Whether it was killed: it made more than n calls. Else its exit status.
    bool wasKilled() const { return killed_; }
    int status() const { return status_; }
    const std::string& call() const { return call_; }  // what it was about to do

private:
    // In the child: the calls stop it for its tracer.
    static bool askTracer() {
        std::vector<sock_filter> filter = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
        for (const ChangingCall& call : kChangingCalls) {
            filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call.number), 0, 1));
            filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE));
        }
        filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
        const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
        return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
    }

    void follow(int n) {
        for (;;) {
            int status = 0;
            const pid_t thread = ::waitpid(-1, &status, __WALL);
            FANTASCOPE_CHECK(thread > 0, "the traced program ends before its tracer");
            if (!WIFSTOPPED(status)) {
                if (thread != child_) continue;
                status_ = statusOf(status);
                return;
            }
            const int event = status >> 16;
            if (event == PTRACE_EVENT_SECCOMP && !killed_ && changes(thread) && n-- == 0) {
                killed_ = true;
                ::kill(child_, SIGKILL);
                continue;
            }
            ::ptrace(PTRACE_CONT, thread, nullptr, event == 0 ? WSTOPSIG(status) : 0);
        }
    }

    // Whether a stopped thread is about to change something in the folder. What becomes of a file
    // without a name, nobody sees.
    bool changes(pid_t thread) {
        __ptrace_syscall_info info{};
        if (::ptrace(PTRACE_GET_SYSCALL_INFO, thread, sizeof info, &info) <= 0) return false;
        const auto number = static_cast<long>(info.seccomp.nr);
        const auto& arguments = info.seccomp.args;
        const auto call = std::ranges::find(kChangingCalls, number, &ChangingCall::number);
        const std::uint64_t flags = arguments[number == SYS_openat ? 2 : 1];
        if ((number == SYS_openat || number == SYS_open) && (flags & (O_CREAT | O_TRUNC)) == 0) return false;
        const std::filesystem::path path =
            call->path == kDescriptor ? target(thread, arguments[0]) : (folder_ / textAt(thread, arguments[call->path]));
        call_ = fmt::format("call {} of {}", number, path.string());
        const std::string name = path.lexically_normal();
        return name.starts_with(folder_.string()) && !name.ends_with(" (deleted)");
    }
    static std::filesystem::path target(pid_t thread, std::uint64_t descriptor) {
        std::error_code ignored;
        return std::filesystem::read_symlink(fmt::format("/proc/{}/fd/{}", thread, descriptor), ignored);
    }
    static std::string textAt(pid_t thread, std::uint64_t address) {
        std::string text(PATH_MAX, '\0');
        // No further than the page: what follows it may not be there.
        const std::size_t page = 4096, size = page - address % page;
        iovec here{text.data(), size}, there{reinterpret_cast<void*>(address), size};
        const ssize_t first = ::process_vm_readv(thread, &here, 1, &there, 1, 0);
        if (first > 0 && text.find('\0') >= static_cast<std::size_t>(first)) {
            here = {text.data() + first, text.size() - static_cast<std::size_t>(first)};
            there = {reinterpret_cast<void*>(address + static_cast<std::uint64_t>(first)), here.iov_len};
            ::process_vm_readv(thread, &here, 1, &there, 1, 0);
        }
        return text.substr(0, text.find('\0'));
    }

    const std::filesystem::path folder_;
    pid_t child_ = -1;
    bool killed_ = false;
    int status_ = -1;
    std::string call_;
};

}  // namespace fantascope
