/* A run as a text file, from which it can be run again. Lines, STEP being pbf_info.step of then:
 *
 *   pbf-record 1 DIMENSION PRECISION CAPACITY THREADS BACKEND     the first
 *   build TEXT, device TEXT
 *   shape JSON                  what a shape is made from, as in a scene's "shapes", without files;
 *                               in the geometry of structs its number stands, from 1
 *   state STEP HEX              what pbf_save wrote: at the begin, and after particles changed
 *   params STEP HEX             the pbf_params of a pbf_set_params
 *   colliders STEP HEX          the structs of a pbf_set_colliders; "-" for none
 *   move STEP DURATION HEX      those of a pbf_move_colliders
 *   hash STEP HEX               pbf_hash after that step
 *
 * examples/record.h writes the same, without shapes, from a program of one's own. */
#ifndef PBF_BENCH_RECORDING_H
#define PBF_BENCH_RECORDING_H

#include <pbf/pbf.h>

#include <cstdio>
#include <string>
#include <vector>

#include "core/output_file.h"
#include "scene/scene.h"

namespace bench {

class RecordWriter {
 public:
  // `shapes`: those that the solver's colliders have.
  RecordWriter(const std::string &path, pbf_solver *solver, const std::vector<SceneShape> &shapes);
  RecordWriter(const RecordWriter &) = delete;
  RecordWriter &operator=(const RecordWriter &) = delete;

  void state();
  void params(const pbf_params &params);
  void colliders(const std::vector<pbf_collider> &colliders);
  void hash();
  void finish();  // throws Error where the file could not be written

 private:
  void line(const char *kind, const void *bytes, size_t size);
  void write_shapes(unsigned dimension);

  OutputFile out_;
  FILE *file_;  // its
  pbf_solver *solver_;
  std::vector<SceneShape> shapes_;
};

struct Recording {
  enum class Kind { state, params, colliders, move, hash };
  struct Entry {
    Kind kind;
    uint64_t step;
    double duration;    // of a move
    uint64_t hash;      // of a hash
    std::string bytes;  // of all others
  };
  uint32_t dimension = 3, precision = PBF_FLOAT32, capacity = 1, threads = 0;
  std::string backend, build, device;
  std::vector<ShapeHandle> shapes;  // which states find by their hashes
  std::vector<Entry> entries;
};

// Those of an entry, with their shapes. Throws Error where there is none of a struct's number.
std::vector<pbf_collider> colliders_of_entry(const Recording &recording,
                                             const Recording::Entry &entry);

// Throws Error that names the line. A last line without an end, as of a program that has been
// stopped, is left out.
Recording read_recording(const std::string &path);

}  // namespace bench

#endif
