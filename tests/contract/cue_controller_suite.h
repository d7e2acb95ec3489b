#pragma once

#include "device/cue_controller.h"

#include "contract/rig.h"

#include <string>

namespace fantascope::contract {

class CueControllerRig : public Rig<CueController> {
public:
    // A button goes down or up under the operator's finger; a button that is down already repeats itself as a held key does.
    virtual void finger(int button, bool down) = 0;
};

// What the controller gives once all has arrived: "+3" for button 3 down, "-3" for up.
inline std::string given(CueControllerRig& rig) {
    rig.letTimePass();
    std::string events;
    for (const ButtonEvent& event : drained([&] { return rig.port().poll(); }))
        events += fmt::format("{}{}", event.pressed ? '+' : '-', event.button);
    return events;
}

inline std::string givenDiffers(CueControllerRig& rig, const std::string& wanted) {
    const std::string events = given(rig);
    CONTRACT_REQUIRE(events == wanted, "it gives '{}', not '{}'", events, wanted);
    return "";
}

// Every promise of device/cue_controller.h.
inline Suite<CueControllerRig> cueControllerSuite() {
    const auto serves = [](CueControllerRig& rig) -> std::string {
        rig.finger(1, true);
        rig.finger(1, false);
        return givenDiffers(rig, "+1-1");
    };
    return joined<CueControllerRig>(lifeClauses<CueControllerRig>(serves),
                                    {
                                        {"an event comes once, with its button and the time of its arrival",
                                         [](CueControllerRig& rig) -> std::string {
                                             rig.letTimePass();
                                             const Time before = rig.clock().now();
                                             rig.finger(2, true);
                                             rig.letTimePass();
                                             const auto event = rig.port().poll();
                                             CONTRACT_REQUIRE(event && event->button == 2 && event->pressed,
                                                              "the press of button 2 did not come");
                                             CONTRACT_REQUIRE(before <= event->at && event->at <= rig.clock().now(),
                                                              "at {} s, pressed at {} s", seconds(event->at), seconds(before));
                                             return givenDiffers(rig, "");
                                         }},
                                        {"events of all buttons come oldest first",
                                         [](CueControllerRig& rig) -> std::string {
                                             for (const int button : {3, 1, 2}) rig.finger(button, true);
                                             for (const int button : {1, 3, 2}) rig.finger(button, false);
                                             return givenDiffers(rig, "+3+1+2-1-3-2");
                                         }},
                                        {"a held button's repeats are left out",
                                         [](CueControllerRig& rig) -> std::string {
                                             for (int repeat = 0; repeat < 5; ++repeat) rig.finger(1, true);
                                             rig.finger(1, false);
                                             return givenDiffers(rig, "+1-1");
                                         }},
                                        {"a button that was down at the loss is reported up, once",
                                         [](CueControllerRig& rig) -> std::string {
                                             rig.finger(1, true);
                                             rig.finger(2, true);
                                             rig.finger(2, false);
                                             if (auto wrong = givenDiffers(rig, "+1+2-2"); !wrong.empty()) return wrong;
                                             rig.lose();
                                             if (auto wrong = givenDiffers(rig, "-1"); !wrong.empty()) return wrong;
                                             rig.giveBack();
                                             rig.finger(1, false);
                                             return givenDiffers(rig, "");
                                         }},
                                        {"a loss that was over before anybody looked still reports the button up",
                                         [serves](CueControllerRig& rig) -> std::string {
                                             rig.finger(1, true);
                                             if (auto wrong = givenDiffers(rig, "+1"); !wrong.empty()) return wrong;
                                             rig.lose();
                                             rig.finger(1, false);
                                             rig.giveBack();
                                             if (auto wrong = givenDiffers(rig, "-1"); !wrong.empty()) return wrong;
                                             return serves(rig);
                                         }},
                                        {"unplugging and plugging in make no press, and what was pressed meanwhile stays lost",
                                         [](CueControllerRig& rig) -> std::string {
                                             rig.finger(1, true);  // nobody polls before the loss
                                             rig.lose();
                                             rig.finger(1, false);
                                             rig.finger(2, true);
                                             rig.giveBack();
                                             if (auto wrong = givenDiffers(rig, ""); !wrong.empty()) return wrong;
                                             rig.finger(2, false);
                                             return givenDiffers(rig, "");
                                         }},
                                    });
}

}  // namespace fantascope::contract
