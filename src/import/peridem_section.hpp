// A section of a PeriDEM file: its keys by name, and an error for a key that is not understood.
#pragma once

#include <string>
#include <vector>

#include "src/deck/values.hpp"

namespace quern {

/// What the reader of an imported deck should know; it stands at the head of the deck that is written.
struct ImportNotes {
    std::vector<std::string> unused;               ///< keys without a meaning here: "HPX", "Output.Tags"
    std::vector<std::string> differs;              ///< sentences: what the deck does otherwise than PeriDEM
    void add_difference(const std::string& text);  ///< each text once
};

/// Keys that a section may hold: `used` mean something here, `unused` are accepted and noted.
struct SectionKeys {
    std::vector<std::string> used, unused;
};

/// Lives on the stack of the reader, as Cursor does. Readers throw InputError with file, line and key.
class Section {
  public:
    Section(const Cursor& at, const SectionKeys& keys, ImportNotes& notes);
    /// The section `name` of another one, which must hold it.
    Section(const Section& parent, const std::string& name, const SectionKeys& keys);
    /// The same with any keys.
    Section(const Section& parent, const std::string& name);
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;

    bool has(const std::string& name) const { return at_.has(name); }
    std::string where(const std::string& name) const { return at_.where(name); }
    std::string where() const { return at_.where(); }
    std::string key() const { return at_.place().key; }  ///< "Displacement_BC.Set_1"
    ImportNotes& notes() const { return notes_; }

    double number(const std::string& name, const Range& range = any_number) const;
    double number_or(const std::string& name, double fallback, const Range& range = any_number) const;
    int integer(const std::string& name, const Range& range = any_number) const;
    bool flag_or(const std::string& name, bool fallback) const;
    std::string text(const std::string& name) const;
    std::string text_or(const std::string& name, const std::string& fallback) const;
    /// One of `words`, by its place among them.
    std::size_t word(const std::string& name, const std::vector<std::string>& words) const;
    std::vector<double> numbers(const std::string& name) const;
    std::vector<double> numbers_or_none(const std::string& name) const;
    std::vector<int> integers(const std::string& name) const;

    /// Throws InputError about the key: what was got is the value as it stands.
    [[noreturn]] void refuse(const std::string& name, const std::string& expected,
                             const std::string& hint = {}) const;

  private:
    Cursor value(const std::string& name, const std::string& expected) const;
    Cursor at_;
    ImportNotes& notes_;
};

/// Zone_1 ... Zone_n, and `more`.
SectionKeys zone_keys(int n_zones, const std::vector<std::string>& more = {},
                      const std::vector<std::string>& unused = {});

}  // namespace quern
