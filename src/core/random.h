#pragma once
// Random numbers that are the same on every machine: a Mersenne Twister with distributions of our
// own, because those of the standard library differ between implementations. Code that needs chance
// is given an Rng; a thing with an identity gets its own stream by streamSeed().

#include <cstdint>
#include <initializer_list>
#include <random>

namespace fantascope {

class Rng {
public:
    explicit Rng(std::uint64_t seed);

    std::uint32_t bits() { return engine_(); }
    double uniform();                          // [0, 1), 53 bits
    double uniform(double low, double high);   // [low, high)
    double normal();                           // mean 0, standard deviation 1 (Box & Muller 1958)
    std::uint32_t below(std::uint32_t count);  // 0 .. count-1, unbiased; count > 0

private:
    std::mt19937 engine_;
    double spare_ = 0;  // the second value of Box-Muller
    bool hasSpare_ = false;
};

// The seed of one thing's stream, from the run's seed and the thing's stable identity, such as
// {instance id, axis}. Different identities give unrelated streams, and a stream does not depend on
// which other things exist.
std::uint64_t streamSeed(std::uint64_t seed, std::initializer_list<std::uint64_t> identity);

}  // namespace fantascope
