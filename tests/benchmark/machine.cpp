#include "tests/benchmark/machine.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "grid/parallel.hpp"
#include "particles/bond_batch.hpp"
#include "quern_version.hpp"

namespace quern::bench {

namespace {

/// What follows "key...:" in a file of /proc; empty if there is no such line.
std::string proc_value(const std::string& file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(key))
            if (const std::size_t colon = line.find(':'); colon != std::string::npos) {
                const std::size_t first = line.find_first_not_of(" \t", colon + 1);
                return first == std::string::npos ? "" : line.substr(first);
            }
    return "";
}

double proc_bytes(const std::string& key) {
    double kilobytes = 0.0;
    std::istringstream(proc_value("/proc/self/status", key)) >> kilobytes;
    return 1024.0 * kilobytes;
}

std::string first_line(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

std::string kibibytes(int what) {
    return fmt::format("{} KiB", std::max(0L, sysconf(what)) / 1024);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine(const std::string& revision) {
    return {{"version", QUERN_VERSION},
            {"revision", revision},
            {"compiler", BENCH_COMPILER},
            {"processor", proc_value("/proc/cpuinfo", "model name")},
            {"cores", fmt::format("{}", n_cores())},
            {"instructions", batch_loops(Instructions::best).name},
            {"cache_l1", kibibytes(_SC_LEVEL1_DCACHE_SIZE)},
            {"cache_l2", kibibytes(_SC_LEVEL2_CACHE_SIZE)},
            {"cache_l3", kibibytes(_SC_LEVEL3_CACHE_SIZE)},
            {"memory", proc_value("/proc/meminfo", "MemTotal")},
            {"load_at_start", first_line("/proc/loadavg")}};
}

int n_cores() {
    return static_cast<int>(std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)));
}

void set_threads(int threads) {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (threads == 1)
        CPU_SET(static_cast<unsigned>(std::max(0, sched_getcpu())), &set);
    else
        for (int c = 0; c < n_cores(); ++c) CPU_SET(static_cast<unsigned>(c), &set);
    sched_setaffinity(0, sizeof set, &set);
    parallel::set_threads(threads);
}

MemoryPeak::MemoryPeak() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts anew
    before_ = proc_bytes("VmRSS");
}

double MemoryPeak::bytes() const {
    return std::max(0.0, proc_bytes("VmHWM") - before_);
}

}  // namespace quern::bench
