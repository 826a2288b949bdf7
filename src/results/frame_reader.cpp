#include <fmt/format.h>

#include <filesystem>

#include "grid/error.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/hdf5_handle.hpp"

namespace quern {

struct FrameFileReader::Impl {
    explicit Impl(const std::string& path) : path(path) {}

    std::string path;
    Hdf5Handle file;
    int dimension = 2;
    bool has_damage_z = false, has_fragment = false, has_plastic_strain = false;
    std::size_t n_frames = 0, n_particles = 0;
    std::string title;
    std::vector<double> domain, periods, time, volume;
    std::vector<std::int64_t> step;
    std::vector<std::int32_t> grain;

    [[noreturn]] void fail(const std::string& got) const {
        throw InputError(path, got, "the results.h5 of a run");
    }

    Hdf5Handle dataset(const char* name) const {
        Hdf5Handle handle(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
        if (handle < 0) fail(fmt::format("a file without a readable dataset /{}", name));
        return handle;
    }

    std::vector<hsize_t> shape(const char* name, int rank) const {
        const Hdf5Handle data = dataset(name);
        const Hdf5Handle space(H5Dget_space(data), H5Sclose);
        if (H5Sget_simple_extent_ndims(space) != rank)
            fail(fmt::format("a dataset /{} of another shape", name));
        std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
        H5Sget_simple_extent_dims(space, dims.data(), nullptr);
        return dims;
    }

    /// values.size() entries from `first` along the first axis.
    template <class T>
    void read(const char* name, hid_t type, hsize_t first, hsize_t count, std::vector<T>& values) const {
        const Hdf5Handle data = dataset(name);
        const Hdf5Handle space(H5Dget_space(data), H5Sclose);
        hsize_t dims[3] = {}, start[3] = {first, 0, 0};
        const int rank = H5Sget_simple_extent_dims(space, dims, nullptr);
        dims[0] = count;
        const hsize_t total = values.size();
        const Hdf5Handle memory(H5Screate_simple(1, &total, nullptr), H5Sclose);
        if (total == 0) return;
        if (rank < 0 || H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, dims, nullptr) < 0 ||
            H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()) < 0)
            fail(fmt::format("a dataset /{} that cannot be read ({})", name, hdf5_reason()));
    }

    /// Invalid where the file has no such attribute.
    Hdf5Handle attribute(const char* name) const {
        if (H5Aexists(file, name) <= 0) return {};
        return {H5Aopen(file, name, H5P_DEFAULT), H5Aclose};
    }

    /// Leaves `numbers` empty where the file has no such attribute.
    void read_numbers(const char* name, std::size_t n, std::vector<double>& numbers) {
        const Hdf5Handle values = attribute(name);
        if (values < 0) return;
        const Hdf5Handle space(H5Aget_space(values), H5Sclose);
        numbers.resize(n);
        const bool fits = H5Sget_simple_extent_npoints(space) == static_cast<hssize_t>(n);
        if (!fits || H5Aread(values, H5T_NATIVE_DOUBLE, numbers.data()) < 0)
            fail(std::string("an unreadable attribute ") + name);
    }

    void read_attributes() {
        if (const Hdf5Handle text = attribute("title"); text >= 0) {
            const Hdf5Handle type(H5Aget_type(text), H5Tclose);
            char* characters = nullptr;
            if (H5Tis_variable_str(type) <= 0 || H5Aread(text, type, &characters) < 0 || !characters)
                fail("an unreadable attribute title");
            title = characters;
            H5free_memory(characters);
        }
        read_numbers("domain", 2 * static_cast<std::size_t>(dimension), domain);
        read_numbers("periods", static_cast<std::size_t>(dimension), periods);
    }

