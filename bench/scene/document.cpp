#include "scene/document.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/content.h"

namespace bench {
namespace {

using nlohmann::json;

constexpr size_t max_depth = 16;
constexpr uintmax_t max_file_size = 16u << 20;

// Elements of an array behind these are said to be where the array is.
constexpr size_t most_noted = 10000;
constexpr size_t longest_reason = 300;

std::vector<size_t> line_starts_of(const std::string &text) {
  std::vector<size_t> starts = {0};
  for (size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
    starts.push_back(at + 1);
  return starts;
}

std::string place_of(const std::vector<size_t> &line_starts, size_t offset) {
  const auto next = std::upper_bound(line_starts.begin(), line_starts.end(), offset);
  return std::to_string(std::distance(line_starts.begin(), next)) + ":" +
         std::to_string(1 + offset - *std::prev(next));
}

// Follows the parser through the text and notes where each value begins.
class PlaceRecorder : public json::json_sax_t {
 public:
  PlaceRecorder(const std::string &name, const std::string &text,
                const std::vector<size_t> &line_starts, std::istringstream &stream)
      : name_(name), text_(text), line_starts_(line_starts), stream_(stream) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t &) override { return value(); }
  bool string(string_t &) override { return value(); }
  bool binary(binary_t &) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t &name) override {
    Level &level = levels_.back();
    level.key = name;
    if (!level.keys.insert(name).second) {
      throw Error(exit_usage, place_at(token_start()) + ": the key \"" + name +
                                  "\" stands twice in one object");
    }
    consumed_ = here();
    return true;
  }

  bool parse_error(std::size_t position, const std::string &,
                   const nlohmann::detail::exception &error) override {
    std::string reason = error.what();
    const auto colon = reason.find(": ");
    if (colon != std::string::npos) reason = reason.substr(colon + 2);
    if (reason.size() > longest_reason) reason = reason.substr(0, longest_reason) + "...";
    throw Error(exit_usage,
                place_at(position > 0 ? position - 1 : 0) + ": this is not JSON: " + reason);
  }

  std::map<std::string, size_t> places;

 private:
  struct Level {
    bool is_array;
    size_t index = 0;
    std::string key;
    std::set<std::string> keys;
  };

  size_t here() const { return text_.size() - static_cast<size_t>(stream_.rdbuf()->in_avail()); }

  // The token that was read last: the first character after the token before it that separates
  // nothing.
  size_t token_start() const {
    const size_t start = text_.find_first_not_of(" \t\r\n:,", consumed_);
    return start == std::string::npos ? text_.size() : start;
  }

  json::json_pointer pointer() const {
    json::json_pointer path;
    for (const Level &level : levels_) {
      path /= level.is_array ? std::to_string(level.index) : level.key;
    }
    return path;
  }

  std::string place_at(size_t offset) const {
    return name_ + ":" + place_of(line_starts_, std::min(offset, text_.size()));
  }

  bool is_noted() const {
    for (const Level &level : levels_)
      if (level.index >= most_noted) return false;
    return true;
  }

  void note() {
    if (is_noted()) places[pointer().to_string()] = token_start();
    consumed_ = here();
  }

  void next() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
  }

  bool value() {
    note();
    next();
    return true;
  }

  bool open(bool is_array) {
    if (levels_.size() == max_depth) {
      throw Error(exit_usage, place_at(token_start()) + ": nested deeper than " +
                                  std::to_string(max_depth) + " levels; a scene needs 6");
    }
    note();
    levels_.push_back({is_array, 0, {}, {}});
    return true;
  }

  bool close() {
    levels_.pop_back();
    consumed_ = here();
    next();
    return true;
  }

  const std::string &name_;
  const std::string &text_;
  const std::vector<size_t> &line_starts_;
  std::istringstream &stream_;
  std::vector<Level> levels_;
  size_t consumed_ = 0;
};

}  // namespace

Document::Document(const std::string &name, const std::string &text)
    : name_(name), line_starts_(line_starts_of(text)) {
  std::istringstream stream(text);
  PlaceRecorder recorder(name_, text, line_starts_, stream);
  json::sax_parse(stream, &recorder);
  places_ = std::move(recorder.places);
  value = json::parse(text);
}

void Document::override_value(const json::json_pointer &pointer, const json &new_value,
                              const std::string &origin) {
  value[pointer] = new_value;
  // What stood below the old value stands nowhere now.
  const std::string below = pointer.to_string() + "/";
  for (auto place = places_.lower_bound(below);
       place != places_.end() && place->first.rfind(below, 0) == 0;) {
    place = places_.erase(place);
  }
  origins_[pointer.to_string()] = origin;
}

std::string Document::place(json::json_pointer pointer) const {
  for (;; pointer = pointer.parent_pointer()) {
    const std::string text = pointer.to_string();
    if (const auto origin = origins_.find(text); origin != origins_.end()) return origin->second;
    if (const auto place = places_.find(text); place != places_.end()) {
      return name_ + ":" + place_of(line_starts_, place->second);
    }
    if (pointer.empty()) return name_;
  }
}

Error Document::error(const ValueError &error) const {
  const std::string path = error.pointer.to_string();
  return Error(exit_usage,
               place(error.pointer) + ": " + (path.empty() ? "" : path + ": ") + error.sentence);
}

Document read_document(const std::string &path) {
  std::string text;
  try {
    text = content_of(path, max_file_size);
  } catch (const std::runtime_error &error) {
    throw Error(exit_usage, error.what());
  }
  return Document(path, text);
}

}  // namespace bench
