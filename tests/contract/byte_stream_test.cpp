#include "drivers/byte_stream/simulated.h"

#include "contract/byte_stream_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class LoopbackRig final : public SimulatedRig<ByteStreamRig> {
public:
    explicit LoopbackRig(Wrap<ByteStream> wrap = {}) : SimulatedRig("line", std::move(wrap)) { reopen(); }

    void farSends(const Bytes& bytes) override { (void)farEnd_->write(bytes); }
    Bytes farReceives() override {
        Bytes bytes(1 << 16);
        const auto count = farEnd_->read(bytes, Time::zero());
        bytes.resize(count ? *count : 0);
        return bytes;
    }

private:
    std::unique_ptr<ByteStream> open() override {
        auto ends = drivers::openLoopback(context_, "line");
        farEnd_ = std::move(ends[1]);
        return std::move(ends[0]);
    }
    std::unique_ptr<ByteStream> farEnd_;
};

// Its script is empty: it accepts everything, and sends by an exchange in which nothing is
// expected.
class ScriptedRig final : public SimulatedRig<ByteStreamRig> {
public:
    ScriptedRig() : SimulatedRig("line", {}) { reopen(); }

    void farSends(const Bytes& bytes) override { script_->expect({}, bytes); }
    Bytes farReceives() override {
        const Bytes all = script_->received();
        const Bytes news(all.begin() + static_cast<std::ptrdiff_t>(asked_), all.end());
        asked_ = all.size();
        return news;
    }

private:
    std::unique_ptr<ByteStream> open() override {
        auto stream = std::make_unique<drivers::ScriptedStream>(context_, "line");
        script_ = stream.get();
        asked_ = 0;
        return stream;
    }
    drivers::ScriptedStream* script_ = nullptr;
    std::size_t asked_ = 0;
};

TEST(ByteStreamContract, is_kept_by_a_loopback) {
    EXPECT_THAT(violations(byteStreamSuite(), [] { return std::make_unique<LoopbackRig>(); }), IsEmpty());
}

TEST(ByteStreamContract, is_kept_by_a_scripted_line) {
    EXPECT_THAT(violations(byteStreamSuite(), [] { return std::make_unique<ScriptedRig>(); }), IsEmpty());
}

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(violations(byteStreamSuite(), [] { return std::make_unique<LoopbackRig>(wrappedIn<Broken, ByteStream>); }));
}

class AlmostGood : public Between<ByteStream> {
    using Between::Between;
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override { return good_->write(bytes); }
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override { return good_->read(bytes, timeout); }
};

class ClaimsToHaveTakenAll : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override {
        TRY(good_->write(bytes));
        return bytes.size();
    }
};
TEST(ByteStreamContract, finds_a_line_that_claims_to_have_taken_all) {
    EXPECT_THAT(brokenBy<ClaimsToHaveTakenAll>(), ElementsAre("a full line takes what fits and loses none of it"));
}

class DropsWhatDoesNotFit : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override {
        const std::size_t count = TRY(good_->read(bytes, timeout));
        Bytes rest(1000);
        if (count == bytes.size()) (void)good_->read(rest, Time::zero());
        return count;
    }
};
TEST(ByteStreamContract, finds_a_line_that_drops_what_does_not_fit_into_a_read) {
    EXPECT_THAT(brokenBy<DropsWhatDoesNotFit>(), ElementsAre("what does not fit into one read() comes with the next"));
}

class ForgetsAtALoss : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override {
        if (!running()) return Error("gone");
        return good_->read(bytes, timeout);
    }
};
TEST(ByteStreamContract, finds_a_line_that_forgets_what_had_arrived) {
    EXPECT_THAT(brokenBy<ForgetsAtALoss>(), ElementsAre("a lost line gives what had arrived, then errors that say why"));
}

class WaitsForAFullBuffer : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override {
        std::size_t count = 0;
        const Time deadline = context_.clock.now() + timeout;
        do {
            count += TRY(good_->read(bytes.subspan(count), deadline - context_.clock.now()));
        } while (count < bytes.size() && context_.clock.now() < deadline && running());
        return count;
    }
};
TEST(ByteStreamContract, finds_a_line_that_waits_for_a_full_buffer) {
    EXPECT_THAT(brokenBy<WaitsForAFullBuffer>(), ElementsAre("what has arrived is read without waiting"));
}

}  // namespace
}  // namespace fantascope::contract
