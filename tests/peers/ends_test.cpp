// Every end of a run leaves its relays safe: `fantascope run` with a module by other authors, ended
// in every way in which a program can end.

#include "core/check.h"
#include "core/clock.h"
#include "core/random.h"
#include "peers/modbus_peer.h"
#include "peers/own_network.h"
#include "peers/plain_dmx.h"
#include "peers/process.h"
#include "program.h"
#include "scratch_folder.h"
#include "test_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <functional>
#include <optional>
#include <tuple>

namespace fantascope::peers {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Ends
sources: {red: {solid: [1, 0, 0]}}
looks: {dark: {outputs: {wall: [{source: red}]}, relays: {road: off}}}
cues: [{name: One, look: dark, fade: 0}]
)";

// A street lamp on a module, and a run that switches it off.
class Street {
public:
    explicit Street(ModbusPeer::Wire wire, const std::string& display = "headless") : peer_(wire, 1) {
        folder_.file("show.yaml", std::string(kShow));
        writeSite("site.yaml", display);
    }
    const std::filesystem::path& folder() const { return folder_.path(); }
    ModbusPeer& peer() { return peer_; }

    void write(const std::filesystem::path& file, const std::string& text) { folder_.file(file, text); }
    void writeSite(const std::filesystem::path& file, const std::string& display, const std::string& more = "") {
        std::string device = peer_.options(0);
        std::replace(device.begin(), device.end(), '\n', ',');
        folder_.file(file, fmt::format(R"(fantascope: site
version: 1
outputs: [{{name: wall, display: {{driver: {}}}, size: [64, 36], refresh_rate: 30}}]
relay_banks: [{{name: street, device: {{{}}}}}]
relays: [{{name: road, coil: 0, safe: on}}]
{})",
                                       display, device, more));
    }
    bool isSafe() const { return peer_.ask("get 0 c 0 1") == "1"; }
    // A person at the module.
    void switchByHand(bool on) { peer_.ask(on ? "set 0 c 0 1" : "set 0 c 0 0"); }
    // Whether no program has written anything except the run's own "off".
    bool isUndisturbed() const {
        return std::ranges::all_of(peer_.journal(), [](const ModbusPeer::Change& change) { return change.coils[0] == '0'; });
    }
    // The lamp is on at first; returns once the run has switched it off.
    Process run(const Process::Prepare& prepare = {}, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments = {"run", ".", "--site", ".", "--from", "One", "--report", "report.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return begun(arguments, prepare);
    }
    // The lamp is on at first; returns in the middle of its first click.
    Process trial() { return begun({"devices", "--site", ".", "--test", "street", "--yes", "--seconds", "60"}); }
    json report() const { return json::parse(contentsOf(folder_ / "report.json")); }
    void removeReport() { std::filesystem::remove(folder_ / "report.json"); }

private:
    Process begun(const std::vector<std::string>& arguments, const Process::Prepare& prepare = {}) {
        switchByHand(true);
        Process process(arguments, folder(), prepare);
        FANTASCOPE_CHECK(eventually([&] { return !isSafe() || !process.isRunning(); }) && process.isRunning(),
                         "it does not begin: " + process.said());
        return process;
    }

    const ScratchFolder folder_;
    ModbusPeer peer_;
};

// How a run ends. If the run notices, it ends in order, with a report.
struct End {
    std::string name;
    bool seen;
    std::function<void(Process& run, Process& x)> bring;
    bool needsX = false;
};

End bySignal(const char* name, int signal, bool seen) {
    return {name, seen, [signal](Process& run, Process&) { run.signal(signal); }, false};
}

const std::vector<End>& allEnds() {
    static const std::vector<End> ends = {
        bySignal("SIGINT", SIGINT, true),
        bySignal("SIGKILL", SIGKILL, false),
        bySignal("SIGTERM", SIGTERM, true),
        bySignal("SIGSEGV", SIGSEGV, false),
        bySignal("SIGHUP", SIGHUP, true),
        bySignal("SIGABRT", SIGABRT, false),
        bySignal("SIGQUIT", SIGQUIT, true),
        bySignal("SIGPIPE of another process", SIGPIPE, true),
        bySignal("SIGUSR1", SIGUSR1, true),
        {"nobody reads it any more", true, [](Process& run, Process&) { run.stopReading(); }},
        // A show goes on without its display.
        {"X killed, then SIGTERM", false,
         [](Process& run, Process& x) {
             x.signal(SIGKILL);
             run.signal(SIGTERM);
         },
         true},
        {"X stopped, then SIGTERM", false,
         [](Process& run, Process& x) {
             x.signal(SIGSTOP);
             run.signal(SIGTERM);
         },
         true},
    };
    return ends;
}

