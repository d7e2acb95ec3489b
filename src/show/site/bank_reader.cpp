#include "show/site/bank_reader.h"

namespace fantascope::show {
namespace {

constexpr int kLastCoil = 1967;   // one Modbus request writes at most 1968 coils (Modbus 1.1b3, section 6.11)
constexpr int kLastInput = 1999;  // one Modbus request reads at most 2000 inputs (section 6.2)

}  // namespace

Result<Relay> readRelay(const ConfigNode& node, std::set<std::string>& names, Banks& banks) {
    Relay relay;
    ConfigFields fields(node);
    fields.read("name", relay.name, onceNamed(names, "relay"));
    banks.declarePlace(fields, relay.bank, "coil", relay.coil, "relay of its bank", kLastCoil);
    fields.choice("safe", relay.safe, {"off", "on"});
    TRY(fields.finish());
    return relay;
}

Result<Contact> readContact(const ConfigNode& node, std::set<std::string>& names, Banks& banks) {
    const auto readAction = [](const ConfigNode& value) -> Result<std::optional<ContactAction>> {
        return std::optional(static_cast<ContactAction>(
            TRY(value.choice({"go", "back", "blackout", "dark", "light", "pause", "freeze", "panic", "restore"}))));
    };
    Contact contact;
    ConfigFields fields(node);
    fields.read("name", contact.name, onceNamed(names, "contact"));
    banks.declarePlace(fields, contact.bank, "input", contact.input, "contact of its bank", kLastInput);
    fields.optional().read("closes", contact.closes, readAction);
    fields.optional().read("opens", contact.opens, readAction);
    fields.optional().text("list", contact.list);
    TRY(fields.finish());
    if (!contact.closes && !contact.opens)
        return node.error(fmt::format("'{}' asks for nothing; say what it does when it 'closes' or 'opens'", contact.name));
    const auto goes = [](const std::optional<ContactAction>& action) {
        return action == ContactAction::Go || action == ContactAction::Back;
    };
    if (!contact.list.empty() && !goes(contact.closes) && !goes(contact.opens))
        return node.error(fmt::format("'{}' gives neither 'go' nor 'back', so it needs no 'list'", contact.name));
    return contact;
}

}  // namespace fantascope::show
