#include "drivers/modbus/relay_bank.h"

#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::drivers {
namespace {

std::string shown(const std::vector<std::uint16_t>& values) { return fmt::format("{}", fmt::join(values, " ")); }

}  // namespace

Result<Opening<RelayBank>> ModbusRelayBank::readTcp(const ConfigNode& options, const std::string& name,
                                                    const std::vector<bool>& safeStates) {
    return fromConfig("modbus_tcp", {ModbusTcp()}, options, name, safeStates);
}

Result<Opening<RelayBank>> ModbusRelayBank::readRtu(const ConfigNode& options, const std::string& name,
                                                    const std::vector<bool>& safeStates) {
    return fromConfig("modbus_rtu", {ModbusRtu()}, options, name, safeStates);
}

Result<ModbusRelayBank::Watchdog> ModbusRelayBank::watchdogOf(const ConfigNode& node) {
    Watchdog watchdog;
    ConfigFields fields(node);
    fields.integer("register", watchdog.address, 0, 65535);
    const auto value = [](const ConfigNode& item) -> Result<std::uint16_t> {
        return static_cast<std::uint16_t>(TRY(item.integer(0, 65535)));
    };
    fields.optional().list("values", watchdog.values, value, 1);
    fields.time("period", watchdog.period, 0.02, 60);
    TRY(fields.finish());
    return watchdog;
}

Result<Opening<RelayBank>> ModbusRelayBank::fromConfig(const char* driver, ModbusLineOptions line, const ConfigNode& node,
                                                       const std::string& name, const std::vector<bool>& safeStates) {
    Options options;
    options.line = std::move(line);
    std::string named;
    ConfigFields fields(node);
    fields.text("driver", named);
    declareLine(fields, options.line);
    declareUnit(fields, options.line, options.place);
    fields.optional().read("kind", options.place.table, [](const ConfigNode& kind) -> Result<ModbusTable> {
        return TRY(kind.choice({"coils", "holding_registers"})) == 0 ? ModbusTable::Coils : ModbusTable::HoldingRegisters;
    });
    fields.optional().integer("on", options.on, 0, 65535);
    fields.optional().integer("off", options.off, 0, 65535);
    fields.optional().boolean("one_by_one", options.oneByOne);
    fields.optional().time("timeout", options.timeout, 0.1, 30);
    fields.optional().number("rate", options.rate, 0.2, 50, "Hz");
    fields.optional().read("watchdog", options.watchdog, [](const ConfigNode& watchdog) -> Result<std::optional<Watchdog>> {
        return std::optional<Watchdog>(TRY(watchdogOf(watchdog)));
    });
    TRY(fields.finish());
    TRY(checkLine(node, options.line));
    TRY(checkPlace(node, options.place, safeStates.size(), true));
    const bool values = options.on != Options().on || options.off != Options().off;
    if (options.place.table == ModbusTable::Coils && values)
        return node.error("'on' and 'off' are for 'kind: holding_registers'");
    if (options.on == options.off) return node.error("'on' and 'off' are the same value");
    // It may wait for another device's request, then it writes and reads back.
    if (options.timeout < 3 * options.line.responseTimeout)
        return node.error(fmt::format("'timeout' is {:g} s, three times 'response_timeout' is needed: {:g} s",
                                      seconds(options.timeout), seconds(3 * options.line.responseTimeout)));
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<RelayBank>> {
        auto bus = TRY(ModbusBus::of(node, options.line, context.clock));
        return std::unique_ptr<RelayBank>(new ModbusRelayBank(name, driver, options, std::move(bus), safeStates));
    };
    const auto claim = [line = options.line, unit = options.place.unit] {
        if (const ModbusRtu* serial = std::get_if<ModbusRtu>(&line.wire)) return claimOf(*serial);
        return fmt::format("Modbus module {} unit {}", nameOf(line), unit);  // because two shows may share a gateway
    };
    return Opening<RelayBank>{.open = open, .uses = {useOf(options.line)}, .claim = claim};
}

ModbusRelayBank::ModbusRelayBank(std::string name, const char* driver, Options options, std::shared_ptr<ModbusBus> bus,
                                 const std::vector<bool>& safeStates)
    : options_(std::move(options)),
      safeStates_(safeStates),
      clock_(bus->clock()),
      unit_(std::move(bus), std::move(name), driver, options_.watchdog ? LossAction::SafeState : LossAction::Hold,
            [this](ModbusLine& line) { return turn(line); }) {}

