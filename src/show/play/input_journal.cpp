#include "show/play/input_journal.h"

#include "core/file.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace fantascope::show {
namespace {

constexpr std::string_view kFirstLine = "fantascope-inputs 1";

}  // namespace

Result<InputJournal> InputJournal::create(const std::filesystem::path& file, const InputLog& log) {
    AppendedFile created = TRY(AppendedFile::create(file));
    created.append(std::string(kFirstLine) + '\n');
    InputJournal journal(std::move(created), log);
    TRY(journal.write());
    return journal;
}

Result<void> InputJournal::write() {
    while (const LoggedInput* const logged = inputs_.next()) file_.append(lineOf(logged->input) + '\n');
    return file_.sync();
}

Result<std::vector<Input>> readJournal(const std::filesystem::path& file) {
    const std::string text = TRY(readFile(file, kMaxFileBytes));
    std::vector<Input> inputs;
    int number = 0;
    for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
        const std::string_view line = std::string_view(text).substr(begin, end - begin);
        ++number;
        if (number == 1 && line != kFirstLine)
            return Error(
                fmt::format("{}:1: this is no journal of inputs: it does not begin with '{}'", file.string(), kFirstLine));
        if (number == 1) continue;
        const Result<Input> input = inputOf(line);
        if (!input) return Error(fmt::format("{}:{}: {}", file.string(), number, input.error().message()));
        inputs.push_back(*input);
    }
    return inputs;
}

}  // namespace fantascope::show
