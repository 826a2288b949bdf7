#include "src/study/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "grid/error.hpp"

namespace quern {

namespace {

constexpr std::size_t longest_name = 120;

std::string trimmed(std::string_view text) {
    const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return std::string(text);
}

/// The last `n` names of a dotted path.
std::string tail(const std::string& path, int n) {
    std::size_t at = path.size();
    for (; n > 0 && at != std::string::npos; --n) at = at == 0 ? std::string::npos : path.rfind('.', at - 1);
    return at == std::string::npos ? path : path.substr(at + 1);
}

}  // namespace

std::vector<std::string> split_outside(std::string_view text, char separator, const std::string& where) {
    std::vector<std::string> pieces;
    std::string closing;  // of the brackets that are open
    char quote = 0;
    std::size_t begin = 0;
    const auto take = [&](std::size_t end) {
        pieces.push_back(trimmed(text.substr(begin, end - begin)));
        if (pieces.back().empty())
            throw InputError(where, fmt::format("an empty piece in '{}'", text),
                             fmt::format("something on either side of each '{}'", separator),
                             "quote a value that holds it");
        begin = end + 1;
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quote != 0) {
            if (c == '\\' && quote == '"') ++i;
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '(' || c == '[' || c == '{') {
            closing += c == '(' ? ')' : c == '[' ? ']' : '}';
        } else if (!closing.empty() && c == closing.back()) {
            closing.pop_back();
        } else if (closing.empty() && c == separator) {
            take(i);
        }
    }
    if (quote != 0 || !closing.empty())
        throw InputError(where, fmt::format("'{}'", text),
                         fmt::format("a closing {}", quote != 0 ? quote : closing.back()));
    take(text.size());
    return pieces;
}

SweptKey parse_swept(const std::string& text, const std::string& option) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw InputError(option, "'" + text + "'", "key=value or key=value,value,...");
    SweptKey swept{trimmed(text.substr(0, equals)), {}};
    const std::string where = option + ": " + swept.key;
    const std::string values = trimmed(text.substr(equals + 1));
    if (values.empty()) throw InputError(where, "no value", "key=value or key=value,value,...");
    swept.values = split_outside(values, ',', where);
    std::set<std::string> seen;
    for (const std::string& value : swept.values)
        if (!seen.insert(value).second)
            throw InputError(where, "the value '" + value + "' twice", "each value once");
    return swept;
}

std::vector<std::string> short_names(const std::vector<SweptKey>& keys) {
    std::vector<std::string> names;
    for (const SweptKey& swept : keys) {
        int n = 1;
        const auto ambiguous = [&] {
            return std::count_if(keys.begin(), keys.end(), [&](const SweptKey& other) {
                       return tail(other.key, n) == tail(swept.key, n);
                   }) > 1;
        };
        while (tail(swept.key, n) != swept.key && ambiguous()) ++n;
        names.push_back(tail(swept.key, n));
    }
    return names;
}

std::string folder_name(std::string_view text) {
    std::string name(text.substr(0, longest_name));
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) &&
            std::string_view(".=,+-_").find(c) == std::string::npos)
            c = '_';
    // Neither hidden, nor the folder above, nor an option of a command.
    if (name.empty() || name.front() == '.' || name.front() == '-') name.insert(name.begin(), '_');
    return name;
}

std::vector<StudyCase> product(const std::vector<SweptKey>& keys) {
    std::set<std::string> given;
    for (const SweptKey& swept : keys)
        if (!given.insert(swept.key).second)
            throw InputError("--set: " + swept.key, "the key a second time", "each key once",
                             "several values: " + swept.key + "=1,2,3");
    const std::vector<std::string> names = short_names(keys);
    std::vector<StudyCase> cases = {StudyCase{}};
    for (std::size_t k = 0; k < keys.size(); ++k) {
        std::vector<StudyCase> longer;
        for (const StudyCase& one : cases)
            for (const std::string& value : keys[k].values) {
                StudyCase next = one;
                next.overrides.push_back(keys[k].key + "=" + value);
                next.values.push_back(value);
                if (keys[k].values.size() > 1)
                    next.name += (next.name.empty() ? "" : ",") + names[k] + "=" + value;
                longer.push_back(std::move(next));
            }
        cases = std::move(longer);
    }
    std::set<std::string> taken;
    for (StudyCase& one : cases) {
        const std::string base = one.name.empty() ? "run" : folder_name(one.name);
        one.name = base;
        for (int n = 2; !taken.insert(one.name).second; ++n) one.name = fmt::format("{}+{}", base, n);
    }
    return cases;
}

}  // namespace quern
