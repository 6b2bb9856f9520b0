/* The CSV of a run: one row a step. */
#ifndef PBF_BENCH_TRACE_H
#define PBF_BENCH_TRACE_H

#include <pbf/pbf.h>

#include <fstream>
#include <string>

namespace bench {

// Lines for standard formats; numbers have as many digits as tell them apart.
std::string trace_header();
std::string trace_row(const pbf_info &info, const pbf_stats &stats);

// A CSV file; "-" is standard output.
class Trace {
 public:
  explicit Trace(const std::string &path);
  void add(const pbf_info &info, const pbf_stats &stats);
  void finish();

 private:
  void write(const std::string &line);

  std::string path_;
  std::ofstream file_;
};

}  // namespace bench

#endif
