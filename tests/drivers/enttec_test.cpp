#include "drivers/byte_stream/simulated.h"
#include "drivers/dmx/enttec_widget.h"
#include "drivers/site/world.h"

#include <gmock/gmock.h>

#include <numeric>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<WidgetMessage> parsed(WidgetParser& parser, const Bytes& bytes) {
    parser.put(bytes);
    std::vector<WidgetMessage> all;
    while (auto message = parser.next()) all.push_back(std::move(*message));
    return all;
}

Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

TEST(WidgetMessage, stands_between_its_start_and_its_end_with_its_length) {
    EXPECT_THAT(encoded(WidgetLabel::Number, {}), ElementsAre(0x7e, 10, 0, 0, 0xe7));
    const Bytes message = encoded(WidgetLabel::Send, Bytes(513, 3));
    EXPECT_EQ(message.size(), 518u);
    EXPECT_THAT(Bytes(message.begin(), message.begin() + 5), ElementsAre(0x7e, 6, 0x01, 0x02, 3));
}

TEST(WidgetParser, finds_messages_however_they_arrive) {
    WidgetParser parser;
    const Bytes two = joined({encoded(WidgetLabel::Number, Bytes{1, 2, 3, 4}), encoded(WidgetLabel::Received, Bytes(514, 0x7e))});
    std::size_t found = 0;
    for (const std::uint8_t byte : two) found += parsed(parser, {byte}).size();
    EXPECT_EQ(found, 2u);
    EXPECT_EQ(parsed(parser, two).size(), 2u);
}

TEST(WidgetParser, an_end_and_a_start_may_stand_in_the_data) {
    WidgetParser parser;
    const auto messages = parsed(parser, encoded(WidgetLabel::Received, Bytes{0xe7, 0x7e, 0xe7}));
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_THAT(messages[0].data, ElementsAre(0xe7, 0x7e, 0xe7));
}

// A computer begins to listen in the middle of a message, or a byte is lost. Whatever comes before,
// the next message is found.
TEST(WidgetParser, finds_its_way_back_after_whatever_came_before) {
    const Bytes good = encoded(WidgetLabel::Number, Bytes{1, 2, 3, 4});
    for (const Bytes& garbage :
         {Bytes{0}, Bytes{0xe7, 0xe7}, Bytes{0x7e}, Bytes{0x7e, 0x7e, 0x7e}, Bytes{0x7e, 5, 0xff, 0xff},
          Bytes{0x7e, 5, 0x59, 0x02}, Bytes{0x7e, 5, 3, 0}, Bytes(1000, 0x7e), encoded(WidgetLabel::Received, Bytes(100, 9))}) {
        for (std::size_t cut = 0; cut < garbage.size(); cut += 1 + garbage.size() / 7) {
            WidgetParser parser;
            const Bytes before(garbage.begin() + static_cast<std::ptrdiff_t>(cut), garbage.end());
            // A start byte by chance may claim up to 600 bytes before it is rejected.
            auto messages = parsed(parser, before);
            for (int more = 0; more < 80; ++more) {
                auto next = parsed(parser, good);
                messages.insert(messages.end(), next.begin(), next.end());
            }
            std::size_t numbers = 0;
            for (const WidgetMessage& message : messages)
                numbers += message.label == WidgetLabel::Number && message.data == Bytes{1, 2, 3, 4};
            EXPECT_GE(numbers, 79u) << garbage.size() << " bytes, cut at " << cut;
        }
    }
}

TEST(WidgetParser, takes_no_message_longer_than_there_are) {
    WidgetParser parser;
    Bytes tooLong{0x7e, 5, 0x59, 0x02};  // 601
    tooLong.resize(4 + 601, 1);
    tooLong.push_back(0xe7);
    EXPECT_THAT(parsed(parser, tooLong), IsEmpty());
    EXPECT_EQ(parsed(parser, encoded(WidgetLabel::Received, Bytes(600, 1))).size(), 1u);
}

TEST(WidgetAnswer, is_read_as_the_widget_means_it) {
    EXPECT_EQ(parametersIn(Bytes{44, 1, 9, 2, 40, 77}).value(), (WidgetParameters{256 + 44, 9, 2, 40}));
    EXPECT_FALSE(parametersIn(Bytes{44, 1, 9, 2}));
    EXPECT_EQ(numberIn(Bytes{0x67, 0x45, 0x23, 0x01}), "01234567");
    EXPECT_EQ(numberIn(Bytes{0xff, 0xff, 0xff, 0xff}), "") << "it was given none";
    EXPECT_FALSE(numberIn(Bytes{1, 2, 3}));
    EXPECT_EQ(nameIn(Bytes{0x45, 0x4e, 'P', 'R', 'O', 0, 'x'}), "PRO");
    EXPECT_EQ(nameIn(Bytes{1}), "");
}

