#pragma once

#include "device/byte_stream.h"

#include "contract/rig.h"

#include <chrono>
#include <numeric>
#include <vector>

namespace fantascope::contract {

using Bytes = std::vector<std::uint8_t>;

class ByteStreamRig : public Rig<ByteStream> {
public:
    virtual void farSends(const Bytes& bytes) = 0;
    // Everything that arrived at the far end since the last call.
    virtual Bytes farReceives() = 0;
};

// All 256 byte values, `times` times, so that no value is special and every position differs from
// its neighbours.
inline Bytes everyByte(std::size_t times = 1) {
    Bytes bytes(256 * times);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
    return bytes;
}

// The next bytes, at most `most` of them.
inline Result<Bytes> readSome(ByteStreamRig& rig, std::size_t most, Time timeout = std::chrono::milliseconds(50)) {
    Bytes bytes(most);
    bytes.resize(TRY(rig.port().read(bytes, timeout)));
    return bytes;
}

// Every promise of device/byte_stream.h.
inline Suite<ByteStreamRig> byteStreamSuite() {
    const auto serves = [](ByteStreamRig& rig) -> std::string {
        const auto written = rig.port().write(everyByte());
        CONTRACT_SUCCEEDS(written);
        rig.letTimePass();
        CONTRACT_REQUIRE(*written == 256 && rig.farReceives() == everyByte(), "the far end did not receive what was written");
        rig.farSends(everyByte());
        rig.letTimePass();
        const auto read = readSome(rig, 1000);
        CONTRACT_SUCCEEDS(read);
        CONTRACT_REQUIRE(*read == everyByte(), "what was read is not what the far end sent");
        return "";
    };
    return joined<ByteStreamRig>(
        lifeClauses<ByteStreamRig>(serves),
        {
            {"all bytes pass in both directions, in order", serves},
            {"what does not fit into one read() comes with the next",
             [](ByteStreamRig& rig) -> std::string {
                 rig.farSends(everyByte());
                 rig.letTimePass();
                 Bytes all;
                 while (all.size() < 256) {
                     const auto some = readSome(rig, 100);
                     CONTRACT_SUCCEEDS(some);
                     CONTRACT_REQUIRE(!some->empty(), "only {} of 256 bytes came", all.size());
                     all.insert(all.end(), some->begin(), some->end());
                 }
                 CONTRACT_REQUIRE(all == everyByte(), "they came out of order or twice");
                 return "";
             }},
            {"a full line takes what fits and loses none of it",
             [](ByteStreamRig& rig) -> std::string {
                 constexpr std::size_t kFarMoreThanALineHolds = 1 << 22;
                 Bytes taken, received;
                 for (std::size_t round = 0; round < 2; ++round) {  // an emptied line accepts bytes again
                     bool full = false;
                     while (!full && taken.size() < (round + 1) * kFarMoreThanALineHolds) {
                         const Bytes chunk = everyByte(4);
                         const auto count = rig.port().write(chunk);
                         CONTRACT_SUCCEEDS(count);
                         CONTRACT_REQUIRE(*count <= chunk.size(), "it took {} of {} bytes", *count, chunk.size());
                         taken.insert(taken.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(*count));
                         full = *count == 0;
                     }
                     rig.letTimePass();
                     const Bytes arrived = rig.farReceives();
                     received.insert(received.end(), arrived.begin(), arrived.end());
                     CONTRACT_REQUIRE(received == taken, "{} bytes were taken, {} came, or others", taken.size(),
                                      received.size());
                 }
                 return "";
             }},
            {"read() of a silent line gives nothing once its timeout has passed",
             [](ByteStreamRig& rig) -> std::string {
                 for (const Time timeout : {Time::zero(), Time(std::chrono::milliseconds(20))}) {
                     const Time before = rig.clock().now();
                     const auto read = readSome(rig, 10, timeout);
                     CONTRACT_SUCCEEDS(read);
                     CONTRACT_REQUIRE(read->empty(), "{} bytes came from nowhere", read->size());
                     CONTRACT_REQUIRE(rig.clock().now() - before >= timeout, "it gave up before its time");
                 }
                 return "";
             }},
            {"what has arrived is read without waiting",
             [](ByteStreamRig& rig) -> std::string {
                 rig.farSends({1, 2, 3});
                 rig.letTimePass();
                 const Time before = rig.clock().now();
                 const auto read = readSome(rig, 10, std::chrono::seconds(10));
                 CONTRACT_SUCCEEDS(read);
                 CONTRACT_REQUIRE(*read == Bytes({1, 2, 3}), "{} bytes came, not three", read->size());
                 CONTRACT_REQUIRE(rig.clock().now() - before < std::chrono::seconds(10), "it waited for more");
                 return "";
             }},
            {"a lost line gives what had arrived, then errors that say why",
             [](ByteStreamRig& rig) -> std::string {
                 rig.farSends({1, 2, 3});
                 rig.lose();
                 const auto written = rig.port().write(everyByte());
                 CONTRACT_REQUIRE(!written && !written.error().message().empty(), "write() claims success");
                 const auto read = readSome(rig, 10);
                 CONTRACT_REQUIRE(read && *read == Bytes({1, 2, 3}), "the bytes from before the loss are not given");
                 const auto more = readSome(rig, 10);
                 CONTRACT_REQUIRE(!more && !more.error().message().empty(), "read() claims success");
                 return "";
             }},
        });
}

}  // namespace fantascope::contract
