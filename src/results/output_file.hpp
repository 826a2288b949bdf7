// Text and bytes on disk, every write checked.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace quern {

/// A file being written. A failure of any call throws OutputError naming the file and the system's reason;
/// so does a file that was deleted behind our back, which the system itself would not report.
class OutputFile {
  public:
    explicit OutputFile(std::string path);  ///< creates or truncates
    /// Goes on behind the first `kept` bytes of a file; what follows them is cut off. Throws InputError if
    /// the file is shorter.
    OutputFile(std::string path, std::int64_t kept);
    ~OutputFile();  ///< writes what is buffered; errors are lost, so flush() first
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);  ///< appends; buffered
    void flush();
    void overwrite(std::uint64_t offset, std::string_view text);  ///< at once, at a byte offset; unbuffered
    std::int64_t size() const;                                    ///< without what is buffered [bytes]

  private:
    void write_fully(std::string_view text, std::int64_t offset);

    std::string path_, buffer_;
    int descriptor_ = -1;
};

/// An XML file that is well-formed after every entry: the closing tags are rewritten behind the newest one.
class GrowingXmlFile {
  public:
    GrowingXmlFile(std::string path, std::string_view head, std::string tail);
    /// Goes on behind the first `kept` bytes of a file.
    GrowingXmlFile(std::string path, std::int64_t kept, std::string tail);
    std::int64_t bytes() const { return static_cast<std::int64_t>(end_); }  ///< without the closing tags
    void add(std::string_view entry);

  private:
    OutputFile file_;
    std::string tail_;
    std::uint64_t end_;  ///< where the closing tags begin [bytes]
};

/// Writes a whole file under a temporary name and renames it: readers see the old file or the new one.
void write_whole_file(const std::string& path, std::string_view bytes);

/// Creates a directory with its parents, or throws OutputError.
void create_directory(const std::string& path);

/// "FILE: cannot DEED: REASON" for an errno.
[[noreturn]] void throw_output_error(const std::string& path, const std::string& deed, int error);

/// Throws OutputError when the open file `descriptor` has no name any more.
void require_not_deleted(const std::string& path, int descriptor);

/// Text with &, <, > and quotes escaped for XML.
std::string xml_escaped(std::string_view text);

}  // namespace quern
