#pragma once

#include "device/cue_controller.h"

#include "contract/rig.h"

#include <array>
#include <cstddef>
#include <string>

namespace fantascope::contract {

class CueControllerRig : public Rig<CueController> {
public:
    // A button goes down or up under the operator's finger. Pressing a button that is already down
    // repeats it like a held key.
    virtual void finger(int button, bool down) = 0;

    // Closes the port for good.
    virtual void close() = 0;
    // What the button's lamp or picture shows now. For a device with lamps on buttons 1 to 3.
    virtual ButtonLight::State shown(int button) = 0;
    // A button that the device does not have.
    virtual int absentButton() const = 0;
};

// A device without lamps.
class LamplessRig : public CueControllerRig {
public:
    ButtonLight::State shown(int) override { return ButtonLight::State::Off; }
};

// The controller's events once everything has arrived: "+3" for button 3 down, "-3" for up.
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

// Every promise of device/cue_controller.h except those of lampSuite().
inline Suite<CueControllerRig> cueControllerSuite() {
    const auto serves = [](CueControllerRig& rig) -> std::string {
        rig.finger(1, true);
        rig.finger(1, false);
        return givenDiffers(rig, "+1-1");
    };
    return joined<CueControllerRig>(
        lifeClauses<CueControllerRig>(serves),
        {
            {"an event comes once, with its button and the time of its arrival",
             [](CueControllerRig& rig) -> std::string {
                 rig.letTimePass();
                 const Time before = rig.clock().now();
                 rig.finger(2, true);
                 rig.letTimePass();
                 const auto event = rig.port().poll();
                 CONTRACT_REQUIRE(event && event->button == 2 && event->pressed, "the press of button 2 did not come");
                 CONTRACT_REQUIRE(before <= event->at && event->at <= rig.clock().now(), "at {} s, pressed at {} s",
                                  seconds(event->at), seconds(before));
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
            {"lights make no press and hold none back, whether there are lamps or not",
             [serves](CueControllerRig& rig) -> std::string {
                 for (int light = 0; light < 100; ++light) rig.port().light(1 + light % 3, {ButtonLight::State(light % 4), "GO"});
                 if (auto wrong = givenDiffers(rig, ""); !wrong.empty()) return wrong;
                 return serves(rig);
             }},
            {"a light of a lost device makes no press at its return",
             [serves](CueControllerRig& rig) -> std::string {
                 rig.lose();
                 rig.port().light(1, {ButtonLight::State::Ready, "GO"});
                 rig.giveBack();
                 if (auto wrong = givenDiffers(rig, ""); !wrong.empty()) return wrong;
                 return serves(rig);
             }},
            {"a light is not waited for",
             [](CueControllerRig& rig) -> std::string {
                 rig.unplug();  // nobody polls it
                 const Time before = rig.clock().now();
                 for (int light = 0; light < 4; ++light) rig.port().light(1, {ButtonLight::State(light), ""});
                 // A clock that stands still detects waiting; a real one shows nothing.
                 const bool stands = dynamic_cast<ManualClock*>(&rig.clock()) != nullptr;
                 CONTRACT_REQUIRE(!stands || rig.clock().now() == before, "it waited {} s", seconds(rig.clock().now() - before));
                 return "";
             }},
        });
}

inline std::string nameOf(ButtonLight::State state) {
    return std::array{"off", "ready", "active", "alarm"}[static_cast<std::size_t>(state)];
}

// "" if buttons 1 to 3 show these once everything has arrived.
inline std::string showsOther(CueControllerRig& rig, const std::array<ButtonLight::State, 3>& wanted) {
    rig.letTimePass();
    for (int button = 1; button <= 3; ++button) {
        const ButtonLight::State shown = rig.shown(button), told = wanted[static_cast<std::size_t>(button - 1)];
        CONTRACT_REQUIRE(shown == told, "button {} shows {}, not {}", button, nameOf(shown), nameOf(told));
    }
    return "";
}

// The further promises of device/cue_controller.h for a device with lamps.
inline Suite<CueControllerRig> lampSuite() {
    using enum ButtonLight::State;
    return {
        {"each button shows the newest light that it was told, and off before",
         [](CueControllerRig& rig) -> std::string {
             if (auto wrong = showsOther(rig, {Off, Off, Off}); !wrong.empty()) return wrong;
             rig.port().light(2, {Ready, "GO"});
             if (auto wrong = showsOther(rig, {Off, Ready, Off}); !wrong.empty()) return wrong;
             rig.port().light(2, {Ready, "GO"});
             rig.port().light(1, {Ready, "BACK"});
             rig.port().light(1, {Active, "BACK"});
             rig.port().light(3, {Alarm, "DARK"});
             if (auto wrong = showsOther(rig, {Active, Ready, Alarm}); !wrong.empty()) return wrong;
             rig.port().light(3, {Off, "DARK"});
             rig.port().light(1, {Alarm, ""});
             rig.port().light(1, {Off, ""});
             rig.port().light(1, {Ready, ""});
             return showsOther(rig, {Ready, Ready, Off});
         }},
        {"a light of a button that is not there is left out",
         [](CueControllerRig& rig) -> std::string {
             rig.port().light(2, {Ready, ""});
             for (const int button : {rig.absentButton(), 0, -1}) rig.port().light(button, {Alarm, ""});
             if (auto wrong = showsOther(rig, {Off, Ready, Off}); !wrong.empty()) return wrong;
             rig.port().light(3, {Active, ""});
             return showsOther(rig, {Off, Ready, Active});
         }},
        {"a device shows again what it was told before it was lost, and what it was told meanwhile",
         [](CueControllerRig& rig) -> std::string {
             rig.port().light(1, {Ready, "GO"});
             rig.port().light(2, {Active, ""});
             if (auto wrong = showsOther(rig, {Ready, Active, Off}); !wrong.empty()) return wrong;
             rig.lose();
             rig.port().light(2, {Off, ""});
             rig.port().light(3, {Alarm, ""});
             rig.giveBack();
             return showsOther(rig, {Ready, Off, Alarm});
         }},
        {"a device that is missing at the start shows what it was told before it came",
         [](CueControllerRig& rig) -> std::string {
             rig.unplug();
             rig.reopen();
             rig.letTimePass();
             rig.port().light(2, {Ready, "GO"});
             rig.giveBack();
             return showsOther(rig, {Off, Ready, Off});
         }},
        {"at the end all is off",
         [](CueControllerRig& rig) -> std::string {
             rig.port().light(1, {Ready, "GO"});
             rig.port().light(3, {Alarm, ""});
             if (auto wrong = showsOther(rig, {Ready, Off, Alarm}); !wrong.empty()) return wrong;
             rig.close();
             for (const int button : {1, 2, 3})
                 CONTRACT_REQUIRE(rig.shown(button) == Off, "button {} shows {}", button, nameOf(rig.shown(button)));
             return "";
         }},
    };
}

}  // namespace fantascope::contract
