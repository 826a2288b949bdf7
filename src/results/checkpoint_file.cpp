#include "src/results/checkpoint_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "src/results/hdf5_handle.hpp"
#include "src/results/output_file.hpp"

namespace quern {

namespace {

constexpr const char* format_name = "quern checkpoint 1";

std::string current_name(const std::string& directory) {
    return directory + "/checkpoint.h5";
}
std::string previous_name(const std::string& directory) {
    return directory + "/checkpoint.previous.h5";
}

/// FNV-1a.
std::int64_t hash_of(const std::vector<Checkpoint::Item>& items) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&](unsigned char byte) { hash = (hash ^ byte) * 1099511628211ull; };
    for (const Checkpoint::Item& item : items) {
        for (const char c : item.name) add(static_cast<unsigned char>(c));
        add(static_cast<unsigned char>(item.type));
        for (const std::byte byte : item.bytes) add(static_cast<unsigned char>(byte));
    }
    return static_cast<std::int64_t>(hash);
}

hid_t hdf5_type(Checkpoint::Type type) {
    switch (type) {
        case Checkpoint::Type::real:
            return H5T_NATIVE_DOUBLE;
        case Checkpoint::Type::integer:
            return H5T_NATIVE_INT64;
        case Checkpoint::Type::byte:
            return H5T_NATIVE_UINT8;
    }
    return H5I_INVALID_HID;
}

std::size_t bytes_of(Checkpoint::Type type) {
    return type == Checkpoint::Type::byte ? 1 : 8;
}

/// A number in front keeps the order of the arrays: HDF5 lists them by name.
std::string dataset_name(std::size_t number, const std::string& name) {
    return fmt::format("{:04} {}", number, name);
}