// How long after a run's end its relays were safe, as the module saw it; nothing: not within half a
// minute.
std::optional<Time> safeAfter(Street& street, const End& end, std::string& wrong) {
    std::optional<Process> x;
    std::string display;
    if (end.needsX) {
        x.emplace(Process::xServer(display));
        ::setenv("DISPLAY", display.c_str(), 1);
    } else {
        x.emplace();
    }
    street.writeSite("site.yaml", end.needsX ? "glfw" : "headless");
    street.removeReport();
    Process run = street.run();
    (void)street.peer().ask("stood 0");  // from now on
    const SteadyClock clock;
    end.bring(run, *x);
    const bool safe = eventually([&] { return street.isSafe(); });
    const Time took = clock.now();
    const int status = run.wait();
    if (!safe) {
        wrong = fmt::format("{}: the relays stay unsafe; it ended with {} and said {}", end.name, status, run.said());
        return std::nullopt;
    }
    if (end.seen && status != 0) wrong = fmt::format("{}: it ended with {} and said {}", end.name, status, run.said());
    if (end.seen && street.report()["unsafe_relays"] != json::array())
        wrong = end.name + ": the report has relays that are unsafe";
    if (!street.isSafe()) wrong = end.name + ": the relays are unsafe again";
    return took;
}

class Ends : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
    }
};

// Ends in random order, but the first of each kind in order: as many as FANTASCOPE_ENDS on each
// wire, or each kind once on one of the two. Each run begins on the site that the previous one has
// left, so no end may keep a claim.
// Example failures: only SIGINT and SIGTERM make relays safe; a crash leaves the street dark until
// the morning.
TEST_F(Ends, leave_the_relays_safe_whatever_they_are) {
    const char* const asked = std::getenv("FANTASCOPE_ENDS");
    Rng rng(18);
    for (const auto& [wire, name, begin] : {std::tuple{ModbusPeer::Wire::Tcp, "TCP", 0u}, {ModbusPeer::Wire::Rtu, "RTU", 1u}}) {
        Street street(wire);
        std::vector<const End*> ends;
        for (std::size_t i = begin; i < allEnds().size(); i += asked != nullptr ? 1 : 2) ends.push_back(&allEnds()[i]);
        while (asked != nullptr && std::ssize(ends) < std::atoi(asked))
            ends.push_back(&allEnds()[rng.below(static_cast<std::uint32_t>(allEnds().size()))]);
        int inTime = 0;
        Time longest{};
        for (const End* end : ends) {
            std::string wrong;
            const auto took = safeAfter(street, *end, wrong);
            EXPECT_EQ(wrong, "");
            if (!took) continue;
            longest = std::max(longest, *took);
            inTime += *took <= 2s;
            if (*took > 2s)
                fmt::print("  {}: {:.2f} s, of which the module's own process stood still for up to {} ms\n", end->name,
                           seconds(*took), street.peer().ask("stood 0"));
        }
        fmt::print("{}: relays safe within 2 s in {} of {}, most {:.2f} s\n", name, inTime, ends.size(), seconds(longest));
        if (asked != nullptr) {
            EXPECT_EQ(inTime, std::ssize(ends));
        }
    }
}

// Example failure: with a stopped X server only kill -9 ended the program, and there was no report.
TEST_F(Ends, an_x_server_that_is_stopped_holds_up_no_end) {
    Street street(ModbusPeer::Wire::Tcp, "glfw");
    std::string display;
    Process x = Process::xServer(display);
    ::setenv("DISPLAY", display.c_str(), 1);
    Process run = street.run();
    x.signal(SIGSTOP);
    run.signal(SIGTERM);
    const int status = run.wait();  // its use of X may hang, or not
    EXPECT_EQ(status, run.said().find("it hung while") == std::string::npos ? 0 : 1) << run.said();
    EXPECT_EQ(street.report()["unsafe_relays"], json::array());
    EXPECT_EQ(street.report()["cues"].size(), 1u);
    EXPECT_TRUE(street.isSafe());
}

