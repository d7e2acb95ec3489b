#include "peers/modbus_campaign.h"

#include "drivers/registry.h"

#include "core/check.h"
#include "core/random.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <optional>
#include <utility>

namespace fantascope {
namespace {

constexpr std::size_t kRelays = 16;
constexpr int kFirst = 4;
constexpr Time kGenerous = std::chrono::seconds(30);
constexpr Time kResponseTimeout = std::chrono::milliseconds(100);

std::string bitsOf(const std::vector<bool>& states) {
    std::string bits;
    for (const bool on : states) bits += on ? '1' : '0';
    return bits;
}

// The caller, like the program's relay thread.
class Caller {
public:
    Caller(RelayBank& bank, Clock& clock) : bank_(bank), clock_(clock) {}
    std::vector<bool> wanted;
    std::vector<std::string> diary;  // its events, each with the moment in seconds

    void tick() {
        const DeviceStatus status = bank_.status();
        const std::string is = fmt::format("{} losses, {} {}", status.losses, nameOf(status.state), status.detail);
        if (is != std::exchange(was_, is)) note(is);
        if (status.losses != losses_) written_.clear();
        losses_ = status.losses;
        if (wanted != written_) {
            const auto written = bank_.write(wanted);
            written_ = written ? wanted : std::vector<bool>();
            if (written || status.state == DeviceState::Running) note(written ? "written" : written.error().message());
        }
        clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(5));
    }
    bool content() const { return wanted == written_; }
    void note(const std::string& what) { diary.push_back(fmt::format("{:.3f} {}", seconds(clock_.now()), what)); }

private:
    RelayBank& bank_;
    Clock& clock_;
    std::vector<bool> written_;
    std::string was_;
    int losses_ = 0;
};

struct Fault {
    std::string name;
    std::function<void(ModbusPeer&)> begin, end;
};

std::vector<Fault> faultsOn(ModbusPeer::Wire wire) {
    const auto asked = [](const char* command) { return [command](ModbusPeer& peer) { peer.ask(command); }; };
    std::vector<Fault> faults{
        {"killed", [](ModbusPeer& peer) { peer.kill(); }, [](ModbusPeer& peer) { peer.restart(); }},
        {"stopped", [](ModbusPeer& peer) { peer.stop(); }, [](ModbusPeer& peer) { peer.resume(); }},
        {"wrong unit", asked("unit 0 9"), asked("unit 0 1")},
        {"exceptions", asked("exception 0 4"), asked("exception 0 0")},
        {"late answers", asked("late 0 110"), asked("late 0 0")},  // some still in time, most too late
        {"no answers", asked("mute 0 1"), asked("mute 0 0")},
        {"line cut", asked("cut 0"), asked("mend 0")},
    };
    if (wire == ModbusPeer::Wire::Rtu) faults.push_back({"noise", asked("noise 0 1"), asked("noise 0 0")});
    return faults;
}

}  // namespace

ModbusCampaign runModbusCampaign(ModbusPeer::Wire wire, int faults, std::uint64_t seed) {
    ModbusCampaign campaign;
    ModbusPeer peer(wire, 1);
    SteadyClock clock;
    Rng rng(seed);
    const drivers::DriverContext context{clock};
    const std::string text =
        peer.options(0) + fmt::format("first: {}\nresponse_timeout: {}\n", kFirst, seconds(kResponseTimeout));
    const auto options = ConfigNode::parse(text, "site.yaml").value();
    const std::vector<Fault> kinds = faultsOn(wire);

    // All requested states, each with its number: a module may see them only in that order.
    std::map<std::string, int> asked;
    const auto newStates = [&] {
        std::vector<bool> states;
        do {
            states.clear();
            while (states.size() < kRelays) states.push_back(rng.below(2) == 1);
        } while (asked.contains(bitsOf(states)));
        asked.emplace(bitsOf(states), static_cast<int>(asked.size()));
        return states;
    };
    const std::vector<bool> safe = newStates();
    {
        const auto bank = drivers::openRelayBank(options, "relays", safe, context).value();
        Caller caller(*bank, clock);
        // The module's own state, by another way than the line.
        const auto really = [&] {
            std::string bits;
            for (const char letter : peer.ask(fmt::format("get 0 c {} {}", kFirst, kRelays)))
                if (letter != ' ') bits += letter;
            return bits;
        };
        const auto stood = [&] { return std::chrono::milliseconds(std::stoi(peer.ask("stood 0"))) > kResponseTimeout / 2; };
        Time ended{};  // end of the fault
        const auto settled = [&] {
            const Time deadline = clock.now() + kGenerous;
            while (!(caller.content() && really() == bitsOf(caller.wanted))) {
                if (clock.now() > deadline) return false;
                caller.tick();
                if (!stood()) continue;
                ++campaign.stalls;
                ended = clock.now();
                caller.note("the module's process stood still");
            }
            return true;
        };
        caller.wanted = newStates();
        if (!settled()) campaign.wrong.push_back("it does not begin: " + bank->status().detail);
        for (int number = 0; number < faults && campaign.wrong.empty(); ++number) {
            caller.diary.clear();
            const Fault& fault = kinds[rng.below(static_cast<std::uint32_t>(kinds.size()))];
            fault.begin(peer);
            // Some faults are over before anybody notices, some last; meanwhile the show goes on.
            const std::uint32_t ticks = 1 + rng.below(80);
            for (std::uint32_t tick = 0; tick < ticks; ++tick) {
                if (rng.below(20) == 0) caller.wanted = newStates();
                caller.tick();
            }
            fault.end(peer);
            (void)stood();  // discards what it was told to do
            ended = clock.now();
            caller.note("the fault ends");
            if (!settled())
                campaign.wrong.push_back(fmt::format("fault {} ({}): wanted {}, it has {}; {}", number, fault.name,
                                                     bitsOf(caller.wanted), really(), bank->status().detail));
            const Time took = clock.now() - ended;
            campaign.recovery[fault.name].push_back(seconds(took));
            if (took > ModbusCampaign::kSoon)
                campaign.slow.push_back(
                    fmt::format("fault {} ({}):\n    {}", number, fault.name, fmt::join(caller.diary, "\n    ")));
        }
    }

    int newest = -1;
    for (const ModbusPeer::Change& change : peer.journal()) {
        ++campaign.writes;
        const std::string states = change.coils.substr(kFirst, kRelays);
        const auto known = asked.find(states);
        if (known == asked.end())
            campaign.wrong.push_back("nobody asked for " + states);
        else if (states != bitsOf(safe) && std::exchange(newest, std::max(newest, known->second)) > known->second)
            campaign.wrong.push_back("an older wish came after a newer one: " + states);
        if (change.coils.find('1') < kFirst || change.coils.find('1', kFirst + kRelays) != std::string::npos)
            campaign.wrong.push_back("a coil of nobody's was switched: " + change.coils);
    }
    return campaign;
}

}  // namespace fantascope