TEST(ReceivedPacket, holds_the_slots_that_came_and_0_in_the_others) {
    DmxPacket packet;
    packet.fill(9);
    EXPECT_TRUE(applyTo({WidgetLabel::Received, {0, 0, 11, 12}}, packet));
    EXPECT_EQ(packet[1], 11);
    EXPECT_EQ(packet[2], 12);
    EXPECT_EQ(packet[3], 0);
    EXPECT_FALSE(applyTo({WidgetLabel::Received, {1, 0, 50}}, packet)) << "the widget could not keep up";
    EXPECT_FALSE(applyTo({WidgetLabel::Received, {0, 0xcc, 50}}, packet)) << "another start code";
    EXPECT_FALSE(applyTo({WidgetLabel::Received, Bytes(515, 0)}, packet)) << "more than a universe";
    EXPECT_FALSE(applyTo({WidgetLabel::Received, {}}, packet));
    EXPECT_EQ(packet[1], 11);
    EXPECT_TRUE(applyTo({WidgetLabel::Received, Bytes(514, 0)}, packet));
}

// One bit per slot, from eight times the first byte on; slot 0 is the start code.
TEST(ChangedSlots, are_those_whose_bits_are_set) {
    DmxPacket packet{};
    EXPECT_TRUE(applyTo({WidgetLabel::Changed, {0, 0b0000'0110, 0, 0, 0, 0, 100, 200}}, packet));
    EXPECT_EQ(packet[1], 100);
    EXPECT_EQ(packet[2], 200);
    EXPECT_TRUE(applyTo({WidgetLabel::Changed, {60, 0, 0, 0, 0b0000'1000, 0b0000'0001, 77, 88}}, packet));
    EXPECT_EQ(packet[60 * 8 + 27], 77);
    EXPECT_EQ(packet[60 * 8 + 32], 88);
    EXPECT_FALSE(applyTo({WidgetLabel::Changed, {64, 0b10, 0, 0, 0, 0, 1}}, packet)) << "beyond slot 512";
    EXPECT_FALSE(applyTo({WidgetLabel::Changed, {0, 0b110, 0, 0, 0, 0, 1}}, packet)) << "a value is missing";
    EXPECT_FALSE(applyTo({WidgetLabel::Changed, {0, 1}}, packet));
}

class EnttecWidgetTest : public testing::Test {
protected:
    void expect(WidgetLabel label, const Bytes& data, const Bytes& reply = {}) { line_.expect(encoded(label, data), reply); }
    // Runs work() for `duration` and collects all messages.
    Result<void> work(Time duration) {
        return widget_.work(clock_.now() + duration, [&](const WidgetMessage& message) { heard_.push_back(message); });
    }

    const Bytes parameters_ = encoded(WidgetLabel::Parameters, Bytes{44, 1, 9, 1, 40});
    ManualClock clock_;
    site::World world_{clock_};
    DriverContext context_{clock_, &world_};
    ScriptedStream line_{context_, "widget"};
    EnttecWidget widget_{line_, clock_};
    std::vector<WidgetMessage> heard_;
};

TEST_F(EnttecWidgetTest, is_met_by_its_parameters_whatever_else_it_says) {
    line_.expect({0x7e, 3, 2, 0, 0, 0, 0xe7}, joined({{1, 2, 3}, encoded(WidgetLabel::Received, Bytes(514, 0)), parameters_}));
    EXPECT_EQ(widget_.handshake().value(), (WidgetParameters{256 + 44, 9, 1, 40}));
    EXPECT_TRUE(line_.finished()) << line_.deviation();
}

TEST_F(EnttecWidgetTest, is_asked_again_behind_what_ends_any_message) {
    expect(WidgetLabel::Parameters, {0, 0});
    line_.expect(Bytes(605, 0));
    expect(WidgetLabel::Parameters, {0, 0}, parameters_);
    EXPECT_TRUE(widget_.handshake());
    EXPECT_TRUE(line_.finished()) << line_.deviation();
}

TEST_F(EnttecWidgetTest, is_none_if_it_never_answers) {
    EXPECT_THAT(widget_.handshake().error().message(), HasSubstr("does not answer"));
    EXPECT_EQ(line_.received().size(), 3 * 7u + 2 * 605u);
}

TEST_F(EnttecWidgetTest, tells_its_number_and_its_name) {
    line_.expect({0x7e, 10, 0, 0, 0xe7}, {0x7e, 10, 4, 0, 0x78, 0x56, 0x34, 0x12, 0xe7});
    line_.expect({0x7e, 77, 0, 0, 0xe7}, encoded(WidgetLabel::Manufacturer, Bytes{0x45, 0x4e, 'E', 'N'}));
    line_.expect({0x7e, 78, 0, 0, 0xe7}, encoded(WidgetLabel::Device, Bytes{1, 0, 'P', 'R', 'O'}));
    EXPECT_EQ(widget_.number().value(), "12345678");
    EXPECT_EQ(widget_.name().value(), "EN PRO");
    EXPECT_TRUE(line_.finished()) << line_.deviation();
}

TEST_F(EnttecWidgetTest, has_no_name_if_it_is_too_old_to_know) { EXPECT_EQ(widget_.name().value(), ""); }

TEST_F(EnttecWidgetTest, is_given_parameters_and_asked_whether_it_took_them) {
    expect(WidgetLabel::Parameters, {0, 0}, parameters_);
    line_.expect({0x7e, 4, 5, 0, 0, 0, 17, 2, 30, 0xe7});
    expect(WidgetLabel::Parameters, {0, 0}, encoded(WidgetLabel::Parameters, Bytes{44, 1, 17, 2, 30}));
    EXPECT_TRUE(widget_.setParameters({256 + 44, 17, 2, 30}));
    EXPECT_TRUE(line_.finished()) << line_.deviation();
}

TEST_F(EnttecWidgetTest, that_keeps_its_own_parameters_is_told) {
    for (int time = 0; time < 4; ++time) {
        expect(WidgetLabel::Parameters, {0, 0}, parameters_);
        if (time < 3) expect(WidgetLabel::SetParameters, {0, 0, 17, 2, 30});
    }
    EXPECT_THAT(widget_.setParameters({256 + 44, 17, 2, 30}).error().message(), HasSubstr("does not accept its parameters"));
}

TEST_F(EnttecWidgetTest, sends_what_it_is_told_byte_by_byte) {
    Bytes packet(513);
    std::iota(packet.begin() + 1, packet.end(), std::uint8_t{5});
    line_.expect(joined({{0x7e, 6, 0x01, 0x02}, packet, {0xe7}}));
    widget_.queue(WidgetLabel::Send, packet);
    EXPECT_FALSE(widget_.idle());
    ASSERT_TRUE(work(25ms));
    EXPECT_TRUE(widget_.idle());
    EXPECT_TRUE(line_.finished()) << line_.deviation();
    EXPECT_EQ(clock_.now(), 25ms) << "it works until it is time for the next frame";
}

TEST_F(EnttecWidgetTest, is_asked_once_a_second_whether_it_is_there) {
    for (int time = 0; time < 3; ++time) expect(WidgetLabel::Parameters, {0, 0}, parameters_);
    ASSERT_TRUE(work(3500ms));
    EXPECT_TRUE(line_.finished()) << line_.deviation();
    EXPECT_EQ(heard_.size(), 3u);
}

TEST_F(EnttecWidgetTest, that_does_not_answer_for_two_seconds_has_stopped) {
    ASSERT_TRUE(work(2900ms));
    EXPECT_THAT(work(200ms).error().message(), HasSubstr("stopped answering"));
    EXPECT_EQ(line_.received().size(), 7u) << "it is not asked again before it has answered";
}

TEST_F(EnttecWidgetTest, whose_line_is_lost_gives_the_lines_error) {
    world_.setPlugged("widget", false);
    EXPECT_FALSE(work(25ms));
    EXPECT_FALSE(widget_.handshake());
}

// A far end that reads nothing.
TEST_F(EnttecWidgetTest, that_takes_no_byte_for_a_second_is_stuck) {
    const auto ends = openLoopback(context_, "line", 1000);
    EnttecWidget widget(*ends[0], clock_);
    const auto hear = [](const WidgetMessage&) {};
    widget.queue(WidgetLabel::Send, Bytes(513, 0));
    ASSERT_TRUE(widget.work(clock_.now() + 25ms, hear));
    widget.queue(WidgetLabel::Send, Bytes(513, 1));
    ASSERT_TRUE(widget.work(clock_.now() + 900ms, hear)) << "as long as it may yet take the rest";
    EXPECT_FALSE(widget.idle());
    Bytes some(600);
    ASSERT_EQ(ends[1]->read(some, Time::zero()).value(), 600u);
    ASSERT_TRUE(widget.work(clock_.now() + 25ms, hear));
    EXPECT_TRUE(widget.idle());
    for (int frame = 0; frame < 2; ++frame) widget.queue(WidgetLabel::Send, Bytes(513, 2));
    EXPECT_THAT(widget.work(clock_.now() + 1100ms, hear).error().message(), HasSubstr("accepts no more bytes"));
}

}  // namespace
}  // namespace fantascope::drivers
