#include "app/journal/night_journal.h"

#include "core/file.h"
#include "core/hash.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostHeld = 1 << 20;                                                          // bytes
constexpr std::uintmax_t kLarge = std::uintmax_t{64} << 20, kTooLarge = std::uintmax_t{128} << 20;  // bytes
constexpr std::size_t kOldJournals = 100;
constexpr Time kSyncEvery = std::chrono::milliseconds(50), kTryAgain = std::chrono::seconds(1);

// A slot of the clock's file: the time in nanoseconds and its check.
constexpr std::size_t kSlot = 30;
std::string slotOf(Time time) {
    const std::string digits = fmt::format("{:020}", time.count());
    return fmt::format("{} {:08x}\n", digits, static_cast<std::uint32_t>(fnv1a(digits)));
}

std::string stampOf(Time utc) {
    const WallTime time = wallTimeOf(utc, Time{});
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time.timeOfDay).count();
    return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}", static_cast<int>(time.date.year()),
                       static_cast<unsigned>(time.date.month()), static_cast<unsigned>(time.date.day()), whole / 3600,
                       whole / 60 % 60, whole % 60);
}

}  // namespace

Result<std::unique_ptr<NightJournal>> NightJournal::open(const fs::path& folder, bool anew, bool asFastAsPossible,
                                                         const WallClock& wall) {
    if (folder.empty()) return std::unique_ptr<NightJournal>();
    std::unique_ptr<NightJournal> journal(new NightJournal(folder, !asFastAsPossible, wall));
    std::error_code refused;
    fs::create_directories(folder, refused);
    if (refused) {
        journal->trouble_ =
            fmt::format("{}: {}; give --journal a folder that can be written", folder.string(), refused.message());
        return journal;
    }
    if (AppendedFile::isOpenElsewhere(folder / "journal"))
        return Error(fmt::format("{}: another run writes this journal; end it, or give each run a folder of its own",
                                 (folder / "journal").string()));
    journal->readEarlier(anew);
    if (const auto opened = journal->openFiles(journal->earlier_ ? journal->earlier_->journal.bytes : 0); !opened) {
        journal->trouble_ = opened.error().message();
        return journal;
    }
    journal->removeOld();
    journal->writer_ = std::jthread([&self = *journal](const std::stop_token& stop) { self.writeOn(stop); });
    if (!asFastAsPossible)
        journal->syncer_ = std::jthread([&self = *journal](const std::stop_token& stop) { self.syncOn(stop); });
    return journal;
}

NightJournal::~NightJournal() {
    for (std::jthread* const thread : {&writer_, &syncer_})
        if (thread->joinable()) thread->request_stop(), thread->join();
    if (file_) static_cast<void>(file_->sync());
}

void NightJournal::readEarlier(bool anew) {
    std::error_code ignored;
    if (!fs::exists(folder_ / "journal", ignored)) return;
    auto journal = show::readJournal(folder_ / "journal");
    if (!journal) return setAside(utc());
    if (journal->entries.empty()) return;  // it died at once, and leaves nothing
    const Time at = std::max(journal->newest(), newestTime().value_or(Time{}));
    // Without the line of its beginning, nobody knows of which night it is.
    const show::journal::Clock clock = journal->clock().value_or(show::journal::Clock{at, utc()});
    const Time ended = clock.utc + (at - clock.at);
    if (anew || utc() - ended > kNight) return setAside(clock.utc);
    earlier_ = Earlier{std::move(*journal), at, ended};
}

// Gives the journal that is there the name of an earlier night's.
void NightJournal::setAside(Time began) {
    std::error_code refused;
    fs::path name = folder_ / ("journal-" + stampOf(began));
    for (int i = 2; fs::exists(name, refused); ++i) name = folder_ / fmt::format("journal-{}-{}", stampOf(began), i);
    fs::rename(folder_ / "journal", name, refused);
    fs::remove(folder_ / "clock", refused);
}

void NightJournal::removeOld() const {
    std::vector<fs::path> old;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored))
        if (entry.path().filename().string().starts_with("journal-")) old.push_back(entry.path());
    std::ranges::sort(old, std::greater());
    for (std::size_t i = kOldJournals; i < old.size(); ++i) fs::remove(old[i], ignored);
}

