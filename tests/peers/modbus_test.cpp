// The Modbus drivers with pymodbus, over TCP and over a serial line.

#include "app/live/lighting.h"
#include "app/running_show.h"
#include "drivers/common/file_handle.h"
#include "drivers/registry.h"

#include "contract/input_bank_suite.h"
#include "contract/relay_bank_suite.h"
#include "core/clock.h"
#include "core/config/config.h"
#include "peers/modbus_campaign.h"
#include "peers/modbus_peer.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <functional>
#include <thread>
#include <tuple>

namespace fantascope {
namespace {

using contract::violations;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Time kGenerous = std::chrono::seconds(30);

std::string nameOfWire(const testing::TestParamInfo<ModbusPeer::Wire>& info) {
    return info.param == ModbusPeer::Wire::Tcp ? "Tcp" : "Rtu";
}

ConfigNode parsed(const std::string& text) { return ConfigNode::parse(text, "site.yaml").value(); }

// Whether the condition holds soon.
bool comesTrue(Clock& clock, const std::function<bool()>& condition) {
    for (const Time deadline = clock.now() + kGenerous; !condition();) {
        if (clock.now() > deadline) return false;
        clock.sleepUntil(clock.now() + std::chrono::milliseconds(1));
    }
    return true;
}

bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

// A machine busy with other tests may take .4 s to deliver what was written to a pseudo-terminal.
const std::string kPatient = "response_timeout: 1\n";
const std::string kPatientRelays = kPatient + "timeout: 3\n";

// How a rig's line is lost.
enum class Loss { LineIsCut, UnitIsSilent };

// The port under test on line 0 of a peer, its neighbour on line 1.
template <class PortRig>
class PeerRig : public PortRig {
public:
    using Port = typename PortRig::PortType;

    Port& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = open();
    }
    void unplug() override {
        plugged_ = false;
        peer_.ask(loss_ == Loss::LineIsCut ? "cut 0" : "unit 0 9");
    }
    void plugIn() override {
        plugged_ = true;
        peer_.ask(loss_ == Loss::LineIsCut ? "mend 0" : "unit 0 1");
    }
    // Waits until the state matches the plug, earlier requests are answered, and the module's
    // watchdog has had its effect. Of four answers, one may be under way already, one may be to the
    // watchdog, one reports the relays, and after the next the driver knows.
    void letTimePass() override {
        const int served = this->served();
        const bool passed = comesTrue(clock_, [&] {
            if (runs(*port_) != plugged_ || port_->status().state == DeviceState::Starting) return false;
            return plugged_ ? this->served() >= served + 4 : peer_.ask("armed 0") == "0";
        });
        if (!passed) ADD_FAILURE() << "it is " << nameOf(port_->status().state) << ": " << port_->status().detail;
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override { return *neighbour_; }

protected:
    PeerRig(ModbusPeer& peer, Loss loss, std::string options) : peer_(peer), loss_(loss), more_(std::move(options)) {
        for (const char* command : {"reset 0", "reset 1"}) peer_.ask(command);
        neighbour_ = drivers::openInputBank(parsed(peer_.options(1)), "contacts", 3, context_).value();
        if (!comesTrue(clock_, [&] { return runs(*neighbour_); })) ADD_FAILURE() << neighbour_->status().detail;
    }
    virtual std::unique_ptr<Port> open() = 0;
    int served() const { return std::stoi(peer_.ask("served 0")); }
    ConfigNode options() const { return parsed(peer_.options(0) + "first: 4\nrate: 50\n" + more_); }

    ModbusPeer& peer_;
    const Loss loss_;
    const std::string more_;
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    std::unique_ptr<Port> port_;

private:
    bool plugged_ = true;
    std::unique_ptr<InputBank> neighbour_;
};

class RelaysOnPeer final : public PeerRig<contract::RelayBankRig> {
public:
    RelaysOnPeer(ModbusPeer& peer, Loss loss) : PeerRig(peer, loss, "watchdog: {register: 100, period: 0.05}\n" + kPatientRelays) {
        peer_.ask("watchdog 0 1500 4 101");
        reopen();
        letTimePass();
    }
    std::vector<bool> relays() override {
        std::vector<bool> states;
        for (const char letter : peer_.ask("get 0 c 4 3"))
            if (letter != ' ') states.push_back(letter == '1');
        return states;
    }
    void handSwitches(const std::vector<bool>& states) override {
        peer_.ask(fmt::format("set 0 c 4 {:d} {:d} {:d}", bool(states[0]), bool(states[1]), bool(states[2])));
    }
    void close() override { port_.reset(); }

private:
    std::unique_ptr<RelayBank> open() override { return drivers::openRelayBank(options(), "relays", kSafe, context_).value(); }
};

class ContactsOnPeer final : public PeerRig<contract::InputBankRig> {
public:
    // `table`, `closed`: table and value of a closed contact, as in the peer.
    ContactsOnPeer(ModbusPeer& peer, Loss loss, char table, int closed, const std::string& options)
        : PeerRig(peer, loss, options + kPatient), table_(table), closed_(closed) {
        reopen();
        letTimePass();
    }
    void setContact(std::size_t contact, bool closed) override {
        peer_.ask(fmt::format("set 0 {} {} {}", table_, 4 + contact, closed ? closed_ : 0));
    }

private:
    std::unique_ptr<InputBank> open() override { return drivers::openInputBank(options(), "contacts", 3, context_).value(); }
    const char table_;
    const int closed_;
};

class OnModbus : public testing::TestWithParam<ModbusPeer::Wire> {
protected:
    void SetUp() override {
        static const std::string missing = ModbusPeer::missing();
        if (!missing.empty()) GTEST_SKIP() << missing;
        peer_ = std::make_unique<ModbusPeer>(GetParam(), 2);
    }
    std::unique_ptr<RelayBank> relays(const std::string& more, std::size_t count = 3) {
        return drivers::openRelayBank(parsed(peer_->options(0) + more), "relays", std::vector<bool>(count, false), context_)
            .value();
    }
    std::unique_ptr<InputBank> contacts(const std::string& more, int line = 0) {
        return drivers::openInputBank(parsed(peer_->options(line) + more), "contacts", 3, context_).value();
    }
    bool comesTrue(const std::function<bool()>& condition) { return fantascope::comesTrue(clock_, condition); }
    bool saysBeforeLong(const Device& device, const std::string& words) {
        return comesTrue([&] { return device.status().detail.find(words) != std::string::npos; });
    }

