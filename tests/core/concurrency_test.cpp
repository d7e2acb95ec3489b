// What threads exchange, and that the number of threads changes nothing. Data races are for the
// thread sanitizer.

#include "core/append_log.h"
#include "core/bounded_queue.h"
#include "core/latest_value.h"
#include "core/parallel.h"
#include "core/random.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace fantascope {
namespace {

using testing::ElementsAre;

TEST(LatestValue, gives_the_newest_once_and_keeps_it) {
    LatestValue<int> slot(7);
    EXPECT_FALSE(slot.update());
    EXPECT_EQ(slot.value(), 7);
    for (const int value : {1, 2, 3}) {
        slot.writable() = value;
        slot.publish();
    }
    EXPECT_EQ(slot.value(), 7) << "nothing changes under the reader's hands";
    EXPECT_TRUE(slot.update());
    EXPECT_EQ(slot.value(), 3);
    EXPECT_FALSE(slot.update());
    EXPECT_EQ(slot.value(), 3);
}

// Example failure: the writer gets the buffer that the reader is looking at, and the picture tears.
TEST(LatestValue, writer_and_reader_never_hold_the_same_buffer) {
    LatestValue<int> slot;
    Rng rng(1);
    int published = 0;
    for (int step = 0; step < 1000; ++step) {
        if (rng.below(2) == 0) {
            slot.writable() = ++published;
            slot.publish();
        } else if (slot.update()) {
            EXPECT_EQ(slot.value(), published);
        }
        ASSERT_NE(&slot.writable(), &slot.value());
    }
}

TEST(LatestValue, values_are_whole_and_only_get_newer_between_two_threads) {
    LatestValue<std::vector<int>> slot(std::vector<int>(1000, 0));
    std::jthread writer([&](const std::stop_token& stopped) {
        for (int value = 1; !stopped.stop_requested(); ++value) {
            std::vector<int>& picture = slot.writable();
            std::fill(picture.begin(), picture.end(), value);
            slot.publish();
        }
    });
    for (int newest = 0, taken = 0; taken < 1000;) {
        if (!slot.update()) {
            std::this_thread::yield();
            continue;
        }
        const std::vector<int>& picture = slot.value();
        ASSERT_GT(picture[0], newest);
        newest = picture[0];
        ASSERT_EQ(std::count(picture.begin(), picture.end(), newest), 1000);
        ++taken;
    }
}

TEST(BoundedQueue, takes_no_more_than_its_capacity_and_keeps_the_order) {
    BoundedQueue<int, 3> queue;
    EXPECT_EQ(queue.pop(), std::nullopt);
    for (int round = 0; round < 5; ++round) {  // so that it wraps around
        for (const int value : {1, 2, 3}) EXPECT_TRUE(queue.push(value));
        EXPECT_FALSE(queue.push(4));
        for (const int value : {1, 2, 3}) EXPECT_EQ(queue.pop(), value);
        EXPECT_EQ(queue.pop(), std::nullopt);
    }
}

// Example failure: a camera frame stays in memory until the queue has wrapped around.
TEST(BoundedQueue, keeps_no_hold_of_what_was_taken) {
    BoundedQueue<std::shared_ptr<int>, 3> queue;
    queue.push(std::make_shared<int>(5));
    const auto taken = queue.pop();
    EXPECT_EQ(taken->use_count(), 1);
}

TEST(BoundedQueue, everything_arrives_once_and_in_order_between_two_threads) {
    constexpr int kLast = 20'000;
    BoundedQueue<int, 16> queue;
    std::jthread writer([&] {
        for (int value = 1; value <= kLast;) {
            if (queue.push(value))
                ++value;
            else
                std::this_thread::yield();
        }
    });
    for (int expected = 1; expected <= kLast;) {
        if (const auto value = queue.pop())
            ASSERT_EQ(*value, expected++);
        else
            std::this_thread::yield();
    }
}

// Example failure: a late reader finds only the newest chunk.
TEST(AppendLog, every_reader_sees_every_value_once_and_all_in_one_order) {
    constexpr int kWriters = 4, kEach = 5000;
    AppendLog<int> log;
    std::vector<std::vector<int>> seen(3);
    {
        std::vector<std::jthread> threads;
        for (int writer = 0; writer < kWriters; ++writer)
            threads.emplace_back([&, writer] {
                for (int i = 0; i < kEach; ++i) log.append(writer * kEach + i);
            });
        for (std::size_t number = 0; number < 2; ++number)
            threads.emplace_back([&, number] {
                auto reader = log.reader();
                while (seen[number].size() < kWriters * kEach)
                    if (const int* const value = reader.next()) seen[number].push_back(*value);
            });
    }
    auto late = log.reader();
    while (const int* const value = late.next()) seen[2].push_back(*value);
    EXPECT_EQ(seen[0], seen[2]);
    EXPECT_EQ(seen[1], seen[2]);
    std::vector<int> all = seen[2];
    std::sort(all.begin(), all.end());
    for (int i = 0; i < kWriters * kEach; ++i) ASSERT_EQ(all[static_cast<std::size_t>(i)], i);
    for (int writer = 0; writer < kWriters; ++writer) {
        int newest = -1;
        for (const int value : seen[2]) {
            if (value / kEach != writer) continue;
            ASSERT_GT(value, std::exchange(newest, value)) << "a writer's values keep their order";
        }
    }
    EXPECT_EQ(late.next(), nullptr);
    log.append(7);
    EXPECT_EQ(*late.next(), 7);
}

TEST(ParallelFor, does_every_index_once_on_any_number_of_threads) {
    for (const int threads : {-1, 0, 1, 2, 3, 8, 100}) {
        for (const int count : {0, 1, 7, 100}) {
            std::vector<int> done(static_cast<std::size_t>(count), 0);
            parallelFor(count, threads, [&](int index) { ++done[static_cast<std::size_t>(index)]; });
            EXPECT_EQ(std::count(done.begin(), done.end(), 1), count) << threads << " threads, " << count << " indices";
        }
    }
}

TEST(ParallelFor, uses_no_thread_but_the_callers_when_one_is_asked_for) {
    std::vector<std::thread::id> threads;
    parallelFor(3, 1, [&](int) { threads.push_back(std::this_thread::get_id()); });
    EXPECT_THAT(threads, ElementsAre(std::this_thread::get_id(), std::this_thread::get_id(), std::this_thread::get_id()));
    EXPECT_GE(hardwareThreads(), 1);
}

}  // namespace
}  // namespace fantascope
