// What a crash leaves of a night's journal is read as far as it is whole.

#include "show/play/journal.h"

#include "core/file.h"
#include "core/random.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<journal::Line> someLines() {
    Input corrected{.at = 4s, .kind = Input::Kind::Correct, .source = Input::Source::Camera, .which = 1};
    corrected.shift[2] = {1.5f, -0.25f};
    Input dimmed{.at = 5s, .kind = Input::Kind::Master, .source = Input::Source::Terminal};
    dimmed.level = 0.7f;
    journal::State held{.at = 6s, .controls = {}, .corrects = false, .cue = "Storm at  night"};
    held.controls.cue = 3;
    held.controls.loaded = 5;
    held.controls.panic = held.controls.frozen = true;
    held.controls.master = 0.7f;
    held.controls.sides = {{.cue = 2}, {.cue = -1, .loaded = 4}};
    held.controls.raised = {{0, 0.3f}, {12, 1}};
    held.controls.switched = {{1, true}, {3, false}};
    return {journal::Run{0s, 1'700'000'000s, false, 0xfedcba9876543210u, "/srv/a show/show.yaml"},
            Input{.at = 0s, .kind = Input::Kind::Jump, .cue = 2},
            corrected,
            dimmed,
            held,
            journal::State{},
            journal::Told{7s, "'left' (glfw) is missing: unplugged"},
            journal::Gap{8s},
            journal::Run{9s, 1'700'000'100s, true, 1, ""},
            journal::End{10s, "interrupted"}};
}
std::string textOf(const std::vector<journal::Line>& lines) {
    std::string text(kJournalHead);
    for (const journal::Line& line : lines) text += lineOf(line);
    return text;
}
std::vector<journal::Line> linesOf(const Journal& journal) {
    std::vector<journal::Line> lines;
    for (const Journal::Entry& entry : journal.entries) lines.push_back(entry.line);
    return lines;
}

TEST(Journal, is_read_as_it_was_written) {
    const ScratchFolder folder;
    const std::string text = textOf(someLines());
    const auto journal = readJournal(folder.file("journal", text));
    ASSERT_TRUE(journal) << journal.error().message();
    EXPECT_TRUE(linesOf(*journal) == someLines());
    EXPECT_EQ(journal->bytes, text.size());
    EXPECT_EQ(journal->damaged, 0u);
    EXPECT_FALSE(journal->isTorn);
    EXPECT_EQ(journal->newest(), 10s);
}

// Example failure: half a number is read as a number, and the show jumps to another time.
TEST(Journal, that_is_torn_anywhere_is_read_up_to_there) {
    const std::string text = textOf(someLines());
    for (std::size_t left = 0; left < text.size(); ++left) {
        const auto journal = journalOf(std::string_view(text).substr(0, left));
        ASSERT_TRUE(journal) << left << ": " << journal.error().message();
        EXPECT_EQ(journal->bytes == left, !journal->isTorn) << left;
        EXPECT_LE(journal->bytes, left);
        EXPECT_EQ(journal->damaged, 0u) << left;
        const auto lines = linesOf(*journal);
        const auto all = someLines();
        ASSERT_LE(lines.size(), all.size());
        EXPECT_TRUE(std::equal(lines.begin(), lines.end(), all.begin())) << left;
        EXPECT_EQ(text.substr(0, left).find('\n', journal->bytes), std::string::npos) << "a whole line was left out";
    }
}

// Example failure: a disk gives back another byte, and somebody else's cue is entered.
TEST(Journal, leaves_out_what_is_damaged_and_says_where) {
    const auto all = someLines();
    Rng rng(11);
    for (int i = 0; i < 20'000; ++i) {
        std::string text = textOf(all);
        const std::size_t at = kJournalHead.size() + rng.below(text.size() - kJournalHead.size());
        const auto length = std::min<std::size_t>(1 + rng.below(40), text.size() - at);
        for (std::size_t byte = at; byte < at + length; ++byte) text[byte] = static_cast<char>(rng.below(256));
        const auto journal = journalOf(text);
        ASSERT_TRUE(journal) << journal.error().message();
        // Each entry is one that was written, in order, and a loss is marked where it is.
        std::size_t next = 0;
        for (const Journal::Entry& entry : journal->entries) {
            const std::size_t before = next;
            while (next < all.size() && !(all[next] == entry.line)) ++next;
            ASSERT_LT(next, all.size()) << "nobody wrote this: " << lineOf(entry.line);
            EXPECT_TRUE(entry.isAfterDamage || next == before);
            ++next;
        }
    }
}

TEST(Journal, is_read_though_its_first_line_is_damaged) {
    std::string text = textOf(someLines());
    text[3] ^= 1;
    const auto journal = journalOf(text);
    ASSERT_TRUE(journal) << journal.error().message();
    EXPECT_TRUE(linesOf(*journal) == someLines());
    EXPECT_EQ(journal->damaged, 1u);
}

TEST(Journal, of_another_kind_is_refused) {
    const ScratchFolder folder;
    const auto refusal = [&](const std::string& text) {
        const auto journal = readJournal(folder.file("journal", text));
        return journal ? "" : journal.error().message();
    };
    EXPECT_THAT(refusal("fantascope-journal 2\n"), HasSubstr("journal: this is no journal of a night"));
    EXPECT_THAT(refusal("fantascope: show\n"), HasSubstr("this is no journal"));
    EXPECT_THAT(refusal("fantascope-jour"), IsEmpty()) << "it died at once";
    EXPECT_FALSE(readJournal(folder / "none"));
}

TEST(Journal, knows_a_list_by_what_enters_its_cues) {
    CueList list;
    list.cues = {{.look = {}, .fade = 2s, .follow = 3s, .name = "A"}, {.look = {}, .fade = 2s, .follow = {}, .name = "B"}};
    const std::uint64_t hash = hashOf(list);
    CueList other = list;
    other.cues[0].fade = 5s;
    EXPECT_EQ(hashOf(other), hash) << "it enters the same cues at the same times";
    other.cues[0].follow = 4s;
    EXPECT_NE(hashOf(other), hash);
    other = list;
    other.cues[1].name = "C";
    EXPECT_NE(hashOf(other), hash);
    other = list;
    other.goInterval = 1s;
    EXPECT_NE(hashOf(other), hash);
}

}  // namespace
}  // namespace fantascope::show
