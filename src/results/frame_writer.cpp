#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "grid/error.hpp"
#include "quern_version.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/hdf5_handle.hpp"
#include "src/results/output_file.hpp"

namespace quern {

namespace {

constexpr hsize_t particles_per_chunk = 1 << 22;
constexpr hsize_t times_per_chunk = 256;
constexpr hsize_t rows_per_chunk = 256;
constexpr unsigned deflate_level = 1;  // higher levels cost several times the time for a few percent

// A kill can cut a write between two pages. An index cut in two would lose frames that were complete before,
// so every node of it is one page: one of 2 * 42 chunks in three dimensions takes 4096 bytes. Left is the
// moment in which a full node is split, at frame 84 and every 42 after.
constexpr hsize_t page = 4096;
constexpr unsigned half_of_index_node = 42;

enum class Packing { plain, deflated };

const char* stress_components(int dimension) {
    return dimension == 2 ? "xx, yy, xy, zz" : "xx, yy, zz, xy, yz, xz";
}

}  // namespace

struct FrameFileWriter::Impl {
    Impl(const std::string& path, int dimension, const std::vector<TableLayout>& layouts)
        : path(path), dimension(dimension) {
        for (const TableLayout& layout : layouts) tables.push_back({layout, {}, {}});
    }

    std::string path;
    int dimension;
    Hdf5Handle file;
    Hdf5Handle time, step, position, velocity, damage, damage_z, fragment, plastic_strain, stress;
    hsize_t n_frames = 0, n_particles = 0;
    struct Table {
        TableLayout layout;
        Hdf5Handle rows, end;
        hsize_t n_rows = 0;
    };
    std::vector<Table> tables;

    [[noreturn]] void fail(const std::string& deed) const {
        throw OutputError(fmt::format("{}: cannot {}: {}", path, deed, hdf5_reason()));
    }
    Hdf5Handle checked(hid_t id, Hdf5Handle::Close close, const char* deed) const {
        if (id < 0) fail(deed);
        return {id, close};
    }
    void check(herr_t status, const char* deed) const {
        if (status < 0) fail(deed);
    }

    void add_attribute(hid_t object, const char* name, const std::string& text) const {
        const Hdf5Handle type = checked(H5Tcopy(H5T_C_S1), H5Tclose, "make a type");
        check(H5Tset_size(type, H5T_VARIABLE), "make a type");
        check(H5Tset_cset(type, H5T_CSET_UTF8), "make a type");
        const Hdf5Handle space = checked(H5Screate(H5S_SCALAR), H5Sclose, "make a space");
        const Hdf5Handle attribute = checked(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                                             H5Aclose, "add an attribute");
        const char* characters = text.c_str();
        check(H5Awrite(attribute, type, &characters), "write an attribute");
    }