    std::unique_ptr<ModbusPeer> peer_;
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
};
INSTANTIATE_TEST_SUITE_P(, OnModbus, testing::Values(ModbusPeer::Wire::Tcp, ModbusPeer::Wire::Rtu), nameOfWire);

TEST_P(OnModbus, the_contract_of_relays_is_kept_when_the_line_is_cut) {
    EXPECT_THAT(violations(contract::relayBankSuite(), [&] { return std::make_unique<RelaysOnPeer>(*peer_, Loss::LineIsCut); }),
                IsEmpty());
}

TEST_P(OnModbus, the_contract_of_contacts_is_kept_by_discrete_inputs) {
    EXPECT_THAT(violations(contract::inputBankSuite(),
                           [&] { return std::make_unique<ContactsOnPeer>(*peer_, Loss::LineIsCut, 'd', 1, ""); }),
                IsEmpty());
}

TEST_P(OnModbus, the_contract_of_contacts_is_kept_by_registers) {
    const Loss lossOfRegisters = GetParam() == ModbusPeer::Wire::Tcp ? Loss::UnitIsSilent : Loss::LineIsCut;
    EXPECT_THAT(violations(contract::inputBankSuite(),
                           [&] {
                               return std::make_unique<ContactsOnPeer>(*peer_, lossOfRegisters, 'i', 700,
                                                                       "kind: input_registers\nthreshold: 500\nhysteresis: 50\n");
                           }),
                IsEmpty());
}

TEST_P(OnModbus, registers_get_the_value_for_on_and_the_value_for_off) {
    const auto bank = relays("kind: holding_registers\nfirst: 10\non: 256\noff: 512\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    EXPECT_THAT(bank->read().error().message(),
                HasSubstr("holding registers 10 to 12 say 0 0 0, neither on (256) nor off (512)"));
    EXPECT_TRUE(bank->write({true, false, true}));
    EXPECT_EQ(peer_->ask("get 0 h 9 5"), "0 256 512 256 0");
    EXPECT_EQ(bank->read().value(), (std::vector<bool>{true, false, true}));
}

// That the module has accepted a request says nothing about its relays.
TEST_P(OnModbus, a_write_is_confirmed_by_what_is_read_back) {
    const auto bank = relays("");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    peer_->ask("stuck 0 1");
    const auto written = bank->write({true, true, true});
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), HasSubstr("coils 0 to 2 were set to 1 1 1 and say 1 0 1"));
    EXPECT_TRUE(runs(*bank)) << bank->status().detail;
    EXPECT_TRUE(bank->write({true, false, false}));
}