    /// Every dataset must hold at least the frames that /time counts, of one number of particles.
    void read_shapes() {
        const hsize_t frames = shape("time", 1)[0], n = shape("grain", 1)[0];
        const std::vector<hsize_t> position = shape("position", 3);
        const hsize_t d = position[2];
        if (d != 2 && d != 3) fail(fmt::format("positions of {} components", d));
        const auto require = [&](const char* name, const std::vector<hsize_t>& dims,
                                 std::vector<hsize_t> rest) {
            const bool enough = dims[0] >= frames || n == 0;
            if (!enough || !std::equal(dims.begin() + 1, dims.end(), rest.begin()))
                fail(fmt::format("a dataset /{} that does not fit /time and /grain", name));
        };
        require("position", position, {n, d});
        require("velocity", shape("velocity", 3), {n, d});
        require("damage", shape("damage", 2), {n});
        has_damage_z = H5Lexists(file, "damage_z", H5P_DEFAULT) > 0;
        if (has_damage_z) require("damage_z", shape("damage_z", 2), {n});
        has_fragment = H5Lexists(file, "fragment", H5P_DEFAULT) > 0;
        if (has_fragment) require("fragment", shape("fragment", 2), {n});
        has_plastic_strain = H5Lexists(file, "plastic_strain", H5P_DEFAULT) > 0;
        if (has_plastic_strain) require("plastic_strain", shape("plastic_strain", 2), {n});
        require("stress", shape("stress", 3), {n, d == 2 ? 4u : 6u});
        require("step", shape("step", 1), {});
        if (shape("volume", 1)[0] != n) fail("a dataset /volume that does not fit /grain");
        dimension = static_cast<int>(d);
        n_frames = frames;
        n_particles = n;
    }
};

FrameFileReader::FrameFileReader(const std::string& path) : impl_(new Impl(path)) {
    silence_hdf5();
    std::error_code error;
    if (!std::filesystem::exists(path, error)) impl_->fail("no such file");
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_file_locking(access, false, true);
    impl_->file = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
    if (impl_->file < 0) impl_->fail(fmt::format("a file that HDF5 cannot open ({})", hdf5_reason()));
    // A run that ended before its first frame has no dataset yet.
    if (H5Lexists(impl_->file, "time", H5P_DEFAULT) <= 0) impl_->fail("a file without frames");
    impl_->read_shapes();
    impl_->read_attributes();
    impl_->time.resize(impl_->n_frames);
    impl_->step.resize(impl_->n_frames);
    impl_->grain.resize(impl_->n_particles);
    impl_->volume.resize(impl_->n_particles);
    impl_->read("time", H5T_NATIVE_DOUBLE, 0, impl_->n_frames, impl_->time);
    impl_->read("step", H5T_NATIVE_INT64, 0, impl_->n_frames, impl_->step);
    impl_->read("grain", H5T_NATIVE_INT32, 0, impl_->n_particles, impl_->grain);
    impl_->read("volume", H5T_NATIVE_DOUBLE, 0, impl_->n_particles, impl_->volume);
}

FrameFileReader::~FrameFileReader() = default;

int FrameFileReader::dimension() const {
    return impl_->dimension;
}
std::size_t FrameFileReader::n_frames() const {
    return impl_->n_frames;
}
std::size_t FrameFileReader::n_particles() const {
    return impl_->n_particles;
}
const std::string& FrameFileReader::title() const {
    return impl_->title;
}
const std::vector<double>& FrameFileReader::domain() const {
    return impl_->domain;
}

const std::vector<double>& FrameFileReader::periods() const {
    return impl_->periods;
}

Frame FrameFileReader::read(std::size_t index) const {
    const Impl& file = *impl_;
    const std::size_t n = file.n_particles, d = static_cast<std::size_t>(file.dimension);
    Frame frame;
    frame.dimension = file.dimension;
    frame.step = file.step.at(index);
    frame.time = file.time.at(index);
    frame.position.resize(n * d);
    frame.velocity.resize(n * d);
    frame.damage.resize(n);
    if (file.has_damage_z) frame.damage_z.resize(n);
    if (file.has_fragment) frame.fragment.resize(n);
    if (file.has_plastic_strain) frame.plastic_strain.resize(n);
    frame.stress.resize(n * (d == 2 ? 4 : 6));
    file.read("position", H5T_NATIVE_DOUBLE, index, 1, frame.position);
    file.read("velocity", H5T_NATIVE_FLOAT, index, 1, frame.velocity);
    file.read("damage", H5T_NATIVE_FLOAT, index, 1, frame.damage);
    if (file.has_damage_z) file.read("damage_z", H5T_NATIVE_FLOAT, index, 1, frame.damage_z);
    if (file.has_fragment) file.read("fragment", H5T_NATIVE_INT32, index, 1, frame.fragment);
    if (file.has_plastic_strain)
        file.read("plastic_strain", H5T_NATIVE_FLOAT, index, 1, frame.plastic_strain);
    file.read("stress", H5T_NATIVE_FLOAT, index, 1, frame.stress);
    frame.grain = file.grain;
    frame.volume = file.volume;
    return frame;
}

}  // namespace quern
