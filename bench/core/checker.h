/* Where pbf-check is, and what runs it. */
#ifndef PBF_BENCH_CHECKER_H
#define PBF_BENCH_CHECKER_H

#include <string>

namespace bench {

// The folder with pbf-check in it: beside an installed program, else the source tree's.
std::string checker_folder();

// PBF_PYTHON, else the Python found at build time, else that of PATH.
std::string python_program();

}  // namespace bench

#endif