// The default show's street on a module. Show time runs as fast as the module answers.
class Street {
public:
    Street(std::unique_ptr<RelayBank> bank) { show_.devices.relayBanks[0] = std::move(bank); }
    const RelayBank& bank() const { return *show_.devices.relayBanks[0]; }
    void pass(Time time) {
        for (const Time end = show_.clock.now() + time; show_.clock.now() < end;
             show_.clock.advance(std::chrono::milliseconds(50))) {
            lighting.tick(show_.clock.now());
            relays_[0].work(show_.clock.now());
        }
    }
    void enter(const char* cue) { show_.inputs.submit(show_.jumpTo(cue)); }
    Time now() const { return show_.clock.now(); }

private:
    app::RunningShow show_;

public:
    std::vector<std::string> told() const { return show_.told(); }
    app::Lighting lighting{show_.site,        show_.inputs, show_.devices, show_.clock,
                           show::ShowClock(), nullptr,      show_.faults,  show_.events};

private:
    const std::vector<app::Part> relays_ = lighting.relayParts();
};

// Example failure: 20 writes a second all night for one burnt relay, and nobody is told.
TEST_P(OnModbus, a_relay_that_sticks_is_told_once_and_written_ever_more_rarely) {
    Street street(relays("", 2));
    ASSERT_TRUE(comesTrue([&] { return runs(street.bank()); })) << street.bank().status().detail;
    peer_->ask("stuck 0 1");
    street.pass(std::chrono::seconds(10));
    EXPECT_THAT(peer_->journal(), testing::SizeIs(testing::Le(9)));
    EXPECT_THAT(street.told(),
                testing::ElementsAre(AllOf(HasSubstr("road-south of 'road' did not switch"), HasSubstr("say 1 0"))));
    EXPECT_TRUE(runs(street.bank())) << street.bank().status().detail;

    street.lighting.end(street.now());
    street.pass(std::chrono::seconds(1));
    EXPECT_THAT(peer_->journal(), testing::SizeIs(testing::Ge(20))) << "at the end it is tried at every tick";
    EXPECT_FALSE(street.lighting.ended());
    ASSERT_THAT(street.lighting.unsafeBanks(), testing::SizeIs(1));
    EXPECT_THAT(street.lighting.unsafeBanks()[0].why, HasSubstr("say 1 0"));
}

// A refusal is not a loss. Example failure: the module is missing and back for ever.
TEST_P(OnModbus, a_module_that_refuses_is_told_once_and_asked_ever_more_rarely) {
    Street street(relays("", 2));
    ASSERT_TRUE(comesTrue([&] { return runs(street.bank()); })) << street.bank().status().detail;
    peer_->ask("refuse 0 1");
    const int before = std::stoi(peer_->ask("asked 0"));
    street.pass(std::chrono::seconds(10));
    EXPECT_LE(std::stoi(peer_->ask("asked 0")) - before, 9 * 2 + 50) << "a write and a read each, and the looks of the meantime";
    EXPECT_THAT(street.told(), testing::ElementsAre(HasSubstr("road-north, road-south of 'road' did not switch (relays: ")));
    EXPECT_EQ(street.bank().status().losses, 0);
    peer_->ask("refuse 0 0");
    street.enter("Farewell");
    street.pass(std::chrono::seconds(20));
    EXPECT_THAT(street.told(), testing::ElementsAre(testing::_, HasSubstr("the relays of 'road' are as they should be after")));
    EXPECT_EQ(peer_->ask("get 0 c 0 2"), "1 1");
}

