#include "lodeline/output/foxglove/foxglove_schemas.h"

#include <stdexcept>
#include <utility>

namespace lodeline::foxglove {
namespace {

using Fields = std::vector<std::pair<std::string, Json>>;

Json number() { return {{"type", "number"}}; }
Json whole() { return {{"type", "integer"}}; }
Json text() { return {{"type", "string"}}; }
Json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
Json list(Json of) { return {{"type", "array"}, {"items", std::move(of)}}; }

/// An object with these fields; all of them are required.
Json object(const Fields& fields) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const auto& [name, field] : fields) {
    schema["properties"][name] = field;
    schema["required"].push_back(name);
  }
  return schema;
}

Json time() {
  Json schema = object({{"sec", whole()}, {"nsec", whole()}});
  schema["title"] = "time";
  return schema;
}

Json vector() { return object({{"x", number()}, {"y", number()}, {"z", number()}}); }
Json rotation() { return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}}); }
Json pose() { return object({{"position", vector()}, {"orientation", rotation()}}); }

Fields fieldsOf(const std::string& name) {
  if (name == kTransform) {
    return {{"timestamp", time()},
            {"parent_frame_id", text()},
            {"child_frame_id", text()},
            {"translation", vector()},
            {"rotation", rotation()}};
  }
  if (name == kPose) return {{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}};
  if (name == kPoses) return {{"timestamp", time()}, {"frame_id", text()}, {"poses", list(pose())}};
  if (name == kPointCloud) {
    const Json field = object({{"name", text()}, {"offset", whole()}, {"type", whole()}});
    return {{"timestamp", time()},     {"frame_id", text()},    {"pose", pose()},
            {"point_stride", whole()}, {"fields", list(field)}, {"data", bytes()}};
  }
  if (name == kLog) {
    return {{"timestamp", time()}, {"level", whole()}, {"message", text()},
            {"name", text()},      {"file", text()},   {"line", whole()}};
  }
  if (name == kImage) {
    return {{"timestamp", time()}, {"frame_id", text()}, {"data", bytes()}, {"format", text()}};
  }
  throw std::invalid_argument("no schema of that name: " + name);
}

}  // namespace

Json schemaOf(const std::string& name) {
  Json schema = object(fieldsOf(name));
  schema["title"] = name;
  return schema;
}

Json stateSchema(const std::vector<std::string>& numbers, const std::vector<std::string>& words) {
  Json schema = object({{"timestamp", time()}});
  schema["title"] = kState;
  for (const std::string& name : words) schema["properties"][name] = text();
  for (const std::string& name : numbers) schema["properties"][name] = number();
  return schema;
}

}  // namespace lodeline::foxglove
