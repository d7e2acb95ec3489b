#include "app/keys/edit_keys.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace fantascope::app {
namespace {

using Name = Key::Name;
namespace edit = show::edit;

// Shift moves ten steps at once, Control a tenth of a step.
glm::dvec2 move(const Key& key, glm::dvec2 direction) { return direction * (key.shift ? 10 : key.control ? 0.1 : 1); }

std::optional<show::EditCommand> letterCommand(const Key& key, edit::Tool tool, glm::ivec2 mesh) {
    if (key.letter >= '1' && key.letter <= '9') return edit::OutputNumber{static_cast<std::size_t>(key.letter - '1')};
    switch (key.letter) {
        case 'o':
            return edit::Output{key.shift ? -1 : 1};
        case 'c':
            return edit::Choose{edit::Tool::Corners};
        case 'm':
            return edit::Choose{edit::Tool::Mesh};
        case 'p':
            return edit::Choose{edit::Tool::Part};
        case 'k':
            return edit::Choose{edit::Tool::Masks};
        case 'n':
            return edit::AddMask{};
        case 'v':
            return edit::TurnMask{};
        case 'l':
            return edit::Choose{edit::Tool::Light};
        case '+':
        case '=':
            return edit::StepSize{1};
        case '-':
            return edit::StepSize{-1};
        case ']':
            if (tool == edit::Tool::Masks) return edit::MaskPoints{1};
            return edit::MeshPoints{glm::max(mesh + 1, glm::ivec2(3))};
        case '[':
            if (tool == edit::Tool::Masks) return edit::MaskPoints{-1};
            return edit::MeshPoints{mesh.x > 2 && mesh.y > 2 ? mesh - 1 : glm::ivec2(0)};
        case 'f':
            return edit::Flip{};
        case 'r':
            return edit::Turn{};
        case 'x':
            return edit::Reset{};
        case 't':
            return edit::Picture{key.shift ? -1 : 1};
        case 'i':
            return edit::Show{TestPicture::Identify};
        case 'u':
            return edit::Undo{};
        case 'y':
            return edit::Redo{};
        default:
            return std::nullopt;
    }
}

}  // namespace

std::optional<show::EditCommand> editCommandFor(const Key& key, edit::Tool tool, glm::ivec2 mesh) {
    switch (key.name) {
        case Name::Left:
            return edit::Move{move(key, {-1, 0})};
        case Name::Right:
            return edit::Move{move(key, {1, 0})};
        case Name::Up:
            return edit::Move{move(key, {0, -1})};
        case Name::Down:
            return edit::Move{move(key, {0, 1})};
        case Name::Tab:
            return edit::Handle{key.shift ? -1 : 1};
        case Name::Enter:
        case Name::Escape:
        case Name::Backspace:
            return std::nullopt;
        case Name::Letter:
            return letterCommand(key, tool, mesh);
    }
    return std::nullopt;
}

std::vector<std::string> editKeyLegend() {
    return {"o output   c corners  m mesh  p part  k masks  l light", "tab next   arrows move (shift 10 x, ctrl 1/10)   + - step",
            "] [ points   n new mask  v its other side   f flip  r turn", "t test picture  i identify   x reset   u undo  y redo",
            "w write the file   h hide this   e end"};
}

std::optional<Key> TerminalKeyParser::take(char character) {
    constexpr char kEscape = '\x1b';
    if (sequence_.empty()) {
        if (character == kEscape) {
            sequence_ = character;
            return std::nullopt;
        }
        if (character == '\t') return Key{Name::Tab};
        if (character == '\r' || character == '\n') return Key{Name::Enter};
        if (character < ' ' || character == '\x7f') return std::nullopt;
        Key key;
        key.letter = static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
        key.shift = key.letter != character;
        return key;
    }
    // A sequence is ESC [ ... LETTER, or ESC O LETTER (ECMA-48, xterm). Digits in between carry the
    // modifiers: 2 for Shift, 5 for Control.
    sequence_ += character;
    pausedSince_.reset();
    if (sequence_.size() == 2 && (character == '[' || character == 'O')) return std::nullopt;
    if (sequence_.size() > 2 && (std::isdigit(static_cast<unsigned char>(character)) != 0 || character == ';'))
        return std::nullopt;
    const std::string whole = std::exchange(sequence_, {});
    Key key;
    key.shift = character == 'Z' || whole.find(";2") != std::string::npos;
    key.control = whole.find(";5") != std::string::npos;
    constexpr std::pair<char, Name> kFinal[] = {
        {'A', Name::Up}, {'B', Name::Down}, {'C', Name::Right}, {'D', Name::Left}, {'Z', Name::Tab}};
    for (const auto& [final, name] : kFinal) {
        if (final != character) continue;
        key.name = name;
        return key;
    }
    return std::nullopt;
}

std::optional<Key> TerminalKeyParser::pause(Time moment) {
    constexpr Time kPatience = std::chrono::milliseconds(50);
    if (sequence_.size() != 1) {
        pausedSince_.reset();
        return std::nullopt;
    }
    if (!pausedSince_) pausedSince_ = moment;
    if (moment - *pausedSince_ < kPatience) return std::nullopt;
    sequence_.clear();
    pausedSince_.reset();
    return Key{Name::Escape};
}

}  // namespace fantascope::app
