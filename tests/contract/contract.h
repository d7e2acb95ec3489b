#pragma once
// A contract suite lists what a port promises, one clause per promise, in terms of a rig: the port
// under test and its far end (what the wire carries, how to unplug it and plug it in, how to let
// time pass). The same suite runs on every backend of the port.

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

namespace fantascope::contract {

template <class Rig>
struct Clause {
    std::string name;                        // the promise, as a sentence
    std::function<std::string(Rig&)> check;  // "" if it holds, else what was seen
};

template <class Rig>
using Suite = std::vector<Clause<Rig>>;

struct Violation {
    std::string clause, what;
};

// Checks each clause on a fresh rig.
template <class Rig>
std::vector<Violation> violations(const std::vector<Clause<Rig>>& suite,
                                  const std::type_identity_t<std::function<std::unique_ptr<Rig>()>>& makeRig) {
    std::vector<Violation> found;
    for (const Clause<Rig>& clause : suite) {
        const std::unique_ptr<Rig> rig = makeRig();
        if (std::string what = clause.check(*rig); !what.empty()) found.push_back({clause.name, std::move(what)});
    }
    return found;
}

// EXPECT_THAT(violations(suite, makeRig), IsEmpty()) prints each violation with what was seen.
inline void PrintTo(const Violation& violation, std::ostream* out) {
    *out << "\"" << violation.clause << "\": " << violation.what;
}

// EXPECT_THAT(clausesOf(violations(suite, makeBrokenRig)), ElementsAre("...")) for a backend that
// breaks a promise.
inline std::vector<std::string> clausesOf(const std::vector<Violation>& violations) {
    std::vector<std::string> names;
    for (const Violation& violation : violations) names.push_back(violation.clause);
    return names;
}

}  // namespace fantascope::contract
