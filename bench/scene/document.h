/* A JSON file that remembers where each of its values stands, for messages. */
#ifndef PBF_BENCH_DOCUMENT_H
#define PBF_BENCH_DOCUMENT_H

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace bench {

// What is wrong, and with which value; a document turns it into file, line, column and sentence.
struct ValueError {
  nlohmann::json::json_pointer pointer;
  std::string sentence;
};

class Document {
 public:
  // `name` is what messages call the text. Throws Error for text that is not JSON, for a key that
  // stands twice in one object, and for nesting that no scene has.
  Document(const std::string &name, const std::string &text);

  // Replaces one value; messages about it then name `origin` in place of file and line.
  void override_value(const nlohmann::json::json_pointer &pointer, const nlohmann::json &value,
                      const std::string &origin);

  Error error(const ValueError &error) const;

  // "file:line:column" of a value, or of the nearest one around it; what overrode it, if anything.
  std::string place(nlohmann::json::json_pointer pointer) const;

  nlohmann::json value;

 private:
  std::string name_;
  std::vector<size_t> line_starts_;
  std::map<std::string, size_t> places_;  // JSON pointer → where in the text
  std::map<std::string, std::string> origins_;
};

Document read_document(const std::string &path);

}  // namespace bench

#endif
