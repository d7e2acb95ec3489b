#include "drivers/modbus/input_bank.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::drivers {
namespace {

// When this many changes wait, nobody polls. Later changes are noticed once somebody does.
constexpr std::size_t kMaxWaiting = 1024;

}  // namespace

Result<Opening<InputBank>> ModbusInputBank::readTcp(const ConfigNode& options, const std::string& name, std::size_t size) {
    return fromConfig("modbus_tcp", {ModbusTcp()}, 50, options, name, size);
}

Result<Opening<InputBank>> ModbusInputBank::readRtu(const ConfigNode& options, const std::string& name, std::size_t size) {
    return fromConfig("modbus_rtu", {ModbusRtu()}, 20, options, name, size);
}

Result<Opening<InputBank>> ModbusInputBank::fromConfig(const char* driver, ModbusLineOptions line, double rate,
                                                       const ConfigNode& node, const std::string& name, std::size_t size) {
    Options options;
    options.line = std::move(line);
    options.rate = rate;
    ContactOptions contact;
    std::vector<std::size_t> normallyClosed;
    std::string named;
    ConfigFields fields(node);
    fields.text("driver", named);
    declareLine(fields, options.line);
    declareUnit(fields, options.line, options.place);
    fields.optional().read("kind", options.place.table, [](const ConfigNode& kind) -> Result<ModbusTable> {
        constexpr ModbusTable kTables[] = {ModbusTable::DiscreteInputs, ModbusTable::Coils, ModbusTable::InputRegisters,
                                           ModbusTable::HoldingRegisters};
        return kTables[TRY(kind.choice({"discrete_inputs", "coils", "input_registers", "holding_registers"}))];
    });
    fields.optional().integer("threshold", contact.threshold, 1, 65535);
    fields.optional().integer("hysteresis", contact.hysteresis, 0, 65535);
    fields.optional().number("rate", options.rate, 0.2, 200, "Hz");
    fields.optional().time("debounce", contact.debounce, 0, 1);
    fields.optional().list("normally_closed", normallyClosed, [size](const ConfigNode& item) -> Result<std::size_t> {
        return static_cast<std::size_t>(TRY(item.integer(0, static_cast<std::int64_t>(size) - 1)));
    });
    TRY(fields.finish());
    TRY(checkLine(node, options.line));
    TRY(checkPlace(node, options.place, size, false));
    const bool bits = options.place.table == ModbusTable::DiscreteInputs || options.place.table == ModbusTable::Coils;
    const bool graded = contact.threshold != ContactOptions().threshold || contact.hysteresis != 0;
    if (bits && graded) return node.error("'threshold' and 'hysteresis' are for registers");
    if (contact.hysteresis >= contact.threshold)
        return node.error(fmt::format("'hysteresis' must be below 'threshold', which is {}: otherwise no contact ever opens",
                                      contact.threshold));
    options.contacts.assign(size, contact);
    for (const std::size_t number : normallyClosed) options.contacts[number].normallyClosed = true;
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<InputBank>> {
        auto bus = TRY(ModbusBus::of(node, options.line, context.clock));
        return std::unique_ptr<InputBank>(new ModbusInputBank(name, driver, options, std::move(bus)));
    };
    const auto claim = [line = options.line] {
        const ModbusRtu* serial = std::get_if<ModbusRtu>(&line.wire);
        return serial == nullptr ? "" : claimOf(*serial);  // any number of programs may read a module on the network
    };
    return Opening<InputBank>{.open = open, .uses = {useOf(options.line)}, .claim = claim};
}

ModbusInputBank::ModbusInputBank(std::string name, const char* driver, Options options, std::shared_ptr<ModbusBus> bus)
    : options_(std::move(options)),
      clock_(bus->clock()),
      contacts_(options_.contacts.begin(), options_.contacts.end()),
      unit_(std::move(bus), std::move(name), driver, LossAction::Hold, [this](ModbusLine& line) { return turn(line); }) {}

std::optional<ContactChange> ModbusInputBank::poll() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    const ContactChange oldest = waiting_.front();
    waiting_.pop_front();
    return oldest;
}

ModbusUnit::TurnResult ModbusInputBank::turn(ModbusLine& line) {
    const bool running = unit_.isRunning();
    const Time began = clock_.now();
    std::vector<std::uint16_t> values(contacts_.size());
    if (auto failure = line.read(options_.place, values, began + (running ? 2 : 1) * options_.line.responseTimeout))
        return *failure;
    const Time now = clock_.now();
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < contacts_.size() && waiting_.size() < kMaxWaiting; ++i) {
        if (!running) contacts_[i].interrupt();
        if (const auto change = contacts_[i].take(values[i], now))
            waiting_.push_back({i, change->closed, now, change->witnessed});
    }
    return began + fromSeconds(1 / options_.rate);
}

}  // namespace fantascope::drivers