// The operator is told what is not safe, and the guard goes on.
TEST_F(Ends, a_module_that_is_silent_at_the_end_is_told_and_tried_on) {
    Street street(ModbusPeer::Wire::Tcp);
    Process run = street.run();
    street.peer().ask("dead 0");
    run.signal(SIGTERM);
    EXPECT_EQ(run.wait(), 1);
    EXPECT_THAT(run.said(), HasSubstr("RELAYS MAY BE UNSAFE: 'street'"));
    EXPECT_EQ(street.report()["unsafe_relays"][0]["bank"], "street");
    EXPECT_THAT(street.report()["faults"].dump(), HasSubstr("'street' has not confirmed its safe states"));
    street.peer().ask("reset 0");
    EXPECT_TRUE(eventually([&] { return street.isSafe(); }));
}

TEST_F(Ends, a_guard_that_dies_is_replaced) {
    Street street(ModbusPeer::Wire::Tcp);
    Process run = street.run();
    const std::vector<pid_t> before = run.children();
    ASSERT_EQ(before.size(), 1u);
    ::kill(before[0], SIGKILL);
    EXPECT_TRUE(eventually([&] { return run.said().find("the relay guard died") != std::string::npos; })) << run.said();
    run.signal(SIGKILL);
    EXPECT_TRUE(eventually([&] { return street.isSafe(); }));
}

TEST_F(Ends, under_nohup_a_closed_terminal_ends_nothing) {
    Street street(ModbusPeer::Wire::Tcp);
    Process run = street.run([] { ::signal(SIGHUP, SIG_IGN); });
    run.signal(SIGHUP);
    street.switchByHand(true);
    EXPECT_TRUE(eventually([&] { return !street.isSafe(); })) << "the show goes on and puts its relay right";
    run.signal(SIGTERM);
    EXPECT_EQ(run.wait(), 0) << run.said();
    EXPECT_TRUE(street.isSafe());
}

// Example failures: output goes to the file that signals use; the guard's own files replace the
// claims that it keeps.
TEST_F(Ends, a_run_without_standard_streams_ends_as_any_other) {
    Street street(ModbusPeer::Wire::Tcp);
    const auto withoutStreams = [] {
        for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::close(stream);
    };
    Process run = street.run(withoutStreams);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        EXPECT_EQ(std::filesystem::read_symlink(fmt::format("/proc/{}/fd/{}", run.id(), stream)), "/dev/null") << stream;
    run.signal(SIGTERM);
    EXPECT_EQ(run.wait(), 0);
    EXPECT_EQ(street.report()["unsafe_relays"], json::array());
    EXPECT_TRUE(street.isSafe());
    street.run(withoutStreams).signal(SIGKILL);
    EXPECT_TRUE(eventually([&] { return street.isSafe(); }));
}

// A person at a terminal with a shell.
class Shell {
public:
    explicit Shell(const std::filesystem::path& folder) {
        int terminal = -1;
        process_ = ::forkpty(&terminal, nullptr, nullptr, nullptr);
        FANTASCOPE_CHECK(process_ >= 0, "there are terminals");
        if (process_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::setenv("PS1", kPrompt, 1);
            if (::chdir(folder.c_str()) == 0) ::execlp("bash", "bash", "--noprofile", "--norc", "-i", nullptr);
            ::_exit(127);
        }
        ::fcntl(terminal, F_SETFL, O_NONBLOCK);
        terminal_ = drivers::FileHandle(terminal);
        FANTASCOPE_CHECK(shows(kPrompt), "a shell begins");
    }
    ~Shell() {
        if (const pid_t program = started(); program > 0) ::kill(program, SIGKILL);
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }
    static constexpr const char* kPrompt = "what next? ";

