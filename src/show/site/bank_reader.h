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

// The banks of one kind, and which places in each are taken.
class Banks {
public:
    // The keys of the file's lists of them, and of what is in them.
    Banks(std::string_view key, std::string_view membersKey) : key_(key), membersKey_(membersKey) {}

    Result<Bank> read(const ConfigNode& node, std::set<std::string>& deviceNames) {
        Bank bank;
        ConfigFields fields(node);
        fields.read("name", bank.name, onceNamed(deviceNames, "device"));
        fields.read("device", bank.device, readDevice);
        banks_.push_back(bank);  // what is wrong with it is no fault of its relays or contacts
        nodes_.push_back(node);
        names_.push_back(bank.name);
        areAllKnown_ = areAllKnown_ && !bank.name.empty();
        TRY(fields.finish());
        return bank;
    }
    // Declares the keys that say where a relay or contact is. Who has one bank need not call it by
    // its name.
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
            if (!known) return 0;  // whether the place is free nobody can say
            bank = *known;
            return onceNumbered(taken_[bank], owner, 0, last)(node);
        });
        areAllPlaced_ = areAllPlaced_ && fields.right();
    }
    // Once all relays or contacts are read.
    void check(ConfigFields& fields) const {
        for (std::size_t bank = 0; bank < nodes_.size() && areAllKnown_ && areAllPlaced_; ++bank)
            if (!taken_.contains(bank))
                fields.check(nodes_[bank],
                             nodes_[bank].error(fmt::format("nothing is in the bank '{}'; say what under '{}', or take it away",
                                                            names_[bank], membersKey_)));
    }

    // ask(bank, how many places it has) of every bank whose device is named.
    template <class Ask>
    void each(Ask ask) const {
        for (std::size_t bank = 0; bank < banks_.size(); ++bank)
            if (const auto taken = taken_.find(bank); taken != taken_.end() && !banks_[bank].device.driver.empty())
                ask(banks_[bank], static_cast<std::size_t>(*taken->second.rbegin()) + 1);
    }

private:
    const std::string_view key_, membersKey_;
    std::vector<Bank> banks_;
    std::vector<ConfigNode> nodes_;
    std::vector<std::string> names_;  // empty where one could not be read
    bool areAllKnown_ = true;         // the names
    bool areAllPlaced_ = true;        // nothing is wrong with what is in the banks
    bool toldOfNone_ = false;
    std::map<std::size_t, std::set<int>> taken_;  // places in each
};

// One entry of a site's `relays`, or of its `contacts`. `names`: of those so far. Error: place,
// key, advice.
Result<Relay> readRelay(const ConfigNode& node, std::set<std::string>& names, Banks& banks);
Result<Contact> readContact(const ConfigNode& node, std::set<std::string>& names, Banks& banks);

}  // namespace fantascope::show