ModbusRelayBank::~ModbusRelayBank() {
    if (used_) (void)write(safeStates_);  // a lost bank relies on its watchdog and the run's relay guard
}

Result<void> ModbusRelayBank::write(const std::vector<bool>& states) {
    FANTASCOPE_CHECK(states.size() == size(), "one state for each relay");
    used_ = true;
    const Time deadline = clock_.now() + options_.timeout;
    std::vector<std::uint16_t> wanted, is(size());
    for (const bool on : states) wanted.push_back(on ? options_.on : options_.off);
    TRY(unit_.run(
        [&](ModbusLine& line) -> ModbusOutcome {
            confirmed_.clear();
            // First, because a module whose watchdog has tripped may refuse everything else.
            if (auto failure = feed(line, deadline)) return failure;
            if (auto failure = set(line, wanted, deadline)) return failure;
            if (auto failure = line.read(options_.place, is, deadline)) return failure;
            if (is == wanted) confirmed_ = wanted;
            return std::nullopt;
        },
        deadline));
    if (is == wanted) return {};
    return Error(
        fmt::format("{}: {} were set to {} and say {}", unit_.name(), nameOf(options_.place, size()), shown(wanted), shown(is)));
}

Result<std::vector<bool>> ModbusRelayBank::read() {
    const Time deadline = clock_.now() + options_.timeout;
    std::vector<std::uint16_t> values(size());
    TRY(unit_.run([&](ModbusLine& line) { return line.read(options_.place, values, deadline); }, deadline));
    std::vector<bool> states;
    for (const std::uint16_t value : values) {
        if (value != options_.on && value != options_.off)
            return Error(fmt::format("{}: {} say {}, neither on ({}) nor off ({})", unit_.name(), nameOf(options_.place, size()),
                                     shown(values), options_.on, options_.off));
        states.push_back(value == options_.on);
    }
    return states;
}

ModbusUnit::TurnResult ModbusRelayBank::turn(ModbusLine& line) {
    const bool running = unit_.isRunning();
    const Time now = clock_.now(), deadline = now + (running ? 2 : 1) * options_.line.responseTimeout;
    if (!running) {
        confirmed_.clear();
        nextCheck_ = now;
    }
    if (!confirmed_.empty() && options_.watchdog && now >= nextFeed_)
        if (auto failure = feed(line, deadline)) return *failure;
    if (now >= nextCheck_) {
        std::vector<std::uint16_t> values(size());
        if (auto failure = line.read(options_.place, values, deadline)) return *failure;
        nextCheck_ = now + fromSeconds(1 / options_.rate);
        // Since the last check the module lost power, its watchdog tripped, or somebody switched it
        // by hand.
        if (!confirmed_.empty() && values != confirmed_) {
            confirmed_.clear();
            return ModbusUnit::Returned{nextCheck_};
        }
    }
    return !confirmed_.empty() && options_.watchdog ? std::min(nextCheck_, nextFeed_) : nextCheck_;
}

ModbusOutcome ModbusRelayBank::set(ModbusLine& line, const std::vector<std::uint16_t>& values, Time deadline) {
    if (!options_.oneByOne) return line.write(options_.place, values, deadline);
    ModbusPlace relay = options_.place;
    for (const std::uint16_t value : values) {
        if (auto failure = line.write(relay, {&value, 1}, deadline)) return failure;
        ++relay.first;
    }
    return std::nullopt;
}

ModbusOutcome ModbusRelayBank::feed(ModbusLine& line, Time deadline) {
    if (!options_.watchdog) return std::nullopt;
    const Watchdog& watchdog = *options_.watchdog;
    const Time now = clock_.now();
    const ModbusPlace place{options_.place.unit, ModbusTable::HoldingRegisters, watchdog.address};
    if (auto failure = line.write(place, {&watchdog.values[feeds_ % watchdog.values.size()], 1}, deadline)) return failure;
    ++feeds_;
    nextFeed_ = now + watchdog.period;
    return std::nullopt;
}

}  // namespace fantascope::drivers