    void add_attribute(hid_t object, const char* name, const std::vector<double>& values) const {
        const hsize_t n = values.size();
        const Hdf5Handle space = checked(H5Screate_simple(1, &n, nullptr), H5Sclose, "make a space");
        const Hdf5Handle attribute =
            checked(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                    "add an attribute");
        check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data()), "write an attribute");
    }

    /// Unlimited along the first axis when it is 0.
    Hdf5Handle add_dataset(const char* name, hid_t type, std::vector<hsize_t> shape, Packing packing,
                           const char* unit, const std::string& description) const {
        const bool grows = shape[0] == 0, one_number_a_frame = grows && shape.size() == 1;
        std::vector<hsize_t> limit = shape, chunk = shape;
        if (grows) {
            limit[0] = H5S_UNLIMITED;
            chunk[0] = one_number_a_frame ? times_per_chunk : 1;
        }
        hsize_t& particles = chunk[grows && !one_number_a_frame ? 1 : 0];
        // Equal parts: a plain chunk takes its full size in the file, however little of it is used.
        const hsize_t parts =
            std::max<hsize_t>(1, (particles + particles_per_chunk - 1) / particles_per_chunk);
        particles = std::max<hsize_t>(1, (particles + parts - 1) / parts);

        const Hdf5Handle properties = checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
        check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "set the chunks");
        // A chunk that grows over several frames (/time, /step) would move in the file each time it is
        // compressed anew, and a run that is killed meanwhile would leave a chunk that cannot be read. Left
        // alone it stays in its place.
        if (packing == Packing::deflated) {
            check(H5Pset_shuffle(properties), "set the shuffle filter");
            check(H5Pset_deflate(properties, deflate_level), "set the compression");
        }
        const Hdf5Handle space =
            checked(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), limit.data()), H5Sclose,
                    "make a space");
        Hdf5Handle dataset =
            checked(H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                    "add a dataset");
        add_attribute(dataset, "units", unit);
        add_attribute(dataset, "description", description);
        return dataset;
    }

    void make_datasets(const Frame& first) {
        n_particles = first.n();
        const hsize_t n = n_particles, d = static_cast<hsize_t>(dimension);
        const hid_t real = H5T_IEEE_F64LE, single = H5T_IEEE_F32LE;
        time = add_dataset("time", real, {0}, Packing::plain, "s", "time of each frame");
        step = add_dataset("step", H5T_STD_I64LE, {0}, Packing::plain, "1",
                           "number of steps done before each frame");
        position = add_dataset("position", real, {0, n, d}, Packing::plain, "m", "current position");
        velocity = add_dataset("velocity", single, {0, n, d}, Packing::plain, "m/s", "velocity");
        damage = add_dataset("damage", single, {0, n}, Packing::deflated, "1",
                             "fraction of broken bonds, 0 intact, 1 all broken");
        if (!first.damage_z.empty())
            damage_z = add_dataset("damage_z", single, {0, n}, Packing::deflated, "1",
                                   "largest bond stretch over the critical one, broken from 1 up");
        if (!first.fragment.empty())
            fragment =
                add_dataset("fragment", H5T_STD_I32LE, {0, n}, Packing::deflated, "1",
                            "fragment of each particle: grains as placed, then pieces as they broke off");
        if (!first.plastic_strain.empty())
            plastic_strain = add_dataset("plastic_strain", single, {0, n}, Packing::deflated, "1",
                                         "equivalent plastic strain");
        stress = add_dataset("stress", single, {0, n, d == 2 ? 4u : 6u}, Packing::plain, "Pa",
                             fmt::format("Cauchy stress {}, tension positive", stress_components(dimension)));
        const Hdf5Handle grain = add_dataset("grain", H5T_STD_I32LE, {n}, Packing::deflated, "1",
                                             "grain of each particle, from 0");
        const Hdf5Handle volume = add_dataset("volume", real, {n}, Packing::deflated, d == 2 ? "m^2" : "m^3",
                                              d == 2 ? "reference area" : "reference volume");
        if (n == 0) return;
        check(H5Dwrite(grain, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, first.grain.data()), "write");
        check(H5Dwrite(volume, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, first.volume.data()),
              "write");
    }

    static std::string rows_name(const Table& table) { return "observed/" + table.layout.name; }
    static std::string end_name(const Table& table) { return rows_name(table) + "_end"; }

    /// Empty, with the names of their columns.
    void make_tables() {
        if (tables.empty()) return;
        const Hdf5Handle group = checked(H5Gcreate2(file, "observed", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                         H5Gclose, "add a group");
        for (Table& table : tables) {
            const hsize_t shape[] = {0, table.layout.columns.size()}, limit[] = {H5S_UNLIMITED, shape[1]},
                          chunk[] = {rows_per_chunk, shape[1]};
            const Hdf5Handle properties = checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
            check(H5Pset_chunk(properties, 2, chunk), "set the chunks");
            const Hdf5Handle space = checked(H5Screate_simple(2, shape, limit), H5Sclose, "make a space");
            table.rows = checked(H5Dcreate2(file, rows_name(table).c_str(), H5T_IEEE_F64LE, space,
                                            H5P_DEFAULT, properties, H5P_DEFAULT),
                                 H5Dclose, "add a dataset");
            std::string names, units;
            for (const TableColumn& column : table.layout.columns) {
                names += (names.empty() ? "" : ",") + column.name;
                units += (units.empty() ? "" : ",") + column.unit;
                if (column.words.empty()) continue;
                std::string words;
                for (const std::string& word : column.words) words += (words.empty() ? "" : "\n") + word;
                add_attribute(table.rows, ("words of " + column.name).c_str(), words);
            }
            add_attribute(table.rows, "columns", names);
            add_attribute(table.rows, "units", units);
            table.end = add_dataset(end_name(table).c_str(), H5T_STD_I64LE, {0}, Packing::plain, "1",
                                    "number of rows at the end of each frame");
        }
    }

    void append_rows(Table& table, const TableRows& cells) const {
        const hsize_t n_columns = table.layout.columns.size(), n = cells.size() / n_columns;
        if (n > 0) {
            const hsize_t shape[] = {table.n_rows + n, n_columns}, start[] = {table.n_rows, 0},
                          count[] = {n, n_columns};
            check(H5Dset_extent(table.rows, shape), "extend a dataset");
            const Hdf5Handle space = checked(H5Dget_space(table.rows), H5Sclose, "read a space");
            check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr), "select rows");
            const Hdf5Handle memory = checked(H5Screate_simple(2, count, nullptr), H5Sclose, "make a space");
            check(H5Dwrite(table.rows, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, cells.data()), "write");
        }
        table.n_rows += n;
        append(table.end, H5T_NATIVE_HSIZE, &table.n_rows);
    }

    /// Cuts the tables to the rows of the frames that count.
    void open_tables() {
        for (Table& table : tables) {
            table.rows =
                checked(H5Dopen2(file, rows_name(table).c_str(), H5P_DEFAULT), H5Dclose, "open a dataset");
            table.end =
                checked(H5Dopen2(file, end_name(table).c_str(), H5P_DEFAULT), H5Dclose, "open a dataset");
            check(H5Dset_extent(table.end, &n_frames), "shorten a dataset");
            std::vector<hsize_t> ends(n_frames);
            check(H5Dread(table.end, H5T_NATIVE_HSIZE, H5S_ALL, H5S_ALL, H5P_DEFAULT, ends.data()), "read");
            table.n_rows = ends.back();
            const hsize_t shape[] = {table.n_rows, table.layout.columns.size()};
            check(H5Dset_extent(table.rows, shape), "shorten a dataset");
        }
    }

    Hdf5Handle access() const {
        Hdf5Handle properties = checked(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make properties");
        // Without locks a picture can be drawn from a run that is still going on.
        check(H5Pset_file_locking(properties, false, true), "set the file access");
        check(H5Pset_alignment(properties, page / 2, page), "set the file access");
        return properties;
    }

    /// /time first: a frame that it does not count is none.
    void open_datasets() {
        for (const auto& [dataset, name] : {std::pair{&time, "time"},
                                            {&step, "step"},
                                            {&position, "position"},
                                            {&velocity, "velocity"},
                                            {&damage, "damage"},
                                            {&damage_z, "damage_z"},
                                            {&fragment, "fragment"},
                                            {&plastic_strain, "plastic_strain"},
                                            {&stress, "stress"}}) {
            const bool optional = dataset == &damage_z || dataset == &fragment || dataset == &plastic_strain;
            if (optional && H5Lexists(file, name, H5P_DEFAULT) <= 0) continue;
            *dataset = checked(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, "open a dataset");
            std::array<hsize_t, 3> shape{};
            const Hdf5Handle space = checked(H5Dget_space(*dataset), H5Sclose, "read a space");
            if (H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0) fail("read a shape");
            shape[0] = n_frames;
            check(H5Dset_extent(*dataset, shape.data()), "shorten a dataset");
        }
        open_tables();
        check(H5Fflush(file, H5F_SCOPE_LOCAL), "write");
    }

    void append(hid_t dataset, hid_t memory_type, const void* values) const {
        std::array<hsize_t, 3> shape{}, start{}, count{};
        const Hdf5Handle old = checked(H5Dget_space(dataset), H5Sclose, "read a space");
        const int rank = H5Sget_simple_extent_dims(old, shape.data(), nullptr);
        if (rank < 0) fail("read a shape");
        count = shape;
        count[0] = 1;
        start[0] = n_frames;
        shape[0] = n_frames + 1;
        check(H5Dset_extent(dataset, shape.data()), "extend a dataset");
        const Hdf5Handle space = checked(H5Dget_space(dataset), H5Sclose, "read a space");
        check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
              "select a frame");
        const Hdf5Handle memory =
            checked(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, "make a space");
        check(H5Dwrite(dataset, memory_type, memory, space, H5P_DEFAULT, values), "write");
    }

    void require_consistent(const Frame& frame) const {
        const std::size_t n = frame.n(), d = static_cast<std::size_t>(dimension);
        const bool fits = frame.dimension == dimension && (n_frames == 0 || n == n_particles) &&
                          frame.position.size() == n * d && frame.velocity.size() == n * d &&
                          frame.damage.size() == n && frame.volume.size() == n &&
                          (frame.damage_z.empty() || frame.damage_z.size() == n) &&
                          (n_frames == 0 || n == 0 || frame.damage_z.empty() == (damage_z < 0)) &&
                          (frame.fragment.empty() || frame.fragment.size() == n) &&
                          (n_frames == 0 || n == 0 || frame.fragment.empty() == (fragment < 0)) &&
                          (frame.plastic_strain.empty() || frame.plastic_strain.size() == n) &&
                          (n_frames == 0 || n == 0 || frame.plastic_strain.empty() == (plastic_strain < 0)) &&
                          frame.stress.size() == n * (d == 2 ? 4 : 6);
        if (!fits)
            throw std::invalid_argument(
                "FrameFileWriter: the arrays of a frame do not fit each other or the frames before");
    }

    void require_not_deleted() const {
        void* descriptor = nullptr;
        check(H5Fget_vfd_handle(file, H5P_DEFAULT, &descriptor), "inspect the file");
        quern::require_not_deleted(path, *static_cast<int*>(descriptor));
    }
};

