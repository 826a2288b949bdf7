// Settings of a study: keys of the deck with several values each, and all their combinations.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace quern {

/// Pieces of `text` between separators, without spaces around them. Separators within quotes and within (),
/// [],
/// {} do not count. Throws InputError at `where` if a quote or a bracket stays open, or if a piece is empty.
std::vector<std::string> split_outside(std::string_view text, char separator, const std::string& where);

/// "key=1, 2, [3, 4]": a key of the deck and its values, each YAML as `--set` of a run takes it.
struct SweptKey {
    std::string key;
    std::vector<std::string> values;
};

/// `option`: "--set" or "--over", for messages. Throws InputError for a missing '=', no value, or a value
/// given twice.
SweptKey parse_swept(const std::string& text, const std::string& option);

/// One combination: a value of each key.
struct StudyCase {
    std::string
        name;  ///< of its folder: "mu=0.3,theta=60" of the keys that have several values; "run" if none
    std::vector<std::string> overrides;  ///< "key=value", as given
    std::vector<std::string> values;     ///< of the keys, in their order
};

/// All combinations, the last key fastest. Throws InputError if a key is given twice.
std::vector<StudyCase> product(const std::vector<SweptKey>& keys);

/// Letters, digits and ".=,+-_" as they are, everything else '_'; long names are cut.
std::string folder_name(std::string_view text);

/// Names of keys as short as tells them apart: "mu", "theta" for params.mu, params.theta.
std::vector<std::string> short_names(const std::vector<SweptKey>& keys);

}  // namespace quern
