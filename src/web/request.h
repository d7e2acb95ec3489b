#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::web {

// A request as the server has read it: whole, and within its limits. Names are as RFC 9110 has
// them.
struct Request {
    std::string method{};  // "GET"
    std::string path{};    // "/api/v1/state": decoded, without the query
    std::vector<std::pair<std::string, std::string>> query{};
    std::string body{};
    std::string contentType{}, host{}, origin{}, fetchSite{};  // header fields; empty: not sent
    bool isLocal = false;                                      // it comes from this machine

    // The value of a part of the query; empty: it is not there.
    std::string_view part(std::string_view name) const {
        for (const auto& [key, value] : query)
            if (key == name) return value;
        return {};
    }
};

struct Response {
    int status = 200;
    std::string type = "application/json";
    std::shared_ptr<const std::string> body{};                // null: empty
    std::vector<std::pair<std::string, std::string>> more{};  // further header fields
    std::string channel{};                                    // not empty: what is published there follows, as events
    static Response of(int status, std::string type, std::string body) {
        return {status, std::move(type), std::make_shared<const std::string>(std::move(body))};
    }
};

}  // namespace fantascope::web