FrameFileWriter::FrameFileWriter(const std::string& path, int dimension, const std::string& title,
                                 const std::vector<double>& domain, const std::vector<TableLayout>& tables,
                                 const std::vector<double>& periods)
    : impl_(new Impl(path, dimension, tables)) {
    silence_hdf5();
    const Hdf5Handle access = impl_->access();
    const Hdf5Handle creation = impl_->checked(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "make properties");
    impl_->check(H5Pset_istore_k(creation, half_of_index_node), "set the size of the index");
    impl_->file =
        impl_->checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, "create the file");
    impl_->add_attribute(impl_->file, "format", "quern results 1");
    impl_->add_attribute(impl_->file, "version", QUERN_VERSION);
    impl_->add_attribute(impl_->file, "title", title);
    if (!domain.empty()) impl_->add_attribute(impl_->file, "domain", domain);
    if (!periods.empty()) impl_->add_attribute(impl_->file, "periods", periods);
    impl_->check(H5Fflush(impl_->file, H5F_SCOPE_LOCAL), "write");
}

FrameFileWriter::FrameFileWriter(const std::string& path, int dimension, std::int64_t n_frames,
                                 const std::vector<TableLayout>& tables)
    : impl_(new Impl(path, dimension, tables)) {
    if (n_frames > 0) {
        const FrameFileReader reader(path);
        if (reader.dimension() != dimension || static_cast<std::int64_t>(reader.n_frames()) < n_frames)
            throw InputError(path, fmt::format("{} frames in {}D", reader.n_frames(), reader.dimension()),
                             fmt::format("the {} frames in {}D of the checkpoint", n_frames, dimension),
                             "was it replaced?");
        impl_->n_particles = reader.n_particles();
    }
    silence_hdf5();
    impl_->n_frames = static_cast<hsize_t>(n_frames);
    const Hdf5Handle access = impl_->access();
    impl_->file = impl_->checked(H5Fopen(path.c_str(), H5F_ACC_RDWR, access), H5Fclose, "open the file");
    if (n_frames > 0) {
        impl_->open_datasets();
        return;
    }
    for (const char* name : {"time", "step", "position", "velocity", "damage", "damage_z", "fragment",
                             "plastic_strain", "stress", "grain", "volume", "observed"})
        if (H5Lexists(impl_->file, name, H5P_DEFAULT) > 0)
            impl_->check(H5Ldelete(impl_->file, name, H5P_DEFAULT), "remove an old dataset");
}

