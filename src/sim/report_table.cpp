#include "src/sim/report_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "src/results/json.hpp"
#include "src/results/output_file.hpp"

namespace quern {

void ReportTable::add(const std::string& name, std::vector<double> values) {
    values.resize(columns_.size(), std::nan(""));
    rows_.emplace_back(name, std::move(values));
}

void ReportTable::write(const std::string& directory, const std::string& name) const {
    std::string csv = "case", json = "[";
    for (const std::string& column : columns_) csv += "," + column;
    csv += "\n";
    for (const auto& [label, values] : rows_) {
        csv += label;
        json += fmt::format("{}\n  {{\"case\": {}", json.size() > 1 ? "," : "", json_string(label));
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            csv += std::isfinite(values[i]) ? fmt::format(",{}", values[i]) : ",";
            json += fmt::format(", {}: {}", json_string(columns_[i]), json_number(values[i]));
        }
        csv += "\n";
        json += "}";
    }
    create_directory(directory);
    write_whole_file(directory + "/" + name + ".csv", csv);
    write_whole_file(directory + "/" + name + ".json", json + "\n]\n");
}

}  // namespace quern