    void type(const std::string& keys) {
        shown_.clear();
        FANTASCOPE_CHECK(::write(terminal_.get(), keys.data(), keys.size()) == std::ssize(keys), "a terminal takes keys");
    }
    // Whether the terminal has shown this since the last keys, or does soon.
    bool shows(const std::string& text) {
        return eventually([&] {
            char bytes[4096];
            for (ssize_t count = 0; (count = ::read(terminal_.get(), bytes, sizeof bytes)) > 0;)
                shown_.append(bytes, static_cast<std::size_t>(count));
            return shown_.find(text) != std::string::npos;
        });
    }
    const std::string& shown() const { return shown_; }
    // Whether the terminal echoes keys and delivers them by line; the shell turns both off while it
    // waits for keys.
    bool echoes() const {
        termios settings{};
        tcgetattr(terminal_.get(), &settings);
        return (settings.c_lflag & (ICANON | ECHO)) != 0;
    }
    // The program that it has started; 0: none.
    pid_t started() const {
        std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", process_));
        pid_t child = 0;
        children >> child;
        return child;
    }

private:
    pid_t process_ = -1;
    drivers::FileHandle terminal_;
    std::string shown_;
};

// Example failure: Ctrl-Z instead of Ctrl-C left the street dark until somebody noticed.
TEST_F(Ends, ctrl_z_does_not_stop_a_run) {
    Street street(ModbusPeer::Wire::Tcp);
    Shell shell(street.folder());
    street.switchByHand(true);
    shell.type(std::string(FANTASCOPE_PROGRAM) + " run . --site . --from One\n");
    ASSERT_TRUE(eventually([&] { return !street.isSafe(); }));
    shell.type(
        "\x1a"
        "0");
    EXPECT_TRUE(shell.shows("BLACKOUT")) << shell.shown();
    shell.type("qq");
    EXPECT_TRUE(eventually([&] { return shell.started() == 0; })) << shell.shown();
    EXPECT_TRUE(street.isSafe());
}

// Example failures: at its end it was stopped, because it restored a terminal that was no longer
// its own, and left no report; the shell got the settings that the run had found.
TEST_F(Ends, a_run_in_the_background_ends_with_its_report_and_leaves_the_terminal_to_the_shell) {
    Street street(ModbusPeer::Wire::Tcp);
    Shell shell(street.folder());
    street.switchByHand(true);
    shell.type(std::string(FANTASCOPE_PROGRAM) + " run . --site . --from One --report report.json\n");
    ASSERT_TRUE(eventually([&] { return !street.isSafe(); }));
    const pid_t run = shell.started();
    ASSERT_GT(run, 0);
    shell.type("");
    ::kill(run, SIGSTOP);
    ASSERT_TRUE(shell.shows(Shell::kPrompt)) << shell.shown();
    shell.type("bg\n");
    ASSERT_TRUE(shell.shows(Shell::kPrompt)) << shell.shown();
    ::kill(run, SIGTERM);
    ASSERT_TRUE(eventually([&] { return shell.started() == 0; })) << shell.shown();
    EXPECT_EQ(street.report()["unsafe_relays"], json::array());
    EXPECT_TRUE(street.isSafe());
    EXPECT_FALSE(shell.echoes());
}

class Trials : public Ends {
protected:
    void SetUp() override {
        Ends::SetUp();
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
    }
    // Until then it holds the module, and the next test may get the same line.
    static bool guardIsDone(Process& trial) {
        return eventually([&] { return trial.said().find("made its relays safe") != std::string::npos; });
    }
};

// Example failure: a tested street lamp stays off for ever.
TEST_F(Trials, a_kill_in_the_middle_of_a_click_leaves_the_relay_safe) {
    for (const auto wire : {ModbusPeer::Wire::Tcp, ModbusPeer::Wire::Rtu}) {
        Street street(wire);
        Process trial = street.trial();
        trial.signal(SIGKILL);
        EXPECT_TRUE(guardIsDone(trial)) << trial.said();
        EXPECT_TRUE(street.isSafe());
    }
}