// Many cheap modules lack the functions that write several values.
TEST_P(OnModbus, relays_are_written_one_by_one_where_the_module_needs_it) {
    const auto bank = relays("first: 8\none_by_one: true\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    ASSERT_TRUE(bank->write({true, false, true}));
    EXPECT_EQ(peer_->ask("get 0 c 7 5"), "0 1 0 1 0");
    std::vector<std::string> states;
    for (const ModbusPeer::Change& change : peer_->journal()) states.push_back(change.coils.substr(8, 3));
    EXPECT_THAT(states, testing::ElementsAre("100", "100", "101"));
}

TEST_P(OnModbus, without_a_watchdog_of_the_module_the_relays_are_said_to_hold) {
    EXPECT_EQ(relays("")->status().onLoss, LossAction::Hold);
    EXPECT_EQ(relays("watchdog: {register: 100, period: 0.1}")->status().onLoss, LossAction::SafeState);
}

// Until the show writes, the relays must stay as the watchdog has set them.
TEST_P(OnModbus, the_watchdog_is_not_fed_before_the_first_write) {
    const auto bank = relays("rate: 50\nwatchdog: {register: 100, values: [5, 6], period: 0.02}\n");
    ASSERT_TRUE(comesTrue([&] { return std::stoi(peer_->ask("served 0")) > 10; })) << bank->status().detail;
    EXPECT_EQ(peer_->ask("fed 0"), "-");
    ASSERT_TRUE(bank->write({true, true, true}));
    EXPECT_TRUE(comesTrue([&] { return peer_->ask("fed 0") == "5 6 5"; })) << peer_->ask("fed 0");
}

TEST_P(OnModbus, a_wrong_address_is_told_in_words) {
    const auto bank = relays("first: 126\n");
    EXPECT_TRUE(saysBeforeLong(*bank, "illegal data address: unit 1 does not have all of coils 126 to 128; check 'first'"))
        << bank->status().detail;
    EXPECT_EQ(bank->status().losses, 0);
}

TEST_P(OnModbus, a_silent_unit_is_named) {
    const auto bank = relays("unit: 9\nresponse_timeout: 0.1\n");
    EXPECT_TRUE(saysBeforeLong(*bank, "unit 9 on")) << bank->status().detail;
    EXPECT_TRUE(saysBeforeLong(*bank, "does not answer within 0.1 s: check its power, wires and address"))
        << bank->status().detail;
}

// Example failure: every check of the dead unit takes its whole timeout, as often as for a living
// one.
TEST_P(OnModbus, a_dead_unit_leaves_the_line_to_the_others) {
    peer_->ask("dead 0.2");
    const auto dead = contacts(kPatient + "unit: 2\nrate: 50\n");
    const auto bank = relays(kPatientRelays);
    const auto living = contacts(kPatient + "first: 8\nrate: 50\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank) && runs(*living); })) << bank->status().detail << living->status().detail;
    for (int time = 0; time < 40; ++time) {
        const std::vector<bool> states{time % 2 == 0, time % 3 == 0, true};
        const auto written = bank->write(states);
        ASSERT_TRUE(written) << written.error().message();
        const auto read = bank->read();
        ASSERT_TRUE(read) << read.error().message();
        EXPECT_EQ(*read, states);
    }
    EXPECT_EQ(bank->status().losses + living->status().losses, 0);
    EXPECT_FALSE(runs(*dead));
    peer_->ask("set 0 d 9 1");
    EXPECT_TRUE(comesTrue([&] { return living->poll().has_value(); }));
    const auto count = [&](const char* what) { return std::stoi(peer_->ask(what)); };
    const int served = count("served 0"), asked = count("asked 0.2");
    ASSERT_TRUE(comesTrue([&] { return count("served 0") >= served + 100; }));
    EXPECT_LT(count("asked 0.2"), asked + 20);
}

TEST_P(OnModbus, a_dead_bus_leaves_the_others_alone) {
    ModbusPeer hanging(GetParam(), 1);
    const auto dead = drivers::openRelayBank(parsed(hanging.options(0)), "relays", {false}, context_).value();
    ASSERT_TRUE(comesTrue([&] { return runs(*dead); })) << dead->status().detail;
    hanging.stop();
    const auto bank = relays("");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    for (int time = 0; time < 200; ++time) {
        const auto written = bank->write({time % 2 == 0, time % 3 == 0, true});
        ASSERT_TRUE(written) << written.error().message();
    }
    EXPECT_EQ(bank->status().losses, 0);
    EXPECT_TRUE(comesTrue([&] { return !runs(*dead); }));
    EXPECT_FALSE(dead->write({true}));
    hanging.resume();
    EXPECT_TRUE(comesTrue([&] { return runs(*dead); })) << dead->status().detail;
}

// A short power interruption changes a module's relays, and nothing else on a serial line shows it.
TEST_P(OnModbus, relays_that_changed_by_themselves_are_a_loss) {
    const auto bank = relays("rate: 50\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    ASSERT_TRUE(bank->write({true, true, false}));
    peer_->ask("set 0 c 0 0 0 0");
    EXPECT_TRUE(comesTrue([&] { return bank->status().losses == 1; }));
    EXPECT_TRUE(runs(*bank)) << bank->status().detail;
    EXPECT_EQ(bank->read().value(), (std::vector<bool>{false, false, false})) << "nothing is written until the next write()";
    ASSERT_TRUE(bank->write({true, true, false}));
    EXPECT_EQ(peer_->ask("get 0 c 0 3"), "1 1 0");
}

// Example failure: a unit is taken for the one whose turn was before.
TEST_P(OnModbus, units_on_one_line_get_what_is_theirs) {
    const auto first = relays("rate: 50\n"), second = relays("unit: 2\nrate: 50\n");
    const auto looking = contacts("unit: 2\nrate: 50\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*first) && runs(*second) && runs(*looking); }))
        << first->status().detail << second->status().detail;
    const auto use = [](RelayBank& bank, bool mine) {
        for (int time = 0; time < 100; ++time) {
            const std::vector<bool> states{mine, !mine, time % 2 == 0};
            ASSERT_TRUE(bank.write(states));
            EXPECT_EQ(bank.read().value(), states);
        }
    };
    std::jthread other([&] { use(*second, false); });
    use(*first, true);
    other.join();
    EXPECT_EQ(first->status().losses + second->status().losses + looking->status().losses, 0);
    std::size_t writes = 0;
    for (const ModbusPeer::Change& change : peer_->journal()) {
        EXPECT_EQ(change.coils.substr(0, 2), change.line == 0 ? "10" : "01");
        ++writes;
    }
    EXPECT_GE(writes, 200u);
}

// Otherwise an abandoned write could still take effect later, unnoticed.
TEST_P(OnModbus, a_write_that_nobody_waits_for_any_more_is_not_done) {
    const auto slow = contacts("response_timeout: 0.3\nunit: 9\nrate: 50\n");  // occupies the line for its timeout
    const auto bank = relays("response_timeout: 0.3\n");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    peer_->ask("mute 0 1");
    EXPECT_FALSE(bank->write({true, true, true}));
    EXPECT_TRUE(comesTrue([&] { return !runs(*bank); }));
    peer_->ask("set 0 c 0 0 0 0");
    peer_->ask("mute 0 0");
    ASSERT_TRUE(comesTrue([&] { return runs(*bank); })) << bank->status().detail;
    EXPECT_EQ(bank->read().value(), (std::vector<bool>{false, false, false}));
}

TEST_P(OnModbus, two_on_one_line_need_the_same_settings_of_it) {
    const auto bank = relays("");
    const auto other = drivers::openInputBank(parsed(peer_->options(0) + "response_timeout: 0.2\n"), "contacts", 3, context_);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message(), AllOf(HasSubstr("site.yaml:1:1"), HasSubstr("with other settings")));
}

TEST_P(OnModbus, faults_are_survived_without_a_wrong_relay) {
    const ModbusCampaign campaign = runModbusCampaign(GetParam(), 25, 2026);
    EXPECT_THAT(campaign.wrong, IsEmpty());
    std::size_t faults = 0;
    for (const auto& [name, times] : campaign.recovery) faults += times.size();
    EXPECT_EQ(faults, 25u);
    EXPECT_GT(campaign.writes, 25u) << "the modules saw too few writes for it to mean anything";
}

// The line is there, the unit is not: only a timeout shows it.
TEST(ModbusSerialLine, the_contract_of_relays_is_kept_when_the_unit_falls_silent) {
    if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
    ModbusPeer peer(ModbusPeer::Wire::Rtu, 2);
    EXPECT_THAT(violations(contract::relayBankSuite(), [&] { return std::make_unique<RelaysOnPeer>(peer, Loss::UnitIsSilent); }),
                IsEmpty());
}

// A serial line is for one program only; another would take its answers.
TEST(ModbusSerialLine, is_refused_while_somebody_else_has_it) {
    if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
    ModbusPeer peer(ModbusPeer::Wire::Rtu, 1);
    SteadyClock clock, clockOfAnother;
    const auto first = drivers::openInputBank(parsed(peer.options(0)), "contacts", 3, {clock}).value();
    ASSERT_TRUE(comesTrue(clock, [&] { return runs(*first); })) << first->status().detail;
    const auto second = drivers::openInputBank(parsed(peer.options(0)), "contacts", 3, {clockOfAnother}).value();
    EXPECT_TRUE(comesTrue(clock, [&] { return second->status().detail.find("is in use") != std::string::npos; }))
        << second->status().detail;
    EXPECT_TRUE(runs(*first));
}

TEST(ModbusSerialLine, says_what_keeps_it_from_being_used) {
    if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
    ModbusPeer peer(ModbusPeer::Wire::Rtu, 1);
    SteadyClock clock;
    for (const auto& [options, state, words] : std::vector<std::tuple<std::string, DeviceState, std::string>>{
             {peer.options(0) + "rs485: true\n", DeviceState::Faulted, "does not switch RS-485"},
             {"driver: modbus_rtu\nusb: {serial: of none}\n", DeviceState::Absent,
              "the USB adapter serial of none is not plugged in"},
             {"driver: modbus_rtu\ndevice: /dev/none\n", DeviceState::Absent, "/dev/none is not there"}}) {
        const auto bank = drivers::openInputBank(parsed(options), "contacts", 3, {clock}).value();
        EXPECT_TRUE(comesTrue(clock, [&] { return bank->status().detail.find(words) != std::string::npos; }))
            << bank->status().detail;
        EXPECT_EQ(bank->status().state, state);
    }
}

// A socket with a full queue drops connections, like a host behind a firewall.
TEST(ModbusTcp, a_host_that_drops_connections_delays_nobody) {
    if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const auto name = reinterpret_cast<sockaddr*>(&address);
    const drivers::FileHandle listener(::socket(AF_INET, SOCK_STREAM, 0));
    ASSERT_TRUE(::bind(listener.get(), name, size) == 0 && ::listen(listener.get(), 0) == 0 &&
                ::getsockname(listener.get(), name, &size) == 0);
    std::vector<drivers::FileHandle> queue;
    for (int i = 0; i < 4; ++i) {
        queue.emplace_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
        (void)::connect(queue.back().get(), name, size);
    }
    SteadyClock clock;
    const drivers::DriverContext context{clock};
    const auto dead =
        drivers::openRelayBank(parsed(fmt::format("driver: modbus_tcp\nhost: 127.0.0.1\nport: {}\nresponse_timeout: 0.1\n",
                                                  ntohs(address.sin_port))),
                               "hanging", {false}, context)
            .value();
    ModbusPeer peer(ModbusPeer::Wire::Tcp, 1);
    const auto bank = drivers::openRelayBank(parsed(peer.options(0)), "relays", {false}, context).value();
    ASSERT_TRUE(comesTrue(clock, [&] { return runs(*bank); })) << bank->status().detail;
    for (int time = 0; time < 200; ++time) ASSERT_TRUE(bank->write({time % 2 == 0}));
    EXPECT_TRUE(comesTrue(clock, [&] { return dead->status().detail.find("nothing answers at") != std::string::npos; }))
        << dead->status().detail;
    EXPECT_EQ(dead->status().state, DeviceState::Absent);
}

}  // namespace
}  // namespace fantascope
