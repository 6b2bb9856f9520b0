/* The figures of a speed-up table, once for the terminal, the JSON and the page. */
#ifndef PBF_BENCH_SPEEDUP_H
#define PBF_BENCH_SPEEDUP_H

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "speedup/contestant.h"

namespace bench {

struct Speedup {
  Scene scene;
  std::vector<Result> results;
  bool is_the_report;  // the report's own scene, unchanged: its figures may stand beside ours
};

// The report's three figures for its 100 steps, in ms: naive, OpenMP (16 threads), CUDA.
constexpr std::array<double, 3> report_ms = {29904, 2557, 768};

double ms_per_step(const Speedup &speedup, const Result &result);
double particle_iterations_per_second(const Speedup &speedup, const Result &result);

// None when the naive contestant did not run.
std::optional<double> speedup_vs_naive(const Speedup &speedup, const Result &result);

// "GPU" for a device, else the number of threads.
std::string threads_text(const Result &result);

// A number with `digits` significant ones and thousands set apart by commas.
std::string rounded(double value, int digits);
std::string counted(uint64_t count);

std::string speedup_table(const Speedup &speedup);

// Google Benchmark's JSON, one entry a row, as its compare.py reads it.
void write_speedup_json(const Speedup &speedup, const std::string &path);

// A single HTML file with table, pictures, machine and builds.
void write_speedup_page(const Speedup &speedup, const std::string &path);

}  // namespace bench

#endif
