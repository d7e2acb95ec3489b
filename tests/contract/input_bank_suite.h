#pragma once

#include "device/input_bank.h"

#include "contract/rig.h"

#include <string>
#include <vector>

namespace fantascope::contract {

// A bank of three contacts, all open at first.
class InputBankRig : public Rig<InputBank> {
public:
    virtual void setContact(std::size_t contact, bool closed) = 0;
};

// The bank's changes once it had time to notice: "+1" for contact 1 closed, "-1" for open.
inline std::string reported(InputBankRig& rig) {
    rig.letTimePass();
    std::string changes;
    for (const ContactChange& change : drained([&] { return rig.port().poll(); }))
        changes += fmt::format("{}{}", change.closed ? '+' : '-', change.contact);
    return changes;
}

inline std::string reportedDiffers(InputBankRig& rig, const std::string& wanted) {
    const std::string changes = reported(rig);
    CONTRACT_REQUIRE(changes == wanted, "it reports '{}', not '{}'", changes, wanted);
    return "";
}

// Every promise of device/input_bank.h.
inline Suite<InputBankRig> inputBankSuite() {
    const auto serves = [](InputBankRig& rig) -> std::string {
        for (const bool closed : {true, false}) {
            rig.setContact(1, closed);
            if (auto wrong = reportedDiffers(rig, closed ? "+1" : "-1"); !wrong.empty()) return wrong;
        }
        return "";
    };
    return joined<InputBankRig>(
        lifeClauses<InputBankRig>(serves),
        {
            {"a change is reported once, with its contact and the time when it was noticed",
             [](InputBankRig& rig) -> std::string {
                 const Time before = rig.clock().now();
                 rig.setContact(2, true);
                 rig.letTimePass();
                 const auto change = rig.port().poll();
                 CONTRACT_REQUIRE(change && change->contact == 2 && change->closed, "contact 2 was closed and is not reported");
                 CONTRACT_REQUIRE(before <= change->at && change->at <= rig.clock().now(), "noticed at {} s, closed at {} s",
                                  seconds(change->at), seconds(before));
                 return reportedDiffers(rig, "");
             }},
            {"the size is constant",
             [](InputBankRig& rig) -> std::string {
                 CONTRACT_REQUIRE(rig.port().size() == 3, "{} contacts, three were declared", rig.port().size());
                 rig.lose();
                 CONTRACT_REQUIRE(rig.port().size() == 3, "{} contacts while lost", rig.port().size());
                 return "";
             }},
            {"changes come oldest first",
             [](InputBankRig& rig) -> std::string {
                 Time last{};
                 for (const std::size_t contact : {2, 0, 1}) {
                     rig.setContact(contact, true);
                     rig.letTimePass();
                     const auto change = rig.port().poll();
                     CONTRACT_REQUIRE(change && change->contact == contact, "contact {} is not reported", contact);
                     CONTRACT_REQUIRE(change->at >= last, "its time goes back");
                     last = change->at;
                 }
                 return "";
             }},
            {"a contact that is closed at the start is the first change",
             [](InputBankRig& rig) -> std::string {
                 rig.setContact(0, true);
                 rig.reopen();
                 return reportedDiffers(rig, "+0");
             }},
            {"changes of one contact alternate, however fast it moves",
             [](InputBankRig& rig) -> std::string {
                 bool last = false;
                 for (int move = 0; move < 50; ++move) {
                     rig.setContact(1, move % 3 != 0);
                     if (move % 2 == 0) rig.letTimePass();
                     while (const auto change = rig.port().poll()) {
                         CONTRACT_REQUIRE(change->closed != last, "'{}' comes twice", last ? "closed" : "open");
                         last = change->closed;
                     }
                 }
                 return "";
             }},
            {"a restless contact does not hide another",
             [](InputBankRig& rig) -> std::string {
                 rig.setContact(2, true);
                 for (int move = 0; move < 20; ++move) {
                     rig.setContact(0, move % 2 == 0);
                     rig.letTimePass();
                     const auto change = rig.port().poll();
                     if (change && change->contact == 2) return "";
                 }
                 return "contact 2 is not reported while contact 0 moves";
             }},
            {"what was found so at the first look was not witnessed, a movement afterwards was",
             [](InputBankRig& rig) -> std::string {
                 const auto witnessed = [&](std::size_t contact, bool closed) -> std::string {
                     rig.letTimePass();
                     const auto change = rig.port().poll();
                     CONTRACT_REQUIRE(change && change->contact == contact && change->closed == closed,
                                      "the movement of contact {} is not reported", contact);
                     return change->witnessed ? "witnessed" : "found";
                 };
                 const auto require = [](const std::string& seen, const std::string& wanted) {
                     return seen == wanted ? "" : seen + ", not " + wanted;
                 };
                 rig.setContact(0, true);
                 rig.reopen();
                 if (auto wrong = require(witnessed(0, true), "found"); !wrong.empty()) return "at the start: " + wrong;
                 rig.setContact(0, false);
                 if (auto wrong = require(witnessed(0, false), "witnessed"); !wrong.empty()) return "then: " + wrong;
                 rig.lose();
                 rig.setContact(1, true);
                 rig.giveBack();
                 if (auto wrong = require(witnessed(1, true), "found"); !wrong.empty()) return "after a loss: " + wrong;
                 rig.setContact(1, false);
                 if (auto wrong = require(witnessed(1, false), "witnessed"); !wrong.empty()) return "at last: " + wrong;
                 return "";
             }},
            {"a loss is no change",
             [](InputBankRig& rig) -> std::string {
                 rig.setContact(1, true);
                 if (auto wrong = reportedDiffers(rig, "+1"); !wrong.empty()) return wrong;
                 rig.lose();
                 if (auto wrong = reportedDiffers(rig, ""); !wrong.empty()) return wrong;
                 rig.giveBack();
                 return reportedDiffers(rig, "");
             }},
            {"after the return only what differs from the last report is reported",
             [](InputBankRig& rig) -> std::string {
                 rig.setContact(0, true);
                 rig.setContact(1, true);
                 rig.letTimePass();
                 if (const auto changes = reported(rig); changes.size() != 4)
                     return "it reports '" + changes + "', not two changes";
                 rig.lose();
                 for (const bool closed : {true, false, true}) rig.setContact(2, closed);
                 rig.setContact(2, false);
                 rig.setContact(0, false);
                 rig.giveBack();
                 return reportedDiffers(rig, "-0");
             }},
        });
}

}  // namespace fantascope::contract
