#include "scene/schema.h"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "core/near.h"
#include "core/resources.h"

namespace bench {
namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;
using Failure = valijson::ValidationResults::Error;

// The validator's context is {"<root>", "[params]", "[gravity]", "[1]"}.
json::json_pointer pointer_of(const Failure &failure) {
  json::json_pointer pointer;
  for (size_t i = 1; i < failure.context.size(); ++i) {
    const std::string &step = failure.context[i];
    pointer /= step.substr(1, step.size() - 2);
  }
  return pointer;
}

// The part of the schema that describes the value at `pointer`; null where there is none. A
// description beside a $ref is nearer to the value than the one behind it.
struct Described {
  const json *schema;
  std::string wanted;
};

void enter(const json &root, const json *node, Described &at) {
  at = {node, node->value("description", "")};
  while (at.schema->contains("$ref")) {
    const auto target = at.schema->at("$ref").get<std::string>().substr(1);
    at.schema = &root.at(json::json_pointer(target));
    if (at.wanted.empty()) at.wanted = at.schema->value("description", "");
  }
}

Described describe(const json &root, const json::json_pointer &pointer) {
  Described at;
  enter(root, &root, at);
  std::vector<std::string> steps;
  for (json::json_pointer p = pointer; !p.empty(); p = p.parent_pointer())
    steps.push_back(p.back());
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (at.schema->contains("items")) {
      enter(root, &at.schema->at("items"), at);
    } else if (at.schema->contains("properties") && at.schema->at("properties").contains(*step)) {
      enter(root, &at.schema->at("properties").at(*step), at);
    } else if (at.schema->contains("additionalProperties") &&
               at.schema->at("additionalProperties").is_object()) {
      enter(root, &at.schema->at("additionalProperties"), at);
    } else {
      return {nullptr, ""};
    }
  }
  return at;
}

std::string quoted_name(const std::string &description) {
  const auto first = description.find('\'');
  const auto named = description.find("constraints: '");
  const auto start = named != std::string::npos ? named + 14 : first + 1;
  const auto end = description.rfind('\'');
  return first == std::string::npos || end <= start ? "" : description.substr(start, end - start);
}

std::string shown(const json &value) {
  constexpr size_t longest = 60;
  const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() <= longest ? text : text.substr(0, longest) + "…";
}

bool is_unknown_key(const Failure &failure) {
  return failure.description.rfind("Object contains a property", 0) == 0;
}

bool is_missing_key(const Failure &failure) {
  return failure.description.rfind("Missing required property", 0) == 0;
}

ValueError unknown_key(const Failure &failure, const Described &described) {
  const std::string key = quoted_name(failure.description);
  std::vector<std::string> known;
  if (described.schema && described.schema->contains("properties")) {
    for (const auto &item : described.schema->at("properties").items()) known.push_back(item.key());
  }
  const bool elsewhere = std::find(known.begin(), known.end(), key) != known.end();
  return {pointer_of(failure) / key, "the key \"" + key + "\" does not belong here" +
                                         (elsewhere ? "" : did_you_mean(key, known)) +
                                         "; wanted: " + described.wanted};
}

ValueError explain(const json &root, const Failure &failure, const Document &document) {
  const json::json_pointer pointer = pointer_of(failure);
  const Described described = describe(root, pointer);
  if (is_unknown_key(failure)) return unknown_key(failure, described);
  if (is_missing_key(failure)) {
    return {pointer,
            "\"" + quoted_name(failure.description) + "\" is missing; wanted: " + described.wanted};
  }
  return {pointer,
          "the value is " + shown(document.value.at(pointer)) + "; wanted: " + described.wanted};
}

}  // namespace

struct Schema::Parsed {
  json text;
  valijson::Schema schema;
};

Schema::Schema(const std::string &text) : parsed_(std::make_unique<Parsed>()) {
  parsed_->text = json::parse(text);
  valijson::SchemaParser().populateSchema(Adapter(parsed_->text), parsed_->schema);
}

Schema::~Schema() = default;

void Schema::check(const Document &document) const {
  valijson::ValidationResults results;
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  if (validator.validate(parsed_->schema, Adapter(document.value), &results)) return;
  // The outer values fail because an inner one did; that one is the news.
  const Failure *innermost = nullptr;
  for (const Failure &failure : results) {
    if (!innermost || failure.context.size() > innermost->context.size()) innermost = &failure;
  }
  throw document.error(explain(parsed_->text, *innermost, document));
}

const Schema &scene_schema() {
  static const Schema schema(scene_schema_text());
  return schema;
}

}  // namespace bench