Result<void> NightJournal::openFiles(std::size_t bytes) {
    file_.emplace(TRY(AppendedFile::open(folder_ / "journal", bytes)));
    bytes_ = bytes;
    if (bytes == 0) pending_ += show::kJournalHead;
    const fs::path clock = folder_ / "clock";
    clockFile_ = drivers::FileHandle(::open(clock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
    if (!clockFile_.isOpen()) return Error(fmt::format("{}: cannot be written", clock.string()));
    return {};
}

std::optional<Time> NightJournal::newestTime() const {
    const auto text = readFile(folder_ / "clock");
    std::optional<Time> newest;
    for (std::size_t slot = 0; text && slot + kSlot <= text->size(); slot += kSlot) {
        Time::rep count = 0;
        const char* const begin = text->data() + slot;
        if (std::from_chars(begin, begin + 20, count).ec != std::errc()) continue;
        if (text->substr(slot, kSlot) == slotOf(Time(count))) newest = std::max(newest.value_or(Time(count)), Time(count));
    }
    return newest;
}

bool NightJournal::put(std::string line) {
    if (pending_.size() + held_ + line.size() > kMostHeld) {
        hasLost_ = true;
        return false;
    }
    pending_ += line;
    ++asked_;
    return true;
}

void NightJournal::write(const show::journal::Line& line, bool isNeeded) {
    std::unique_lock lock(mutex_);
    if (!file_ || bytes_ > (isNeeded ? kTooLarge : kLarge)) return;
    if (hasLost_ && pending_.size() + held_ < kMostHeld / 2) {
        hasLost_ = false;
        put(show::lineOf(show::journal::Gap{}));
    }
    if (!put(show::lineOf(line))) return;
    const std::uint64_t mine = asked_;
    wake_.notify_one();
    const auto isWritten = [&] { return written_ >= mine || !trouble_.empty(); };
    if (isPaced_)
        done_.wait_for(lock, kPatience, isWritten);
    else
        done_.wait(lock, isWritten);
}

void NightJournal::begin(const show::journal::Run& run) {
    write(run);
    // If this fails, the clock still has an earlier time until it is written twice.
    [[maybe_unused]] const int ignored = ::ftruncate(clockFile_.get(), 0);
}

void NightJournal::noteTime(Time showTime) {
    const std::lock_guard lock(mutex_);
    time_ = showTime;
    wake_.notify_one();
}

std::string NightJournal::trouble() const {
    const std::lock_guard lock(mutex_);
    const std::string& why = trouble_.empty() ? syncTrouble_ : trouble_;
    if (!why.empty()) return "the journal is not written: " + why;
    if (bytes_ > kTooLarge) return "the journal is full: nothing more is written tonight";
    if (bytes_ > kLarge) return "the journal is large: only what a restart needs is written from now on";
    return {};
}

// The writer's thread: gives lines to the system as they come.
void NightJournal::writeOn(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (true) {
        const auto hasWork = [&] { return time_.has_value() || (trouble_.empty() && written_ < asked_); };
        if (trouble_.empty())
            wake_.wait(lock, stop, hasWork);
        else
            wake_.wait_for(lock, stop, kTryAgain, [] { return false; });
        const bool isLast = stop.stop_requested();
        const std::string lines = std::exchange(pending_, {});
        const std::uint64_t asked = asked_;
        const std::optional<Time> time = std::exchange(time_, std::nullopt);
        lock.unlock();
        file_->append(lines);
        const Result<void> result = file_->write();
        if (time) writeTime(*time);
        lock.lock();
        held_ = file_->unwritten();
        // While the disk is waited for, a press may have to wait, too: only if there is something
        // new.
        isDirty_ = isDirty_ || file_->written() != bytes_;
        bytes_ = file_->written();
        trouble_ = result ? "" : result.error().message() + "; make room, and the lines follow";
        if (result) written_ = asked;
        done_.notify_all();
        if (isLast) return;
    }
}

// The syncer's thread: waits for the disk, so that the writer need not.
void NightJournal::syncOn(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        pause_.wait_for(lock, stop, kSyncEvery, [] { return false; });
        if (!std::exchange(isDirty_, false)) continue;
        lock.unlock();
        const Result<void> result = file_->sync();
        lock.lock();
        syncTrouble_ = result ? "" : result.error().message();
    }
}

void NightJournal::writeTime(Time showTime) {
    const std::string slot = slotOf(showTime);
    // The clock is a help: without it the newest line tells the time.
    [[maybe_unused]] const ssize_t ignored =
        ::pwrite(clockFile_.get(), slot.data(), slot.size(), std::exchange(secondSlot_, !secondSlot_) ? off_t{kSlot} : 0);
}

}  // namespace fantascope::app
