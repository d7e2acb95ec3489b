#include "show/play/contact_inputs.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

// A gate that starts the next cue, an emergency button, and in another bank a door that takes a cue
// back.
Site site() {
    Site site;
    site.contacts = {{"gate", 0, 4, ContactAction::Go, {}},
                     {"emergency", 0, 1, ContactAction::Dark, ContactAction::Light},
                     {"door", 1, 4, ContactAction::Back, {}},
                     {"stop", 1, 5, ContactAction::Panic, ContactAction::Restore}};
    return site;
}

std::optional<Input::Kind> asked(std::size_t contact, bool closed, bool witnessed = true, std::size_t bank = 0) {
    const auto input = inputFor(site(), bank, contact, closed, witnessed, 5s);
    if (!input) return std::nullopt;
    EXPECT_EQ(input->at, 5s);
    return input->kind;
}

TEST(ContactInputs, are_what_the_site_says_of_each_movement) {
    EXPECT_EQ(asked(4, true), Input::Kind::Go);
    EXPECT_EQ(asked(4, false), std::nullopt);
    EXPECT_EQ(asked(1, true), Input::Kind::Dark);
    EXPECT_EQ(asked(1, false), Input::Kind::Light);
    EXPECT_EQ(asked(0, true), std::nullopt) << "nobody declared it";
    EXPECT_EQ(asked(4, true, true, 1), Input::Kind::Back) << "the same place in another bank";
    EXPECT_EQ(asked(1, true, true, 1), std::nullopt);
}

// Example failure: the gate stood closed while the program started, and the show begins in the
// afternoon.
TEST(ContactInputs, a_cue_needs_a_movement_that_was_seen) { EXPECT_EQ(asked(4, true, false), std::nullopt); }

// Example failure: the emergency button was pressed while its module was away, and the lamps stay
// on.
TEST(ContactInputs, the_dark_holds_however_it_came_about) {
    EXPECT_EQ(asked(1, true, false), Input::Kind::Dark);
    EXPECT_EQ(asked(1, false, false), Input::Kind::Light);
    EXPECT_EQ(asked(5, true, false, 1), Input::Kind::Panic);
}

// Example failure: a module that comes back brings the light back, too, without anybody there.
TEST(ContactInputs, a_show_is_restored_only_by_a_movement_that_was_seen) {
    EXPECT_EQ(asked(5, false, true, 1), Input::Kind::Restore);
    EXPECT_EQ(asked(5, false, false, 1), std::nullopt);
}

}  // namespace
}  // namespace fantascope::show
