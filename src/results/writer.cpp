#include "src/results/writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <stdexcept>

#include "src/results/frame_file.hpp"
#include "src/results/json.hpp"
#include "src/results/output_file.hpp"
#include "src/results/vtp_series.hpp"
#include "src/results/xdmf.hpp"

namespace quern {

namespace {

/// ",x,y" or ",x,y,z", each number as short as reads back to the same bits.
std::string cells(const double (&vector)[3], int dimension) {
    return dimension == 2 ? fmt::format(",{},{}", vector[0], vector[1])
                          : fmt::format(",{},{},{}", vector[0], vector[1], vector[2]);
}

/// In quotes where it has to be.
std::string csv_text(const std::string& text) {
    if (text.find_first_of("\",\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

/// Rows that are handed over without waiting for a frame.
constexpr std::size_t long_packet = 4096;

/// A directory that can be written to, without what would tell of another run.
const std::string& make_run_directory(const WriterOptions& options) {
    create_directory(options.directory);
    for (const char* name :
         {"summary.json", "results.pvd", "strength.csv", "fragments.csv", "contacts.csv", "grain_stress.csv",
          "regions.csv", "profiles.csv", "forces.csv", "checkpoint.h5", "checkpoint.previous.h5"}) {
        std::error_code error;
        if (options.resumed && name != std::string_view("summary.json")) continue;
        std::filesystem::remove(options.directory + "/" + name, error);
        if (error) throw_output_error(options.directory + "/" + name, "remove the old file", error.value());
    }
    return options.directory;
}

/// 0 if there is none.
std::int64_t file_size(const std::string& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    return error ? 0 : static_cast<std::int64_t>(size);
}

/// The names as a line of CSV.
std::string header(const std::vector<std::string>& columns) {
    return fmt::format("{}\n", fmt::join(columns, ","));
}

}  // namespace

std::vector<std::string> history_columns(int dimension) {
    std::vector<std::string> columns = {"time",     "kinetic",    "elastic",       "contact_elastic",
                                        "gravity",  "damping",    "friction",      "contact_loss",
                                        "fracture", "plastic",    "transfer_loss", "external_work",
                                        "residual", "throughput", "momentum_x",    "momentum_y"};
    if (dimension == 2) {
        columns.push_back("angular_momentum");
    } else {
        for (const char* name :
             {"momentum_z", "angular_momentum_x", "angular_momentum_y", "angular_momentum_z"})
            columns.push_back(name);
    }
    for (const char* name : {"broken_bonds", "fragments", "debris"}) columns.push_back(name);
    return columns;
}

std::vector<std::string> grain_columns(int dimension) {
    if (dimension == 2) return {"time", "grain", "x", "y", "vx", "vy", "angle", "omega", "fx", "fy"};
    return {"time", "grain", "x", "y", "z", "vx", "vy", "vz", "angle", "omega", "fx", "fy", "fz"};
}

std::vector<std::string> reaction_columns(int dimension) {
    if (dimension == 2) return {"time", "name", "x", "y", "ux", "uy", "fx", "fy", "moment", "work"};
    return {"time", "name", "x", "y", "z", "ux", "uy", "uz", "fx", "fy", "fz", "mx", "my", "mz", "work"};
}

std::vector<std::string> fragment_columns(int dimension) {
    std::vector<std::string> columns = {"time", "fragment",  "grain",     "parent",
                                        "born", "born_step", "particles", "mass"};
    const std::vector<const char*> rest =
        dimension == 2
            ? std::vector<const char*>{"x",         "y",         "vx",        "vy",        "omega",
                                       "stress_xx", "stress_yy", "stress_xy", "stress_zz", "damage"}
            : std::vector<const char*>{"x",         "y",         "z",         "vx",
                                       "vy",        "vz",        "omega_x",   "omega_y",
                                       "omega_z",   "stress_xx", "stress_yy", "stress_zz",
                                       "stress_xy", "stress_yz", "stress_xz", "damage"};
    columns.insert(columns.end(), rest.begin(), rest.end());
    return columns;
}

struct ResultWriter::Files {
    explicit Files(const WriterOptions& options)
        : directory(make_run_directory(options)),
          dimension(options.dimension),
          log(directory + "/run.log"),
          history(directory + "/history.csv"),
          grains(directory + "/grains.csv"),
          reactions(directory + "/reactions.csv"),
          frames(directory + "/results.h5", dimension, options.title, options.domain, options.tables,
                 options.periods),
          xdmf(directory + "/results.xdmf", dimension) {
        history.write(header(history_columns(dimension)));
        grains.write(header(grain_columns(dimension)));
        reactions.write(header(reaction_columns(dimension)));
        for (OutputFile* table : {&history, &grains, &reactions}) table->flush();
        if (options.fragments) {
            fragments.emplace(directory + "/fragments.csv");
            fragments->write(header(fragment_columns(dimension)));
            fragments->flush();
        }
        if (options.vtp) vtp.emplace(directory);
        for (const TableLayout& layout : options.tables) {
            std::vector<std::string> columns;
            for (const TableColumn& column : layout.columns) columns.push_back(column.name);
            tables.push_back({layout, std::make_unique<OutputFile>(directory + "/" + layout.name + ".csv")});
            tables.back().file->write(header(columns));
            tables.back().file->flush();
        }
    }
    Files(const WriterOptions& options, const ResultPosition& position)
        : directory(make_run_directory(options)),
          dimension(options.dimension),
          log(directory + "/run.log", file_size(directory + "/run.log")),
          history(directory + "/history.csv", position.history_bytes),
          grains(directory + "/grains.csv", position.grains_bytes),
          reactions(directory + "/reactions.csv", position.reactions_bytes),
          frames(directory + "/results.h5", dimension, position.n_frames, options.tables),
          xdmf(directory + "/results.xdmf", dimension, position) {
        if (options.fragments) fragments.emplace(directory + "/fragments.csv", position.fragments_bytes);
        if (options.vtp) vtp.emplace(directory, position);
        for (std::size_t k = 0; k < options.tables.size(); ++k)
            tables.push_back({options.tables[k],
                              std::make_unique<OutputFile>(directory + "/" + options.tables[k].name + ".csv",
                                                           position.tables_bytes.at(k))});
    }

    void write(const Packet& packet);
    void write(const HistoryRow& row);
    void write(const GrainRow& row);
    void write(const ReactionRow& row);
    void write(const FragmentRow& row);

    struct GrowingTable {
        TableLayout layout;
        std::unique_ptr<OutputFile> file;
        void write(const TableRows& rows);
    };

    std::string directory;
    int dimension;
    OutputFile log, history, grains, reactions;
    std::optional<OutputFile> fragments;
    FrameFileWriter frames;
    XdmfFile xdmf;
    std::optional<VtpSeries> vtp;
    std::vector<GrowingTable> tables;
};

ResultWriter::ResultWriter(const WriterOptions& options) {
    if (options.dimension != 2 && options.dimension != 3)
        throw std::invalid_argument("ResultWriter: dimension is neither 2 nor 3");
    if (!options.domain.empty() && options.domain.size() != 2 * static_cast<std::size_t>(options.dimension))
        throw std::invalid_argument("ResultWriter: domain has not 2 * dimension numbers");
    files_ = options.resumed ? std::make_unique<Files>(options, *options.resumed)
                             : std::make_unique<Files>(options);
    background_ = std::make_unique<BackgroundWriter>(
        [files = files_.get()](const Packet& packet) { files->write(packet); });
}

ResultWriter::~ResultWriter() {
    try {
        if (background_) hand_over();
    } catch (const std::exception&) {
        // A destructor has nobody to tell; owners that care have called finish().
    }
}

void ResultWriter::write_text(const std::string& file_name, const std::string& text) {
    write_whole_file(files_->directory + "/" + file_name, text);
}

void ResultWriter::log(const std::string& line) {
    files_->log.write(line + "\n");
    files_->log.flush();
}

Frame ResultWriter::add_frame(Frame frame, std::vector<TableRows> tables) {
    if (tables.size() != files_->tables.size())
        throw std::invalid_argument("ResultWriter: the tables of a frame are not those of the options");
    packet_.tables = std::move(tables);
    packet_.frame = std::move(frame);
    packet_.has_frame = true;
    hand_over();
    return std::move(packet_.frame);
}

void ResultWriter::add_history(const HistoryRow& row) {
    packet_.history.push_back(row);
    hand_over_if_long();
}

void ResultWriter::add_grain(const GrainRow& row) {
    packet_.grains.push_back(row);
    hand_over_if_long();
}

void ResultWriter::add_reaction(const ReactionRow& row) {
    packet_.reactions.push_back(row);
    hand_over_if_long();
}

void ResultWriter::add_fragment(const FragmentRow& row) {
    packet_.fragments.push_back(row);
    hand_over_if_long();
}

void ResultWriter::hand_over_if_long() {
    const std::size_t n = packet_.history.size() + packet_.grains.size() + packet_.reactions.size();
    if (n + packet_.fragments.size() >= long_packet) hand_over();
}

void ResultWriter::hand_over() {
    background_->hand_over(packet_);
    packet_.history.clear();
    packet_.grains.clear();
    packet_.reactions.clear();
    packet_.fragments.clear();
    packet_.has_frame = false;
}

void ResultWriter::flush() {
    hand_over();
    background_->wait();
    for (OutputFile* table : {&files_->history, &files_->grains, &files_->reactions}) table->flush();
    if (files_->fragments) files_->fragments->flush();
    for (const Files::GrowingTable& table : files_->tables) table.file->flush();
}

ResultPosition ResultWriter::position() {
    flush();
    std::vector<std::int64_t> tables;
    for (const Files::GrowingTable& table : files_->tables) tables.push_back(table.file->size());
    return {files_->frames.n_frames(),
            files_->history.size(),
            files_->grains.size(),
            files_->reactions.size(),
            files_->xdmf.bytes(),
            files_->vtp ? files_->vtp->bytes() : 0,
            files_->fragments ? files_->fragments->size() : 0,
            tables};
}

double ResultWriter::busy_seconds() const {
    return background_->busy_seconds();
}

void ResultWriter::finish(const Summary& summary) {
    flush();
    background_.reset();
    files_->frames.close();
    write_text("summary.json", make_summary_json(summary));
    files_->log.flush();
}

void ResultWriter::Files::write(const Packet& packet) {
    for (const HistoryRow& row : packet.history) write(row);
    for (const GrainRow& row : packet.grains) write(row);
    for (const ReactionRow& row : packet.reactions) write(row);
    for (const FragmentRow& row : packet.fragments) write(row);
    if (!packet.has_frame) return;
    for (std::size_t k = 0; k < tables.size(); ++k) tables[k].write(packet.tables[k]);
    frames.add(packet.frame, packet.tables);
    xdmf.add(packet.frame.time, packet.frame.n(), !packet.frame.damage_z.empty(),
             !packet.frame.plastic_strain.empty());
    if (vtp) vtp->add(packet.frame);
    for (OutputFile* table : {&history, &grains, &reactions}) table->flush();
    if (fragments) fragments->flush();
    for (const GrowingTable& table : tables) table.file->flush();
}

void ResultWriter::Files::GrowingTable::write(const TableRows& rows) {
    const std::size_t n_columns = layout.columns.size();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::size_t c = i % n_columns;
        const TableColumn& column = layout.columns[c];
        if (column.words.empty())
            file->write(fmt::format("{}", rows[i]));
        else if (rows[i] >= 0.0)
            file->write(csv_text(column.words.at(static_cast<std::size_t>(rows[i]))));
        file->write(c + 1 == n_columns ? "\n" : ",");
    }
}

void ResultWriter::Files::write(const HistoryRow& row) {
    const EnergyBudget& e = row.energy;
    std::string line =
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}", row.time, e.kinetic, e.elastic,
                    e.contact_elastic, e.gravity, e.damping, e.friction, e.contact_loss, e.fracture,
                    e.plastic, e.transfer_loss, e.external_work, e.residual, e.throughput);
    line += cells(row.momentum, dimension);
    line += dimension == 2 ? fmt::format(",{}", row.angular_momentum[2]) : cells(row.angular_momentum, 3);
    history.write(fmt::format("{},{},{},{}\n", line, row.broken_bonds, row.fragments, row.debris));
}

void ResultWriter::Files::write(const GrainRow& row) {
    const int d = dimension;
    grains.write(fmt::format("{},{}{}{},{},{}{}\n", row.time, row.grain, cells(row.position, d),
                             cells(row.velocity, d), row.angle, row.omega, cells(row.force, d)));
}

void ResultWriter::Files::write(const ReactionRow& row) {
    const int d = dimension;
    reactions.write(fmt::format("{},{}{}{}{}{},{}\n", row.time, csv_text(row.name), cells(row.position, d),
                                cells(row.displacement, d), cells(row.force, d),
                                d == 2 ? fmt::format(",{}", row.moment[2]) : cells(row.moment, 3), row.work));
}

void ResultWriter::Files::write(const FragmentRow& row) {
    const int d = dimension;
    fragments->write(fmt::format(
        "{},{},{},{},{},{},{},{}{}{}{},{},{}\n", row.time, row.fragment, row.grain, row.parent, row.born,
        row.born_step, row.particles, row.mass, cells(row.position, d), cells(row.velocity, d),
        d == 2 ? fmt::format(",{}", row.omega[2]) : cells(row.omega, 3),
        fmt::join(std::begin(row.stress), std::begin(row.stress) + (d == 2 ? 4 : 6), ","), row.damage));
}

}  // namespace quern