class Output {
  public:
    explicit Output(std::string path) : path_(std::move(path)) {
        silence_hdf5();
        file_ = checked(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    }

    void add(std::size_t number, const Checkpoint::Item& item) {
        const hsize_t n = item.bytes.size() / bytes_of(item.type);
        const Hdf5Handle space = checked(H5Screate_simple(1, &n, nullptr), H5Sclose);
        const Hdf5Handle data =
            checked(H5Dcreate2(file_, dataset_name(number, item.name).c_str(), hdf5_type(item.type), space,
                               H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    H5Dclose);
        if (n > 0)
            check(H5Dwrite(data, hdf5_type(item.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, item.bytes.data()));
    }

    void add_attribute(const char* name, std::int64_t value) {
        const Hdf5Handle space = checked(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Handle attribute =
            checked(H5Acreate2(file_, name, H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        check(H5Awrite(attribute, H5T_NATIVE_INT64, &value));
    }

    void add_attribute(const char* name, const std::string& text) {
        const Hdf5Handle type = checked(H5Tcopy(H5T_C_S1), H5Tclose);
        check(H5Tset_size(type, text.size()));
        const Hdf5Handle space = checked(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Handle attribute =
            checked(H5Acreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        check(H5Awrite(attribute, type, text.data()));
    }

    /// On disk when it returns.
    void close() {
        if (!file_.close()) fail();
        const int descriptor = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0) throw_output_error(path_, "open", errno);
        const int status = fsync(descriptor);
        const int error = errno;
        ::close(descriptor);
        if (status != 0) throw_output_error(path_, "write", error);
    }

  private:
    [[noreturn]] void fail() const {
        throw OutputError(fmt::format("{}: cannot write the checkpoint: {}", path_, hdf5_reason()));
    }
    Hdf5Handle checked(hid_t id, Hdf5Handle::Close close) const {
        if (id < 0) fail();
        return {id, close};
    }
    void check(herr_t status) const {
        if (status < 0) fail();
    }

    std::string path_;
    Hdf5Handle file_;
};

void rename_file(const std::string& from, const std::string& to) {
    if (std::rename(from.c_str(), to.c_str()) != 0) throw_output_error(to, "replace the file", errno);
}

class Input {
  public:
    explicit Input(std::string path) : path_(std::move(path)) {}

    std::vector<Checkpoint::Item> read() {
        silence_hdf5();
        std::error_code error;
        if (!std::filesystem::exists(path_, error)) refuse("no such file");
        file_ = Hdf5Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
        if (file_ < 0) refuse(fmt::format("a file that is cut off or altered ({})", hdf5_reason()));
        if (text_attribute("format") != format_name) refuse("a file of another format");
        H5G_info_t info;
        if (H5Gget_info(file_, &info) < 0) refuse_altered();
        std::vector<Checkpoint::Item> items;
        for (hsize_t k = 0; k < info.nlinks; ++k) items.push_back(read_item(k));
        std::int64_t hash = 0;
        const Hdf5Handle attribute(H5Aopen(file_, "hash", H5P_DEFAULT), H5Aclose);
        if (attribute < 0 || H5Aread(attribute, H5T_NATIVE_INT64, &hash) < 0 || hash != hash_of(items))
            refuse_altered();
        return items;
    }

  private:
    [[noreturn]] void refuse(const std::string& got) const {
        throw InputError(path_, got, "a checkpoint of a run");
    }
    [[noreturn]] void refuse_altered() const { refuse("a file that is cut off or altered"); }

    std::string text_attribute(const char* name) const {
        const Hdf5Handle attribute(H5Aopen(file_, name, H5P_DEFAULT), H5Aclose);
        if (attribute < 0) return {};
        const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
        if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) return {};
        std::string text(H5Tget_size(type), '\0');
        return H5Aread(attribute, type, text.data()) < 0 ? std::string() : text;
    }

    Checkpoint::Item read_item(hsize_t index) const {
        char name[256] = {};
        if (H5Lget_name_by_idx(file_, ".", H5_INDEX_NAME, H5_ITER_INC, index, name, sizeof name - 1,
                               H5P_DEFAULT) < 5)
            refuse_altered();
        const Hdf5Handle data(H5Dopen2(file_, name, H5P_DEFAULT), H5Dclose);
        if (data < 0) refuse_altered();
        const Hdf5Handle type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
        Checkpoint::Item item;
        item.name = std::string(name).substr(5);
        item.type = H5Tget_class(type) == H5T_FLOAT ? Checkpoint::Type::real
                    : H5Tget_size(type) == 1        ? Checkpoint::Type::byte
                                                    : Checkpoint::Type::integer;
        const hssize_t n = H5Sget_simple_extent_npoints(space);
        const auto stored = H5Dget_storage_size(data);
        std::error_code error;
        const bool fits = n >= 0 && stored == static_cast<hsize_t>(n) * bytes_of(item.type);
        if (!fits || stored > std::filesystem::file_size(path_, error)) refuse_altered();
        item.bytes.resize(static_cast<std::size_t>(stored));
        if (n > 0 &&
            H5Dread(data, hdf5_type(item.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, item.bytes.data()) < 0)
            refuse_altered();
        return item;
    }

    std::string path_;
    Hdf5Handle file_;
};

}  // namespace

std::size_t Checkpoint::size_of_next(const std::string& name) const {
    if (next_ >= items_.size() || items_[next_].name != name)
        throw InputError(place_, next_ < items_.size() ? "an array " + items_[next_].name : "no more arrays",
                         "an array " + name, "was it written by another version?");
    return items_[next_].bytes.size();
}

void Checkpoint::pass(const std::string& name, Type type, std::span<std::byte> bytes) {
    if (!loading_) {
        items_.push_back({name, type, {bytes.begin(), bytes.end()}});
        return;
    }
    const std::size_t size = size_of_next(name);
    const Item& item = items_[next_++];
    if (item.type != type || size != bytes.size())
        throw InputError(place_, fmt::format("{} bytes in {}", size, name),
                         fmt::format("{} bytes", bytes.size()), "is it the checkpoint of another deck?");
    std::copy(item.bytes.begin(), item.bytes.end(), bytes.begin());
}

void write_checkpoint(const std::string& directory, const Checkpoint& checkpoint) {
    const std::string path = current_name(directory), part = path + ".part";
    try {
        Output output(part);
        output.add_attribute("format", format_name);
        for (std::size_t k = 0; k < checkpoint.items().size(); ++k) output.add(k, checkpoint.items()[k]);
        output.add_attribute("hash", hash_of(checkpoint.items()));
        output.close();
    } catch (const OutputError&) {
        unlink(part.c_str());
        throw;
    }
    std::error_code error;
    if (std::filesystem::exists(path, error)) rename_file(path, previous_name(directory));
    rename_file(part, path);
}

Checkpoint read_checkpoint(const std::string& directory, std::string& refused) {
    refused.clear();
    try {
        return {Input(current_name(directory)).read(), current_name(directory)};
    } catch (const InputError& error) {
        std::error_code code;
        if (!std::filesystem::exists(previous_name(directory), code)) throw;
        refused = error.what();
    }
    return {Input(previous_name(directory)).read(), previous_name(directory)};
}

}  // namespace quern
