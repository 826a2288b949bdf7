#include "src/import/import_peridem.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "grid/error.hpp"
#include "src/import/peridem_writer.hpp"
#include "src/results/output_file.hpp"

namespace quern {
namespace {

namespace fs = std::filesystem;

struct FileToWrite {
    std::string path, bytes;
};

std::string read_bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    if (!file || !(bytes << file.rdbuf()))
        throw InputError(path.string(), "an unreadable file", "a readable one");
    return bytes.str();
}

bool same_file(const fs::path& a, const fs::path& b) {
    std::error_code none;
    return fs::equivalent(a, b, none);
}

/// Whether the file is to be written; one with the same contents stays.
bool must_write(const FileToWrite& file, const PeridemDeck& deck, bool force) {
    if (!fs::exists(file.path)) return true;
    for (const std::string& source : {deck.file, deck.particles})
        if (!source.empty() && same_file(file.path, source))
            throw InputError(file.path, "the file that is imported", "another name for the deck", "-o DECK");
    if (fs::is_regular_file(file.path) && read_bytes(file.path) == file.bytes) return false;
    if (!force) throw InputError(file.path, "an existing file", "a new one", "--force overwrites it");
    return true;
}

}  // namespace

ImportReport import_peridem(const ImportOptions& options) {
    ImportNotes notes;
    const PeridemDeck deck = read_peridem_deck(options.input, notes);
    const PeridemBodies bodies = make_peridem_bodies(deck, notes);
    const fs::path output(options.output);
    ImportedDeck written = write_imported_deck(deck, bodies, options.horizon, output.stem().string(), notes);

    std::vector<FileToWrite> files = {{output.string(), std::move(written.text)}};
    for (ImportedFile& file : written.files)
        files.push_back({(output.parent_path() / file.name).string(),
                         file.source.empty() ? std::move(file.text) : read_bytes(file.source)});
    ImportReport report;
    report.differs = notes.differs;
    report.n_bodies = static_cast<int>(bodies.bodies.size());
    report.n_shapes = written.n_shapes;
    std::vector<const FileToWrite*> wanted;
    for (const FileToWrite& file : files)
        if (must_write(file, deck, options.force)) wanted.push_back(&file);
    if (!output.parent_path().empty()) create_directory(output.parent_path().string());
    for (const FileToWrite* file : wanted) {
        write_whole_file(file->path, file->bytes);
        report.files.push_back(file->path);
    }
    return report;
}

}  // namespace quern
