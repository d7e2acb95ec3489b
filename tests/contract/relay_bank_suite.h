#pragma once

#include "device/relay_bank.h"

#include "contract/rig.h"

#include <string>
#include <vector>

namespace fantascope::contract {

// A bank of three relays whose safe states are kSafe.
class RelayBankRig : public Rig<RelayBank> {
public:
    inline static const std::vector<bool> kSafe = {true, false, true};

    // What the relays really are.
    virtual std::vector<bool> relays() = 0;
    // A person switches them at the module itself.
    virtual void handSwitches(const std::vector<bool>& states) = 0;
    // Destroys the port. Only reopen() may follow.
    virtual void close() = 0;
};

inline std::string shown(const std::vector<bool>& states) {
    std::string text;
    for (const bool on : states) text += on ? '1' : '0';
    return text;
}

inline std::string relaysDiffer(RelayBankRig& rig, const std::vector<bool>& wanted) {
    CONTRACT_REQUIRE(rig.relays() == wanted, "the relays are {}, not {}", shown(rig.relays()), shown(wanted));
    return "";
}

// Every promise of device/relay_bank.h.
inline Suite<RelayBankRig> relayBankSuite() {
    static const std::vector<bool> kUnsafe = {false, true, false};
    const auto serves = [](RelayBankRig& rig) -> std::string {
        for (const auto& states : {kUnsafe, std::vector<bool>{true, true, false}}) {
            CONTRACT_SUCCEEDS(rig.port().write(states));
            if (auto wrong = relaysDiffer(rig, states); !wrong.empty()) return wrong;
        }
        return "";
    };
    return joined<RelayBankRig>(
        lifeClauses<RelayBankRig>(serves),
        {
            {"the relays are as written when write() returns", serves},
            {"the size is constant",
             [](RelayBankRig& rig) -> std::string {
                 CONTRACT_REQUIRE(rig.port().size() == 3, "{} relays, three were declared", rig.port().size());
                 rig.lose();
                 CONTRACT_REQUIRE(rig.port().size() == 3, "{} relays while lost", rig.port().size());
                 return "";
             }},
            {"read() tells what the relays are now, whoever switched them",
             [](RelayBankRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().write(kUnsafe));
                 for (const std::vector<bool>& states : {std::vector<bool>{false, false, true}, kUnsafe}) {
                     rig.handSwitches(states);
                     const auto read = rig.port().read();
                     CONTRACT_SUCCEEDS(read);
                     CONTRACT_REQUIRE(*read == states, "it reads {}, they are {}", shown(*read), shown(states));
                 }
                 return "";
             }},
            {"write() and read() on a lost bank are errors that say why",
             [](RelayBankRig& rig) -> std::string {
                 rig.lose();
                 const auto written = rig.port().write(kUnsafe);
                 CONTRACT_REQUIRE(!written && !written.error().message().empty(), "write() claims success");
                 const auto read = rig.port().read();
                 CONTRACT_REQUIRE(!read && !read.error().message().empty(), "read() claims success");
                 return "";
             }},
            {"a lost bank takes its safe states, and says that it does",
             [](RelayBankRig& rig) -> std::string {
                 CONTRACT_REQUIRE(rig.port().status().onLoss == LossAction::SafeState, "it declares another loss action");
                 CONTRACT_SUCCEEDS(rig.port().write(kUnsafe));
                 rig.lose();
                 return relaysDiffer(rig, RelayBankRig::kSafe);
             }},
            {"after its return the bank stays safe until it is written again",
             [](RelayBankRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().write(kUnsafe));
                 rig.lose();
                 (void)rig.port().write(kUnsafe);
                 rig.giveBack();
                 (void)rig.port().read();
                 return relaysDiffer(rig, RelayBankRig::kSafe);
             }},
            {"relays that are found other than written are a loss, counted once, and stay so until they are written",
             [](RelayBankRig& rig) -> std::string {
                 const std::vector<bool> byHand = {true, true, false};
                 for (int losses = 0; losses < 2; ++losses) {
                     CONTRACT_SUCCEEDS(rig.port().write(kUnsafe));
                     rig.letTimePass();
                     CONTRACT_REQUIRE(rig.port().status().losses == losses, "{} losses after {}", rig.port().status().losses,
                                      losses);
                     rig.handSwitches(byHand);
                     rig.letTimePass();
                     CONTRACT_REQUIRE(rig.port().status().losses == losses + 1, "{} losses after {} and a hand",
                                      rig.port().status().losses, losses);
                     if (auto wrong = misreports(rig.port(), true); !wrong.empty()) return wrong;
                     rig.handSwitches(RelayBankRig::kSafe);  // nobody has written since
                     rig.letTimePass();
                     CONTRACT_REQUIRE(rig.port().status().losses == losses + 1, "it is counted again: {} losses",
                                      rig.port().status().losses);
                     if (auto wrong = relaysDiffer(rig, RelayBankRig::kSafe); !wrong.empty()) return wrong;
                 }
                 return "";
             }},
            {"closing leaves the relays safe",
             [](RelayBankRig& rig) -> std::string {
                 CONTRACT_SUCCEEDS(rig.port().write(kUnsafe));
                 rig.close();
                 return relaysDiffer(rig, RelayBankRig::kSafe);
             }},
            {"closing a bank that was only looked at switches nothing",
             [](RelayBankRig& rig) -> std::string {
                 rig.handSwitches(kUnsafe);
                 (void)rig.port().read();
                 rig.close();
                 return relaysDiffer(rig, kUnsafe);
             }},
        });
}

}  // namespace fantascope::contract
