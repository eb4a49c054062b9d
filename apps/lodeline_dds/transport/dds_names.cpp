#include "apps/lodeline_dds/transport/dds_names.h"

#include <fmt/core.h>

#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "lodeline/diagnostics.h"

namespace lodeline::dds {
namespace {

constexpr std::string_view kBefore = "::msg::dds_::";
/// Ports of a domain are 7400 + 250 domain and the 250 that follow (OMG DDSI-RTPS 9.6.1).
constexpr int64_t kGreatestDomain = 232;

/// Tokens of letters, digits and underscores, which do not begin with a digit, with single slashes between
/// them.
bool isName(std::string_view name) {
  bool is_start = true;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (c == '/') {
      if (is_start) return false;
      is_start = true;
      continue;
    }
    if (!(std::isalnum(letter) || c == '_') || (is_start && std::isdigit(letter))) return false;
    is_start = false;
  }
  return !is_start;
}

}  // namespace

std::string fullName(const std::string& topic, const std::string& name_space) {
  std::string name = topic;
  if (!topic.starts_with('/')) {
    const bool is_root = name_space.empty() || name_space == "/";
    const bool is_absolute = name_space.starts_with('/');
    name = fmt::format("{}{}/{}", is_root || is_absolute ? "" : "/", is_root ? "" : name_space, topic);
  }
  if (!isName(std::string_view(name).substr(1))) {
    throw UsageError(
        fmt::format("{}: is no name of a topic in ROS 2: letters, digits and _, with / between", name));
  }
  return name;
}

std::string ddsTopic(const std::string& full_name) { return "rt" + full_name; }

std::string ddsType(const std::string& type) {
  const size_t slash = type.find('/');
  return fmt::format("{}{}{}_", type.substr(0, slash), kBefore, type.substr(slash + 1));
}

std::optional<std::string> rosType(const std::string& dds_type) {
  const size_t place = dds_type.find(kBefore);
  if (place == std::string::npos || !dds_type.ends_with('_')) return std::nullopt;
  const size_t start = place + kBefore.size();
  return fmt::format("{}/{}", dds_type.substr(0, place), dds_type.substr(start, dds_type.size() - start - 1));
}

void checkDomain(int64_t domain, const std::string& source) {
  if (domain >= 0 && domain <= kGreatestDomain) return;
  throw UsageError(fmt::format("{}: {} is no domain; domains are 0 to {}", source, domain, kGreatestDomain));
}

int domainOfEnvironment() {
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  const std::string_view all(text);
  int64_t domain = -1;
  const auto [rest, error] = std::from_chars(all.data(), all.data() + all.size(), domain);
  if (error != std::errc() || rest != all.data() + all.size()) {
    throw UsageError(fmt::format("ROS_DOMAIN_ID: '{}' is no number", all));
  }
  checkDomain(domain, "ROS_DOMAIN_ID");
  return static_cast<int>(domain);
}

}  // namespace lodeline::dds
