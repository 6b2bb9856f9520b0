/* Judges a document by a JSON schema whose descriptions say what is wanted, in words. */
#ifndef PBF_BENCH_SCHEMA_H
#define PBF_BENCH_SCHEMA_H

#include <memory>
#include <string>

#include "scene/document.h"

namespace bench {

class Schema {
 public:
  explicit Schema(const std::string &text);
  ~Schema();

  // Throws the error of the innermost value that the schema refuses.
  void check(const Document &document) const;

 private:
  struct Parsed;
  std::unique_ptr<Parsed> parsed_;
};

// The scene format is what bench/scenes/scene.schema.json says, which is built into the program.
const Schema &scene_schema();

}  // namespace bench

#endif
