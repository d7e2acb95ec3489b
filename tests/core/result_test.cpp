#include "core/result.h"

#include "core/check.h"
#include "core/log.h"

#include <gmock/gmock.h>

#include <memory>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Result<int> half(int number) {
    if (number % 2 != 0) return Error(std::to_string(number) + " is odd");
    return number / 2;
}
Result<int> quarter(int number) { return TRY(half(TRY(half(number)))); }
Result<void> mustBeEven(int number) {
    TRY(half(number));
    return {};
}

TEST(Result, holds_a_value_or_says_why_not) {
    EXPECT_EQ(*half(6), 3);
    EXPECT_FALSE(half(5));
    EXPECT_EQ(half(5).error().message(), "5 is odd");
    EXPECT_TRUE(mustBeEven(2));
    EXPECT_EQ(mustBeEven(3).error().message(), "3 is odd");
}

TEST(Result, try_returns_the_first_error) {
    EXPECT_EQ(*quarter(8), 2);
    EXPECT_EQ(quarter(6).error().message(), "3 is odd");
    EXPECT_EQ(quarter(5).error().message(), "5 is odd");
}

TEST(Result, context_is_added_going_up) {
    EXPECT_EQ(half(5).in("lamps[2]").in("site.yaml").error().message(), "site.yaml: lamps[2]: 5 is odd");
    EXPECT_EQ(half(4).in("site.yaml").value(), 2);
    EXPECT_EQ(mustBeEven(5).in("a").error().message(), "a: 5 is odd");
    EXPECT_TRUE(mustBeEven(4).in("a"));
}

TEST(Result, values_that_can_only_move_pass_through) {
    const auto make = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(7); };
    const auto pass = [&]() -> Result<std::unique_ptr<int>> { return TRY(make()); };
    EXPECT_EQ(**pass(), 7);
}

TEST(CheckDeathTest, a_broken_promise_names_itself_and_its_place) {
    FANTASCOPE_CHECK(1 + 1 == 2, "sums");
    EXPECT_DEATH(FANTASCOPE_CHECK(1 + 1 == 3, "sums are right"),
                 "result_test.cpp:[0-9]+: check failed: 1 \\+ 1 == 3: sums are right");
}

TEST(Log, lines_below_their_categorys_level_are_dropped) {
    testing::internal::CaptureStderr();
    log::debug("show", "too fine");
    log::warning("show", "braces {} are plain text");
    log::setLevel("render", log::Level::Debug);
    log::debug("render", "asked for");
    log::setLevel(log::Level::Error);
    log::warning("render", "too coarse");
    log::setLevel(log::Level::Info);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), AllOf(HasSubstr("warning"), HasSubstr("show: braces {} are plain text"),
                                                              HasSubstr("render: asked for"), Not(HasSubstr("too"))));
}

}  // namespace
}  // namespace fantascope
