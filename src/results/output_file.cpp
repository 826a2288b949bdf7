#include "src/results/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "grid/error.hpp"

namespace quern {

namespace {

constexpr std::size_t buffer_size = 1 << 14;

}  // namespace

void throw_output_error(const std::string& path, const std::string& deed, int error) {
    throw OutputError(fmt::format("{}: cannot {}: {}", path, deed, std::generic_category().message(error)));
}

void require_not_deleted(const std::string& path, int descriptor) {
    struct stat status {};
    if (fstat(descriptor, &status) != 0) throw_output_error(path, "inspect the file", errno);
    if (status.st_nlink == 0) throw OutputError(path + ": cannot write: the file was deleted during the run");
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
    descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw_output_error(path_, "open for writing", errno);
    buffer_.reserve(buffer_size);
}

OutputFile::OutputFile(std::string path, std::int64_t kept) : path_(std::move(path)) {
    descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw_output_error(path_, "open for writing", errno);
    const std::int64_t present = size();
    if (present < kept) {
        close(descriptor_);
        throw InputError(path_, fmt::format("{} bytes", present),
                         fmt::format("at least the {} bytes that it had at the checkpoint", kept),
                         "was it replaced?");
    }
    if (ftruncate(descriptor_, kept) != 0 || lseek(descriptor_, 0, SEEK_END) < 0) {
        const int error = errno;
        close(descriptor_);
        throw_output_error(path_, "shorten the file", error);
    }
    buffer_.reserve(buffer_size);
}

OutputFile::~OutputFile() {
    try {
        flush();
    } catch (const OutputError&) {
        // A destructor has nobody to tell; owners that care have flushed before.
    }
    close(descriptor_);
}

void OutputFile::write(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() >= buffer_size) flush();
}

void OutputFile::flush() {
    require_not_deleted(path_, descriptor_);
    const std::string pending = std::move(buffer_);
    buffer_.clear();
    write_fully(pending, -1);
}

void OutputFile::overwrite(std::uint64_t offset, std::string_view text) {
    require_not_deleted(path_, descriptor_);
    write_fully(text, static_cast<std::int64_t>(offset));
}

std::int64_t OutputFile::size() const {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0) throw_output_error(path_, "inspect the file", errno);
    return status.st_size;
}

void OutputFile::write_fully(std::string_view text, std::int64_t offset) {
    while (!text.empty()) {
        const ssize_t n = offset < 0 ? ::write(descriptor_, text.data(), text.size())
                                     : pwrite(descriptor_, text.data(), text.size(), offset);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw_output_error(path_, "write", errno);
        text.remove_prefix(static_cast<std::size_t>(n));
        if (offset >= 0) offset += n;
    }
}

GrowingXmlFile::GrowingXmlFile(std::string path, std::string_view head, std::string tail)
    : file_(std::move(path)), tail_(std::move(tail)), end_(head.size()) {
    file_.overwrite(0, std::string(head) + tail_);
}

GrowingXmlFile::GrowingXmlFile(std::string path, std::int64_t kept, std::string tail)
    : file_(std::move(path), kept), tail_(std::move(tail)), end_(static_cast<std::uint64_t>(kept)) {
    file_.overwrite(end_, tail_);
}

void GrowingXmlFile::add(std::string_view entry) {
    file_.overwrite(end_, std::string(entry) + tail_);
    end_ += entry.size();
}

void write_whole_file(const std::string& path, std::string_view bytes) {
    const std::string part = path + ".part";
    try {
        OutputFile file(part);
        file.overwrite(0, bytes);
    } catch (const OutputError&) {
        unlink(part.c_str());
        throw;
    }
    if (std::rename(part.c_str(), path.c_str()) != 0) {
        const int error = errno;
        unlink(part.c_str());
        throw_output_error(path, "replace the file", error);
    }
}

void create_directory(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!error && !std::filesystem::is_directory(path, error) && !error)
        error = std::make_error_code(std::errc::not_a_directory);
    if (error) throw_output_error(path, "create the directory", error.value());
}

std::string xml_escaped(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '"')
            escaped += "&quot;";
        else
            escaped += c;
    }
    return escaped;
}

}  // namespace quern
