#include "record/recording.h"

#include <cerrno>
#include <cinttypes>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include "core/content.h"
#include "core/error.h"
#include "core/solver.h"

namespace bench {
namespace {

pbf_info info_of(pbf_solver *solver) {
  pbf_info info = {};
  info.struct_size = sizeof info;
  check_call(pbf_get_info(solver, &info));
  return info;
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// False unless all of `hex` are pairs of digits.
bool bytes_of(const std::string &hex, std::string &bytes) {
  if (hex.empty() || hex.size() % 2 != 0) return false;
  for (size_t i = 0; i < hex.size(); i += 2) {
    const int high = digit(hex[i]), low = digit(hex[i + 1]);
    if (high < 0 || low < 0) return false;
    bytes.push_back(static_cast<char>(16 * high + low));
  }
  return true;
}

bool kind_of(const std::string &word, Recording::Kind &kind) {
  const std::pair<const char *, Recording::Kind> known[] = {
      {"state", Recording::Kind::state},
      {"params", Recording::Kind::params},
      {"colliders", Recording::Kind::colliders},
      {"move", Recording::Kind::move},
      {"hash", Recording::Kind::hash}};
  for (const auto &[name, value] : known) {
    if (word != name) continue;
    kind = value;
    return true;
  }
  return false;
}

// Structs that come from a file are as long as they say.
bool right_size(const Recording::Entry &entry) {
  uint32_t size = 0;
  if (entry.bytes.size() >= sizeof size) std::memcpy(&size, entry.bytes.data(), sizeof size);
  switch (entry.kind) {
    case Recording::Kind::params:
      return size == entry.bytes.size() && size <= sizeof(pbf_params);
    case Recording::Kind::colliders:
    case Recording::Kind::move:
      return entry.bytes.empty() ||
             (size == sizeof(pbf_collider) && entry.bytes.size() % size == 0);
    default:
      return true;
  }
}

bool read_entry(std::istringstream &words, Recording::Entry &entry) {
  std::string hex;
  if (!(words >> entry.step)) return false;
  if (entry.kind == Recording::Kind::move && !(words >> entry.duration)) return false;
  if (!(words >> hex) || (hex != "-" && !bytes_of(hex, entry.bytes))) return false;
  if (entry.kind == Recording::Kind::hash) entry.hash = std::strtoull(hex.c_str(), nullptr, 16);
  return (entry.kind != Recording::Kind::hash || hex.size() == 16) && right_size(entry);
}

std::string rest_of(std::istringstream &words) {
  std::string text;
  std::getline(words >> std::ws, text);
  return text;
}

// Nothing else of this machine belongs into a recording.
bool read_shape_line(const std::string &text, Recording &recording) {
  const nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  const unsigned dimension = recording.dimension;
  if (!object.is_object() || object.contains("file") || (dimension != 2 && dimension != 3))
    return false;
  try {
    const ShapeSource source = read_shape(object, nlohmann::json::json_pointer(), dimension, "");
    recording.shapes.push_back(bake_shape(source, dimension));
  } catch (const nlohmann::json::exception &) {
    return false;
  } catch (const ValueError &) {
    return false;
  } catch (const std::runtime_error &) {
    return false;
  }
  return true;
}

bool read_line(const std::string &line, bool first, Recording &recording) {
  std::istringstream words(line);
  std::string kind;
  words >> kind;
  if (first) {
    uint32_t version = 0;
    return kind == "pbf-record" &&
           static_cast<bool>(words >> version >> recording.dimension >> recording.precision >>
                             recording.capacity >> recording.threads >> recording.backend) &&
           version == 1;
  }
  if (kind == "build" || kind == "device") {
    (kind == "build" ? recording.build : recording.device) = rest_of(words);
    return true;
  }
  if (kind == "shape") return read_shape_line(rest_of(words), recording);
  Recording::Entry entry{};
  if (!kind_of(kind, entry.kind) || !read_entry(words, entry)) return false;
  recording.entries.push_back(entry);
  return true;
}

}  // namespace

RecordWriter::RecordWriter(const std::string &path, pbf_solver *solver,
                           const std::vector<SceneShape> &shapes)
    : out_(path), file_(out_.stream()), solver_(solver), shapes_(shapes) {
  const pbf_info info = info_of(solver);
  std::fprintf(file_, "pbf-record 1 %u %u %u %u %s\nbuild %s\ndevice %s\n", info.dimension,
               info.precision, info.capacity, info.threads, info.backend, info.build_id,
               info.device_name);
  write_shapes(info.dimension);
  state();
}

void RecordWriter::write_shapes(unsigned dimension) {
  for (const SceneShape &shape : shapes_)
    std::fprintf(file_, "shape %s\n", shape_json(shape.source, dimension).dump().c_str());
}

void RecordWriter::state() {
  uint64_t size = 0;
  check_call(pbf_save(solver_, nullptr, &size));
  std::string bytes(size, '\0');
  check_call(pbf_save(solver_, bytes.data(), &size));
  line("state", bytes.data(), bytes.size());
}

void RecordWriter::params(const pbf_params &params) { line("params", &params, sizeof params); }

// An address says nothing to another process: a shape's number stands in its place.
void RecordWriter::colliders(const std::vector<pbf_collider> &colliders) {
  std::vector<pbf_collider> numbered = colliders;
  for (pbf_collider &collider : numbered) {
    uintptr_t number = 0;
    for (size_t i = 0; i < shapes_.size(); ++i)
      if (collider.geometry && shapes_[i].handle.get() == collider.geometry) number = i + 1;
    std::memcpy(&collider.geometry, &number, sizeof number);  // as wide as an address
  }
  line("colliders", numbered.data(), numbered.size() * sizeof(pbf_collider));
}

void RecordWriter::line(const char *kind, const void *bytes, size_t size) {
  std::fprintf(file_, "%s %" PRIu64 " %s", kind, info_of(solver_).step, size > 0 ? "" : "-");
  const auto *all = static_cast<const unsigned char *>(bytes);
  for (size_t i = 0; i < size; ++i) std::fprintf(file_, "%02x", all[i]);
  std::fputc('\n', file_);
  out_.check();
}

void RecordWriter::hash() {
  uint64_t hash = 0;
  check_call(pbf_hash(solver_, &hash));
  std::fprintf(file_, "hash %" PRIu64 " %016" PRIx64 "\n", info_of(solver_).step, hash);
}

void RecordWriter::finish() { out_.keep(); }

std::vector<pbf_collider> colliders_of_entry(const Recording &recording,
                                             const Recording::Entry &entry) {
  std::vector<pbf_collider> colliders(entry.bytes.size() / sizeof(pbf_collider));
  if (colliders.empty()) return colliders;
  std::memcpy(colliders.data(), entry.bytes.data(), colliders.size() * sizeof(pbf_collider));
  for (pbf_collider &collider : colliders) {
    uintptr_t number = 0;
    std::memcpy(&number, &collider.geometry, sizeof number);
    if (number > recording.shapes.size())
      throw Error(exit_usage, "a collider of step " + std::to_string(entry.step) +
                                  " has a shape that the recording has not");
    collider.geometry = number > 0 ? recording.shapes[number - 1].get() : nullptr;
  }
  return colliders;
}

Recording read_recording(const std::string &path) {
  const std::string text = content_of(path, UINTMAX_MAX, "pbf-record ");
  Recording recording;
  size_t number = 0;
  for (size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    if (!read_line(text.substr(at, end - at), ++number == 1, recording))
      throw Error(exit_usage, path + ":" + std::to_string(number) +
                                  ": this is not a line of a recording; `pbf-bench record` and "
                                  "examples/record.h write them");
  }
  if (recording.entries.empty() || recording.entries[0].kind != Recording::Kind::state)
    throw Error(exit_usage, path + ": there is no state to begin with");
  return recording;
}

}  // namespace bench
