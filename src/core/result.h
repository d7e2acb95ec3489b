#pragma once
// How functions report that the world refused: a file, a device, a parser. A function that cannot
// be refused returns its value; a solver that did not converge says so in its Summary; our own
// mistakes end in FANTASCOPE_CHECK.

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace fantascope {

// A message for a person: what, where, and what to do. Callers add context: "shows/x: patterns[2]:
// ...".
class Error {
public:
    explicit Error(std::string message) : message_(std::move(message)) {}
    const std::string& message() const { return message_; }
    Error in(const std::string& context) const { return Error(context + ": " + message_); }

private:
    std::string message_;
};

// A value or an Error, like C++23's std::expected. Asking for the one that is missing is a bug of
// ours and stops the program.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : held_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}

    bool has_value() const { return held_.index() == 0; }
    explicit operator bool() const { return has_value(); }
    T& value() & { return std::get<0>(held_); }
    const T& value() const& { return std::get<0>(held_); }
    T&& value() && { return std::get<0>(std::move(held_)); }
    const Error& error() const { return std::get<1>(held_); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    // The same result; an error's message is led by `context`.
    Result in(const std::string& context) && {
        if (has_value()) return std::move(*this);
        return error().in(context);
    }

private:
    std::variant<T, Error> held_;
};

template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    bool has_value() const { return !error_; }
    explicit operator bool() const { return has_value(); }
    void value() const {}
    const Error& error() const { return error_.value(); }
    Result in(const std::string& context) && {
        if (has_value()) return {};
        return error().in(context);
    }

private:
    std::optional<Error> error_;
};

}  // namespace fantascope

// The value of a Result, or a return of its error from the enclosing function: auto image =
// TRY(readGrey(path)); In a braced initialiser it must come first, never as in {name, TRY(...)}:
// g++ would not destroy the name. tests/house checks this.
#define TRY(expression)                                                      \
    ({                                                                       \
        auto tried_ = (expression);                                          \
        if (!tried_.has_value()) return ::fantascope::Error(tried_.error()); \
        std::move(tried_).value();                                           \
    })