FrameFileWriter::~FrameFileWriter() = default;

std::int64_t FrameFileWriter::n_frames() const {
    return static_cast<std::int64_t>(impl_->n_frames);
}

void FrameFileWriter::add(const Frame& frame, const std::vector<TableRows>& tables) {
    impl_->require_consistent(frame);
    silence_hdf5();
    impl_->require_not_deleted();
    if (impl_->n_frames == 0) {
        impl_->make_datasets(frame);
        impl_->make_tables();
    }
    const Impl& file = *impl_;
    if (file.n_particles > 0) {
        file.append(file.position, H5T_NATIVE_DOUBLE, frame.position.data());
        file.append(file.velocity, H5T_NATIVE_FLOAT, frame.velocity.data());
        file.append(file.damage, H5T_NATIVE_FLOAT, frame.damage.data());
        if (file.damage_z >= 0) file.append(file.damage_z, H5T_NATIVE_FLOAT, frame.damage_z.data());
        if (file.fragment >= 0) file.append(file.fragment, H5T_NATIVE_INT32, frame.fragment.data());
        if (file.plastic_strain >= 0)
            file.append(file.plastic_strain, H5T_NATIVE_FLOAT, frame.plastic_strain.data());
        file.append(file.stress, H5T_NATIVE_FLOAT, frame.stress.data());
    }
    for (std::size_t k = 0; k < impl_->tables.size(); ++k) file.append_rows(impl_->tables[k], tables.at(k));
    file.append(file.step, H5T_NATIVE_INT64, &frame.step);
    // All that the new frame needs is on disk before /time counts it, wherever a kill hits.
    file.check(H5Fflush(file.file, H5F_SCOPE_LOCAL), "write");
    file.append(file.time, H5T_NATIVE_DOUBLE, &frame.time);
    file.check(H5Fflush(file.file, H5F_SCOPE_LOCAL), "write");
    ++impl_->n_frames;
}

void FrameFileWriter::close() {
    Impl& file = *impl_;
    if (file.file < 0) return;
    file.require_not_deleted();
    bool closed = true;
    for (Hdf5Handle* dataset : {&file.time, &file.step, &file.position, &file.velocity, &file.damage,
                                &file.damage_z, &file.fragment, &file.plastic_strain, &file.stress})
        closed = dataset->close() && closed;
    for (Impl::Table& table : file.tables) closed = table.rows.close() && table.end.close() && closed;
    closed = file.file.close() && closed;
    if (!closed) file.fail("close the file");
}

}  // namespace quern