// Example failure: the second Ctrl-C ended it at once.
TEST_F(Trials, ctrl_c_twice_in_the_middle_of_a_click_leaves_the_relay_safe) {
    Street street(ModbusPeer::Wire::Tcp);
    Process trial = street.trial();
    trial.signalAlone(SIGINT);
    trial.signalAlone(SIGINT);
    EXPECT_EQ(trial.wait(), 0) << trial.said();
    EXPECT_TRUE(street.isSafe());
}

// Another program may use the other banks of the site.
TEST_F(Trials, a_kill_switches_nothing_of_another_bank) {
    Street street(ModbusPeer::Wire::Tcp);
    std::string site = contentsOf(street.folder() / "site.yaml");
    const auto replace = [&](const std::string& old, const std::string& by) { site.replace(site.find(old), old.size(), by); };
    std::string other = street.peer().options(0) + "unit: 2\n";
    std::replace(other.begin(), other.end(), '\n', ',');
    replace("relay_banks: [", "relay_banks: [{name: yard, device: {" + other + "}}, ");
    replace("relays: [", "relays: [{name: gate, bank: yard, coil: 0, safe: on}, ");
    replace("{name: road,", "{name: road, bank: street,");
    std::ofstream(street.folder() / "site.yaml") << site;
    Process trial = street.trial();
    trial.signal(SIGKILL);
    EXPECT_TRUE(guardIsDone(trial)) << trial.said();
    EXPECT_TRUE(street.isSafe());
    EXPECT_EQ(street.peer().ask("get 0.2 c 0 1"), "0");
}

using Claims = Ends;

// Example failure: two runs switched the relays against each other 8 times a second.
TEST_F(Claims, a_second_run_is_refused_and_told_who_holds_the_site_or_a_device_of_it) {
    Street street(ModbusPeer::Wire::Tcp);
    Process first = street.run();
    const auto refused = [&](const std::string& site, const std::string& what) {
        const Outcome second = runProgram({"run", ".", "--site", site, "--from", "One"}, street.folder());
        EXPECT_EQ(second.status, 1);
        EXPECT_THAT(second.errors, AllOf(HasSubstr(what), HasSubstr(fmt::format("process {} (", first.id())),
                                         HasSubstr("run . --site . --from One"), HasSubstr(fmt::format("kill {}", first.id()))));
    };
    refused(".", "the site ");
    street.writeSite("copy.yaml", "headless");
    refused("copy.yaml", "Modbus module 127.0.0.1:");
    EXPECT_TRUE(street.isUndisturbed());
    first.signal(SIGTERM);
    EXPECT_EQ(first.wait(), 0);
}

// Example failure: the list opened every bank, and closing them wrote all coils safe in the middle
// of a show.
TEST_F(Claims, looking_at_the_devices_of_a_site_switches_nothing) {
    if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();  // `devices` searches every network
    Street street(ModbusPeer::Wire::Tcp);
    street.peer().ask("set 0 c 0 0");
    const Outcome before = runProgram({"devices", "--site", "."}, street.folder());
    ASSERT_THAT(before, exits(0));
    EXPECT_THAT(before.out, HasSubstr("street          modbus_tcp, running"));
    EXPECT_FALSE(street.isSafe()) << "it was only to look";
    EXPECT_TRUE(street.peer().journal().empty());
    Process run = street.run();
    const std::string holder = fmt::format("modbus_tcp, in use by process {}", run.id());
    EXPECT_THAT(runProgram({"devices", "--site", ".", "--watch", "--seconds", "1"}, street.folder()).out, HasSubstr(holder));
    EXPECT_FALSE(street.isSafe());
    EXPECT_TRUE(street.isUndisturbed());
}

TEST_F(Claims, what_a_run_has_is_looked_at_from_afar_and_not_tried) {
    if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
    Street street(ModbusPeer::Wire::Rtu);
    Process run = street.run();
    const std::string holder = fmt::format("in use by process {}", run.id());
    EXPECT_THAT(runProgram({"devices", "--site", "."}, street.folder()).out, HasSubstr(holder));
    const Outcome tried = runProgram({"devices", "--site", ".", "--test", "street", "--seconds", "1"}, street.folder());
    EXPECT_THAT(tried, exits(1));
    EXPECT_THAT(tried.errors, HasSubstr(holder));
    EXPECT_FALSE(street.isSafe());
    EXPECT_TRUE(street.isUndisturbed());
    run.signal(SIGTERM);
    EXPECT_EQ(run.wait(), 0) << run.said();
}

