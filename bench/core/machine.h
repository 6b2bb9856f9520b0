/* What a reader of a result must know about the machine and the build. */
#ifndef PBF_BENCH_MACHINE_H
#define PBF_BENCH_MACHINE_H

#include <string>

namespace bench {

struct Machine {
  std::string cpu;       // model name
  unsigned cpus;         // that this process may use
  std::string system;    // kernel name, release and architecture
  std::string compiler;  // of the harness; backends tell their own in their build ids
  std::string commit;    // of the source tree at build time
};

Machine this_machine();

}  // namespace bench

#endif
