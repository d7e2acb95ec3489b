#pragma once

#include "show/site/site_fields.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::show {

// The banks of one kind, and the places that are taken in each.
class Banks {
public:
    // `key`: of the file's list of these banks. `membersKey`: of the list of their relays or
    // contacts.
    Banks(std::string_view key, std::string_view membersKey) : key_(key), membersKey_(membersKey) {}

    Result<Bank> read(const ConfigNode& node, std::set<std::string>& deviceNames) {
        Bank bank;
        ConfigFields fields(node);
        fields.read("name", bank.name, onceNamed(deviceNames, "device"));
        fields.read("device", bank.device, readDevice);
        banks_.push_back(bank);  // even a faulty one: its relays or contacts are no further faults
        nodes_.push_back(node);
        names_.push_back(bank.name);
        areAllKnown_ = areAllKnown_ && !bank.name.empty();
        TRY(fields.finish());
        return bank;
    }
    // Declares the keys that say where a relay or contact is. A site with one bank of the kind may
    // omit `bank`.
    void declarePlace(ConfigFields& fields, std::size_t& bank, std::string_view placeKey, int& place, std::string_view owner,
                      int last) {
        std::optional<std::size_t> known;
        if (names_.size() == 1) known = 0;
        if (names_.size() <= 1) fields.optional();
        fields.read("bank", known, [this](const ConfigNode& node) -> Result<std::optional<std::size_t>> {
            auto chosen = node.choice(names_);
            if (!chosen && !areAllKnown_) return std::optional<std::size_t>();
            return std::optional(TRY(std::move(chosen)));
        });
        fields.read(placeKey, place, [&](const ConfigNode& node) -> Result<int> {
            if (names_.empty() && !std::exchange(toldOfNone_, true))
                return node.error(fmt::format("there is no bank; add it under '{}'", key_));
            if (!known) return 0;  // without the bank, the place cannot be checked
            bank = *known;
            return onceNumbered(taken_[bank], owner, 0, last)(node);
        });
        areAllPlaced_ = areAllPlaced_ && fields.right();
    }
    // Refuses empty banks. Call it once all relays or contacts are read.
    void check(ConfigFields& fields) const {
        for (std::size_t bank = 0; bank < nodes_.size() && areAllKnown_ && areAllPlaced_; ++bank)
            if (!taken_.contains(bank))
                fields.check(nodes_[bank],
                             nodes_[bank].error(fmt::format("the bank '{}' is empty; add to it under '{}', or remove it",
                                                            names_[bank], membersKey_)));
    }

    // Calls ask(bank, number of its places) for every bank that has some, and whose driver is
    // named.
    template <class Ask>
    void each(Ask ask) const {
        for (std::size_t bank = 0; bank < banks_.size(); ++bank)
            if (const auto taken = taken_.find(bank);
                taken != taken_.end() && !taken->second.empty() && !banks_[bank].device.driver.empty())
                ask(banks_[bank], static_cast<std::size_t>(*taken->second.rbegin()) + 1);
    }

private:
    const std::string_view key_, membersKey_;
    std::vector<Bank> banks_;
    std::vector<ConfigNode> nodes_;
    std::vector<std::string> names_;  // "" for a name that could not be read
    bool areAllKnown_ = true;         // every name could be read
    bool areAllPlaced_ = true;        // no relay or contact so far has a fault
    bool toldOfNone_ = false;
    std::map<std::size_t, std::set<int>> taken_;  // the places that are taken, by bank
};

// Reads one entry of a site's `relays`, or of its `contacts`. `names`: of the entries so far.
// Error: place, key, advice.
Result<Relay> readRelay(const ConfigNode& node, std::set<std::string>& names, Banks& banks);
Result<Contact> readContact(const ConfigNode& node, std::set<std::string>& names, Banks& banks);

}  // namespace fantascope::show