// Example failure: the guard reads the site file again, which somebody saved in the middle of the
// show, and guards other relays, or none.
TEST_F(Ends, a_guard_that_is_replaced_knows_the_site_that_the_run_has_read) {
    Street street(ModbusPeer::Wire::Tcp);
    Process run = street.run();
    street.write("site.yaml", "relays: [{name: roa");
    const std::vector<pid_t> before = run.children();
    ASSERT_EQ(before.size(), 1u);
    ::kill(before[0], SIGKILL);
    EXPECT_TRUE(eventually([&] { return run.said().find("there is a new relay guard") != std::string::npos; })) << run.said();
    run.signal(SIGKILL);
    EXPECT_TRUE(eventually([&] { return street.isSafe(); }));
}

TEST_F(Ends, the_report_tells_of_a_guard_that_died) {
    Street street(ModbusPeer::Wire::Tcp);
    Process run = street.run();
    ASSERT_EQ(run.children().size(), 1u);
    ::kill(run.children()[0], SIGKILL);
    EXPECT_TRUE(eventually([&] { return run.said().find("there is a new relay guard") != std::string::npos; })) << run.said();
    run.signal(SIGTERM);
    EXPECT_EQ(run.wait(), 0) << run.said();
    const json faults = street.report()["faults"];
    ASSERT_EQ(faults.size(), 1u) << faults;
    EXPECT_EQ(faults[0]["what"], "the relay guard died");
    EXPECT_TRUE(faults[0].contains("until"));
}

// Example failure: most lamps hold the last level that they got, the one of that moment, until the
// morning.
TEST_F(Ends, an_impatient_operator_gets_the_end_levels_at_once_and_is_told_of_the_recording) {
    if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
    Street street(ModbusPeer::Wire::Tcp);
    std::string show(kShow);
    street.write("show.yaml", show.insert(show.find("relays:"), "fixtures: {lamp: {level: 1}}, "));
    street.writeSite("site.yaml", "headless",
                     "universes: [{number: 7, port: {driver: sacn, interface: near}}]\n"
                     "fixtures: [{name: lamp, universe: 7, address: 1, channels: [level], end: 0.2}]\nend_fade: 60\n");
    PlainSocket ear = madeThere([] {
        PlainSocket socket("far", "", 5568);
        socket.join("far", sacnGroup(7));
        return socket;
    });
    std::optional<int> level;
    const auto hears = [&](int timeout) {
        for (Datagram bytes = ear.receive(timeout); !bytes.empty(); bytes = ear.receive(0))
            if (const auto levels = readPlainSacn(bytes)) level = levels->slots[0];
        return level;
    };
    Process run = street.run({}, {"--record", "recorded"});
    ASSERT_TRUE(eventually([&] { return hears(2) == 255; })) << run.said();
    ASSERT_TRUE(eventually([&] {
        run.signal(SIGINT);
        hears(2);
        return !run.isRunning();
    }));
    EXPECT_EQ(hears(100), 51);
    const std::string said = run.said();
    EXPECT_EQ(run.wait(), 1);
    EXPECT_THAT(said, AllOf(HasSubstr("it was interrupted again while making the relays safe"),
                            HasSubstr("The recording was not finished and is lost")));
    EXPECT_TRUE(street.isSafe());
    const json report = street.report();
    EXPECT_EQ(report["stop_reason"], "hung");
    EXPECT_EQ(report["recorded"]["wall"], 0);
    EXPECT_EQ(report["not_recorded"]["wall"], report["frames"]);
    EXPECT_GT(report["frames"], 0);
    ASSERT_EQ(report["faults"].size(), 1u) << report["faults"];
    EXPECT_EQ(report["faults"][0]["what"], "recording: it was not finished and is lost");
}

}  // namespace
}  // namespace fantascope::peers

int main(int count, char** arguments) {
    fantascope::peers::enterOwnNetwork();  // before anything starts a thread
    return fantascope::runTests(count, arguments);
}
